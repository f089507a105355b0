"""Angle minimisation in circle pencils (D8, D11): derivatives, optimum, invariances."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_centroids, mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.optimization.pencil_energy import (
    PencilCoupling,
    angle_density,
    couple_pencils,
    edge_products,
    signed_density,
)
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.rows import recenter
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, roof_net, torus_net

NETS = ["torus", "ellipsoid", "egg", "catenoid", "vase", "enneper", "roof"]
STEP = 1e-5


def mean_angle(sphere_mesh: SphereMesh) -> float:
    return float(np.degrees(intersection_angles(sphere_mesh)).mean())


def members(mesh: Mesh, angles: FloatArray) -> SphereMesh:
    """Spheres of the faces' pencils at given unknowns."""
    circles, _ = face_circles(mesh)
    return SphereMesh.from_local(mesh, pencil_spheres(*circle_pencils(circles), angles))


def coupling_of(mesh: Mesh) -> PencilCoupling:
    weights = np.ones(len(mesh.topology.edge_corners))
    return couple_pencils(mesh, face_circles(mesh)[0], weights)


def fold(dihedral: float) -> Mesh:
    """Two unit squares that meet along the y axis, a roof falling by `dihedral`."""
    c, s = np.cos(dihedral / 2), np.sin(dihedral / 2)
    points = [[-c, 0, -s], [0, 0, 0], [c, 0, -s], [-c, 1, -s], [0, 1, 0], [c, 1, -s]]
    return Mesh(points, [[0, 1, 4, 3], [1, 2, 5, 4]])


