"""Triangles in rows from a net of quadrilaterals: every other row moves on by half an edge."""

from typing import Any, Literal, get_args

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from .errors import InputError, name_ids
from .mesh import Mesh, corner_edges, edge_ends, face_vector_areas

Rows = Literal["sharper", "flatter"]


def shifted_rows(mesh: Mesh, rows: Rows = "sharper") -> Mesh:
    """
    Triangles with six neighbours at every inner vertex, in rows along lines of a net.

    Parameters
    ----------
    mesh : Mesh
        Quadrilaterals with four edges at every inner vertex.
    rows : {"sharper", "flatter"}
        Rows run along those lines of the net that bend more, or less, across the surface.

    Returns
    -------
    Mesh
        Triangles. Every other row keeps its vertices; the vertices of the rest lie between two
        old ones, on a cubic curve through four, and the ends of rows stay.

    Raises
    ------
    InputError
        If a face is no quadrilateral, the net has vertices at which rows become columns, or an
        odd number of rows closes up; the message names the faces.

    Notes
    -----
    Tangent spheres of triangulations with rows along the direction of the larger curvature make
    hexagons of the best shapes.
    """
    if rows not in get_args(Rows):
        raise InputError(f"rows must be sharper or flatter, not {rows!r}")
    bad = np.flatnonzero(mesh.degrees != 4)
    if len(bad):
        raise InputError(f"faces {name_ids(bad.tolist())} are no quadrilaterals")
    edges = corner_edges(mesh)
    ends = edge_ends(mesh, edges)
    in_row = _row_edges(mesh, edges, ends, rows)
    row_ends = ends[in_row]
    is_shifted = _shifted_vertices(mesh, row_ends, ends[~in_row])
    points, ids = _row_points(mesh, ends, in_row & is_shifted[ends[:, 0]])
    faces = _triangles(mesh, edges, in_row, is_shifted, ids)
    used, corners = np.unique(faces, return_inverse=True)
    return Mesh(points[used], corners.reshape(-1, 3).astype(np.int64))


def _two_colors(count: int, same: IntArray, different: IntArray) -> tuple[BoolArray, BoolArray]:
    """
    Colour things (count) so that pairs (n, 2) are alike, and others differ.

    Two copies of everything, one per colour: what is joined to its own copy has none.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    first = np.concatenate([same, same + count, different, different[:, ::-1]])
    first[2 * len(same) :, 1] += count
    ones = np.ones(len(first), bool)
    graph = csr_array((ones, (first[:, 0], first[:, 1])), shape=(2 * count, 2 * count))
    found: Any = connected_components(graph, directed=False)
    labels = np.asarray(found[1], np.int64)
    return labels[:count] > labels[count:], labels[:count] == labels[count:]


def _row_edges(mesh: Mesh, edges: IntArray, ends: IntArray, rows: Rows) -> BoolArray:
    """Edges that run along the rows."""
    sides = edges.reshape(-1, 4)
    same = np.concatenate([sides[:, [0, 2]], sides[:, [1, 3]]])
    family, is_mixed = _two_colors(len(ends), same, sides[:, :2])
    _refuse_faces(
        is_mixed[sides],
        "faces {} belong to a net in which rows become columns, about vertices without four "
        "edges: cut it there, or use triangulate",
    )
    bends = [_mean_bend(mesh, ends[family == name]) for name in (False, True)]
    sharper = bends[1] > bends[0]
    return family == (sharper if rows == "sharper" else not sharper)


def _mean_bend(mesh: Mesh, lines: IntArray) -> float:
    """Mean curvature across the surface of polylines with edges (n, 2)."""
    count = mesh.n_vertices
    faces = np.repeat(face_vector_areas(mesh), 4, axis=0)
    normals = unit(sum_by(mesh.corners, faces, count))
    pairs = np.concatenate([lines, lines[:, ::-1]])
    arms = mesh.vertices[pairs[:, 1]] - mesh.vertices[pairs[:, 0]]
    turns = sum_by(pairs[:, 0], unit(arms), count)
    lengths = sum_by(pairs[:, 0], norm(arms), count)
    inner = np.bincount(pairs[:, 0], minlength=count) == 2
    if not inner.any():
        return 0.0
    return float(np.abs(2 * dot(turns, normals)[inner] / lengths[inner]).mean())


def _shifted_vertices(mesh: Mesh, row_ends: IntArray, cross_ends: IntArray) -> BoolArray:
    """Vertices of every other row; if that is a choice, of those with less of the boundary."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    count = mesh.n_vertices
    graph = csr_array(
        (np.ones(len(row_ends), bool), (row_ends[:, 0], row_ends[:, 1])), shape=(count, count)
    )
    found: Any = connected_components(graph, directed=False)
    row = np.asarray(found[1], np.int64)
    none = np.zeros((0, 2), np.int64)
    color, is_odd = _two_colors(int(found[0]), none, row[cross_ends])
    _refuse_faces(
        is_odd[row][mesh.corners].reshape(-1, 4),
        "faces {} lie in an odd number of rows that closes up: every other one cannot shift; "
        "use rows along the other lines, or one row more",
    )
    is_used = np.zeros(count, bool)
    is_used[mesh.corners] = True
    boundary = mesh.topology.is_boundary_vertex & is_used
    shifted = color[row]
    if (boundary & shifted).sum() > (boundary & ~shifted & is_used).sum():
        shifted = ~shifted
    return shifted


