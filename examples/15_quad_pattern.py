"""A design surface covered with quads: what spheres will gain, the net, panels and beams."""

import numpy as np

import spheremesh as sm
from spheremesh.nodes import (
    axis_support,
    beams,
    cluster_radii,
    face_planes,
    node_axes,
    panels,
    quad_pattern,
    render,
    sphere_gain,
    write_3dm,
)

EDGE = 1.5

# A canopy of 16 by 11 metres; its mesh is only the carrier of the shape.
x, y = np.meshgrid(np.linspace(-8, 8, 65), np.linspace(-5.5, 5.5, 45), indexing="ij")
z = -0.035 * x**2 - 0.018 * y**2 + 0.25 * np.sin(x / 3)
ids = np.arange(x.size).reshape(x.shape)
faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
canopy = sm.Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))

expected = sphere_gain(canopy, EDGE).report
print(f"expected: {expected['advice']}")

net, report = quad_pattern(canopy, EDGE)
for tried in report["tries"]:
    print(f"  curvature {tried['curvature']:.3f}: {tried['status']}")
angles = report["angles_deg"]
print(
    f"{report['status']}: {report['faces']['count']} faces, {angles['planes']:.2f} degrees "
    f"with planes, {angles['spheres']:.2f} with spheres, {angles['expected']:.2f} expected"
)

moulds = cluster_radii(net, 3)
support = axis_support(moulds.sphere_mesh, depth=0.3, axes=node_axes(net))
cut = panels(
    moulds.sphere_mesh, edges="axis", axes=support.axes, labels=moulds.labels, thickness=0.04
)
made = beams(support.annuli, thickness=0.04, panels=cut.panels)
for found in (cut, support, made):
    for entry in found.report["rejected"]:
        print(f"  {entry['id']}: {entry['reason']}")
print(f"{cut.report['written']} panels, {made.report['written']} beams")
flat = panels(face_planes(net.mesh)).panels
print(render(flat, "canopy_planes.png", color_by="none", width=800, height=500))
print(render(cut.panels, "canopy_spheres.png", width=800, height=500))
print(write_3dm(cut.panels, "canopy.3dm", beams=made.beams, reference=canopy))
