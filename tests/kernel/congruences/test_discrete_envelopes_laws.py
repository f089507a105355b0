"""Laws of discrete congruences and their envelopes (C4, C7, C8; E1 for the mirror points)."""

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence
from spheremesh.kernel.congruences.discrete_envelopes import (
    contact_points,
    envelope,
    mirror_points,
    ribaucour_residuals,
)
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_centroids, mean_edge_length
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.rows import (
    center_radius,
    from_center_radius,
    from_plane,
    lift_points,
    normalize,
    recenter,
)
from spheremesh.kernel.surfaces.circular_nets import enneper_net, torus_net


def common_pairs(degree: int, count: int) -> tuple[Mesh, FloatArray, FloatArray]:
    """Separate faces with spheres and planes through two points each: mesh, rows, points."""
    rng = np.random.default_rng(degree)
    pairs = rng.normal(size=(count, 2, 3))
    middle, chord = pairs.mean(1), pairs[:, 1] - pairs[:, 0]
    first = unit(np.cross(chord, rng.normal(size=(count, 3))))
    second = np.cross(unit(chord), first)
    angles = 2 * np.pi * (np.arange(degree) + rng.uniform(0, 0.7, (count, degree))) / degree
    arms = (
        np.cos(angles)[..., None] * first[:, None] + np.sin(angles)[..., None] * second[:, None]
    )
    centers = middle[:, None] + rng.uniform(0.3, 2, (count, degree, 1)) * arms
    square = dot(centers - pairs[:, :1], centers - pairs[:, :1])
    rows = from_center_radius(centers, square)
    planes = from_plane(arms[:, 0], dot(arms[:, 0], middle))
    rows[::3, 0] = planes[::3]  # a plane through both points in every third face
    mesh = Mesh(centers.reshape(-1, 3), np.arange(count * degree).reshape(-1, degree))
    return mesh, rows.reshape(-1, 5), pairs


