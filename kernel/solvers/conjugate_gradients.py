"""Truncated conjugate gradients for the steps of a descent."""

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, dot
from ..tolerances import ROUNDED_DIRECTION, STEP_MODEL
from .products import Product


class CgStep(NamedTuple):
    """A step, and whether more iterations would better it noticeably.

    Attributes
    ----------
    step : (n,) float array
        The step; a direction of descent after any number of iterations.
    is_settled : bool
        Whether the quadratic model has come to rest.
    """

    step: FloatArray
    is_settled: bool


def truncated_step(
    product: Product,
    precondition: Product,
    right: FloatArray,
    max_iterations: int,
    share: float = STEP_MODEL,
) -> CgStep:
    """Minimise the quadratic model ``x·Hx / 2 - x·b`` until it gains no more.

    Parameters
    ----------
    product : callable
        Vector to ``H`` times it; H symmetric, positive definite.
    precondition : callable
        Vector to an approximate inverse of H times it; symmetric, positive definite.
    right : (n,) float array
        Vector b.
    max_iterations : int
        Largest number of products.
    share : float
        Gain, relative to the gain so far, that is not worth waiting for.

    Returns
    -------
    CgStep
        Settled where the gain of an iteration, times their number, fell below this share of
        the gain so far: what follows would add about as much.

    References
    ----------
    Nash, Sofer 1990, Assessing a search direction within a truncated-Newton method.
    """
    step = np.zeros_like(right)
    residual = right.copy()
    direction = precondition(residual)
    slope = first = float(dot(residual, direction))
    gain = 0.0
    for iteration in range(1, max_iterations + 1):
        if not slope > ROUNDED_DIRECTION * first:
            return CgStep(step, is_settled=True)
        image = product(direction)
        curvature = float(dot(direction, image))
        if not curvature > 0:
            # Only rounding makes it so: the directions so far are as good as can be had.
            return CgStep(step, is_settled=False)
        length = slope / curvature
        step += length * direction
        residual -= length * image
        gain += length * slope / 2
        if iteration * length * slope / 2 <= share * gain:
            return CgStep(step, is_settled=True)
        scaled = precondition(residual)
        previous, slope = slope, float(dot(residual, scaled))
        direction = scaled + (slope / previous) * direction
    return CgStep(step, is_settled=False)
