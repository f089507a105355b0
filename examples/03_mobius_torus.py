"""A panelled torus through an inversion: a cyclide with the same angles between its panels."""

import spheremesh as sm
from spheremesh.nodes import (
    apply_mobius,
    fit_spheres,
    intersection_angles,
    inversion,
    minimize_angles,
    panels,
    torus_mesh,
    write_3dm,
)

graph = sm.Graph("cyclide", units="m")
net = graph.add(torus_mesh, n_around=36, n_across=18)
start = graph.add(fit_spheres, mesh=net)
torus = graph.add(minimize_angles, sphere_mesh=start).sphere_mesh
turned = graph.add(inversion, center=[6.0, 0.0, 1.0], radius=5.0)
cyclide = graph.add(apply_mobius, geometry=torus, transform=turned)

for name, shape in {"torus": torus, "cyclide": cyclide}.items():
    angles = graph.run(graph.add(intersection_angles, sphere_mesh=shape))
    cut = graph.add(panels, sphere_mesh=shape, thickness=0.01)
    path = graph.run(graph.add(write_3dm, panels=cut.panels, path=f"{name}.3dm"))
    count = graph.run(cut.report)["written"]
    print(f"{name}: {angles.mean():.4f} degrees between neighbours, {count} panels in {path}")
