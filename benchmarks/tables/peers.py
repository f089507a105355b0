"""General solvers on a sum of squares, each to the same energy.

All get the same residuals and the same sparse Jacobian, evaluated by the same vectorised
code, and the same start; each ends when the energy is reached or its seconds are used up.
From Python Ceres can take residuals a few at a time, each by a call, or all at once with a
dense Jacobian; where the first is not given it gets the second.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares, minimize
from scipy.sparse import csc_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from spheremesh.kernel.arrays import FloatArray

REACHED = 1e-6
"""An energy counts as reached within this share."""


class LocalSum(NamedTuple):
    """Residuals that depend on a few of the unknowns.

    Attributes
    ----------
    unknowns : tuple of int
        Ids of these unknowns.
    n_residuals : int
        Number of residuals.
    evaluate : callable
        The unknowns to the residuals and their derivatives by each of them.
    """

    unknowns: tuple[int, ...]
    n_residuals: int
    evaluate: Callable[..., tuple[Sequence[float], Sequence[Sequence[float]]]]


class SquareSum(NamedTuple):
    """A sum of squares and a start.

    Attributes
    ----------
    residuals : callable
        Unknowns (n,) to residuals (m,).
    jacobian : callable
        Unknowns (n,) to a sparse matrix (m, n), whose pattern is always the same.
    start : (n,) float array
        Where solvers begin.
    local : list of LocalSum or None
        The same residuals a few at a time, for solvers that call back.
    """

    residuals: Callable[[FloatArray], FloatArray]
    jacobian: Callable[[FloatArray], csr_array]
    start: FloatArray
    local: Sequence[LocalSum] | None = None


class Reached(NamedTuple):
    """What a solver reached: its least energy, and CPU seconds."""

    energy: float
    seconds: float


class _EndedError(Exception):
    """The energy is reached, or the time is over."""


class _Watch:
    """Times evaluations, and ends a solver at an energy or after its seconds."""

    def __init__(self, problem: SquareSum, aim: float, limit: float) -> None:
        self.problem, self.aim, self.limit = problem, aim, limit
        self.began, self.least = time.process_time(), np.inf

    @property
    def seconds(self) -> float:
        return time.process_time() - self.began

    @property
    def is_over(self) -> bool:
        return self.least <= self.aim * (1 + REACHED) or self.seconds > self.limit

    def residuals(self, x: FloatArray) -> FloatArray:
        found = self.problem.residuals(x)
        self.least = min(self.least, float(found @ found))
        return found

    def ending_residuals(self, x: FloatArray) -> FloatArray:
        found = self.residuals(x)
        if self.is_over:
            raise _EndedError
        return found

    def jacobian(self, x: FloatArray) -> csr_array:
        return self.problem.jacobian(x)


def _lbfgs(watch: _Watch) -> None:
    def _energy(x: FloatArray) -> tuple[float, FloatArray]:
        found = watch.ending_residuals(x)
        return float(found @ found), 2 * (watch.jacobian(x).T @ found)

    options = {"maxiter": 10**6, "maxfun": 10**6, "maxcor": 20, "ftol": 0, "gtol": 0}
    minimize(_energy, watch.problem.start, jac=True, method="L-BFGS-B", options=options)


def _least_squares(watch: _Watch) -> None:
    least_squares(
        watch.ending_residuals, watch.problem.start, watch.jacobian, tr_solver="lsmr",
        ftol=1e-15, xtol=1e-15, gtol=1e-15, max_nfev=10**6,
    )  # fmt: skip


def _levenberg_marquardt(watch: _Watch) -> None:
    """The paper's method, with a sparse factorisation of the normal equations (SuperLU)."""
    x = watch.problem.start
    residuals = watch.ending_residuals(x)
    damping, growth = 1e-3, 2.0
    identity = eye_array(len(x), format="csc")
    while True:
        jacobian = watch.jacobian(x)
        normal, slope = csc_array(jacobian.T @ jacobian), jacobian.T @ residuals
        scale = float(normal.diagonal().mean())
        while True:
            matrix = csc_array(normal + damping * scale * identity)
            step = -splu(matrix, "MMD_AT_PLUS_A", 0.0, options={"SymmetricMode": True}).solve(
                slope
            )
            moved = watch.ending_residuals(x + step)
            fall = float(residuals @ residuals - moved @ moved)
            promised = -float(step @ slope) + damping * scale * float(step @ step)
            if fall > 0:
                break
            damping, growth = damping * growth, growth * 2
        damping *= max(0.1, 1 - (2 * fall / promised - 1) ** 3)
        x, residuals, growth = x + step, moved, 2.0


