"""The descent to an exact support: wishes first, conditions that weigh more and more.

Levenberg-Marquardt at rising weight of the conditions. Spheres of the common curvature through
the faces' circles miss their axes by a lot; conditions that count fully from the start would
be met at once, somewhere far off. Nets whose conditions are hard after few steps each land.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, dot
from ..solvers.blocks import JacobianPattern, jacobian_matrix, jacobian_pattern
from ..solvers.factorization import factorize_symmetric
from ..solvers.levenberg_marquardt import DampedStep, levenberg_marquardt
from ..tolerances import ENERGY_CHANGE, EXACT_ENERGY, STEP_RIDGE
from .conditions import COMMON_AXES, CONDITIONS, FLATNESS
from .setting import SlideSetting, SlidState, Unknown, slid_by
from .terms import SlideTerm
from .wishes import LEAN, WISHES

CONDITION_UNIT = 1e-5
"""What a condition may be missed by at full weight, for a unit of the objective."""

WEIGHTS = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)
"""Weights of the conditions, one after the other."""

STEPS_PER_WEIGHT = 25
"""Linear systems at each weight; twice as many at the last."""

LANDING_STEPS = 40
"""Linear systems of a landing."""

WEIGHT_CHANGE = 1e-3
"""A stage that others follow ends when a step lowers the energy by less than this share."""


@dataclass(frozen=True)
class _Problem:
    """Terms with rows, each with its weight, and which unknowns are free."""

    setting: SlideSetting
    terms: tuple[tuple[SlideTerm, float], ...]
    pattern: JacobianPattern
    is_free: BoolArray
    units: FloatArray


def slide_to_support(setting: SlideSetting, start: SlidState) -> SlidState:
    """Bring spheres to the conditions of an exact support, and near to the wishes."""
    state = start
    for weight in WEIGHTS:
        is_last = weight == WEIGHTS[-1]
        terms = [(term, weight / CONDITION_UNIT) for term in _conditions(setting)]
        terms += [(term, 1.0) for term in WISHES]
        state = _minimized(
            _problem(setting, terms),
            state,
            ENERGY_CHANGE if is_last else WEIGHT_CHANGE,
            2 * STEPS_PER_WEIGHT if is_last else STEPS_PER_WEIGHT,
        )
    return state


def meet_conditions(setting: SlideSetting, start: SlidState) -> SlidState:
    """The nearest state that meets all conditions to rounding, flat beams among them."""
    terms = [(term, 1.0) for term in (*CONDITIONS, FLATNESS)]
    return _minimized(_problem(setting, terms), start, 0.0, LANDING_STEPS)


def meet_axes(setting: SlideSetting, start: SlidState) -> SlidState:
    """The poles that spheres have in common, with flat beams between them; all else stays.

    Of several, as where neighbours are one sphere, those that lean little.
    """
    hard = [(COMMON_AXES, 1 / CONDITION_UNIT), (FLATNESS, 1 / CONDITION_UNIT)]
    near = _problem(setting, [*hard, (LEAN, 1.0)], Unknown.POLE)
    state = _minimized(near, start, ENERGY_CHANGE, LANDING_STEPS)
    exact = _problem(setting, [(term, 1.0) for term, _ in hard], Unknown.POLE)
    return _minimized(exact, state, 0.0, LANDING_STEPS)


def misses(setting: SlideSetting, state: SlidState) -> float:
    """Largest miss of any condition, in mean edges and radians."""
    found = [term.residuals(setting, state) for term in (*CONDITIONS, FLATNESS)]
    return float(max(np.abs(residuals).max(initial=0.0) for residuals in found))


def _conditions(setting: SlideSetting) -> tuple[SlideTerm, ...]:
    return (*CONDITIONS, FLATNESS) if setting.is_flat else CONDITIONS


def _problem(
    setting: SlideSetting, weighted: list[tuple[SlideTerm, float]], only: Unknown | None = None
) -> _Problem:
    """The problem of some terms, for all unknowns or those of one group alone."""
    present = tuple((t, w) for t, w in weighted if len(t.blocks(setting)[0].ids))
    layout = setting.layout
    is_free = np.ones(int(layout.starts[-1]), bool)
    if only is not None:
        is_free[: layout.starts[only]] = is_free[layout.starts[only + 1] :] = False
    units = np.ones(len(is_free))
    rows, _, poles = layout.split(units)
    rows[:, 0], poles[:] = 1 / setting.scales, 1 / setting.node_scales[:, None]
    if setting.has_one_radius:
        layout.split(is_free)[Unknown.ROW][:, 0] = False
    pattern = jacobian_pattern(layout, [term.blocks(setting) for term, _ in present])
    return _Problem(setting, present, pattern, is_free, units)


def _minimized(problem: _Problem, start: SlidState, tolerance: float, steps: int) -> SlidState:
    return levenberg_marquardt(
        start,
        lambda state: _energies(problem, state),
        lambda state: _linearized(problem, state),
        lambda state, step: slid_by(problem.setting, state, step),
        tolerance=tolerance,
        max_iterations=steps,
        least_energy=EXACT_ENERGY,
    ).state


def _energies(problem: _Problem, state: SlidState) -> FloatArray:
    return np.array(
        [
            weight**2 * (term.residuals(problem.setting, state) ** 2).sum()
            for term, weight in problem.terms
        ]
    )


def _linearized(problem: _Problem, state: SlidState) -> Callable[[float], DampedStep]:
    """Steps from a state: from a damping, which multiplies the squared step, to the step."""
    from scipy.sparse import diags_array

    setting = problem.setting
    residuals = np.concatenate([w * t.residuals(setting, state) for t, w in problem.terms])
    entries = [
        [weight * table for table in term.jacobian(setting, state)]
        for term, weight in problem.terms
    ]
    free = np.flatnonzero(problem.is_free)
    jacobian = jacobian_matrix(problem.pattern, entries)[:, free]
    product, slope = jacobian.T @ jacobian, jacobian.T @ residuals
    units = problem.units[free] ** 2
    ridge = STEP_RIDGE * product.diagonal()

    def _step(damping: float) -> DampedStep:
        solve = factorize_symmetric(product + diags_array(damping * units + ridge))
        part = -solve(slope)
        step = np.zeros(len(problem.is_free))
        step[free] = part
        ahead = residuals + jacobian @ part
        return DampedStep(step, float(dot(ahead, ahead)))

    return _step
