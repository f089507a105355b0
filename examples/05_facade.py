"""A facade whose panels meet at sixty degrees, all of them: cushions by design (Fig. 10)."""

import numpy as np

from spheremesh.nodes import (
    ellipsoid_mesh,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    panels,
    render,
)

start = fit_spheres(ellipsoid_mesh(n_around=28, n_across=13))
for target in (0.0, 30.0, 60.0):
    facade = minimize_angles(start, target_angle=target).sphere_mesh
    angles = intersection_angles(facade)
    off = np.abs(angles - target)
    print(f"{target:.0f} degrees asked for: {np.median(angles):.2f} in the middle, ", end="")
    print(f"nine of ten edges within {np.percentile(off, 90):.2f}")

cut = panels(facade, thickness=0.01)
print(render(cut.panels, "facade.png"), f"{cut.report['written']} panels")
