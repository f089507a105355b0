"""A freeform roof with singular points, its net, panels, and beams that meet in axes."""

import numpy as np

import spheremesh as sm
from spheremesh.nodes import (
    annulus_support,
    beams,
    conjugate_directions,
    evolve_spheres,
    p4_remesh,
    panels,
    render,
    support_structure,
    triangulate,
    write_3dm,
    write_dxf,
)

EDGE = 1.8

# Two waves over a hall of 40 by 26 metres.
x, y = np.meshgrid(np.linspace(-20, 20, 65), np.linspace(-13, 13, 43), indexing="ij")
z = 6 * np.exp(-(((x - 8) / 8) ** 2) - ((y - 2) / 14) ** 2)
z += 5 * np.exp(-(((x + 9) / 8) ** 2) - ((y + 3) / 15) ** 2)
ids = np.arange(x.size).reshape(x.shape)
faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
roof = triangulate(sm.Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4)))

# Spheres above the roof, as large as node axes within 15 degrees of the normals let them be.
grown = evolve_spheres(roof, max_axis_angle=15, side="plus")
expected = conjugate_directions(grown.mesh, grown.spheres).report
print(
    f"complex on {100 * expected['complex_share']:.2f} % of the area, "
    f"{len(expected['singular'])} singular points, edges up to {expected['largest_edge']:.1f} m"
)

net = p4_remesh(grown.mesh, grown.spheres, EDGE)
planar = net.report["planarized"]
print(f"faces by degree {net.report['faces']['degrees']}, {net.report['flipped']} flips")
print(
    f"nodes planar to {planar['planarity']['after']:.0e}, on their spheres to "
    f"{planar['corner_gap']['after']:.0e} edges, shortest edge "
    f"{planar['shortest_edge']['after']:.2f} of the mean"
)
nodes = support_structure(net.sphere_mesh).report
print(f"torsion inside up to {nodes['torsion_deg']['max']:.0e} degrees")
for entry in nodes["invalid"]:
    print(f"  {entry['id']}: {entry['reason']}")

cut = panels(net.sphere_mesh, edges="intersection", thickness=0.06, joint_gap=0.04)
annuli = annulus_support(net.sphere_mesh, depth=0.35)
made = beams(annuli.annuli, thickness=0.06)
for found in (cut, annuli, made):
    for entry in found.report["rejected"]:
        print(f"  {entry['id']}: {entry['reason']}")
print(f"{cut.report['written']} panels, {made.report['written']} beams")
print(render(cut.panels, "roof_remeshed.png", color_by="radius", width=1800, height=840))
print(write_3dm(cut.panels, "roof.3dm", beams=made.beams))
print(write_dxf(made.beams, "roof_beams.dxf", sheet=(6000, 2000)))
