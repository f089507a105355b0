"""From the cells of a net to a mesh without slivers along its boundary."""

from typing import NamedTuple

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, norm, sum_by
from ...errors import InputError
from ...meshes.mesh import Mesh, with_vertices
from ...solvers.weighted_graphs import piece_labels
from .extraction import Net

SHORT = 0.4
"""Edges at the boundary below this length, in edge lengths, are contracted."""

WIDEST = 0.9
"""Holes of a larger radius, in edge lengths, are not contracted."""

NEAREST = 0.35
"""Nodes inside that an edge below this length joins, in edge lengths, are moved apart."""

SPREADS = 30
"""Rounds of moving them."""


class NetMesh(NamedTuple):
    """The mesh of a net.

    Attributes
    ----------
    is_node : (V,) bool array
        Vertices where two lines cross inside the surface.
    n_contracted : int
        Edges at the boundary that were too short to keep.
    n_digons : int
        Cells of two corners, around lemon singularities, that became edges.
    n_slivers : int
        Cells at the boundary that were lost: with a contracted edge, or since they had but two
        corners.
    """

    mesh: Mesh
    is_node: BoolArray
    n_contracted: int
    n_digons: int
    n_slivers: int


def net_mesh(net: Net, edge_length: float) -> NetMesh:
    """Build the mesh of a net with steps of a given length.

    Where contracting the short edges would pinch the mesh they are kept.

    Raises
    ------
    InputError
        If the cells form no mesh, since they are too large for the surface.
    """
    merged = _merge_short_edges(net, edge_length)
    try:
        return _spread(_build(net, merged), NEAREST * edge_length)
    except InputError:
        pass
    try:
        return _spread(_build(net, np.arange(len(net.points))), NEAREST * edge_length)
    except InputError as error:
        raise InputError(
            "the edge length is too large for the surface: faces of the net would touch "
            f"themselves ({error}); choose a smaller one"
        ) from error


def _merge_short_edges(net: Net, edge_length: float) -> IntArray:
    """For each point the one that stands for it."""
    count = len(net.points)
    tails, heads = net.corners, net.corners[_following(net.offsets)]
    is_short = norm(net.points[tails] - net.points[heads]) < SHORT * edge_length
    is_short &= (tails >= net.n_nodes) | (heads >= net.n_nodes)
    clusters = piece_labels(tails[is_short], heads[is_short], count)
    # A hole at which lines crowd stays open.
    is_wide = _widths(net.points, clusters) > WIDEST * edge_length
    stays = is_wide[clusters] & _closes_hole(net, clusters)[clusters]
    clusters[stays] = count + np.flatnonzero(stays)
    clusters = np.unique(clusters, return_inverse=True)[1]
    # A corner of the boundary stands for its cluster, else a point of the boundary.
    standing = np.concatenate([np.zeros(net.n_nodes), 1.0 + net.is_corner])
    order = np.lexsort((np.arange(count), -standing, clusters))
    first = np.unique(clusters[order], return_index=True)[1]
    return order[first][clusters]


def _closes_hole(net: Net, clusters: IntArray) -> BoolArray:
    """Whether each cluster holds all points of a line of the boundary."""
    count, ends = len(net.points), (net.corners, net.corners[_following(net.offsets)])
    on_rim = (ends[0] >= net.n_nodes) & (ends[1] >= net.n_nodes)
    lines = piece_labels(ends[0][on_rim], ends[1][on_rim], count)[net.n_nodes :]
    low, high = np.full(count, count), np.full(count, -1)
    np.minimum.at(low, lines, clusters[net.n_nodes :])
    np.maximum.at(high, lines, clusters[net.n_nodes :])
    result = np.zeros(count, np.bool_)
    result[low[low == high]] = True
    return result


def _widths(points: FloatArray, clusters: IntArray) -> FloatArray:
    """Largest distance of a point of each cluster from their mean."""
    sizes = np.bincount(clusters)
    means = sum_by(clusters, points, len(sizes)) / sizes[:, None]
    widths = np.zeros(len(sizes))
    np.maximum.at(widths, clusters, norm(points - means[clusters]))
    return widths


