"""Fig. 14: the panels of Fig. 13 on six moulds, a colour for each."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh.nodes import cluster_radii, fit_spheres, minimize_angles, roof_mesh


def draw(*, small: bool = False) -> Figure:
    """The roof of Fig. 13, from two sides."""
    net = roof_mesh(8, 8, 24.0) if small else roof_mesh(22, 22, 24.0)
    smooth = minimize_angles(fit_spheres(net)).sphere_mesh
    six = cluster_radii(smooth, 6, tolerance=0.02)
    made = cut(six.sphere_mesh, labels=six.labels)
    radii = made.radii
    spread = max(
        float(np.ptp(radii[made.labels == k]) / radii[made.labels == k][0]) for k in range(6)
    )
    counts = ", ".join(map(str, np.bincount(six.labels).tolist()))
    return Figure(
        "Fig. 14",
        f"{net.n_faces} panels have six radii, equal within {spread:.0e}: {counts} of each.",
        len(np.unique(six.labels)) == 6 and spread < 1e-9,
        [
            View(
                "from above", made, options={"color_by": "mould", "direction": (0.5, -0.8, 0.9)}
            ),
            View(
                "from the other side",
                made,
                options={"color_by": "mould", "direction": (-0.7, 0.8, 0.5)},
            ),
        ],
        shape=0.65,
    )


if __name__ == "__main__":
    run(draw)
