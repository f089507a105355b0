"""Energy (6) on sphere meshes: smooth spheres, upright planes between them, nodes with axes.

With a tolerance the vertices move, at most so far, until all spheres of a vertex pass through
it. Not every mesh has such spheres nearby: a quad whose corners lie on no circle fixes its
sphere, and moving a few of many alike corners helps the few alone. Where the outcome would be
rougher than flat panels, the vertices stay and each sphere passes within the tolerance of them
instead.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, norm
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length, with_vertices
from ..solvers.levenberg_marquardt import Status
from ..sphere_meshes.fit import face_planes
from ..sphere_meshes.sphere_mesh import SphereMesh, intersection_angles, vertex_error
from ..spheres.circles import circle_pencils, face_circles, pencil_spheres
from ..spheres.rows import recenter, rescale
from ..tolerances import COMMON_VERTEX, ENERGY_CHANGE, RESTING_MODEL, STAGE_CHANGE, STEP_MODEL
from .angle_minimization import check_angle_options, minimize_angles, pencil_angles
from .energies.freedom import Boundary, Freedom, Interior, vertex_freedom
from .energies.minimize import energy_problem, minimize_energy
from .energies.setting import Setting, Unknowns, energy_setting, first_unknowns
from .energies.table import EnergyWeights

Corners = Literal["soft", "common", "own"]

SPHERICITY_FACTORS = (10, 100, 1000)
SUPPORT_FACTORS = (10, 100, 1000, 10_000, 100_000)
LANDING_SUPPORT = 100.0
"""Weight of the support against that of sphericity in the landing: its residuals are products
of two curvatures, and small."""


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
        Largest number of linear systems of each stage.
    """

    target_angle: float = 0.0
    edge_weights: ArrayLike | None = None
    tolerance: float = 0.0
    fixed_radii: ArrayLike | None = None
    interior: Interior = "free"
    boundary: Boundary = "free"
    max_iterations: int = 100


@dataclass(frozen=True)
class Stage:
    """One minimisation on the way.

    Attributes
    ----------
    name : str
        What it was for.
    status : {"converged", "stalled", "exhausted"}
        How it ended.
    energies : mapping of str to (n,) float arrays
        Weighted energy of each term at the start and after each accepted step.
    """

    name: str
    status: Status
    iterations: int
    energies: Mapping[str, FloatArray]


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
    """

    stages: tuple[Stage, ...]
    corners: Corners
    vertex_move: float
    vertex_miss: float

    @property
    def converged(self) -> bool:
        """Whether the last stage came to rest: False if it used up its iterations."""
        return self.stages[-1].status != "exhausted"


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
    angles alone. What has to hold exactly, nodes with an axis and vertices on their spheres, is
    brought about by raising its weight from stage to stage; where neighbours are nearly the
    same sphere, the residuals of the support are small whatever the torsion. Last, moving
    vertices land: what has to hold is minimised alone, which Gauss-Newton steps do quickly and
    without moving anything more than needed.

    References
    ----------
    Meshes with Spherical Faces, eq. (6), Table 1, Secs. 3 and 4.
    """
    weights = EnergyWeights() if weights is None else weights
    conditions = Conditions() if conditions is None else conditions
    near = _angles_first(_problem(sphere_mesh, conditions), weights)
    if conditions.tolerance == 0:
        return _finished(_tightened(near, weights, ()), "soft")
    result, report = _landed(near, weights, conditions)
    is_free = weights.regularity == 0 and weights.support == 0
    is_rough = is_free and _is_rougher_than_planes(result, conditions)
    if report.vertex_miss <= COMMON_VERTEX and not is_rough:
        return result, report
    allowance = conditions.tolerance * (1 - COMMON_VERTEX)
    near = replace(
        near, setting=replace(near.setting, allowance=allowance), stages=report.stages
    )
    return _finished(_tightened(near, weights, ("sphericity",)), "own")


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
    near = _angles_first(_problem(sphere_mesh, conditions), weights)
    return _landed(near, weights, conditions)


@dataclass(frozen=True)
class _Problem:
    mesh: Mesh
    setting: Setting
    freedom: Freedom
    unknowns: Unknowns
    max_iterations: int
    stages: tuple[Stage, ...] = ()


