"""A torus of tangent spheres, remeshed (Fig. 29): panels, beams without torsion, CAD files."""

from spheremesh.nodes import (
    annulus_support,
    beams,
    evolve_spheres,
    p4_remesh,
    panels,
    render,
    shifted_rows,
    support_structure,
    tangent_sphere_shex,
    torus_mesh,
    write_3dm,
    write_dxf,
    write_step,
)

EDGE = 0.6

# Section 7: spheres that touch the torus grow towards its curvature spheres.
triangles = shifted_rows(torus_mesh(n_around=72, n_across=24, minor_radius=0.9))
grown = evolve_spheres(triangles, max_axis_angle=15)
hexagons = tangent_sphere_shex(grown.mesh, grown.spheres)
shapes = hexagons.report
print(f"{shapes['faces']} faces, {shapes['degrees'].get('6', 0)} of them hexagons")

# Section 6.4: the same spheres, along their conjugate directions.
net = p4_remesh(grown.mesh, grown.spheres, EDGE)
report, planar = net.report, net.report["planarized"]
print(f"remeshed: faces by degree {report['faces']['degrees']}")
print(
    f"nodes planar to {planar['planarity']['after']:.0e}, on their spheres to "
    f"{planar['corner_gap']['after']:.0e} edges; moved {planar['moved']['max']:.2f} edges"
)
nodes = support_structure(net.sphere_mesh).report
print(
    f"torsion up to {nodes['torsion_deg']['max']:.0e} degrees, axes within "
    f"{planar['axis_angles_deg']['max']:.1f} of upright, {len(nodes['invalid'])} invalid"
)

cut = panels(net.sphere_mesh, edges="intersection", thickness=0.02, joint_gap=0.012)
annuli = annulus_support(net.sphere_mesh, depth=0.12)
made = beams(annuli.annuli, thickness=0.02)
for what, found in {"panels": cut, "annuli": annuli, "beams": made}.items():
    print(f"{what}: {len(found.report['rejected'])} rejected")
print(f"{cut.report['written']} panels, {made.report['written']} beams")

hexagonal = panels(hexagons.sphere_mesh, edges="intersection", joint_gap=0.012)
print(render(hexagonal.panels, "torus_hexagons.png", color_by="radius", width=1000, height=625))
print(render(cut.panels, "torus_remeshed.png", color_by="radius", width=1000, height=625))
print(write_step(cut.panels, "torus.step", beams=made.beams))
print(write_3dm(cut.panels, "torus.3dm", beams=made.beams))
print(write_dxf(made.beams, "torus_beams.dxf"))
