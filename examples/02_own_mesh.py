"""Without a graph: the nodes are plain functions. A mesh of mixed faces to .3dm and STEP."""

import numpy as np

import spheremesh as sm
from spheremesh.nodes import fit_spheres, minimize_angles, panels, write_3dm, write_step

# A dome of quadrilaterals around a hexagonal eye closed by triangles.
turns = np.linspace(0, 2 * np.pi, 6, endpoint=False)
rings = [(3.0, 0.0), (2.2, 1.1), (1.1, 1.8)]
vertices = [[r * np.cos(t), r * np.sin(t), z] for r, z in rings for t in turns]
vertices.append([0.0, 0.0, 2.1])
faces = [
    [6 * ring + i, 6 * ring + (i + 1) % 6, 6 * ring + 6 + (i + 1) % 6, 6 * ring + 6 + i]
    for ring in range(2)
    for i in range(6)
]
faces += [[12 + i, 12 + (i + 1) % 6, 18] for i in range(6)]
dome = sm.Mesh(vertices, faces)

optimum = minimize_angles(fit_spheres(dome))
angles = optimum.report["angles_deg"]
print(f"{angles['planar']['mean']:.1f} -> {angles['spherical']['mean']:.1f} degrees")

made = panels(optimum.sphere_mesh, thickness=0.03)
print(f"{made.report['written']} panels, rejected: {made.report['rejected']}")
print(write_step(made.panels, "dome.step"), write_3dm(made.panels, "dome.3dm"))
