"""Symmetric systems on graphs: solved if definite, and told if not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh.kernel.arrays import FloatArray, sum_by
from spheremesh.kernel.solvers.definite_systems import (
    GraphMatrix,
    graph_pattern,
    is_definite,
    lowest_mode,
    solve_if_definite,
)


def on_a_grid(
    seed: int, rows: int, columns: int, shift: float
) -> tuple[GraphMatrix, FloatArray]:
    """Random edge entries; the diagonal is theirs in sum, and more by a shift. Also dense."""
    rng = np.random.default_rng(seed)
    place = rng.permutation(rows * columns).reshape(rows, columns)
    pairs = np.concatenate(
        [
            np.stack([place[:-1].ravel(), place[1:].ravel()], 1),
            np.stack([place[:, :-1].ravel(), place[:, 1:].ravel()], 1),
        ]
    )
    mixed = rng.normal(size=len(pairs))
    size = place.size
    diagonal = shift + sum_by(pairs.ravel(), np.repeat(np.abs(mixed), 2), size)
    dense = np.diag(diagonal)
    np.add.at(dense, tuple(pairs.T), mixed)
    np.add.at(dense, tuple(pairs[:, ::-1].T), mixed)
    return GraphMatrix(graph_pattern(pairs, size), diagonal, mixed), dense


@given(seed=st.integers(0, 1000), rows=st.integers(2, 9), columns=st.integers(2, 40))
def test_definite_systems_are_solved(seed: int, rows: int, columns: int) -> None:
    matrix, dense = on_a_grid(seed, rows, columns, 1e-3)
    right = np.random.default_rng(seed).normal(size=len(dense))
    found = solve_if_definite(matrix, right, 1e-12)
    assert found is not None
    np.testing.assert_allclose(dense @ found, right, atol=1e-7)
    assert is_definite(matrix, 0.0)


@pytest.mark.parametrize("columns", [3, 60])
def test_ill_conditioned_chains_are_factorised(columns: int) -> None:
    """A Laplacian of a long chain: conjugate gradients do not settle in time."""
    size = 50 * columns
    pairs = np.stack([np.arange(size - 1), np.arange(1, size)], 1)
    diagonal = np.full(size, 2.0)
    matrix = GraphMatrix(graph_pattern(pairs, size), diagonal, np.full(size - 1, -1.0))
    right = np.ones(size)
    found = solve_if_definite(matrix, right)
    assert found is not None
    # The parabola that vanishes one step beyond either end.
    x = np.arange(1.0, size + 1)
    np.testing.assert_allclose(found, x * (size + 1 - x) / 2, rtol=1e-5)


@given(seed=st.integers(0, 1000), share=st.floats(0.01, 0.9))
def test_inertia_is_that_of_the_eigenvalues(seed: int, share: float) -> None:
    matrix, dense = on_a_grid(seed, 5, 6, 0.0)
    least, most = np.linalg.eigvalsh(dense)[[0, -1]]
    lower = GraphMatrix(
        matrix.pattern, matrix.diagonal - least - share * (most - least), matrix.mixed
    )
    higher = GraphMatrix(matrix.pattern, matrix.diagonal - least + 0.01, matrix.mixed)
    assert not is_definite(lower, 1e-8)
    assert is_definite(higher, 1e-8)
    right = np.random.default_rng(seed).normal(size=len(dense))
    # A right side with parts along all directions does not pass.
    assert solve_if_definite(lower, right) is None or share < 0.1


@pytest.mark.parametrize("columns", [5, 60])
def test_the_lowest_mode_is_an_eigenvector(columns: int) -> None:
    matrix, dense = on_a_grid(3, 6, columns, -1.0)
    value, mode = lowest_mode(matrix)
    assert value == pytest.approx(np.linalg.eigvalsh(dense)[0], abs=1e-6)
    np.testing.assert_allclose(dense @ mode, value * mode, atol=1e-3)


def test_nothing_is_definite_up_to_a_slack() -> None:
    matrix = GraphMatrix(graph_pattern(np.zeros((0, 2), int), 3), np.zeros(3), np.zeros(0))
    assert is_definite(matrix, 1e-8)
    barely = GraphMatrix(matrix.pattern, np.array([1.0, -1e-9, 1.0]), np.zeros(0))
    assert is_definite(barely, 1e-8)
    assert not is_definite(barely, 1e-10)
