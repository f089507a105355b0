"""Boundary and creases of a surface as curves by arc length, which edits of triangles keep to.

All curves are laid along one axis. A vertex on a line is a place on the axis, an edge of it an
interval, and the intervals cover each curve once: how far the edges leave the curve is exact,
and no vertex changes to a curve that comes close.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..solvers.weighted_graphs import piece_labels, weighted_graph


@dataclass(frozen=True)
class Curves:
    """Polylines laid along one axis, with gaps between them.

    Attributes
    ----------
    arcs : (k,) float array
        Places of the points on the axis, rising: arc length along their polyline.
    points : (k, 3) float array
        The points.
    """

    arcs: FloatArray
    points: FloatArray

    def at(self, arcs: FloatArray) -> FloatArray:
        """Points of the curves.

        Parameters
        ----------
        arcs : (n,) float array
            Places on the axis.

        Returns
        -------
        (n, 3) float array
            Points.
        """
        if not len(arcs):
            return np.zeros((0, 3))
        result = np.empty((len(arcs), 3))
        for axis in range(3):
            result[:, axis] = np.interp(arcs, self.arcs, self.points[:, axis])
        return result

    def deviations(self, chords: FloatArray, arcs: FloatArray) -> FloatArray:
        """How far curves leave chords that cover each of them once.

        Parameters
        ----------
        chords : (n, 2, 3) float array
            Ends of the chords, on the curves.
        arcs : (n, 2) float array
            Places of the ends on the axis.

        Returns
        -------
        (n,) float array
            Largest distance of the interval of a curve from its chord.
        """
        result = np.zeros(len(chords))
        if not len(chords):
            return result
        order = np.argsort(arcs.min(axis=1))
        places = np.searchsorted(arcs.min(axis=1)[order], self.arcs, side="right") - 1
        # Distance to a chord is convex along a segment: corners of the curve are the farthest.
        owners = order[np.maximum(places, 0)]
        start, along = chords[owners, 0], chords[owners, 1] - chords[owners, 0]
        arm, squared = self.points - start, dot(along, along)
        zero = np.zeros_like(squared)
        share = np.divide(dot(arm, along), squared, out=zero, where=squared > 0)
        distances = norm(arm - np.clip(share, 0, 1)[:, None] * along)
        np.maximum.at(result, owners, distances)
        return result


def loop_starts(lines: IntArray, is_fixed: BoolArray) -> IntArray:
    """First vertices of the lines that close without a fixed vertex.

    Parameters
    ----------
    lines : (n, 2) int array
        Ends of the edges on lines.
    is_fixed : (V,) bool array
        Fixed vertices.

    Returns
    -------
    (m,) int array
        One vertex of each.
    """
    labels = piece_labels(lines[:, 0], lines[:, 1], len(is_fixed))
    used = np.unique(lines)
    names, first = np.unique(labels[used], return_index=True)
    return used[first[~np.isin(names, labels[is_fixed])]]


def trace_curves(
    vertices: FloatArray, lines: IntArray, is_fixed: BoolArray
) -> tuple[Curves, FloatArray]:
    """Curves between the fixed vertices of lines.

    Parameters
    ----------
    vertices : (V, 3) float array
        Points.
    lines : (n, 2) int array
        Ends of the edges on lines. Vertices that are not fixed have two edges or none, and no
        line closes without a fixed vertex.
    is_fixed : (V,) bool array
        Vertices at which curves end.

    Returns
    -------
    curves : Curves
        The curves.
    arcs : (n, 2) float array
        Places of the ends of the edges.
    """
    from scipy.sparse.csgraph import dijkstra

    if not len(lines):
        return Curves(np.zeros(0), np.zeros((0, 3))), np.zeros((0, 2))
    # A fixed vertex becomes one end for each of its edges: only paths are left.
    ids = np.arange(lines.size).reshape(-1, 2)
    names, nodes = np.unique(
        np.where(is_fixed[lines], len(vertices) + ids, lines), return_inverse=True
    )
    nodes, count = nodes.reshape(-1, 2), len(names)
    points = np.empty((count, 3))
    points[nodes] = vertices[lines]
    labels = piece_labels(nodes[:, 0], nodes[:, 1], count)
    is_end = names >= len(vertices)
    starts = np.flatnonzero(is_end)[np.unique(labels[is_end], return_index=True)[1]]
    lengths = norm(np.diff(vertices[lines], axis=1)[:, 0])
    links = weighted_graph(lengths, nodes[:, 0], nodes[:, 1], count)
    arcs = np.asarray(dijkstra(links, directed=False, indices=starts, min_only=True))
    spans = np.zeros(labels.max() + 1)
    np.maximum.at(spans, labels, arcs)
    arcs += (np.cumsum(spans + 1) - spans)[labels]
    order = np.argsort(arcs)
    return Curves(arcs[order], points[order]), arcs[nodes]
