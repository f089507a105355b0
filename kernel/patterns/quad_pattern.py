"""Quads on a surface: a short list of curvatures, each remeshed, planarised and judged."""

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from ..arrays import FloatArray
from ..congruences.curvature_spheres import sphere_congruence
from ..errors import ConvergenceError, InputError
from ..meshes.mesh import Mesh
from ..optimization.angle_minimization import minimize_angles
from ..remesh import pipeline
from ..remesh.field.guides import NetWishes
from ..remesh.pipeline import NO_WISHES
from ..sphere_meshes.fit import fit_spheres
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..surfaces.surface import Surface
from ..tolerances import CREASE, OPENING
from .density import even_spacing
from .expected_angles import quad_angles
from .gain_report import SHARP_TURN, check_edge, is_round, turn_p95
from .held_nets import FARTHEST_NODE, HeldNet, held_nets, without_loose_corners
from .net_flaws import Flaw, PatternJudgement, judge_faces, judge_net
from .panel_scale import FINENESS, curvatures_on, even_triangles
from .surface_curvatures import SurfaceCurvatures

SMALLEST_RADIUS = 1.5
"""Least radius of the spheres, in edges: panels are caps of 28 degrees at most."""

NEARLY_FLAT = 3.0
"""Radius of spheres that are nearly planes, in diagonals of the surface."""

SHARES: dict[str, float | None] = {"75 %": 0.75, "50 %": 0.5, "flat": None, "best": 1.0}
"""Curvatures to try, as shares of the best one: nets are worst at the best one itself."""

STRETCHES = (0.93, 1.08)
"""Other edges that the best curvature is tried with: singular points come to lie elsewhere."""

RIBBED = 1
"""Curvatures that are tried where the surface turns too sharply for its panels."""

EFFORT = 130_000
"""Linear systems times faces after which nothing more is tried, about 15 s of one core."""

MOST_TURNED = 0.05
"""Share of the area with directions turned from the lines of curvature that nodes bear."""

ROUND = (
    "the two principal curvatures are nearly the same over most of the surface, as on a "
    "sphere: spheres all but fit it, and planarising would turn their circles over; build "
    "this net with upright beams (--support bisector), or take hexagons"
)
"""Why a net on all but a sphere is not planarised."""

TURNED_AWAY = (
    "lines that follow what you asked for leave the lines of curvature on {:.0%} of the area, "
    "where nodes cannot be free of torsion; build this net with upright beams (--support "
    "bisector)"
)
"""Why a net that follows guides is not planarised."""

TryStatus = Literal["usable", "flawed", "not planarised", "failed"]


_MADE = ("usable", "not planarised")


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
    edge : float
        Length of the edges asked for, in model units.
    status : {"usable", "flawed", "not planarised", "failed"}
    net : SphereMesh or None
    judgement : PatternJudgement or None
    distance : float
        Largest distance of a node inside from the surface, in mean edges.
    message : str
        Why there is no net, or none that is planar.
    turned_share : float
        Share of the area whose directions guides turn away from the lines of curvature.
    effort : int
        Linear systems times faces that it took.
    """

    choice: CurvatureChoice
    edge: float
    status: TryStatus
    net: SphereMesh | None
    judgement: PatternJudgement | None
    distance: float
    message: str
    turned_share: float = 0.0
    effort: int = 0


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


def quad_pattern(
    source: Mesh | Surface,
    edge: float,
    wishes: NetWishes = NO_WISHES,
    *,
    density: float = 0.0,
    insists: bool = False,
) -> QuadPattern:
    """Cover a surface with quads whose spheres have a support structure.

    Parameters
    ----------
    source : Mesh or Surface
        A dense mesh of any faces, or a surface with its exact shape.
    edge : float
        Length of the edges, in model units.
    wishes : NetWishes
        What lines follow besides the curvature; its spacing is that of the density.
    density : float
        From 0 to 1: how much edges are shorter where the surface bends more.
    insists : bool
        Whether nets are planarised even where a surface is all but a sphere, or lines leave
        those of curvature.

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
    triangles = even_triangles(mesh, edge / FINENESS)
    found = curvatures_on(source, triangles)
    wishes = replace(wishes, spacing=even_spacing(source, triangles, density))
    rounded = is_round(found, edge) and not insists
    job = _Job(triangles, wishes, is_planar=not rounded, insists=insists)
    diagonal = float(np.linalg.norm(np.ptp(triangles.vertices, axis=0)))
    turn = turn_p95(found, edge)
    # On ribs sharper than the panels all nets fail alike.
    choices = curvature_choices(found, edge, diagonal)[: RIBBED if turn > SHARP_TURN else None]
    tries: list[NetTry] = []
    for choice in choices:
        tries.append(_try(job, choice, edge))
        if _is_enough(tries):
            break
    for stretch in () if turn > SHARP_TURN else STRETCHES:
        if _is_enough(tries):
            break
        likely = min(tries, key=_badness).choice
        tries.append(_try(job, likely, stretch * edge))
    best = min(tries, key=_badness)
    if best.net is None:
        raise InputError(
            f"no quads of edges of {edge:g} can be made on this surface: {best.message}"
        )
    return QuadPattern(best, tuple(tries), triangles, found, rounded, turn)


