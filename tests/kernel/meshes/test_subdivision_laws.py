"""Laws of triangulation and subdivision."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_normals, face_vector_areas
from spheremesh.kernel.meshes.subdivision import (
    subdivide_catmull_clark,
    subdivide_loop,
    subdivide_midpoint,
)
from spheremesh.kernel.meshes.triangulation import triangulate
from spheremesh.kernel.sphere_meshes.planarity_circularity import planarity

Scheme = Callable[[Mesh], Mesh]
SMOOTH: dict[str, Scheme] = {"loop": subdivide_loop, "catmull-clark": subdivide_catmull_clark}
SCHEMES: dict[str, Scheme] = {**SMOOTH, "midpoint": subdivide_midpoint}


@pytest.fixture(scope="module")
def mixed() -> Mesh:
    """Triangles, quads and a hexagon on a bowl, none of them regular."""
    turns = np.linspace(0, 2 * np.pi, 6, endpoint=False)
    rings = [(1.0, 0.1), (2.1, 0.5), (3.3, 1.4)]
    rng = np.random.default_rng(1)
    points = [[r * np.cos(t), 1.2 * r * np.sin(t), z] for r, z in rings for t in turns]
    vertices = np.array(points) + 0.15 * rng.normal(size=(18, 3))
    # The hexagon is planar.
    vertices[:6, 2] = 0.1 + 0.2 * vertices[:6, 0]
    around = [(i, (i + 1) % 6) for i in range(6)]
    faces = [[*range(6)], *([i, 6 + i, 6 + j, j] for i, j in around)]
    faces += [
        face for i, j in around for face in ([6 + i, 12 + i, 6 + j], [12 + i, 12 + j, 6 + j])
    ]
    return Mesh(vertices, faces)


@pytest.fixture(scope="module")
def shapes(mixed: Mesh, nets: dict[str, Mesh], octahedron: Mesh) -> dict[str, Mesh]:
    """Open and closed meshes of every degree."""
    return {"mixed": mixed, "torus": nets["torus"], "roof": nets["roof"], "ball": octahedron}


def grid(n: int, height: FloatArray | None = None) -> Mesh:
    """Squares, n by n; `skew` makes triangles of them."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    z = np.zeros_like(x) if height is None else height
    ids = np.arange(x.size).reshape(x.shape)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))


def skew(mesh: Mesh) -> Mesh:
    """Squares cut along their first diagonal: every inner vertex has six neighbours."""
    quads = mesh.corners.reshape(-1, 4)
    triangles = np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], 1)
    return Mesh(mesh.vertices, triangles.reshape(-1, 3))


def characteristic(mesh: Mesh) -> int:
    boundary = int((mesh.topology.twins < 0).sum())
    used = len(np.unique(mesh.corners))
    return used - (len(mesh.topology.edge_corners) + boundary) + mesh.n_faces


def boundary_loops(mesh: Mesh) -> set[frozenset[int]]:
    rim = mesh.topology.twins < 0
    tails = mesh.corners[rim]
    heads = mesh.corners[mesh.topology.next_corners][rim]
    return {frozenset(pair) for pair in zip(tails.tolist(), heads.tolist(), strict=True)}


