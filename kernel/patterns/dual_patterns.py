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
"""How often spheres grow to keep a bound: after polishing, vertices lie better for it."""

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

    Notes
    -----
    Polishing turns axes by a few degrees: what was grown with a tighter bound may just keep
    the one asked for, and what does not keep it is no choice. The grid is nested, so a looser
    bound never makes hexagons rougher; below all of it the bound and its half are tried.
    Without flaws comes before fewer flaws, then smaller angles.
    """
    if not 0 < bound < 90:
        raise InputError(f"the largest angle of an axis lies between 0 and 90, not {bound:g}")
    check_edge(edge)
    surface = _mesh_of(source)
    triangles = even_triangles(surface, np.sqrt(3) * edge)
    bounds = [each for each in BOUNDS if each <= bound] or [bound / 2, bound]
    tries = [
        _bounded(found, bound)
        for each in bounds
        for found in _grown(triangles, surface, each, boundary)
    ]
    best = min(tries, key=_badness)
    if best.net is None:
        raise InputError(f"no hexagons can be made on this surface: {best.message}")
    return best, tries


def _mesh_of(source: Mesh | Surface) -> Mesh:
    return source.mesh if isinstance(source, Surface) else source


def _grown(
    triangles: Mesh, surface: Mesh, bound: float, boundary: BoundaryRule
) -> list[DualTry]:
    """Hexagons grown with one bound and polished; grown anew from there where they pass it."""
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
        if judgement.is_usable and np.degrees(judgement.lean_max) <= bound + LEAN_SLACK:
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


def _badness(found: DualTry) -> tuple[bool, int, float]:
    judgement = found.judgement
    if judgement is None:
        return True, 0, 0.0
    return False, len({flaw.face for flaw in judgement.flaws}), judgement.angle
