"""Multiplication by ``JᵀJ`` without forming it."""

import importlib.util
from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

import numpy as np

from ..arrays import FloatArray
from .factorization import SparseArray

Product: TypeAlias = Callable[[FloatArray], FloatArray]
"""A square matrix as what it does to a vector."""


def normal_product(matrix: SparseArray) -> Product:
    """Multiplication by ``JᵀJ``: (n,) vector x to ``Jᵀ (J x)``.

    With numba installed, J (csr) is read once instead of twice; the sums run in the same order.
    """
    if importlib.util.find_spec("numba") is None:
        return normal_product_by_scipy(matrix)
    return normal_product_by_numba(matrix)


def normal_product_by_scipy(matrix: SparseArray) -> Product:
    """`normal_product` in two passes."""
    transposed = matrix.T
    return lambda vector: transposed @ (matrix @ vector)


def normal_product_by_numba(matrix: SparseArray) -> Product:
    """`normal_product` row by row, compiled."""
    sweep = _sweep()
    # Unsigned indices spare numba the question whether they count from the end.
    columns, starts = matrix.indices.view(np.uint32), matrix.indptr.astype(np.uint64)
    return lambda vector: sweep(matrix.data, columns, starts, vector)


@cache
def _sweep() -> Any:  # noqa: ANN401
    import numba

    compiler: Any = numba

    @compiler.njit(cache=True, error_model="numpy")
    def _rows(data: Any, columns: Any, starts: Any, vector: Any) -> Any:  # noqa: ANN401
        result = np.zeros_like(vector)
        for row in range(len(starts) - 1):
            total = 0.0
            for entry in range(starts[row], starts[row + 1]):
                total += data[entry] * vector[columns[entry]]
            for entry in range(starts[row], starts[row + 1]):
                result[columns[entry]] += data[entry] * total
        return result

    return _rows
