"""Fig. 3: a semi-regular mesh of triangles and hexagons, on spheres."""

from figure import Figure, View, cut, run

from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.nodes import (
    face_planes,
    intersection_angles,
    roof_mesh,
    semiregular_pattern,
    vertex_error,
)


def draw(*, small: bool = False) -> Figure:
    """Triangles and hexagons on a roof, two of each around a vertex."""
    found = semiregular_pattern(roof_mesh(), 4.0 if small else 1.8)
    spheres, net = found.sphere_mesh, found.sphere_mesh.mesh
    miss = float(vertex_error(spheres).max() / mean_edge_length(net))
    flat = intersection_angles(spheres, reference="planes").mean()
    angle = intersection_angles(spheres).mean()
    triangles, hexagons = (int((net.degrees == degree).sum()) for degree in (3, 6))
    return Figure(
        "Fig. 3",
        f"{triangles} triangles and {hexagons} hexagons ({net.n_faces} faces with those that "
        f"the boundary cuts) meet at {angle:.2f}° on average, their planes at {flat:.2f}°; "
        f"vertices are off their spheres by {miss:.0%} of an edge at most.",
        bool(angle < flat),
        [
            View("planes", cut(face_planes(net))),
            View("spheres", cut(spheres)),
        ],
        columns=1,
        shape=0.4,
    )


if __name__ == "__main__":
    run(draw)
