"""Patterns on even triangles: the triangles themselves, and the hexagons dual to them."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ..errors import ConvergenceError, InputError
from ..hexagons.dual_sphere_mesh import BoundaryRule, dual_sphere_mesh
from ..hexagons.evolution import evolve_spheres
from ..meshes.mesh import Mesh
from ..optimization.angle_minimization import minimize_angles
from ..sphere_meshes.fit import fit_spheres
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..surfaces.surface import Surface
from ..tolerances import CREASE, OPENING
from .gain_report import check_edge
from .net_flaws import Flaw, PatternJudgement, judge_faces
from .panel_scale import even_triangles
from .polishing import polish

BOUNDS: Final = (2.0, 3.0, 5.0, 9.0, 15.0, 20.0, 30.0)
"""Bounds on the angle of node axes, in degrees: a looser one takes all tighter ones along."""

GROWTHS = 2
"""How often spheres grow with one bound at most."""

LEAN_SLACK = 0.1
"""Degrees by which an axis may pass its bound."""

SHORTEST_HEXAGON_EDGE = 0.1
"""Least edge of a hexagon, in mean edges."""


@dataclass(frozen=True)
class DualTry:
    """Hexagons grown with one bound.

    Attributes
    ----------
    bound : float
        Largest angle of node axes with the normals, in degrees.
    net : SphereMesh or None
    judgement : PatternJudgement or None
    message : str
        Why there are none.
    """

    bound: float
    net: SphereMesh | None
    judgement: PatternJudgement | None
    message: str


def triangle_pattern(
    source: Mesh | Surface, edge: float
) -> tuple[SphereMesh, PatternJudgement]:
    """Triangles of nearly one size, with the spheres that meet most smoothly.

    Raises
    ------
    InputError
        If the length is not positive, or the triangles would be too many.
    """
    check_edge(edge)
    start = fit_spheres(even_triangles(_mesh_of(source), edge))
    net, _ = minimize_angles(start, crease=CREASE, max_opening=OPENING)
    return net, judge_faces(net, "bisector", convex=False)


def hexagon_pattern(
    source: Mesh | Surface, edge: float, bound: float, boundary: BoundaryRule
) -> tuple[DualTry, list[DualTry]]:
    """Convex hexagons: the smoothest over a fixed grid of bounds, and all that were tried.

    Parameters
    ----------
    source : Mesh or Surface
    edge : float
        Length of the edges; the triangles under the hexagons are √3 times as large.
    bound : float
        Largest angle of node axes with the normals, in degrees.
    boundary : {"drop", "clip"}

    Raises
    ------
    InputError
        If an option is out of range, or no hexagons can be made.
    """
    tries = hexagon_tries(source, edge, bound, boundary)
    best = smoothest_within(tries, bound)
    if best.net is None:
        raise InputError(f"no hexagons can be made on this surface: {best.message}")
    return best, [_bounded(found, bound) for found in tries]


def hexagon_tries(
    source: Mesh | Surface, edge: float, bound: float, boundary: BoundaryRule
) -> list[DualTry]:
    """Convex hexagons grown with each bound of a fixed grid that is no looser.

    Parameters and errors as for `hexagon_pattern`.

    Notes
    -----
    Polishing turns axes by a few degrees. Where the result has flaws, and with the tightest
    bound if it is passed, spheres grow once more: polished vertices lie better for it. Below
    all of the grid the bound and its half are tried.
    """
    if not 0 < bound < 90:
        raise InputError(f"the largest angle of an axis lies between 0 and 90, not {bound:g}")
    check_edge(edge)
    surface = _mesh_of(source)
    triangles = even_triangles(surface, np.sqrt(3) * edge)
    bounds = [each for each in BOUNDS if each <= bound] or [bound / 2, bound]
    return [
        found
        for each in bounds
        for found in _grown(triangles, surface, each, boundary, is_first=each == bounds[0])
    ]


def smoothest_within(tries: list[DualTry], bound: float) -> DualTry:
    """The best of hexagons within a bound on the axes, in degrees.

    Notes
    -----
    What was grown with a tighter bound may just keep this one, and what does not keep it is no
    choice. The grid is nested, so a looser bound never makes hexagons rougher. Without flaws
    comes before fewer flaws, then axes that pass the bound by less, then smaller angles.
    """
    return min(
        (_bounded(found, bound) for found in tries), key=lambda each: _badness(each, bound)
    )


def _mesh_of(source: Mesh | Surface) -> Mesh:
    return source.mesh if isinstance(source, Surface) else source


def _grown(
    triangles: Mesh, surface: Mesh, bound: float, boundary: BoundaryRule, *, is_first: bool
) -> list[DualTry]:
    """Hexagons grown with one bound and polished; grown anew from there if that may help."""
    found: list[DualTry] = []
    for _ in range(GROWTHS):
        try:
            grown = polish(evolve_spheres(triangles, float(np.radians(bound))), surface)
            net = dual_sphere_mesh(grown.mesh, grown.spheres, boundary).sphere_mesh
            judgement = judge_faces(
                net, "intersection", convex=True, shortest=SHORTEST_HEXAGON_EDGE
            )
        except (InputError, ConvergenceError) as error:
            return [*found, DualTry(bound, None, None, str(error))]
        judgement = replace(
            judgement,
            lean_p95=float(np.percentile(grown.axis_angles, 95)),
            lean_max=float(grown.axis_angles.max()),
        )
        found.append(DualTry(bound, net, judgement, ""))
        keeps = np.degrees(judgement.lean_max) <= bound + LEAN_SLACK
        if judgement.is_usable and (keeps or not is_first):
            break
        triangles = grown.mesh
    return found


def _bounded(found: DualTry, bound: float) -> DualTry:
    """A try with a flaw if its axes pass a bound, in degrees."""
    judgement = found.judgement
    if judgement is None or np.degrees(judgement.lean_max) <= bound + LEAN_SLACK:
        return found
    lean = np.degrees(judgement.lean_max)
    flaw = Flaw(None, f"node axes lean by up to {lean:.1f} degrees, not {bound:g}")
    return replace(found, judgement=replace(judgement, flaws=(*judgement.flaws, flaw)))


def _badness(found: DualTry, bound: float) -> tuple[bool, int, float, float]:
    judgement = found.judgement
    if judgement is None:
        return True, 0, 0.0, 0.0
    excess = max(float(np.degrees(judgement.lean_max)) - bound - LEAN_SLACK, 0.0)
    return False, len({flaw.face for flaw in judgement.flaws}), excess, judgement.angle
