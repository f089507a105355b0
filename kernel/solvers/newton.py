"""Newton's method that knows a minimum from a saddle.

A step solves ``(H + μ I) s = -g`` by a factorisation that refuses matrices which are not
positive definite; then the convex part of H leads on, under the same shift μ. So every step
goes down. The shift grows where steps promise too much, and falls to next to nothing where
they keep what they promise. At rest, the lowest eigenvector is found, and where the energy
falls along it, the descent goes on from there.

The method knows nothing of matrices: a problem hands it the energy of a state, a model at a
state, and the way to move along a step.
"""

from dataclasses import dataclass
from typing import Generic, NamedTuple

import numpy as np

from ..arrays import FloatArray, dot
from ..progress import tell_progress
from ..tolerances import (
    ENERGY_ROUNDING,
    LEAST_DECREMENT,
    LEAST_SHIFT,
    LOWEST_EIGENVALUE,
    RESIDUAL_ROUNDING,
    SAME_FALL,
)
from .factorization import Solver
from .levenberg_marquardt import State, Status
from .minimization import Factorize, Model, Problem

LARGEST_SHIFT = 1e3
GROWTH = 1e3
LONGEST_WAIT = 7
"""Steps that the convex part leads at most before the Hessian is tried again."""
RENEWED_SHIFT = 1e-7
"""Shift with which a step that lowered nothing is tried again."""
SHORTEST_PART, LONGEST_PART = 2.0**-7, 2.0**10
BETTER_THAN_PROMISED = 1.3
CHORD = 0.1
"""Share of the last decrement that is left where the last factors serve once more."""
MOST_ESCAPES = 10
"""Saddles that a descent leaves at most."""


@dataclass(frozen=True)
class NewtonDescent(Generic[State]):
    """How a minimisation went.

    Attributes
    ----------
    status : {"converged", "stalled", "exhausted"}
        ``converged``: no step within rounding lowers the energy, and no direction curves down;
        ``stalled``: steps that should lower the energy do not; ``exhausted``: the number of
        iterations is used up.
    history : (n + 1, terms) float array
        Energy of each term at the start and after each accepted step.
    iterations : int
        Steps, accepted or not.
    lowest : float
        A bound from below on the lowest eigenvalue of H at rest; minus infinity where it was
        not asked for.
    solve : callable, optional
        The last factors of H itself, for a descent that goes on from here.
    """

    state: State
    status: Status
    history: FloatArray
    iterations: int
    lowest: float
    solve: Solver | None


class _Taken(NamedTuple, Generic[State]):
    state: State
    terms: FloatArray
    part: float
    fall: float
    agreement: float


class _Step(NamedTuple):
    shift: float
    solve: Solver
    step: FloatArray
    decrement: float
    is_exact: bool
    is_chord: bool = False

    @property
    def is_least(self) -> bool:
        """Whether its factors prove that H itself is positive definite here."""
        return self.serves_again and not self.is_chord

    @property
    def serves_again(self) -> bool:
        """Whether its factors are those of H itself, here or nearby."""
        return self.is_exact and self.shift <= LEAST_SHIFT

    def chord(self, taken: _Taken[State], gradient: FloatArray) -> "_Step | None":
        """A step by the factors of this one, where they serve as well as new ones would."""
        if not (self.serves_again and taken.part == 1):
            return None
        found = _chord(self.solve, gradient)
        return found if 0 <= found.decrement <= CHORD * self.decrement else None


def _chord(solve: Solver, gradient: FloatArray) -> _Step:
    step = solve(-gradient)
    decrement = -float(dot(gradient, step))
    return _Step(LEAST_SHIFT, solve, step, decrement, is_exact=True, is_chord=True)


class _Trust(NamedTuple):
    """What the last steps taught.

    Attributes
    ----------
    shift : float
        Shift to begin with.
    refusals, wait : int
        How often in a row the Hessian was refused, and how many steps it is not tried for.
    refused_at : float
        Decrement when it was refused last.
    """

    shift: float = LEAST_SHIFT
    refusals: int = 0
    wait: int = 0
    refused_at: float = np.inf

    def tried(self, found: _Step) -> "_Trust":
        """A factorisation that is refused costs as much as a step: wait before the next."""
        if found.is_exact:
            return _Trust(self.shift)
        if found.decrement < self.refused_at / 4 and self.wait:
            return self._replace(wait=0)
        if self.wait:
            return self._replace(wait=self.wait - 1)
        wait = min(2**self.refusals, LONGEST_WAIT)
        return _Trust(self.shift, self.refusals + 1, wait, found.decrement)

    def adapted(self, found: _Step, part: float, agreement: float) -> "_Trust":
        """Less shift where a step kept what it promised, more where it did not."""
        shift = found.shift
        if agreement > 0.75 and part >= 1:
            shift = max(shift / 8, LEAST_SHIFT)
        elif agreement < 0.25 or part < 0.25:
            shift *= 4
        return self._replace(shift=shift)

    def renewed(self, found: _Step) -> "_Trust":
        """After a step that lowered nothing."""
        return self._replace(shift=max(10 * found.shift, RENEWED_SHIFT))


