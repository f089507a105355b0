"""Symmetric systems with one unknown per face and one entry per edge."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..tolerances import LINEAR_SOLVE

MAX_CG_ITERATIONS = 400


@dataclass(frozen=True)
class SymmetricPattern:
    """Compressed rows of a symmetric matrix with a diagonal and one entry per pair.

    Attributes
    ----------
    order : (n + 2 m,) int array
        Sorts the entries (diagonal, pairs, transposed pairs) into rows.
    columns : (n + 2 m,) int array
        Column of each sorted entry; a pair that occurs twice is summed.
    starts : (n + 1,) int array
        First entry of each row.
    """

    order: IntArray
    columns: IntArray
    starts: IntArray


def symmetric_pattern(pairs: IntArray, size: int) -> SymmetricPattern:
    """Pattern of the (n, n) matrices whose entries sit on the diagonal and on pairs (m, 2).

    The unknowns of a pair differ, in any order. Built once, used by every solve.
    """
    a, b = pairs.T
    rows = np.concatenate([np.arange(size), a, b])
    columns = np.concatenate([np.arange(size), b, a])
    order = np.argsort(rows, kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=size))])
    return SymmetricPattern(order, columns[order], starts)


def solve_symmetric(
    pattern: SymmetricPattern, diagonal: FloatArray, mixed: FloatArray, right: FloatArray
) -> FloatArray:
    """Solve by conjugate gradients with the diagonal as preconditioner.

    Of the matrix the diagonal (n,), no entry zero, and the entries (m,) of the pairs. The
    relative residual is `LINEAR_SOLVE`. For an indefinite matrix the result is some vector: the
    caller accepts a step only if its energy falls.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import LinearOperator, cg

    shape = (len(diagonal), len(diagonal))
    entries = np.concatenate([diagonal, mixed, mixed])[pattern.order]
    matrix: Any = csr_array((entries, pattern.columns, pattern.starts), shape=shape)
    inverse = 1 / np.abs(diagonal)

    jacobi: Any = LinearOperator(shape, matvec=lambda right: inverse * right, dtype=np.float64)
    solution, _ = cg(matrix, right, rtol=LINEAR_SOLVE, maxiter=MAX_CG_ITERATIONS, M=jacobi)
    return np.asarray(solution, np.float64)