def in_order(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Vertices, and centroids with vector areas of faces, in an order of their own."""
    middles = np.array([mesh.vertices[face].mean(0) for face in mesh.faces])
    faces = np.concatenate([middles, face_vector_areas(mesh)], 1)
    key_v, key_f = (np.lexsort(np.round(a, 7).T) for a in (mesh.vertices, faces))
    return mesh.vertices[key_v], faces[key_f]


def applied(name: str, mesh: Mesh) -> Mesh:
    if name == "triangulate":
        return triangulate(mesh)
    return SCHEMES[name](triangulate(mesh) if name == "loop" else mesh)


OPERATIONS = ["triangulate", *SCHEMES]


@pytest.mark.parametrize("name", OPERATIONS)
@pytest.mark.parametrize("shape", ["mixed", "torus", "roof", "ball"])
def test_law_topology_is_kept(name: str, shape: str, shapes: dict[str, Mesh]) -> None:
    mesh = shapes[shape]
    result = applied(name, mesh)
    assert characteristic(result) == characteristic(mesh)
    expected = {
        "triangulate": (mesh.degrees - 2).sum(),
        "loop": 4 * (mesh.degrees - 2).sum(),
        "catmull-clark": mesh.degrees.sum(),
        "midpoint": mesh.degrees.sum() + (mesh.degrees == 3).sum(),
    }[name]
    assert result.n_faces == expected
    rim, finer = len(boundary_loops(mesh)), len(boundary_loops(result))
    assert finer == (rim if name == "triangulate" else 2 * rim)


@pytest.mark.parametrize("name", OPERATIONS)
@pytest.mark.parametrize("shape", ["mixed", "ball"])
def test_law_faces_keep_their_orientation(
    name: str, shape: str, shapes: dict[str, Mesh]
) -> None:
    mesh = shapes[shape]
    result = applied(name, mesh)
    per_face = np.diff(mesh.offsets) - 2 if name == "triangulate" else None
    if name == "loop":
        per_face = 4 * (mesh.degrees - 2)
    if name == "catmull-clark":
        per_face = mesh.degrees
    if name == "midpoint":
        per_face = mesh.degrees + (mesh.degrees == 3)
    parents = np.repeat(np.arange(mesh.n_faces), per_face)
    # Parts follow each other, in the order of the faces, and look the same way.
    assert (dot(face_normals(result), face_normals(mesh)[parents]) > 0).all()


@pytest.mark.parametrize("name", OPERATIONS)
def test_law_does_not_depend_on_numbering(
    name: str, mixed: Mesh, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    shuffled, _ = renumber(mixed)
    for found, expected in zip(
        in_order(applied(name, shuffled)), in_order(applied(name, mixed)), strict=True
    ):
        np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("name", OPERATIONS)
def test_law_commutes_with_similarities(name: str, mixed: Mesh, rotation: FloatArray) -> None:
    expected = applied(name, mixed)
    for scale, shift in ((1e3, 0.0), (1e-3, 0.0), (1.0, 1e6), (1e3, 1e6)):
        points = scale * (mixed.vertices @ rotation.T + shift)
        found = applied(name, Mesh(points, mixed.faces))
        np.testing.assert_array_equal(found.corners, expected.corners)
        np.testing.assert_allclose(
            (found.vertices / scale - shift) @ rotation, expected.vertices,
            atol=1e-13 + 1e-15 * shift,
        )  # fmt: skip


@pytest.mark.parametrize("name", OPERATIONS)
def test_law_planar_stays_planar(name: str, rotation: FloatArray) -> None:
    flat = grid(4)
    flat = Mesh(flat.vertices @ rotation.T + 3, flat.faces)
    result = applied(name, flat)
    np.testing.assert_allclose((result.vertices - 3) @ rotation[:, 2], 0, atol=1e-14)
    areas = face_vector_areas(result).sum(0)
    if name in {"triangulate", "midpoint"}:
        np.testing.assert_allclose(areas, face_vector_areas(flat).sum(0), atol=1e-13)


def test_law_midpoints_keep_planar_faces_and_areas(mixed: Mesh) -> None:
    finer = subdivide_midpoint(mixed)
    is_planar = np.repeat(planarity(mixed) < 1e-12, mixed.degrees + (mixed.degrees == 3))
    assert is_planar.sum() > 12 * 4
    assert planarity(finer)[is_planar].max() < 1e-14
    np.testing.assert_array_equal(finer.vertices[: mixed.n_vertices], mixed.vertices)
    np.testing.assert_allclose(
        face_vector_areas(finer).sum(0), face_vector_areas(mixed).sum(0), atol=1e-13
    )


def test_law_catmull_clark_is_the_cubic_spline_on_grids() -> None:
    rng = np.random.default_rng(2)
    mesh = grid(4, rng.normal(size=(5, 5)))
    points = mesh.vertices.reshape(5, 5, 3)
    mask = np.array([1, 4, 1]) / 6
    limit = np.einsum("i,j,ijk->k", mask, mask, points[1:4, 1:4])
    rim = np.einsum("i,ik->k", mask, points[1:4, 0])
    errors = []
    for _ in range(5):
        mesh = subdivide_catmull_clark(mesh)
        errors.append(norm(mesh.vertices[[12, 10]] - [limit, rim]))
    # The distance from the limit falls to a quarter with each step.
    assert errors[-1].max() < 1e-3
    np.testing.assert_allclose(errors[-1] / errors[-2], 0.25, atol=1e-3)


def test_law_loop_is_the_box_spline_on_grids() -> None:
    rng = np.random.default_rng(3)
    mesh = skew(grid(4, rng.normal(size=(5, 5))))
    points = mesh.vertices.reshape(5, 5, 3)
    around = [
        points[2 + i, 2 + j] for i, j in ((1, 0), (1, 1), (0, 1), (-1, 0), (-1, -1), (0, -1))
    ]
    limit = points[2, 2] / 2 + np.sum(around, axis=0) / 12
    rim = np.einsum("i,ik->k", np.array([1, 4, 1]) / 6, points[1:4, 0])
    errors = []
    for _ in range(5):
        mesh = subdivide_loop(mesh)
        errors.append(norm(mesh.vertices[[12, 10]] - [limit, rim]))
    assert errors[-1].max() < 1e-3
    np.testing.assert_allclose(errors[-1] / errors[-2], 0.25, atol=1e-3)


@pytest.mark.parametrize("name", SMOOTH)
def test_law_affine_grids_stay_inside(name: str) -> None:
    mesh = grid(6) if name == "catmull-clark" else skew(grid(6))
    finer = SMOOTH[name](mesh)
    inner = np.flatnonzero(~mesh.topology.is_boundary_vertex)
    np.testing.assert_allclose(finer.vertices[inner], mesh.vertices[inner], atol=1e-14)


@pytest.mark.parametrize("name", SMOOTH)
def test_law_meshes_that_share_a_boundary_keep_sharing_it(name: str) -> None:
    rng = np.random.default_rng(4)
    heights = rng.normal(size=(5, 9))
    left, right = (
        Mesh(
            np.column_stack([grid(4).vertices[:, 0], y + grid(4).vertices[:, 1], z.ravel()]),
            (grid(4) if name == "catmull-clark" else skew(grid(4))).faces,
        )
        for y, z in ((0, heights[:, :5]), (4, heights[:, 4:]))
    )
    left, right = SMOOTH[name](left), SMOOTH[name](right)
    for i in range(1, 4):
        np.testing.assert_allclose(left.vertices[5 * i + 4], right.vertices[5 * i], atol=1e-14)


def test_quads_are_split_along_the_shorter_diagonal(nets: dict[str, Mesh]) -> None:
    mesh = nets["enneper"]
    quads = mesh.vertices[mesh.corners.reshape(-1, 4)]
    shorter = np.minimum(norm(quads[:, 0] - quads[:, 2]), norm(quads[:, 1] - quads[:, 3]))
    corners = mesh.vertices[triangulate(mesh).corners].reshape(-1, 2, 3, 3)
    for pair, length in zip(corners, shorter, strict=True):
        sides = norm(np.roll(pair, -1, axis=1) - pair).ravel()
        assert (np.abs(sides - length) < 1e-9).sum() >= 2


def test_equal_diagonals_give_a_regular_net(nets: dict[str, Mesh]) -> None:
    # Trapezoids of a surface of revolution: their diagonals differ by rounding.
    mesh = nets["torus"]
    quads = mesh.corners.reshape(-1, 4)
    expected = np.stack([quads[:, [0, 1, 2]], quads[:, [2, 3, 0]]], 1).reshape(-1, 3)
    found = triangulate(mesh).corners.reshape(-1, 3)
    np.testing.assert_array_equal(np.sort(found, axis=1), np.sort(expected, axis=1))


def test_polygons_that_are_not_convex() -> None:
    turns = np.arange(14) * np.pi / 7
    radii = np.where(np.arange(14) % 2, 1.0, 3.0)
    star = np.stack([radii * np.cos(turns), radii * np.sin(turns), 0 * turns], 1)
    # The diagonal across the mouth of the dart is short, but runs outside.
    dart = [[0, 0, 0], [3, 0.3, 0], [0, 0.6, 0], [1, 0.3, 0]]
    ell = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
    in_line = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]]
    for points in (star, dart, ell, in_line):
        for turn in range(len(points)):
            mesh = Mesh(points, [np.roll(np.arange(len(points)), turn)])
            areas = face_vector_areas(triangulate(mesh))
            assert (areas[:, 2] > 0.01).all()
            np.testing.assert_allclose(areas.sum(0), face_vector_areas(mesh)[0], atol=1e-13)


def test_bad_input_is_named(mixed: Mesh) -> None:
    crossed = Mesh([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]], [[0, 1, 2, 3]])
    with pytest.raises(InputError, match=r"faces \[0\] cross themselves"):
        triangulate(crossed)
    with pytest.raises(InputError, match=r"faces \[0, 1, 2, 3, 4, 5, 6\] are no triangles"):
        subdivide_loop(mixed)


@pytest.mark.parametrize("name", OPERATIONS)
def test_vertices_without_a_face_do_no_harm(name: str, mixed: Mesh) -> None:
    points = np.insert(mixed.vertices, 3, 9.0, axis=0)
    lonely = Mesh(points, [face + (face >= 3) for face in mixed.faces])
    result = applied(name, lonely)
    expected = applied(name, mixed)
    np.testing.assert_allclose(
        face_vector_areas(result), face_vector_areas(expected), atol=1e-15
    )