def newton(
    problem: Problem[State],
    start: State,
    max_iterations: int,
    tolerance: float,
    *,
    is_exact: bool = True,
    leaves_saddles: bool = True,
    last: Solver | None = None,
) -> NewtonDescent[State]:
    """Minimise an energy.

    Parameters
    ----------
    max_iterations : int
        Largest number of steps.
    tolerance : float
        Decrement ``-g·s``, relative to the energy, at which the descent is at rest.
    is_exact : bool
        Whether the Hessian is used, or its convex part alone.
    leaves_saddles : bool
        Whether the lowest eigenvalue at rest is checked.
    last : callable, optional
        Factors of a descent that came to rest nearby, of an energy much the same. They serve as
        long as their steps do.

    References
    ----------
    Nocedal, Wright 2006, Numerical Optimization, Secs. 3.4 and 3.5.
    """
    state, history = start, [problem.energies(start)]
    trust, model = _Trust(), problem.model(start)
    found = None if last is None else _chord(last, model.gradient)
    escapes, lowest, is_refused = 0, -np.inf, False
    status: Status = "exhausted"
    iteration = 0
    for iteration in range(1, max_iterations + 1):
        tell_progress(iteration - 1, max_iterations)
        energy = float(history[-1].sum())
        rest = tolerance * energy + LEAST_DECREMENT
        if found is None:
            found = _step(model, trust.shift, uses_curvature=is_exact and not trust.wait)
            trust = trust.tried(found)
        knows_enough = found.is_least or (found.is_chord and not leaves_saddles)
        if found.decrement <= rest and is_exact and not (is_refused or knows_enough):
            # A shift makes steps short, and a convex model knows no saddle.
            found = _exact_step(model, LEAST_SHIFT, LARGEST_SHIFT) or found
        last = found.solve if found.serves_again else last
        taken = _search(problem, state, found, energy) if found.decrement > rest else None
        is_refused = taken is None and found.decrement > rest and not found.is_chord
        if taken is None and found.decrement > max(rest, _rounding(energy)):
            if found.shift > LARGEST_SHIFT:
                status = "stalled"
                break
            trust = trust if found.is_chord else trust.renewed(found)
            found = None
            continue
        if taken is None and leaves_saddles:
            if not found.is_exact:
                found = _exact_step(model, LEAST_SHIFT, LARGEST_SHIFT) or found
            lowest, vector = _lowest(model, found)
            if lowest < -LOWEST_EIGENVALUE and escapes < MOST_ESCAPES and vector.any():
                taken, escapes = _escape(problem, state, vector, energy), escapes + 1
        if taken is None:
            state, status = _last(problem, state, found, energy), "converged"
            break
        state, model = taken.state, problem.model(taken.state)
        history.append(taken.terms)
        trust = trust.adapted(found, taken.part, taken.agreement)
        found = found.chord(taken, model.gradient)
    return NewtonDescent(state, status, np.array(history), iteration, lowest, last)


def _rounding(energy: float) -> float:
    """Falls of an energy that rounding hides."""
    return ENERGY_ROUNDING * energy + RESIDUAL_ROUNDING * float(np.sqrt(energy))


def _last(problem: Problem[State], state: State, found: _Step, energy: float) -> State:
    """Where the step at rest leads: it gains digits of the state, though none of the energy."""
    part = problem.reach(state, found.step)
    moved = problem.move(state, part * found.step)
    change = float(problem.energies(moved).sum()) - energy
    return moved if change <= ENERGY_ROUNDING * energy + LEAST_DECREMENT else state


def _step(model: Model, shift: float, *, uses_curvature: bool) -> _Step:
    """Step by the Hessian where it is positive definite, else by its convex part."""
    found = _exact_step(model, shift, shift) if uses_curvature else None
    found = found or _solved(model, model.factorize_convex, shift, np.inf, is_exact=False)
    return found or _Step(np.inf, np.copy, -model.gradient, np.inf, is_exact=False)


