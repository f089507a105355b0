"""Weighted graphs as sparse matrices that every version of scipy walks."""

import numpy as np

from ..arrays import FloatArray, IntArray
from .factorization import SparseArray


def weighted_graph(
    weights: FloatArray, tails: IntArray, heads: IntArray, count: int
) -> SparseArray:
    """The graph with these edges; weights of equal edges add up.

    Parameters
    ----------
    weights : (E,) float array
        Weight of each edge, not 0.
    tails, heads : (E,) int array
        The vertices that it joins.
    count : int
        Number of vertices.

    Returns
    -------
    (count, count) csr_array
        With indices of 32 bits: spanning trees and shortest paths of scipy before 1.17.1 take
        no others.
    """
    from scipy.sparse import csr_array

    ends = tails.astype(np.int32), heads.astype(np.int32)
    graph: SparseArray = csr_array((weights, ends), shape=(count, count))
    return graph
