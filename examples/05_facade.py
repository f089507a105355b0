"""A facade whose panels meet at sixty degrees, all of them: cushions by design (Fig. 10)."""

import numpy as np

from spheremesh.nodes import (
    annulus_support,
    audit,
    beams,
    catenoid_mesh,
    drilling_marks,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    panels,
    render,
    write_dxf,
    write_schedule,
    write_step,
)

# Cushions bulge to one side: then the planes of their arcs stand, and panels are cut in them.
start = fit_spheres(catenoid_mesh(n_around=36, n_across=13))
for target in (0.0, 30.0, 60.0):
    facade = minimize_angles(start, target_angle=target, sides="one").sphere_mesh
    angles = intersection_angles(facade)
    print(
        f"{target:.0f} degrees asked for: {np.median(angles):.1f} in the middle, all between "
        f"{angles.min():.1f} and {angles.max():.1f}"
    )

cut = panels(facade, edges="intersection", thickness=0.01)
print(f"{cut.report['written']} panels; {render(cut.panels, 'facade.png')}")

# The frame: flat beams in the planes of the arcs, cut square before round nodes, and bolted.
annuli = annulus_support(facade, depth=0.06)
frame = beams(
    annuli.annuli, thickness=0.008, node_radius=0.012, node_gap=0.001, panels=cut.panels
)
bolted = drilling_marks(frame.beams, count=2, diameter=0.006, inset=0.012)
found = audit(
    cut.panels,
    cut.report,
    beams=bolted.beams,
    annuli_report=annuli.report,
    beams_report=frame.report,
)
print(
    f"{frame.report['written']} beams, {bolted.report['marked']} of them drilled; findings: "
    f"{found.report['counts']}"
)
for path in (
    write_step(cut.panels, "facade.step", beams=bolted.beams),
    write_dxf(bolted.beams, "beams.dxf"),
    write_schedule(beams=bolted.beams, path="beams.csv"),
):
    print(path)