def _build(net: Net, merged: IntArray) -> NetMesh:
    corners = merged[net.corners]
    cells = np.repeat(np.arange(len(net.offsets) - 1), np.diff(net.offsets))
    keep = corners != corners[_following(net.offsets)]
    degrees = np.bincount(cells[keep], minlength=len(net.offsets) - 1)
    is_face = degrees >= 3
    keep &= is_face[cells]
    kept, degrees = _without_bends(corners[keep], degrees[is_face])
    used, renumbered = np.unique(kept, return_inverse=True)
    faces = np.split(renumbered, np.cumsum(degrees)[:-1])
    mesh = Mesh(_places(net, merged)[used], faces)
    # A line that grazes the boundary cuts off cells of two corners as well.
    reaches = np.bincount(cells, net.corners >= net.n_nodes, len(is_face)) > 0
    is_digon = (np.diff(net.offsets) == 2) & ~reaches
    is_inner = used < net.n_nodes
    return NetMesh(
        mesh, is_inner, int((merged != np.arange(len(merged))).sum()), int(is_digon.sum()),
        int((~is_face & ~is_digon).sum()),
    )  # fmt: skip


def _spread(built: NetMesh, least: float) -> NetMesh:
    """Move nodes apart that are too near: lines crowd around singular points.

    Nodes at the ends of very short edges fall into one when they become planar.
    """
    mesh, topology = built.mesh, built.mesh.topology
    tails, heads = mesh.corners, mesh.corners[topology.next_corners]
    once = (tails < heads) | (topology.twins < 0)
    tails, heads = tails[once], heads[once]
    points, free = mesh.vertices.copy(), built.is_node
    for _ in range(SPREADS):
        sides = points[heads] - points[tails]
        lengths = norm(sides)
        is_short = (lengths < least) & (lengths > 0) & (free[tails] | free[heads])
        if not is_short.any():
            break
        push = ((least / lengths[is_short] - 1) / 2)[:, None] * sides[is_short]
        moves = sum_by(heads[is_short], push, len(points))
        moves -= sum_by(tails[is_short], push, len(points))
        points[free] += moves[free]
    return built._replace(mesh=with_vertices(mesh, points))


def _without_bends(corners: IntArray, degrees: IntArray) -> tuple[IntArray, IntArray]:
    """Corners and degrees of faces, without vertices at which two faces share both edges.

    Where slivers beside a node were lost, it only bends the edge of two faces. It stays if one
    of them has no corner to spare.
    """
    faces = np.repeat(np.arange(len(degrees)), degrees)
    following = _following(np.concatenate([[0], np.cumsum(degrees)]))
    after, before = corners[following], np.empty_like(corners)
    before[following] = corners
    order = np.argsort(corners, kind="stable")
    starts = np.flatnonzero(np.diff(corners[order], prepend=-1))
    pairs = starts[np.diff(starts, append=len(order)) == 2]
    first, second = order[pairs], order[pairs + 1]
    bends = (after[first] == before[second]) & (before[first] == after[second])
    ends = np.stack([first, second], axis=1)[bends]
    spare = degrees - np.bincount(faces[ends.ravel()], minlength=len(degrees)) >= 3
    dropped = ends[spare[faces[ends]].all(axis=1)].ravel()
    lost = np.bincount(faces[dropped], minlength=len(degrees))
    return np.delete(corners, dropped), degrees - lost


def _places(net: Net, merged: IntArray) -> FloatArray:
    """Corners stay where they are; other clusters lie in the middle of their rim points."""
    count = len(net.points)
    weights = np.concatenate([np.zeros(net.n_nodes), np.ones(count - net.n_nodes)])
    total = sum_by(merged, weights, count)
    means = sum_by(merged, weights[:, None] * net.points, count)
    is_corner = np.concatenate([np.zeros(net.n_nodes, bool), net.is_corner])
    is_mean = (total > 0) & ~is_corner
    result = net.points.copy()
    result[is_mean] = means[is_mean] / total[is_mean, None]
    return result


def _following(offsets: IntArray) -> IntArray:
    """The next place in each group, the first after the last."""
    result = np.arange(1, int(offsets[-1]) + 1)
    result[offsets[1:] - 1] = offsets[:-1]
    return result
