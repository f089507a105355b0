"""Quads on a surface: a short list of curvatures, each remeshed, planarised and judged."""

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from ..arrays import FloatArray
from ..congruences.curvature_spheres import sphere_congruence
from ..errors import ConvergenceError, InputError
from ..meshes.isotropic_remeshing import remesh_triangles
from ..meshes.mesh import Mesh
from ..remesh import pipeline
from ..remesh.planar.conditions import node_distances
from ..remesh.planar.planarize import planarize_held
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..surfaces.surface import Surface
from ..tolerances import CREASE
from .expected_angles import quad_angles
from .gain_report import check_edge, is_round, turn_p95
from .net_flaws import Flaw, NetJudgement, judge_net
from .surface_curvatures import SurfaceCurvatures, surface_curvatures

FINENESS = 2.4
"""Edges of the triangles under a net, as parts of its own edges."""

SMALLEST_RADIUS = 1.5
"""Least radius of the spheres, in edges: panels are caps of 28 degrees at most."""

NEARLY_FLAT = 3.0
"""Radius of spheres that are nearly planes, in diagonals of the surface."""

SHARES: dict[str, float | None] = {"75 %": 0.75, "50 %": 0.5, "flat": None, "best": 1.0}
"""Curvatures to try, as shares of the best one: nets are worst at the best one itself."""

EVENING_ROUNDS = 10
"""How often the triangles are evened out."""

FARTHEST_NODE = 0.02
"""Largest distance of a node from the surface, in mean edges, for a net of that surface."""

ROUND = (
    "the two principal curvatures are nearly the same over most of the surface, as on a "
    "sphere: spheres all but fit it, and planarising would turn their circles over; build "
    "this net with upright beams (--support bisector), or take hexagons"
)
"""Why a net is not planarised."""

TryStatus = Literal["usable", "flawed", "not planarised", "failed"]


class CurvatureChoice(NamedTuple):
    """A curvature to try: its name, itself, and the mean angle it foretells, in radians."""

    name: str
    curvature: float
    expected: float


@dataclass(frozen=True)
class NetTry:
    """One curvature tried.

    Attributes
    ----------
    choice : CurvatureChoice
    status : {"usable", "flawed", "not planarised", "failed"}
    net : SphereMesh or None
    judgement : NetJudgement or None
    distance : float
        Largest distance of a node inside from the surface, in mean edges.
    message : str
        Why there is no net, or none that is planar.
    """

    choice: CurvatureChoice
    status: TryStatus
    net: SphereMesh | None
    judgement: NetJudgement | None
    distance: float
    message: str


@dataclass(frozen=True)
class QuadPattern:
    """The best net on a surface, and all that were tried.

    Attributes
    ----------
    best : NetTry
    tries : tuple of NetTry
    surface : Mesh
        The triangles that nets were made on.
    curvatures : SurfaceCurvatures
        Of the surface.
    is_round : bool
        Whether quads find no directions, as on a sphere; nets are not planarised then.
    turn : float
        Turn of the surface over an edge at 95 % of the area, in radians.
    """

    best: NetTry
    tries: tuple[NetTry, ...]
    surface: Mesh
    curvatures: SurfaceCurvatures
    is_round: bool
    turn: float


def curvature_choices(
    found: SurfaceCurvatures, edge: float, diagonal: float
) -> list[CurvatureChoice]:
    """Curvatures to try, in this order; those that coincide once."""
    most = 1 / (SMALLEST_RADIUS * edge)
    best = float(np.clip(found.best, -most, most))
    flat = float(np.copysign(1 / (NEARLY_FLAT * diagonal), best))
    choices: list[CurvatureChoice] = []
    for name, share in SHARES.items():
        curvature = flat if share is None else share * best
        if abs(curvature) <= abs(flat):
            name, curvature = "flat", flat  # noqa: PLW2901 - the same net by another name
        angles = quad_angles(found.first, found.second, edge, curvature)
        if all(choice.name != name for choice in choices):
            choices.append(CurvatureChoice(name, curvature, found.mean(angles)))
    return choices


