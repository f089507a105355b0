"""Block systems against dense algebra; nested dissection; what is not positive definite."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csc_array

from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.errors import ConvergenceError
from spheremesh.kernel.solvers.block_patterns import add_up, hessian_pattern
from spheremesh.kernel.solvers.block_systems import (
    Blocks,
    factorize_system,
    system_pattern,
)
from spheremesh.kernel.solvers.blocks import (
    Block,
    Layout,
    jacobian_matrix,
    jacobian_pattern,
)
from spheremesh.kernel.solvers.dissection import SMALLEST_SET, dissect
from spheremesh.kernel.solvers.factorization import (
    factorize,
    factorize_symmetric,
    solve_definite,
)
from spheremesh.kernel.solvers.multifrontal import (
    factorize_fronts,
    frontal_pattern,
    solve_fronts,
)


def grid(size: int, seed: int) -> tuple[FloatArray, IntArray]:
    """Cells of a grid in a random order, and those that share a corner."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    ids = random.permutation(size * size).reshape(size, size)
    points = np.empty((size * size, 3))
    points[ids.ravel()] = np.stack([x, y, 0.01 * x * y], -1).reshape(-1, 3)
    pairs = [
        np.stack([a.ravel(), b.ravel()], axis=1)
        for a, b in (
            (ids[:-1], ids[1:]),
            (ids[:, :-1], ids[:, 1:]),
            (ids[:-1, :-1], ids[1:, 1:]),
            (ids[:-1, 1:], ids[1:, :-1]),
        )
    ]
    return points, np.concatenate(pairs)


