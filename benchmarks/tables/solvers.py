"""Ours beside general solvers, to the same energy: angles, and the whole energy (6)."""

import time
from collections.abc import Callable, Sequence
from math import cos, sin
from typing import Any

import numpy as np
from energy import FULL, surface
from measure import Table, exponent, measured
from peers import REACHED, SOLVERS, LocalSum, Reached, SquareSum, reach
from scipy.sparse import (
    block_diag,
    bsr_array,
    coo_array,
    csr_array,
    eye_array,
    hstack,
    vstack,
)

from spheremesh import Mesh, nodes
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.optimization.descent.freedom import Freedom, moved, vertex_freedom
from spheremesh.kernel.optimization.descent.multipliers import descend_energy
from spheremesh.kernel.optimization.descent.problem import (
    UPRIGHT,
    EnergyProblem,
    energy_problem,
)
from spheremesh.kernel.optimization.energies.setting import (
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.pencil_energy import couple_pencils, edge_products
from spheremesh.kernel.optimization.whole_energy import Conditions, optimize_spheres
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.kernel.spheres.minkowski import minkowski, minkowski_gradient

LIMIT = 60.0
"""CPU seconds that a peer gets."""
MOST_DENSE = 1000
"""Faces up to which Ceres is tried with a dense Jacobian: 1,600 took 6 GB and no step."""


def angle_sum(mesh: Mesh) -> SquareSum:
    """The energy of the angles, eq. (9), one residual per edge, from fitted spheres."""
    circles, _ = face_circles(mesh)
    coupling = couple_pencils(mesh, circles, np.ones(len(mesh.topology.edge_corners)))
    n_edges = len(coupling.faces)
    places = np.repeat(np.arange(n_edges), 2), coupling.faces.ravel()

    def _residuals(x: FloatArray) -> FloatArray:
        g = edge_products(coupling, x).value
        return g * np.abs(g) - 1

    def _jacobian(x: FloatArray) -> csr_array:
        found = edge_products(coupling, x)
        slopes = (
            2 * np.abs(found.value)[:, None] * np.stack([found.by_first, found.by_second], 1)
        )
        return csr_array((slopes.ravel(), places), shape=(n_edges, mesh.n_faces))

    def _local(edge: int) -> LocalSum:
        pp, pq, qp, qq = coupling.products[:, edge].tolist()

        def _evaluate(s: float, t: float) -> tuple[Sequence[float], Sequence[Sequence[float]]]:
            c, d, e, f = cos(s), sin(s), cos(t), sin(t)
            p, q = pp * e + pq * f, qp * e + qq * f
            g = c * p + d * q
            slope = 2 * abs(g)
            by_second = c * (pq * e - pp * f) + d * (qq * e - qp * f)
            return (g * abs(g) - 1,), ((slope * (c * q - d * p),), (slope * by_second,))

        return LocalSum(tuple(coupling.faces[edge].tolist()), 1, _evaluate)

    start = pencil_angles(nodes.fit_spheres(mesh), circles)
    return SquareSum(_residuals, _jacobian, start, [_local(edge) for edge in range(n_edges)])


def our_angles(size: int) -> tuple[int, float, float, bool]:
    """Faces, energy, seconds, and whether it converged."""
    minimize_angles(nodes.fit_spheres(surface(4)))  # load scipy before the clock
    mesh = surface(size)
    start = nodes.fit_spheres(mesh)
    began = time.process_time()
    found, report = minimize_angles(start)
    seconds = time.process_time() - began
    energy = 0.0
    if mesh.n_faces < 100_000:
        x = pencil_angles(found, face_circles(mesh)[0])
        residuals = angle_sum(mesh).residuals(x)
        energy = float(residuals @ residuals)
    return mesh.n_faces, energy, seconds, report.converged


def peer_angles(name: str, size: int, aim: float) -> Reached:
    """What a general solver reaches."""
    return reach(name, angle_sum(surface(size)), aim, LIMIT)


def angles(*, is_quick: bool) -> list[Table]:
    """Least angles, one unknown per face."""
    sizes = (22, 71) if is_quick else (22, 71, 224, 707)
    rows: list[tuple[Any, ...]] = []
    counts, seconds = [], []
    for size in sizes:
        (n_faces, energy, spent, converged), peak = measured(our_angles, size)
        counts.append(n_faces)
        seconds.append(spent)
        own = "spheremesh" if converged else "spheremesh (NOT CONVERGED)"
        rows.append((n_faces, own, spent, 1.0, peak))
        if n_faces < 100_000:
            rows += [
                _peer_row(
                    n_faces, name, *measured(peer_angles, name, size, energy), energy, spent
                )
                for name in SOLVERS
            ]
    return [
        Table(
            "Angles at edges",
            "Spheres through the circles of the faces of a freeform roof of quads, one unknown "
            "per face, from fitted spheres to the least energy of eq. (9) "
            "(within 1e-6 of it). Ours grows as faces to the power "
            f"{exponent(counts, seconds):.2f}, from {counts[0]} to {counts[-1]:,} faces.",
            ("Faces", "Solver", "Seconds", "Ratio", "GB"),
            rows,
        )
    ]


def _peer_row(
    n_faces: int, name: str, found: Reached, peak: float, aim: float, ours: float
) -> tuple[Any, ...]:

    if found.energy <= aim * (1 + REACHED):
        return n_faces, name, found.seconds, found.seconds / ours, peak
    off = found.energy / aim - 1
    said = f"not reached in {found.seconds:.0f} s ({off:.1e} above)"
    return n_faces, name, said, f"> {found.seconds / ours:.0f}", peak


def energy_sum(size: int) -> tuple[SquareSum, EnergyProblem, Unknowns]:
    """Energy (6) with a support, vertices fixed: as squares, our problem, and the start."""
    mesh = surface(size)
    start = first_unknowns(minimize_angles(nodes.fit_spheres(mesh))[0])
    setting = energy_setting(mesh, np.ones(len(mesh.topology.edge_corners)))
    freedom = Freedom(0.0, vertex_freedom(mesh, "free", "free"), np.zeros(mesh.n_faces, bool))
    problem = energy_problem(setting, freedom, FULL)
    split, none = start.spheres.size, np.zeros((0, 3))

    def _unknowns(x: FloatArray) -> Unknowns:
        free = Unknowns(x[:split].reshape(-1, 5), start.displacements, x[split:].reshape(-1, 3))
        return moved(freedom, free, (0 * free.spheres, none, 0 * free.normals))

    def _residuals(x: FloatArray) -> FloatArray:
        found = _unknowns(x)
        terms = zip(problem.terms, problem.weights, strict=True)
        leaning = UPRIGHT * (found.normals - problem.upright)
        return np.concatenate(
            [*(weight * t.residuals(setting, found) for t, weight in terms), leaning.ravel()]
        )

    def _jacobian(x: FloatArray) -> csr_array:
        rows, axes = x[:split].reshape(-1, 5), x[split:].reshape(-1, 3)
        of_rows = _of_unit(rows, np.sqrt(minkowski(rows, rows)), minkowski_gradient)
        of_axes = _of_unit(axes, np.linalg.norm(axes, axis=1), lambda unit: unit)
        by_axes = UPRIGHT * eye_array(axes.size)
        rest = coo_array((axes.size, rows.size))
        by_unit = vstack([jacobian(problem, _unknowns(x)), hstack([rest, by_axes])])
        return csr_array(by_unit @ block_diag([of_rows, of_axes]))

    x = np.concatenate([start.spheres.ravel(), start.normals.ravel()])
    return SquareSum(_residuals, _jacobian, x), problem, start


def _of_unit(
    rows: FloatArray, lengths: FloatArray, gradient: Callable[[FloatArray], FloatArray]
) -> bsr_array:
    """Derivative of ``x / |x|`` by x for rows of any length: a sparse matrix of blocks."""
    unit = rows / lengths[:, None]
    width = rows.shape[1]
    tables = np.eye(width) - unit[:, :, None] * gradient(unit)[:, None, :]
    tables /= lengths[:, None, None]
    count = np.arange(len(rows) + 1)
    return bsr_array((tables, count[:-1], count), shape=(rows.size, rows.size))


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


def our_energy(size: int) -> tuple[int, float, float]:
    """Faces, energy and seconds of our Newton's method on the squares alone."""
    _, problem, start = energy_sum(4)
    descend_energy(problem, start, 500, 1e-12)  # load scipy before the clock
    _, problem, start = energy_sum(size)
    began = time.process_time()
    found = descend_energy(problem, start, 500, 1e-12)
    seconds = time.process_time() - began
    return size**2, float(found.history[-1].sum()), seconds


def peer_energy(name: str, size: int, aim: float) -> Reached:
    """What a general solver reaches."""
    return reach(name, energy_sum(size)[0], aim, LIMIT)


def whole_job(size: int) -> tuple[int, float, bool]:
    """Faces, seconds, and whether the whole job with its conditions converged."""
    for count in (4, size):  # the first loads scipy
        start, _ = minimize_angles(nodes.fit_spheres(surface(count)))
        began = time.process_time()
        _, report = optimize_spheres(start, FULL, Conditions())
        seconds = time.process_time() - began
    return size**2, seconds, report.converged


def energy(*, is_quick: bool) -> list[Table]:
    """The whole energy with a support."""
    rows: list[tuple[Any, ...]] = []
    for size in (10,) if is_quick else (10, 22, 40):
        (n_faces, least, spent), peak = measured(our_energy, size)
        rows.append((n_faces, "spheremesh", spent, 1.0, peak))
        for name in SOLVERS:
            if name.startswith("Ceres") and n_faces > MOST_DENSE:
                rows.append((n_faces, name, "not tried: its Jacobian takes 6 GB", "", ""))
                continue
            found, peak = measured(peer_energy, name, size, least)
            rows.append(_peer_row(n_faces, name, found, peak, least, spent))
    jobs: list[tuple[Any, ...]] = []
    counts, seconds = [], []
    for size in (22, 71) if is_quick else (22, 71, 224):
        (n_faces, spent, converged), peak = measured(whole_job, size)
        counts.append(n_faces)
        seconds.append(spent)
        jobs.append((n_faces, spent, "yes" if converged else "NO", peak))
    return [
        Table(
            "Energy (6) with a support",
            "Vertices stay; spheres and node axes of a freeform roof of quads on no circles, "
            "weights of the paper's Table 1, from the least angles to the same energy "
            "(within 1e-6). Ceres gets a dense Jacobian here: from Python it could have a "
            "sparse one only by a call for each residual.",
            ("Faces", "Solver", "Seconds", "Ratio", "GB"),
            rows,
        ),
        Table(
            "The whole job with a support",
            "The same roof by `optimize_spheres`, with the multipliers that hold what must "
            f"hold. It grows as faces to the power {exponent(counts, seconds):.2f}.",
            ("Faces", "Seconds", "Converged", "GB"),
            jobs,
        ),
    ]


PAPER = (
    ("1", 4982, 40, 9.8, "quads"),
    ("3", 6144, 40, 4.3, "triangles"),
    ("23", 1766, 60, 0.9, "quads"),
    ("20", 2240, 60, 1.4, "triangles"),
    ("26", 264, 60, 0.15, "quads"),
    ("28", 390, 120, 0.7, "hexagons"),
)
"""Figure, faces, iterations, seconds of each, and the kind of net that we put in its place."""


def net(kind: str, n_faces: int) -> Mesh:
    """A net of about so many faces."""
    from hexagons import ellipsoid, shifted_grid

    if kind == "quads":
        return surface(round(n_faces**0.5))
    if kind == "triangles":
        side = round((n_faces / 2) ** 0.5)
        return shifted_grid(ellipsoid, side + 1, side + 1, closed=False, outside=False)
    side = round(n_faces**0.5)
    triangles = shifted_grid(ellipsoid, side + 2, side + 2, closed=False, outside=False)
    grown = nodes.evolve_spheres(triangles, 15.0)
    return nodes.tangent_sphere_shex(grown.mesh, grown.spheres).sphere_mesh.mesh


def paper_row(kind: str, count: int) -> tuple[int, int, float, bool]:
    """Faces, steps, seconds, and whether it converged: energy (6) with a support."""
    for size in (25, count):  # the first loads scipy
        start = nodes.fit_spheres(net(kind, size))
        began = time.process_time()
        _, report = optimize_spheres(start, FULL, Conditions())
        seconds = time.process_time() - began
    steps = sum(stage.iterations for stage in report.stages)
    return start.mesh.n_faces, steps, seconds, report.converged


def paper(*, is_quick: bool) -> list[Table]:
    """The rows of the paper's Table 1."""
    rows: list[tuple[Any, ...]] = []
    for figure, n_faces, steps, each, kind in PAPER[4:] if is_quick else PAPER:
        (count, ours, seconds, converged), peak = measured(paper_row, kind, n_faces)
        state = "yes" if converged else "NO"
        rows.append((f"Fig. {figure}", n_faces, steps, steps * each, f"{count} {kind}", ours,
                     seconds, state, peak))  # fmt: skip
    return [
        Table(
            "The paper's Table 1",
            "The paper's meshes are not public: in their place stand nets of our own of the "
            "same size, with all terms of energy (6), to the end and not for some steps. "
            "The paper's seconds are its steps times its seconds per step on an Intel "
            "i7-7500U; ours are of the machine above.",
            ("Figure", "Faces", "Steps", "Paper's seconds", "Ours", "Our steps",
             "Our seconds", "Converged", "GB"),
            rows,
        )
    ]  # fmt: skip
