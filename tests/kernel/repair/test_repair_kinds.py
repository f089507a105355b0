"""Every kind of fault alone: what is done, and what is said of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_vector_areas
from spheremesh.kernel.repair.pipeline import RepairReport, repair, repair_counts, repair_words
from spheremesh.kernel.repair.raw_mesh import raw_from_faces, raw_from_mesh
from spheremesh.kernel.repair.welding import number_spacing, weld_tolerance

Faces = list[list[int]]
GRID = [[x, y, 0.1 * x * y] for x in range(4) for y in range(4)]
QUADS = [
    [4 * i + j, 4 * i + j + 4, 4 * i + j + 5, 4 * i + j + 1] for i in range(3) for j in range(3)
]


def repaired(points: object, faces: Faces) -> tuple[Mesh, RepairReport, set[str]]:
    mesh, report = repair(raw_from_faces(points, faces))  # type: ignore[arg-type]
    return mesh, report, set(repair_counts(report))


def faces_of(mesh: Mesh) -> Faces:
    return [face.tolist() for face in mesh.faces]


# Welding


def test_every_face_on_vertices_of_its_own_is_welded() -> None:
    mesh = Mesh(GRID, QUADS)
    soup = mesh.vertices[mesh.corners]
    welded, report, kinds = repaired(soup, np.arange(36).reshape(9, 4).tolist())
    assert (welded.n_vertices, kinds) == (16, {"welded_vertices"})
    assert np.array_equal(welded.vertices[welded.corners], soup)
    assert all(len(group) > 1 for group in report.welded_vertices)


def written(points: FloatArray, digits: int) -> FloatArray:
    """Points as they are read from a file with this number of significant digits."""
    return np.array([[float(f"{x:.{digits}g}") for x in point] for point in points])


@pytest.mark.parametrize("digits", [5, 6, 7, 9, 12])
@pytest.mark.parametrize("size", [1.0, 1e5])
def test_the_tolerance_follows_from_the_digits(digits: int, size: float) -> None:
    rng = np.random.default_rng(digits)
    mesh = Mesh(np.array(GRID) * size + rng.uniform(0, size, (16, 3)) / 10, QUADS)
    step = 10.0 ** (np.floor(np.log10(mesh.vertices.max())) + 1 - digits)
    soup = mesh.vertices[mesh.corners] + rng.uniform(-0.4, 0.4, (36, 3)) * step
    points = written(soup, digits)
    assert number_spacing(points) == pytest.approx(step)
    welded, report = repair(raw_from_faces(points, np.arange(36).reshape(9, 4)))
    assert welded.n_vertices == 16
    assert report.tolerance <= 1e-3 * 1.3 * size


def test_numbers_of_float32_are_known_as_such() -> None:
    points = np.random.default_rng(0).uniform(1, 2, (9, 3)).astype(np.float32)
    assert number_spacing(points.astype(float)) == pytest.approx(2.0**-23 * points.max())
    assert number_spacing(np.pi * np.ones((1, 3))) == pytest.approx(2.0**-52 * np.pi)
    assert number_spacing(np.zeros((2, 3))) == 0


def test_numbers_by_hand_do_not_weld_what_is_apart() -> None:
    raw = raw_from_faces([[0, 0, 0], [9, 0, 0], [9, 8, 0], [0, 8, 0]], [[0, 1, 2, 3]])
    assert weld_tolerance(raw) <= 0.01


def test_a_tolerance_that_is_given_holds() -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1.05, 0, 0], [2, 0, 0], [2, 1, 0]]
    raw = raw_from_faces(points, [[0, 1, 2, 3], [4, 5, 6, 2]])
    assert repair(raw, 0.01)[0].n_vertices == 8  # vertex 2 alone joins no faces
    mesh, report = repair(raw, 0.1)
    assert (mesh.n_vertices, report.tolerance) == (6, 0.1)
    assert report.welded_vertices == [[1, 4]]
    assert mesh.vertices[1].tolist() == [1, 0, 0]


# Faces


def test_repeated_faces_go_in_either_direction_and_from_any_corner() -> None:
    faces = [*QUADS, QUADS[4][1:] + QUADS[4][:1], QUADS[2][::-1]]
    mesh, report, kinds = repaired(GRID, faces)
    assert faces_of(mesh) == QUADS
    assert kinds == {"duplicate_faces"}
    assert report.duplicate_faces == [[9, 4], [10, 2]]
    assert report.face_ids == list(range(9))


def test_the_same_corners_in_another_order_are_another_face() -> None:
    mesh, _, _ = repaired(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], [[0, 1, 2, 3], [0, 2, 1]]
    )
    assert mesh.n_faces == 2


@pytest.mark.parametrize(
    "sliver", [[0, 0, 1], [0, 1, 16], [4, 8, 17], [0, 4, 8], [0, 4, 0, 4], [5, 5, 5]]
)
def test_slivers_go(sliver: list[int]) -> None:
    points = [*GRID, GRID[1], [1.4, 0, 0]]
    mesh, report, kinds = repaired(points, [*QUADS, sliver])
    assert faces_of(mesh) == QUADS
    assert report.sliver_faces == [9]
    assert kinds <= {"sliver_faces", "unused_vertices", "shortened_faces", "welded_vertices"}


def test_unusable_faces_and_unused_vertices_go() -> None:
    points = [*GRID, [9, 9, 9], [np.nan, 0, 0]]
    faces = [[0, 1], [], *QUADS, [0, 1, 99], [1, 2, -1], [0, 1, 17]]
    mesh, report, kinds = repaired(points, faces)
    assert faces_of(mesh) == QUADS
    assert report.unusable_faces == [0, 1, 11, 12, 13]
    assert report.unused_vertices == [16, 17]
    assert kinds == {"unusable_faces", "unused_vertices"}
    assert report.face_ids == list(range(2, 11))


@pytest.mark.parametrize("faces", [[], [[0, 1]], [[0, 1, 1]], [[0, 4, 8]], [[7, 8, 99]]])
def test_no_face_left_is_an_error(faces: Faces) -> None:
    with pytest.raises(InputError, match="no face is left"):
        repaired(GRID, faces)


def test_coinciding_corners_become_one() -> None:
    pole = [[0, 0, 1], [0, 0, 1], [0, 0, 1]]
    rim = [[np.cos(t), np.sin(t), 0] for t in np.arange(3) * 2 * np.pi / 3]
    faces = [[i, (i + 1) % 3, 3 + (i + 1) % 3, 3 + i][::-1] for i in range(3)]
    mesh, report, _ = repaired(pole + rim, faces)
    assert mesh.degrees.tolist() == [3, 3, 3]
    assert report.shortened_faces == [0, 1, 2]


def test_a_way_to_a_vertex_and_back_goes() -> None:
    mesh, _, kinds = repaired(GRID, [[0, 4, 15, 4, 5, 1]])
    assert faces_of(mesh) == [[0, 3 - 2, 2, 1]] or mesh.degrees.tolist() == [4]
    assert kinds == {"shortened_faces", "unused_vertices"}


# Holes


def holed(rng: np.random.Generator, n_holes: int) -> tuple[FloatArray, list[int], float]:
    """A star-shaped face with holes, each with a bridge to the rim; and its area."""
    per = 8 // max(n_holes, 1) + int(rng.integers(1, 4))
    angles = 2 * np.pi * np.arange(per * max(n_holes, 1)) / (per * max(n_holes, 1))
    radii = rng.uniform(2.0, 3.0, len(angles))
    rim = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], 1)
    points, ring = rim.tolist(), []
    area = polygon_area(rim)
    for i in range(len(angles)):
        ring.append(i)
        if n_holes and i % per == 0:
            out = np.array([np.cos(angles[i]), np.sin(angles[i])])
            corners = 2 * np.pi * np.arange(k := int(rng.integers(3, 7))) / k
            turned = np.cos(corners)[:, None] * out + np.sin(corners)[:, None] * [
                out[1],
                -out[0],
            ]
            size = 0.5 * np.sin(np.pi / max(n_holes, 2))
            hole = 0.9 * out + size * turned
            first = len(points)
            points += hole.tolist()
            ring += [*range(first, first + k), first, i]
            area -= abs(polygon_area(hole))
    return np.array(points), ring, area


def polygon_area(points: FloatArray) -> float:
    x, y = points.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


@given(st.integers(0, 2**32 - 1), st.integers(1, 6))
def test_faces_with_holes_are_cut_into_triangles(seed: int, n_holes: int) -> None:
    rng = np.random.default_rng(seed)
    flat, ring, area = holed(rng, n_holes)
    tilt = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    mesh, report, kinds = repaired(flat @ tilt[:, :2].T, [ring])
    assert kinds == {"triangulated_faces"}
    assert report.triangulated_faces == [0]
    assert set(mesh.degrees.tolist()) == {3}
    areas = face_vector_areas(mesh)
    lengths = np.linalg.norm(areas, axis=1)
    assert lengths.sum() == pytest.approx(area)
    assert np.linalg.norm(areas.sum(axis=0)) == pytest.approx(area)
    euler = (
        mesh.n_vertices - mesh.n_faces - (len(mesh.corners) - len(mesh.topology.edge_corners))
    )
    assert euler + 2 * mesh.n_faces == 1 - n_holes


def test_a_face_that_pinches_at_a_vertex_is_cut_there() -> None:
    points = [[0, 0, 0], [2, -1, 0], [2, 1, 0], [-2, 1, 0], [-2, -1, 0]]
    mesh, report, _ = repaired(points, [[0, 1, 2, 0, 3, 4]])
    assert sorted(map(sorted, faces_of(mesh)))[0][0] == 0
    assert mesh.n_faces == 2
    assert report.triangulated_faces == [0]


def test_a_face_that_crosses_itself_is_named() -> None:
    points = [[0, 0, 0], [2, 2, 0], [2, 0, 0], [0, 2, 0], [3, 1, 0], [5, 7, 0]]
    with pytest.raises(InputError, match=r"boundary of face 1 crosses itself"):
        repaired([*points, [9, 9, 0]], [[0, 6, 3], [0, 1, 2, 3, 1, 4, 5, 2, 4]])


# T-junctions


def test_vertices_on_an_edge_become_corners_in_their_order() -> None:
    points = [[0, 0, 0], [3, 0, 0], [3, 1, 0], [0, 1, 0], [1, 0, 0], [2, 0, 0],
              [0, -1, 0], [1, -1, 0], [2, -1, 0], [3, -1, 0]]  # fmt: skip
    faces = [[0, 1, 2, 3], [6, 7, 4, 0], [7, 8, 5, 4], [8, 9, 1, 5]]
    mesh, report, kinds = repaired(points, faces)
    assert faces_of(mesh)[0] == [0, 4, 5, 1, 2, 3]
    assert kinds == {"t_junctions"}
    assert report.t_junctions == [[0, 4], [0, 5]]


def test_a_sliver_that_fills_a_t_junction_goes_and_the_junction_is_split() -> None:
    points = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [1, 0, 0], [0, -1, 0], [2, -1, 0]]
    mesh, report, _ = repaired(points, [[0, 1, 2, 3], [1, 0, 4], [0, 5, 4], [4, 5, 6, 1]])
    assert faces_of(mesh) == [[0, 4, 1, 2, 3], [0, 5, 4], [4, 5, 6, 1]]
    assert (report.sliver_faces, report.t_junctions) == ([1], [[0, 4]])


# Normals


def test_of_every_piece_the_fewer_are_turned_over() -> None:
    far = np.add(GRID, [0, 0, 9]).tolist()
    second = [[i + 16 for i in face] for face in QUADS]
    faces = [face[::-1] if i in (1, 4) else face for i, face in enumerate(QUADS)]
    faces += [face if i in (3, 5) else face[::-1] for i, face in enumerate(second)]
    mesh, report, kinds = repaired(GRID + far, faces)
    assert kinds == {"flipped_faces"}
    assert report.flipped_faces == [1, 4, 12, 14]
    assert faces_of(mesh)[1] == [QUADS[1][i] for i in (3, 0, 1, 2)]


def test_halves_follow_the_first_face() -> None:
    mesh, report, _ = repaired(GRID, [QUADS[0][::-1], QUADS[1]])
    assert report.flipped_faces == [1]
    assert mesh.n_faces == 2


@pytest.mark.parametrize("n", [5, 8, 13])
def test_a_moebius_strip_is_cut_open(n: int) -> None:
    turn = np.arange(n) * 2 * np.pi / n
    mid = np.stack([np.cos(turn), np.sin(turn), 0 * turn], 1) * 3
    arm = np.cos(turn / 2)[:, None] * mid / 3 + np.sin(turn / 2)[:, None] * [0, 0, 1]
    points = np.concatenate([mid + arm, mid - arm])
    faces = [[i, i + 1, n + i + 1, n + i] for i in range(n - 1)] + [[n - 1, n, 0, 2 * n - 1]]
    with pytest.raises(InputError, match="non-orientable"):
        Mesh(points, faces)
    mesh, report, kinds = repaired(points.tolist(), faces)
    assert mesh.n_faces == n
    assert mesh.n_vertices == 2 * n + 2
    assert kinds <= {"separated_vertices", "flipped_faces"}
    assert len(report.separated_vertices) == 2


# Non-manifold edges and vertices


def test_at_an_edge_with_three_faces_the_smooth_pair_stays_together() -> None:
    wall = [[0, 1, -1], [1, 1, -1.2], [2, 1, -1], [3, 1, -1]]
    below = [[16 + i, 17 + i, 4 * i + 5, 4 * i + 1] for i in range(3)]
    mesh, report, kinds = repaired(GRID + wall, below + QUADS)
    assert kinds == {"separated_vertices"}
    assert report.separated_vertices == [1, 5, 9, 13]
    assert mesh.n_faces == 12
    roof = Mesh(GRID, QUADS)
    assert len(mesh.topology.edge_corners) == len(roof.topology.edge_corners) + 2


def test_faces_that_meet_in_a_vertex_alone_are_separated() -> None:
    mesh, report, _ = repaired(GRID, [QUADS[0], QUADS[4]])
    assert mesh.n_vertices == 8
    assert report.separated_vertices == [5]
    assert mesh.vertices[-1].tolist() == GRID[5]


def test_walls_within_a_box_are_separated() -> None:
    """Every edge of the grid of cells has three faces or four."""
    points = [[x, y, z] for x in range(3) for y in range(3) for z in range(3)]
    number = {tuple(p): i for i, p in enumerate(points)}
    faces = []
    for axis in range(3):
        for p in points:
            steps = [np.eye(3, dtype=int)[k] for k in range(3) if k != axis]
            ring = [p, p + steps[0], p + steps[0] + steps[1], p + steps[1]]
            ids = [number.get(tuple(np.asarray(q).tolist())) for q in ring]
            if None not in ids:
                faces.append(ids)
    mesh, report, _ = repaired(points, faces)  # type: ignore[arg-type]
    assert mesh.n_faces == len(faces) == 36
    assert report.separated_vertices
    again, second = repair(raw_from_mesh(mesh))
    assert np.array_equal(again.corners, mesh.corners)
    assert not repair_counts(second)


# Words, input


def test_a_repair_is_told_in_one_sentence() -> None:
    counts = {"welded_vertices": 2, "sliver_faces": 1, "unused_vertices": 1}
    assert repair_words(counts, is_done=False) == (
        "weld 2 places, drop 1 sliver, drop 1 unused vertex"
    )
    assert repair_words({}, is_done=True) == ""


@pytest.mark.parametrize("points", [[[0, 1], [2, 3]], [[0, 1, 2], [3]], [["a", "b", "c"]], 7])
def test_vertices_must_be_rows_of_three_numbers(points: object) -> None:
    with pytest.raises(InputError, match="vertices must"):
        raw_from_faces(points, [[0, 1, 2]])  # type: ignore[arg-type]