def _landed(
    problem: _Problem, weights: EnergyWeights, conditions: Conditions
) -> tuple[SphereMesh, Optimization]:
    """Vertices move onto their spheres."""
    freedom = replace(
        problem.freedom,
        tolerance=conditions.tolerance,
        vertices=vertex_freedom(problem.mesh, conditions.interior, conditions.boundary),
    )
    problem = _tightened(replace(problem, freedom=freedom), weights, ("sphericity",))
    exact = EnergyWeights(sphericity=1.0, angle=0.0, support=LANDING_SUPPORT * weights.support)
    # Coming closer than this gains nothing, and moves much where few shapes of a mesh will do.
    problem = replace(problem, setting=replace(problem.setting, allowance=COMMON_VERTEX / 2))
    return _finished(_descend(problem, ("landing", exact), ENERGY_CHANGE), "common")


def _problem(sphere_mesh: SphereMesh, conditions: Conditions) -> _Problem:
    mesh = sphere_mesh.mesh
    weights = check_angle_options(mesh, conditions.target_angle, conditions.edge_weights)
    tolerance = conditions.tolerance
    if not (np.isfinite(tolerance) and tolerance >= 0):
        raise InputError(f"the tolerance must be finite and at least 0, not {tolerance}")
    if conditions.target_angle > 0:
        # At smooth contact the energy of another target is stationary: start in the pencils.
        sphere_mesh, _ = minimize_angles(sphere_mesh, conditions.target_angle, weights)
    sphere_mesh, is_fixed = _with_radii(sphere_mesh, conditions.fixed_radii)
    return _Problem(
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


def _angles_first(problem: _Problem, weights: EnergyWeights) -> _Problem:
    """Leave the planes, on which regularity and support vanish; vertices stay."""
    if weights.angle == 0 or (weights.regularity == 0 and weights.support == 0):
        return problem
    alone = replace(weights, regularity=0.0, support=0.0)
    return _descend(problem, ("angles", alone), STAGE_CHANGE)


def _tightened(problem: _Problem, weights: EnergyWeights, hard: tuple[str, ...]) -> _Problem:
    """Minimise; then again and again with ten times the weight on what has to hold exactly.

    Where vertices stay, the first stage comes to rest. The valley of the energy is flat: a
    descent that ends halfway, or whose steps leave much out, ends where rounding has led it,
    and raised weights, which make the valley steep, keep it there. Vertices that move make too
    flat a valley to rest in.
    """
    stays = problem.freedom.tolerance == 0
    ends = (ENERGY_CHANGE, RESTING_MODEL) if stays else (STAGE_CHANGE, STEP_MODEL)
    problem = _descend(problem, ("energy", weights), *ends)
    factors = SPHERICITY_FACTORS if hard else SUPPORT_FACTORS if weights.support > 0 else ()
    if weights.support > 0:
        hard = (*hard, "support")
    for factor in factors:
        raised = {name: factor * getattr(weights, name) for name in hard}
        stage = f"{' and '.join(hard)} x {factor}", replace(weights, **raised)
        change = ENERGY_CHANGE if factor == max(factors) else STAGE_CHANGE
        problem = _descend(problem, stage, change)
    return problem


def _descend(
    problem: _Problem,
    stage: tuple[str, EnergyWeights],
    change: float,
    share: float = STEP_MODEL,
) -> _Problem:
    name, weights = stage
    terms = energy_problem(problem.setting, problem.freedom, weights)
    descent = minimize_energy(terms, problem.unknowns, problem.max_iterations, change, share)
    energies = {
        term.name: history for term, history in zip(terms.terms, descent.history.T, strict=True)
    }
    done = Stage(name, descent.status, descent.iterations, energies)
    return replace(problem, unknowns=descent.state, stages=(*problem.stages, done))


def _finished(problem: _Problem, corners: Corners) -> tuple[SphereMesh, Optimization]:
    edge, mesh, unknowns = mean_edge_length(problem.mesh), problem.mesh, problem.unknowns
    rows = rescale(unknowns.spheres, edge)
    if problem.freedom.tolerance > 0:
        mesh = with_vertices(mesh, mesh.vertices + edge * unknowns.displacements)
        rows = recenter(rows, face_centroids(mesh) - face_centroids(problem.mesh))
    result = SphereMesh.from_local(mesh, rows)
    report = Optimization(
        problem.stages,
        corners,
        float(norm(unknowns.displacements).max()),
        float(vertex_error(result).max()) / edge,
    )
    return result, report


def _is_rougher_than_planes(sphere_mesh: SphereMesh, conditions: Conditions) -> bool:
    """Whether the angles lie farther from their target than those of flat panels."""
    angles = intersection_angles(sphere_mesh)
    planar = intersection_angles(face_planes(sphere_mesh.mesh))
    weights = check_angle_options(
        sphere_mesh.mesh, conditions.target_angle, conditions.edge_weights
    )
    target = conditions.target_angle
    return float(weights @ np.abs(angles - target)) > float(weights @ np.abs(planar - target))
