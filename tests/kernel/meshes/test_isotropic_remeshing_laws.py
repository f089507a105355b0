"""Laws of isotropic remeshing: even edges, the same surface, topology, boundary and creases."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.isotropic_remeshing import even_share, remesh_triangles
from spheremesh.kernel.meshes.mesh import face_normals, face_vector_areas, mean_edge_length
from spheremesh.kernel.meshes.subdivision import subdivide_midpoint
from spheremesh.kernel.meshes.surface_lines import loop_starts, trace_curves
from spheremesh.kernel.meshes.triangle_edges import (
    Triangles,
    edge_lengths,
    find_edges,
    to_be_edited,
)
from spheremesh.kernel.meshes.triangle_edits import (
    collapse_short_edges,
    flip_edges,
    split_long_edges,
)
from spheremesh.kernel.meshes.triangulation import triangulate
from spheremesh.kernel.surfaces.circular_nets import torus_net


@pytest.fixture(scope="module")
def shapes(nets: dict[str, Mesh]) -> dict[str, Mesh]:
    """Surfaces with none, one and two boundaries, some of very uneven triangles."""
    return {
        "torus": torus_net(24, 12, 3.0, 1.0),
        "enneper": nets["enneper"],
        "vase": nets["vase"],
        "wild": wild_sheet(1),
    }


def wild_sheet(seed: int) -> Mesh:
    """Very uneven triangles between random points, with slivers and a jagged boundary."""
    from scipy.spatial import Delaunay

    cloud = np.random.default_rng(seed).uniform(size=(400, 2)) ** 1.5
    height = 0.3 * np.sin(3 * cloud[:, 0]) * cloud[:, 1]
    triangles = Delaunay(cloud).simplices.astype(np.int64)
    return Mesh(np.column_stack([cloud, height]), triangles)


def star(n_tips: int) -> Mesh:
    """A ring whose outer boundary is a fine smooth wave, without a corner."""
    turns = 2 * np.pi * np.arange(160) / 160
    radii = np.linspace(0.3, 1, 12)[:, None]
    radii = radii + 0.25 * np.cos(n_tips * turns) * radii**3
    points = np.stack([radii * np.cos(turns), radii * np.sin(turns), 0.1 * radii**2], -1)
    ids = np.arange(radii.size).reshape(radii.shape)
    ids = np.concatenate([ids, ids[:, :1]], 1)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return triangulate(Mesh(points.reshape(-1, 3), quads.reshape(-1, 4)))


def characteristic(mesh: Mesh) -> int:
    boundary = int((mesh.topology.twins < 0).sum())
    used = len(np.unique(mesh.corners))
    return used - (len(mesh.topology.edge_corners) + boundary) + mesh.n_faces


def n_boundaries(mesh: Mesh) -> int:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    rim = mesh.topology.twins < 0
    tails, heads = mesh.corners[rim], mesh.corners[mesh.topology.next_corners][rim]
    links = csr_array(
        (np.ones(len(tails)), (tails, heads)), shape=(mesh.n_vertices, mesh.n_vertices)
    )
    labels = connected_components(links, directed=False)[1]
    return len(np.unique(labels[tails]))


def distances(points: FloatArray, mesh: Mesh) -> FloatArray:
    import igl

    surface = triangulate(mesh)
    faces = surface.corners.reshape(-1, 3)
    return np.sqrt(igl.point_mesh_squared_distance(points, surface.vertices, faces)[0])


def rim_points(mesh: Mesh, count: int = 5) -> FloatArray:
    """Points along the boundary."""
    rim = mesh.topology.twins < 0
    tails = mesh.vertices[mesh.corners[rim]]
    heads = mesh.vertices[mesh.corners[mesh.topology.next_corners][rim]]
    shares = np.linspace(0, 1, count)[:, None, None]
    return (tails + shares * (heads - tails)).reshape(-1, 3)


def rim_distances(points: FloatArray, mesh: Mesh) -> FloatArray:
    rim = mesh.topology.twins < 0
    tails = mesh.vertices[mesh.corners[rim]]
    along = mesh.vertices[mesh.corners[mesh.topology.next_corners][rim]] - tails
    arm = points[:, None] - tails
    share = np.clip(dot(arm, along) / dot(along, along), 0, 1)
    return norm(arm - share[..., None] * along).min(axis=1)


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.5])
@pytest.mark.parametrize("name", ["torus", "enneper", "vase", "wild"])
def test_law_edges_are_even_and_the_surface_stays(
    name: str, factor: float, shapes: dict[str, Mesh]
) -> None:
    mesh = shapes[name]
    length = factor * mean_edge_length(triangulate(mesh))
    result = remesh_triangles(mesh, length)
    assert even_share(result, length) > 0.95
    assert characteristic(result) == characteristic(mesh)
    assert n_boundaries(result) == n_boundaries(mesh)
    size = np.ptp(mesh.vertices)
    assert distances(result.vertices, mesh).max() < 1e-9 * size
    # Triangles cut off what bulges over them, and kinks of the mesh. At the rim of the sheet
    # there are steep slivers, which nothing even can follow.
    finer = subdivide_midpoint(triangulate(mesh))
    sharpest = {"torus": 1.0, "enneper": 2.0, "vase": 2.0, "wild": 0.0}[name]
    bound = 0.4 * sharpest * length * max(length, mean_edge_length(mesh))
    bound = 0.45 * length if name == "wild" else bound
    assert distances(finer.vertices, result).max() < bound
    np.testing.assert_allclose(
        norm(face_vector_areas(result)).sum(),
        norm(face_vector_areas(triangulate(mesh))).sum(),
        rtol=0.08,
    )


@pytest.mark.parametrize("name", ["enneper", "vase", "wild"])
def test_law_boundaries_stay(name: str, shapes: dict[str, Mesh]) -> None:
    mesh = shapes[name]
    length = 0.7 * mean_edge_length(mesh)
    result = remesh_triangles(mesh, length)
    assert_boundary_stays(mesh, result, length)


def assert_boundary_stays(mesh: Mesh, result: Mesh, length: float) -> None:
    on_rim = result.vertices[result.topology.is_boundary_vertex]
    assert rim_distances(on_rim, mesh).max() < 1e-12 * np.ptp(mesh.vertices)
    assert rim_distances(rim_points(mesh), result).max() < 0.1 * length


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_law_boundaries_stay_however_ties_fall(seed: int) -> None:
    # Rounding moves vertices by more than it differs between processors.
    rng = np.random.default_rng(seed)
    sheet = wild_sheet(1)
    length = 0.7 * mean_edge_length(sheet)
    noise = 1 + 1e-13 * rng.normal(size=sheet.vertices.shape)
    mesh = Mesh(sheet.vertices * noise, sheet.faces)
    assert_boundary_stays(mesh, remesh_triangles(mesh, length), length)
    mesh = wild_sheet(seed)
    for factor in (0.7, 1.5):
        length = factor * mean_edge_length(mesh)
        assert_boundary_stays(mesh, remesh_triangles(mesh, length), length)


@pytest.mark.parametrize("factor", [2.0, 4.0])
@pytest.mark.parametrize("n_tips", [3, 5, 8])
def test_law_boundaries_that_bend_within_an_edge_stay(n_tips: int, factor: float) -> None:
    mesh = star(n_tips)
    length = factor * mean_edge_length(mesh)
    result = remesh_triangles(mesh, length)
    assert_boundary_stays(mesh, result, length)
    assert result.n_vertices < 1.5 * mesh.n_vertices / factor**2
    assert characteristic(result) == 0
    assert n_boundaries(result) == 2


@pytest.mark.parametrize("name", ["torus", "wild", "cube"])
def test_law_rounding_decides_nothing(
    name: str, shapes: dict[str, Mesh], rotation: FloatArray
) -> None:
    mesh = {**shapes, "cube": cube()}[name]
    length = 0.9 * mean_edge_length(mesh) if name != "cube" else 0.2
    result = remesh_triangles(mesh, length)
    rng = np.random.default_rng(0)
    noise = 1 + 1e-13 * rng.normal(size=mesh.vertices.shape)
    for points in (mesh.vertices * noise, mesh.vertices @ rotation.T):
        other = remesh_triangles(Mesh(points, mesh.faces), length)
        np.testing.assert_array_equal(other.corners, result.corners)


def test_law_flat_stays_flat_and_corners_stay() -> None:
    square = Mesh([[0, 0, 0], [3, 0, 0], [3, 2, 0], [0, 2, 0]], [[0, 1, 2, 3]])
    result = remesh_triangles(square, 0.2)
    np.testing.assert_array_equal(result.vertices[:, 2], 0)
    areas = face_vector_areas(result)[:, 2]
    assert (areas > 0).all()
    np.testing.assert_allclose(areas.sum(), 6, rtol=1e-13)
    for corner in square.vertices:
        assert norm(result.vertices - corner).min() == 0
    valence = np.bincount(result.corners)[~result.topology.is_boundary_vertex]
    assert (valence == 6).mean() > 0.7
    assert even_share(result, 0.2) == 1


def cube() -> Mesh:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh(corners, faces)


def is_on_edge_of_cube(points: FloatArray) -> BoolArray:
    return ((np.abs(points) < 1e-12) | (np.abs(points - 1) < 1e-12)).sum(axis=1) >= 2


def test_law_creases_stay() -> None:
    result = remesh_triangles(cube(), 0.15)
    np.testing.assert_allclose(norm(face_vector_areas(result)).sum(), 6, rtol=1e-12)
    assert np.abs(face_normals(result)).max(axis=1).min() > 1 - 1e-12
    assert is_on_edge_of_cube(result.vertices).sum() > 12 * 5
    assert even_share(result, 0.15) > 0.99
    # Without creases the edges are cut off.
    smooth = remesh_triangles(cube(), 0.15, crease_angle=np.pi)
    assert norm(face_vector_areas(smooth)).sum() < 5.99


def test_law_does_not_depend_on_units_and_place(
    shapes: dict[str, Mesh], rotation: FloatArray
) -> None:
    mesh = shapes["vase"]
    length = mean_edge_length(mesh)
    result = remesh_triangles(mesh, length)
    for scale, shift in ((1e3, 0.0), (1e-3, 0.0), (1.0, 1e6)):
        points = scale * (mesh.vertices @ rotation.T + shift)
        other = remesh_triangles(Mesh(points, mesh.faces), scale * length)
        # Rounding may decide which of two equal edges comes first: compare what is promised.
        assert abs(other.n_faces - result.n_faces) < 0.05 * result.n_faces
        assert even_share(other, scale * length) > 0.95
        back = (other.vertices / scale - shift) @ rotation
        assert distances(back, mesh).max() < 1e-8


def test_law_quality_does_not_depend_on_numbering(
    shapes: dict[str, Mesh], renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    mesh = shapes["wild"]
    length = mean_edge_length(mesh)
    result, other = (remesh_triangles(m, length) for m in (mesh, renumber(mesh)[0]))
    assert abs(other.n_faces - result.n_faces) < 0.1 * result.n_faces
    assert even_share(other, length) > 0.95


def test_law_blunt_creases_stay() -> None:
    turns = np.pi * np.arange(6) / 3
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    points = np.concatenate([np.column_stack([ring, np.full(6, z)]) for z in (0.0, 2.0)])
    tube = Mesh(points, [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)])
    result = remesh_triangles(tube, 0.25)
    np.testing.assert_allclose(norm(face_vector_areas(result)).sum(), 12, rtol=1e-12)
    turned = np.arctan2(*face_normals(result).T[[1, 0]]) * 3 / np.pi - 0.5
    np.testing.assert_allclose(turned, np.round(turned), atol=1e-9)


@pytest.mark.parametrize("length", [0.3, 0.7, 2.0])
def test_law_what_is_thinner_than_an_edge_keeps_its_topology(length: float) -> None:
    wire = torus_net(40, 5, 3.0, 0.15)
    result = remesh_triangles(wire, length, crease_angle=np.pi)
    assert characteristic(result) == 0
    grid = np.stack(np.meshgrid(np.arange(41) / 4, [0, 0.2], indexing="ij"), -1)
    ids = np.arange(82).reshape(41, 2)
    quads = np.stack([ids[:-1, 0], ids[1:, 0], ids[1:, 1], ids[:-1, 1]], -1)
    strip = Mesh(np.column_stack([grid.reshape(-1, 2), np.zeros(82)]), quads)
    result = remesh_triangles(strip, length)
    assert characteristic(result) == n_boundaries(result) == 1
    np.testing.assert_allclose(norm(face_vector_areas(result)).sum(), 2, rtol=1e-12)


def edited(mesh: Mesh) -> Triangles:
    surface = triangulate(mesh)
    rim = np.flatnonzero(surface.topology.twins < 0)
    lines = surface.corners[np.stack([rim, surface.topology.next_corners[rim]], 1)]
    nowhere = np.zeros(surface.n_vertices, bool)
    return to_be_edited(surface.vertices, surface.corners.reshape(-1, 3), nowhere, lines)


def test_law_edits_keep_the_topology(shapes: dict[str, Mesh]) -> None:
    for mesh in shapes.values():
        scaled = Mesh(mesh.vertices / mean_edge_length(mesh), mesh.faces)
        for factor in (0.4, 1.0, 3.0):
            start = edited(Mesh(factor * scaled.vertices, scaled.faces))
            split = split_long_edges(start)
            assert edge_lengths(split, find_edges(split)).max() <= 4 / 3
            merged = collapse_short_edges(start)
            flipped = flip_edges(start)
            for triangles in (split, merged, flipped):
                result = Mesh(triangles.vertices, triangles.faces)
                assert characteristic(result) == characteristic(mesh)
                assert n_boundaries(result) == n_boundaries(mesh)
            before, after = (
                np.bincount(find_edges(t).ends.ravel()) - 6 for t in (start, flipped)
            )
            assert (after**2).sum() <= (before**2).sum()


def test_law_edges_of_two_lines_do_not_become_one() -> None:
    # A narrow triangle between the boundary and a crease: its third corner could be merged.
    points = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.05, 0], [0.5, -0.9, 0.3]])
    faces = np.array([[0, 1, 2], [1, 0, 3]])
    lines = np.array([[1, 2], [2, 0], [0, 3], [3, 1], [0, 1]])
    start = to_be_edited(points, faces, np.array([True, True, False, True]), lines)
    merged = collapse_short_edges(start)
    assert len(np.unique(np.sort(merged.lines, axis=1), axis=0)) == len(merged.lines) == 5


def test_law_curves_know_how_far_chords_leave_them() -> None:
    turns = np.linspace(0, np.pi, 101)
    arc = np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
    points = np.concatenate([arc, arc + np.array([0, 0, 0.01])])
    first = np.stack([np.arange(100), np.arange(1, 101)], 1)
    lines = np.concatenate([first, first + 101])
    is_fixed = np.isin(np.arange(202), [0, 100, 101, 201])
    curves, arcs = trace_curves(points, lines, is_fixed)
    np.testing.assert_allclose(np.abs(np.diff(arcs, axis=1)), 2 * np.sin(np.pi / 200))
    # The ends of the first and the last edge: a quarter and a half circle, however close.
    start, middle, end = arcs[0, 0], arcs[50, 0], arcs[99, 1]
    other = arcs[[100, 199], [0, 1]]
    places = np.array([[start, middle], [middle, end], other])
    chords = curves.at(places.ravel()).reshape(-1, 2, 3)
    quarter = 1 - np.cos(np.pi / 4)
    np.testing.assert_allclose(curves.deviations(chords, places), [quarter, quarter, 1])
    with_start = loop_starts(np.array([[4, 2], [2, 3], [3, 4], [5, 6]]), np.arange(7) == 5)
    np.testing.assert_array_equal(with_start, [2])


def test_coarsening_beyond_the_shape_keeps_a_surface(octahedron: Mesh) -> None:
    fine = octahedron
    for _ in range(3):
        fine = subdivide_midpoint(fine)
    result = remesh_triangles(fine, 50.0, crease_angle=np.pi)
    assert characteristic(result) == 2
    assert 4 <= result.n_faces < 40
    tetrahedron = Mesh(
        [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
        [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
    )
    assert remesh_triangles(tetrahedron, 50.0, crease_angle=np.pi).n_faces == 4


def test_bad_input_is_named(octahedron: Mesh) -> None:
    for length in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="edge length must be positive"):
            remesh_triangles(octahedron, length)
    with pytest.raises(InputError, match=r"would make about 1\.6e\+13 triangles"):
        remesh_triangles(octahedron, 1e-6)


def test_vertices_without_a_face_are_left_out(octahedron: Mesh) -> None:
    lonely = Mesh(np.vstack([octahedron.vertices, [[9, 9, 9]]]), octahedron.faces)
    result = remesh_triangles(lonely, 0.4)
    assert len(np.unique(result.corners)) == result.n_vertices
