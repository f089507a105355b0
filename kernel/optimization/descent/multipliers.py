"""Descents of energy (6), and the rounds in which what has to hold comes to hold."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.factorization import Solver
from ...solvers.levenberg_marquardt import Status
from ...solvers.minimization import Problem
from ...solvers.newton import NewtonDescent, newton
from ...tolerances import (
    AT_REST,
    COMMON_VERTEX,
    HELD,
    HELD_AXES,
    LEAST_DECREMENT,
    SAME_OBJECTIVE,
)
from ..energies.setting import Group, Unknowns
from .axes import with_best_axes
from .derivatives import energy_model
from .freedom import largest_part, moved, tangents
from .problem import EnergyProblem, energies_of_terms, hard_misses, names

MULTIPLIER_ROUNDS = 40
"""Largest number of rounds; each makes what is missing several times smaller."""
FIRST_ROUND, STRICTER = 1e-4, 1e-2
"""Decrement at which the first round, whose multipliers are rough, may end; and from round to
round."""
BOUND_MARGIN = 0.95
"""Share of the way to the bound that a step may go."""
SLOW = 4.0
"""From round to round, what has to hold shall miss by so much less; else it weighs more."""
HARDER = {"sphericity": 3.0, "support": 10.0}
"""How much more. Vertices that move slide along curved walls: too steep ones stop them."""
SLOW_ROUNDS = 2
"""What stays slow for more rounds than this, each with more weight, cannot hold."""


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
    energies: dict[str, FloatArray]


class Held(NamedTuple):
    """What came of the rounds.

    Attributes
    ----------
    unknowns : Unknowns
    stages : tuple of Stage
        A round each.
    lowest : float
        Lowest eigenvalue, or a bound from below, of the Hessian at rest.
    is_held : bool
        Whether all that has to hold does.
    """

    unknowns: Unknowns
    stages: tuple[Stage, ...]
    lowest: float
    is_held: bool


def descend_energy(
    problem: EnergyProblem,
    start: Unknowns,
    max_iterations: int,
    tolerance: float,
    *,
    is_exact: bool = True,
    leaves_saddles: bool = False,
    last: Solver | None = None,
) -> NewtonDescent[Unknowns]:
    """Minimise the energy under its multipliers; the history has a column per term.

    Factors of a descent nearby serve as long as they do.
    """
    layout, freedom = problem.layout, problem.freedom

    def _steps(unknowns: Unknowns, step: FloatArray) -> tuple[FloatArray, ...]:
        directions = tangents(freedom, unknowns, layout.counts)
        sizes = [basis.shape[0] * basis.shape[2] for basis in directions]
        parts = np.split(step, np.cumsum(sizes)[:-1])
        return tuple(
            np.einsum("nij,nj->ni", basis, part.reshape(len(basis), basis.shape[2]))
            for basis, part in zip(directions, parts, strict=True)
        )

    def _move(unknowns: Unknowns, step: FloatArray) -> Unknowns:
        spheres, displacements, normals = _steps(unknowns, step)
        free = moved(freedom, unknowns, (spheres, displacements, normals))
        return with_best_axes(problem, free)

    def _reach(unknowns: Unknowns, step: FloatArray) -> float:
        steps = _steps(unknowns, step)[Group.VERTEX]
        return largest_part(freedom, unknowns.displacements, steps, BOUND_MARGIN)

    def _energies(unknowns: Unknowns) -> FloatArray:
        found = energies_of_terms(problem, unknowns)
        return np.where(np.isfinite(found), found, np.inf)

    return newton(
        Problem(
            _energies,
            lambda unknowns: energy_model(problem, unknowns, is_exact=is_exact),
            _move,
            _reach,
            _preference,
        ),
        start,
        max_iterations,
        tolerance,
        is_exact=is_exact,
        leaves_saddles=leaves_saddles,
        last=last,
    )


def _preference(before: Unknowns, after: Unknowns) -> float:
    """Where both sides of a saddle are equal, spheres shall curve more to their own side."""
    change = after.spheres[:, 0] - before.spheres[:, 0]
    total = float(change.sum())
    return (
        total if abs(total) > 1e-6 * float(np.abs(change).sum()) else float((change**3).sum())
    )


def stage_of(problem: EnergyProblem, name: str, descent: NewtonDescent[Unknowns]) -> Stage:
    """The record of a descent."""
    columns = zip(names(problem), descent.history.T, strict=True)
    kept = {
        term: history
        for term, history in columns
        if term not in {"displacement", "lean"} or history.any()
    }
    return Stage(name, descent.status, descent.iterations, kept)


def hold(
    problem: EnergyProblem,
    start: Unknowns,
    max_iterations: int,
    bound_weights: Sequence[float],
) -> Held:
    """Minimise such that what has to hold holds.

    Rounds with falling weights of the displacements, the last as often as needed. What has to
    hold and does not come nearer cannot hold: the rounds end there.
    """
    stages: list[Stage] = []
    unknowns, objective = start, np.inf
    left = {name: _Left() for name in problem.hard}
    number, is_settled, last = 0, False, None
    while True:
        is_last = number >= len(bound_weights) - 1
        weight = bound_weights[min(number, len(bound_weights) - 1)]
        problem = replace(problem, bound_weight=weight)
        tolerance = max(AT_REST, FIRST_ROUND * STRICTER**number)
        # Saddles of multipliers that are still rough are none of the problem.
        looks = is_settled or (is_last and not problem.hard)
        descent = descend_energy(
            problem, unknowns, max_iterations, tolerance, leaves_saddles=looks, last=last
        )
        unknowns, minimised = descent.state, problem
        stages.append(stage_of(problem, f"round {number + 1}", descent))
        found = hard_misses(problem, unknowns)
        problem = _taken_up(problem, found)
        is_used_up = descent.status == "exhausted"
        left = {
            name: left[name].after(name, values, counts=is_last or is_used_up)
            for name, values in found.items()
        }
        previous, objective = objective, _objective(problem, descent.history[-1])
        change = abs(previous - objective)
        is_same = change <= SAME_OBJECTIVE * objective + LEAST_DECREMENT
        is_held = all(each.is_held for each in left.values())
        is_settled = is_last and is_held and (is_same or not problem.hard)
        if is_settled and looks:
            return Held(unknowns, tuple(stages), descent.lowest, is_held=True)
        is_stuck = not (is_last and is_held) and any(
            each.slow > (0 if is_used_up else SLOW_ROUNDS) for each in left.values()
        )
        number += 1
        if is_stuck or number == MULTIPLIER_ROUNDS:
            break
        slow = {name for name, each in left.items() if each.slow}
        problem = _harder(problem, slow)
        last = descent.solve if is_last and not slow else None
    # Where conditions depend on each other, multipliers grow on and on, and what is missing
    # falls slowly: less than what vertices may miss is as good as nothing.
    is_held = all(each.miss <= COMMON_VERTEX for each in left.values())
    if not looks:
        descent = descend_energy(
            minimised, unknowns, max_iterations, tolerance, leaves_saddles=True
        )
    return Held(descent.state, tuple(stages), descent.lowest, is_held=is_held)


class _Left(NamedTuple):
    """How much a term that has to hold misses, and for how many rounds it has hardly fallen."""

    miss: float = np.inf
    slow: int = 0
    is_held: bool = False

    def after(self, name: str, values: FloatArray, *, counts: bool) -> "_Left":
        miss = float(np.abs(values).max(initial=0.0))
        is_held = miss <= (HELD_AXES if name == "support" else HELD)
        is_slow = counts and not is_held and miss > self.miss / SLOW
        return _Left(miss, self.slow + 1 if is_slow else 0, is_held)


def _harder(problem: EnergyProblem, slow: set[str]) -> EnergyProblem:
    """The same multipliers in effect, and more weight on what misses too much too long."""
    if not slow:
        return problem
    factors = {name: HARDER[name] for name in slow}
    weights = tuple(
        weight * factors.get(term.name, 1.0)
        for term, weight in zip(problem.terms, problem.weights, strict=True)
    )
    multipliers = {
        name: y / factors.get(name, 1.0) ** 2 for name, y in problem.multipliers.items()
    }
    return replace(problem, weights=weights, multipliers=multipliers)


def _taken_up(problem: EnergyProblem, found: dict[str, FloatArray]) -> EnergyProblem:
    """The multipliers take up what is left of what has to hold."""
    multipliers = {
        name: values + problem.multipliers.get(name, 0.0) for name, values in found.items()
    }
    return replace(problem, multipliers=multipliers)


def _objective(problem: EnergyProblem, terms: FloatArray) -> float:
    """Energy of all that does not have to hold."""
    counts = [name not in problem.hard for name in names(problem)]
    return float(dot(terms, np.array(counts, np.float64)))
