"""Multiplication by ``JᵀJ`` without forming it."""

import importlib.util
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from ..arrays import FloatArray

Product = Callable[[FloatArray], FloatArray]


def normal_product(matrix: Any) -> Product:  # noqa: ANN401 - scipy is loaded late
    """
    Multiplication by ``JᵀJ``.

    Parameters
    ----------
    matrix : (m, n) csr_array
        The matrix J.

    Returns
    -------
    callable
        (n,) vector x to ``Jᵀ (J x)``. With numba installed, J is read once instead of twice;
        the sums run in the same order.
    """
    if importlib.util.find_spec("numba") is None:
        return normal_product_by_scipy(matrix)
    return normal_product_by_numba(matrix)


def normal_product_by_scipy(matrix: Any) -> Product:  # noqa: ANN401
    """
    Multiplication by ``JᵀJ`` in two passes.

    Parameters
    ----------
    matrix : (m, n) csr_array
        The matrix J.

    Returns
    -------
    callable
        (n,) vector x to ``Jᵀ (J x)``.
    """
    transposed = matrix.T

    def _product(vector: FloatArray) -> FloatArray:
        return transposed @ (matrix @ vector)

    return _product


def normal_product_by_numba(matrix: Any) -> Product:  # noqa: ANN401
    """
    Multiplication by ``JᵀJ``, row by row.

    Parameters
    ----------
    matrix : (m, n) csr_array
        The matrix J.

    Returns
    -------
    callable
        (n,) vector x to ``Jᵀ (J x)``.
    """
    sweep = _sweep()
    # Unsigned indices spare numba the question whether they count from the end.
    columns, starts = matrix.indices.view(np.uint32), matrix.indptr.astype(np.uint64)

    def _product(vector: FloatArray) -> FloatArray:
        return sweep(matrix.data, columns, starts, vector)

    return _product


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
