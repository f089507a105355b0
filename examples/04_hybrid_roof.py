"""A roof of triangles and quadrilaterals on beams that meet in axes: no torsion at any node."""

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
    roof_mesh,
    support_structure,
    write_3dm,
    write_dxf,
)

net = roof_mesh(12, 28)
faces = []
for i, (a, b, c, d) in enumerate(map(np.ndarray.tolist, net.faces)):
    row = i // 28
    # Bands of triangles between bands of quadrilaterals.
    faces += [[a, b, c], [a, c, d]] if row % 3 == 1 else [[a, b, c, d]]
hybrid = sm.Mesh(net.vertices, faces)

smooth = minimize_angles(fit_spheres(hybrid))
built = optimize_spheres(smooth.sphere_mesh, regularity=3.5, support=1)
angles = built.report["angles_deg"]
print(f"{hybrid.n_faces} faces: {angles['planar']['mean']:.2f} degrees between plane panels,")
print(f"{smooth.report['angles_deg']['spherical']['mean']:.2f} between spheres at their best,")
print(f"{angles['spherical']['mean']:.2f} between spheres whose nodes have an axis")

for name, spheres in {"before": smooth.sphere_mesh, "after": built.sphere_mesh}.items():
    nodes = support_structure(spheres).report
    print(
        f"{name}: torsion up to {nodes['torsion_deg']['max']:.3g} degrees, "
        f"tilt of beams mostly below {nodes['beam_tilt_deg']['p95']:.2g}"
    )

annuli = annulus_support(built.sphere_mesh, depth=0.3)
made = beams(annuli.annuli, thickness=0.03)
cut = panels(built.sphere_mesh, edges="intersection", thickness=0.02)
print(f"{cut.report['written']} panels, {made.report['written']} beams")
print(write_3dm(cut.panels, "hybrid_roof.3dm", beams=made.beams))
print(write_dxf(made.beams, "hybrid_beams.dxf"))
print(render(cut.panels, "hybrid_roof.png"))
