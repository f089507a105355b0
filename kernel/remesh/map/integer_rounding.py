"""Whole-number minima of small quadratic functions under whole-number relations."""

from typing import NamedTuple

import numpy as np

from ...arrays import FloatArray
from ...tolerances import GAUGE_RANK


class ContradictionError(ArithmeticError):
    """No whole numbers satisfy the equations; callers drop some of them."""


class IntegerSolutions(NamedTuple):
    """All solutions ``offset + basis @ y`` of linear equations in whole numbers.

    Attributes
    ----------
    offset : (m,) float array
        One solution.
    basis : (m, k) float array
        Unimodular basis of the solutions of the homogeneous equations.
    """

    offset: FloatArray
    basis: FloatArray


def integer_solutions(relations: FloatArray, constants: FloatArray) -> IntegerSolutions:
    """Solve linear equations in whole numbers: relations (r, m), right sides (r,).

    Raises
    ------
    ContradictionError
        If whole numbers cannot satisfy the equations.

    Notes
    -----
    Euclid's algorithm on the columns, row after row (Hermite normal form).
    """
    count = relations.shape[1]
    columns, change = relations.astype(float).copy(), np.eye(count)
    is_open = np.ones(count, bool)
    values = np.zeros(count)
    for row, constant in enumerate(constants):
        while True:
            entries = np.where(is_open, np.abs(columns[row]), 0)
            active = np.flatnonzero(entries)
            if len(active) < 2:
                break
            pivot = active[np.argmin(entries[active])]
            others = active[active != pivot]
            factors = np.rint(columns[row, others] / columns[row, pivot])
            columns[:, others] -= columns[:, [pivot]] * factors
            change[:, others] -= change[:, [pivot]] * factors
        rest = constant - columns[row, ~is_open] @ values[~is_open]
        if len(active) == 0:
            if rest != 0:
                raise ContradictionError
            continue
        value = rest / columns[row, active[0]]
        if value != np.rint(value):
            raise ContradictionError
        values[active[0]], is_open[active[0]] = value, False
    return IntegerSolutions(change[:, ~is_open] @ values[~is_open], change[:, is_open])


class Quadratic(NamedTuple):
    """The function ``n H n / 2 - g n``.

    Attributes
    ----------
    hessian : (m, m) float array
        Positive semidefinite matrix H.
    gradient : (m,) float array
        The vector g.
    scale : float
        Size that entries of H have by themselves: eigenvalues far below belong to freedoms.
    """

    hessian: FloatArray
    gradient: FloatArray
    scale: float


def relaxed_minimum(function: Quadratic, solutions: IntegerSolutions) -> FloatArray:
    """The minimum (m,) of a quadratic function if numbers need not be whole.

    Of several minima the one nearest to the offset of the solutions.
    """
    offset, basis = solutions
    right = basis.T @ (function.gradient - function.hessian @ offset)
    values = _solve(basis.T @ function.hessian @ basis, right, function.scale)
    return offset + basis @ values


def round_minimum(function: Quadratic, solutions: IntegerSolutions, n_first: int) -> FloatArray:
    """Whole numbers (m,) that satisfy the equations, near the minimum of a quadratic function.

    The first `n_first` entries of n are rounded before the others.

    Notes
    -----
    Greedy: the value nearest to a whole number is fixed, the others follow; then single steps
    as long as one of them lowers the function.
    """
    offset, basis = solutions
    matrix = basis.T @ function.hessian @ basis
    right = basis.T @ (function.gradient - function.hessian @ offset)
    is_first = (basis[:n_first] != 0).any(axis=0)
    values = _solve(matrix, right, function.scale)
    is_open = np.ones(len(values), bool)
    for group in (is_first, ~is_first):
        while (is_open & group).any():
            candidates = np.flatnonzero(is_open & group)
            misses = np.abs(values[candidates] - np.rint(values[candidates]))
            chosen = candidates[np.argmin(misses)]
            values[chosen], is_open[chosen] = np.rint(values[chosen]), False
            rest = right[is_open] - matrix[np.ix_(is_open, ~is_open)] @ values[~is_open]
            open_part = matrix[np.ix_(is_open, is_open)]
            values[is_open] = _solve(open_part, rest, function.scale)
    _descend(matrix, right, values, function.scale)
    return np.rint(offset + basis @ values)


def _solve(matrix: FloatArray, right: FloatArray, scale: float) -> FloatArray:
    """Solution without any share of the freedoms."""
    sizes, axes = np.linalg.eigh(matrix)
    is_bound = sizes > GAUGE_RANK * scale
    shares = np.where(is_bound, axes.T @ right / np.where(is_bound, sizes, 1.0), 0.0)
    return axes @ shares


def _descend(matrix: FloatArray, right: FloatArray, values: FloatArray, scale: float) -> None:
    """Single steps of one, in place, while the function falls by more than rounding."""
    diagonal = np.diag(matrix)
    for _ in range(100 * len(values)):
        slope = matrix @ values - right
        gains = np.abs(slope) - diagonal / 2
        if len(gains) == 0 or gains.max() <= GAUGE_RANK * scale:
            return
        best = int(np.argmax(gains))
        values[best] -= np.sign(slope[best])
