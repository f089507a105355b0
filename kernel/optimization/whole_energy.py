"""Energy (6) on sphere meshes: smooth spheres, upright planes between them, nodes with axes.

With a tolerance the vertices move, at most so far, until all spheres of a vertex pass through
it. Not every mesh has such spheres nearby: a quad whose corners lie on no circle fixes its
sphere, and moving a few of many alike corners helps the few alone. Where the outcome would be
rougher than flat panels, the vertices stay and each sphere passes within the tolerance of them
instead.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, norm
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length, with_vertices
from ..sphere_meshes.fit import face_planes
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ..spheres.circles import circle_pencils, face_circles, pencil_spheres
from ..spheres.rows import recenter, rescale
from ..tolerances import COMMON_VERTEX, LOWEST_EIGENVALUE
from .angle_minimization import check_angle_options, minimize_angles, pencil_angles
from .comparison import Kept, Smoothness, smoother, smoothness
from .costs import tell_cost
from .descent.freedom import Boundary, Freedom, Interior, vertex_freedom
from .descent.multipliers import BOUND_MARGIN, Stage, descend_energy, hold, stage_of
from .descent.problem import EnergyProblem, energy_problem
from .energies.setting import Setting, Unknowns, energy_setting, first_unknowns
from .energies.table import TERMS, EnergyWeights

Corners = Literal["soft", "common", "own"]

HARD = {"sphericity": 10.0, "support": 100.0}
"""Factors on the weights of what has to hold exactly; its multipliers do the rest."""
BOUND_WEIGHTS = (1e-2, 3e-3, 1e-3)
"""Weights of the displacements, from round to round. What costs nothing else moves least."""
LIMIT_WEIGHTS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)
"""Weights of misses that have a limit, from round to round."""
NEARER = (1, 10, 100, 1000)
"""Factors on the weight of the misses until all are within their limit."""
FIRST_STEPS = 10
FIRST_DECREMENT = 1e-3
"""Steps without second derivatives end at this decrement: they lead out of saddles."""
STEPS_OF_ANGLES = 2
"""Steps by the angles alone, which leave the planes."""


@dataclass(frozen=True)
class Conditions:
    """What an optimisation has to respect.

    Attributes
    ----------
    target_angle : float
        Angle at which neighbours shall meet, in radians from 0 to π/2.
    edge_weights : (E,) array_like of float, optional
        Weight of the angle over each interior edge; 1 by default.
    tolerance : float
        How far vertices may move, in mean edges; at 0 they stay and the spheres pass near them
        as the weights decide.
    fixed_radii : (F,) array_like of float, optional
        Radius of each face: infinite for a plane, 0 where it is free. The side to which a
        panel curves is that of the sphere to start from.
    interior : {"free", "glide"}
        Whether moving vertices may leave the tangent plane of the mesh.
    boundary : {"free", "glide", "fixed"}
        How boundary vertices move; gliding ones along the boundary.
    max_iterations : int
        Largest number of steps of each stage.
    """

    target_angle: float = 0.0
    edge_weights: ArrayLike | None = None
    tolerance: float = 0.0
    fixed_radii: ArrayLike | None = None
    interior: Interior = "free"
    boundary: Boundary = "free"
    max_iterations: int = 100


@dataclass(frozen=True)
class Optimization:
    """How an optimisation went.

    Attributes
    ----------
    stages : tuple of Stage
        In order.
    corners : {"soft", "common", "own"}
        ``soft``: vertices stay, the spheres miss them by what the weights allow; ``common``:
        all spheres of a vertex pass through it; ``own``: vertices stay, the spheres pass
        within the tolerance of them.
    vertex_move : float
        Largest displacement of a vertex, in mean edges.
    vertex_miss : float
        Largest distance of a vertex from one of its spheres, in mean edges.
    is_held : bool
        Whether all that had to hold exactly does: nodes have axes if asked for, vertices lie
        on their spheres, or spheres pass within the tolerance of them.
    lowest_eigenvalue : float
        Lowest eigenvalue of the Hessian at rest, or a bound from below: no minimum where it is
        clearly negative. Minus infinity where it is not known.
    figures : mapping of str to Smoothness
        Of the ``optimum``, of ``planes`` on the mesh as it was, of the spheres at ``start``.
    kept : {"optimum", "planes", "start"}
        Which of these is the result: where nothing was asked for but small angles, an optimum
        that is rougher on average is not handed over.
    """

    stages: tuple[Stage, ...]
    corners: Corners
    vertex_move: float
    vertex_miss: float
    is_held: bool = True
    lowest_eigenvalue: float = -np.inf
    figures: Mapping[str, Smoothness] = field(default_factory=dict[str, Smoothness])
    kept: Kept = "optimum"

    @property
    def converged(self) -> bool:
        """Whether the last stage came to rest in a minimum, and all that had to hold does."""
        is_minimum = self.lowest_eigenvalue >= -LOWEST_EIGENVALUE
        return self.stages[-1].status == "converged" and is_minimum and self.is_held


def optimize_spheres(
    sphere_mesh: SphereMesh,
    weights: EnergyWeights | None = None,
    conditions: Conditions | None = None,
) -> tuple[SphereMesh, Optimization]:
    """Minimise energy (6): the optimum, on moved vertices if they may move, and how it went.

    Raises
    ------
    InputError
        If a condition is out of range or does not match the mesh.

    Notes
    -----
    Regularity and support vanish when all spheres are planes, so they come after a stage of
    angles alone. What has to hold exactly, nodes with an axis and vertices on their spheres,
    is brought about by multipliers (`descent.multipliers`).

    References
    ----------
    Meshes with Spherical Faces, eq. (6), Table 1, Secs. 3 and 4.
    """
    weights = EnergyWeights() if weights is None else weights
    conditions = Conditions() if conditions is None else conditions
    result, report = _optimum(sphere_mesh, weights, conditions)
    edge_weights = check_angle_options(
        sphere_mesh.mesh, conditions.target_angle, conditions.edge_weights
    )
    others = {"planes": face_planes(sphere_mesh.mesh), "start": sphere_mesh}
    figures = {
        name: smoothness(each, edge_weights, conditions.target_angle)
        for name, each in {"optimum": result, **others}.items()
    }
    report = replace(report, figures=figures)
    explains = not _asks_for_angles_alone(weights, conditions)
    if weights.support > 0 and (report.corners == "own" or not report.is_held):
        # Without common vertices nodes have no axes: the support explains nothing.
        explains = False
    if weights.angle == 0 or explains:
        return result, report
    kept = smoother(
        figures["optimum"], figures["planes"], figures["start"], conditions.tolerance
    )
    if kept == "optimum":
        return result, report
    miss = figures[kept].miss
    corners: Corners = "soft" if conditions.tolerance == 0 else "own"
    report = replace(report, corners=corners, vertex_move=0.0, vertex_miss=miss, kept=kept)
    return others[kept], report


def _asks_for_angles_alone(weights: EnergyWeights, conditions: Conditions) -> bool:
    """Whether nothing that was asked for explains rougher spheres."""
    others = weights.regularity, weights.support, weights.fairness, weights.closeness
    return not any(others) and conditions.fixed_radii is None


def _optimum(
    sphere_mesh: SphereMesh, weights: EnergyWeights, conditions: Conditions
) -> tuple[SphereMesh, Optimization]:
    tell_cost(sphere_mesh.mesh.n_faces, moves=conditions.tolerance > 0)
    run = _angles_first(_prepared(sphere_mesh, conditions), weights)
    if conditions.tolerance == 0:
        return _finished(_held(run, weights, ()), "soft")
    result, report = _landed(run, weights, conditions)
    is_free = weights.regularity == 0 and weights.support == 0
    is_rough = is_free and _is_rougher_than_planes(result, conditions)
    if report.vertex_miss <= COMMON_VERTEX and not is_rough:
        return result, report
    return _finished(_within(replace(run, stages=report.stages), weights, conditions), "own")


def move_vertices(
    sphere_mesh: SphereMesh, weights: EnergyWeights, conditions: Conditions
) -> tuple[SphereMesh, Optimization]:
    """Minimise energy (6) with vertices that move onto their spheres.

    The tolerance bounds every displacement. Where `vertex_miss` exceeds `COMMON_VERTEX`, the
    vertices could not reach common spheres within it.

    Raises
    ------
    InputError
        If a condition is out of range or does not match the mesh.
    """
    run = _angles_first(_prepared(sphere_mesh, conditions), weights)
    return _landed(run, weights, conditions)


@dataclass(frozen=True)
class _Run:
    """An optimisation under way."""

    mesh: Mesh
    setting: Setting
    freedom: Freedom
    unknowns: Unknowns
    max_iterations: int
    stages: tuple[Stage, ...] = ()
    is_held: bool = True
    lowest: float = -np.inf
    problem: EnergyProblem | None = None


def _landed(
    run: _Run, weights: EnergyWeights, conditions: Conditions
) -> tuple[SphereMesh, Optimization]:
    """Vertices move onto their spheres."""
    freedom = replace(
        run.freedom,
        tolerance=conditions.tolerance,
        vertices=vertex_freedom(run.mesh, conditions.interior, conditions.boundary),
    )
    return _finished(_held(replace(run, freedom=freedom), weights, ("sphericity",)), "common")


def _prepared(sphere_mesh: SphereMesh, conditions: Conditions) -> _Run:
    mesh = sphere_mesh.mesh
    weights = check_angle_options(mesh, conditions.target_angle, conditions.edge_weights)
    tolerance = conditions.tolerance
    if not (np.isfinite(tolerance) and tolerance >= 0):
        raise InputError(f"the tolerance must be finite and at least 0, not {tolerance}")
    if conditions.target_angle > 0:
        # At smooth contact the energy of another target is stationary: start in the pencils.
        sphere_mesh, _ = minimize_angles(sphere_mesh, conditions.target_angle, weights)
    sphere_mesh, is_fixed = _with_radii(sphere_mesh, conditions.fixed_radii)
    return _Run(
        mesh,
        energy_setting(mesh, weights, conditions.target_angle),
        Freedom(0.0, vertex_freedom(mesh, "free", "free"), is_fixed),
        first_unknowns(sphere_mesh),
        conditions.max_iterations,
    )


def _with_radii(
    sphere_mesh: SphereMesh, fixed_radii: ArrayLike | None
) -> tuple[SphereMesh, BoolArray]:
    """Spheres through the faces' circles with the radii asked for, and which faces have one."""
    mesh = sphere_mesh.mesh
    if fixed_radii is None:
        return sphere_mesh, np.zeros(mesh.n_faces, bool)
    radii = np.array(fixed_radii, np.float64)
    if radii.shape != (mesh.n_faces,):
        raise InputError(f"fixed radii must have shape ({mesh.n_faces},), not {radii.shape}")
    if not (radii >= 0).all():
        raise InputError("fixed radii must be at least 0: 0 where free, infinite for a plane")
    circles, _ = face_circles(mesh)
    is_fixed = radii > 0
    with np.errstate(divide="ignore"):
        sines = np.sqrt(circles.radii_squared) / radii
    too_small = np.flatnonzero(is_fixed & (sines > 1 + COMMON_VERTEX))
    if len(too_small):
        raise InputError(
            f"faces {name_ids(too_small.tolist())} are larger than a sphere of their fixed "
            "radius: give them a larger one"
        )
    side = np.where(pencil_angles(sphere_mesh, circles) < 0, -1.0, 1.0)
    angles = side * np.arcsin(np.minimum(sines, 1.0))
    rows = sphere_mesh.local_spheres.copy()
    rows[is_fixed] = pencil_spheres(*circle_pencils(circles), angles)[is_fixed]
    return SphereMesh.from_local(mesh, rows), is_fixed


