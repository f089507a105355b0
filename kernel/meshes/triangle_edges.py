"""Triangles that are being edited, their edges and shapes, as arrays."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..tolerances import SAME_LENGTH
from .surface_lines import Curves, loop_starts, trace_curves

SLIVER = 0.15


@dataclass(frozen=True)
class Triangles:
    """Triangles that are being edited.

    Attributes
    ----------
    vertices : (V, 3) float array
        Points; some may be without a triangle.
    faces : (T, 3) int array
        Vertices of each triangle.
    is_fixed : (V,) bool array
        Vertices that stay in place.
    lines : (n, 2) int array
        Vertices of the edges on lines: the boundary, and creases.
    arcs : (n, 2) float array
        Where these vertices lie on `curves`.
    curves : Curves
        The lines as they were at first. They end at fixed vertices.
    """

    vertices: FloatArray
    faces: IntArray
    is_fixed: BoolArray
    lines: IntArray
    arcs: FloatArray
    curves: Curves


@dataclass(frozen=True)
class Edges:
    """Edges of triangles.

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
    line_edges : (n,) int array
        The edges of `Triangles.lines`.
    is_rim, is_line : (E,) bool array
        Edges on the boundary; on the boundary or a crease.
    is_rim_vertex, is_line_vertex : (V,) bool array
        Vertices of such edges.
    """

    ends: IntArray
    keys: IntArray
    halves: IntArray
    corner_edges: IntArray
    line_edges: IntArray
    is_rim: BoolArray
    is_line: BoolArray
    is_rim_vertex: BoolArray
    is_line_vertex: BoolArray


def to_be_edited(
    vertices: FloatArray, faces: IntArray, is_fixed: BoolArray, lines: IntArray
) -> Triangles:
    """Triangles with their lines as curves; one without a corner gets a fixed vertex.

    Parameters
    ----------
    vertices : (V, 3) float array
        Points.
    faces : (T, 3) int array
        Vertices of each triangle.
    is_fixed : (V,) bool array
        Vertices that stay in place: at least those where lines end or meet.
    lines : (n, 2) int array
        Vertices of the edges on the boundary and on creases.
    """
    is_fixed = is_fixed.copy()
    is_fixed[loop_starts(lines, is_fixed)] = True
    curves, arcs = trace_curves(vertices, lines, is_fixed)
    return Triangles(vertices, faces, is_fixed, lines, arcs, curves)


def find_edges(triangles: Triangles) -> Edges:
    """Edges of triangles, by one sort of the half-edges: the edges."""
    faces, count = triangles.faces, len(triangles.vertices)
    ends = np.stack([faces.ravel(), np.roll(faces, -1, axis=1).ravel()], 1)
    keys, first, ids = np.unique(pair_keys(ends, count), return_index=True, return_inverse=True)
    others = np.ones(len(ends), bool)
    others[first] = False
    second = np.full(len(first), -1, np.int64)
    second[ids[others]] = np.flatnonzero(others)
    ends = ends[first]
    is_rim = second < 0
    line_edges = np.searchsorted(keys, pair_keys(triangles.lines, count)).astype(np.int64)
    is_line = is_rim.copy()
    is_line[line_edges] = True
    is_rim_vertex, is_line_vertex = np.zeros((2, count), bool)
    is_rim_vertex[ends[is_rim]] = True
    is_line_vertex[ends[is_line]] = True
    halves = np.stack([first, second], 1).astype(np.int64)
    corner_edges = ids.reshape(-1, 3).astype(np.int64)
    return Edges(
        ends,
        keys,
        halves,
        corner_edges,
        line_edges,
        is_rim,
        is_line,
        is_rim_vertex,
        is_line_vertex,
    )


def pair_keys(pairs: IntArray, count: int) -> IntArray:
    """A number for each unordered pair of vertices.

    Parameters
    ----------
    pairs : (n, 2) int array

    Returns
    -------
    (n,) int array
        Numbers.
    """
    return pairs.min(axis=1) * count + pairs.max(axis=1)


def edge_lengths(triangles: Triangles, edges: Edges) -> FloatArray:
    """Lengths of edges.

    Returns
    -------
    (E,) float array
        Lengths.
    """
    return norm(triangles.vertices[edges.ends[:, 1]] - triangles.vertices[edges.ends[:, 0]])


def exceeds(values: FloatArray | float, bounds: FloatArray | float) -> BoolArray:
    """Whether values are larger by more than rounding, so that equal is equal on any machine.

    Parameters
    ----------
    values, bounds : (...) float array
        Lengths in edges wanted, or ratios.

    Returns
    -------
    (...) bool array
        Whether they are.
    """
    return np.asarray(values - bounds) > SAME_LENGTH


def triangle_normals(corners: FloatArray) -> FloatArray:
    """Cross products of two sides: normals of twice the area of the triangles.

    Parameters
    ----------
    corners : (..., 3, 3) float array

    Returns
    -------
    (..., 3) float array
        Vectors.
    """
    sides = corners[..., 1:, :] - corners[..., :1, :]
    return np.cross(sides[..., 0, :], sides[..., 1, :])


def thickness(corners: FloatArray) -> FloatArray:
    """Height of triangles over their longest side, relative to it.

    Parameters
    ----------
    corners : (..., 3, 3) float array

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
