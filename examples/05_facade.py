"""A facade whose panels meet at sixty degrees, all of them: cushions by design (Fig. 10)."""

import numpy as np

from spheremesh.nodes import (
    catenoid_mesh,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    panels,
    render,
)

start = fit_spheres(catenoid_mesh(n_around=36, n_across=13))
for target in (0.0, 30.0, 60.0):
    facade = minimize_angles(start, target_angle=target).sphere_mesh
    angles = intersection_angles(facade)
    print(
        f"{target:.0f} degrees asked for: {np.median(angles):.1f} in the middle, all between "
        f"{angles.min():.1f} and {angles.max():.1f}"
    )

cut = panels(facade, edges="intersection", thickness=0.01)
print(f"{cut.report['written']} panels; {render(cut.panels, 'facade.png')}")
