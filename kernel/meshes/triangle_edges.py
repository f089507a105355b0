"""Triangles that are being edited, their edges and shapes, as arrays."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm

SLIVER = 0.15


@dataclass(frozen=True)
class Triangles:
    """
    Triangles that are being edited.

    Attributes
    ----------
    vertices : (V, 3) float array
        Points; some may be without a triangle.
    faces : (T, 3) int array
        Vertices of each triangle.
    is_fixed : (V,) bool array
        Vertices that stay in place.
    creases : (n, 2) int array
        Vertices of the edges within that are kept.
    """

    vertices: FloatArray
    faces: IntArray
    is_fixed: BoolArray
    creases: IntArray


@dataclass(frozen=True)
class Edges:
    """
    Edges of triangles.

    Attributes
    ----------
    ends : (E, 2) int array
        Vertices of each edge, as its first half-edge runs.
    keys : (E,) int array
        A number for each pair of ends.
    halves : (E, 2) int array
        Half-edges ``3 t + k``, from corner k of triangle t to the next; -1 on the boundary.
    corner_edges : (T, 3) int array
        Edge that leaves each corner.
    is_rim, is_line : (E,) bool array
        Edges on the boundary; on the boundary or a crease.
    is_rim_vertex, is_line_vertex : (V,) bool array
        Vertices of such edges.
    """

    ends: IntArray
    keys: IntArray
    halves: IntArray
    corner_edges: IntArray
    is_rim: BoolArray
    is_line: BoolArray
    is_rim_vertex: BoolArray
    is_line_vertex: BoolArray


def find_edges(triangles: Triangles) -> Edges:
    """
    Edges of triangles, by one sort of the half-edges.

    Parameters
    ----------
    triangles : Triangles
        The triangles.

    Returns
    -------
    Edges
        The edges.
    """
    faces, count = triangles.faces, len(triangles.vertices)
    ends = np.stack([faces.ravel(), np.roll(faces, -1, axis=1).ravel()], 1)
    keys, first, ids = np.unique(pair_keys(ends, count), return_index=True, return_inverse=True)
    others = np.ones(len(ends), bool)
    others[first] = False
    second = np.full(len(first), -1, np.int64)
    second[ids[others]] = np.flatnonzero(others)
    ends = ends[first]
    is_rim = second < 0
    is_line = is_rim | np.isin(keys, pair_keys(triangles.creases, count))
    is_rim_vertex, is_line_vertex = np.zeros((2, count), bool)
    is_rim_vertex[ends[is_rim]] = True
    is_line_vertex[ends[is_line]] = True
    halves = np.stack([first, second], 1).astype(np.int64)
    corner_edges = ids.reshape(-1, 3).astype(np.int64)
    return Edges(
        ends, keys, halves, corner_edges, is_rim, is_line, is_rim_vertex, is_line_vertex
    )


def pair_keys(pairs: IntArray, count: int) -> IntArray:
    """
    A number for each unordered pair of vertices.

    Parameters
    ----------
    pairs : (n, 2) int array
        Pairs.
    count : int
        Number of vertices.

    Returns
    -------
    (n,) int array
        Numbers.
    """
    return pairs.min(axis=1) * count + pairs.max(axis=1)


def edge_lengths(triangles: Triangles, edges: Edges) -> FloatArray:
    """
    Lengths of edges.

    Parameters
    ----------
    triangles : Triangles
        The triangles.
    edges : Edges
        Their edges.

    Returns
    -------
    (E,) float array
        Lengths.
    """
    return norm(triangles.vertices[edges.ends[:, 1]] - triangles.vertices[edges.ends[:, 0]])


def triangle_normals(corners: FloatArray) -> FloatArray:
    """
    Cross products of two sides: normals of twice the area of the triangles.

    Parameters
    ----------
    corners : (..., 3, 3) float array
        Corners of the triangles.

    Returns
    -------
    (..., 3) float array
        Vectors.
    """
    sides = corners[..., 1:, :] - corners[..., :1, :]
    return np.cross(sides[..., 0, :], sides[..., 1, :])


def thickness(corners: FloatArray) -> FloatArray:
    """
    Height of triangles over their longest side, relative to it.

    Parameters
    ----------
    corners : (..., 3, 3) float array
        Corners of the triangles.

    Returns
    -------
    (...) float array
        From 0 to 0.87, for an equilateral triangle; below `SLIVER` a sliver, whose normal says
        nothing about the surface.
    """
    sides = np.roll(corners, -1, axis=-2) - corners
    longest = dot(sides, sides).max(axis=-1)
    doubled = norm(triangle_normals(corners))
    return np.divide(doubled, longest, out=np.zeros_like(longest), where=longest > 0)
