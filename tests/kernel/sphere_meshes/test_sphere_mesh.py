"""The sphere mesh: rows that keep their digits, and what is measured on it."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import (
    face_centroids,
    face_normals,
    local_corners,
    mean_edge_length,
)
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.rows import recenter

NETS = ["torus", "ellipsoid", "egg", "catenoid", "vase", "enneper", "roof"]


def curved(mesh: Mesh) -> SphereMesh:
    """Any spheres that hold their vertices, of both signs of curvature on most nets."""
    return fit_spheres(mesh)


def edge_keys(mesh: Mesh, new: IntArray) -> list[tuple[int, int]]:
    """Faces of the interior edges under a renumbering."""
    return [(min(a, b), max(a, b)) for a, b in new[mesh.topology.edge_faces].tolist()]


def ball_row(radius: float) -> FloatArray:
    """Sphere about the origin, N outwards."""
    return np.array([-0.5 / radius, 0, 0, 0, radius / 2])


# Construction


def test_rows_are_unit_read_only_and_oriented(ball: Mesh) -> None:
    rows = np.tile(7.0 * ball_row(2.0), (ball.n_faces, 1))
    found = SphereMesh(ball, rows)
    np.testing.assert_allclose(minkowski(found.spheres, found.spheres), 1, atol=1e-12)
    np.testing.assert_allclose(found.spheres, rows / 7, atol=1e-12)
    local = found.local_spheres
    np.testing.assert_allclose(local, recenter(rows / 7, face_centroids(ball)), atol=1e-12)
    for array in (found.spheres, local):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    rows[0] = 0
    assert found.spheres[0, 0] != 0


@pytest.mark.parametrize("name", NETS)
def test_model_rows_and_local_rows_make_the_same(
    nets: dict[str, Mesh], name: str, assert_spheres_close: Callable[..., None]
) -> None:
    first = curved(nets[name])
    again = SphereMesh(first.mesh, first.spheres)
    edge = mean_edge_length(first.mesh)
    assert_spheres_close(again.local_spheres, first.local_spheres, 1e-11, edge, oriented=True)
    third = SphereMesh.from_local(first.mesh, 3 * first.local_spheres)
    assert_spheres_close(third.local_spheres, first.local_spheres, 1e-14, edge, oriented=True)


@pytest.mark.parametrize("name", ["torus", "roof"])
def test_far_models_keep_their_spheres(
    nets: dict[str, Mesh], name: str, assert_spheres_close: Callable[..., None]
) -> None:
    """A million edges away the model row has lost digits that its face gives back."""
    near = curved(nets[name])
    edge = mean_edge_length(near.mesh)
    shift = 1e6 * edge * np.array([1.0, -0.7, 0.2])
    mesh = Mesh(near.mesh.vertices + shift, near.mesh.faces)
    local = SphereMesh.from_local(mesh, near.local_spheres)
    assert vertex_error(local).max() < 1e-8 * edge
    model = SphereMesh(mesh, recenter(near.spheres, -shift))
    # Rounding of the coordinates, 1e-10 of an edge, and of B at the far end of a radius.
    assert_spheres_close(model.local_spheres, near.local_spheres, 1e-8, edge, oriented=True)
    assert vertex_error(model).max() < 1e-8 * edge
    again = SphereMesh(mesh, local.spheres)
    assert_spheres_close(again.local_spheres, near.local_spheres, 1e-8, edge, oriented=True)


def test_spheres_off_their_vertices_stay_off(ball: Mesh) -> None:
    """The digits taken from the face are those that rounding lost, no more."""
    rows = np.tile(ball_row(2.25), (ball.n_faces, 1))
    error = vertex_error(SphereMesh(ball, rows))
    np.testing.assert_allclose(error, 0.25, atol=1e-12)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ([np.nan, 0, 0, 1, 0], r"\[3\] are not finite"),
        ([0, 0, 0, 1, np.inf], r"\[3\] are not finite"),
        ([1, 0, 0, 0, 1], r"\[3\] are imaginary or points"),
        ([0, 0, 0, 0, 0], r"\[3\] are imaginary or points"),
    ],
)
def test_unusable_rows_are_refused(ball: Mesh, row: list[float], message: str) -> None:
    rows = np.tile(ball_row(2.0), (ball.n_faces, 1))
    rows[3] = row
    for make in (SphereMesh, SphereMesh.from_local):
        with pytest.raises(InputError, match=message):
            make(ball, rows)


@pytest.mark.parametrize("shape", [(127, 5), (128, 4), (128,)])
def test_rows_match_the_faces(ball: Mesh, shape: tuple[int, ...]) -> None:
    for make in (SphereMesh, SphereMesh.from_local):
        with pytest.raises(InputError, match=r"spheres must have shape \(128, 5\)"):
            make(ball, np.ones(shape))


# Measures


def test_vertex_error_is_the_largest_distance(ball: Mesh) -> None:
    rows = np.tile(ball_row(2.0), (ball.n_faces, 1))
    rows[5] = ball_row(1.9)
    rows[6] = ball_row(2.05)
    error = vertex_error(SphereMesh(ball, rows))
    expected = np.zeros(ball.n_vertices)
    expected[ball.faces[6]] = 0.05
    expected[ball.faces[5]] = 0.1
    np.testing.assert_allclose(error, expected, atol=1e-12)


def test_vertex_error_of_unused_vertices_is_zero() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
    error = vertex_error(SphereMesh(mesh, [[0, 0, 0, 1, 0.5]]))
    np.testing.assert_allclose(error, [0.5, 0.5, 0.5, 0])


def test_angles_of_planes_are_dihedral_deviations(nets: dict[str, Mesh]) -> None:
    for mesh in nets.values():
        normals = face_normals(mesh)[mesh.topology.edge_faces]
        cosine = (normals[:, 0] * normals[:, 1]).sum(-1)
        np.testing.assert_allclose(
            np.cos(intersection_angles(face_planes(mesh))), cosine, atol=1e-12
        )


def test_angles_on_one_sphere_are_zero(ball: Mesh) -> None:
    rows = np.tile(ball_row(2.0), (ball.n_faces, 1))
    angles = intersection_angles(SphereMesh(ball, rows))
    # Rounding enters below a square root.
    assert angles.max() < 1e-7
    rows[3] *= -1
    spikes = (ball.topology.edge_faces == 3).any(axis=1)
    angles = intersection_angles(
        SphereMesh.from_local(ball, recenter(rows, face_centroids(ball)))
    )
    np.testing.assert_allclose(angles[spikes], np.pi, atol=1e-6)
    assert angles[~spikes].max() < 1e-7


def test_angles_agree_with_normals_at_both_ends_of_an_edge(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    found = curved(mesh)
    corners, topology = local_corners(mesh), mesh.topology
    left = topology.edge_corners
    for first in (left, topology.next_corners[left]):
        twin = topology.twins[left]
        second = topology.next_corners[twin] if first is left else twin
        rows = [found.local_spheres[topology.corner_faces[c]] for c in (first, second)]
        for row, corner in zip(rows, (first, second), strict=True):
            np.testing.assert_allclose(evaluate(row, corners[corner]), 0, atol=1e-11)
        n, m = (
            row[:, 1:4] - 2 * row[:, :1] * corners[corner]
            for row, corner in zip(rows, (first, second), strict=True)
        )
        expected = 2 * np.arctan2(norm(n - m), norm(n + m))
        np.testing.assert_allclose(intersection_angles(found), expected, atol=1e-7)


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_law_angles_are_invariant_under_similarities(
    nets: dict[str, Mesh], rotation: FloatArray, name: str, scale: float
) -> None:
    before = curved(nets[name])
    mesh = Mesh(scale * before.mesh.vertices @ rotation.T, before.mesh.faces)
    rows = before.local_spheres * [1 / scale, 1, 1, 1, scale]
    rows[:, 1:4] = rows[:, 1:4] @ rotation.T
    after = SphereMesh.from_local(mesh, rows)
    angles = np.degrees(intersection_angles(after))
    expected = np.degrees(intersection_angles(before))
    # Angles near zero are square roots of what is rounded: compare the squares there.
    np.testing.assert_allclose(angles, expected, atol=1e-4)
    assert angles.mean() == pytest.approx(expected.mean(), abs=1e-6)
    error = vertex_error(after).max()
    assert error < 1e-10 * scale * mean_edge_length(before.mesh)


@pytest.mark.parametrize("name", NETS)
def test_law_angles_survive_a_far_site(nets: dict[str, Mesh], name: str) -> None:
    before = curved(nets[name])
    shift = 1e6 * mean_edge_length(before.mesh) * np.array([0.8, 0.5, -0.3])
    mesh = Mesh(before.mesh.vertices + shift, before.mesh.faces)
    expected = np.degrees(intersection_angles(before)).mean()
    for after in (
        SphereMesh(mesh, recenter(before.spheres, -shift)),
        SphereMesh.from_local(mesh, before.local_spheres),
    ):
        found = np.degrees(intersection_angles(after)).mean()
        assert found == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("name", NETS)
def test_law_angles_do_not_depend_on_the_numbering(
    nets: dict[str, Mesh], name: str, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    before = curved(nets[name])
    mesh, new = renumber(before.mesh)
    rows = np.empty_like(before.spheres)
    rows[new] = before.spheres
    after = SphereMesh(mesh, rows)
    identity = np.arange(mesh.n_faces)
    expected = dict(zip(edge_keys(before.mesh, new), intersection_angles(before), strict=True))
    found = dict(zip(edge_keys(mesh, identity), intersection_angles(after), strict=True))
    assert found.keys() == expected.keys()
    difference = [np.degrees(abs(found[key] - expected[key])) for key in expected]
    assert max(difference) < 1e-5
    assert np.mean(difference) < 1e-6
