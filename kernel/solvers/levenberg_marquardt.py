"""Levenberg-Marquardt: least squares with steps that are taken only if the energy falls.

The method knows nothing of matrices: a problem hands it the energy of a state, a damped
Gauss-Newton step at a state, and the way to move along a step (which may keep unit vectors
unit, or points within a bound).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Literal, NamedTuple, TypeVar

import numpy as np

from ..arrays import FloatArray
from ..progress import tell_progress
from ..tolerances import DAMPING, ENERGY_ROUNDING

State = TypeVar("State")

Status = Literal["converged", "stalled", "exhausted"]

FIRST_DAMPING = 1e-3


class DampedStep(NamedTuple):
    """A step and the energy that its linear model promises.

    Attributes
    ----------
    step : (n,) float array
        Change of the unknowns.
    predicted : float
        Energy ``|r + J step|²`` of the linear model after the step.
    """

    step: FloatArray
    predicted: float


@dataclass(frozen=True)
class Descent(Generic[State]):
    """How a minimisation went.

    Attributes
    ----------
    status : {"converged", "stalled", "exhausted"}
        ``converged``: the energy fell by less than the tolerance asked for, or is as good as
        zero; ``stalled``: no
        step, however short, lowers the energy although the linear model says so;
        ``exhausted``: the number of iterations is used up.
    history : (n + 1, terms) float array
        Energy of each term at the start and after each accepted step.
    iterations : int
        Linear systems solved, accepted or not.
    """

    state: State
    status: Status
    history: FloatArray
    iterations: int


def levenberg_marquardt(
    start: State,
    energies: Callable[[State], FloatArray],
    linearize: Callable[[State], Callable[[float], DampedStep]],
    move: Callable[[State, FloatArray], State],
    tolerance: float = 1e-6,
    max_iterations: int = 100,
    least_energy: float = 0.0,
) -> Descent[State]:
    """Minimise a sum of squares.

    Parameters
    ----------
    start : object
        State to start from, of any type.
    energies : callable
        State to the energies (terms,) of its terms, whose sum ``|r|²`` is minimised.
    linearize : callable
        State to a solver that takes a damping μ relative to the size of ``JᵀJ`` and returns
        the step that minimises ``|r + J step|² + μ |step|²``.
    move : callable
        State and step to the moved state.
    tolerance : float
        A step that lowers the energy by a smaller share ends the minimisation.
    max_iterations : int
        Largest number of linear systems to solve.
    least_energy : float
        An energy that is as good as zero.

    Returns
    -------
    Descent
        Best state, status and history.

    Notes
    -----
    The damping follows the ratio of the fall of the energy to the fall of its linear model
    (Nielsen's rule). A step ends the minimisation only where the model holds, so strong
    damping is not mistaken for convergence. Where nothing more than rounding is promised, the
    descent has stalled if shorter and shorter steps were refused before.

    References
    ----------
    Marquardt 1963; Madsen, Nielsen, Tingleff 2004, Methods for non-linear least squares
    problems, algorithm 3.16.
    """
    state = start
    history = [energies(state)]
    damping, growth = FIRST_DAMPING, 2.0
    if history[0].sum() <= least_energy:
        return Descent(state, "converged", np.array(history), 0)
    solve: Callable[[float], DampedStep] | None = None
    for iteration in range(1, max_iterations + 1):
        tell_progress(iteration - 1, max_iterations)
        solve = linearize(state) if solve is None else solve
        energy = float(history[-1].sum())
        trial = solve(damping)
        promised = energy - trial.predicted
        if not promised > ENERGY_ROUNDING * energy:
            status = "converged" if growth == 2.0 else "stalled"
            return Descent(state, status, np.array(history), iteration)
        moved = move(state, trial.step)
        terms = energies(moved)
        fall = energy - float(terms.sum())
        if fall > 0:
            agreement = fall / promised
            state = moved
            history.append(terms)
            has_settled = fall <= tolerance * energy and agreement > 0.25
            if has_settled or energy - fall <= least_energy:
                return Descent(state, "converged", np.array(history), iteration)
            damping = max(DAMPING, damping * max(0.1, 1 - (2 * agreement - 1) ** 3))
            growth = 2.0
            solve = None
        else:
            damping *= growth
            growth *= 2
    return Descent(state, "exhausted", np.array(history), max_iterations)