def _is_enough(tries: list[NetTry]) -> bool:
    """Whether a net is found, or has cost what it may."""
    is_found = tries[-1].status in _MADE
    return is_found or sum(each.effort for each in tries) > EFFORT


class _Job(NamedTuple):
    """What all nets share: triangles, wishes, and whether nodes are made planar."""

    triangles: Mesh
    wishes: NetWishes
    is_planar: bool
    insists: bool


def _try(job: _Job, choice: CurvatureChoice, edge: float) -> NetTry:
    """One net: remeshed, planarised and judged."""
    effort = 0
    nets: list[NetTry] = []
    try:
        spheres = _touching(job.triangles, choice.curvature)
        done = pipeline.remesh(job.triangles, spheres, edge, wishes=job.wishes)
        start, turned = done.sphere_mesh, done.turned_share
        if not job.is_planar or (turned > MOST_TURNED and not job.insists):
            message = TURNED_AWAY.format(turned) if job.is_planar else ROUND
            return _upright(choice, edge, start.mesh, message, turned)
        for held in held_nets(start, done.surface):
            effort += held.iterations * start.mesh.n_faces
            nets.append(_judged(choice, edge, held, done.n_flipped))
            if nets[-1].status == "usable" or not _touches_rim(nets[-1]):
                break
    except (InputError, ConvergenceError) as error:
        nets.append(NetTry(choice, edge, "failed", None, None, np.inf, str(error)))
    return replace(min(nets, key=_badness), effort=effort)


def _upright(
    choice: CurvatureChoice, edge: float, mesh: Mesh, message: str, turned: float
) -> NetTry:
    """A net for upright beams: its nodes stay on the surface, its spheres meet smoothly."""
    net, _ = minimize_angles(fit_spheres(mesh), crease=CREASE, max_opening=OPENING)
    judgement = judge_faces(net, "bisector", convex=False)
    return NetTry(choice, edge, "not planarised", net, judgement, 0.0, message, turned)


def _judged(choice: CurvatureChoice, edge: float, held: HeldNet, n_flipped: int) -> NetTry:
    """A net with what keeps it from being built."""
    net, judgement = _judged_and_trimmed(held.net)
    if n_flipped:
        text = f"{n_flipped} triangles of the map are flipped: faces overlap"
        judgement = _with_flaw(judgement, text)
    if held.distance > FARTHEST_NODE:
        text = f"nodes left the surface by up to {held.distance:.2g} edges"
        judgement = _with_flaw(judgement, text)
    status: TryStatus = "usable" if judgement.is_usable else "flawed"
    return NetTry(choice, edge, status, net, judgement, held.distance, "")


def _judged_and_trimmed(net: SphereMesh) -> tuple[SphereMesh, PatternJudgement]:
    """A net and its flaws; its cells at the boundary trimmed if that leaves fewer."""
    judgement = judge_net(net)
    faces = judgement.flawed_faces
    trimmed = without_loose_corners(net, np.array(faces, np.int64)) if faces else net
    if trimmed is net:
        return net, judgement
    after = judge_net(trimmed)
    return (trimmed, after) if len(after.flaws) < len(judgement.flaws) else (net, judgement)


def _touches_rim(found: NetTry) -> bool:
    """Whether a flaw lies at the boundary, or nowhere in particular."""
    if found.net is None or found.judgement is None:
        return False
    mesh, faces = found.net.mesh, found.judgement.flawed_faces
    if any(flaw.face is None for flaw in found.judgement.flaws):
        return True
    at_rim = mesh.topology.is_boundary_vertex[mesh.corners]
    return bool(np.logical_or.reduceat(at_rim, mesh.offsets[:-1])[faces].any())


def _with_flaw(judgement: PatternJudgement, cause: str) -> PatternJudgement:
    return replace(judgement, flaws=(*judgement.flaws, Flaw(None, cause)))


def _touching(triangles: Mesh, curvature: float) -> FloatArray:
    return sphere_congruence(triangles, "tangent", 1 / curvature)[0]


def _badness(found: NetTry) -> tuple[int, int, float]:
    judgement = found.judgement
    if judgement is None:
        return 2, 0, 0.0
    faces = {flaw.face for flaw in judgement.flaws}
    return int(found.status not in _MADE), len(faces), judgement.roughness
