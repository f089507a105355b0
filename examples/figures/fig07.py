"""Fig. 7: annuli that meet in a node axis, and annuli of a node with some torsion."""

import numpy as np
from figure import RED, SAND, Figure, View, run

from spheremesh import Mesh
from spheremesh.kernel.parts.records import select_parts
from spheremesh.nodes import (
    annulus_support,
    fit_spheres,
    minimize_angles,
    optimize_spheres,
    roof_mesh,
    support_structure,
)
from spheremesh.viewer.shapes import axis_shape, mesh_shape


def draw(*, small: bool = False) -> Figure:
    """A roof whose spheres are best for angles, and best with a support structure."""
    net = roof_mesh(5, 7, 10.0) if small else roof_mesh(10, 16, 12.0)
    free = minimize_angles(fit_spheres(net)).sphere_mesh
    loose = optimize_spheres(free, regularity=0.5).sphere_mesh
    built = optimize_spheres(free, regularity=3.5, support=1.0, tolerance=0.05).sphere_mesh
    views, torsions = [], []
    for caption, spheres in (("a node axis", built), ("some torsion", loose)):
        found = support_structure(spheres)
        torsions.append(float(found.torsion.max()))
        annuli = annulus_support(spheres, depth=0.5).annuli
        whole = np.bincount(annuli.edge_vertices.ravel(), minlength=net.n_vertices) >= 3
        wanted = np.where(
            whole, found.torsion if spheres is loose else net.vertices[:, 2], -9.0
        )
        vertex = int(np.argmax(wanted))
        star = select_parts(annuli, (annuli.edge_vertices == vertex).any(axis=1))
        strips = star.to_trimesh()
        along = np.diff(found.axes[vertex], axis=0)[0]
        along *= 0.9 / np.linalg.norm(along)
        line = net.vertices[vertex] + np.stack([-along, along])
        views.append(
            View(
                f"{caption}: {found.torsion[vertex]:.1g}°",
                things=[
                    mesh_shape(Mesh(strips.vertices, strips.faces), SAND),
                    axis_shape(line[None], 0.015, RED),
                ],
                options={"direction": (0.5, -0.8, 0.7)},
            )
        )
    return Figure(
        "Fig. 7",
        f"torsion is at most {torsions[0]:.0e}° where it is asked to vanish, and up to "
        f"{torsions[1]:.1f}° where it is not.",
        torsions[0] < 1e-4 < torsions[1],
        views,
    )


if __name__ == "__main__":
    run(draw)