def _exact_step(model: Model, shift: float, largest: float) -> _Step | None:
    return _solved(model, model.factorize, shift, largest, is_exact=True)


def _solved(
    model: Model, factorize: Factorize, shift: float, largest: float, *, is_exact: bool
) -> _Step | None:
    """Step under the least shift, from the one given on, that makes H positive definite."""
    while shift <= min(largest, 1e6 * LARGEST_SHIFT):
        solve = factorize(shift)
        if solve is not None:
            step = solve(-model.gradient)
            if np.isfinite(step).all():
                return _Step(shift, solve, step, -float(dot(model.gradient, step)), is_exact)
        shift *= GROWTH
    return None


def _search(
    problem: Problem[State], state: State, found: _Step, energy: float
) -> _Taken[State] | None:
    """The part of a step, halved again and again, that lowers the energy enough.

    A step that gains more than its model promised, as where the shift alone made it short, is
    doubled as long as that gains more.
    """
    taken = None
    part = problem.reach(state, found.step)
    while taken is None and part >= SHORTEST_PART:
        taken = _tried(problem, state, found, energy, part)
        part /= 2
    while taken is not None and taken.part >= 1 and taken.agreement > BETTER_THAN_PROMISED:
        part = 2 * taken.part
        if part > LONGEST_PART or problem.reach(state, part * found.step) < 1:
            break
        longer = _tried(problem, state, found, energy, part)
        if longer is None or longer.fall <= taken.fall:
            break
        taken = longer
    return taken


def _tried(
    problem: Problem[State], state: State, found: _Step, energy: float, part: float
) -> _Taken[State] | None:
    moved = problem.move(state, part * found.step)
    terms = problem.energies(moved)
    fall = energy - float(terms.sum())
    # s·(H + μ) s is the decrement: the shift counts as curvature, to be on the safe side.
    promised = max(2 * part - part**2, part) * found.decrement
    if not (fall > 0 and fall >= 1e-4 * promised):
        return None
    return _Taken(moved, terms, part, fall, fall / promised)


def _lowest(model: Model, found: _Step) -> tuple[float, FloatArray]:
    """Lowest eigenvalue of H and its vector.

    Where H itself is positive definite, or as good as that, only this is said.
    """
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    size = len(model.gradient)
    if found.is_least:
        return -found.shift, np.zeros(size)
    if not found.is_exact:
        return -np.inf, np.zeros(size)
    if size < 3:
        inverse = np.stack([found.solve(row) for row in np.eye(size)])
        values, vectors = np.linalg.eigh((inverse + inverse.T) / 2)
        return 1 / float(values[-1]) - found.shift, vectors[:, -1]
    operator = LinearOperator((size, size), matvec=found.solve, dtype=np.float64)
    start = np.cos(np.arange(size))
    try:
        values, vectors = eigsh(operator, k=1, which="LA", v0=start, tol=1e-3, maxiter=50)
    except ArpackNoConvergence:
        return -np.inf, np.zeros(size)
    return 1 / float(values[0]) - found.shift, vectors[:, 0]


def _escape(
    problem: Problem[State], state: State, vector: FloatArray, energy: float
) -> _Taken[State] | None:
    """Go along a direction in which the energy curves down, to the side where it falls more."""
    ends = [
        _line_search(problem, state, side * vector / np.abs(vector).max(), energy)
        for side in (1.0, -1.0)
    ]
    found = [end for end in ends if end is not None]
    if not found:
        return None
    falls = [energy - float(terms.sum()) for _, terms in found]
    best = int(np.argmax(falls))
    if len(found) == 2 and abs(falls[0] - falls[1]) <= SAME_FALL * max(falls):
        best = int(np.argmax([problem.preference(state, end) for end, _ in found]))
    state, terms = found[best]
    return _Taken(state, terms, 0.0, falls[best], 1.0)


def _line_search(
    problem: Problem[State], state: State, direction: FloatArray, energy: float
) -> tuple[State, FloatArray] | None:
    """The step, doubled from a small one on, that lowers the energy most."""
    best, least, length = None, energy, 1e-4
    while length <= 1:
        moved = problem.move(state, length * direction)
        if problem.reach(state, length * direction) < 1:
            break
        terms = problem.energies(moved)
        if not float(terms.sum()) < least:
            break
        best, least = (moved, terms), float(terms.sum())
        length *= 2
    return best
