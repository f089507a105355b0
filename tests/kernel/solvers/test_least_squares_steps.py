"""Sparse least-squares steps: patterns, products and solutions against dense algebra."""

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array

from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.solvers import normal_equations
from spheremesh.kernel.solvers.blocks import (
    Block,
    JacobianPattern,
    Layout,
    diagonal_blocks,
    jacobian_matrix,
    jacobian_pattern,
)
from spheremesh.kernel.solvers.conjugate_gradients import truncated_step
from spheremesh.kernel.solvers.factorization import (
    factorize_symmetric,
    solve_by_cholmod,
    solve_definite,
)
from spheremesh.kernel.solvers.normal_equations import damped_step, linearization
from spheremesh.kernel.solvers.products import (
    normal_product_by_numba,
    normal_product_by_scipy,
)

LAYOUT = Layout((4, 0, 3), (2, 5, 3))


def random_terms() -> tuple[JacobianPattern, list[tuple[FloatArray, ...]]]:
    """Three terms on two groups; a third group takes no part."""
    random = np.random.default_rng(2)
    terms = [
        (Block(0, random.integers(0, 4, 9)),),
        (Block(0, np.arange(4)), Block(1, np.arange(4)), Block(2, np.array([0, 1, 2, 0]))),
        (Block(2, np.arange(3)),),
    ]
    pattern = jacobian_pattern(LAYOUT, terms)
    entries = [
        tuple(random.normal(size=(len(b.ids), LAYOUT.widths[b.group])) for b in blocks)
        for blocks in pattern.blocks
    ]
    # Entries that happen to be zero must stay in the pattern.
    entries[0][0][3] = 0
    return pattern, entries


def test_columns_are_counted_once() -> None:
    assert LAYOUT.starts.tolist() == [0, 8, 8, 17]
    assert LAYOUT.columns(Block(2, np.array([1]))).tolist() == [[11, 12, 13]]
    spheres, points, normals = LAYOUT.split(np.arange(17.0))
    assert spheres.shape == (4, 2)
    assert points.shape == (0, 5)
    assert normals[2].tolist() == [14, 15, 16]


def test_matrix_has_its_blocks_and_keeps_zeros() -> None:
    pattern, entries = random_terms()
    matrix = jacobian_matrix(pattern, entries)
    assert matrix.shape == (9 + 4 + 3, 17)
    assert matrix.nnz == 9 * 2 + 4 * 5 + 3 * 3
    dense = matrix.toarray()
    np.testing.assert_array_equal(dense[9 + 2, 4:6], entries[1][0][2])
    np.testing.assert_array_equal(dense[9 + 3, 8:11], entries[1][1][3])


def test_diagonal_blocks_are_those_of_the_normal_matrix() -> None:
    pattern, entries = random_terms()
    dense = jacobian_matrix(pattern, entries).toarray()
    normal = dense.T @ dense
    first, none, last = diagonal_blocks(pattern, entries)
    assert none.shape == (0, 5, 5)
    for i in range(4):
        block = normal[2 * i : 2 * i + 2, 2 * i : 2 * i + 2]
        np.testing.assert_allclose(first[i], block, atol=1e-14)
    for i in range(3):
        block = normal[8 + 3 * i : 11 + 3 * i, 8 + 3 * i : 11 + 3 * i]
        np.testing.assert_allclose(last[i], block, atol=1e-14)


def test_products_agree_with_and_without_numba() -> None:
    pytest.importorskip("numba")
    random = np.random.default_rng(7)
    dense = random.normal(size=(60, 40)) * (random.random((60, 40)) < 0.2)
    matrix = csr_array(dense)
    vector = random.normal(size=40)
    plain = normal_product_by_scipy(matrix)(vector)
    np.testing.assert_allclose(plain, dense.T @ (dense @ vector), rtol=1e-12)
    np.testing.assert_allclose(normal_product_by_numba(matrix)(vector), plain, rtol=1e-14)