@given(size=st.integers(1, 25), seed=st.integers(0, 9))
def test_separators_separate(size: int, seed: int) -> None:
    """Elements that touch share a node of the tree, or one lies above the other."""
    points, pairs = grid(size, seed)
    nodes = dissect(points, pairs)
    assert (nodes >= 1).all()
    low, high = np.sort(nodes[pairs], axis=1).T
    while (high > low).any():
        high = np.where(high > low, high // 2, high)
    np.testing.assert_array_equal(high, low)
    assert np.bincount(nodes).max() <= max(SMALLEST_SET, 2 * size)


def test_elements_at_one_place_are_separated_too() -> None:
    count = 3 * SMALLEST_SET
    pairs = np.stack(np.triu_indices(count, 1), axis=1)
    nodes = dissect(np.zeros((count, 3)), pairs)
    # All touch all: one chain from the root down.
    assert all(node == 1 or node // 2 in set(nodes.tolist()) for node in nodes.tolist())


@pytest.mark.parametrize("size", [1, 2, 9, 17])
def test_fronts_solve_as_dense_algebra(size: int) -> None:
    points, pairs = grid(size, 3)
    random = np.random.default_rng(0)
    width, count = 3, size * size
    mixed = 0.3 * random.normal(size=(len(pairs), width, width))
    diagonal = np.tile(5.0 * np.eye(width), (count, 1, 1))
    dense = np.zeros((count, width, count, width))
    dense[np.arange(count), :, np.arange(count)] = diagonal
    dense[pairs[:, 0], :, pairs[:, 1]] = mixed
    dense[pairs[:, 1], :, pairs[:, 0]] = mixed.transpose(0, 2, 1)
    dense = dense.reshape(count * width, count * width)
    pattern = frontal_pattern(points, pairs, width)
    factors = factorize_fronts(pattern, diagonal, mixed)
    assert factors is not None
    right = random.normal(size=(count, width))
    expected = np.linalg.solve(dense, right.ravel())
    np.testing.assert_allclose(solve_fronts(factors, right).ravel(), expected, rtol=1e-10)
    lowest = np.linalg.eigvalsh(dense)[0]
    for shift, is_definite in ((-1.001 * lowest, False), (-0.999 * lowest, True)):
        moved = diagonal + shift * np.eye(width)
        assert (factorize_fronts(pattern, moved, mixed) is not None) == is_definite


def three_groups() -> tuple[dict[tuple[int, int], IntArray], tuple[FloatArray, ...]]:
    """Faces that share edges and corners; nodes at the corners; vertices that touch too."""
    points, pairs = grid(6, 1)
    random = np.random.default_rng(5)
    corner_faces, corners = np.divmod(np.arange(36 * 4), 4)
    corner_ids = (corner_faces * 7 + corners * 3) % 30
    joined = np.unique(np.stack([corner_faces, corner_ids], axis=1), axis=0)
    found = {(0, 0): np.unique(np.sort(pairs, axis=1), axis=0), (0, 1): joined}
    found[0, 2] = joined[joined[:, 1] < 20]
    return found, (points, random.normal(size=(30, 3)), random.normal(size=(20, 3)))


@pytest.mark.parametrize("vertices_touch", [False, True])
def test_systems_of_three_groups_solve_as_dense_algebra(vertices_touch: bool) -> None:  # noqa: FBT001
    pairs, points = three_groups()
    if vertices_touch:
        pairs[1, 1] = np.stack([np.arange(29), np.arange(1, 30)], axis=1)
    widths = (4, 3, 2)
    random = np.random.default_rng(2)
    counts = [len(table) for table in points]
    starts = np.cumsum([0, *np.multiply(counts, widths)])
    dense = np.zeros((starts[-1], starts[-1]))
    diagonal, mixed = [], {}
    for group, (count, width) in enumerate(zip(counts, widths, strict=True)):
        table = np.tile(8.0 * np.eye(width), (count, 1, 1))
        diagonal.append(table)
        for element in range(count):
            place = slice(
                starts[group] + width * element, starts[group] + width * (element + 1)
            )
            dense[place, place] = table[element]
    for (g, h), ids in pairs.items():
        tables = 0.3 * random.normal(size=(len(ids), widths[g], widths[h]))
        mixed[g, h] = tables
        for (i, j), table in zip(ids.tolist(), tables, strict=True):
            rows = slice(starts[g] + widths[g] * i, starts[g] + widths[g] * (i + 1))
            columns = slice(starts[h] + widths[h] * j, starts[h] + widths[h] * (j + 1))
            dense[rows, columns] = table
            dense[columns, rows] = table.T
    pattern = system_pattern(pairs, widths, points)
    assert len(pattern.eliminations) == (1 if vertices_touch else 2)
    right = random.normal(size=len(dense))
    lowest = np.linalg.eigvalsh(dense)[0]
    for shift in (1.0, -0.99 * lowest):
        solve = factorize_system(pattern, Blocks(tuple(diagonal), mixed), shift)
        assert solve is not None
        expected = np.linalg.solve(dense + shift * np.eye(len(dense)), right)
        np.testing.assert_allclose(solve(right), expected, rtol=1e-7, atol=1e-7)
    assert factorize_system(pattern, Blocks(tuple(diagonal), mixed), -1.01 * lowest) is None


def test_tables_add_up_to_where_they_belong() -> None:
    """Pairs of one group in any order, elements paired with themselves, an empty group."""
    layout = Layout((3, 0), (2, 5))
    first, second = np.array([0, 2, 1, 2]), np.array([1, 0, 0, 2])
    blocks = (Block(0, first), Block(0, second), Block(1, np.zeros(4, np.int64)))
    pattern = hessian_pattern(layout, [blocks])
    assert pattern.pairs[0, 0].tolist() == [[0, 1], [0, 2]]
    addition = pattern.additions[0][0, 1]
    tables = np.arange(16.0).reshape(4, 2, 2)
    sums = add_up(addition.straight, tables)
    assert addition.turned is not None
    sums += add_up(addition.turned, tables.transpose(0, 2, 1))
    np.testing.assert_array_equal(sums[0], tables[0] + tables[2].T)
    np.testing.assert_array_equal(sums[1], tables[1].T)
    assert pattern.gradients[0][2] is None


def test_direct_solutions_solve() -> None:
    random = np.random.default_rng(3)
    dense = random.normal(size=(30, 20))
    normal = dense.T @ dense + np.eye(20)
    right = random.normal(size=20)
    found = factorize_symmetric(csc_array(normal))(right)
    np.testing.assert_allclose(found, np.linalg.solve(normal, right), rtol=1e-10)


def test_shifted_solutions_solve() -> None:
    random = np.random.default_rng(3)
    dense = random.normal(size=(30, 20))
    right = random.normal(size=20)
    expected = np.linalg.solve(dense.T @ dense + 0.1 * np.eye(20), right)
    found = solve_definite(csc_array(dense.T @ dense), 0.1, right)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_jacobians_have_their_blocks_and_keep_zeros() -> None:
    layout = Layout((4, 0, 3), (2, 5, 3))
    assert layout.starts.tolist() == [0, 8, 8, 17]
    assert layout.columns(Block(2, np.array([1]))).tolist() == [[11, 12, 13]]
    random = np.random.default_rng(2)
    terms = [
        (Block(0, random.integers(0, 4, 9)),),
        (Block(0, np.arange(4)), Block(1, np.arange(4)), Block(2, np.array([0, 1, 2, 0]))),
    ]
    pattern = jacobian_pattern(layout, terms)
    entries = [
        tuple(random.normal(size=(len(b.ids), layout.widths[b.group])) for b in blocks)
        for blocks in pattern.blocks
    ]
    entries[0][0][3] = 0
    matrix = jacobian_matrix(pattern, entries)
    assert matrix.nnz == 9 * 2 + 4 * 5
    dense = matrix.toarray()
    np.testing.assert_array_equal(dense[9 + 2, 4:6], entries[1][0][2])
    np.testing.assert_array_equal(dense[9 + 3, 8:11], entries[1][1][3])


@pytest.mark.parametrize("direct", [factorize, factorize_symmetric])
def test_a_singular_matrix_ends_in_an_error_of_ours(
    direct: Callable[[object], object],
) -> None:
    with pytest.raises(ConvergenceError, match="cannot be solved"):
        direct(csc_array(np.diag([1.0, 0.0, 2.0])))
