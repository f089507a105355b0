"""Fig. 29: a torus of hexagons remeshed by quadrilaterals, which are planar in P4."""

from figure import GREEN, SAND, Figure, View, cut, drawn_mesh, dual_mesh, run

from spheremesh.nodes import (
    evolve_spheres,
    p4_remesh,
    pentaspherical_coordinates,
    shifted_rows,
    support_structure,
    tangent_sphere_shex,
    torus_mesh,
)


def draw(*, small: bool = False) -> Figure:
    """Tangent spheres of a torus, along their conjugate directions."""
    n, m, edge = (48, 16, 0.9) if small else (72, 24, 0.6)
    grown = evolve_spheres(shifted_rows(torus_mesh(n, m, 2.0, 0.9)), max_axis_angle=15)
    hexagons = tangent_sphere_shex(grown.mesh, grown.spheres).sphere_mesh
    net = p4_remesh(grown.mesh, grown.spheres, edge)
    quads = net.sphere_mesh
    planarity = net.report["planarized"]["planarity"]["after"]
    torsion = float(support_structure(quads).torsion.max())
    x = pentaspherical_coordinates(quads.spheres)
    x = x[:, :4] / x[:, 4:]
    return Figure(
        "Fig. 29",
        f"{quads.mesh.n_faces} faces; in P4 their duals are planar within {planarity:.0e}, and "
        f"nodes have a torsion of at most {torsion:.0e}°.",
        planarity < 1e-6 and torsion < 1e-3,
        [
            View("hexagons", cut(hexagons, edges="intersection")),
            View("remeshed by quadrilaterals", cut(quads, edges="intersection")),
            View(
                "centres of hexagons",
                things=drawn_mesh(dual_mesh(hexagons.mesh, hexagons.centers)),
            ),
            View(
                "centres of quadrilaterals",
                things=drawn_mesh(dual_mesh(quads.mesh, quads.centers)),
            ),
            View(
                "P4, x1 x2 x3", things=drawn_mesh(dual_mesh(quads.mesh, x[:, [0, 1, 2]]), SAND)
            ),
            View(
                "P4, x1 x2 x4", things=drawn_mesh(dual_mesh(quads.mesh, x[:, [0, 1, 3]]), GREEN)
            ),
        ],
        columns=3,
        shape=0.8,
    )


if __name__ == "__main__":
    run(draw)
