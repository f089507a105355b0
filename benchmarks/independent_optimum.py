"""Whether another solver finds the optimum that we report.

    python benchmarks/independent_optimum.py

Two roofs of 50 quadrilaterals that lie on no circles, vertices within a tolerance: scipy's
SLSQP minimises the same angles and the same price of displacements, with vertices on their
spheres and unit rows as equations, from the same start and from our optimum disturbed. Printed
are the energies of both, how far ours is above its best, and the largest difference of an
angle. Last come faces of 1:20, whose best spheres are smoother than planes.
"""

import time

import numpy as np
from scipy.optimize import minimize

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot
from spheremesh.kernel.meshes.mesh import face_centroids, mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.energies import angle, sphericity
from spheremesh.kernel.optimization.energies.setting import (
    Setting,
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.whole_energy import (
    BOUND_WEIGHTS,
    Conditions,
    optimize_spheres,
)
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from spheremesh.kernel.spheres.minkowski import minkowski, minkowski_gradient
from spheremesh.kernel.spheres.rows import recenter, rescale

TOLERANCE = 0.05
WEIGHT = 0.1
DISTURBED = 1e-3
SCALE = 1e3
"""SLSQP begins with an identity for the Hessian."""


def roof(kind: str) -> Mesh:
    """A roof of 10 x 5 faces: a wave, or a twisted vault with a rough boundary."""
    x, y = np.meshgrid(np.arange(11.0), np.arange(6.0), indexing="ij")
    if kind == "wave":
        z = 0.25 * np.sin(0.55 * x) + 0.15 * np.cos(0.5 * y + 0.1 * x)
    else:
        z = 0.03 * x * (10 - x) - 0.05 * (y - 2.2) ** 2 + 0.002 * x * y
        x = x + 0.04 * np.sin(3 * y)
    ids = np.arange(66).reshape(11, 6)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))


def strips() -> Mesh:
    """Faces of 1:20 on a barrel."""
    x, y = np.meshgrid(np.arange(13.0), 20 * np.arange(5.0), indexing="ij")
    z = -0.02 * (x - 6) ** 2 - 0.0004 * (y - 40) ** 2
    ids = np.arange(65).reshape(13, 5)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))


