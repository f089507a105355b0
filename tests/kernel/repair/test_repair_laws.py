"""A repair gives back the mesh that was damaged, leaves clean ones alone, and is done once."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.repair.pipeline import repair, repair_counts
from spheremesh.kernel.repair.raw_mesh import RawMesh, raw_from_faces, raw_from_mesh

Faces = list[list[int]]
seeds = st.integers(0, 2**32 - 1)


def random_mesh(rng: np.random.Generator) -> tuple[FloatArray, Faces, list[tuple[int, int]]]:
    """A bumpy net of triangles and quads, and faces with a corner in the middle of an edge."""
    n, m = rng.integers(4, 9, 2).tolist()
    x, y = np.meshgrid(np.arange(n + 1), np.arange(m + 1), indexing="ij")
    points = np.stack([x, y, rng.normal(0, 0.3, x.shape)], -1).reshape(-1, 3)
    points = points + rng.normal(0, 0.05, points.shape)
    vertices, faces = points.tolist(), []
    for i in range(n):
        for j in range(m):
            a = i * (m + 1) + j
            quad = [a, a + m + 1, a + m + 2, a + 1]
            faces += [quad] if rng.random() < 0.6 else [quad[:3], [quad[0], *quad[2:]]]
    middles: list[tuple[int, int]] = []
    touched: set[int] = set()
    for face in rng.permutation(len(faces)).tolist():
        if len(middles) == 3:
            break
        ring = faces[face]
        a, b = ring[0], ring[1]
        across = [
            k for k, other in enumerate(faces)
            if (b, a) in zip(other, other[1:] + other[:1], strict=True)
        ]  # fmt: skip
        if not across or {face, across[0]} & touched:
            continue
        touched |= {face, across[0], len(faces)}
        middle = len(vertices)
        vertices.append(((np.array(vertices[a]) + vertices[b]) / 2).tolist())
        faces[face] = [middle, *ring[1:]]
        faces.append([a, middle, ring[-1]])
        other = faces[across[0]]
        other.insert(other.index(b) + 1, middle)
        middles.append((across[0], middle))
    return np.array(vertices), faces, middles


def damaged(
    vertices: FloatArray, faces: Faces, middles: list[tuple[int, int]], rng: np.random.Generator
) -> RawMesh:
    """Every tenth vertex split, a fifth of the faces flipped, T-junctions, two slivers."""
    points, rings = vertices.tolist(), [list(face) for face in faces]
    for face, middle in middles:
        rings[face].remove(middle)
    split = set(range(0, len(points), 10))
    for ring in rings:
        for place, vertex in enumerate(ring):
            if vertex in split and rng.random() < 0.8:
                ring[place] = len(points)
                points.append(points[vertex])
    for face in rng.permutation(len(rings))[: len(rings) // 5].tolist():
        rings[face].reverse()
    a, b, *_ = rings[int(rng.integers(len(rings)))]
    points.append((0.7 * np.array(points[a]) + 0.3 * np.array(points[b])).tolist())
    rings.append([a, len(points) - 1, b])
    points.append(points[b])
    rings.append([b, a, len(points) - 1])
    order = rng.permutation(len(rings)).tolist()
    return raw_from_faces(points, [rings[i] for i in order])


def placed_faces(mesh: Mesh) -> list[tuple[float, ...]]:
    """Corners of the faces by their places, each from its least one, in order."""
    rings = []
    for face in mesh.faces:
        ring = mesh.vertices[face].round(9).tolist()
        start = ring.index(min(ring))
        rings.append(tuple(np.ravel(ring[start:] + ring[:start]).tolist()))
    return sorted(rings)


def assert_same_faces(mesh: Mesh, vertices: FloatArray, faces: Faces) -> None:
    expected = Mesh(vertices, faces)
    assert mesh.n_vertices == expected.n_vertices
    actual, wanted = placed_faces(mesh), placed_faces(expected)
    assert [len(ring) for ring in actual] == [len(ring) for ring in wanted]
    turned = [tuple(np.ravel(np.reshape(r, (-1, 3))[::-1]).tolist()) for r in wanted]
    assert actual == wanted, turned[0]
    order = np.lexsort(mesh.vertices.round(9).T), np.lexsort(expected.vertices.round(9).T)
    miss = np.abs(mesh.vertices[order[0]] - expected.vertices[order[1]]).max()
    assert miss <= 1e-12


@given(seeds)
def test_a_damaged_mesh_is_repaired_to_the_mesh_it_came_from(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices, faces, middles = random_mesh(rng)
    mesh, report = repair(damaged(vertices, faces, middles, rng))
    assert_same_faces(mesh, vertices, faces)
    assert len(report.sliver_faces) == 2
    assert len(report.t_junctions) == len(middles) == 3
    assert len(report.flipped_faces) == (len(faces)) // 5
    assert report.welded_vertices
    assert not report.separated_vertices


@given(seeds)
def test_repair_of_a_clean_mesh_is_the_identity(seed: int) -> None:
    vertices, faces, _ = random_mesh(np.random.default_rng(seed))
    mesh = Mesh(vertices, faces)
    repaired, report = repair(raw_from_mesh(mesh))
    assert_identical(mesh, repaired)
    assert not repair_counts(report)
    assert report.face_ids == list(range(mesh.n_faces))


def test_nets_stay_as_they_are(nets: dict[str, Mesh]) -> None:
    for mesh in nets.values():
        repaired, report = repair(raw_from_mesh(mesh))
        assert_identical(mesh, repaired)
        assert not repair_counts(report)


def assert_identical(a: Mesh, b: Mesh) -> None:
    assert np.array_equal(a.vertices, b.vertices)
    assert np.array_equal(a.corners, b.corners)
    assert np.array_equal(a.offsets, b.offsets)


def tangled(rng: np.random.Generator) -> RawMesh:
    """Faces at random on few places: everything that can be wrong, at once."""
    points = rng.integers(0, 3, (12, 3)) + np.where(rng.random((12, 1)) < 0.2, 1e-9, 0)
    faces = [rng.integers(0, 12, rng.integers(3, 5)).tolist() for _ in range(10)]
    return raw_from_faces(points, faces)


@given(seeds)
def test_what_was_repaired_wants_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    raw = damaged(*random_mesh(rng), rng) if seed % 2 else tangled(rng)
    mesh, _ = repair(raw)
    again, report = repair(raw_from_mesh(mesh))
    assert_identical(mesh, again)
    assert not repair_counts(report)


@given(seeds, st.sampled_from([1e-3, 0.3048, 1.0, 1000.0]))
def test_scale_and_place_change_nothing(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    vertices, faces, middles = random_mesh(rng)
    raw = damaged(vertices, faces, middles, rng)
    turn = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    moved = scale * (raw.vertices @ turn.T + rng.uniform(-1e4, 1e4, 3))
    rings = np.split(raw.corners, raw.offsets[1:-1])
    mesh, report = repair(raw)
    other, other_report = repair(raw_from_faces(moved, rings))
    assert np.array_equal(mesh.corners, other.corners)
    assert repair_counts(report) == repair_counts(other_report)


@given(seeds)
def test_numbering_changes_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices, faces, middles = random_mesh(rng)
    raw = damaged(vertices, faces, middles, rng)
    new = rng.permutation(len(raw.vertices))
    points = np.empty_like(raw.vertices)
    points[new] = raw.vertices
    rings = [new[ring] for ring in np.split(raw.corners, raw.offsets[1:-1])]
    rings = [np.roll(rings[i], 1) for i in rng.permutation(len(rings))]
    assert_same_faces(repair(raw_from_faces(points, rings))[0], vertices, faces)
