"""Few radii (D13): k-means on curvatures, circles and sides kept."""

import numpy as np
import pytest
import sklearn.cluster  # noqa: F401  its import takes seconds: not within a test

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.surfaces.circular_nets import roof_net


def curvatures(sphere_mesh: SphereMesh) -> FloatArray:
    return np.abs(2 * sphere_mesh.local_spheres[:, 0])


def squares(turned: FloatArray) -> SphereMesh:
    """Unit squares apart from each other, on pencil members t."""
    count = len(turned)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    shifts = np.arange(count)[:, None, None] * np.array([3.0, 0, 0])
    mesh = Mesh((square + shifts).reshape(-1, 3), np.arange(4 * count).reshape(-1, 4))
    circles, _ = face_circles(mesh)
    rows = pencil_spheres(*circle_pencils(circles), turned)
    return SphereMesh.from_local(mesh, rows)


def squares_of_curvature(signed: FloatArray) -> SphereMesh:
    return squares(np.arcsin(np.asarray(signed, float) * np.sqrt(0.5)))


def optimal_cost(values: FloatArray, k: int) -> float:
    """Least sum of squared distances to k centres on the line, by dynamic programming."""
    x = np.sort(values)
    ones, sums, squared = (
        np.concatenate([[0.0], np.cumsum(p)]) for p in (np.ones_like(x), x, x**2)
    )
    n = len(x)
    cost = np.full((n + 1, n + 1), np.inf)
    for j in range(1, n + 1):
        i = np.arange(j)
        total = sums[j] - sums[i]
        cost[i, j] = squared[j] - squared[i] - total**2 / (ones[j] - ones[i])
    best = cost[0]
    for _ in range(k - 1):
        best = np.concatenate(
            [[np.inf], [np.min(best[:j] + cost[:j, j]) for j in range(1, n + 1)]]
        )
    return max(float(best[n]), 0.0)


@pytest.fixture(scope="module")
def optimum(nets: dict[str, Mesh]) -> dict[str, SphereMesh]:
    """Nets after the angle stage: what is clustered in practice."""
    chosen = ("torus", "egg", "vase", "roof", "catenoid")
    return {name: minimize_angles(face_planes(nets[name]))[0] for name in chosen}


@pytest.mark.parametrize("name", ["torus", "egg", "vase", "roof", "catenoid"])
@pytest.mark.parametrize("k", [1, 2, 5, 8])
def test_law_d13_clusters(optimum: dict[str, SphereMesh], name: str, k: int) -> None:
    before = optimum[name]
    after, clusters = cluster_radii(before, k)
    faces, edge = before.mesh.n_faces, mean_edge_length(before.mesh)
    # As many radii as are said, ascending; each face has that of its label, exactly.
    assert 1 <= len(clusters.radii) <= k
    assert (np.diff(clusters.radii) > 0).all()
    found = curvatures(after) * edge
    np.testing.assert_allclose(
        found, edge / clusters.radii[clusters.labels], rtol=1e-9, atol=1e-13
    )
    assert len(np.unique(np.round(found, 9))) == len(clusters.radii)
    np.testing.assert_array_equal(
        np.bincount(clusters.labels, minlength=len(clusters.radii)), clusters.counts
    )
    assert clusters.counts.min() > 0
    assert clusters.counts.sum() == faces
    # Vertices and circles stay, and so does the side to which a panel curves.
    assert vertex_error(after).max() < 1e-10 * np.abs(before.mesh.vertices).max()
    circles, _ = face_circles(before.mesh)
    radii = np.sqrt(circles.radii_squared)
    assert (clusters.radii[clusters.labels] >= radii * (1 - 1e-12)).all()
    angles, old = pencil_angles(after, circles), pencil_angles(before, circles)
    expected = np.arcsin(np.minimum(radii / clusters.radii[clusters.labels], 1))
    side = np.where(np.abs(old) < 1e-9, np.sign(angles), np.sign(old))
    np.testing.assert_allclose(angles, side * expected, atol=1e-7)


