"""Damped Gauss-Newton steps of large sparse problems.

``(JᵀJ + μ σ I) x = -Jᵀr`` is solved by conjugate gradients on J itself, never forming ``JᵀJ``,
with the inverted diagonal blocks as preconditioner. Where these do not settle and the problem
is small enough, the matrix is formed and factorised.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, dot
from ..tolerances import STEP_MODEL
from .blocks import JacobianPattern, Layout, block_diagonal, diagonal_blocks, jacobian_matrix
from .conjugate_gradients import truncated_step
from .factorization import SparseArray, solve_definite
from .levenberg_marquardt import DampedStep
from .products import normal_product

MAX_PRODUCTS = 300
"""Largest number of products of one step."""

MAX_OPERATIONS = 2 * 10**9
"""Entries of J visited by the conjugate gradients of one step: a large problem gets rougher
steps, and more of them."""

MAX_FACTORIZED = 100_000
"""Unknowns up to which a factorisation costs less than the iterations that it saves."""


@dataclass(frozen=True)
class Linearization:
    """A least-squares problem near a point.

    Attributes
    ----------
    jacobian : (m, n) csr_array
        Derivatives of the residuals.
    residuals : (m,) float array
        Residuals.
    blocks : tuple of (count, width, width) float arrays
        Diagonal blocks of ``JᵀJ``.
    """

    layout: Layout
    jacobian: SparseArray
    residuals: FloatArray
    blocks: tuple[FloatArray, ...]


def linearization(
    pattern: JacobianPattern, residuals: FloatArray, entries: Sequence[Sequence[FloatArray]]
) -> Linearization:
    """Collect what a step needs: residuals (m,), and derivatives (m, width) block by block."""
    return Linearization(
        pattern.layout,
        jacobian_matrix(pattern, entries),
        residuals,
        diagonal_blocks(pattern, entries),
    )


def damped_step(
    problem: Linearization, damping: float, share: float = STEP_MODEL
) -> DampedStep:
    """Step that minimises ``|r + J x|² + μ σ |x|²``.

    The damping is μ; the scale σ is the mean of the diagonal of ``JᵀJ``; `share` is the gain of
    the model that a step may leave out, as in `truncated_step`. Also the energy of the linear
    model after the step. Unknowns on which no residual depends do not move.
    """
    jacobian, multiply = problem.jacobian, normal_product(problem.jacobian)
    traces = [float(np.trace(blocks, axis1=1, axis2=2).sum()) for blocks in problem.blocks]
    shift = damping * sum(traces) / int(problem.layout.starts[-1])
    right = -(jacobian.T @ problem.residuals)
    inverse = _block_inverse(problem.blocks, shift)

    budget = MAX_OPERATIONS // max(2 * jacobian.nnz, 1)
    step, is_settled = truncated_step(
        lambda vector: multiply(vector) + shift * vector,
        lambda vector: inverse @ vector,
        right,
        int(min(MAX_PRODUCTS, budget)),
        share,
    )
    if not is_settled and len(right) <= MAX_FACTORIZED:
        step = solve_definite(jacobian.T @ jacobian, shift, right)
    model = problem.residuals + jacobian @ step
    return DampedStep(step, float(dot(model, model)))


def _block_inverse(blocks: tuple[FloatArray, ...], shift: float) -> SparseArray:
    from scipy.sparse import block_diag

    inverses = [
        np.asarray(np.linalg.inv(table + shift * np.eye(table.shape[1])), np.float64)
        for table in blocks
        if len(table)
    ]
    return block_diag([block_diagonal(table) for table in inverses], format="csr")
