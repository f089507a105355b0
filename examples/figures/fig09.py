"""Fig. 9: panels on an exact support; some are taken away to see the annuli below."""

from figure import Figure, View, cut, run

from spheremesh.kernel.parts.records import select_parts
from spheremesh.nodes import (
    axis_support,
    beams,
    common_axes,
    ellipsoid_mesh,
    exact_support,
    support_structure,
)


def draw(*, small: bool = False) -> Figure:
    """Half an ellipsoid."""
    net = ellipsoid_mesh(16, 8, 1.0, 0.8) if small else ellipsoid_mesh(28, 14, 1.0, 0.8)
    exact = exact_support(net).sphere_mesh
    torsion = float(support_structure(exact).torsion.max())
    axes = common_axes(exact)
    support = axis_support(exact, depth=0.12, axes=axes)
    made = cut(exact, edges="axis", axes=axes, thickness=0.01)
    frame = beams(support.annuli, thickness=0.015, panels=made).beams
    x, y, z = made.origins.T
    shown = select_parts(made, ~((y < 0) & (x > -0.15) & (z < 0.35)))
    return Figure(
        "Fig. 9",
        f"{net.n_faces} panels and {frame.n_beams} beams with a torsion of at most "
        f"{torsion:.0e}°.",
        torsion < 1e-6,
        [
            View(
                "some panels are taken away",
                shown,
                beams=frame,
                options={"direction": (0.3, -1, 0.35)},
            ),
            View("the support alone", beams=frame, options={"direction": (0.3, -1, 0.35)}),
        ],
    )


if __name__ == "__main__":
    run(draw)
