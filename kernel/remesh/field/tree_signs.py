"""Signs under which neighbours are alike."""

import numpy as np

from ...arrays import FloatArray
from ...solvers.factorization import SparseArray
from ...solvers.weighted_graphs import weighted_graph


def tree_signs(likeness: SparseArray) -> FloatArray:
    """Choose signs (n,), 1 or -1, along a spanning tree of a graph.

    `likeness` (n, n) says how alike neighbours are, between -1 and 1, stored for all edges, one
    way or both. The tree prefers the edges on which the sign is clearest.
    """
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    edges, signs = likeness.tocoo(), likeness.copy()
    signs.data = np.sign(likeness.data)
    tails, heads = edges.coords
    clarity = np.minimum(np.abs(edges.data), 1.0)
    costs = weighted_graph(2.0 - clarity, tails, heads, signs.shape[0])
    order, parents = breadth_first_order(minimum_spanning_tree(costs), 0, directed=False)
    parents = np.where(parents < 0, 0, parents)
    children = np.arange(len(parents))
    along = signs[children, parents] + signs[parents, children]
    result = np.where(np.asarray(along).ravel() < 0, -1.0, 1.0)
    result[order[0]] = 1.0
    # Pointer doubling: the sign of a vertex is the product of the signs on its way to the root.
    while (parents != order[0]).any():
        result, parents = result * result[parents], parents[parents]
    return result * result[order[0]]
