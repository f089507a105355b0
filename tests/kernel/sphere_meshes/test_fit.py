"""Planes and least-squares spheres of faces (D5, D6)."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_normals, local_corners, mean_edge_length
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.kernel.spheres.incidence import evaluate, normals
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.rows import center_radius
from spheremesh.kernel.tolerances import CIRCULAR

POINTS = arrays(float, 3, elements=st.floats(-4, 4))
NETS = ["torus", "ellipsoid", "egg", "catenoid", "vase", "enneper", "roof"]


def rough_ball(radius: float = 1.0, roughness: float = 0.05) -> Mesh:
    """Quads whose corners lie on a sphere but on no circles."""
    rng = np.random.default_rng(4)
    n_around, n_across = 9, 5
    u, v = np.meshgrid(
        np.linspace(0.2, 2.0, n_around), np.linspace(-0.7, 0.7, n_across), indexing="ij"
    )
    u, v = (a + rng.uniform(-roughness, roughness, u.shape) for a in (u, v))
    points = radius * np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], -1)
    return Mesh(points.reshape(-1, 3), grid_faces(n_around, n_across))


def grid_faces(n_rows: int, n_columns: int) -> IntArray:
    ids = np.arange(n_rows * n_columns).reshape(n_rows, n_columns)
    corners = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return np.stack(corners, -1).reshape(-1, 4)


def rough_sheet(curvature: float = 0.0) -> Mesh:
    """Quads without circles on a paraboloid; on a plane where the curvature is 0."""
    rng = np.random.default_rng(6)
    x, y = np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij")
    x, y = x + rng.uniform(-0.2, 0.2, x.shape), y + rng.uniform(-0.2, 0.2, x.shape)
    points = np.stack([x, y, curvature * (x**2 - 0.5 * y**2)], -1)
    return Mesh(points.reshape(-1, 3), grid_faces(6, 5))


# Planes


@pytest.mark.parametrize("name", NETS)
def test_planes_carry_their_faces(nets: dict[str, Mesh], name: str) -> None:
    found = face_planes(nets[name])
    assert (found.spheres[:, 0] == 0).all()
    np.testing.assert_allclose(norm(found.spheres[:, 1:4]), 1, atol=1e-14)
    np.testing.assert_allclose(found.spheres[:, 1:4], face_normals(nets[name]), atol=1e-12)
    assert vertex_error(found).max() < 1e-12 * np.abs(nets[name].vertices).max()


def test_planes_of_warped_faces_are_mean_planes() -> None:
    mesh = rough_sheet(0.1)
    found = face_planes(mesh)
    heights = evaluate(found.local_spheres[mesh.topology.corner_faces], local_corners(mesh))
    np.testing.assert_allclose(np.add.reduceat(heights, mesh.offsets[:-1]), 0, atol=1e-13)


# Exact on spheres and planes


@pytest.mark.parametrize("ring", [0, 1, 2])
@pytest.mark.parametrize("radius", [1e-3, 1.0, 1e4])
def test_law_d6_exact_on_spheres(
    radius: float, ring: int, assert_spheres_close: Callable[..., None]
) -> None:
    found = fit_spheres(rough_ball(radius), ring)
    expected = np.array([-0.5 / radius, 0, 0, 0, radius / 2])
    assert_spheres_close(found.spheres, expected, 1e-8, radius, oriented=True)


@pytest.mark.parametrize("ring", [1, 2])
def test_law_d6_exact_on_circular_faces_of_a_sphere(
    ball: Mesh, ring: int, assert_spheres_close: Callable[..., None]
) -> None:
    expected = np.array([-0.25, 0, 0, 0, 1.0])
    assert_spheres_close(fit_spheres(ball, ring).spheres, expected, 1e-11, 2.0, oriented=True)


@pytest.mark.parametrize("ring", [0, 1, 2])
def test_law_d6_exact_on_planes(ring: int, assert_spheres_close: Callable[..., None]) -> None:
    found = fit_spheres(rough_sheet(), ring)
    assert_spheres_close(found.spheres, np.array([0, 0, 0, 1.0, 0]), 1e-9, oriented=True)


@pytest.mark.parametrize("roughness", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("radius", [1e-3, 1.0, 1e4])
def test_law_d6_a_fit_loses_no_more_digits_than_its_corners(
    radius: float, roughness: float
) -> None:
    """Four corners tell their sphere by how far they miss a common circle.

    The error is the rounding over this miss, not over its square.
    """
    mesh = rough_ball(radius, roughness)
    _, miss = face_circles(mesh)
    edge = mean_edge_length(mesh)
    is_free = miss > CIRCULAR * edge
    assert is_free.mean() > 0.8
    found = fit_spheres(mesh, ring=0).spheres - np.array([-0.5 / radius, 0, 0, 0, radius / 2])
    error = np.abs(found * [radius, 1, 1, 1, 1 / radius]).max(axis=1)
    assert (error * miss)[is_free].max() < 1e-14 * edge


@pytest.mark.parametrize("distance", [0.0, 1e3, 1e6])
def test_law_d6_exact_far_from_the_origin(distance: float) -> None:
    near = rough_ball()
    shift = np.array([distance, -distance, 0.3])
    found = fit_spheres(Mesh(near.vertices + shift, near.faces))
    # The coordinates themselves are rounded at 1e-16 of the distance, faces are 0.2 wide.
    tolerance = 1e-9 + 1e-12 * distance
    np.testing.assert_allclose(found.local_spheres[:, 0], -0.5, atol=10 * tolerance)
    assert vertex_error(found).max() < tolerance


# Covariance


@given(seed=st.integers(0, 50), factor=st.sampled_from([1e-3, 1.0, 1e3]), shift=POINTS)
def test_law_d6_fit_commutes_with_similarities(
    seed: int, factor: float, shift: FloatArray
) -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    mesh = rough_sheet(0.1)
    before = fit_spheres(mesh)
    after = fit_spheres(Mesh(factor * (mesh.vertices + shift) @ turn.T, mesh.faces))
    expected = before.local_spheres * [1 / factor, 1, 1, 1, factor]
    expected[:, 1:4] = expected[:, 1:4] @ turn.T
    units = np.array([factor, 1, 1, 1, 1 / factor])
    np.testing.assert_allclose(after.local_spheres * units, expected * units, atol=1e-9)


@pytest.mark.parametrize("name", NETS)
def test_law_d6_pencil_fit_commutes_with_similarities(
    nets: dict[str, Mesh], rotation: FloatArray, name: str
) -> None:
    mesh = nets[name]
    before, edge = fit_spheres(mesh).local_spheres, mean_edge_length(mesh)
    for factor in (1e-3, 1e3):
        after = fit_spheres(Mesh(factor * mesh.vertices @ rotation.T + 5.0, mesh.faces))
        found = after.local_spheres * [factor, 1, 1, 1, 1 / factor]
        np.testing.assert_allclose(found[:, 0] * edge, before[:, 0] * edge, atol=1e-8)
        np.testing.assert_allclose(found[:, 1:4], before[:, 1:4] @ rotation.T, atol=1e-8)


@pytest.mark.parametrize("name", NETS)
def test_law_d6_fit_does_not_depend_on_the_numbering(
    nets: dict[str, Mesh], name: str, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    mesh, new = renumber(nets[name])
    edge = mean_edge_length(mesh)
    found, expected = fit_spheres(mesh).spheres[new], fit_spheres(nets[name]).spheres
    np.testing.assert_allclose(found[:, 0] * edge, expected[:, 0] * edge, atol=1e-9)
    np.testing.assert_allclose(found[:, 1:4], expected[:, 1:4], atol=1e-9)


# What it fits


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("ring", [1, 2])
def test_circular_faces_stay_in_their_pencil(
    nets: dict[str, Mesh], name: str, ring: int
) -> None:
    found = fit_spheres(nets[name], ring)
    assert vertex_error(found).max() < 1e-11 * np.abs(nets[name].vertices).max()
    assert (dot(found.local_spheres[:, 1:4], face_normals(nets[name])) > 0).all()


def test_the_pencil_fit_is_the_best_member() -> None:
    """One square and the four around it, by a search over the pencil."""
    x, y = np.meshgrid(np.arange(4.0) - 1.5, np.arange(4.0) - 1.5, indexing="ij")
    mesh = Mesh(
        np.stack([x, y, -0.1 * (x**2 + y**2) + 0.02 * x**3], -1).reshape(-1, 3),
        grid_faces(4, 4),
    )
    circles, _ = face_circles(mesh)
    middle = 4
    ring = [1, 2, 4, 7, 8, 11, 13, 14, 5, 6, 9, 10]
    points = mesh.vertices[ring] - mesh.vertices[mesh.faces[middle]].mean(0)
    row = fit_spheres(mesh).local_spheres[middle]
    assert row[0] < 0

    def cost(t: float) -> float:
        radius = np.sqrt(circles.radii_squared[middle])
        center, n = circles.centers[middle], circles.normals[middle]
        a = np.sin(t) / (2 * radius)
        height = points @ n - n @ center
        outside = dot(points - center, points - center) - radius**2
        return float(((a * outside - np.cos(t) * height) ** 2).sum())

    t = np.arcsin(2 * row[0] * np.sqrt(circles.radii_squared[middle]))
    for step in (-1e-3, 1e-3, 0.1, -0.1, 1.0):
        assert cost(t) < cost(t + step)


@pytest.mark.parametrize("curvature", [0.02, 0.15])
def test_the_free_fit_is_the_best_unit_row(curvature: float) -> None:
    """No unit row near Pratt's has a smaller sum of squares on the face and its ring."""
    mesh = rough_sheet(curvature)
    found = fit_spheres(mesh, ring=0).local_spheres
    assert np.abs(vertex_error(fit_spheres(mesh, ring=0))).max() < 1e-8
    rows = fit_spheres(mesh).local_spheres
    assert np.abs(rows - found).max() > 1e-4
    face, rng = 5, np.random.default_rng(0)
    neighbours = mesh.topology.edge_faces[(mesh.topology.edge_faces == face).any(axis=1)]
    ids = np.unique(np.concatenate([mesh.faces[f] for f in np.unique(neighbours)]))
    points = mesh.vertices[ids] - mesh.vertices[mesh.faces[face]].mean(0)
    best = (evaluate(rows[face], points) ** 2).sum()
    for scale in (1e-3, 1e-2, 1e-1):
        for change in rng.normal(size=(40, 5)):
            other = rows[face] + scale * change
            square = minkowski(other, other)
            if square > 0:
                assert (evaluate(other, points) ** 2).sum() / square > best


