"""Fig. 15: the model change of hyperbolic geometry carries a plane to two spheres."""

import numpy as np
from figure import BLUE, GREEN, GREY, RED, Figure, View, drawn_mesh, run

from spheremesh import Mesh
from spheremesh.nodes import model_change, sphere_rows
from spheremesh.viewer.shapes import sphere_shape


def draw(*, small: bool = False, geometry: str = "hyperbolic", name: str = "Fig. 15") -> Figure:
    """A square in the absolute sphere, and its two images."""
    steps = 3 if small else 9
    u, v = np.meshgrid(*[np.linspace(-0.45, 0.45, steps)] * 2, indexing="ij")
    plane = np.stack([0.45 + 0 * u, u, v], -1)
    ids = np.arange(steps**2).reshape(steps, steps)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1).reshape(
        -1, 4
    )
    mesh = Mesh(plane.reshape(-1, 3), faces)
    omega = sphere_rows([[0.0, 0, 0]], [1.0])
    images = {
        side: model_change(mesh, geometry, 1.0, branch=side) for side in ("inner", "outer")
    }
    sign = 1 if geometry == "hyperbolic" else -1
    centers = np.concatenate([image.centers for image in images.values()])
    radii = np.concatenate([image.radii for image in images.values()])
    miss = float(np.abs((centers**2).sum(axis=1) - radii**2 - sign).max())
    how = "right angles" if sign > 0 else "opposite points"
    one_sphere = max(float(np.ptp(image.radii)) for image in images.values())
    absolute = sphere_shape(omega, GREY, is_veil=True)
    return Figure(
        name,
        f"all {steps - 1} x {steps - 1} pieces of a plane go to one sphere within "
        f"{one_sphere:.0e}, which meets the absolute sphere at {how} within {miss:.0e}.",
        one_sphere < 1e-9 and miss < 1e-9,
        [
            View(
                "a piece of a plane in the absolute sphere",
                things=[absolute, *drawn_mesh(mesh, GREEN)],
                options=VIEW,
            ),
            View(
                "its image inside",
                things=[absolute, *drawn_mesh(images["inner"].mesh, BLUE)],
                options=VIEW,
            ),
            View(
                "its image outside",
                things=[absolute, *drawn_mesh(images["outer"].mesh, RED)],
                options=VIEW,
            ),
        ],
    )


VIEW = {"direction": (0.5, -1.0, 0.35)}


if __name__ == "__main__":
    run(draw)
