"""Symmetric systems with one unknown per node of a graph, solved if they are definite.

Conjugate gradients first, which notice negative curvature on their way; where they do not
settle, a factorisation. The signs of its pivots are those of the eigenvalues (Sylvester's law
of inertia): a matrix that is not definite is not taken for one.
"""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from ..arrays import FloatArray, IntArray, dot
from ..tolerances import EPSILON, LINEAR_SOLVE
from .factorization import Solver, SparseArray

LEAST_GRADIENTS, MOST_GRADIENTS = 60, 300
"""Conjugate gradients that cost as much as a factorisation, of small and of large systems."""
UNKNOWNS_PER_GRADIENT = 200
"""Between the two, unknowns for each of them."""

MOST_DENSE = 200
"""Unknowns up to which a dense eigenproblem is the fastest."""


@dataclass(frozen=True)
class GraphPattern:
    """Compressed rows of a symmetric matrix with a diagonal and one entry per edge of a graph.

    Attributes
    ----------
    order : (n + 2 m,) int array
        Sorts the entries (diagonal, edges, transposed edges) into rows.
    columns : (n + 2 m,) int array
        Column of each sorted entry; an edge that occurs twice is summed.
    starts : (n + 1,) int array
        First entry of each row.
    """

    order: IntArray
    columns: IntArray
    starts: IntArray


def graph_pattern(pairs: IntArray, size: int) -> GraphPattern:
    """Pattern of the (n, n) matrices whose entries sit on the diagonal and on pairs (m, 2).

    The unknowns of a pair differ, in any order. Built once, used by every solve.
    """
    a, b = pairs.T
    rows = np.concatenate([np.arange(size), a, b])
    columns = np.concatenate([np.arange(size), b, a])
    order = np.argsort(rows, kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=size))])
    return GraphPattern(order, columns[order], starts)


@dataclass(frozen=True)
class GraphMatrix:
    """A symmetric matrix with a diagonal and one entry per edge of a graph.

    Attributes
    ----------
    pattern : GraphPattern
    diagonal : (n,) float array
    mixed : (m,) float array
        Entry of each edge.
    """

    pattern: GraphPattern
    diagonal: FloatArray
    mixed: FloatArray


def solve_if_definite(
    matrix: GraphMatrix, right: FloatArray, residual: float = LINEAR_SOLVE
) -> FloatArray | None:
    """Solve ``H x = b``, (n,), to a relative residual; None where H has negative curvature.

    A matrix that is not definite may pass where b has no part along its negative directions:
    x goes downhill then, too.
    """
    if (matrix.diagonal <= 0).any():
        return None
    rows = _compressed(matrix, 0.0)
    found = _conjugate_gradients(rows, 1 / matrix.diagonal, right, residual)
    if found is None or len(found) == len(right):
        return found
    solve = _definite_factors(matrix, 4 * EPSILON * float(matrix.diagonal.max()))
    return None if solve is None else solve(right)


def is_definite(matrix: GraphMatrix, slack: float) -> bool:
    """Whether no eigenvalue lies below ``-slack``, relative to the largest of the diagonal."""
    scale = float(np.abs(matrix.diagonal).max(initial=0.0))
    if scale == 0:
        return not matrix.mixed.any()
    if (matrix.diagonal + slack * scale <= 0).any():
        return False
    return _definite_factors(matrix, slack * scale) is not None


def lowest_mode(matrix: GraphMatrix) -> tuple[float, FloatArray]:
    """Lowest eigenvalue and its unit vector (n,); zeros if they are not found."""
    from scipy.sparse.linalg import ArpackNoConvergence, eigsh

    size = len(matrix.diagonal)
    rows = _compressed(matrix, 0.0)
    if size <= MOST_DENSE:
        values, vectors = np.linalg.eigh(rows.toarray())
        return float(values[0]), np.asarray(vectors[:, 0], np.float64)
    try:
        values, vectors = cast("Any", eigsh)(
            rows, k=1, which="SA", v0=irregular(size), tol=1e-6, maxiter=size
        )
    except ArpackNoConvergence:
        return 0.0, np.zeros(size)
    return float(values[0]), np.asarray(vectors[:, 0], np.float64)


def irregular(size: int) -> FloatArray:
    """Numbers (size,) that share no symmetry with a mesh: where to look for eigenvectors."""
    return np.sin(np.arange(1.0, size + 1) ** 2)


def _compressed(matrix: GraphMatrix, shift: float) -> SparseArray:
    """The matrix plus ``shift I``."""
    from scipy.sparse import csr_array

    pattern, size = matrix.pattern, len(matrix.diagonal)
    entries = np.concatenate([matrix.diagonal + shift, matrix.mixed, matrix.mixed])
    rows = (entries[pattern.order], pattern.columns, pattern.starts)
    return csr_array(rows, shape=(size, size))


def _conjugate_gradients(
    rows: SparseArray, inverse: FloatArray, right: FloatArray, share: float
) -> FloatArray | None:
    """Solution; nothing, (0,), where it does not settle; None at negative curvature."""
    solution, residual = np.zeros_like(right), right.copy()
    aim = share**2 * float(dot(right, right))
    if aim == 0:
        return solution
    most = np.clip(len(right) // UNKNOWNS_PER_GRADIENT, LEAST_GRADIENTS, MOST_GRADIENTS)
    near = inverse * residual
    direction, gain = near, float(dot(residual, near))
    for _ in range(int(most)):
        image = rows @ direction
        bend = float(dot(direction, image))
        if bend <= 0:
            return None
        solution += gain / bend * direction
        residual -= gain / bend * image
        if float(dot(residual, residual)) <= aim:
            return solution
        near = inverse * residual
        before, gain = gain, float(dot(residual, near))
        direction = near + gain / before * direction
    return np.zeros(0)


def _definite_factors(matrix: GraphMatrix, shift: float) -> Solver | None:
    """Solver with ``H + shift I``; None where that is not positive definite."""
    from scipy.sparse.linalg import splu

    try:
        factors = cast("Any", splu)(
            _compressed(matrix, shift).tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:  # a pivot is exactly zero
        return None
    # A pivot is sought off the diagonal only where there is none on it.
    is_symmetric = bool((factors.perm_r == factors.perm_c).all())
    if not is_symmetric or not bool((factors.U.diagonal() > 0).all()):
        return None

    def _solve(right: FloatArray) -> FloatArray:
        return np.asarray(factors.solve(right), np.float64)

    return _solve