def stiff_problem(
    size: int,
) -> tuple[JacobianPattern, FloatArray, list[tuple[FloatArray, ...]]]:
    """Springs along a line, the last a thousand times as stiff as the first."""
    layout = Layout((size,), (1,))
    ids = np.arange(size)
    terms = [(Block(0, ids[:-1]), Block(0, ids[1:])), (Block(0, ids[:1]),)]
    stiffness = np.geomspace(1, 1e3, size - 1)[:, None]
    entries = [(stiffness, -stiffness), (np.ones((1, 1)),)]
    residuals = np.random.default_rng(0).normal(size=size)
    return jacobian_pattern(layout, terms), residuals, entries


@pytest.mark.parametrize("damping", [1e-2, 1e-8])
def test_a_step_lowers_the_model_as_far_as_it_goes(damping: float) -> None:
    pattern, residuals, entries = stiff_problem(200)
    problem = linearization(pattern, residuals, entries)
    dense = problem.jacobian.toarray()
    shift = damping * np.trace(dense.T @ dense) / 200
    exact = np.linalg.solve(dense.T @ dense + shift * np.eye(200), -dense.T @ residuals)
    best = np.sum((residuals + dense @ exact) ** 2) + shift * exact @ exact
    found = damped_step(problem, damping)
    reached = found.predicted + shift * found.step @ found.step
    start = residuals @ residuals
    assert found.predicted == pytest.approx(np.sum((residuals + dense @ found.step) ** 2))
    assert reached <= best + 0.05 * (start - best)


def test_the_matrix_is_factorised_where_iterations_do_not_settle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(normal_equations, "MAX_PRODUCTS", 3)
    pattern, residuals, entries = stiff_problem(200)
    problem = linearization(pattern, residuals, entries)
    dense = problem.jacobian.toarray()
    shift = 1e-6 * np.trace(dense.T @ dense) / 200
    exact = np.linalg.solve(dense.T @ dense + shift * np.eye(200), -dense.T @ residuals)
    np.testing.assert_allclose(damped_step(problem, 1e-6).step, exact, atol=1e-8)


@pytest.mark.parametrize("library", ["superlu", "cholmod"])
def test_direct_solvers_agree(library: str) -> None:
    if library == "cholmod":
        pytest.importorskip("sksparse.cholmod")
    random = np.random.default_rng(3)
    dense = random.normal(size=(30, 20))
    normal = dense.T @ dense + np.eye(20)
    right = random.normal(size=20)
    matrix = csc_array(normal)
    if library == "cholmod":
        found = solve_by_cholmod(matrix, right)
    else:
        found = factorize_symmetric(matrix)(right)
    np.testing.assert_allclose(found, np.linalg.solve(normal, right), rtol=1e-10)


def test_direct_solutions_solve() -> None:
    random = np.random.default_rng(3)
    dense = random.normal(size=(30, 20))
    matrix = csr_array(dense.T @ dense)
    right = random.normal(size=20)
    expected = np.linalg.solve(dense.T @ dense + 0.1 * np.eye(20), right)
    np.testing.assert_allclose(solve_definite(matrix, 0.1, right), expected, rtol=1e-9)


def test_conjugate_gradients_say_when_more_would_help() -> None:
    diagonal = np.geomspace(1, 1e4, 50)
    right = np.ones(50)

    def _product(x: FloatArray) -> FloatArray:
        return diagonal * x

    step, is_settled = truncated_step(_product, np.copy, right, 2)
    assert not is_settled
    assert step @ right > 0
    step, is_settled = truncated_step(_product, np.copy, right, 500)
    assert is_settled
    np.testing.assert_allclose(step @ right, (right / diagonal).sum(), rtol=0.05)
    nothing, is_settled = truncated_step(_product, np.copy, 0 * right, 5)
    assert is_settled
    assert not nothing.any()
