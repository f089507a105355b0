"""The net of a seamless map: lines become edges, their crossings nodes, cells faces.

Every dart of the net has its cell on the left: the four that leave a node, the one that enters
from each boundary point, and the one from each boundary point to the next along the boundary.
"""

from typing import NamedTuple

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...errors import ConvergenceError
from ...meshes.vertex_fans import VertexFans
from ...solvers.weighted_graphs import piece_labels
from ..field.congruence_mesh import CongruenceMesh
from ..field.frames import CombedFrames
from ..map.boundary_alignment import boundary_corners, next_on_boundary
from ..map.parametrization import Parametrization
from .crossings import (
    EdgeCrossings,
    Meetings,
    Segments,
    corner_coordinates,
    edge_crossings,
    face_meetings,
    face_segments,
)


class Net(NamedTuple):
    """Polygons between the lines of a map.

    Attributes
    ----------
    points : (n, 3) float array
        Nodes first, then points of the boundary.
    n_nodes : int
        Number of nodes, where two lines cross.
    corners : (h,) int array
        Points of the cells, cell after cell.
    offsets : (c + 1,) int array
        First corner of each cell, and h.
    is_corner : (n - n_nodes,) bool array
        Points where the boundary itself has a corner.
    """

    points: FloatArray
    n_nodes: int
    corners: IntArray
    offsets: IntArray
    is_corner: BoolArray


class _Rim(NamedTuple):
    """Points of the boundary: crossing or -1, next point along it, and position."""

    crossings: IntArray
    following: IntArray
    points: FloatArray


def extract_net(
    surface: CongruenceMesh, fans: VertexFans, frames: CombedFrames, mapped: Parametrization
) -> Net:
    """Trace the lines at whole numbers and a half, and the cells between them.

    Cells on the boundary are cut by it, with a corner where it has one; cells that have a hole
    inside cover it.

    Raises
    ------
    ConvergenceError
        If lines do not match across edges or end within the surface.
    """
    corners = corner_coordinates(fans, mapped.charts, mapped.values)
    crossings = edge_crossings(surface, corners)
    segments = face_segments(surface, corners, frames.signs, crossings)
    meetings, is_mirrored = face_meetings(corners, segments, mapped.is_flipped)
    n_nodes = len(meetings.u_segments)
    faces = segments.faces[meetings.u_segments]
    triangles = surface.points[surface.triangles[faces]]
    nodes = np.einsum("nc,nci->ni", meetings.weights, triangles)
    partners = _wires(surface, crossings, segments, meetings, is_mirrored)
    rim = _boundary_points(surface, fans, crossings)
    following, origins = _darts(n_nodes, len(crossings.shares), partners, rim)
    order, offsets = _cycles(following)
    points, is_corner = np.concatenate([nodes, rim.points]), rim.crossings < 0
    degrees, on_line = np.diff(offsets), np.concatenate([np.ones(n_nodes, bool), ~is_corner])
    cells = np.repeat(np.arange(len(degrees)), degrees)
    # What no line meets is the inside of a hole: a cell lies around it, which covers it.
    is_cell = np.bincount(cells, on_line[origins[order]], len(degrees)) > 0
    offsets = np.concatenate([[0], np.cumsum(degrees[is_cell])])
    return Net(points, n_nodes, origins[order][is_cell[cells]], offsets, is_corner)


def _wires(
    surface: CongruenceMesh,
    crossings: EdgeCrossings,
    segments: Segments,
    meetings: Meetings,
    is_mirrored: BoolArray,
) -> IntArray:
    """The other end of each wire: of the crossings on the boundary and the ports of the nodes.

    Ids are those of the crossings, then ``4 node + port``; ports 0 to 3 leave along u, v, -u,
    -v, counter-clockwise; -1 for crossings within the surface.
    """
    count, n_nodes = len(crossings.shares), len(meetings.u_segments)
    nodes = count + 4 * np.arange(n_nodes)
    flip = np.where(is_mirrored, 2, 0)
    # Along a piece of a u line v grows: it comes in at port 3 and leaves at port 1.
    knots = np.concatenate(
        [segments.ends[:, 0], segments.ends[:, 1], nodes + (3 + flip) % 4, nodes + 2]
    )
    leaving = np.concatenate(
        [segments.ends[:, 0], segments.ends[:, 1], nodes + (1 + flip) % 4, nodes]
    )
    pieces = np.arange(len(segments.faces))
    on = np.concatenate([pieces, pieces, meetings.u_segments, meetings.v_segments])
    heights = np.concatenate(
        [
            np.full(len(pieces), -np.inf),
            np.full(len(pieces), np.inf),
            segments.levels[meetings.v_segments],
            segments.levels[meetings.u_segments],
        ]
    )
    order = np.lexsort((heights, on))
    tails, heads = leaving[order][:-1], knots[order][1:]
    is_link = on[order][:-1] == on[order][1:]
    size = count + 4 * n_nodes
    wires = piece_labels(tails[is_link], heads[is_link], size)
    is_end = np.ones(size, bool)
    is_end[:count] = surface.topology.twins[crossings.half_edges] < 0
    ends = np.flatnonzero(is_end)
    ends = ends[np.argsort(wires[ends], kind="stable")]
    if len(ends) % 2 or (wires[ends[::2]] != wires[ends[1::2]]).any():
        raise ConvergenceError(
            "lines of the map end within the surface: refine the mesh or choose another edge "
            "length"
        )
    partners = np.full(size, -1)
    partners[ends[::2]], partners[ends[1::2]] = ends[1::2], ends[::2]
    return partners


