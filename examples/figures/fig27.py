"""Fig. 27: central spheres reflected in their faces, as a start for the smallest angles."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh import SphereMesh
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.nodes import (
    central_spheres,
    face_planes,
    intersection_angles,
    minimize_angles,
    vase_mesh,
)


def draw(*, small: bool = False) -> Figure:
    """A vase with spheres on the wrong side, and what becomes of them."""
    net = vase_mesh(14, 9) if small else vase_mesh(22, 14)
    central = central_spheres(net)
    planes, rows = face_planes(net).local_spheres, central.local_spheres
    turned = 2 * minkowski(rows, planes)[:, None] * planes - rows
    spiky = SphereMesh.from_local(net, turned)
    best, again = minimize_angles(central), minimize_angles(spiky)
    angles = [float(intersection_angles(each).mean()) for each in (spiky, central)]
    ends = [each.report["angles_deg"]["spherical"]["mean"] for each in (again, best)]
    apart = float(
        np.abs(again.sphere_mesh.local_spheres - best.sphere_mesh.local_spheres).max()
    )
    return Figure(
        "Fig. 27",
        f"reflected spheres meet at {angles[0]:.1f}° on average, central ones at "
        f"{angles[1]:.1f}°; from both starts the search ends at {ends[0]:.3f}° and "
        f"{ends[1]:.3f}°, with spheres that differ by {apart:.0e}: ours runs into no trap.",
        abs(ends[0] - ends[1]) < 1e-3 < angles[0] - angles[1],
        [
            View("reflected in their faces", cut(spiky)),
            View("smallest angles from there", cut(again.sphere_mesh)),
            View("smallest angles from central spheres", cut(best.sphere_mesh)),
        ],
    )


if __name__ == "__main__":
    run(draw)
