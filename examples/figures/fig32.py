"""Fig. 32: convex hexagons on spheres, also on a saddle; bow-ties where faces are planes."""

import numpy as np
from figure import Figure, View, cut, drawn_mesh, dual_mesh, run

from spheremesh.nodes import (
    annulus_support,
    beams,
    catenoid_mesh,
    classify_hexagons,
    evolve_spheres,
    shifted_rows,
    support_structure,
    tangent_sphere_shex,
    tangent_spheres,
    torus_mesh,
)

BELOW = (0.5, -0.8, -0.5)


def draw(*, small: bool = False) -> Figure:
    """A torus and a catenoid in convex hexagons; the catenoid in bow-ties, made on purpose."""
    torus_net, net = (
        (torus_mesh(36, 12, 2.0, 0.8), catenoid_mesh(40, 16, height=1.2))
        if small
        else (torus_mesh(72, 20, 2.0, 0.8), catenoid_mesh(64, 24, height=1.2))
    )
    torus = evolve_spheres(shifted_rows(torus_net))
    saddle = evolve_spheres(shifted_rows(net), side="minus")
    plain = shifted_rows(catenoid_mesh(*(40, 8) if small else (80, 16), height=1.2))
    ring, convex, flat = (
        tangent_sphere_shex(mesh, spheres).sphere_mesh
        for mesh, spheres in (
            (torus.mesh, torus.spheres),
            (saddle.mesh, saddle.spheres),
            (plain, tangent_spheres(plain, np.inf)),
        )
    )
    kinds = [classify_hexagons(each) for each in (convex, flat)]
    good, bad = (
        int((kind == name).sum())
        for kind, name in zip(kinds, ("convex", "bow-tie"), strict=True)
    )
    torsion = float(support_structure(convex).torsion.max())
    frame = beams(annulus_support(convex, depth=0.12).annuli, thickness=0.012).beams
    meet = {"edges": "intersection"}
    view = {"color_by": "radius"}
    return Figure(
        "Fig. 32",
        f"on the catenoid {good} of {len(kinds[0])} hexagons on spheres are convex, and {bad} "
        f"of {len(kinds[1])} planar ones bow-ties; torsion is at most {torsion:.0e}°.",
        good > 0.9 * len(kinds[0]) and bad > 0.9 * len(kinds[1]) and torsion < 1e-6,
        [
            View(
                "a torus in convex hexagons", cut(ring, joint_gap=0.008, **meet), options=view
            ),
            View(
                "a catenoid in convex hexagons",
                cut(convex, joint_gap=0.008, **meet),
                options=view,
            ),
            View("planar bow-ties, on purpose", cut(flat, **meet)),
            View("beams of the second", beams=frame),
            View("from below", cut(convex, **meet), beams=frame, options={"direction": BELOW}),
            View(
                "the mesh of centres", things=drawn_mesh(dual_mesh(convex.mesh, convex.centers))
            ),
        ],
        columns=3,
        shape=0.85,
    )


if __name__ == "__main__":
    run(draw)
