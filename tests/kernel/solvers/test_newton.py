"""Newton's method: minima, saddles, bounds, and what it does when nothing helps."""

import numpy as np
import pytest

from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.solvers.factorization import Solver
from spheremesh.kernel.solvers.minimization import Factorize, Model, Problem
from spheremesh.kernel.solvers.newton import NewtonDescent, newton


def dense(hessian: FloatArray) -> Factorize:
    def _factorize(shift: float) -> object:
        shifted = hessian + shift * np.eye(len(hessian))
        try:
            np.linalg.cholesky(shifted)
        except np.linalg.LinAlgError:
            return None
        return lambda right: np.linalg.solve(shifted, right)

    return _factorize


def minimise(
    function: object,
    start: list[float],
    steps: int = 100,
    *,
    leaves_saddles: bool = True,
    last: Solver | None = None,
) -> NewtonDescent[FloatArray]:
    """A function of a point that gives energy, gradient, Hessian and its convex part."""

    def _model(x: FloatArray) -> Model:
        _, gradient, hessian, convex = function(x)
        return Model(np.asarray(gradient) / 2, dense(hessian / 2), dense(convex / 2))

    problem = Problem(
        lambda x: np.array([function(x)[0]]),
        _model,
        lambda x, step: x + step,
        lambda *_: 1.0,
        lambda before, after: float((after - before).sum()),
    )
    return newton(
        problem, np.array(start), steps, 1e-12, leaves_saddles=leaves_saddles, last=last
    )


def rosenbrock(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    r = np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])
    jacobian = np.array([[-20 * x[0], 10], [-1, 0]])
    convex = 2 * jacobian.T @ jacobian
    bent = convex + 2 * r[0] * np.array([[-20, 0], [0, 0]])
    return float(r @ r), 2 * jacobian.T @ r, bent, convex


@pytest.mark.parametrize("start", [[-1.2, 1.0], [3.0, -2.0], [0.0, 5.0]])
def test_a_bent_valley(start: list[float]) -> None:
    found = minimise(rosenbrock, start)
    assert found.status == "converged"
    assert found.lowest >= -1e-8
    np.testing.assert_allclose(found.state, 1, atol=1e-9)
    assert (np.diff(found.history[:, 0]) < 0).all()


def saddle(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Two valleys beside a saddle at the origin."""
    u, v, w = x
    energy = 3 + (u**2 - 1) ** 2 + v**2 + w**2
    gradient = np.array([4 * u * (u**2 - 1), 2 * v, 2 * w])
    hessian = np.diag([12 * u**2 - 4, 2, 2])
    return energy, gradient, hessian, np.diag([8 * u**2, 2.0, 2.0])


def test_a_saddle_is_left_to_the_side_that_is_preferred() -> None:
    found = minimise(saddle, [0.0, 0.3, -0.2])
    assert found.status == "converged"
    np.testing.assert_allclose(found.state, [1, 0, 0], atol=1e-9)

    def _tilted(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
        energy, gradient, hessian, convex = saddle(x)
        hessian = hessian + np.diag([0.6 * x[0], 0, 0])
        return (
            energy + 0.1 * x[0] ** 3,
            gradient + np.array([0.3 * x[0] ** 2, 0, 0]),
            hessian,
            convex,
        )

    found = minimise(_tilted, [0.0, 0.3, -0.2])
    assert found.state[0] < -0.9


def test_factors_of_a_descent_nearby_serve_again() -> None:
    made: list[float] = []

    def _bowl(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
        hessian = np.diag([2.0, 4.0]) + 0.01 * np.eye(2) * x[0]
        made.append(x[0])
        return float(x @ x + x[1] ** 2 + 1), np.array([2 * x[0], 4 * x[1]]), hessian, hessian

    first = minimise(_bowl, [1.0, 1.0], leaves_saddles=False)
    assert first.solve is not None
    found = minimise(_bowl, [0.1, -0.1], leaves_saddles=False, last=first.solve)
    assert found.status == "converged"
    np.testing.assert_allclose(found.state, 0, atol=1e-6)
    assert found.solve is first.solve


@pytest.mark.parametrize("factor", [1e6, 1e-6, -1.0])
def test_factors_that_do_not_serve_are_made_anew(factor: float) -> None:
    found = minimise(rosenbrock, [-1.2, 1.0], last=lambda right: factor * right)
    assert found.status == "converged"
    np.testing.assert_allclose(found.state, 1, atol=1e-9)


def test_a_flat_direction_is_not_gone_along() -> None:
    def _flat(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
        hessian = np.diag([2.0, 0.0])
        return float((x[0] - 1) ** 2), np.array([2 * (x[0] - 1), 1e-17]), hessian, hessian

    found = minimise(_flat, [5.0, 7.0])
    assert found.status == "converged"
    np.testing.assert_allclose(found.state, [1, 7], atol=1e-6)


def test_used_up_and_stalled() -> None:
    assert minimise(rosenbrock, [-1.2, 1.0], steps=3).status == "exhausted"

    def _lies(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
        """The gradient points uphill."""
        return float(1 + x @ x), -2 * x, 2 * np.eye(len(x)), 2 * np.eye(len(x))

    found = minimise(_lies, [1.0, 2.0])
    assert found.status == "stalled"
    np.testing.assert_array_equal(found.state, [1, 2])
