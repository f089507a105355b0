"""Fig. 6: a congruence of spheres and its two envelopes f+ and f-."""

import numpy as np
from figure import BLUE, GREEN, SAND, Figure, View, grid_mesh, run

from spheremesh.nodes import smooth_envelope, sphere_rows
from spheremesh.viewer.shapes import mesh_shape, sphere_shape


def draw(*, small: bool = False) -> Figure:
    """Centres on a saddle, radii that grow along it."""
    n = 25 if small else 61
    u, v = np.meshgrid(np.linspace(-1.2, 1.2, n), np.linspace(-0.9, 0.9, n), indexing="ij")
    zero, one = np.zeros_like(u), np.ones_like(u)
    centers = np.stack([u, v, 0.3 * (u**2 - v**2)], -1).reshape(-1, 3)
    radii = (0.3 + 0.08 * u).ravel()
    found = smooth_envelope(
        centers, radii,
        np.stack([one, zero, 0.6 * u], -1).reshape(-1, 3),
        np.stack([zero, one, -0.6 * v], -1).reshape(-1, 3),
        np.full(n * n, 0.08), np.zeros(n * n),
    )  # fmt: skip
    sides = [grid_mesh(p.reshape(n, n, 3)) for p in (found.points_plus, found.points_minus)]
    off = max(
        float(np.abs(np.linalg.norm(side.vertices - centers, axis=1) - radii).max())
        for side in sides
    )
    step = (n - 1) // (3 if small else 6)
    sparse = np.arange(n * n).reshape(n, n)[step // 2 :: step, step // 2 :: step].ravel()
    spheres = sphere_shape(sphere_rows(centers[sparse], radii[sparse]), BLUE)
    upper = [mesh_shape(sides[0], SAND, smooth=True), mesh_shape(sides[1], GREEN, smooth=True)]
    view = {"direction": (0.55, -0.9, 0.45)}
    return Figure(
        "Fig. 6",
        f"at {n * n} spheres both envelopes lie on the spheres to {off:.0e}.",
        bool(found.is_real.all()) and off < 1e-12,
        [
            View("a sparse choice of the spheres", things=[spheres], options=view),
            View("both envelopes", things=upper, options=view),
            View(
                "spheres between their envelopes",
                things=[
                    spheres,
                    mesh_shape(sides[1], GREEN, smooth=True),
                    mesh_shape(sides[0], SAND, smooth=True, is_veil=True),
                ],
                options=view,
            ),
        ],
        shape=0.8,
    )


if __name__ == "__main__":
    run(draw)