@pytest.mark.parametrize("name", ["egg", "vase", "roof"])
@pytest.mark.parametrize("k", [2, 4, 7])
def test_law_d13_k_means_is_near_the_optimum(
    optimum: dict[str, SphereMesh], name: str, k: int
) -> None:
    values = curvatures(optimum[name])
    values = values / values.max()
    after, clusters = cluster_radii(optimum[name], k)
    assert not clusters.reassigned.any()
    means = curvatures(after) / curvatures(optimum[name]).max()
    least = optimal_cost(values, k)
    cost = float(((values - means) ** 2).sum())
    assert least <= cost + 1e-11
    assert cost <= 1.02 * least + 1e-11


def test_the_exact_optimum_of_this_test() -> None:
    values = np.array([0.0, 1.0, 10.0, 11.0, 20.0])
    assert optimal_cost(values, 3) == pytest.approx(1.0)
    assert optimal_cost(values, 5) == pytest.approx(0.0, abs=1e-12)
    assert optimal_cost(values, 1) == pytest.approx(((values - 8.4) ** 2).sum())


def test_more_moulds_never_cost_more(optimum: dict[str, SphereMesh]) -> None:
    before = optimum["roof"]
    costs = [
        ((curvatures(before) - curvatures(cluster_radii(before, k)[0])) ** 2).sum()
        for k in (1, 3, 8)
    ]
    assert (np.diff(costs) < 0).all()


def test_as_many_moulds_as_curvatures_change_nothing() -> None:
    before = squares_of_curvature(np.array([0.5, -0.5, 0.2, 0.2, 0.0, -1.0]))
    for k in (4, 5, 100):
        after, clusters = cluster_radii(before, k)
        np.testing.assert_allclose(clusters.radii, [1, 2, 5, np.inf])
        assert clusters.labels.tolist() == [1, 1, 2, 2, 3, 0]
        assert clusters.counts.tolist() == [1, 2, 2, 1]
        np.testing.assert_allclose(after.local_spheres, before.local_spheres, atol=1e-12)


def test_curvatures_equal_up_to_rounding_share_a_mould() -> None:
    """Wherever in the grid of roundings the value lies."""
    for value in (0.3, 0.2500000005, 0.123456789500000, 0.7777777775):
        noise = np.array([-2e-13, 0.0, 2e-13, 1e-13])
        before = squares_of_curvature(np.concatenate([value + noise, [1.0, 0.9]]))
        _, clusters = cluster_radii(before, 3)
        assert clusters.counts.tolist() == [1, 1, 4]
        _, clusters = cluster_radii(before, 6)
        assert clusters.counts.tolist() == [1, 1, 4]


def test_curvatures_hardly_different_make_no_noise() -> None:
    values = [0.5, 0.5, 1, 1 - 2e-9, 1 - 4e-9, 1 - 6e-9]
    for k in (2, 3, 4, 5):
        _, clusters = cluster_radii(squares_of_curvature(np.array(values)), k)
        assert len(clusters.radii) <= k
        np.testing.assert_allclose(clusters.radii[-1], 2)


def test_planes_among_curved_panels_stay_planes() -> None:
    before = squares_of_curvature(np.array([0.0, 1e-17, -1e-17, 0.5, 0.52, 0.8]))
    after, clusters = cluster_radii(before, 3)
    assert clusters.radii[-1] == np.inf
    assert clusters.counts.tolist() == [1, 2, 3]
    assert (after.local_spheres[:3, 0] == 0).all()


def test_one_mould_for_all() -> None:
    before = squares_of_curvature(np.array([0.1, -0.3, 0.2]))
    after, clusters = cluster_radii(before, 1)
    np.testing.assert_allclose(clusters.radii, [5.0])
    np.testing.assert_allclose(2 * after.local_spheres[:, 0], [0.2, -0.2, 0.2], rtol=1e-12)