class Sqp:
    """The problem in the words of scipy: x holds the rows (F, 5), then the moves (V, 3)."""

    def __init__(self, setting: Setting, start: Unknowns) -> None:
        self.setting, self.start, self.split = setting, start, start.spheres.size

    def unknowns(self, x: FloatArray) -> Unknowns:
        """The unknowns that x stands for."""
        rows, moves = x[: self.split].reshape(-1, 5), x[self.split :].reshape(-1, 3)
        return Unknowns(rows, moves, self.start.normals)

    def energy(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Angles and the price of moves, and the gradient."""
        unknowns = self.unknowns(x)
        residuals = WEIGHT * angle.residuals(self.setting, unknowns)
        rows = np.zeros_like(unknowns.spheres)
        for faces, table in zip(
            self.setting.edge_faces.T, angle.jacobian(self.setting, unknowns), strict=True
        ):
            np.add.at(rows, faces, 2 * WEIGHT * residuals[:, None] * table)
        squares = dot(unknowns.displacements, unknowns.displacements)
        # SLSQP tries points out of bounds: the price goes on as it is near the bound.
        left = np.maximum(1 - squares / TOLERANCE**2, 1e-3)
        price = BOUND_WEIGHTS[-1] ** 2
        moves = 2 * price * unknowns.displacements / left[:, None] ** 2
        value = float(residuals @ residuals) + price * float((squares / left).sum())
        return SCALE * value, SCALE * np.concatenate([rows.ravel(), moves.ravel()])

    def equations(self, x: FloatArray) -> FloatArray:
        """Vertices on their spheres, unit rows."""
        unknowns = self.unknowns(x)
        norms = minkowski(unknowns.spheres, unknowns.spheres) - 1
        return np.concatenate([sphericity.residuals(self.setting, unknowns), norms])

    def slopes(self, x: FloatArray) -> FloatArray:
        """Their derivatives."""
        unknowns, setting = self.unknowns(x), self.setting
        by_row, by_point = sphericity.jacobian(setting, unknowns)
        n, faces = len(by_row), len(unknowns.spheres)
        result = np.zeros((n + faces, len(x)))
        row = np.arange(n)[:, None]
        result[row, 5 * setting.corner_faces[:, None] + np.arange(5)] = by_row
        columns = self.split + 3 * setting.corner_vertices[:, None] + np.arange(3)
        result[row, columns] = by_point
        norms = 2 * minkowski_gradient(unknowns.spheres)
        columns = 5 * np.arange(faces)[:, None] + np.arange(5)
        result[n + np.arange(faces)[:, None], columns] = norms
        return result


def compare(kind: str) -> None:
    """Print a line for a roof."""
    start, _ = minimize_angles(fit_spheres(roof(kind)))
    began = time.process_time()
    found, report = optimize_spheres(start, None, Conditions(tolerance=TOLERANCE))
    seconds = time.process_time() - began
    setting = energy_setting(start.mesh, np.ones(len(start.mesh.topology.edge_corners)))
    sqp = Sqp(setting, first_unknowns(start))
    last = {name: float(values[-1]) for name, values in report.stages[-1].energies.items()}
    ours = last["angle"] + last["displacement"]
    first = np.concatenate([sqp.start.spheres.ravel(), 0 * sqp.start.displacements.ravel()])
    optimum = unknowns_of(start, found)
    disturbed = optimum + DISTURBED * np.random.default_rng(7).normal(size=len(optimum))
    best, angles = np.inf, np.zeros(0)
    began = time.process_time()
    for name, x in {"our start": first, "our optimum, disturbed": disturbed}.items():
        equations = {"type": "eq", "fun": sqp.equations, "jac": sqp.slopes}
        options = {"maxiter": 600, "ftol": 1e-13}
        end = minimize(
            sqp.energy, x, jac=True, method="SLSQP", constraints=equations, options=options
        )
        missed = float(np.abs(sqp.equations(end.x)).max())
        print(
            f"  SLSQP from {name}: {end.fun / SCALE:.10g}, {end.nit} steps, misses {missed:.1e}"
        )
        if missed < 1e-7 and end.fun / SCALE < best:
            best = float(end.fun) / SCALE
            cosines = np.sqrt(1 + angle.residuals(setting, sqp.unknowns(end.x)))
            angles = np.degrees(np.arccos(np.minimum(cosines, 1)))
    largest = float(np.abs(angles - np.degrees(intersection_angles(found))).max())
    print(
        f"{kind}: ours {ours:.10g} ({seconds:.1f} s, {report.corners}, converged "
        f"{report.converged}), SLSQP {best:.10g} ({time.process_time() - began:.0f} s), ours "
        f"above by {ours / best - 1:.1e}, an angle differs by {largest:.1e} degrees",
        flush=True,
    )


def unknowns_of(start: SphereMesh, found: SphereMesh) -> FloatArray:
    """The unknowns of an optimum, as SLSQP takes them."""
    edge = mean_edge_length(start.mesh)
    centroids = face_centroids(start.mesh) - face_centroids(found.mesh)
    rows = rescale(recenter(found.local_spheres, centroids), 1 / edge)
    moves = (found.mesh.vertices - start.mesh.vertices) / edge
    return np.concatenate([rows.ravel(), moves.ravel()])


def main() -> None:
    """Both roofs, then faces of 1:20."""
    for kind in ("wave", "vault"):
        compare(kind)
    start, _ = minimize_angles(fit_spheres(strips()))
    _, report = optimize_spheres(start)
    optimum, planes = (np.degrees(report.figures[each].mean) for each in ("optimum", "planes"))
    print(f"1:20, vertices fixed: {optimum:.6f} degrees, planes {planes:.6f}")


if __name__ == "__main__":
    main()
