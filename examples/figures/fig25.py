"""Fig. 25: strips: spheres that join smoothly along one family of lines only."""

from figure import Figure, View, cut, run

from spheremesh.nodes import (
    catenoid_mesh,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    strip_weights,
)


def draw(*, small: bool = False) -> Figure:
    """Strips around a catenoid and along it, beside the smallest angles everywhere."""
    net = catenoid_mesh(18, 10) if small else catenoid_mesh(32, 18)
    start = fit_spheres(net)
    free = minimize_angles(start)
    zebra = {"shading": "zebra"}
    views = [View("the smallest angles everywhere", cut(free.sphere_mesh), options=zebra)]
    within, across = [], []
    for direction, where in enumerate(("around", "along")):
        weights = strip_weights(net, direction)
        strips = minimize_angles(start, edge_weights=weights).sphere_mesh
        angles = intersection_angles(strips)
        within.append(float(angles[weights > 0].max()))
        across.append(float(angles[weights == 0].mean()))
        views.append(View(f"strips {where} the axis", cut(strips), options=zebra))
    return Figure(
        "Fig. 25",
        f"strips around the axis meet at {within[0]:.0e}° at most within and at "
        f"{across[0]:.1f}° from strip to strip; along the axis at {within[1]:.2f}° and "
        f"{across[1]:.1f}°.",
        within[0] < 1e-3 < across[0],
        views,
    )


if __name__ == "__main__":
    run(draw)