@given(curvature=st.floats(0.005, 0.2), sign=st.sampled_from([-1.0, 1.0]))
def test_normals_of_spheres_are_those_of_the_faces(curvature: float, sign: float) -> None:
    mesh = rough_sheet(sign * curvature)
    rows = fit_spheres(mesh).local_spheres
    assume(np.abs(rows[:, 0]).max() < 1)
    upward = normals(rows, np.zeros_like(face_normals(mesh)))
    assert (dot(unit(upward), face_normals(mesh)) > 0.8).all()


def test_a_lone_circular_face_is_plane() -> None:
    """Nothing says how it should curve: rounding must not decide."""
    rng = np.random.default_rng(8)
    for _ in range(20):
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turns = np.sort(rng.uniform(0, 2 * np.pi, 5))
        points = np.stack([np.cos(turns), np.sin(turns), np.full(5, 3.0)], 1) @ turn.T
        found = fit_spheres(Mesh(points, [range(5)]))
        np.testing.assert_allclose(found.spheres[0, 0], 0, atol=1e-9)


def test_ring_zero_of_circular_faces_is_their_plane(nets: dict[str, Mesh]) -> None:
    for mesh in nets.values():
        rows = fit_spheres(mesh, ring=0).spheres
        np.testing.assert_allclose(rows[:, 0] * mean_edge_length(mesh), 0, atol=1e-9)