def test_all_planes_stay_planes(ball: Mesh) -> None:
    after, clusters = cluster_radii(face_planes(ball), 3)
    assert clusters.radii.tolist() == [np.inf]
    assert (after.spheres[:, 0] == 0).all()
    assert clusters.counts.tolist() == [ball.n_faces]
    assert (clusters.labels == 0).all()


def test_faces_larger_than_their_mould_get_a_larger_one() -> None:
    """Two small, sharply curved squares and a large flat one on the mean of all."""
    small, large = 1.0, 20.0
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    points = np.concatenate([small * square, small * square + 5, large * square + 50])
    mesh = Mesh(points, np.arange(12).reshape(3, 4))
    circles, _ = face_circles(mesh)
    rho = np.sqrt(circles.radii_squared)
    t = np.arcsin(rho * np.array([1.0, -0.9, 0.01]))
    before = SphereMesh.from_local(mesh, pencil_spheres(*circle_pencils(circles), t))
    after, clusters = cluster_radii(before, 1)
    # The only mould must carry the large square: its circle's radius at least.
    assert clusters.radii[0] >= rho[2] * (1 - 1e-12)
    assert vertex_error(after).max() < 1e-9
    after, clusters = cluster_radii(before, 2)
    assert (clusters.radii[clusters.labels] >= rho * (1 - 1e-12)).all()
    assert clusters.labels.tolist() == [0, 0, 1]
    assert vertex_error(after).max() < 1e-9


def test_reassigned_faces_are_told() -> None:
    """A large face whose curvature lies nearer to a mould on which it has no room."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    sizes = np.array([1.0, 1.0, 1.0, 1.0, 2.3, 1.0, 1.0])
    shifts = 10.0 * np.arange(7)[:, None, None] * np.array([1.0, 0, 0])
    points = (sizes[:, None, None] * square + shifts).reshape(-1, 3)
    mesh = Mesh(points, np.arange(28).reshape(7, 4))
    circles, _ = face_circles(mesh)
    rho = np.sqrt(circles.radii_squared)
    kappa = np.array([0.7, 0.7, 0.7, 0.7, 0.6, 0.1, 0.1])
    t = np.arcsin(rho * kappa)
    before = SphereMesh.from_local(mesh, pencil_spheres(*circle_pencils(circles), t))
    after, clusters = cluster_radii(before, 2)
    assert clusters.reassigned.tolist() == [False] * 4 + [True] + [False] * 2
    assert clusters.labels[4] == clusters.labels[5]
    assert vertex_error(after).max() < 1e-9


def test_results_are_reproducible(optimum: dict[str, SphereMesh]) -> None:
    first, clusters = cluster_radii(optimum["roof"], 6, seed=3)
    again, same = cluster_radii(optimum["roof"], 6, seed=3)
    np.testing.assert_array_equal(first.spheres, again.spheres)
    np.testing.assert_array_equal(clusters.labels, same.labels)
    np.testing.assert_array_equal(clusters.radii, same.radii)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_law_d13_clusters_do_not_depend_on_units(scale: float) -> None:
    def clustered(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
        _, clusters = cluster_radii(minimize_angles(face_planes(mesh))[0], 5)
        return clusters.radii, clusters.labels

    mesh = roof_net(9, 8, 30.0)
    radii, labels = clustered(mesh)
    moved = Mesh(scale * (mesh.vertices + norm(mesh.vertices).max()), mesh.faces)
    moved_radii, moved_labels = clustered(moved)
    np.testing.assert_allclose(moved_radii, scale * radii, rtol=1e-6)
    np.testing.assert_array_equal(moved_labels, labels)


@pytest.mark.parametrize("k", [0, -3])
def test_there_is_at_least_one_mould(ball: Mesh, k: int) -> None:
    with pytest.raises(InputError, match=f"at least 1, not {k}"):
        cluster_radii(face_planes(ball), k)
