"""Singular vertices close to each other, which shall not fall on the same whole numbers."""

from itertools import pairwise

import numpy as np

from ...arrays import FloatArray, IntArray, norm
from ...solvers.weighted_graphs import weighted_graph
from ..field.congruence_mesh import CongruenceMesh
from .seams import Seams

REACH = 4.0
"""Distance within which two singular vertices may fall together, in steps."""


def singular_differences(
    surface: CongruenceMesh, seams: Seams, edge_length: float
) -> FloatArray:
    """Differences of the coordinates of singular vertices along shortest paths between them.

    (p, m) by the integers of the seams, a row for each pair of neighbours; a unit step is
    `edge_length` mean edges long.
    """
    from scipy.sparse.csgraph import dijkstra

    singular, count = seams.singular, len(surface.points)
    if len(singular) < 2:
        return np.zeros((0, seams.shifts.shape[1]))
    tails, heads = surface.triangles.ravel(), np.roll(surface.triangles, -1, axis=1).ravel()
    lengths = norm(surface.points[heads] - surface.points[tails])
    graph = weighted_graph(lengths, tails, heads, count)
    distances, parents = dijkstra(
        graph, directed=False, indices=singular, limit=REACH * edge_length,
        return_predecessors=True,
    )  # fmt: skip
    pairs = np.argwhere(np.triu(np.isfinite(distances[:, singular]), 1))
    rows = np.zeros((len(pairs), seams.shifts.shape[1]))
    for row, (i, j) in zip(rows, pairs.tolist(), strict=True):
        leaving, arriving = _corners_along(surface, _path(parents[i], int(singular[j])))
        row[:] = _difference(seams, (i, j), leaving, arriving)
    return rows


def _corners_along(surface: CongruenceMesh, path: IntArray) -> tuple[IntArray, IntArray]:
    """Corners at both ends of each step of a path along edges, in one face of the edge."""
    tails, heads = surface.triangles.ravel(), np.roll(surface.triangles, -1, axis=1).ravel()
    following = surface.topology.next_corners
    leaving, arriving = np.empty((2, len(path) - 1), np.int64)
    for k, (start, end) in enumerate(pairwise(path.tolist())):
        ahead = np.flatnonzero((tails == start) & (heads == end))
        if len(ahead):
            leaving[k], arriving[k] = ahead[0], following[ahead[0]]
        else:
            behind = np.flatnonzero((tails == end) & (heads == start))[0]
            leaving[k], arriving[k] = following[behind], behind
    return leaving, arriving


def _path(parents: IntArray, end: int) -> IntArray:
    """Vertices from the root of a tree to one of its leaves."""
    path = [end]
    while parents[path[-1]] >= 0:
        path.append(int(parents[path[-1]]))
    return np.array(path[::-1])


def _difference(
    seams: Seams, pair: tuple[int, int], leaving: IntArray, arriving: IntArray
) -> FloatArray:
    """Coordinate of the second vertex minus that of the first, in the first one's chart."""
    sign, shift = 1.0, np.zeros(seams.shifts.shape[1])
    out, into = seams.shifts[leaving].toarray(), seams.shifts[arriving].toarray()
    for k in range(len(leaving)):
        there, here = seams.signs[arriving[k]], seams.signs[leaving[k]]
        sign, shift = there * here * sign, there * (here * shift + out[k] - into[k])
    row = -sign * shift
    row[pair[1]] += sign
    row[pair[0]] -= 1
    return row
