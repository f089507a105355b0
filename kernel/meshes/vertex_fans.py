"""Fans: the corners around vertices in counter-clockwise order."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import BoolArray, IntArray
from .topology import Topology, previous_corners


@dataclass(frozen=True)
class VertexFans:
    """Corners around vertices, counter-clockwise.

    Attributes
    ----------
    vertices : (n,) int array
    corners : (m,) int array
        Corners at each vertex, one vertex after the other; an open fan starts at the boundary
        half-edge that leaves the vertex.
    offsets : (n + 1,) int array
        First corner of each vertex, and m.
    is_closed : (n,) bool array
        Whether the last corner is followed by the first.
    """

    vertices: IntArray
    corners: IntArray
    offsets: IntArray
    is_closed: BoolArray


def vertex_fans(
    topology: Topology,
    tails: IntArray,
    vertices: IntArray,
    closed_from: Literal["first", "last"] = "first",
) -> VertexFans:
    """Order the corners around vertices.

    Parameters
    ----------
    tails : (H,) int array
        Vertex of each corner.
    vertices : (n,) int array
        Vertices that belong to faces.
    closed_from : {"first", "last"}
        Whether the fan of an inner vertex starts at its first or its last corner.
    """
    corners, around = np.arange(len(tails)), topology.twins[previous_corners(topology)]
    start = np.full(len(topology.is_boundary_vertex), -1)
    if closed_from == "last":
        start[tails] = corners
    else:
        start[tails[::-1]] = corners[::-1]
    opening = np.flatnonzero(topology.twins < 0)
    start[tails[opening]] = opening
    owners, found = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    active, current = np.arange(len(vertices)), start[vertices]
    while len(active):
        owners.append(active)
        found.append(current)
        current = around[current]
        going = (current >= 0) & (current != start[vertices[active]])
        active, current = active[going], current[going]
    order = np.argsort(np.concatenate(owners), kind="stable")
    sizes = np.bincount(np.concatenate(owners), minlength=len(vertices))
    offsets = np.concatenate([np.zeros(1, np.int64), np.cumsum(sizes)])
    is_closed = topology.twins[start[vertices]] >= 0
    return VertexFans(vertices, np.concatenate(found)[order], offsets, is_closed)
