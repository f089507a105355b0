"""Fig. 20: a free form of triangles, flat and in spheres, in the reflection of a street."""

from figure import Figure, View, cut, run

from spheremesh.nodes import (
    face_planes,
    fit_spheres,
    minimize_angles,
    remesh_triangles,
    vase_mesh,
)


def draw(*, small: bool = False) -> Figure:
    """A blob of nearly equilateral triangles, with and without lines along its edges."""
    net = remesh_triangles(vase_mesh(48, 36, 1.2, 2.6, 0.25), 0.5 if small else 0.22)
    smooth = minimize_angles(fit_spheres(net))
    angles = smooth.report["angles_deg"]
    flat, spheres = cut(face_planes(net)), cut(smooth.sphere_mesh)
    views = [
        View(f"{kind}, {lines}", made, options={"shading": "mirror", "edges": lines == "edges"})
        for kind, made in (("flat", flat), ("spheres", spheres))
        for lines in ("edges", "no edges")
    ]
    planar, round_ = angles["planar"]["mean"], angles["spherical"]["mean"]
    return Figure(
        "Fig. 20",
        f"{net.n_faces} triangles meet at {planar:.2f}° on average, spheres on them at "
        f"{round_:.2f}°.",
        round_ < planar,
        views,
        columns=4,
        shape=1.2,
    )


if __name__ == "__main__":
    run(draw)