def _ceres(watch: _Watch) -> None:
    """Levenberg-Marquardt of Ceres on one thread, by its sparse or its dense Cholesky."""
    import pyceres

    ceres: Any = pyceres
    x = watch.problem.start.copy()
    problem = ceres.Problem()
    how = ceres.SolverOptions()
    kinds = ceres.LinearSolverType
    local = watch.problem.local
    if local is None:
        how.linear_solver_type = kinds.DENSE_NORMAL_CHOLESKY
        costs = [_whole_cost(ceres, watch)]
        problem.add_residual_block(costs[0], None, [x])
    else:
        how.linear_solver_type = kinds.SPARSE_NORMAL_CHOLESKY
        unknowns = [x[i : i + 1] for i in range(len(x))]
        costs = [_local_cost(ceres, share) for share in local]
        for share, cost in zip(local, costs, strict=True):
            problem.add_residual_block(cost, None, [unknowns[i] for i in share.unknowns])

    class _End(ceres.IterationCallback):
        def __call__(self, _summary: Any) -> Any:  # noqa: ANN401
            if local is not None:
                watch.residuals(x)
            states = ceres.CallbackReturnType
            return states.SOLVER_ABORT if watch.is_over else states.SOLVER_CONTINUE

    how.num_threads, how.max_num_iterations = 1, 10**6
    how.function_tolerance = how.gradient_tolerance = how.parameter_tolerance = 0.0
    how.update_state_every_iteration = True
    how.logging_type = ceres.LoggingType.SILENT
    end = _End()
    how.callbacks = [end]
    ceres.solve(how, problem, ceres.SolverSummary())


def _whole_cost(ceres: Any, watch: _Watch) -> Any:  # noqa: ANN401
    """All residuals as one block: vectorised, but a dense Jacobian."""
    count, width = watch.problem.jacobian(watch.problem.start).shape

    class _Whole(ceres.CostFunction):
        def __init__(self) -> None:
            super().__init__()
            self.set_num_residuals(count)
            self.set_parameter_block_sizes([width])

        def Evaluate(self, parameters: Any, residuals: Any, jacobians: Any) -> bool:  # noqa: ANN401, N802
            x = np.array(parameters[0])
            residuals[:] = watch.residuals(x)
            if jacobians is not None and jacobians[0] is not None:
                jacobians[0][:] = watch.jacobian(x).toarray().ravel()
            return True

    return _Whole()


def _local_cost(ceres: Any, share: LocalSum) -> Any:  # noqa: ANN401
    """Residuals of a few unknowns, called back one after another."""

    class _Local(ceres.CostFunction):
        def __init__(self) -> None:
            super().__init__()
            self.set_num_residuals(share.n_residuals)
            self.set_parameter_block_sizes([1] * len(share.unknowns))

        def Evaluate(self, parameters: Any, residuals: Any, jacobians: Any) -> bool:  # noqa: ANN401, N802
            found, columns = share.evaluate(*(float(each[0]) for each in parameters))
            residuals[:] = found
            if jacobians is not None:
                for table, column in zip(jacobians, columns, strict=True):
                    if table is not None:
                        table[:] = column
            return True

    return _Local()


SOLVERS: dict[str, Callable[[_Watch], None]] = {
    "Levenberg-Marquardt with a factorisation": _levenberg_marquardt,
    "Ceres (pyceres)": _ceres,
    "scipy L-BFGS": _lbfgs,
    "scipy least_squares": _least_squares,
}


def reach(name: str, problem: SquareSum, aim: float, limit: float) -> Reached:
    """Let one of `SOLVERS` run to an energy, for so many CPU seconds at most."""
    watch = _Watch(problem, aim, limit)
    with suppress(_EndedError):
        SOLVERS[name](watch)
    return Reached(watch.least, watch.seconds)