def triangulated(mesh: Mesh) -> Mesh:
    quads = np.stack(mesh.faces)
    return Mesh(mesh.vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


# Products and derivatives


@pytest.mark.parametrize("name", NETS)
def test_law_d8_products_are_those_of_the_rows(nets: dict[str, Mesh], name: str) -> None:
    mesh = nets[name]
    angles = np.random.default_rng(0).uniform(-1.4, 1.4, mesh.n_faces)
    found = edge_products(coupling_of(mesh), angles).value
    rows = members(mesh, angles).local_spheres
    left, right = mesh.topology.edge_faces.T
    across = face_centroids(mesh)[left] - face_centroids(mesh)[right]
    expected = minkowski(rows[left], recenter(rows[right], across))
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize("name", ["torus", "roof", "enneper"])
@pytest.mark.parametrize("spread", [0.0, 1e-6, 0.3, 1.5])
def test_law_d8_derivatives_of_products(
    nets: dict[str, Mesh], name: str, spread: float
) -> None:
    """At planes, nearly flat, curved and steep spheres; second derivatives too."""
    mesh = nets[name]
    coupling = coupling_of(mesh)
    angles = np.random.default_rng(1).uniform(-1, 1, mesh.n_faces) * spread
    left, right = coupling.faces.T

    def value(a: FloatArray, b: FloatArray) -> FloatArray:
        """Each edge by itself: its two unknowns as if nobody shared them."""
        n = len(left)
        own = PencilCoupling(
            np.stack([np.arange(n), np.arange(n) + n], 1), coupling.products, coupling.weights
        )
        return edge_products(own, np.concatenate([a, b])).value

    a, b, h = angles[left], angles[right], STEP
    found = edge_products(coupling, angles)
    np.testing.assert_allclose(found.value, value(a, b), atol=1e-14)
    scale = np.abs(coupling.products).max()
    by_first = (value(a + h, b) - value(a - h, b)) / (2 * h)
    by_second = (value(a, b + h) - value(a, b - h)) / (2 * h)
    np.testing.assert_allclose(found.by_first, by_first, atol=1e-7 * scale)
    np.testing.assert_allclose(found.by_second, by_second, atol=1e-7 * scale)
    h = 1e-4
    corners = value(a + h, b + h) - value(a + h, b - h) - value(a - h, b + h)
    mixed = (corners + value(a - h, b - h)) / (4 * h**2)
    np.testing.assert_allclose(found.mixed, mixed, atol=1e-6 * scale)
    twice = (value(a + h, b) - 2 * value(a, b) + value(a - h, b)) / h**2
    np.testing.assert_allclose(twice, -found.value, atol=1e-6 * scale)


@given(g=st.floats(-1.5, 1.5), target=st.floats(0, np.pi / 2))
def test_law_d8_derivatives_of_densities(g: float, target: float) -> None:
    # The second derivative jumps at a right angle.
    assume(abs(g) > 2 * STEP)
    for density in (signed_density, angle_density(target)):
        values = np.array([g - STEP, g, g + STEP])
        energy, slope, bend = density(values)
        np.testing.assert_allclose(slope[1], (energy[2] - energy[0]) / (2 * STEP), atol=1e-7)
        np.testing.assert_allclose(bend[1], (slope[2] - slope[0]) / (2 * STEP), atol=1e-7)


@given(phi=st.floats(0, np.pi), target=st.floats(0, np.pi / 2))
def test_law_d8_densities_are_zero_at_their_target(phi: float, target: float) -> None:
    g = np.array([np.cos(phi)])
    signed = np.sin(phi) ** 4 if phi <= np.pi / 2 else (1 + np.cos(phi) ** 2) ** 2
    np.testing.assert_allclose(angle_density(0.0)(g)[0], signed, atol=1e-14)
    np.testing.assert_allclose(signed_density(g)[0], 2 * np.sin(phi / 2) ** 2, atol=1e-15)
    np.testing.assert_allclose(angle_density(target)(np.cos([target]))[0], 0, atol=1e-15)
    assert (angle_density(target)(g)[0] >= 0).all()


@pytest.mark.parametrize("name", NETS)
def test_unknowns_of_pencil_members_come_back(nets: dict[str, Mesh], name: str) -> None:
    mesh = nets[name]
    angles = np.random.default_rng(2).uniform(-3, 3, mesh.n_faces)
    found = pencil_angles(members(mesh, angles), face_circles(mesh)[0])
    np.testing.assert_allclose(found, angles, atol=1e-10)


# The optimum


@pytest.mark.parametrize("name", NETS)
def test_result_keeps_vertices_and_falls_in_energy(nets: dict[str, Mesh], name: str) -> None:
    mesh = nets[name]
    found, report = minimize_angles(face_planes(mesh))
    assert vertex_error(found).max() < 1e-11 * np.abs(mesh.vertices).max()
    assert report.converged
    assert max(report.iterations) <= 12
    assert report.circle_miss < 1e-10
    energies = np.array(report.energies)
    # After stage 1 each step of stage 2 is accepted only downhill; the last ones stand still.
    assert (np.diff(energies[1:]) <= 1e-12 * energies[1]).all()
    sines = np.sin(intersection_angles(found)) ** 4
    assert energies[-1] == pytest.approx(sines.sum(), rel=1e-9)
    planar = np.sin(intersection_angles(face_planes(mesh))) ** 4
    assert energies[-1] < planar.sum()
    assert energies[0] == pytest.approx(planar.sum(), rel=1e-9)


@pytest.mark.parametrize("name", NETS)
def test_result_is_stationary(nets: dict[str, Mesh], name: str) -> None:
    """The energy of the rows themselves, perturbed face by face."""
    mesh = nets[name]
    found, _ = minimize_angles(face_planes(mesh))
    angles = pencil_angles(found, face_circles(mesh)[0])
    coupling = coupling_of(mesh)

    def energy(t: FloatArray) -> float:
        return float(((edge_products(coupling, t).value ** 2 - 1) ** 2).sum())

    least = energy(angles)
    rng = np.random.default_rng(3)
    for scale in (1e-4, 1e-2):
        for _ in range(10):
            change = scale * rng.normal(size=mesh.n_faces)
            assert energy(angles + change) > least
    for face in rng.integers(mesh.n_faces, size=5):
        change = np.zeros(mesh.n_faces)
        change[face] = STEP
        slope = (energy(angles + change) - energy(angles - change)) / (2 * STEP)
        assert abs(slope) < 1e-8


@pytest.mark.parametrize("name", NETS)
def test_result_does_not_depend_on_the_start(
    nets: dict[str, Mesh], name: str, assert_spheres_close: Callable[..., None]
) -> None:
    mesh = nets[name]
    expected, _ = minimize_angles(face_planes(mesh))
    fitted = fit_spheres(mesh)
    fit_angles = pencil_angles(fitted, face_circles(mesh)[0])
    rng = np.random.default_rng(4)
    starts = {
        "fit": fitted,
        "reflected": members(mesh, -fit_angles),
        "optimum": expected,
        "near": members(mesh, fit_angles + rng.uniform(-0.1, 0.1, mesh.n_faces)),
        "random": members(mesh, rng.uniform(-1.5, 1.5, mesh.n_faces)),
    }
    edge = mean_edge_length(mesh)
    for start in starts.values():
        found, report = minimize_angles(start)
        assert report.converged
        assert_spheres_close(
            found.local_spheres, expected.local_spheres, 1e-6, edge, oriented=True
        )
        assert mean_angle(found) == pytest.approx(mean_angle(expected), abs=1e-6)


@pytest.mark.parametrize(
    ("name", "most", "least"),
    [
        ("ellipsoid", 0.35, 0.2),
        ("egg", 0.3, 0.15),
        ("vase", 0.7, 0.5),
        ("roof", 0.75, 0.5),
        ("torus", 0.95, 0.8),
        ("catenoid", 1.0, 0.85),
        ("enneper", 1.0, 0.97),
    ],
)
def test_gains_over_plane_faces(
    nets: dict[str, Mesh], name: str, most: float, least: float
) -> None:
    """Large where both curvatures are of one sign and alike, none on minimal surfaces."""
    planes = face_planes(nets[name])
    gain = mean_angle(minimize_angles(planes)[0]) / mean_angle(planes)
    assert least < gain < most


def test_refinement_halves_the_angles() -> None:
    coarse, fine = (
        mean_angle(minimize_angles(face_planes(roof_net(n, 2 * n, 40.0)))[0]) for n in (8, 16)
    )
    assert fine == pytest.approx(coarse / 2, rel=0.15)


def test_the_mean_may_rise_while_the_energy_falls(nets: dict[str, Mesh]) -> None:
    """What is minimised is the sum of sin⁴, not the mean angle."""
    fitted = fit_spheres(nets["torus"])
    found, report = minimize_angles(fitted)
    assert report.energies[-1] < (np.sin(intersection_angles(fitted)) ** 4).sum()
    assert mean_angle(found) > mean_angle(fitted)


@pytest.mark.parametrize("faces", ["quads", "triangles"])
def test_inscribed_meshes_return_their_sphere(
    ball: Mesh, faces: str, assert_spheres_close: Callable[..., None]
) -> None:
    mesh = ball if faces == "quads" else triangulated(ball)
    found, report = minimize_angles(face_planes(mesh))
    expected = np.array([-0.25, 0, 0, 0, 1.0])
    assert_spheres_close(found.spheres, expected, 1e-7, 2.0, oriented=True)
    assert report.converged
    assert np.degrees(intersection_angles(found)).max() < 1e-4


CUBE = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


@pytest.mark.parametrize("body", ["cube", "octahedron", "tetrahedron"])
def test_coarse_bodies_return_their_sphere(
    body: str, octahedron: Mesh, assert_spheres_close: Callable[..., None]
) -> None:
    """Planes that meet at 70 to 109 degrees are far from the optimum, but not too far."""
    corners = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij"), -1).reshape(-1, 3)
    mesh = {
        "cube": Mesh(corners / np.sqrt(3), CUBE),
        "octahedron": octahedron,
        "tetrahedron": Mesh(
            corners[[0, 3, 5, 6]] / np.sqrt(3), [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]
        ),
    }[body]
    found, report = minimize_angles(face_planes(mesh))
    assert report.converged
    expected = np.array([-0.5, 0, 0, 0, 0.5])
    assert_spheres_close(found.spheres, expected, 1e-6, oriented=True)


@pytest.mark.parametrize("dihedral", [20.0, -20.0, 50.0, 0.0])
def test_two_faces_meet_smoothly(dihedral: float) -> None:
    found, report = minimize_angles(face_planes(fold(np.radians(dihedral))))
    assert report.converged
    assert np.degrees(intersection_angles(found)[0]) < 1e-3


@pytest.mark.parametrize("target", [20.0, 60.0, 85.0])
@pytest.mark.parametrize("dihedral", [10.0, 40.0])
def test_law_d11_two_faces_meet_at_the_target(target: float, dihedral: float) -> None:
    start = face_planes(fold(np.radians(dihedral)))
    found, report = minimize_angles(start, np.radians(target))
    assert report.converged
    assert np.degrees(intersection_angles(found)[0]) == pytest.approx(target, abs=1e-3)


# Invariances


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_law_optimum_is_invariant_under_similarities(
    nets: dict[str, Mesh], rotation: FloatArray, name: str, scale: float
) -> None:
    mesh = nets[name]
    expected = mean_angle(minimize_angles(face_planes(mesh))[0])
    moved = Mesh(scale * mesh.vertices @ rotation.T, mesh.faces)
    found, report = minimize_angles(face_planes(moved))
    assert report.converged
    assert mean_angle(found) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("name", NETS)
def test_law_optimum_survives_a_far_site(nets: dict[str, Mesh], name: str) -> None:
    mesh = nets[name]
    expected = mean_angle(minimize_angles(face_planes(mesh))[0])
    shift = 1e6 * mean_edge_length(mesh) * np.array([0.8, -0.6, 0.1])
    far = Mesh(mesh.vertices + shift, mesh.faces)
    found, report = minimize_angles(face_planes(far))
    assert report.converged
    assert mean_angle(found) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("name", NETS)
def test_law_optimum_does_not_depend_on_the_numbering(
    nets: dict[str, Mesh],
    name: str,
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
    assert_spheres_close: Callable[..., None],
) -> None:
    expected, _ = minimize_angles(face_planes(nets[name]))
    mesh, new = renumber(nets[name])
    found, _ = minimize_angles(face_planes(mesh))
    assert mean_angle(found) == pytest.approx(mean_angle(expected), abs=1e-6)
    size = np.abs(mesh.vertices).max()
    assert_spheres_close(found.spheres[new], expected.spheres, 1e-7, size, oriented=True)


# Weights and odd meshes


def test_weights_of_one_change_nothing_and_scale_out(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    expected = mean_angle(minimize_angles(face_planes(mesh))[0])
    count = len(mesh.topology.edge_corners)
    for weight in (1.0, 2.5, 1e-3):
        found, _ = minimize_angles(face_planes(mesh), edge_weights=np.full(count, weight))
        assert mean_angle(found) == pytest.approx(expected, abs=1e-6)


def test_edges_of_weight_zero_are_ignored() -> None:
    """Only edges along the tube count: angles across them vanish on a surface of revolution."""
    mesh = ellipsoid_net(18, 7, 2.0, 3.0, 1.1)
    ends = mesh.vertices[mesh.topology.edge_vertices]
    is_meridian = np.abs(ends[:, 0, 2] - ends[:, 1, 2]) > 1e-9
    found, report = minimize_angles(face_planes(mesh), edge_weights=is_meridian.astype(float))
    assert report.converged
    angles = np.degrees(intersection_angles(found))
    assert angles[is_meridian].max() < 1e-3
    assert angles[~is_meridian].max() > 0.1
    none, report = minimize_angles(face_planes(mesh), edge_weights=np.zeros(len(angles)))
    assert report.converged
    assert np.isfinite(none.spheres).all()


@pytest.mark.parametrize("bad", [-1e-9, np.nan, np.inf])
def test_weights_are_finite_and_not_negative(nets: dict[str, Mesh], bad: float) -> None:
    mesh = nets["vase"]
    weights = np.ones(len(mesh.topology.edge_corners))
    weights[3] = bad
    with pytest.raises(InputError, match="finite and at least 0"):
        minimize_angles(face_planes(mesh), edge_weights=weights)
    with pytest.raises(InputError, match="must have shape"):
        minimize_angles(face_planes(mesh), edge_weights=weights[:-1])


@pytest.mark.parametrize("target", [-0.1, 1.6, np.nan])
def test_targets_are_angles_up_to_a_right_one(ball: Mesh, target: float) -> None:
    with pytest.raises(InputError, match="between 0 and 90 degrees"):
        minimize_angles(face_planes(ball), target)


def test_a_single_face_is_flat(assert_spheres_close: Callable[..., None]) -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    for t in (0.0, 0.4):
        found, report = minimize_angles(members(mesh, np.array([t])))
        assert report.converged
        assert_spheres_close(found.spheres, face_planes(mesh).spheres, 1e-9, oriented=True)


def test_disconnected_pieces_do_not_disturb_each_other(
    assert_spheres_close: Callable[..., None],
) -> None:
    first, second = roof_net(6, 5, 10.0), torus_net(8, 6, 3.0, 1.0)
    points = np.concatenate([first.vertices, second.vertices + 50])
    faces = [*first.faces, *(face + first.n_vertices for face in second.faces)]
    together, report = minimize_angles(face_planes(Mesh(points, faces)))
    assert report.converged
    alone = [minimize_angles(face_planes(mesh))[0].local_spheres for mesh in (first, second)]
    assert_spheres_close(together.local_spheres, np.concatenate(alone), 1e-7, oriented=True)


def test_faces_off_their_circles_are_reported() -> None:
    mesh = roof_net(6, 5, 10.0)
    rng = np.random.default_rng(5)
    edge = mean_edge_length(mesh)
    rough = Mesh(mesh.vertices + 1e-3 * edge * rng.normal(size=mesh.vertices.shape), mesh.faces)
    found, report = minimize_angles(face_planes(rough))
    assert 1e-4 < report.circle_miss < 1e-2
    assert 0.1 * report.circle_miss < vertex_error(found).max() / edge < 3 * report.circle_miss
