"""Fig. 23: quadrilaterals and triangles in one mesh, for the smallest angles."""

from figure import Figure, View, cut, run

from spheremesh import Mesh
from spheremesh.nodes import face_planes, fit_spheres, minimize_angles, roof_mesh


def draw(*, small: bool = False) -> Figure:
    """The roof of the demo, every third row of faces cut into triangles."""
    n, m = (9, 12) if small else (21, 36)
    net = roof_mesh(n, m, 60.0)
    faces: list[list[int]] = []
    for number, face in enumerate(net.corners.reshape(-1, 4).tolist()):
        a, b, c, d = face
        is_cut = number // n % 3 == 1
        faces += [[a, b, c], [a, c, d]] if is_cut else [face]
    hybrid = Mesh(net.vertices, faces)
    smooth = minimize_angles(fit_spheres(hybrid))
    planar, round_ = (smooth.report["angles_deg"][k]["mean"] for k in ("planar", "spherical"))
    view = {"direction": (0.5, -0.8, 0.7), "ground": True}
    zebra = {"shading": "zebra", "direction": (0.5, -0.8, 0.7)}
    return Figure(
        "Fig. 23",
        f"{hybrid.n_faces} faces, of which {(hybrid.degrees == 3).sum()} triangles, meet at "
        f"{round_:.2f}° on average, their planes at {planar:.2f}°.",
        round_ < planar,
        [
            View("planes", cut(face_planes(hybrid)), options=view),
            View("spheres", cut(smooth.sphere_mesh), options=view),
            View("planes, reflections", cut(face_planes(hybrid)), options=zebra),
            View("spheres, reflections", cut(smooth.sphere_mesh), options=zebra),
        ],
        columns=2,
        shape=0.6,
    )


if __name__ == "__main__":
    run(draw)