def cube() -> Mesh:
    """Six circular faces, three around every vertex."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    faces = [
        [0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]
    ]  # fmt: skip
    return Mesh(corners, faces)


def spheres_on(mesh: Mesh, angles: FloatArray) -> SphereMesh:
    return SphereMesh.from_local(
        mesh, pencil_spheres(*circle_pencils(face_circles(mesh)[0]), angles)
    )


def matches(found: tuple[FloatArray, FloatArray], pairs: FloatArray) -> float:
    """Largest distance between two unordered pairs of points."""
    straight = norm(found[0] - pairs[:, 0]) + norm(found[1] - pairs[:, 1])
    crossed = norm(found[1] - pairs[:, 0]) + norm(found[0] - pairs[:, 1])
    return float(np.minimum(straight, crossed).max())


# C8: spheres at the vertices, points on the faces


@pytest.mark.parametrize("degree", [3, 4, 5, 6])
def test_law_c8_both_common_points_are_found(degree: int) -> None:
    mesh, rows, pairs = common_pairs(degree, 300)
    found = envelope(mesh, rows)
    assert found.is_real.all()
    assert matches((found.points_plus, found.points_minus), pairs) < 1e-11
    assert found.residuals.max() < 1e-12
    unit_rows = normalize(rows)[mesh.corners]
    for points in (found.points_plus, found.points_minus):
        at = points[mesh.topology.corner_faces]
        assert np.abs(minkowski(unit_rows, lift_points(at))).max() < 1e-11
    # The finite centres lie in the plane that bisects the two points.
    centers, _ = center_radius(rows[mesh.corners])
    chord = unit(found.points_plus - found.points_minus)[mesh.topology.corner_faces]
    middle = ((found.points_plus + found.points_minus) / 2)[mesh.topology.corner_faces]
    sphere = rows[mesh.corners, 0] != 0
    assert np.abs(dot(centers - middle, chord))[sphere].max() < 1e-10
    assert np.abs(dot(rows[mesh.corners, 1:4], chord))[~sphere].max() < 1e-12


def test_law_c8_plus_is_nearest_or_to_the_side_of_the_normal() -> None:
    mesh, rows, _ = common_pairs(3, 300)
    near = envelope(mesh, rows)
    origins = face_centroids(mesh)
    gain = norm(near.points_minus - origins) - norm(near.points_plus - origins)
    assert (gain >= -1e-12).all()
    sphere = (rows.reshape(-1, 3, 5)[..., 0] > 0).all(1)
    corners = mesh.vertices.reshape(-1, 3, 3)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    oriented = envelope(mesh, rows, "oriented")
    chord = oriented.points_plus - oriented.points_minus
    assert (dot(chord, area)[sphere] > 0).all()
    over = envelope(mesh, -rows, "oriented")
    np.testing.assert_allclose(over.points_plus, oriented.points_minus, atol=1e-11)
    turned = Mesh(mesh.vertices, [face[::-1] for face in mesh.faces])
    back = envelope(turned, rows, "oriented")
    np.testing.assert_allclose(back.points_plus, oriented.points_minus, atol=1e-11)


@pytest.mark.parametrize("degree", [3, 4])
def test_law_c8_envelopes_commute_with_inversion_and_similarities(degree: int) -> None:
    mesh, rows, pairs = common_pairs(degree, 100)
    center = np.array([4.0, -5.0, 3.0])
    mirror = normalize(from_center_radius(center, np.array(9.0)))
    inverted = normalize(rows)
    inverted = inverted - 2 * minkowski(inverted, mirror)[:, None] * mirror
    arms = pairs - center
    expected = center + 9 * arms / dot(arms, arms)[..., None]
    found = envelope(mesh, inverted)
    assert matches((found.points_plus, found.points_minus), expected) < 1e-9
    for scale, shift in ((1000.0, 0.0), (1e-3, 0.0), (1.0, 1e4)):
        moved = Mesh(scale * mesh.vertices + shift, mesh.faces)
        scaled = normalize(rows) * np.array([1 / scale, 1, 1, 1, scale])
        found = envelope(moved, recenter(scaled, np.full(3, -shift)))
        error = matches((found.points_plus, found.points_minus), scale * pairs + shift)
        assert error / scale < (1e-6 if shift else 1e-10)


def test_law_c8_no_real_points_are_flagged() -> None:
    """Apart; all the same; through one circle; and a pair that meets, to compare with."""
    apart = from_center_radius(np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0.0]]), np.ones(3))
    same = np.tile(from_center_radius(np.zeros(3), np.array(4.0)), (3, 1))
    heights = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 2.0]])
    circle = from_center_radius(heights, 1 + heights[:, 2] ** 2)
    meet = from_center_radius(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.ones(3))
    rows = np.concatenate([apart, same, circle, meet])
    points = np.random.default_rng(0).normal(size=(12, 3))
    found = envelope(Mesh(points, np.arange(12).reshape(4, 3)), rows)
    assert found.is_real.tolist() == [False, False, False, True]
    for values in (found.points_plus, found.points_minus, found.residuals):
        assert np.isnan(values[:3]).all()
        assert np.isfinite(values[3]).all()


def test_law_c8_planes_meet_in_a_point_and_at_infinity() -> None:
    rng = np.random.default_rng(6)
    point = rng.normal(size=3)
    directions = unit(rng.normal(size=(3, 3)))
    mesh = Mesh(point + rng.normal(size=(3, 3)), [[0, 1, 2]])
    found = envelope(mesh, from_plane(directions, directions @ point))
    np.testing.assert_allclose(found.points_plus, point[None], atol=1e-13)
    assert np.isinf(found.points_minus).all()
    assert found.is_real.all()
    assert found.residuals.max() < 1e-13


def test_law_c8_the_surface_is_one_envelope_of_its_tangent_spheres() -> None:
    """Centres at a tube radius of 1.8: the other envelope is the tube of radius 2.6."""
    errors = []
    for n in (16, 32, 64):
        mesh = torus_net(2 * n, n, 3.0, 1.0)
        found = envelope(mesh, sphere_congruence(mesh, "tangent", 0.8)[0])
        assert found.is_real.all()
        near, far = (
            np.hypot(norm(points[:, :2]) - 3, points[:, 2])
            for points in (found.points_plus, found.points_minus)
        )
        errors.append(max(np.abs(near - 1).max(), np.abs(far - 2.6).max()))
    assert errors[2] < 0.02
    assert errors[0] > 3.5 * errors[1] > 3.5**2 * errors[2]


def test_law_c8_residuals_tell_that_four_spheres_have_no_common_points() -> None:
    mesh, rows, _ = common_pairs(4, 50)
    blown = rows.copy()
    blown[1::4, 4] -= 0.05  # a larger second sphere in every face
    found = envelope(mesh, blown)
    assert found.is_real.all()
    assert found.residuals.min() > 1e-7
    assert 1e-3 < np.median(found.residuals) < 1e-2


@pytest.mark.parametrize("square", [0.0, -1.0])
def test_imaginary_spheres_are_named(square: float) -> None:
    mesh, rows, _ = common_pairs(3, 4)
    rows[[4, 7]] = from_center_radius(mesh.vertices[[4, 7]], np.full(2, square))
    with pytest.raises(InputError, match=r"vertices \[4, 7\] are imaginary or points"):
        envelope(mesh, rows)


def test_bad_rows_are_named() -> None:
    mesh, rows, _ = common_pairs(3, 4)
    with pytest.raises(InputError, match=r"shape \(12, 5\)"):
        envelope(mesh, rows[:5])
    rows[2, 1] = np.nan
    with pytest.raises(InputError, match=r"vertices \[2\] are not finite"):
        envelope(mesh, rows)
    with pytest.raises(InputError, match="order must be"):
        envelope(mesh, rows, "farthest")  # type: ignore[arg-type]


# C8 and E1: spheres on the faces, mirror points of the vertices


def test_law_c8_mirror_points_mirror_in_the_plane_of_the_centers() -> None:
    mesh = cube()
    sphere_mesh = spheres_on(mesh, np.random.default_rng(1).uniform(0.2, 1, 6))
    centers, _ = center_radius(sphere_mesh.spheres)
    mirrored = mirror_points(sphere_mesh)
    assert mirrored.is_valid.all()
    assert mirrored.residuals.max() < 1e-14
    for vertex, point in enumerate(mesh.vertices):
        around = centers[mesh.topology.corner_faces[mesh.corners == vertex]]
        normal = unit(np.cross(around[1] - around[0], around[2] - around[0]))
        expected = point - 2 * dot(point - around[0], normal) * normal
        np.testing.assert_allclose(mirrored.points[vertex], expected, atol=1e-12)


def test_law_c8_mirror_points_with_planes_among_the_spheres() -> None:
    mesh = cube()
    angles = np.random.default_rng(1).uniform(0.2, 1, 6)
    angles[0] = 0  # the face at x = -1
    sphere_mesh = spheres_on(mesh, angles)
    assert sphere_mesh.spheres[0, 0] == 0
    centers, _ = center_radius(sphere_mesh.spheres)
    mirrored = mirror_points(sphere_mesh)
    assert mirrored.residuals.max() < 1e-14
    for vertex in range(4):
        faces = mesh.topology.corner_faces[mesh.corners == vertex]
        first, second = centers[faces[faces != 0]]
        normal = unit(np.cross(second - first, [1.0, 0, 0]))
        point = mesh.vertices[vertex]
        expected = point - 2 * dot(point - first, normal) * normal
        np.testing.assert_allclose(mirrored.points[vertex], expected, atol=1e-12)
    flat = mirror_points(face_planes(mesh))
    assert np.isinf(flat.points).all()
    assert not flat.is_valid.any()


def test_law_c8_mirror_points_and_envelope_are_one() -> None:
    """The envelope of the dual congruence: a vertex and its mirror point."""
    mesh = cube()
    sphere_mesh = spheres_on(mesh, np.random.default_rng(2).uniform(0.2, 1, 6))
    faces = [mesh.topology.corner_faces[mesh.corners == vertex] for vertex in range(8)]
    corners = np.concatenate(faces)
    dual = Mesh(face_centroids(mesh)[corners], np.arange(24).reshape(8, 3))
    found = envelope(dual, sphere_mesh.spheres[corners])
    pairs = np.stack([mesh.vertices, mirror_points(sphere_mesh).points], 1)
    assert matches((found.points_plus, found.points_minus), pairs) < 1e-12


def test_law_c8_where_there_is_no_mirror_point(nets: dict[str, Mesh], ball: Mesh) -> None:
    mirrored = mirror_points(fit_spheres(nets["roof"]))
    boundary = nets["roof"].topology.is_boundary_vertex
    assert np.isnan(mirrored.points[boundary]).all()
    assert np.isnan(mirrored.residuals[boundary]).all()
    assert not mirrored.is_valid[boundary].any()
    # Around a vertex of the ball all spheres are one: no second point is singled out.
    assert not mirror_points(fit_spheres(ball)).is_valid.any()


def test_law_e1_mirror_points_fit_if_and_only_if_the_centers_are_coplanar() -> None:
    mesh = torus_net(24, 12, 3.0, 1.0)
    symmetric = mirror_points(fit_spheres(mesh))
    assert symmetric.residuals.max() < 1e-12
    angles = np.random.default_rng(3).uniform(0.1, 0.3, mesh.n_faces)
    sphere_mesh = spheres_on(mesh, angles)
    mirrored = mirror_points(sphere_mesh)
    centers, _ = center_radius(sphere_mesh.spheres)
    off_plane = np.empty(mesh.n_vertices)
    for vertex in range(mesh.n_vertices):
        around = centers[mesh.topology.corner_faces[mesh.corners == vertex]]
        off_plane[vertex] = np.linalg.svd(around - around.mean(0), compute_uv=False)[2]
    assert np.median(off_plane) > 1e-3
    assert np.median(mirrored.residuals) > 1e-3


# C4


def ribaucour_patch(mesh: Mesh, seed: int) -> SphereMesh:
    """Spheres on a 3x3 circular net so that those around each inner vertex share two points.

    The first mirror point is free, the next two lie on the circles through it and an edge;
    the fourth is where the spheres around its vertex meet again.
    """
    rng = np.random.default_rng(seed)
    circles = face_circles(mesh)[0]
    planes, great = (recenter(rows, -face_centroids(mesh)) for rows in circle_pencils(circles))
    middle = mesh.faces[4]

    def through(face: int, point: FloatArray) -> FloatArray:
        return (
            evaluate(great[face], point) * planes[face]
            - evaluate(planes[face], point) * (great[face])
        )

    def beside(a: int, b: int) -> int:
        """The face on the other side of an edge of the middle one."""
        pair = {int(middle[a]), int(middle[b])}
        return next(
            f for f, face in enumerate(mesh.faces) if f != 4 and pair <= set(face.tolist())
        )

    def behind(a: int) -> int:
        """The face that touches the middle one in a vertex only."""
        near = {f for f, face in enumerate(mesh.faces) if middle[a] in face}
        return (near - {4} - {beside(a, (a + 1) % 4), beside(a, (a - 1) % 4)}).pop()

    corners = mesh.vertices[middle]
    size = mean_edge_length(mesh)
    start = corners.mean(0) + size * rng.normal(size=3)
    rows = np.zeros((9, 5))
    rows[4], rows[behind(0)] = through(4, start), through(behind(0), start)
    seconds = {}
    for i in (1, 3):
        rows[beside(0, i)] = through(beside(0, i), start)
        seconds[i] = on_circle(corners[0], corners[i], start, rng.uniform(0.3, 2))
        rows[beside(i, 2)] = through(beside(i, 2), seconds[i])
        rows[behind(i)] = through(behind(i), seconds[i])
    around = [4, beside(1, 2), beside(3, 2)]
    pair = envelope(Mesh(corners[:3], [[0, 1, 2]]), rows[around])
    both = np.concatenate([pair.points_plus, pair.points_minus])
    fourth = both[np.argmax(norm(both - corners[2]))]
    rows[behind(2)] = through(behind(2), fourth)
    return SphereMesh(mesh, rows)


def on_circle(a: FloatArray, b: FloatArray, c: FloatArray, share: float) -> FloatArray:
    """A point of the circle through three, by inversion at the first: a line."""
    second, third = ((p - a) / dot(p - a, p - a) for p in (b, c))
    image = third + share * (second - third)
    return a + image / dot(image, image)


@pytest.mark.parametrize("seed", range(8))
def test_law_c4_miquel_one_circular_net_makes_the_other_circular(seed: int) -> None:
    sphere_mesh = ribaucour_patch(enneper_net(3, 0.8), seed)
    assert vertex_error(sphere_mesh).max() < 1e-12
    mirrored = mirror_points(sphere_mesh)
    assert mirrored.is_valid.sum() == 4
    assert np.nanmax(mirrored.residuals) < 1e-12
    plus, minus = ribaucour_residuals(sphere_mesh)
    assert plus.max() < 1e-14
    assert np.isfinite(minus).tolist() == [False] * 4 + [True] + [False] * 4
    assert minus[4] < 1e-12


def test_law_c4_nets_that_are_not_circular_are_told() -> None:
    mesh = cube()
    sphere_mesh = spheres_on(mesh, np.linspace(0.3, 1, 6))
    plus, minus = ribaucour_residuals(sphere_mesh)
    # Around each vertex of a cube are three spheres: a Q-congruence, so Ribaucour.
    assert max(plus.max(), minus.max()) < 1e-14
    bent = Mesh(mesh.vertices + 0.1 * np.random.default_rng(0).normal(size=(8, 3)), mesh.faces)
    plus, minus = ribaucour_residuals(SphereMesh(bent, sphere_mesh.spheres))
    assert plus.min() > 1e-3
    assert minus.min() > 1e-3


def test_law_c4_triangles_are_always_circular(octahedron: Mesh) -> None:
    plus, _ = ribaucour_residuals(face_planes(octahedron))
    assert plus.tolist() == [0.0] * 8


# C7


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_law_c7_contact_points_lie_on_all_spheres(scale: float) -> None:
    net = torus_net(24, 12, 3.0 * scale, 1.0 * scale)
    sphere_mesh = fit_spheres(net)
    edge = mean_edge_length(net)
    noise = 0.05 * edge * np.random.default_rng(4).normal(size=net.vertices.shape)
    shaken = SphereMesh(Mesh(net.vertices + noise, net.faces), sphere_mesh.spheres)
    assert vertex_error(shaken).max() > 1e-2 * edge
    points, residuals = contact_points(shaken)
    assert residuals.max() < 1e-13 * edge
    assert norm(points - net.vertices).max() < 1e-10 * edge
    rows = sphere_mesh.spheres[net.topology.corner_faces]
    products = minkowski(rows, lift_points(points[net.corners]))
    assert np.abs(products).max() < 1e-12 * scale


def test_law_c7_vertices_on_few_spheres_move_no_farther_than_they_must(
    nets: dict[str, Mesh],
) -> None:
    net = nets["egg"]
    sphere_mesh = fit_spheres(net)
    edge = mean_edge_length(net)
    noise = 0.02 * edge * np.random.default_rng(4).normal(size=net.vertices.shape)
    start = Mesh(net.vertices + noise, net.faces)
    points, residuals = contact_points(SphereMesh(start, sphere_mesh.spheres))
    boundary = net.topology.is_boundary_vertex
    assert residuals.max() < 1e-12 * edge
    assert (norm(points - start.vertices)[boundary] <= norm(noise)[boundary] * 1.01).all()


def test_law_c7_spheres_without_a_common_point_have_a_residual() -> None:
    """Four planes of a pyramid, moved in and out in turn: the apex is best by symmetry."""
    ring = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]])
    mesh = Mesh(np.vstack([ring, [[0, 0, 1.0]]]), [[i, (i + 1) % 4, 4] for i in range(4)])
    rows = face_planes(mesh).spheres.copy()
    rows[:, 4] += 0.1 * np.array([1, -1, 1, -1])
    points, residuals = contact_points(SphereMesh(mesh, rows))
    np.testing.assert_allclose(points[4], [0, 0, 1], atol=1e-14)
    np.testing.assert_allclose(residuals[4], 0.1, atol=1e-14)
    np.testing.assert_allclose(residuals[:4], 0, atol=1e-14)
