"""Many small programs at once, by a primal-dual interior point method.

Each has the same few unknowns and functions that are nearly linear. Where the system of a step
is not positive, curvature that bends the wrong way is left out of it; what is solved stays the
same.
"""

from collections.abc import Callable

import numpy as np

from ..arrays import BoolArray, FloatArray, dot
from ..tolerances import EPSILON

Functions = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Values (n, m) and gradients (n, m, k) of functions of unknowns (n, k)."""

Curvature = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Curvature (n, k, k) of the functions, weighted by multipliers (n, m), and its positive part.

With the sign changed: positive where functions bend down.
"""

_STAY = 0.99
"""Share of the way to the bound that a step may go."""

_CENTERING = 0.15
"""To which share of it each step takes the gap to the minimum."""

_BEGIN = 0.01
"""Slack to begin with: small, so that of several minima that near the start is found."""

_LEAST = 1e-13
"""Least curvature of a system, along directions in which nothing changes."""

_LEAST_GAP = 1e-16
"""Where the gap to the minimum ends; unknowns then still move along nearly parallel faces."""


def minimize_within(
    start: FloatArray,
    quadratic: FloatArray,
    linear: FloatArray,
    functions: Functions,
    curvature: Curvature,
    rounds: int,
) -> FloatArray:
    """Minimise ``w·Q w / 2 + q·w`` where all functions are at least zero.

    Parameters
    ----------
    start : (n, k) float array
        Where to begin; need not be admissible.
    quadratic : (k, k) float array
        Q, positive semidefinite.
    linear : (k,) float array
        The vector q.
    functions, curvature : callable
        The functions g ≥ 0.
    rounds : int
        Number of steps; each takes the gap to the minimum down to about a sixth.

    Returns
    -------
    (n, k) float array
        Stationary points; the best near the start where the functions are nearly linear.
    """
    unknowns: FloatArray = start.copy()
    values, slopes = functions(unknowns)
    slacks: FloatArray = np.maximum(values, _BEGIN)
    forces: FloatArray = _BEGIN**2 / slacks
    eye = np.eye(start.shape[1])
    for _ in range(rounds):
        gap = dot(slacks, forces)[:, None] / slacks.shape[1]
        target = np.maximum(_CENTERING * gap, _LEAST_GAP)
        dual: FloatArray = (
            unknowns @ quadratic + linear - np.einsum("nmk,nm->nk", slopes, forces)
        )
        miss: FloatArray = values - slacks
        weights: FloatArray = forces / slacks
        system = np.einsum("nmk,nm,nml->nkl", slopes, weights, slopes, optimize=True)
        scale = 8 * EPSILON * np.trace(system, axis1=1, axis2=2)
        system += quadratic + (_LEAST + scale)[:, None, None] * eye
        system = _positive_sum(system, *curvature(forces))
        pull: FloatArray = target / slacks - forces - weights * miss
        right: FloatArray = np.einsum("nmk,nm->nk", slopes, pull) - dual
        step: FloatArray = np.asarray(
            np.linalg.solve(system, right[..., None])[..., 0], np.float64
        )
        opening: FloatArray = np.einsum("nmk,nk->nm", slopes, step) + miss
        pushing: FloatArray = target / slacks - forces - weights * opening
        near, far = _longest(slacks, opening), _longest(forces, pushing)
        unknowns += near * step
        slacks += near * opening
        forces += far * pushing
        values, slopes = functions(unknowns)
    return unknowns


def _longest(values: FloatArray, changes: FloatArray) -> FloatArray:
    """Longest steps (n, 1), at most 1, that keep values positive."""
    shares = np.divide(-_STAY * values, changes, out=np.ones_like(values), where=changes < 0)
    return np.minimum(shares.min(axis=1), 1.0)[:, None]


def _positive_sum(systems: FloatArray, whole: FloatArray, positive: FloatArray) -> FloatArray:
    """Systems plus curvature, with as little of what bends the wrong way left out as needed."""
    result = systems + positive
    for share in (0.1, 0.01, 0.0):
        trial = systems + share * positive + (1 - share) * whole
        use = _are_positive(trial)[:, None, None]
        result = np.where(use, trial, result)
    return result


def _are_positive(matrices: FloatArray) -> BoolArray:
    """Which symmetric matrices (n, k, k) are positive definite, by their pivots."""
    left = matrices.copy()
    least = EPSILON * np.trace(matrices, axis1=1, axis2=2)
    result = np.ones(len(left), bool)
    for i in range(left.shape[1]):
        pivot = left[:, i, i]
        result &= pivot > least
        column = left[:, i + 1 :, i] / np.where(result, pivot, 1.0)[:, None]
        left[:, i + 1 :, i + 1 :] -= column[:, :, None] * left[:, i, None, i + 1 :]
    return result
