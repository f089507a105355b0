"""Fig. 24: spheres over a discrete isothermic net, with upright beams without torsion."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh.nodes import (
    axis_support,
    beams,
    common_axes,
    enneper_mesh,
    exact_support,
    support_structure,
)


def draw(*, small: bool = False) -> Figure:
    """Enneper's minimal surface in curvature lines that are squares in the small."""
    net = enneper_mesh(8 if small else 16)
    quads = net.vertices[net.corners.reshape(-1, 4)]
    sides = np.linalg.norm(np.roll(quads, -1, axis=1) - quads, axis=2)
    ratio = float((sides[:, 0] * sides[:, 2] / (sides[:, 1] * sides[:, 3])).std())
    exact = exact_support(net).sphere_mesh
    torsion = float(support_structure(exact).torsion.max())
    axes = common_axes(exact)
    support = axis_support(exact, depth=0.09, axes=axes)
    made = cut(exact, edges="axis", axes=axes, thickness=0.005)
    frame = beams(support.annuli, thickness=0.01, panels=made).beams
    tilt = support.report["tilt_deg"]["max"]
    view = {"direction": (0.7, -0.7, 0.6)}
    return Figure(
        "Fig. 24",
        f"cross-ratios of the net are -1 within {ratio:.0e} in their size; with spheres the "
        f"beams have a torsion of {torsion:.0e}° and lean by at most {tilt:.1f}°.",
        torsion < 1e-6 and ratio < 1e-9,
        [
            View("spheres", made, options=view),
            View("their beams", beams=frame, options=view),
            View("from below", made, beams=frame, options={"direction": (0.7, -0.7, -0.6)}),
        ],
        shape=0.8,
    )


if __name__ == "__main__":
    run(draw)
