"""What Newton's method is given: energies of states, a model near a state, and moves."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, NamedTuple

from ..arrays import FloatArray
from .factorization import Solver
from .levenberg_marquardt import State

Factorize = Callable[[float], Solver | None]


class Model(NamedTuple):
    """The energy near a state, to second order; the second derivatives only if asked for.

    Attributes
    ----------
    gradient : (n,) float array
        Half of the gradient of the energy.
    factorize : callable
        Shift to a function that solves with ``H + shift I``, H half of the second derivatives,
        or to None if that is not positive definite.
    factorize_convex : callable
        The same for the part of H that is never indefinite: ``JᵀJ`` of least squares.
    """

    gradient: FloatArray
    factorize: Factorize
    factorize_convex: Factorize


@dataclass(frozen=True)
class Problem(Generic[State]):
    """What is minimised.

    Attributes
    ----------
    energies : callable
        State to the energies (terms,) of its terms; infinite where a state is out of bounds.
    model : callable
        State to its model.
    move : callable
        State and step to the moved state.
    reach : callable
        State and step to the largest part of the step, up to 1, that stays within bounds.
    preference : callable
        A number of a state that decides between the two sides of a saddle where they are equal.
    """

    energies: Callable[[State], FloatArray]
    model: Callable[[State], Model]
    move: Callable[[State, FloatArray], State]
    reach: Callable[[State, FloatArray], float]
    preference: Callable[[State, State], float]