def _angles_first(run: _Run, weights: EnergyWeights) -> _Run:
    """Leave the planes, on which regularity and support vanish; vertices stay."""
    if weights.angle == 0 or (weights.regularity == 0 and weights.support == 0):
        return run
    alone = replace(weights, regularity=0.0, support=0.0)
    problem = energy_problem(run.setting, run.freedom, alone)
    return _first_steps(run, "angles", problem, STEPS_OF_ANGLES)


def _first_steps(run: _Run, name: str, problem: EnergyProblem, most: int = FIRST_STEPS) -> _Run:
    """A few steps without second derivatives, which lead downhill from anywhere."""
    steps = min(run.max_iterations, most)
    found = descend_energy(problem, run.unknowns, steps, FIRST_DECREMENT, is_exact=False)
    stage = stage_of(problem, name, found)
    return replace(run, unknowns=found.state, stages=(*run.stages, stage), problem=problem)


def _held(run: _Run, weights: EnergyWeights, hard: tuple[str, ...]) -> _Run:
    """Minimise the energy such that the terms named, and the support if asked for, hold."""
    bound_weights = BOUND_WEIGHTS if run.freedom.tolerance > 0 else (0.0,)
    soft = energy_problem(run.setting, run.freedom, weights, bound_weights[0])
    return _rounds(_first_steps(run, "energy", soft), weights, hard, {}, bound_weights)


