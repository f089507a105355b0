"""Fig. 3: a semi-regular mesh of triangles and hexagons, on spheres."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh import Mesh
from spheremesh.kernel.meshes.mesh import corner_edges, edge_ends
from spheremesh.kernel.meshes.vertex_fans import vertex_fans
from spheremesh.nodes import (
    catenoid_mesh,
    face_planes,
    fit_spheres,
    intersection_angles,
    optimize_spheres,
    shifted_rows,
    vertex_error,
)


def rectified(triangles: Mesh) -> Mesh:
    """A vertex in the middle of each edge, a face in each triangle and around each vertex."""
    edges, topology = corner_edges(triangles), triangles.topology
    middles = triangles.vertices[edge_ends(triangles, edges)].mean(axis=1)
    fans = vertex_fans(topology, triangles.corners, np.unique(triangles.corners))
    rings = np.split(edges[fans.corners], fans.offsets[1:-1])
    whole = [ring for ring, closed in zip(rings, fans.is_closed, strict=True) if closed]
    return Mesh(middles, [*edges.reshape(-1, 3), *whole])


def draw(*, small: bool = False) -> Figure:
    """Triangles and hexagons on a catenoid, two of each around a vertex."""
    triangles = shifted_rows(catenoid_mesh(14, 6) if small else catenoid_mesh(60, 24))
    net = rectified(triangles)
    found = optimize_spheres(fit_spheres(net), sphericity=30.0, tolerance=0.08)
    spheres = found.sphere_mesh
    miss = float(vertex_error(spheres).max())
    flat = intersection_angles(spheres, reference="planes").mean()
    angle = intersection_angles(spheres).mean()
    hexagons = int((net.degrees == 6).sum())
    return Figure(
        "Fig. 3",
        f"{net.n_faces - hexagons} triangles and {hexagons} hexagons, whose vertices are on "
        f"their spheres within {miss:.0e}, meet at {angle:.2f}° on average; their planes at "
        f"{flat:.2f}°.",
        bool(angle < flat),
        [
            View("planes", cut(face_planes(spheres.mesh))),
            View("spheres", cut(spheres)),
        ],
    )


if __name__ == "__main__":
    run(draw)
