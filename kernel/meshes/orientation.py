"""Which faces are to be turned over, so that neighbours run against each other."""

import numpy as np

from ..arrays import BoolArray, IntArray
from ..solvers.weighted_graphs import piece_labels, weighted_graph


def faces_to_flip(
    n_faces: int, links: IntArray, is_aligned: BoolArray
) -> tuple[BoolArray, BoolArray]:
    """Choose the faces to turn over: of every piece the fewer.

    Parameters
    ----------
    links : (n, 2) int array
        Faces that share an edge.
    is_aligned : (n,) bool array
        Whether both run along it in the same direction.

    Returns
    -------
    is_flipped : (F,) bool array
        Faces to turn over. Of a piece that is divided into halves those go that disagree with
        its first face.
    is_met : (n,) bool array
        Whether the two faces of a link run against each other then. False only within pieces
        that have one side, such as a Möbius strip: these are consistent along a tree of links.

    Notes
    -----
    The two sides of a face are the nodes of a graph, and links join the sides that agree. Both
    sides of a face are in one component if the piece has one side only.
    """
    front, back = _sides(n_faces, links, is_aligned)
    one_sided = front == back
    if one_sided.any():
        kept = ~one_sided[links[:, 0]]
        kept[_tree(n_faces, links)] = True
        front, back = _sides(n_faces, links[kept], is_aligned[kept])
    pieces = np.minimum(front, back)
    side = front != pieces
    votes = np.bincount(pieces, np.where(side, -1.0, 1.0), 2 * n_faces)
    _, firsts, piece_numbers = np.unique(pieces, return_index=True, return_inverse=True)
    first_side = side[firsts][piece_numbers]
    is_even = votes[pieces] == 0
    is_flipped: BoolArray = side != np.where(is_even, first_side, votes[pieces] < 0)
    is_turned = is_flipped[links[:, 0]] != is_flipped[links[:, 1]]
    return is_flipped, is_turned == is_aligned


def _sides(n_faces: int, links: IntArray, is_aligned: BoolArray) -> tuple[IntArray, IntArray]:
    """Component of the front and of the back of every face."""
    left, right = links.T
    other = np.where(is_aligned, n_faces, 0)
    rows = np.concatenate([left, left + n_faces])
    columns = np.concatenate([right + other, right + n_faces - other])
    labels = piece_labels(rows, columns, 2 * n_faces)
    return labels[:n_faces], labels[n_faces:]


def _tree(n_faces: int, links: IntArray) -> IntArray:
    """Links of a spanning tree of every piece."""
    from scipy.sparse.csgraph import minimum_spanning_tree

    # Of several links of two faces the first counts; numbers from 1 are weights.
    low, high = np.sort(links, axis=1).T
    _, firsts = np.unique(low * n_faces + high, return_index=True)
    firsts = firsts[low[firsts] != high[firsts]]
    graph = weighted_graph((firsts + 1).astype(np.float64), low[firsts], high[firsts], n_faces)
    return np.asarray(minimum_spanning_tree(graph).data, np.int64) - 1
