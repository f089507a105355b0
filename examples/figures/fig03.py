"""Fig. 3: a semi-regular mesh of triangles and hexagons, on spheres."""

from figure import Figure, View, cut, run

from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.nodes import (
    face_planes,
    intersection_angles,
    semiregular_pattern,
    vase_mesh,
    vertex_error,
)


def draw(*, small: bool = False) -> Figure:
    """Triangles and hexagons on a vase, two of each around a vertex."""
    vase = vase_mesh(24, 18, 1.2, 2.6, 0.25) if small else vase_mesh(64, 48, 1.2, 2.6, 0.25)
    found = semiregular_pattern(vase, 0.5 if small else 0.19)
    spheres, net = found.sphere_mesh, found.sphere_mesh.mesh
    miss = float(vertex_error(spheres).max() / mean_edge_length(net))
    flat = intersection_angles(spheres, reference="planes").mean()
    angle = intersection_angles(spheres).mean()
    triangles, hexagons = (int((net.degrees == degree).sum()) for degree in (3, 6))
    return Figure(
        "Fig. 3",
        f"{triangles} triangles and {hexagons} hexagons ({net.n_faces} faces with those that the "
        f"boundary cuts) meet at {angle:.2f}° on average, their planes at {flat:.2f}°; vertices "
        f"are off their spheres by {miss:.1%} of an edge at most.",
        bool(angle < flat),
        [
            View("planes", cut(face_planes(net))),
            View("spheres", cut(spheres)),
        ],
    )


if __name__ == "__main__":
    run(draw)
