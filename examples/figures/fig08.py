"""Fig. 8: a chain of annuli that intersect twice: R² - r² is one number along it."""

import numpy as np
from figure import BLUE, GREEN, RED, SAND, Figure, View, grid_mesh, run

from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.support.annuli import Annuli
from spheremesh.nodes import annulus_support, ellipsoid_mesh, model_change
from spheremesh.viewer.shapes import Shape, circle_shape, mesh_shape


def draw(*, small: bool = False) -> Figure:
    """Whole annuli around a face of a sphere mesh with exact support."""
    net = ellipsoid_mesh(8, 5) if small else ellipsoid_mesh(12, 7)
    spheres = model_change(net, radius=4.0)
    most = annulus_support(spheres, kappa=0.01).report["kappa_max"]
    annuli = annulus_support(spheres, kappa=0.3 * most).annuli
    powers = annuli.radii[:, 0] ** 2 - annuli.radii[:, 1] ** 2
    spread = float(np.ptp(powers) / powers.mean())
    beside = annuli.edge_faces[annuli.edge_faces >= 0]
    face = int(np.argmax(np.bincount(beside)))
    chain = np.flatnonzero((annuli.edge_faces == face).any(axis=1))
    views = [
        View(
            caption,
            things=_rings(select_parts(annuli, np.isin(np.arange(annuli.n_annuli), some))),
        )
        for caption, some in (("two annuli", chain[:2]), ("a closed chain", chain))
    ]
    return Figure(
        "Fig. 8",
        f"R² - r² = {powers.mean():.4f} along all chains of {annuli.n_annuli} annuli, within "
        f"{spread:.0e}.",
        spread < 1e-9,
        views,
    )


def _rings(annuli: Annuli) -> list[Shape]:
    """Each annulus as the whole ring between its circles."""
    turns = np.linspace(0, 2 * np.pi, 97)[:-1]
    found: list[Shape] = []
    colors = (BLUE, SAND, GREEN, RED)
    for k, (center, radii) in enumerate(zip(annuli.centers, annuli.radii, strict=True)):
        x, y, normal = annuli.frames[k]
        ring = np.cos(turns)[:, None] * x + np.sin(turns)[:, None] * y
        band = grid_mesh(center + radii[None, :, None] * ring[:, None], around=True)
        found += [
            mesh_shape(band, colors[k % 4]),
            circle_shape([center] * 2, [normal] * 2, radii, 0.012 * radii[0]),
        ]
    return found


if __name__ == "__main__":
    run(draw)
