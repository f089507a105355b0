"""Array types and the few operations on rows of vectors that NumPy has no short name for."""

from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]
ComplexArray: TypeAlias = NDArray[np.complex128]


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product along the last axis.

    Parameters
    ----------
    a, b : (..., n) float array
        Vectors, broadcast against each other.

    Returns
    -------
    (...) float array
        Sum of the products of the components.
    """
    return np.einsum("...i,...i->...", a, b)


def norm(a: FloatArray) -> FloatArray:
    """Euclidean length along the last axis.

    Parameters
    ----------
    a : (..., n) float array

    Returns
    -------
    (...) float array
        Lengths.
    """
    return np.sqrt(dot(a, a))


def unit(a: FloatArray) -> FloatArray:
    """Vectors divided by their length; the zero vector stays zero.

    Parameters
    ----------
    a : (..., n) float array

    Returns
    -------
    (..., n) float array
        Unit vectors.
    """
    length = norm(a)[..., None]
    return np.divide(a, length, out=np.zeros_like(a), where=length > 0)


def sum_by(ids: IntArray, values: FloatArray, size: int) -> FloatArray:
    """Sum of the rows that share an id.

    Parameters
    ----------
    ids : (n,) int array
        Group of each row, in ``[0, size)``.
    values : (n,) or (n, m) float array
        Rows to add up.

    Returns
    -------
    (size,) or (size, m) float array
        Sums; zero for a group without rows.
    """
    if values.ndim == 1:
        return np.bincount(ids, values, size).astype(np.float64, copy=False)
    columns = [sum_by(ids, column, size) for column in values.T]
    return np.stack(columns, axis=1)


def gather(table: FloatArray, ids: IntArray) -> FloatArray:
    """Rows of a table, its columns stored one after the other: ``table[ids]``, only faster.

    So do formulas run along all rows and not over the few numbers of each.

    Parameters
    ----------
    table : (n, k) float array
    ids : (m,) int array

    Returns
    -------
    (m, k) float array
        In Fortran order.
    """
    return np.take(table.T, ids, axis=1).T


def batches_by_count(ids: IntArray, size: int) -> Iterator[tuple[IntArray, IntArray]]:
    """Groups of equal size, gathered so that each batch is one array.

    Parameters
    ----------
    ids : (m,) int array
        Group of each row, in ``[0, size)``.

    Yields
    ------
    groups : (n,) int array
        Groups that have k rows each.
    rows : (n, k) int array
        Their rows, in order.
    """
    counts = np.bincount(ids, minlength=size)
    order = np.argsort(ids, kind="stable")
    starts = np.cumsum(counts) - counts
    for count in np.unique(counts[counts > 0]).tolist():
        chosen = np.flatnonzero(counts == count)
        yield chosen, order[starts[chosen][:, None] + np.arange(count)]


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """The same array, closed for writing.

    Parameters
    ----------
    array : array
        Array that nobody else writes to.

    Returns
    -------
    array
        `array` itself.
    """
    array.flags.writeable = False
    return array
