"""Fig. 21: a Willmore surface, in flat panels and in spheres."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh.kernel.panels.panels import panel_areas
from spheremesh.nodes import (
    apply_mobius,
    central_spheres,
    face_planes,
    fit_spheres,
    inversion,
    minimize_angles,
    torus_mesh,
)


def draw(*, small: bool = False) -> Figure:
    """A Möbius image of the Clifford torus: of all tori they have the least energy, 2 π²."""
    n, m = (24, 16) if small else (56, 36)
    torus = torus_mesh(n, m, float(np.sqrt(2)), 1.0)
    net = apply_mobius(torus, inversion([3.4, 0.6, 0.9], 3.0))
    smooth = minimize_angles(fit_spheres(net))
    made = cut(smooth.sphere_mesh)
    central = cut(central_spheres(net))
    energy = float((panel_areas(central) / central.radii**2).sum())
    angles = smooth.report["angles_deg"]
    planar, round_ = angles["planar"]["mean"], angles["spherical"]["mean"]
    zebra = {"shading": "zebra", "direction": (0.4, -0.8, 0.7)}
    return Figure(
        "Fig. 21",
        f"the spheres have the energy {energy:.2f} where the smooth surface has "
        f"2π² = {2 * np.pi**2:.2f}; they meet at {round_:.2f}° on average, planes at "
        f"{planar:.2f}°.",
        abs(energy / (2 * np.pi**2) - 1) < 0.1 and round_ < planar,
        [
            View("flat panels", cut(face_planes(net)), options=zebra),
            View("spheres", made, options=zebra),
        ],
    )


if __name__ == "__main__":
    run(draw)
