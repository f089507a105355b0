"""Least energies in the pencils of the faces' circles, under bounds on every opening.

Newton's method on one unknown per face. Where the Hessian shows negative curvature, the step is
that of its convex part, edge by edge. At rest the Hessian is checked: from a saddle the descent
goes on along the lowest eigenvector, so that what is called an optimum is one of second order.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, sum_by
from ..solvers.definite_systems import (
    GraphMatrix,
    GraphPattern,
    graph_pattern,
    is_definite,
    lowest_mode,
    solve_if_definite,
)
from ..tolerances import (
    ANGLE_STEP,
    LEAST_ENERGY,
    LINEAR_SOLVE,
    NEGATIVE_MODE,
    SAME_ENERGY,
)
from .pencil_energy import (
    EdgeEnergy,
    PencilCoupling,
    PencilDerivatives,
    angle_energy,
    convex_part,
    energy_derivatives,
    has_convex_blocks,
)

SLOWEST_FALL = 0.8
"""Steps to a contact fall to two thirds: the energy is quartic there. Slower is rounding."""

MAX_NEWTON_STEPS = 400
MAX_ESCAPES = 20
LONGEST_STEP = 0.5
"""Radians by which no unknown moves farther in a step: the next basin is not the nearest."""
ROUGH_SOLVE = 1e-3
"""Largest relative residual of a step; near rest the last step squared."""
ESCAPES = (0.001, 0.005, 0.02, 0.05, 0.1, 0.2, 0.4)
"""Radians of the unknown that moves farthest, tried from a saddle on both sides."""


@dataclass(frozen=True)
class PencilProblem:
    """What is minimised.

    Attributes
    ----------
    coupling : PencilCoupling
    density : EdgeEnergy
    bounds : tuple of float
        Least and largest value of an unknown, in radians.
    curvatures : (F,) float array
        Inverse radii of the circles, of any scale: they decide ties.
    """

    coupling: PencilCoupling
    density: EdgeEnergy
    bounds: tuple[float, float]
    curvatures: FloatArray


@dataclass(frozen=True)
class PencilDescent:
    """How a descent went.

    Attributes
    ----------
    angles : (F,) float array
        Unknowns at the end.
    energies : tuple of float
        At the start and after each step.
    step : float
        Largest change of an unknown that the last step asked for.
    converged : bool
        Whether it came to rest where no direction goes down, up to second order.
    """

    angles: FloatArray
    energies: tuple[float, ...]
    step: float
    converged: bool


def minimize_in_pencils(problem: PencilProblem, start: FloatArray) -> PencilDescent:
    """Descend from unknowns (F,), clipped to the bounds, to an optimum of second order."""
    coupling, density = problem.coupling, problem.density
    pattern = graph_pattern(coupling.faces, len(start))
    angles = np.clip(start, *problem.bounds)
    energies = [angle_energy(coupling, density, angles)]
    largest, escapes = LONGEST_STEP, 0
    zero = LEAST_ENERGY * float(coupling.weights.sum())

    def _descent(unknowns: FloatArray, *, converged: bool) -> PencilDescent:
        return PencilDescent(unknowns, tuple(energies), largest, converged)

    for _ in range(MAX_NEWTON_STEPS):
        found = energy_derivatives(coupling, density, angles)
        step, held = _newton_step(problem, pattern, angles, found, largest**2)
        before, largest = largest, float(np.abs(step).max(initial=0.0))
        moved = np.clip(angles + step, *problem.bounds)
        # Steps shrink to nothing, or to what rounding makes of them.
        is_lost = -float(dot(found.gradient, step)) <= found.noise
        is_resting = largest <= ANGLE_STEP or (is_lost and largest > SLOWEST_FALL * before)
        # Below zero nothing can fall: there the second derivatives are rounding.
        if is_resting and (energies[-1] <= zero or _is_minimum(problem, pattern, found, held)):
            return _descent(moved if largest <= before else angles, converged=True)
        if is_resting:
            escapes += 1
            lower = _escape(problem, pattern, angles, found, held, energies[-1])
        else:
            lower = _line_search(problem, angles, step, energies[-1], found)
        if lower is None or escapes > MAX_ESCAPES:
            return _descent(angles, converged=False)
        angles = lower
        energies.append(angle_energy(coupling, density, angles))
    return _descent(angles, converged=False)


def _newton_step(
    problem: PencilProblem,
    pattern: GraphPattern,
    angles: FloatArray,
    found: PencilDerivatives,
    residual: float,
) -> tuple[FloatArray, BoolArray]:
    """Step (F,) of the unknowns, and which of them the bounds hold."""
    residual = min(max(residual, LINEAR_SOLVE**2), ROUGH_SOLVE)
    gradient, (least, largest) = found.gradient, problem.bounds
    held = ((angles >= largest) & (gradient < 0)) | ((angles <= least) & (gradient > 0))
    right = np.where(held, 0.0, -gradient)
    if not right.any():
        return right, held
    step = solve_if_definite(_matrix(problem, pattern, found, held), right, residual)
    if step is None:
        convex = _matrix(problem, pattern, convex_part(found), held)
        shift = SAME_ENERGY * float(convex.diagonal.max())
        damped = GraphMatrix(pattern, convex.diagonal + shift, convex.mixed)
        step = solve_if_definite(damped, right, residual)
    if step is None:
        step = right / float(np.abs(found.first).max() + np.abs(found.second).max())
    size = float(np.abs(step).max(initial=0.0))
    return step * min(1.0, LONGEST_STEP / size) if size > 0 else step, held


def _matrix(
    problem: PencilProblem,
    pattern: GraphPattern,
    found: PencilDerivatives,
    held: BoolArray,
) -> GraphMatrix:
    """Second derivatives by the unknowns that move; the others are kept apart by ones."""
    a, b = problem.coupling.faces.T
    count = len(held)
    diagonal = sum_by(a, found.first, count) + sum_by(b, found.second, count)
    mixed = np.where(held[a] | held[b], 0.0, found.mixed) if held.any() else found.mixed
    # Of a face without a weighted edge nothing is asked.
    used = np.zeros(count, bool)
    used[problem.coupling.faces[problem.coupling.weights > 0]] = True
    scale = float(np.abs(diagonal).max(initial=0.0)) or 1.0
    return GraphMatrix(pattern, np.where(held | ~used, scale, diagonal), mixed)


def _line_search(
    problem: PencilProblem,
    angles: FloatArray,
    step: FloatArray,
    energy: float,
    found: PencilDerivatives,
) -> FloatArray | None:
    """The step, or the longest half of a half of it that goes down; None if there is none."""
    for halves in range(40):
        moved = np.clip(angles + step * 0.5**halves, *problem.bounds)
        promised = min(float(dot(found.gradient, moved - angles)), 0.0)
        reached = angle_energy(problem.coupling, problem.density, moved)
        if reached <= energy + found.noise + 1e-4 * promised:
            return moved
    return None


def _is_minimum(
    problem: PencilProblem, pattern: GraphPattern, found: PencilDerivatives, held: BoolArray
) -> bool:
    """Whether no direction of the unknowns that move has negative curvature."""
    if has_convex_blocks(found).all():
        return True
    return is_definite(_matrix(problem, pattern, found, held), NEGATIVE_MODE)


def _escape(
    problem: PencilProblem, pattern: GraphPattern, angles: FloatArray,
    found: PencilDerivatives, held: BoolArray, energy: float,
) -> FloatArray | None:  # fmt: skip
    """A lower point along the lowest eigenvector; None if there is none."""
    _, mode = lowest_mode(_matrix(problem, pattern, found, held))
    mode = np.where(held, 0.0, mode)
    mode /= np.abs(mode).max(initial=0.0) or 1.0
    # Of two sides that are equally low, the one where the spheres bulge more.
    bulge = float(dot(problem.curvatures * np.cos(angles), mode))
    size = float(dot(problem.curvatures, np.abs(mode)))
    if abs(bulge) <= SAME_ENERGY * size:
        bulge = float((problem.curvatures * mode**3).sum())
    mode *= -1.0 if bulge < 0 else 1.0
    best, lowest = None, energy
    for side in (1, -1):
        for length in ESCAPES:
            moved = angles + side * length * mode
            moved = np.clip(moved, *problem.bounds)
            reached = angle_energy(problem.coupling, problem.density, moved)
            if reached < lowest - SAME_ENERGY * energy:
                best, lowest = moved, reached
    return best
