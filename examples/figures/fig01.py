"""Fig. 1: a freeform roof in flat panels, its support structure of annuli, and in spheres."""

from figure import Figure, View, cut, run

from spheremesh.nodes import (
    axis_support,
    beams,
    face_planes,
    fit_spheres,
    minimize_angles,
    roof_mesh,
)


def draw(*, small: bool = False) -> Figure:
    """The roof of the demo."""
    net = roof_mesh(8, 16) if small else roof_mesh(16, 34)
    smooth = minimize_angles(fit_spheres(net))
    support = axis_support(smooth.sphere_mesh, depth=1.2)
    frame = beams(support.annuli, thickness=0.15).beams
    angles, torsion = smooth.report["angles_deg"], support.report["torsion_deg"]["max"]
    flat, round_ = angles["planar"]["mean"], angles["spherical"]["mean"]
    view = {"direction": (0.5, -0.85, 0.55), "ground": True}
    return Figure(
        "Fig. 1",
        f"{net.n_faces} panels meet at {round_:.2f}° on average, where flat ones meet at "
        f"{flat:.2f}°; beams between node axes have a torsion of at most {torsion:.1e}°.",
        round_ < flat and torsion < 1e-3,
        [
            View("flat panels", cut(face_planes(net)), options=view),
            View("annuli that meet in node axes", beams=frame, options=view),
            View("spheres on the same mesh", cut(smooth.sphere_mesh), options=view),
        ],
        shape=0.7,
    )


if __name__ == "__main__":
    run(draw)
