"""Fig. 16: planar hexagons in the absolute sphere, and their two images under δ."""

import numpy as np
from figure import GREEN, GREY, Figure, View, cut, drawn_mesh, run

from spheremesh import Mesh
from spheremesh.nodes import (
    apply_mobius,
    ellipsoid_mesh,
    inversion,
    model_change,
    shifted_rows,
    sphere_rows,
    tangent_sphere_shex,
    tangent_spheres,
)
from spheremesh.viewer.shapes import sphere_shape


def planar_hexagons(n: int, m: int, *shape: float) -> Mesh:
    """Tangent planes of an ellipsoid, which meet in planar hexagons."""
    triangles = shifted_rows(ellipsoid_mesh(n, m, *shape))
    return tangent_sphere_shex(triangles, tangent_spheres(triangles, np.inf)).sphere_mesh.mesh


def draw(*, small: bool = False) -> Figure:
    """A small net of planar hexagons, inside the absolute sphere."""
    net = planar_hexagons(*((24, 6) if small else (40, 10)), 0.5, 0.6)
    inner, outer = (model_change(net, "hyperbolic", 1.0, branch=b) for b in ("inner", "outer"))
    again = apply_mobius(inner.mesh.vertices, inversion([0.0, 0, 0], 1.0))
    miss = float(np.abs(again - outer.mesh.vertices).max())
    absolute = sphere_shape(sphere_rows([[0.0, 0, 0]], [1.0]), GREY, is_veil=True)
    view = {"direction": (0.4, -1.0, 0.3)}
    return Figure(
        "Fig. 16",
        f"the inversion in the absolute sphere carries one image of {net.n_faces} planar "
        f"hexagons to the other within {miss:.0e}.",
        miss < 1e-9,
        [
            View("planar hexagons", things=[absolute, *drawn_mesh(net, GREEN)], options=view),
            View("the image inside", cut(inner), things=[absolute], options=view),
            View("the image outside", cut(outer), things=[absolute], options=view),
        ],
    )


if __name__ == "__main__":
    run(draw)