def _within(run: _Run, weights: EnergyWeights, conditions: Conditions) -> _Run:
    """Minimise the energy with spheres that pass within the tolerance of the vertices."""
    allowance = conditions.tolerance * (1 - COMMON_VERTEX)
    run = replace(run, setting=replace(run.setting, allowance=allowance))
    term = next(term for term in TERMS if term.name == "sphericity")
    misses = np.zeros(0)
    for factor in NEARER:
        near = replace(weights, sphericity=factor * (weights.sphericity or 1.0))
        problem = energy_problem(run.setting, run.freedom, near, known=run.problem)
        run = _first_steps(run, "nearer", problem)
        misses = np.abs(term.residuals(run.setting, run.unknowns))
        if misses.max() < BOUND_MARGIN * allowance:
            break
    limits = {"sphericity": np.maximum(allowance, misses / BOUND_MARGIN)}
    found = _rounds(run, replace(weights, sphericity=1.0), (), limits, LIMIT_WEIGHTS)
    is_near = bool((limits["sphericity"] <= allowance).all())
    return replace(found, is_held=found.is_held and is_near)


def _rounds(
    run: _Run,
    weights: EnergyWeights,
    hard: tuple[str, ...],
    limits: dict[str, FloatArray],
    bound_weights: tuple[float, ...],
) -> _Run:
    if weights.support > 0:
        hard = (*hard, "support")
    raised = {name: HARD[name] * (getattr(weights, name) or 1.0) for name in hard}
    weights = replace(weights, **raised)
    problem = energy_problem(run.setting, run.freedom, weights, known=run.problem)
    problem = replace(problem, hard=frozenset(hard), limits=limits)
    held = hold(problem, run.unknowns, run.max_iterations, bound_weights)
    return replace(
        run,
        unknowns=held.unknowns,
        stages=(*run.stages, *held.stages),
        is_held=held.is_held,
        lowest=held.lowest,
    )


def _finished(run: _Run, corners: Corners) -> tuple[SphereMesh, Optimization]:
    edge, mesh, unknowns = mean_edge_length(run.mesh), run.mesh, run.unknowns
    rows = rescale(unknowns.spheres, edge)
    if run.freedom.tolerance > 0:
        mesh = with_vertices(mesh, mesh.vertices + edge * unknowns.displacements)
        rows = recenter(rows, face_centroids(mesh) - face_centroids(run.mesh))
    result = SphereMesh.from_local(mesh, rows)
    report = Optimization(
        run.stages,
        corners,
        float(norm(unknowns.displacements).max()),
        float(vertex_error(result).max()) / edge,
        run.is_held,
        run.lowest,
    )
    return result, report


def _is_rougher_than_planes(sphere_mesh: SphereMesh, conditions: Conditions) -> bool:
    """Whether the angles lie farther from their target than those of flat panels."""
    target = conditions.target_angle
    weights = check_angle_options(sphere_mesh.mesh, target, conditions.edge_weights)
    planes = smoothness(face_planes(sphere_mesh.mesh), weights, target)
    return smoothness(sphere_mesh, weights, target).mean > planes.mean
