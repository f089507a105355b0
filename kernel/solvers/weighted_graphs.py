"""Pieces of graphs, and weighted graphs that every version of scipy walks."""

import numpy as np

from ..arrays import FloatArray, IntArray
from .factorization import SparseArray


def weighted_graph(
    weights: FloatArray, tails: IntArray, heads: IntArray, count: int
) -> SparseArray:
    """The graph with these edges (E,); weights, not 0, of equal edges add up.

    Its indices have 32 bits: spanning trees and shortest paths of scipy before 1.17.1 take no
    others.
    """
    from scipy.sparse import csr_array

    ends = tails.astype(np.int32), heads.astype(np.int32)
    graph: SparseArray = csr_array((weights, ends), shape=(count, count))
    return graph


def piece_labels(tails: IntArray, heads: IntArray, count: int) -> IntArray:
    """Connected piece of each of `count` vertices, numbered by their first vertices."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(tails)), (tails, heads)), shape=(count, count))
    labels: IntArray = np.asarray(connected_components(graph, directed=False)[1], np.int64)
    return labels