def expected_planes(found: SurfaceCurvatures, edge: float) -> float:
    """Mean angle between flat quads that the curvatures foretell, in radians."""
    return found.mean(quad_angles(found.first, found.second, edge, 0.0))


def quad_pattern(source: Mesh | Surface, edge: float) -> QuadPattern:
    """Cover a surface with quads whose spheres have a support structure.

    Parameters
    ----------
    source : Mesh or Surface
        A dense mesh of any faces, or a surface with its exact shape.
    edge : float
        Length of the edges, in model units.

    Returns
    -------
    QuadPattern
        The first net that is usable; else the one that is least bad, its flaws named.

    Raises
    ------
    InputError
        If the length is not positive, or too large for the surface, or no net can be made.

    Notes
    -----
    Of nets that are not usable, fewer faces with flaws are better, then smaller angles.
    """
    check_edge(edge)
    mesh = source.mesh if isinstance(source, Surface) else source
    triangles = remesh_triangles(mesh, edge / FINENESS, EVENING_ROUNDS, CREASE)
    found = _curvatures(source, triangles)
    rounded = is_round(found, edge)
    diagonal = float(np.linalg.norm(np.ptp(triangles.vertices, axis=0)))
    tries: list[NetTry] = []
    for choice in curvature_choices(found, edge, diagonal):
        tries.append(_try(triangles, choice, edge, planar=not rounded))
        if tries[-1].status in {"usable", "not planarised"}:
            break
    best = min(tries, key=_badness)
    if best.net is None:
        raise InputError(
            f"no quads of edges of {edge:g} can be made on this surface: {best.message}"
        )
    return QuadPattern(best, tuple(tries), triangles, found, rounded, turn_p95(found, edge))


def _curvatures(source: Mesh | Surface, triangles: Mesh) -> SurfaceCurvatures:
    """Exact curvatures where they are known; else at the scale of the panels."""
    if isinstance(source, Surface):
        return surface_curvatures(source)
    found = surface_curvatures(triangles)
    inner = np.where(triangles.topology.is_boundary_vertex, 0.0, found.weights)
    return replace(found, weights=inner / inner.sum()) if inner.sum() > 0 else found


def _try(triangles: Mesh, choice: CurvatureChoice, edge: float, *, planar: bool) -> NetTry:
    """One net: remeshed, planarised and judged."""
    spheres = _touching(triangles, choice.curvature)
    try:
        done = pipeline.remesh(triangles, spheres, edge)
        net, message = done.sphere_mesh, ROUND
        if planar:
            net, message = planarize_held(net, done.surface)[0].sphere_mesh, ""
        judgement = judge_net(net)
        distances = node_distances(done.surface, net.mesh)
    except (InputError, ConvergenceError) as error:
        return NetTry(choice, "failed", None, None, np.inf, str(error))
    if done.n_flipped:
        text = f"{done.n_flipped} triangles of the map are flipped: faces overlap"
        judgement = _with_flaw(judgement, text)
    distance = float(distances[~net.mesh.topology.is_boundary_vertex].max(initial=0.0))
    if distance > FARTHEST_NODE:
        text = f"nodes left the surface by up to {distance:.2g} edges"
        judgement = _with_flaw(judgement, text)
    status: TryStatus = "usable" if judgement.is_usable else "flawed"
    if not planar:
        status = "not planarised"
    return NetTry(choice, status, net, judgement, distance, message)


def _with_flaw(judgement: NetJudgement, cause: str) -> NetJudgement:
    return replace(judgement, flaws=(*judgement.flaws, Flaw(None, cause)))


def _touching(triangles: Mesh, curvature: float) -> FloatArray:
    return sphere_congruence(triangles, "tangent", 1 / curvature)[0]


def _badness(found: NetTry) -> tuple[int, int, float]:
    judgement = found.judgement
    if judgement is None:
        return 2, 0, 0.0
    faces = {flaw.face for flaw in judgement.flaws}
    return int(found.status != "usable"), len(faces), judgement.roughness
