"""Target angles: four starts, optima of second order, and no say of the numbering (D11)."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.optimization.pencil_energy import (
    PencilDerivatives,
    angle_density,
    angle_energy,
    convex_part,
    couple_pencils,
    energy_derivatives,
    has_convex_blocks,
)
from spheremesh.kernel.optimization.target_starts import two_colors
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles
from spheremesh.kernel.spheres.circles import face_circles

FEET = 1 / 0.3048


def flat(rows: int, length: float) -> Mesh:
    """Rectangles 1 by `length` in a plane."""
    x, y = np.meshgrid(np.arange(rows + 1.0), length * np.arange(rows + 1.0), indexing="ij")
    first = np.arange(rows)[:, None] * (rows + 1) + np.arange(rows)
    steps = np.array([0, rows + 1, rows + 2, 1])
    faces = (first.reshape(-1, 1) + steps).tolist()
    return Mesh(np.stack([x, y, 0 * x], -1).reshape(-1, 3), faces)


def shell(rows: int, columns: int, bend: float = 0.3) -> Mesh:
    """A doubly curved net without any symmetry."""
    u, v = np.meshgrid(np.linspace(-1, 1, rows + 1), np.linspace(-1, 1, columns + 1),
                       indexing="ij")  # fmt: skip
    height = bend * (u**2 - 0.4 * v**2 + 0.3 * u * v + 0.2 * u**3)
    points = np.stack([u + 0.06 * v**2, 0.8 * v + 0.05 * u * v, height], -1).reshape(-1, 3)
    first = np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)
    steps = np.array([0, columns + 1, columns + 2, 1])
    return Mesh(points, (first.reshape(-1, 1) + steps).tolist())


def triangles(mesh: Mesh) -> Mesh:
    """Quads cut in two, every third along the other diagonal: rings of any length."""
    quads = mesh.corners.reshape(-1, 4).copy()
    quads[::3] = np.roll(quads[::3], 1, axis=1)
    return Mesh(mesh.vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


def hessian(found: PencilDerivatives, faces: IntArray, count: int) -> FloatArray:
    matrix = np.zeros((count, count))
    a, b = faces.T
    for rows, columns, values in (
        (a, a, found.first), (b, b, found.second), (a, b, found.mixed), (b, a, found.mixed),
    ):  # fmt: skip
        np.add.at(matrix, (rows, columns), values)
    return matrix


def lowest_eigenvalue(sphere_mesh: SphereMesh, target: float, weights: FloatArray) -> float:
    """Of the second derivatives at an optimum, relative to the largest."""
    mesh = sphere_mesh.mesh
    circles, _ = face_circles(mesh)
    coupling = couple_pencils(mesh, circles, weights)
    angles = pencil_angles(sphere_mesh, circles)
    found = energy_derivatives(coupling, angle_density(target), angles)
    values = np.linalg.eigvalsh(hessian(found, coupling.faces, mesh.n_faces))
    return float(values[0] / np.abs(values).max())


Spelling = tuple[Mesh, IntArray, float]
"""A mesh, the new number of each face, and how much larger it is."""


def spellings(
    mesh: Mesh, rotation: FloatArray, order: tuple[Mesh, IntArray]
) -> dict[str, Spelling]:
    """One shape written in eight ways."""
    same = np.arange(mesh.n_faces)
    points, edge = mesh.vertices, mean_edge_length(mesh)
    noise = 1e-15 * np.random.default_rng(2).normal(size=points.shape)
    mirrored = [face[::-1] for face in mesh.faces]
    turned = [np.roll(face, 1) for face in mesh.faces]
    return {
        "order": (order[0], order[1], 1.0),
        "first corner": (Mesh(points, turned), same, 1.0),
        "rotation": (Mesh(points @ rotation.T, mesh.faces), same, 1.0),
        "mirror": (Mesh(points * [1, 1, -1], mirrored), same, 1.0),
        "millimetres": (Mesh(1000 * points, mesh.faces), same, 1000.0),
        "feet": (Mesh(FEET * points, mesh.faces), same, FEET),
        "far": (Mesh(points + 1e6 * edge * np.array([0.8, -0.5, 0.3]), mesh.faces), same, 1.0),
        "noise": (Mesh(points + noise, mesh.faces), same, 1.0),
    }


def sorted_angles(sphere_mesh: SphereMesh) -> FloatArray:
    return np.sort(np.degrees(intersection_angles(sphere_mesh)))


MESHES = {"quads": shell(6, 7), "triangles": triangles(shell(3, 4)), "flat": flat(5, 3.0)}


@pytest.mark.parametrize(
    ("name", "target"),
    [("quads", 0), ("quads", 10), ("quads", 60), ("quads", 90), ("triangles", 0),
     ("triangles", 30)],
)  # fmt: skip
def test_law_d11_the_optimum_is_one_in_eight_spellings(
    rotation: FloatArray,
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
    name: str,
    target: float,
) -> None:
    mesh = MESHES[name]
    angle = np.radians(target)
    expected, _ = minimize_angles(fit_spheres(mesh), angle)
    curvatures = expected.spheres[:, 0]
    for how, (other, new, scale) in spellings(mesh, rotation, renumber(mesh)).items():
        found, report = minimize_angles(fit_spheres(other), angle)
        assert report.converged, how
        within = 1e-4 if how == "far" else 1e-6
        np.testing.assert_allclose(
            sorted_angles(found), sorted_angles(expected), atol=within, err_msg=how
        )
        bulges = scale * found.local_spheres[new, 0]
        # A mirrored face that keeps its order would be turned over: it runs the other way.
        np.testing.assert_allclose(bulges, curvatures, atol=within, err_msg=how)


@pytest.mark.parametrize("target", [20.0, 60.0])
def test_equal_optima_of_a_symmetric_mesh_are_one_in_every_order(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]], target: float
) -> None:
    """A plane bulges to either side, and a chessboard has two colours."""
    for mesh in (flat(5, 3.0), flat(4, 1.0)):
        other, new = renumber(mesh)
        one, _ = minimize_angles(face_planes(mesh), np.radians(target))
        two, _ = minimize_angles(face_planes(other), np.radians(target))
        np.testing.assert_allclose(
            two.local_spheres[new, 0], one.local_spheres[:, 0], atol=1e-6
        )


@pytest.mark.parametrize("target", [10.0, 30.0, 45.0, 60.0, 80.0, 85.0, 90.0])
def test_law_d11_targets_are_met_wherever_they_can_be(target: float) -> None:
    phi, theta = np.linspace(0, 3, 11)[:2], np.linspace(0.4, 2.4, 9)[3:6]
    points = [
        [np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)] for p in phi for t in theta
    ]
    pair = Mesh(1.3 * np.array(points), [[0, 3, 4, 1], [1, 4, 5, 2]])
    for mesh in (pair, flat(5, 8.0), flat(5, 1.0)):
        found, report = minimize_angles(face_planes(mesh), np.radians(target))
        assert report.converged
        angles = np.degrees(intersection_angles(found))
        np.testing.assert_allclose(angles, target, atol=2e-3 if target == 90 else 1e-6)


@pytest.mark.parametrize("name", ["quads", "triangles", "flat"])
@pytest.mark.parametrize("target", [0.0, 10.0, 45.0, 90.0])
def test_optima_are_of_second_order(name: str, target: float) -> None:
    mesh = MESHES[name]
    found, report = minimize_angles(fit_spheres(mesh), np.radians(target))
    assert report.converged
    weights = np.ones(len(mesh.topology.edge_corners))
    if report.energies[-1] > 1e-20:
        assert lowest_eigenvalue(found, np.radians(target), weights) >= -1e-8


@pytest.mark.parametrize("target", [10.0, 30.0, 60.0, 90.0])
@pytest.mark.parametrize("name", ["quads", "flat"])
def test_no_random_start_of_a_general_solver_reaches_lower(name: str, target: float) -> None:
    mesh = MESHES[name]
    angle = np.radians(target)
    circles, _ = face_circles(mesh)
    weights = np.ones(len(mesh.topology.edge_corners))
    coupling, density = couple_pencils(mesh, circles, weights), angle_density(angle)
    found, _ = minimize_angles(fit_spheres(mesh), angle)
    reached = angle_energy(coupling, density, pencil_angles(found, circles))
    rng = np.random.default_rng(7)
    smooth = pencil_angles(fit_spheres(mesh), circles)
    for number in range(6):
        spread = rng.uniform(-1.2, 1.2, mesh.n_faces)
        start = spread if number % 2 else smooth + np.sign(spread) * angle / 2

        def energy(t: FloatArray) -> tuple[float, FloatArray]:
            gradient = energy_derivatives(coupling, density, t).gradient
            return angle_energy(coupling, density, t), gradient

        other = minimize(energy, start, jac=True, method="L-BFGS-B", options={"maxiter": 3000})
        assert reached <= max(other.fun * (1 + 1e-3), 1e-8)


def test_a_better_start_of_the_user_is_kept() -> None:
    """Spheres that are given already, lower than all starts, are not lost."""
    mesh = MESHES["triangles"]
    angle = np.radians(45)
    best, report = minimize_angles(fit_spheres(mesh), angle)
    again, other = minimize_angles(best, angle)
    assert other.energies[-1] <= report.energies[-1] * (1 + 1e-9)
    np.testing.assert_allclose(again.spheres, best.spheres, atol=1e-5)


def test_pieces_are_optimised_each_by_itself() -> None:
    """Of each piece the best start counts, whatever is best for the others."""
    one, two = MESHES["quads"], flat(3, 5.0)
    points = np.concatenate([one.vertices, two.vertices + 20])
    faces = [*one.faces, *(face + one.n_vertices for face in two.faces)]
    angle = np.radians(30)
    together, report = minimize_angles(fit_spheres(Mesh(points, faces)), angle)
    assert report.converged
    alone = [minimize_angles(fit_spheres(mesh), angle)[0] for mesh in (one, two)]
    expected = np.concatenate([found.local_spheres[:, 0] for found in alone])
    np.testing.assert_allclose(together.local_spheres[:, 0], expected, atol=1e-6)


# Colours and blocks


def test_two_colors_of_even_rings_differ_everywhere() -> None:
    faces = shell(6, 7).topology.edge_faces
    colors = two_colors(faces, 42)
    assert set(colors.tolist()) == {-1.0, 1.0}
    assert (colors[faces[:, 0]] == -colors[faces[:, 1]]).all()


def test_two_colors_of_odd_rings_differ_nearly_everywhere() -> None:
    mesh = triangles(shell(12, 10))
    faces = mesh.topology.edge_faces
    colors = two_colors(faces, mesh.n_faces)
    assert (colors[faces[:, 0]] != colors[faces[:, 1]]).mean() > 0.7
    # A single triangle of neighbours: two of three.
    ring = np.array([[0, 1], [1, 2], [2, 0]])
    found = two_colors(ring, 3)
    assert (found[ring[:, 0]] != found[ring[:, 1]]).sum() == 2


@given(seed=st.integers(0, 10_000))
def test_the_convex_part_keeps_what_curves_upwards(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second, mixed = rng.normal(size=(3, 20))
    found = PencilDerivatives(np.zeros(40), first, second, mixed, 0.0)
    convex = convex_part(found)
    for i in range(20):
        block = np.array([[first[i], mixed[i]], [mixed[i], second[i]]])
        values, vectors = np.linalg.eigh(block)
        expected = vectors @ np.diag(np.maximum(values, 0)) @ vectors.T
        part = np.array(
            [[convex.first[i], convex.mixed[i]], [convex.mixed[i], convex.second[i]]]
        )
        np.testing.assert_allclose(part, expected, atol=1e-12)
        assert has_convex_blocks(found)[i] == (values[0] >= 0)


@given(seed=st.integers(0, 1000), target=st.floats(0.05, 1.5))
def test_law_d8_derivatives_of_the_energy(seed: int, target: float) -> None:
    mesh = MESHES["triangles"]
    circles, _ = face_circles(mesh)
    rng = np.random.default_rng(seed)
    weights = rng.uniform(0, 2, len(mesh.topology.edge_corners))
    coupling, density = couple_pencils(mesh, circles, weights), angle_density(target)
    angles = rng.uniform(-0.8, 0.8, mesh.n_faces)
    way = rng.normal(size=mesh.n_faces)
    found = energy_derivatives(coupling, density, angles)
    h = 1e-5
    sides = [energy_derivatives(coupling, density, angles + s * h * way) for s in (1, -1)]
    heights = [angle_energy(coupling, density, angles + s * h * way) for s in (1, -1)]
    slope = (heights[0] - heights[1]) / (2 * h)
    assert found.gradient @ way == pytest.approx(slope, rel=1e-5, abs=1e-6)
    turn = (sides[0].gradient - sides[1].gradient) / (2 * h)
    matrix = hessian(found, coupling.faces, mesh.n_faces)
    # The second derivative jumps where spheres meet at a right angle: seldom within h.
    np.testing.assert_allclose(matrix @ way, turn, atol=1e-3)
