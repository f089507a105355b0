"""Connectivity of a mesh of mixed face degrees, from its half-edges.

A *corner* is a vertex in a face. Corner h also names the half-edge that leaves it, so the
arrays of length H serve both. Interior edges are counted once, by their first half-edge.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, IntArray, read_only
from .defects import crowded_edge, disagreeing_normals, repeated_face, split_vertex


@dataclass(frozen=True)
class Topology:
    """Half-edge arrays of an orientable manifold mesh with boundary.

    Attributes
    ----------
    corner_faces : (H,) int array
    next_corners : (H,) int array
        Following corner in the same face.
    twins : (H,) int array
        Opposite half-edge; -1 on the boundary.
    edge_corners : (E,) int array
        First half-edge of each interior edge.
    edge_faces : (E, 2) int array
        Faces left and right of each interior edge.
    edge_vertices : (E, 2) int array
        Ends of each interior edge, in the direction of its first half-edge.
    is_boundary_vertex : (V,) bool array
        Vertices on the boundary; unused vertices count as such.
    """

    corner_faces: IntArray
    next_corners: IntArray
    twins: IntArray
    edge_corners: IntArray
    edge_faces: IntArray
    edge_vertices: IntArray
    is_boundary_vertex: BoolArray


def build_topology(corners: IntArray, offsets: IntArray, n_vertices: int) -> Topology:
    """Match half-edges and check that they form an orientable manifold with boundary.

    Parameters
    ----------
    corners : (H,) int array
        Vertex of each corner, face after face.
    offsets : (F + 1,) int array
        First corner of each face, and H.

    Raises
    ------
    InputError
        If an edge has more than two faces, two faces run along an edge in the same direction,
        or faces meet in a vertex without sharing an edge; the message names the faces.

    Notes
    -----
    One sort of the H half-edges; everything else is linear.
    """
    degrees = np.diff(offsets)
    corner_faces = np.repeat(np.arange(len(degrees)), degrees)
    next_corners = np.arange(1, len(corners) + 1)
    next_corners[offsets[1:] - 1] = offsets[:-1]
    heads = corners[next_corners]
    twins = _match_half_edges(corners, heads, offsets, n_vertices)
    _check_pillows(corners, offsets, twins, corner_faces)
    _check_vertex_fans(corners, next_corners, twins, corner_faces, n_vertices)

    edge_corners = np.flatnonzero(twins > np.arange(len(corners)))
    is_boundary_vertex = np.ones(n_vertices, bool)
    is_boundary_vertex[corners] = False
    is_boundary_vertex[corners[twins < 0]] = True
    is_boundary_vertex[heads[twins < 0]] = True
    edge_faces = np.stack([corner_faces[edge_corners], corner_faces[twins[edge_corners]]], 1)
    edge_vertices = np.stack([corners[edge_corners], heads[edge_corners]], 1)
    arrays = (
        corner_faces, next_corners, twins, edge_corners, edge_faces, edge_vertices,
        is_boundary_vertex,
    )  # fmt: skip
    return Topology(*(read_only(array) for array in arrays))


def _match_half_edges(
    tails: IntArray, heads: IntArray, offsets: IntArray, n_vertices: int
) -> IntArray:
    undirected = np.minimum(tails, heads) * n_vertices + np.maximum(tails, heads)
    order = np.argsort(undirected, kind="stable")
    ordered = undirected[order]
    same = ordered[1:] == ordered[:-1]
    crowded = np.flatnonzero(same[1:] & same[:-1])
    if len(crowded):
        first = order[crowded[0]]
        owners = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
        faces = np.unique(owners[undirected == undirected[first]])
        raise crowded_edge(tails, offsets, (int(tails[first]), int(heads[first])), faces)
    pairs = np.flatnonzero(same)
    left, right = order[pairs], order[pairs + 1]
    is_aligned = tails[left] == tails[right]
    if is_aligned.any():
        links = np.stack([left, right], 1)
        raise disagreeing_normals(tails, offsets, links, is_aligned)
    twins = np.full(len(tails), -1, np.int64)
    twins[left], twins[right] = right, left
    return twins


def _check_vertex_fans(
    corners: IntArray,
    next_corners: IntArray,
    twins: IntArray,
    corner_faces: IntArray,
    n_vertices: int,
) -> None:
    """Each vertex must be surrounded by one fan of faces: count open and closed fans."""
    previous = np.empty_like(next_corners)
    previous[next_corners] = np.arange(len(corners))
    around = twins[previous]
    is_open = np.zeros(len(corners), bool)
    is_open[around < 0] = True
    jump = np.where(around < 0, np.arange(len(corners)), around)
    label = np.arange(len(corners))
    # Pointer doubling: after k rounds each corner has seen 2^k corners of its fan.
    largest = int(np.bincount(corners, minlength=1).max(initial=1))
    for _ in range(max(1, largest.bit_length() + 1)):
        label = np.minimum(label, label[jump])
        is_open = is_open | is_open[jump]
        jump = jump[jump]
    closed_fans = ~is_open & (label == np.arange(len(corners)))
    starts = (around < 0) | closed_fans
    fans = np.bincount(corners[starts], minlength=n_vertices)
    if (fans > 1).any():
        vertex = int(np.flatnonzero(fans > 1)[0])
        faces = np.unique(corner_faces[corners == vertex])
        raise split_vertex(vertex, faces)


def _check_pillows(
    corners: IntArray, offsets: IntArray, twins: IntArray, corner_faces: IntArray
) -> None:
    """Two faces with the same corners close up, but are one face and the same turned over."""
    other = np.where(twins < 0, -1, corner_faces[twins])
    least = np.minimum.reduceat(other, offsets[:-1])
    is_single = (least >= 0) & (least == np.maximum.reduceat(other, offsets[:-1]))
    faces = np.flatnonzero(is_single)
    if len(faces):
        error = repeated_face(corners, offsets, np.unique([faces, least[faces]]))
        if error:
            raise error


def previous_corners(topology: Topology) -> IntArray:
    """The corner (H,) before each corner in its face: inverse of `Topology.next_corners`."""
    result = np.empty_like(topology.next_corners)
    result[topology.next_corners] = np.arange(len(result))
    return result
