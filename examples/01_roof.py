"""A freeform roof in 8 moulds: how much smoother, how many panels per mould, what gap."""

import spheremesh as sm
from spheremesh.nodes import (
    cluster_radii,
    fit_spheres,
    minimize_angles,
    panels,
    roof_mesh,
    write_schedule,
)

graph = sm.Graph("roof", units="m")
moulds = graph.param("moulds", 8, min=1, max=60)
net = graph.add(roof_mesh)
start = graph.add(fit_spheres, mesh=net)
optimum = graph.add(minimize_angles, sphere_mesh=start)
clusters = graph.add(cluster_radii, sphere_mesh=optimum.sphere_mesh, k=moulds)
cut = graph.add(
    panels,
    sphere_mesh=clusters.sphere_mesh,
    thickness=0.02,
    joint_gap=0.01,
    labels=clusters.labels,
)
schedule = graph.add(write_schedule, panels=cut.panels, path="schedule.csv")

angles = graph.run(optimum.report)["angles_deg"]
print(f"planes:  {angles['planar']['mean']:.2f} degrees between neighbours")
print(f"spheres: {angles['spherical']['mean']:.2f}")
for count in (12, 8, 4, 2, 1):
    graph.set(moulds=count)
    report = graph.run(clusters.report)
    print(f"{report['count']:2d} moulds: {report['angles_deg']['mean']:.2f}")

graph.set(moulds=8)
gap = graph.run(cut.report)["edge_gap"]
print(f"arcs of neighbours differ by at most {1000 * gap['max']:.1f} mm")
print(f"wrote {graph.run(schedule)}")
graph.save("roof.json")
