"""The mesh: what it accepts, what it refuses and how it says so, and its connectivity."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import IntArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import (
    face_centroids,
    face_normals,
    face_vector_areas,
    local_corners,
    mean_edge_length,
)
from spheremesh.kernel.surfaces.circular_nets import torus_net

HOUSE = [[0, 1, 2, 3], [3, 2, 4], [0, 5, 6, 7, 1]]
"""A square, a triangle above and a pentagon below."""

HOUSE_POINTS = np.array(
    [
        [0, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [0.5, 2, 0],
        [-1, -1, 0],
        [0.5, -2, 0],
        [2, -1, 0],
    ]
)

TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def points(count: int) -> np.ndarray:
    return np.random.default_rng(1).normal(size=(count, 3))


def euler_characteristic(mesh: Mesh) -> int:
    used = len(np.unique(mesh.corners))
    n_edges = len(mesh.topology.edge_corners) + int((mesh.topology.twins < 0).sum())
    return used - n_edges + mesh.n_faces


# What it accepts


def test_faces_of_mixed_degree_round_trip() -> None:
    mesh = Mesh(HOUSE_POINTS, HOUSE)
    assert [face.tolist() for face in mesh.faces] == HOUSE
    assert mesh.degrees.tolist() == [4, 3, 5]
    assert (mesh.n_vertices, mesh.n_faces) == (8, 3)
    assert mesh.counts == {"V": 8, "F": 3, "E": len(mesh.topology.edge_faces)}
    assert mesh.offsets.tolist() == [0, 4, 7, 12]
    again = Mesh(mesh.vertices, mesh.faces)
    np.testing.assert_array_equal(again.corners, mesh.corners)
    assert mesh.corners.dtype == mesh.offsets.dtype == np.int64
    assert mesh.vertices.dtype == np.float64


@pytest.mark.parametrize(
    "faces", [np.array([[0, 1, 2], [0, 2, 3]], np.int32), [(0, 1, 2), (0, 2, 3)]]
)
def test_faces_may_be_an_array_or_sequences(faces: object) -> None:
    mesh = Mesh(HOUSE_POINTS[:4], faces)  # type: ignore[arg-type]
    assert [face.tolist() for face in mesh.faces] == [[0, 1, 2], [0, 2, 3]]


def test_arrays_are_read_only_copies() -> None:
    vertices, faces = HOUSE_POINTS.copy(), np.array([[0, 1, 2, 3]])
    mesh = Mesh(vertices, faces)
    vertices[0], faces[0] = 9, 7
    assert mesh.vertices[0].tolist() == [0, 0, 0]
    assert mesh.corners.tolist() == [0, 1, 2, 3]
    arrays = [mesh.vertices, mesh.corners, mesh.offsets, mesh.faces[0]]
    arrays += list(vars(mesh.topology).values())
    for array in arrays:
        assert not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(AttributeError):
        mesh.vertices = vertices  # type: ignore[misc]


def test_isolated_vertices_are_allowed() -> None:
    mesh = Mesh(np.concatenate([points(3), [[5.0, 5, 5]]]), [[0, 1, 2]])
    assert mesh.n_vertices == 4
    assert mesh.topology.is_boundary_vertex.tolist() == [True] * 4


# What it refuses


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_coordinates_must_be_finite(value: float) -> None:
    vertices = points(5)
    vertices[[1, 4], 2] = value
    with pytest.raises(InputError, match=r"vertices \[1, 4\] have coordinates"):
        Mesh(vertices, [[0, 1, 2], [0, 2, 3]])


@pytest.mark.parametrize("shape", [(4,), (4, 2), (1, 4, 3)])
def test_vertices_must_be_points_of_space(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match=r"shape \(V, 3\)"):
        Mesh(np.zeros(shape), [[0, 1, 2]])


@pytest.mark.parametrize("faces", [[], np.zeros((0, 3), int)])
def test_a_mesh_has_faces(faces: list[list[int]]) -> None:
    with pytest.raises(InputError, match="no faces"):
        Mesh(points(3), faces)


@pytest.mark.parametrize("bad", [-1, 4, 2**40])
def test_indices_must_be_in_range(bad: int) -> None:
    with pytest.raises(InputError, match=r"faces \[1\] refer to vertices out of range.*4"):
        Mesh(points(4), [[0, 1, 2], [2, bad, 3]])


@pytest.mark.parametrize("bad", [0.5, np.nan])
def test_indices_must_be_whole_numbers(bad: float) -> None:
    with pytest.raises(InputError, match="whole numbers"):
        Mesh(points(4), [[0, 1, 2], [2, bad, 3]])  # type: ignore[list-item]
    with pytest.raises(InputError, match="whole numbers"):
        Mesh(points(4), np.array([[0, 1, bad]]))


def test_faces_have_three_corners() -> None:
    with pytest.raises(InputError, match=r"faces \[0, 2\] have fewer than 3 corners"):
        Mesh(points(4), [[0, 1], [0, 1, 2], []])


@pytest.mark.parametrize("face", [[1, 2, 3, 1], [1, 1, 2, 3], [1, 2, 1, 3]])
def test_corners_must_differ(face: list[int]) -> None:
    with pytest.raises(InputError, match=r"faces \[1\] have a repeated corner"):
        Mesh(points(4), [[0, 1, 2], face])


def test_edges_have_two_faces_at_most() -> None:
    with pytest.raises(InputError, match=r"edge (0-1|1-0) is non-manifold.*\[0, 2, 3\]"):
        Mesh(points(6), [[0, 1, 2], [2, 1, 5], [1, 0, 3], [0, 1, 4]])


def test_neighbours_run_against_each_other() -> None:
    with pytest.raises(InputError, match=r"faces \[0, 1\] run along edge 1-2 in the same"):
        Mesh(points(4), [[0, 1, 2], [1, 2, 3]])


def test_a_moebius_strip_is_refused() -> None:
    strip = [[i, i + 1, 5 + i + 1, 5 + i] for i in range(4)] + [[4, 5, 0, 9]]
    with pytest.raises(InputError, match="non-orientable"):
        Mesh(points(10), strip)
    ring = [*strip[:4], [4, 0, 5, 9]]
    assert Mesh(points(10), ring).n_faces == 5


def shifted(faces: list[list[int]], first: int) -> list[list[int]]:
    """A copy of faces on other vertices, all but vertex 0."""
    return [[0 if i == 0 else i + first for i in face] for face in faces]


OPEN_FAN = [[0, 1, 2], [0, 2, 3]]
CLOSED_FAN = [[0, 1, 2], [0, 2, 3], [0, 3, 1]]


@pytest.mark.parametrize("first", [OPEN_FAN, CLOSED_FAN, OPEN_FAN[:1]])
@pytest.mark.parametrize("second", [OPEN_FAN, CLOSED_FAN, OPEN_FAN[:1]])
def test_vertices_have_one_fan(first: list[list[int]], second: list[list[int]]) -> None:
    faces = first + shifted(second, 3)
    ids = ", ".join(str(i) for i in range(len(faces)))
    with pytest.raises(InputError, match=rf"vertex 0 is non-manifold: faces \[{ids}\]"):
        Mesh(points(7), faces)
    Mesh(points(7), first)


@pytest.mark.parametrize("valence", [3, 7, 64, 100])
def test_fans_of_any_size_are_one_fan(valence: int) -> None:
    rim = np.arange(valence) + 1
    faces = np.stack([np.zeros(valence, int), rim, np.roll(rim, -1)], 1)
    order = np.random.default_rng(2).permutation(valence)
    closed = Mesh(points(valence + 1), faces[order])
    assert closed.topology.is_boundary_vertex.tolist() == [False] + [True] * valence
    Mesh(points(valence + 1), faces[order[order != 0]])
    with pytest.raises(InputError, match="vertex 0 is non-manifold"):
        Mesh(points(valence + 4), np.concatenate([faces, [[0, valence + 1, valence + 2]]]))


# Connectivity


@pytest.mark.parametrize(
    ("mesh", "expected"),
    [
        (Mesh(points(4), TETRAHEDRON), 2),
        (torus_net(5, 4, 2.0, 1.0), 0),
        (torus_net(3, 3, 2.0, 1.0), 0),
        (Mesh(HOUSE_POINTS, HOUSE), 1),
    ],
    ids=["tetrahedron", "torus", "smallest torus", "house"],
)
def test_euler_characteristic(mesh: Mesh, expected: int) -> None:
    assert euler_characteristic(mesh) == expected


def test_closed_meshes_have_no_boundary() -> None:
    for mesh in (Mesh(points(4), TETRAHEDRON), torus_net(3, 3, 2.0, 1.0)):
        assert (mesh.topology.twins >= 0).all()
        assert not mesh.topology.is_boundary_vertex.any()
        assert len(mesh.topology.edge_corners) * 2 == len(mesh.corners)


@given(around=st.integers(3, 7), across=st.integers(3, 6), seed=st.integers(0, 99))
def test_law_half_edges(around: int, across: int, seed: int) -> None:
    """On a torus from which faces are taken, as long as it stays a manifold."""
    faces = np.stack(torus_net(around, across, 2.0, 1.0).faces)
    keep = np.random.default_rng(seed).permutation(len(faces))[: len(faces) - 2]
    try:
        mesh = Mesh(points(around * across), faces[keep])
    except InputError as error:
        assert "vertex" in str(error)  # noqa: PT017
        return
    topology = mesh.topology
    half_edges = np.arange(len(mesh.corners))
    tails, heads = mesh.corners, mesh.corners[topology.next_corners]
    interior = topology.twins >= 0
    twins = topology.twins[interior]
    np.testing.assert_array_equal(topology.twins[twins], half_edges[interior])
    np.testing.assert_array_equal(tails[twins], heads[interior])
    np.testing.assert_array_equal(heads[twins], tails[interior])
    assert (topology.corner_faces[twins] != topology.corner_faces[interior]).all()
    np.testing.assert_array_equal(
        topology.corner_faces[topology.next_corners], topology.corner_faces
    )
    edges = topology.edge_corners
    np.testing.assert_array_equal(
        np.stack([tails[edges], heads[edges]], 1), topology.edge_vertices
    )
    opposite = topology.corner_faces[topology.twins[edges]]
    np.testing.assert_array_equal(
        np.stack([topology.corner_faces[edges], opposite], 1), topology.edge_faces
    )
    assert sorted([*edges, *topology.twins[edges]]) == half_edges[interior].tolist()
    rim = np.zeros(mesh.n_vertices, bool)
    rim[tails[~interior]] = rim[heads[~interior]] = True
    rim |= np.bincount(tails, minlength=mesh.n_vertices) == 0
    np.testing.assert_array_equal(topology.is_boundary_vertex, rim)


def test_law_connectivity_does_not_depend_on_the_numbering(
    nets: dict[str, Mesh], renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    for mesh in nets.values():
        other, new = renumber(mesh)
        expected = {tuple(sorted(pair)) for pair in new[mesh.topology.edge_faces].tolist()}
        found = {tuple(sorted(pair)) for pair in other.topology.edge_faces.tolist()}
        assert found == expected
        assert euler_characteristic(other) == euler_characteristic(mesh)
        np.testing.assert_allclose(face_centroids(other)[new], face_centroids(mesh), atol=1e-12)
        np.testing.assert_allclose(face_normals(other)[new], face_normals(mesh), atol=1e-11)


# Measures of faces


def test_areas_and_normals_of_known_faces() -> None:
    mesh = Mesh(HOUSE_POINTS, HOUSE)
    # The pentagon of the house runs counter-clockwise: 3.5 by the shoelace formula.
    np.testing.assert_allclose(face_vector_areas(mesh)[:, 2], [1, 0.5, 3.5])
    np.testing.assert_allclose(face_normals(mesh), np.tile([0, 0, 1.0], (3, 1)))
    np.testing.assert_allclose(face_centroids(mesh)[:2], [[0.5, 0.5, 0], [0.5, 4 / 3, 0]])


def test_vector_areas_of_a_closed_mesh_cancel(nets: dict[str, Mesh]) -> None:
    total = face_vector_areas(nets["torus"]).sum(0)
    np.testing.assert_allclose(total, 0, atol=1e-12)


def test_measures_keep_their_digits_far_away(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    edge = mean_edge_length(mesh)
    far = Mesh(mesh.vertices + 1e6 * edge, mesh.faces)
    # What is left is the rounding of the coordinates themselves.
    rounding = 1e-15 * 1e6 * edge
    np.testing.assert_allclose(local_corners(far), local_corners(mesh), atol=rounding)
    np.testing.assert_allclose(face_normals(far), face_normals(mesh), atol=10 * rounding / edge)
    assert mean_edge_length(far) == pytest.approx(edge, rel=1e-10)
    scaled = Mesh(1e3 * mesh.vertices, mesh.faces)
    assert mean_edge_length(scaled) == pytest.approx(1e3 * edge, rel=1e-12)


def test_corners_are_local_to_the_mean_of_their_face(nets: dict[str, Mesh]) -> None:
    for mesh in nets.values():
        sums = np.add.reduceat(local_corners(mesh), mesh.offsets[:-1])
        assert norm(sums).max() < 1e-13 * np.abs(mesh.vertices).max()
