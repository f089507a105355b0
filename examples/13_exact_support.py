"""A roof whose net slides on its surface until beams and panels meet exactly."""

from spheremesh.nodes import (
    audit,
    axis_support,
    beams,
    common_axes,
    exact_support,
    panels,
    render_assembly,
    roof_mesh,
    write_dxf,
    write_step,
)

mesh = roof_mesh(n_span=10, n_length=14)
found = exact_support(mesh, max_height=0.06, max_slide=0.7)
report = found.report
print(
    f"{report.verdict}: torsion at most {report.torsion_deg['max']:.0e} degrees, gaps at most "
    f"{report.gap['relative_to_edge']:.0e} of an edge; vertices leave the surface by at most "
    f"{report.height['max']:.3f} and slide by at most {report.slide['max']:.2f} edges"
)
angles = report.angles_deg
print(
    f"neighbours meet at {angles['spherical']['mean']:.2f} degrees, flat panels would at "
    f"{angles['planar']['mean']:.2f}; beams tilt by at most {report.beam_tilt_deg['max']:.1f}"
)

axes = common_axes(found.sphere_mesh)
support = axis_support(found.sphere_mesh, depth=0.3, axes=axes)
cut = panels(
    found.sphere_mesh, edges="axis", axes=axes, thickness=0.02, joint_gap=0.01
)  # fmt: skip
frame = beams(support.annuli, thickness=0.03, panels=cut.panels)
checked = audit(
    cut.panels, cut.report, beams=frame.beams, annuli_report=support.report,
    beams_report=frame.report,
)  # fmt: skip
print(
    f"{cut.report['written']} panels, {frame.report['written']} beams; "
    f"{checked.report['counts']}"
)
print(
    render_assembly(
        cut.panels, frame.beams, "roof_from_below.png", (0.5, -0.7, -0.6), width=900
    )
)
print(write_step(cut.panels, "roof.step", beams=frame.beams))
print(write_dxf(frame.beams, "beams.dxf"))