def _boundary_points(
    surface: CongruenceMesh, fans: VertexFans, crossings: EdgeCrossings
) -> _Rim:
    tails = surface.triangles.ravel()
    following = next_on_boundary(surface, fans)
    is_corner = boundary_corners(surface, following)
    on_rim = np.flatnonzero(following[crossings.half_edges] >= 0)
    sharp = np.flatnonzero((following >= 0) & is_corner[tails])
    ids = np.concatenate([np.full(len(sharp), -1), on_rim])
    sides = np.concatenate([sharp, crossings.half_edges[on_rim]])
    shares = np.concatenate([np.zeros(len(sharp)), crossings.shares[on_rim]])
    ranks = np.concatenate([np.full(len(sharp), -1), crossings.ranks[on_rim]])
    order = np.lexsort((ranks, sides))
    ids, sides, shares = ids[order], sides[order], shares[order]
    start = surface.points[tails[sides]]
    end = surface.points[tails[surface.topology.next_corners[sides]]]
    points = start + shares[:, None] * (end - start)
    first = np.full(len(tails), -1)
    first[sides[::-1]] = np.arange(len(sides))[::-1]
    # Skip half-edges without points by pointer doubling.
    ahead = following.copy()
    for _ in range(len(tails).bit_length()):
        skips = (ahead >= 0) & (first[np.maximum(ahead, 0)] < 0)
        ahead[skips] = ahead[ahead[skips]]
    is_last = np.ones(len(sides), bool)
    is_last[:-1] = sides[1:] != sides[:-1]
    beyond = np.where(is_last, first[ahead[sides]], np.arange(1, len(sides) + 1))
    return _Rim(ids, beyond, points)


def _darts(
    n_nodes: int, n_crossings: int, partners: IntArray, rim: _Rim
) -> tuple[IntArray, IntArray]:
    """Next dart around the cell on the left, and the point that each dart leaves."""
    n_rim, ports = len(rim.crossings), 4 * n_nodes
    rim_of = np.full(n_crossings, -1)
    is_crossing = rim.crossings >= 0
    rim_of[rim.crossings[is_crossing]] = np.flatnonzero(is_crossing)
    inner, along = ports + np.arange(n_rim), ports + n_rim + np.arange(n_rim)
    ends = partners[n_crossings:]
    inward = partners[rim.crossings[is_crossing]]

    def _turn(arrived: IntArray) -> IntArray:
        node, port = np.divmod(np.maximum(arrived - n_crossings, 0), 4)
        on_rim = along[rim_of[np.minimum(arrived, n_crossings - 1)]] if n_rim else arrived
        return np.where(arrived >= n_crossings, 4 * node + (port - 1) % 4, on_rim)

    following = np.empty(ports + 2 * n_rim, np.int64)
    following[:ports] = _turn(ends)
    # A corner of the boundary has no dart inwards: that place maps to itself.
    following[inner] = inner
    following[inner[is_crossing]] = _turn(inward)
    target = rim.following
    following[along] = np.where(is_crossing[target], inner[target], along[target])
    origins = np.concatenate(
        [np.repeat(np.arange(n_nodes), 4), *[n_nodes + np.arange(n_rim)] * 2]
    )
    return following, origins


def _cycles(following: IntArray) -> tuple[IntArray, IntArray]:
    """Darts of each cycle of a permutation in order, and offsets; fixed points are left out."""
    labels = piece_labels(np.arange(len(following)), following, len(following))
    _, starts, lengths = np.unique(labels, return_index=True, return_counts=True)
    starts, lengths = starts[lengths > 1], lengths[lengths > 1]
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    order = np.empty(offsets[-1], np.int64)
    current = starts
    for step in range(int(lengths.max(initial=0))):
        active = lengths > step
        order[offsets[:-1][active] + step] = current[active]
        current = np.where(active, following[current], current)
    return order, offsets
