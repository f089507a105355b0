"""Fig. 26: central spheres, upright arcs, smallest angles, and smallest angles with walls."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh.nodes import (
    beam_tilt,
    central_spheres,
    intersection_angles,
    minimize_angles,
    optimize_spheres,
    panels,
    vase_mesh,
)


def draw(*, small: bool = False) -> Figure:
    """A vase in four kinds of panels."""
    net = vase_mesh(14, 9) if small else vase_mesh(22, 14)
    central = central_spheres(net)
    upright = optimize_spheres(central, angle=0.01, regularity=10.0).sphere_mesh
    smooth = minimize_angles(central).sphere_mesh
    kinds = {"central": central, "upright": upright, "smallest angles": smooth}
    angle = {name: float(intersection_angles(each).mean()) for name, each in kinds.items()}
    tilt = {name: float(np.nanquantile(beam_tilt(each), 0.95)) for name, each in kinds.items()}
    walls = panels(smooth)
    gap = walls.report["edge_gap"]["relative_to_edge"]
    meet = {"edges": "intersection"}
    return Figure(
        "Fig. 26",
        "mean angle and tilt of arcs: "
        + ", ".join(f"{name} {angle[name]:.1f}° and {tilt[name]:.0f}°" for name in kinds)
        + f"; between walls that bisect faces gaps are up to {gap:.3f} of an edge.",
        angle["smallest angles"] <= min(angle.values()) + 1e-6
        and tilt["upright"] <= min(tilt.values()) + 1e-6,
        [
            View("(a) central spheres", cut(central, **meet)),
            View("(b) upright arcs", cut(upright, **meet)),
            View("(c) smallest angles", cut(smooth, **meet)),
            View("(d) smallest, upright walls", walls.panels),
        ],
        shape=1.15,
    )


if __name__ == "__main__":
    run(draw)
