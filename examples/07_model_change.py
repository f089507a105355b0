"""A vase of even triangles, bent three ways: each with beams that all point to one place."""

import numpy as np

from spheremesh.nodes import (
    intersection_angles,
    model_change,
    panels,
    remesh_triangles,
    sphere_bundle,
    support_type,
    vase_mesh,
    write_3dm,
)

vase = remesh_triangles(vase_mesh(48, 36, amplitude=0.35), edge_length=0.42)
middle = vase.vertices.mean(axis=0)
shapes = {
    "hyperbolic": model_change(vase, "hyperbolic", radius=2.0, center=middle),
    "elliptic": model_change(vase, "elliptic", radius=1.0, center=middle),
    "bundle": sphere_bundle(vase, center=middle + np.array([-2.4, -2.4, 1.2]), radius=3.0),
}
for name, shape in shapes.items():
    found = support_type(shape)
    center = np.round(found.omega[1:4] / (2 * found.omega[0]), 3)
    planes = intersection_angles(shape, reference="planes").mean()
    spheres = intersection_angles(shape).mean()
    made = panels(shape, thickness=0.01)
    print(
        f"{name}: {found.kind}, all beams point to {center}; {planes:.1f} -> {spheres:.1f} "
        f"degrees between panels; {write_3dm(made.panels, f'{name}.3dm')}"
    )
