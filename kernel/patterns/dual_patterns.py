"""Patterns on even triangles: the triangles themselves, and the hexagons dual to them."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..errors import ConvergenceError, InputError
from ..hexagons.dual_sphere_mesh import BoundaryRule, dual_sphere_mesh
from ..hexagons.evolution import evolve_spheres
from ..meshes.isotropic_remeshing import remesh_triangles
from ..meshes.mesh import Mesh
from ..optimization.angle_minimization import minimize_angles
from ..remesh.planar.node_planarity import measure_nodes, node_axis_angles
from ..sphere_meshes.fit import fit_spheres
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..surfaces.surface import Surface
from ..tolerances import CREASE, OPENING
from .gain_report import check_edge
from .net_flaws import FaceJudgement, judge_faces
from .polishing import polish
from .quad_pattern import EVENING_ROUNDS

BOUNDS: Final = (3.0, 5.0, 9.0, 15.0, 20.0, 30.0)
"""Bounds on the angle of node axes, in degrees: a looser one takes all tighter ones along."""

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
    judgement : FaceJudgement or None
    lean_p95, lean_max : float
        Angles of the node axes, in radians.
    message : str
        Why there are none.
    """

    bound: float
    net: SphereMesh | None
    judgement: FaceJudgement | None
    lean_p95: float
    lean_max: float
    message: str


def even_triangles(source: Mesh | Surface, edge: float) -> Mesh:
    """Triangles of nearly one size on a surface.

    Raises
    ------
    InputError
        If the length is not positive, or the triangles would be too many.
    """
    check_edge(edge)
    mesh = source.mesh if isinstance(source, Surface) else source
    return remesh_triangles(mesh, edge, EVENING_ROUNDS, CREASE)


def triangle_pattern(source: Mesh | Surface, edge: float) -> tuple[SphereMesh, FaceJudgement]:
    """Triangles of nearly one size, with the spheres that meet most smoothly.

    Raises
    ------
    InputError
        If the length is not positive, or the triangles would be too many.
    """
    start = fit_spheres(even_triangles(source, edge))
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
    The grid is nested, so a looser bound never makes hexagons rougher; a bound below all of it
    is tried itself. Without flaws comes before fewer flaws, then smaller angles.
    """
    if not 0 < bound < 90:
        raise InputError(f"the largest angle of an axis lies between 0 and 90, not {bound:g}")
    triangles = even_triangles(source, np.sqrt(3) * edge)
    bounds = [each for each in BOUNDS if each <= bound] or [bound]
    surface = source.mesh if isinstance(source, Surface) else source
    tries = [_grown(triangles, surface, each, boundary) for each in bounds]
    best = min(tries, key=_badness)
    if best.net is None:
        raise InputError(f"no hexagons can be made on this surface: {best.message}")
    return best, tries


def _grown(triangles: Mesh, surface: Mesh, bound: float, boundary: BoundaryRule) -> DualTry:
    """Hexagons grown with one bound, and polished."""
    try:
        found = evolve_spheres(triangles, float(np.radians(bound)))
        mesh, spheres = polish(found, surface)
        net = dual_sphere_mesh(mesh, spheres, boundary).sphere_mesh
        judgement = judge_faces(
            net, "intersection", convex=True, shortest=SHORTEST_HEXAGON_EDGE
        )
    except (InputError, ConvergenceError) as error:
        return DualTry(bound, None, None, np.inf, np.inf, str(error))
    angles = node_axis_angles(net, measure_nodes(net))
    known = np.append(angles[np.isfinite(angles)], 0.0)
    return DualTry(
        bound, net, judgement, float(np.percentile(known, 95)), float(known.max()), ""
    )


def _badness(found: DualTry) -> tuple[bool, int, float]:
    if found.judgement is None:
        return True, 0, 0.0
    faces = {flaw.face for flaw in found.judgement.flaws}
    return False, len(faces), found.judgement.angle
