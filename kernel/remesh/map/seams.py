"""How coordinates of the faces are tied across the seams of a cut mesh.

Along a seam the coordinates of one face are those of the other with a sign and a shift:
``w' = s w + T``. Around a vertex the shifts must add up. On the graph of the seams this is a
law of conservation, so a spanning tree of that graph leaves few shifts free, those of handles
and holes. Together with the places of the singular vertices they are the integers of a seamless
map, and all other shifts are whole-number combinations of them.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray, IntArray
from ...meshes.topology import previous_corners
from ...meshes.vertex_fans import VertexFans
from ...solvers.factorization import SparseArray, factorize
from ..field.congruence_mesh import CongruenceMesh
from ..field.frames import CombedFrames, fan_signs


@dataclass(frozen=True)
class Seams:
    """Coordinates at the corners in terms of those at the vertices and of integers.

    A coordinate w at corner c of vertex v is ``signs[c] w_v + shifts[c] @ z``: w_v its value in
    the face of the vertex's first corner, z the integers, first those of the singular vertices.

    Attributes
    ----------
    signs : (H,) float array
        1 or -1.
    shifts : (H, m) sparse array
        Whole numbers.
    singular : (s,) int array
        Vertices whose coordinates are the first s integers.
    relations : (r, m) float array
        Combinations of the integers that must vanish.
    is_free : bool
        Whether adding a constant to all coordinates changes no shift.
    """

    signs: FloatArray
    shifts: SparseArray
    singular: IntArray
    relations: FloatArray
    is_free: bool


def find_seams(surface: CongruenceMesh, fans: VertexFans, frames: CombedFrames) -> Seams:
    """Solve the conservation of shifts around all vertices: the integers of the map."""
    from scipy.sparse import csr_array

    topology = surface.topology
    crossed = previous_corners(topology)
    signs = fan_signs(fans, frames.signs[crossed])
    after = signs * frames.signs[crossed]
    singular = np.flatnonzero(frames.indices)
    edges, edge_ends, edge_sides = _seam_edges(surface, frames)
    # Shifts seen from the first corner of the vertex: their sum around it is conserved.
    used = np.flatnonzero(edges[crossed] >= 0)
    entries = after[used] * edge_sides[crossed[used]]
    steps = csr_array(
        (entries, (used, edges[crossed[used]])), shape=(len(edges), len(edge_ends))
    )
    root, parents = _spanning_tree(surface, fans, edge_ends, singular)
    flows, relations = _conserve(surface, fans, after, steps, (root, parents), singular)
    shifts = _corner_shifts(fans, signs, steps, flows)
    is_free = len(singular) == 0 and bool((frames.signs > 0).all())
    return Seams(signs, shifts, singular, relations, is_free)


def _seam_edges(
    surface: CongruenceMesh, frames: CombedFrames
) -> tuple[IntArray, IntArray, FloatArray]:
    """Seam edge of each half-edge or -1, ends of each (n, 2), factor of its shift (H,)."""
    topology = surface.topology
    is_seam = frames.is_seam[topology.edge_corners]
    one = topology.edge_corners[is_seam]
    other = topology.twins[one]
    edges = np.full(len(topology.twins), -1)
    edges[one] = edges[other] = np.arange(len(one))
    factors = np.ones(len(topology.twins))
    factors[other] = -frames.signs[one]
    return edges, topology.edge_vertices[is_seam], factors


def _spanning_tree(
    surface: CongruenceMesh, fans: VertexFans, ends: IntArray, singular: IntArray
) -> tuple[int, IntArray]:
    """Root (V for the boundary) and the seam edge to the parent of each vertex, or -1."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order

    count = len(surface.points)
    rim = np.flatnonzero(~fans.is_closed)
    root = count if len(rim) else int(singular[0]) if len(singular) else 0
    tails = np.concatenate([ends[:, 0], rim])
    heads = np.concatenate([ends[:, 1], np.full(len(rim), count)])
    shape = (count + 1, count + 1)
    graph = csr_array((np.ones(len(tails)), (tails, heads)), shape=shape)
    _, parents = breadth_first_order(graph, root, directed=False)
    result = np.full(count, -1)
    for side in (0, 1):
        children = ends[:, side]
        is_parent = parents[children] == ends[:, 1 - side]
        result[children[is_parent]] = np.flatnonzero(is_parent)
    return root, result


def _conserve(
    surface: CongruenceMesh,
    fans: VertexFans,
    after: FloatArray,
    steps: SparseArray,
    tree: tuple[int, IntArray],
    singular: IntArray,
) -> tuple[SparseArray, FloatArray]:
    """Shifts of the seam edges (n, m) by the integers, and relations between these (r, m)."""
    from scipy.sparse import csr_array, hstack

    (root, parents), count = tree, len(surface.points)
    corners = np.arange(len(after))
    vertices = surface.triangles.ravel()
    sums = csr_array((np.ones(len(corners)), (vertices, corners)), shape=(count, len(corners)))
    balance = (sums @ steps).tocsc()
    # A coordinate that returns with the other sign after a turn, w' = -w + T, is T / 2.
    closing = after[fans.corners[fans.offsets[1:] - 1]]
    places = csr_array(
        (closing[singular] - 1, (singular, np.arange(len(singular)))),
        shape=(count, len(singular)),
    )
    inner = np.flatnonzero(fans.is_closed)
    rows = inner[inner != root]
    tree_edges = parents[rows]
    is_loop = np.ones(steps.shape[1], bool)
    is_loop[tree_edges] = False
    right = hstack([places, -balance[:, np.flatnonzero(is_loop)]]).tocsc()
    solve = factorize(balance[rows][:, tree_edges])
    flows = np.zeros((steps.shape[1], right.shape[1]))
    flows[tree_edges] = np.rint(solve(right[rows].toarray()))
    flows[is_loop, len(singular) :] = np.eye(int(is_loop.sum()))
    relations = np.zeros((0, right.shape[1]))
    if root < count:
        relation = balance[[root]] @ flows
        relation[:, : len(singular)] -= places[[root]].toarray()
        relations = np.rint(relation)
    return csr_array(flows), relations[(relations != 0).any(axis=1)]


def _corner_shifts(
    fans: VertexFans, signs: FloatArray, steps: SparseArray, flows: SparseArray
) -> SparseArray:
    """Shift of each corner against the first of its fan, (H, m)."""
    from scipy.sparse import csr_array

    moves = (steps @ flows).tocsr()
    moves.eliminate_zeros()
    vertices = np.repeat(np.arange(len(fans.is_closed)), np.diff(fans.offsets))
    is_moved = np.zeros(len(fans.is_closed), bool)
    is_moved[vertices[np.diff(moves.indptr)[fans.corners] > 0]] = True
    places = np.flatnonzero(is_moved[vertices])
    corners = fans.corners[places]
    dense = moves[corners].toarray()
    before = np.cumsum(dense, axis=0) - dense
    starts = np.searchsorted(places, fans.offsets[:-1][vertices[places]])
    values = signs[corners, None] * (before - before[starts])
    rows, columns = np.nonzero(values)
    return csr_array((values[rows, columns], (corners[rows], columns)), shape=moves.shape)
