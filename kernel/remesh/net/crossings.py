"""Where the lines of a seamless map cross the edges of the triangles, and each other.

Lines are the places where a coordinate is a whole number and a half. Everything that decides
about connectivity is taken from whole numbers and from one order of the crossings along each
edge, so both faces of an edge and all lines in a face agree.
"""

from typing import NamedTuple

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...errors import ConvergenceError
from ...meshes.vertex_fans import VertexFans
from ...tolerances import LATTICE_TIE
from ..field.congruence_mesh import CongruenceMesh
from ..map.injectivity import ChartGradients


class EdgeCrossings(NamedTuple):
    """Crossings of lines with edges, in order along each edge.

    Attributes
    ----------
    half_edges : (n,) int array
        Half-edge in whose chart and direction the crossing is given.
    families : (n,) int array
        0 where u is constant, 1 where v is.
    levels : (n,) int array
        The line is at ``level + 1/2``.
    shares : (n,) float array
        Place along the half-edge, from 0 to 1.
    ranks : (n,) int array
        Number of crossings before on the same edge.
    counts : (H,) int array
        Crossings on the half-edge; 0 for those whose twin has them.
    """

    half_edges: IntArray
    families: IntArray
    levels: IntArray
    shares: FloatArray
    ranks: IntArray
    counts: IntArray


class Segments(NamedTuple):
    """Pieces of lines in faces, from the lower to the higher value of the other coordinate.

    Attributes
    ----------
    faces : (n,) int array
        Face of each piece.
    families, levels : (n,) int array
        Which line.
    ends : (n, 2) int array
        Crossings at the two ends.
    places : (n, 2) int array
        Order of the two ends around the face.
    """

    faces: IntArray
    families: IntArray
    levels: IntArray
    ends: IntArray
    places: IntArray


class Meetings(NamedTuple):
    """Points in which two lines cross within a face.

    Attributes
    ----------
    u_segments, v_segments : (n,) int array
        The two pieces.
    weights : (n, 3) float array
        Barycentric coordinates in the face.
    """

    u_segments: IntArray
    v_segments: IntArray
    weights: FloatArray


def corner_coordinates(
    fans: VertexFans, charts: ChartGradients, values: FloatArray
) -> FloatArray:
    """Coordinates (H, 2) of the corners, from those of the vertices, with no vertex on a line.

    Vertices that lie on a line are moved off it, towards the inside on the boundary.
    """
    from_line = values - 0.5
    is_tie = np.abs(from_line - np.rint(from_line)) < LATTICE_TIE
    corners = charts.corner_values(values)
    first_faces = fans.corners[fans.offsets[:-1]] // 3
    inside = corners.reshape(-1, 3, 2).mean(axis=1)[first_faces]
    side = np.where(inside >= values, 1.0, -1.0)
    return charts.corner_values(values + np.where(is_tie, 2 * LATTICE_TIE * side, 0.0))


def edge_crossings(surface: CongruenceMesh, corners: FloatArray) -> EdgeCrossings:
    """Find the crossings of all edges with the lines; one half-edge of each edge has them.

    No corner (H, 2) lies on a line.
    """
    topology = surface.topology
    edges = np.concatenate([topology.edge_corners, np.flatnonzero(topology.twins < 0)])
    starts, ends = corners[edges], corners[topology.next_corners[edges]]
    first = np.ceil(np.minimum(starts, ends) - 0.5).astype(np.int64)
    counts = np.floor(np.maximum(starts, ends) - 0.5).astype(np.int64) - first + 1
    total = counts.ravel()
    slots = np.repeat(np.arange(len(total)), total)
    steps = np.arange(len(slots)) - np.repeat(np.cumsum(total) - total, total)
    places, families = slots // 2, slots % 2
    levels = first.ravel()[slots] + steps
    start, end = starts.ravel()[slots], ends.ravel()[slots]
    shares = (levels + 0.5 - start) / (end - start)
    order = np.lexsort((families, shares, places))
    places = places[order]
    on_edge = np.bincount(places, minlength=len(edges))
    ranks = np.arange(len(places)) - (np.cumsum(on_edge) - on_edge)[places]
    per_half_edge = np.zeros(len(corners), np.int64)
    per_half_edge[edges] = on_edge
    return EdgeCrossings(
        edges[places], families[order], levels[order], shares[order], ranks, per_half_edge
    )


