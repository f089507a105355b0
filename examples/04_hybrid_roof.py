"""A dome of triangles and quadrilaterals whose beams meet in axes: no torsion at any node."""

import numpy as np

import spheremesh as sm
from spheremesh.nodes import (
    annulus_support,
    beams,
    fit_spheres,
    minimize_angles,
    optimize_spheres,
    panels,
    render,
    support_structure,
    write_3dm,
    write_dxf,
)

# Rings of quadrilaterals and of triangles in turn; above each ring of triangles everything is
# turned by half a step.
AROUND, BANDS = 32, "QTQTQTQT"
latitudes = np.linspace(0.12, 1.25, len(BANDS) + 1)
steps = np.arange(AROUND)
vertices, faces, turned = [], [], 0.0
for ring, latitude in enumerate(latitudes):
    turns = 2 * np.pi * (steps + turned) / AROUND
    wave = 0.5 * np.cos(2 * turns) * np.cos(latitude)
    x, y = 13.5 * np.cos(latitude) * np.cos(turns), 10 * np.cos(latitude) * np.sin(turns)
    vertices.append(np.stack([x, y, 6 * np.sin(latitude) + wave], axis=1))
    if ring == len(BANDS):
        break
    a, b = ring * AROUND + steps, ring * AROUND + (steps + 1) % AROUND
    c, d = b + AROUND, a + AROUND
    if BANDS[ring] == "Q":
        faces += np.stack([a, b, c, d], axis=1).tolist()
    else:
        faces += np.stack([a, b, d], axis=1).tolist() + np.stack([b, c, d], axis=1).tolist()
        turned += 0.5
dome = sm.Mesh(np.concatenate(vertices), faces)

smooth = minimize_angles(fit_spheres(dome))
built = optimize_spheres(smooth.sphere_mesh, regularity=3.5, support=1, tolerance=0.05)
angles = built.report["angles_deg"]
print(f"{dome.n_faces} faces: {angles['planar']['mean']:.2f} degrees between plane panels,")
print(f"{angles['spherical']['mean']:.2f} between spheres whose nodes have axes;")
print(f"vertices moved by up to {built.report['vertex_move']:.3f} edges")
for name, spheres in {"before": smooth.sphere_mesh, "after": built.sphere_mesh}.items():
    nodes = support_structure(spheres).report
    print(
        f"{name}: torsion up to {nodes['torsion_deg']['max']:.2g} degrees, "
        f"tilt of beams up to {nodes['beam_tilt_deg']['max']:.2g}"
    )

annuli = annulus_support(built.sphere_mesh, depth=0.3)
made = beams(annuli.annuli, thickness=0.03)
cut = panels(built.sphere_mesh, edges="intersection", thickness=0.02)
print(f"{cut.report['written']} panels, {made.report['written']} beams")
print(write_3dm(cut.panels, "dome.3dm", beams=made.beams))
print(write_dxf(made.beams, "dome_beams.dxf"))
print(render(cut.panels, "dome.png"))
