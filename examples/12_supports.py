"""A roof on few moulds with beams on node axes, and its triangles with upright beams."""

from spheremesh.nodes import (
    audit,
    axis_support,
    beams,
    bisector_support,
    cluster_radii,
    fit_spheres,
    least_node_radius,
    minimize_angles,
    panels,
    render_assembly,
    roof_mesh,
    support_feasibility,
    triangulate,
    write_dxf,
    write_step,
)

UNDERNEATH = (0.5, -0.7, -0.6)

mesh = roof_mesh(n_span=12, n_length=18)
smooth = minimize_angles(fit_spheres(mesh)).sphere_mesh
print(f"beams on node axes: {support_feasibility(smooth).reason}")

# Vertices and spheres stay, and radii do not matter: five moulds will do.
clusters = cluster_radii(smooth, k=5)
support = axis_support(clusters.sphere_mesh, depth=0.3)
cut = panels(
    clusters.sphere_mesh, edges="axis", axes=support.axes, labels=clusters.labels,
    thickness=0.02, joint_gap=0.01,
)  # fmt: skip
frame = beams(support.annuli, thickness=0.03, panels=cut.panels)
found = audit(
    cut.panels, cut.report, beams=frame.beams, annuli_report=support.report,
    beams_report=frame.report,
)  # fmt: skip
print(
    f"{cut.report['written']} panels on {len(clusters.radii)} moulds, "
    f"{frame.report['written']} beams; torsion at most "
    f"{support.report.torsion_deg['max']:.4f} degrees, gaps at most "
    f"{100 * support.report.gap['max']:.1f} % of an edge; {found.report['counts']}"
)
print(render_assembly(cut.panels, frame.beams, "roof_from_below.png", UNDERNEATH, width=900))
print(write_step(cut.panels, "roof.step", beams=frame.beams))
print(write_dxf(frame.beams, "beams.dxf"))

# Triangles have more edges than axes can please: beams stand upright, cylinders join them.
triangles = minimize_angles(fit_spheres(triangulate(mesh))).sphere_mesh
print(f"triangles: {support_feasibility(triangles).reason}")
upright = bisector_support(triangles, depth=0.3, thickness=0.03)
skin = panels(triangles, thickness=0.02, joint_gap=0.01)
radius = least_node_radius(upright.annuli, thickness=0.03, panels=skin.panels)
nodes = beams(upright.annuli, thickness=0.03, node_radius=radius, panels=skin.panels)
print(
    f"{skin.report['written']} triangles, {nodes.report['written']} beams before cylinders of "
    f"{radius:.3f}; torsion {upright.report.torsion_deg['p95']:.2f} degrees"
)
print(
    render_assembly(skin.panels, nodes.beams, "triangles_from_below.png", UNDERNEATH, width=900)
)