def face_segments(
    surface: CongruenceMesh, corners: FloatArray, signs: FloatArray, crossings: EdgeCrossings
) -> Segments:
    """Join the crossings around each face to pieces of lines.

    No corner (H, 2) lies on a line; `signs` (H,) are those between the charts on both sides of
    each half-edge.

    Raises
    ------
    ConvergenceError
        If the lines do not match across an edge.
    """
    topology, one = surface.topology, crossings.half_edges
    other = topology.twins[one]
    inner = np.flatnonzero(other >= 0)
    here, there = one[inner], other[inner]
    family = crossings.families[inner]
    shift = corners[topology.next_corners[there], family] - signs[here] * corners[here, family]
    beyond = np.rint(signs[here] * (crossings.levels[inner] + 0.5) + shift - 0.5)
    last = crossings.counts[here] - 1
    sides = np.concatenate([one, there])
    ids = np.concatenate([np.arange(len(one)), inner])
    families = np.concatenate([crossings.families, family])
    levels = np.concatenate([crossings.levels, beyond.astype(np.int64)])
    ranks = np.concatenate([crossings.ranks, last - crossings.ranks[inner]])
    shares = np.concatenate([crossings.shares, 1 - crossings.shares[inner]])
    places = sides * (int(crossings.counts.max(initial=0)) + 1) + ranks
    start, end = (
        corners[sides, 1 - families],
        corners[topology.next_corners[sides], 1 - families],
    )
    heights = start + shares * (end - start)
    order = np.lexsort((heights, levels, families, sides // 3))
    key = np.stack([sides // 3, families, levels], 1)[order]
    if (
        len(order) % 2
        or (key[::2] != key[1::2]).any()
        or (key[1:-1:2] == key[2::2]).all(1).any()
    ):
        raise ConvergenceError(
            "the lines of the map do not match across the edges of the mesh: refine the mesh "
            "or choose another edge length"
        )
    pairs = order.reshape(-1, 2)
    faces, families, levels = key[::2].T
    return Segments(faces, families, levels, ids[pairs], places[pairs])


def face_meetings(
    corners: FloatArray, segments: Segments, is_flipped: BoolArray
) -> tuple[Meetings, BoolArray]:
    """Cross the u lines with the v lines in every face: the nodes, and which are mirrored.

    `is_flipped` (F,) tells the faces that the map turns over; their nodes are mirrored.
    """
    u_ids, v_ids = np.flatnonzero(segments.families == 0), np.flatnonzero(segments.families)
    starts = np.searchsorted(segments.faces[v_ids], segments.faces[u_ids])
    counts = np.searchsorted(segments.faces[v_ids], segments.faces[u_ids], "right") - starts
    first = np.repeat(u_ids, counts)
    steps = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    second = v_ids[np.repeat(starts, counts) + steps]
    low, high = np.sort(segments.places[first], axis=1).T
    ends = segments.places[second]
    is_between = (ends > low[:, None]) & (ends < high[:, None])
    crosses = is_between[:, 0] != is_between[:, 1]
    first, second = first[crosses], second[crosses]
    faces = segments.faces[first]
    triangle = corners.reshape(-1, 3, 2)[faces]
    sides = np.stack([triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]], 2)
    target = np.stack([segments.levels[first], segments.levels[second]], 1) + 0.5
    det = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    x, y = (target - triangle[:, 0]).T
    b = (x * sides[:, 1, 1] - y * sides[:, 0, 1]) / det
    c = (y * sides[:, 0, 0] - x * sides[:, 1, 0]) / det
    weights = np.clip(np.stack([1 - b - c, b, c], 1), 0, 1)
    weights /= weights.sum(axis=1, keepdims=True)
    return Meetings(first, second, weights), is_flipped[faces]
