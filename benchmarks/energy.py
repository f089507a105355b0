"""Time to solution of energy (6), and general solvers on the same energy beside it.

    python benchmarks/energy.py [large] [moving] [scipy]

The whole job with a support, vertices fixed (or with ``moving`` within 0.02 edges), on 5,000
faces, with ``large`` on 50,000 too. With ``scipy`` the energy without multipliers is minimised
by Newton's method, by the same steps without second derivatives (a factorising
Levenberg-Marquardt), by L-BFGS and by scipy's least_squares, all on 1,600 faces, in one run.
Seconds are CPU seconds of this machine now; what counts are the ratios.
"""

import resource
import sys
import time
from contextlib import suppress

import numpy as np
from scipy.sparse import csr_array

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.descent.freedom import Freedom, moved, vertex_freedom
from spheremesh.kernel.optimization.descent.multipliers import descend_energy
from spheremesh.kernel.optimization.descent.problem import EnergyProblem, energy_problem
from spheremesh.kernel.optimization.energies.setting import (
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.energies.table import EnergyWeights
from spheremesh.kernel.optimization.whole_energy import Conditions, optimize_spheres
from spheremesh.kernel.sphere_meshes.fit import fit_spheres

FULL = EnergyWeights(regularity=3.5, support=1.0)


def surface(size: int) -> Mesh:
    """A smooth roof of quadrilaterals that lie on no circles."""
    u, v = np.meshgrid(*2 * [np.linspace(-1, 1, size + 1)], indexing="ij")
    height = 0.35 * (1 - u**2) * (1 - 0.6 * v**2) + 0.1 * np.sin(2 * u + v)
    ids = np.arange((size + 1) ** 2).reshape(size + 1, size + 1)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(np.stack([u, v, height], -1).reshape(-1, 3), faces.reshape(-1, 4))


def whole_job(size: int, tolerance: float) -> tuple[int, float]:
    """Print a line; faces and seconds."""
    mesh = surface(size)
    start, _ = minimize_angles(fit_spheres(mesh))
    began = time.process_time()
    _, report = optimize_spheres(start, FULL, Conditions(tolerance=tolerance))
    seconds = time.process_time() - began
    steps = sum(stage.iterations for stage in report.stages)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(
        f"{mesh.n_faces} faces, tolerance {tolerance:g}: {seconds:.1f} s, "
        f"{steps} steps, converged {report.converged}, corners {report.corners}, "
        f"{memory:.2f} GB",
        flush=True,
    )
    return mesh.n_faces, seconds


def same_energy(size: int) -> None:
    """Newton's method, without second derivatives, L-BFGS and least_squares, to one energy."""
    mesh = surface(size)
    start = first_unknowns(minimize_angles(fit_spheres(mesh))[0])
    setting = energy_setting(mesh, np.ones(len(mesh.topology.edge_corners)))
    freedom = Freedom(0.0, vertex_freedom(mesh, "free", "free"), np.zeros(mesh.n_faces, bool))
    problem = energy_problem(setting, freedom, FULL)
    best, first = np.inf, 0.0
    for name, is_exact in (("Newton", True), ("Levenberg-Marquardt, factorising", False)):
        began = time.process_time()
        found = descend_energy(problem, start, 500, 1e-12, is_exact=is_exact)
        seconds = time.process_time() - began
        energy = float(found.history[-1].sum())
        best, first = min(best, energy), first or seconds
        print(
            f"{name}: energy {energy:.10g}, {found.iterations} steps, {seconds:.1f} s, "
            f"{seconds / first:.2g} times Newton's method",
            flush=True,
        )
    general_solvers(problem, start, best, first)


def jacobian(problem: EnergyProblem, unknowns: Unknowns) -> csr_array:
    """By the unknowns as they stand: a change of length of a row is nothing to first order."""
    rows, columns, values, first = [], [], [], 0
    layout = problem.layout
    for term, weight in zip(problem.terms, problem.weights, strict=True):
        tables = term.jacobian(problem.setting, unknowns)
        for block, table in zip(term.blocks(problem.setting), tables, strict=True):
            if layout.counts[block.group]:
                width = table.shape[1]
                start = layout.starts[block.group] + width * block.ids[:, None]
                rows.append(np.repeat(first + np.arange(len(table)), width))
                columns.append((start + np.arange(width)).ravel())
                values.append(weight * table.ravel())
        first += len(tables[0])
    places = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), places), shape=(first, int(layout.starts[-1])))


def general_solvers(problem: EnergyProblem, start: Unknowns, aim: float, newton: float) -> None:
    """Solvers of scipy to the same energy, each for two minutes at most.

    Seconds are beside those of Newton's method.
    """
    from scipy.optimize import least_squares, minimize

    split = start.spheres.size
    none = np.zeros((0, 3))

    def _unknowns(x: FloatArray) -> Unknowns:
        free = Unknowns(x[:split].reshape(-1, 5), start.displacements, x[split:].reshape(-1, 3))
        return moved(problem.freedom, free, (0 * free.spheres, none, 0 * free.normals))

    def _residuals(x: FloatArray) -> FloatArray:
        nonlocal least
        found = _unknowns(x)
        parts = [
            weight * term.residuals(problem.setting, found)
            for term, weight in zip(problem.terms, problem.weights, strict=True)
        ]
        residuals = np.concatenate(parts)
        least = min(least, float(residuals @ residuals))
        if least <= aim * (1 + 1e-6) or time.process_time() - began > 120:
            raise StopIteration
        return residuals

    def _jacobian(x: FloatArray) -> csr_array:
        return jacobian(problem, _unknowns(x))

    def _function(x: FloatArray) -> tuple[float, FloatArray]:
        residuals = _residuals(x)
        return float(residuals @ residuals), 2 * (_jacobian(x).T @ residuals)

    x = np.concatenate([start.spheres.ravel(), start.normals.ravel()])
    options = {"maxiter": 10**6, "maxfun": 10**6, "ftol": 0, "gtol": 0}
    jobs = {
        "L-BFGS": lambda: minimize(_function, x, jac=True, method="L-BFGS-B", options=options),
        "least_squares (trf, lsmr)": lambda: least_squares(
            _residuals, x, _jacobian, tr_solver="lsmr", ftol=1e-15, xtol=1e-15, gtol=1e-15
        ),
    }
    for name, job in jobs.items():
        began, least = time.process_time(), np.inf
        with suppress(StopIteration):
            job()
        off = least / aim - 1
        seconds = time.process_time() - began
        print(
            f"scipy {name}: energy {least:.10g}, {off:.1e} above, {seconds:.1f} s, "
            f"{seconds / newton:.2g} times Newton's method",
            flush=True,
        )


def main(options: list[str]) -> None:
    """Print the figures."""
    tolerance = 0.02 if "moving" in options else 0.0
    whole_job(5, tolerance)  # load scipy outside of the clock
    faces, seconds = whole_job(71, tolerance)
    if "large" in options:
        more, longer = whole_job(224, tolerance)
        exponent = np.log(longer / seconds) / np.log(more / faces)
        print(f"exponent of the seconds: {exponent:.2f}")
    if "scipy" in options:
        same_energy(40)


if __name__ == "__main__":
    main(sys.argv[1:])
