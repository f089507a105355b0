"""How fast energy (6) falls: seconds and iterations, with a general solver beside it.

    python benchmarks/energy.py [large] [scipy]

Seconds are those of this machine now; what counts are the ratios, taken within one run.
"""

import resource
import sys
import time

import numpy as np

from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.energies.freedom import Freedom, moved, vertex_freedom
from spheremesh.kernel.optimization.energies.minimize import (
    EnergyProblem,
    energy_problem,
    minimize_energy,
    weighted_entries,
    weighted_residuals,
)
from spheremesh.kernel.optimization.energies.setting import (
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.energies.table import EnergyWeights
from spheremesh.kernel.solvers.blocks import jacobian_matrix
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.nodes import roof_mesh

FULL = EnergyWeights(regularity=3.5, support=1.0)
REGULAR = EnergyWeights(regularity=3.5)


def prepare(
    n_span: int, n_length: int, weights: EnergyWeights
) -> tuple[EnergyProblem, Unknowns]:
    """A roof at its smallest angles, and the energy to minimise from there."""
    mesh = roof_mesh(n_span, n_length)
    start, _ = minimize_angles(fit_spheres(mesh))
    setting = energy_setting(mesh, np.ones(len(mesh.topology.edge_corners)))
    freedom = Freedom(0.0, vertex_freedom(mesh, "free", "free"), np.zeros(mesh.n_faces, bool))
    return energy_problem(setting, freedom, weights), first_unknowns(start)


def descend(
    n_span: int, n_length: int, weights: EnergyWeights, max_iterations: int
) -> tuple[float, float, float]:
    """Print a line; seconds in all, seconds of an iteration, final energy."""
    problem, start = prepare(n_span, n_length, weights)
    wall, cpu = time.perf_counter(), time.process_time()
    descent = minimize_energy(problem, start, max_iterations, 1e-6)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    energy = descent.history.sum(axis=1)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    name = "full energy" if weights.support else "angle + regularity"
    print(
        f"{n_span * n_length} faces, {name}: {descent.status} in {descent.iterations} "
        f"iterations, {energy[0]:.4g} to {energy[-1]:.4g}; {wall / descent.iterations:.3f} s "
        f"(CPU {cpu / descent.iterations:.3f} s) each; {memory:.2f} GB"
    )
    return wall, cpu / descent.iterations, float(energy[-1])


def general_solver(n_span: int, n_length: int, aim: float, limit: float) -> None:
    """scipy.optimize.least_squares on the same residuals and Jacobian, for `limit` seconds."""
    from scipy.optimize import least_squares

    problem, start = prepare(n_span, n_length, FULL)
    shapes = (start.spheres.shape, start.normals.shape)
    began = time.perf_counter()
    best = [np.inf, 0.0]
    none = np.zeros((0, 3))

    def _unknowns(x: FloatArray) -> Unknowns:
        split = shapes[0][0] * 5
        return Unknowns(
            x[:split].reshape(shapes[0]), start.displacements, x[split:].reshape(shapes[1])
        )

    def _residuals(x: FloatArray) -> FloatArray:
        unknowns = _unknowns(x)
        residuals = np.concatenate(weighted_residuals(problem, unknowns))
        # Our rows are unit rows; those of a general solver, a little shorter, gain by it.
        unit_rows = moved(
            problem.freedom, unknowns, (0 * unknowns.spheres, none, unknowns.normals)
        )
        energy = sum(float(part @ part) for part in weighted_residuals(problem, unit_rows))
        seconds = time.perf_counter() - began
        if energy < best[0]:
            best[:] = energy, seconds
        if energy <= aim * (1 + 1e-6) or seconds > limit:
            raise StopIteration
        return residuals

    def _jacobian(x: FloatArray) -> object:
        return jacobian_matrix(problem.pattern, weighted_entries(problem, _unknowns(x)))

    x = np.concatenate([start.spheres.ravel(), start.normals.ravel()])
    outcome = "stopped by itself"
    try:
        least_squares(
            _residuals, x, _jacobian, method="trf", tr_solver="lsmr",
            ftol=1e-12, xtol=1e-12, gtol=1e-12, max_nfev=10_000,
        )  # fmt: skip
    except StopIteration:
        outcome = "reached it" if best[0] <= aim * (1 + 1e-6) else "did not reach it"
    print(
        f"scipy least_squares (trf, lsmr): energy {best[0]:.6g} after {best[1]:.0f} s, aim "
        f"{aim:.6g}: {outcome} in {time.perf_counter() - began:.0f} s"
    )


def main(options: list[str]) -> None:
    """Print the figures."""
    descend(4, 4, FULL, 10)  # load scipy outside of the clock
    descend(50, 100, REGULAR, 60)
    seconds, each, energy = descend(50, 100, FULL, 60)
    if "large" in options:
        descend(500, 1000, REGULAR, 8)
        _, large, _ = descend(500, 1000, FULL, 8)
        print(
            f"exponent of the seconds of an iteration: {np.log(large / each) / np.log(100):.2f}"
        )
    if "scipy" in options:
        print(f"our whole descent took {seconds:.2f} s")
        general_solver(50, 100, energy, 40 * seconds)


if __name__ == "__main__":
    main(sys.argv[1:])
