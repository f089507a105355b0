"""Strips: panels join smoothly along one family of lines, not along the other (Fig. 25)."""

import numpy as np

from spheremesh.nodes import (
    catenoid_mesh,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    panels,
    render,
    strip_weights,
)

net = catenoid_mesh(n_around=30, n_across=18)
start = fit_spheres(net)
for direction, where in enumerate(("around the axis", "along the axis")):
    weights = strip_weights(net, direction)
    strips = minimize_angles(start, edge_weights=weights).sphere_mesh
    angles = intersection_angles(strips)
    print(
        f"strips {where}: {angles[weights > 0].max():.1e} degrees at most within a strip, "
        f"{angles[weights == 0].mean():.1f} on average from strip to strip"
    )
    if direction == 0:
        centers = strips.spheres[:, 1:4] / (2 * strips.spheres[:, :1])
        off_axis = np.linalg.norm(centers[:, :2], axis=1).max()
        print(f"their centres are at most {off_axis:.1e} off the axis")
    made = panels(strips)
    print(render(made.panels, f"strips_{direction}.png", shading="zebra"))
