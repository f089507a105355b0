"""Convex hexagons on a torus, a catenoid and a saddle: panels, files and pictures."""

import numpy as np

import spheremesh as sm
from spheremesh.nodes import (
    catenoid_mesh,
    evolve_spheres,
    panels,
    render,
    shifted_rows,
    tangent_sphere_shex,
    torus_mesh,
    write_step,
)


def saddle(n: int, m: int) -> sm.Mesh:
    """Quadrilaterals of a saddle roof over a square."""
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, m + 1), indexing="ij")
    ids = np.arange(x.size).reshape(x.shape)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    points = np.stack([x, y, 0.4 * (x**2 - y**2)], -1)
    return sm.Mesh(points.reshape(-1, 3), faces.reshape(-1, 4))


graph = sm.Graph("hexagons", units="m")
nets = {
    "torus": graph.add(torus_mesh, n_around=72, n_across=20, minor_radius=0.8),
    "catenoid": graph.add(catenoid_mesh, n_around=64, n_across=24, height=1.2),
    "saddle": saddle(44, 26),
}
# The side of the centres, and whether edges may be flipped: without, spheres stay smaller.
choices = {"torus": ("auto", True), "catenoid": ("minus", True), "saddle": ("plus", False)}

for name, net in nets.items():
    side, flips = choices[name]
    triangles = graph.add(shifted_rows, mesh=net)
    grown = graph.add(evolve_spheres, mesh=triangles, side=side, flips=flips)
    hexagons = graph.add(tangent_sphere_shex, mesh=grown.mesh, spheres=grown.spheres)
    cut = graph.add(
        panels, sphere_mesh=hexagons.sphere_mesh, edges="intersection", joint_gap=0.006
    )
    found, shapes = graph.run(grown.report), graph.run(hexagons.report)
    print(
        f"{name}: {shapes['convex']} of {shapes['faces']} faces convex, "
        f"{shapes['degrees'].get('6', 0)} hexagons; node axes within "
        f"{found['axis_angle_deg']['max']:.1f} degrees of upright, spheres reach "
        f"{found['lambda_over_rho']['mean']:.2f} of the curvature radius"
    )
    for entry in found["bad_faces"]:
        print(f"  at vertex {entry['vertex']}: {entry['reason']}")
    print(f"  {graph.run(cut.report)['written']} panels")
    picture = graph.add(
        render, panels=cut.panels, path=f"{name}.png", color_by="radius", width=640, height=448
    )
    print(f"  wrote {graph.run(picture)}")
    if name == "saddle":
        print(
            f"  wrote {graph.run(graph.add(write_step, panels=cut.panels, path='saddle.step'))}"
        )
