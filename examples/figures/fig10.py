"""Fig. 10: spheres that meet at a prescribed angle of sixty degrees."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh.nodes import catenoid_mesh, fit_spheres, intersection_angles, minimize_angles


def draw(*, small: bool = False) -> Figure:
    """Cushions on a catenoid."""
    start = fit_spheres(catenoid_mesh(18, 7) if small else catenoid_mesh(36, 13))
    cushions = minimize_angles(start, target_angle=60.0, sides="one").sphere_mesh
    angles = intersection_angles(cushions)
    spread = float(np.std(angles))
    made = cut(cushions, edges="intersection")
    return Figure(
        "Fig. 10",
        f"{len(angles)} edges meet at {np.median(angles):.2f}° in the middle, all between "
        f"{angles.min():.1f}° and {angles.max():.1f}°, where 60° were asked for.",
        abs(float(np.median(angles)) - 60) < 2 and spread < 8,
        [
            View("from above", made),
            View("from the front", made, options={"direction": (0.2, -1.0, 0.15)}),
        ],
    )


if __name__ == "__main__":
    run(draw)
