"""Time to solution of energy (6).

    python benchmarks/energy.py [large] [moving]

The whole job with a support, vertices fixed (or with ``moving`` within 0.02 edges), on 5,000
faces, with ``large`` on 50,000 too. Seconds are CPU seconds of this machine now; what counts is
the exponent. General solvers on the same energy stand in the tables (tables/run.py).
"""

import resource
import sys
import time

import numpy as np

from spheremesh import Mesh
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
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


def main(options: list[str]) -> None:
    """Print the figures."""
    tolerance = 0.02 if "moving" in options else 0.0
    whole_job(5, tolerance)  # load scipy outside of the clock
    faces, seconds = whole_job(71, tolerance)
    if "large" in options:
        more, longer = whole_job(224, tolerance)
        exponent = np.log(longer / seconds) / np.log(more / faces)
        print(f"exponent of the seconds: {exponent:.2f}")


if __name__ == "__main__":
    main(sys.argv[1:])
