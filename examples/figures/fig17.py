"""Fig. 17: triangles and hexagons on spheres, from a model change of hyperbolic geometry."""

from fig16 import planar_hexagons
from figure import Figure, View, cut, run

from spheremesh.nodes import (
    face_planes,
    model_change,
    remesh_triangles,
    support_structure,
    vase_mesh,
)


def draw(
    *,
    small: bool = False,
    geometry: str = "hyperbolic",
    radius: float = 2.2,
    name: str = "Fig. 17",
) -> Figure:
    """A vase of triangles and an ellipsoid of hexagons, flat and changed."""
    vase = remesh_triangles(vase_mesh(48, 36, 1.0, 3.0, 0.3), 0.6 if small else 0.34)
    hexagons = planar_hexagons(*((24, 6) if small else (48, 12)), 1.0, 1.2)
    changed = [
        model_change(net, geometry, radius, net.vertices.mean(axis=0))
        for net in (vase, hexagons)
    ]
    torsion = max(float(support_structure(each).torsion.max()) for each in changed)
    return Figure(
        name,
        f"{changed[0].mesh.n_faces} triangles and {changed[1].mesh.n_faces} hexagons have a "
        f"support structure with a torsion of at most {torsion:.0e}°.",
        torsion < 1e-6,
        [
            View("flat triangles", cut(face_planes(vase))),
            View("triangles on spheres", cut(changed[0])),
            View("planar hexagons", cut(face_planes(hexagons))),
            View("hexagons on spheres", cut(changed[1])),
        ],
        shape=1.15,
    )


if __name__ == "__main__":
    run(draw)
