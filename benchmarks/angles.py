"""The smallest angles: against planes, with targets against a general solver, and how fast.

    python benchmarks/angles.py [planes FOLDER] [targets] [speed] [large]

`planes` reads every mesh of a folder and compares the mean angle over edges that are no crease
with that of flat panels. `targets` compares the energies of target angles with the best of 20
independent starts of scipy. `speed` times 5,000 and 50,000 faces, with `large` 500,000 as well.
Seconds are CPU seconds of this machine now; what counts are the ratios and the exponent.
"""

import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh import Mesh, nodes
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.optimization.pencil_energy import (
    PencilCoupling,
    angle_density,
    angle_energy,
    couple_pencils,
    energy_derivatives,
)
from spheremesh.kernel.spheres.circles import face_circles

STARTS = 20
CREASE = np.radians(40)


def grid(points: FloatArray) -> Mesh:
    """Quads of a table of points (m, n, 3)."""
    rows, columns = len(points), len(points[0])
    place: IntArray = np.arange(rows * columns).reshape(rows, columns)
    sides = [place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]]
    return Mesh(points.reshape(-1, 3), np.stack([side.ravel() for side in sides], 1))


def flat(count: int, length: float) -> Mesh:
    """Rectangles 1 by `length` in a plane."""
    side = np.arange(count + 1.0)
    x, y = np.meshgrid(side, length * side, indexing="ij")
    return grid(np.stack([x, y, 0 * x], -1))


def tube(around: int, along: int) -> Mesh:
    """Part of a cylinder."""
    turn, height = np.meshgrid(np.linspace(0, 2, around + 1), np.linspace(0, 3, along + 1),
                               indexing="ij")  # fmt: skip
    return grid(np.stack([3 * np.cos(turn), 3 * np.sin(turn), height], -1))


def surface(rows: int, columns: int, kind: str) -> Mesh:
    """A graph over a square: curved in every way, a dome, or a bowl bent mostly one way."""
    u, v = np.meshgrid(np.linspace(-1, 1, rows + 1), np.linspace(-1, 1, columns + 1),
                       indexing="ij")  # fmt: skip
    height = {
        "free": 0.35 * (1 - u**2) * (1 - 0.6 * v**2) + 0.1 * np.sin(2 * u + v),
        "dome": np.sqrt(4 - u**2 - v**2),
        "bowl": 0.5 * (u**2 + 0.2 * v**2),
    }[kind]
    return grid(np.stack([u, v, height], -1))


def planes(folder: Path) -> None:
    """Mean angles of planes and of spheres, for every mesh of a folder."""
    worse = 0
    for path in sorted(folder.glob("*.obj")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh = nodes.read_mesh(str(path))
            found = nodes.minimize_angles(nodes.fit_spheres(mesh)).report
        planar, spherical = found["angles_deg"]["planar"], found["angles_deg"]["spherical"]
        is_worse = spherical["mean"] > planar["mean"] * (1 + 1e-9)
        worse += is_worse
        print(
            f"{path.stem[:28]:28s} {mesh.n_faces:5d} faces, {found['creases']['count']:3d} "
            f"creases: {planar['mean']:9.6f} with planes, {spherical['mean']:12.9f} with "
            f"spheres{' WORSE' if is_worse else ''}"
        )
    print(f"rougher than planes: {worse}")


def best_of_scipy(
    coupling: PencilCoupling, target: float, smooth: FloatArray, starts: int
) -> float:
    """Least energy of L-BFGS from random starts, half of them near smooth contact."""
    import scipy.optimize

    solver: Any = scipy.optimize.minimize
    density = angle_density(target)
    rng = np.random.default_rng(3)

    def _energy(t: FloatArray) -> tuple[float, FloatArray]:
        gradient = energy_derivatives(coupling, density, t).gradient
        return angle_energy(coupling, density, t), gradient

    best = np.inf
    for number in range(starts):
        spread = rng.uniform(-1.2, 1.2, len(smooth))
        start = spread if number % 2 else smooth + np.sign(spread) * target / 2
        options = {"maxiter": 5000, "maxfun": 10_000, "ftol": 1e-14, "gtol": 1e-10}
        found = solver(_energy, start, jac=True, method="L-BFGS-B", options=options)
        best = min(best, float(found.fun))
    return best


def targets() -> None:
    """Energies of target angles, and of a general solver."""
    meshes = {
        "vase": nodes.vase_mesh(), "ellipsoid": nodes.ellipsoid_mesh(),
        "torus": nodes.torus_mesh(24, 12), "catenoid": nodes.catenoid_mesh(24, 9),
        "cylinder": tube(12, 8), "flat 1:8": flat(5, 8.0), "squares": flat(10, 1.0),
        "roof": nodes.roof_mesh(12, 20),
    }  # fmt: skip
    worse = 0
    for name, mesh in meshes.items():
        start = nodes.fit_spheres(mesh)
        circles, _ = face_circles(mesh)
        weights = np.ones(len(mesh.topology.edge_corners))
        coupling = couple_pencils(mesh, circles, weights)
        smooth = pencil_angles(minimize_angles(start)[0], circles)
        for degrees in (10, 30, 45, 60, 90):
            target, began = np.radians(degrees), time.process_time()
            found, report = minimize_angles(start, target)
            seconds = time.process_time() - began
            angles = pencil_angles(found, circles)
            ours = angle_energy(coupling, angle_density(target), angles)
            other = best_of_scipy(coupling, target, smooth, STARTS)
            is_worse = ours > max(other * (1 + 1e-3), 1e-8) or not report.converged
            worse += is_worse
            print(
                f"{name:10s} {mesh.n_faces:4d} faces, {degrees:2d} degrees: {ours:.4e} in "
                f"{seconds:.2f} s, best of {STARTS} starts {other:.4e}"
                f"{' WORSE' if is_worse else ''}",
                flush=True,
            )
    print(f"worse than a general solver: {worse}")


def sized(name: str, size: int) -> Mesh:
    """A mesh of about size² faces."""
    if name == "roof":
        return nodes.roof_mesh(round(size / 2**0.5), round(size * 2**0.5))
    if name == "free, 1:20":
        return surface(round(size * 4.5), round(size / 4.5), "free")
    return surface(size, size, name)


def speed(*, is_large: bool) -> None:
    """Seconds of the smallest angles, and how they grow."""
    sizes = (71, 225, 707) if is_large else (71, 225)
    minimize_angles(nodes.fit_spheres(tube(4, 4)))  # load scipy outside of the clock
    for name in ("roof", "free", "dome", "bowl", "free, 1:20"):
        counts, seconds = list[int](), list[float]()
        for size in sizes:
            start = nodes.fit_spheres(sized(name, size))
            began = time.process_time()
            _, report = minimize_angles(start, crease=CREASE)
            seconds.append(time.process_time() - began)
            counts.append(start.mesh.n_faces)
            print(
                f"{name:10s} {counts[-1]:6d} faces: {seconds[-1]:7.3f} s, "
                f"{sum(report.iterations)} steps, converged {report.converged}",
                flush=True,
            )
        exponent = np.log(seconds[-1] / seconds[0]) / np.log(counts[-1] / counts[0])
        print(f"{name:10s} exponent {exponent:.2f}")


def main(options: list[str]) -> None:
    """Print what is asked for; everything but the large meshes without options."""
    if "planes" in options:
        planes(Path(options[options.index("planes") + 1]))
    if not options or "targets" in options:
        targets()
    if not options or "speed" in options or "large" in options:
        speed(is_large="large" in options)


if __name__ == "__main__":
    main(sys.argv[1:])
