"""Levenberg-Marquardt on problems whose minimum is known."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.solvers.levenberg_marquardt import (
    DampedStep,
    Descent,
    levenberg_marquardt,
)

Problem = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def rosenbrock(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    residual = np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])
    return residual, np.array([[-20 * x[0], 10], [-1, 0]])


def powell(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Singular at its minimum 0."""
    a, b, c, d = x
    residual = np.array(
        [a + 10 * b, 5**0.5 * (c - d), (b - 2 * c) ** 2, 10**0.5 * (a - d) ** 2]
    )
    jacobian = np.array(
        [
            [1, 10, 0, 0],
            [0, 0, 5**0.5, -(5**0.5)],
            [0, 2 * (b - 2 * c), -4 * (b - 2 * c), 0],
            [2 * 10**0.5 * (a - d), 0, 0, -2 * 10**0.5 * (a - d)],
        ]
    )
    return residual, jacobian


def line(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Minimum 2 along a line: JᵀJ is singular everywhere."""
    return np.array([x[0] + x[1] - 3, x[0] + x[1] - 5]), np.ones((2, 2))


def solve(
    problem: Problem, start: list[float], tolerance: float = 1e-6, max_iterations: int = 100
) -> Descent[FloatArray]:
    def _energies(x: FloatArray) -> FloatArray:
        return problem(x)[0] ** 2

    def _linearize(x: FloatArray) -> Callable[[float], DampedStep]:
        residual, jacobian = problem(x)
        normal = jacobian.T @ jacobian

        def _step(damping: float) -> DampedStep:
            shift = damping * np.abs(normal).max() * np.eye(len(x))
            delta = np.linalg.solve(normal + shift, -jacobian.T @ residual)
            return DampedStep(delta, float(((residual + jacobian @ delta) ** 2).sum()))

        return _step

    return levenberg_marquardt(
        np.array(start, float), _energies, _linearize, np.add, tolerance, max_iterations
    )


@pytest.mark.parametrize(
    ("problem", "start", "least"),
    [(rosenbrock, [-1.2, 1], 0), (powell, [3, -1, 0, 1], 0), (line, [1, 1], 2)],
)
def test_reaches_the_minimum_without_ever_rising(
    problem: Problem, start: list[float], least: float
) -> None:
    descent = solve(problem, start, tolerance=1e-12, max_iterations=400)
    total = descent.history.sum(axis=1)
    assert descent.status != "stalled"
    assert total[-1] == pytest.approx(least, abs=1e-10)
    assert (np.diff(total) < 0).all()
    assert total[-1] == pytest.approx(float((problem(descent.state)[0] ** 2).sum()))


def test_a_minimum_is_left_alone() -> None:
    descent = solve(rosenbrock, [1, 1])
    assert descent.status == "converged"
    assert descent.iterations <= 1
    np.testing.assert_array_equal(descent.state, [1, 1])


def test_iterations_run_out_in_plain_words() -> None:
    descent = solve(rosenbrock, [-1.2, 1], max_iterations=3)
    assert descent.status == "exhausted"
    assert descent.iterations == 3


def test_a_wrong_jacobian_stalls_instead_of_claiming_a_minimum() -> None:
    def _lying(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        residual, jacobian = rosenbrock(x)
        return residual, -jacobian

    descent = solve(_lying, [-1.2, 1])
    assert descent.status == "stalled"
    np.testing.assert_array_equal(descent.state, [-1.2, 1])
