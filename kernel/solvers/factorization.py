"""Direct solution of sparse systems."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from ..arrays import FloatArray
from ..errors import ConvergenceError

SparseArray: TypeAlias = Any
"""A sparse array of SciPy, whose types do not say much yet."""


Solver: TypeAlias = Callable[[FloatArray], FloatArray]
"""Takes right sides (n,) or (n, k) to solutions of the same shape."""


def factorize(matrix: SparseArray) -> Solver:
    """Factorise an invertible matrix: a function that solves with it.

    Raises
    ------
    ConvergenceError
        If the matrix is singular.
    """
    return _solver(matrix)


def factorize_symmetric(matrix: SparseArray) -> Solver:
    """Factorise a symmetric positive definite matrix: a function that solves with it.

    Raises
    ------
    ConvergenceError
        If the matrix is singular.

    Notes
    -----
    SuperLU with minimum degree on the symmetric pattern and pivots on the diagonal: several
    times faster than its default for such matrices.
    """
    return _solver(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _solver(matrix: SparseArray, **options: object) -> Solver:
    from scipy.sparse.linalg import splu

    factorized: Any = splu
    try:
        factors = factorized(matrix.tocsc(), **options)
    except RuntimeError as error:  # a pivot is exactly zero
        raise ConvergenceError(
            "the linear equations of a step cannot be solved: weights or lengths of too "
            "different sizes meet in them; bring them closer together"
        ) from error

    def _solve(right: FloatArray) -> FloatArray:
        return np.asarray(factors.solve(right), np.float64)

    return _solve


def solve_definite(matrix: SparseArray, shift: float, right: FloatArray) -> FloatArray:
    """Solve ``(H + shift I) x = b`` by factorisation.

    H is symmetric, positive semidefinite, the shift positive.
    """
    from scipy.sparse import csc_array, eye_array

    shifted: SparseArray = csc_array(matrix + shift * eye_array(len(right)))
    return factorize_symmetric(shifted)(right)
