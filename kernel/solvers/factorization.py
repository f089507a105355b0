"""Direct solution of sparse systems."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from ..arrays import FloatArray

SparseArray: TypeAlias = Any
"""A sparse array of SciPy, whose types do not say much yet."""


def factorize_symmetric(matrix: SparseArray) -> Callable[[FloatArray], FloatArray]:
    """
    Factorise a symmetric positive definite matrix.

    Parameters
    ----------
    matrix : (n, n) sparse array
        The matrix.

    Returns
    -------
    callable
        Takes right sides (n,) or (n, k) to solutions of the same shape.

    Notes
    -----
    SuperLU with minimum degree on the symmetric pattern and pivots on the diagonal: several
    times faster than its default for such matrices.
    """
    from scipy.sparse.linalg import splu

    solver: Any = splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )

    def _solve(right: FloatArray) -> FloatArray:
        return np.asarray(solver.solve(right), np.float64)

    return _solve
