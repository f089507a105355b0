"""Nested dissection: an order of elimination that fills in little.

A set of elements is halved across its longest side; the elements of one half that touch the
other separate them, and are eliminated after both. The halves are halved again. Where elements
lie is enough to find good halves; a graph partition would find none better on a surface.
"""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray

SMALLEST_SET = 40
"""Sets of so few elements are not halved: dense algebra is faster on them."""


def dissect(points: FloatArray, pairs: IntArray) -> IntArray:
    """Place of each element in a binary tree of separators.

    Parameters
    ----------
    points : (n, d) float array
        Where the elements are.
    pairs : (m, 2) int array
        Elements that touch.

    Returns
    -------
    (n,) int array
        Node of the tree: 1 the root, 2 k and 2 k + 1 the children of k. Elements that touch
        share a node, or the node of one is an ancestor of that of the other.

    References
    ----------
    George 1973, Nested dissection of a regular finite element mesh.
    """
    nodes = np.ones(len(points), np.int64)
    is_open = np.ones(len(points), bool)
    while True:
        ids = np.flatnonzero(is_open)
        _, sets, counts = np.unique(nodes[ids], return_inverse=True, return_counts=True)
        is_open[ids[counts[sets] <= SMALLEST_SET]] = False
        ids = np.flatnonzero(is_open)
        if not len(ids):
            return nodes
        _, sets, counts = np.unique(nodes[ids], return_inverse=True, return_counts=True)
        is_second = np.zeros(len(points), bool)
        is_second[ids] = _second_half(points[ids], sets, counts)
        pairs = pairs[
            (nodes[pairs[:, 0]] == nodes[pairs[:, 1]])
            & is_open[pairs[:, 0]]
            & is_open[pairs[:, 1]]
        ]
        places = np.zeros(len(points), np.int64)
        places[ids] = sets
        separates = _separators(pairs, is_second, places, len(counts))
        is_open[separates] = False
        rest = ids[~separates[ids]]
        nodes[rest] = 2 * nodes[rest] + is_second[rest]


def _second_half(points: FloatArray, sets: IntArray, counts: IntArray) -> BoolArray:
    """Elements beyond the middle of their set along its longest side."""
    starts = np.cumsum(counts) - counts
    by_set = points[np.argsort(sets, kind="stable")]
    extents = np.maximum.reduceat(by_set, starts) - np.minimum.reduceat(by_set, starts)
    # Columns from the longest side to the shortest: rows of equal elements are cut straight.
    axes = np.argsort(-extents, axis=1, kind="stable")[sets]
    sorted_points = np.take_along_axis(points, axes, axis=1)
    order = np.lexsort((*sorted_points.T[::-1], sets))
    ranks = np.empty(len(points), np.int64)
    ranks[order] = np.arange(len(points)) - np.repeat(starts, counts)
    return ranks >= (counts // 2)[sets]


def _separators(
    pairs: IntArray, is_second: BoolArray, sets: IntArray, n_sets: int
) -> BoolArray:
    """Of each set, the elements of the half with fewer that touch the other half."""
    cut = pairs[is_second[pairs[:, 0]] != is_second[pairs[:, 1]]]
    touches = np.zeros(len(is_second), bool)
    touches[cut] = True
    ids = np.flatnonzero(touches)
    seconds = np.bincount(sets[ids], is_second[ids], n_sets)
    firsts = np.bincount(sets[ids], ~is_second[ids], n_sets)
    touches[ids] = is_second[ids] == (seconds < firsts)[sets[ids]]
    return touches