def test_faces_with_many_neighbours_see_all_of_them() -> None:
    """A cone over a polygon of 256 corners: its base fits the sphere through base and apex."""
    turns = 2 * np.pi * np.arange(256) / 256
    rim = np.stack([0.6 * np.cos(turns), 0.6 * np.sin(turns), np.full(256, -0.8)], 1)
    points = np.concatenate([rim, [[0, 0, 1.0]]])
    sides = [[i, (i + 1) % 256, 256] for i in range(256)]
    found = fit_spheres(Mesh(points, [list(range(255, -1, -1)), *sides]))
    center, square = center_radius(found.spheres[0])
    np.testing.assert_allclose(center, 0, atol=1e-9)
    np.testing.assert_allclose(square, 1, rtol=1e-9)


# Refusals


def test_rings_are_not_negative(ball: Mesh) -> None:
    with pytest.raises(InputError, match="ring must be 0 or more, not -1"):
        fit_spheres(ball, ring=-1)


@pytest.mark.parametrize("fit", [face_planes, fit_spheres])
def test_degenerate_faces_are_named(fit: Callable[[Mesh], object]) -> None:
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]]
    mesh = Mesh(points, [[0, 1, 2], [3, 4, 5]])
    with pytest.raises(InputError, match=r"faces \[1\] have zero area"):
        fit(mesh)