def _row_points(mesh: Mesh, ends: IntArray, between: BoolArray) -> tuple[FloatArray, IntArray]:
    """Old points, then one on each edge so marked; and the id (n,) of that of each edge."""
    origin = mesh.vertices[mesh.corners[0]]
    points, count = mesh.vertices - origin, mesh.n_vertices
    a, b = ends[between].T
    tails, heads = np.concatenate([a, b]), np.concatenate([b, a])
    neighbors = sum_by(tails, points[heads], count)
    has_two = np.bincount(tails, minlength=count) == 2
    before, after = neighbors[a] - points[b], neighbors[b] - points[a]
    middle = (points[a] + points[b]) / 2
    # The cubic through four points, the parabola through three at an end, or the chord.
    both = (has_two[a] & has_two[b])[:, None]
    bulge = (points[a] + points[b] - before - after) / 16
    start = np.where(has_two[a, None], 2 * points[a] - before - points[b], 0.0) / 8
    end = np.where(has_two[b, None], 2 * points[b] - after - points[a], 0.0) / 8
    fresh = middle + np.where(both, bulge, start + end)
    ids = np.full(len(ends), -1, np.int64)
    ids[between] = count + np.arange(len(fresh))
    return np.concatenate([points, fresh]) + origin, ids


def _triangles(
    mesh: Mesh, edges: IntArray, in_row: BoolArray, is_shifted: BoolArray, ids: IntArray
) -> IntArray:
    """One triangle per quad on its unshifted side, and one per edge across the rows."""
    quads = np.arange(len(edges)).reshape(-1, 4)
    starts = in_row[edges[quads]] & ~is_shifted[mesh.corners[quads]]
    turn = np.argmax(starts, axis=1)
    order = np.take_along_axis(quads, (turn[:, None] + np.arange(4)) % 4, axis=1)
    a, b, c, d = mesh.corners[order].T
    middle = ids[edges[order[:, 2]]]
    # Beyond the edge from b to c lies the next quad of the row, or the end of the row.
    after = mesh.topology.twins[order[:, 1]]
    before = mesh.topology.twins[order[:, 3]]
    following = np.where(after >= 0, middle[after // 4], c)
    is_start = before < 0
    return np.concatenate(
        [
            np.stack([a, b, middle], 1),
            np.stack([b, following, middle], 1),
            np.stack([a, middle, d], 1)[is_start],
        ]
    )


def _refuse_faces(is_bad: BoolArray, message: str) -> None:
    """Refuse quads with a bad side or corner (F, 4)."""
    bad = np.flatnonzero(is_bad.any(axis=1))
    if len(bad):
        raise InputError(message.format(name_ids(bad.tolist())))
