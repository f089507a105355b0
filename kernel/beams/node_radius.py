"""Least radius of node cylinders, before which beams end clear of each other."""

from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm
from ..support.annuli import Annuli
from .beams import cut_corners
from .cutting import BeamEnds, node_points, node_rings

ROOM: Final = 3.0
"""Length of a beam, in radii of its node cylinders, that leaves a third of it between them."""

RADIUS_ROUNDS: Final = 8
"""How often ends are found anew: radii change by a quarter of the change before."""


def least_node_radius(annuli: Annuli, thickness: float, node_gap: float = 0.0) -> float:
    """Least radius of node cylinders at which no two beams of a node run into each other.

    In model units; the beams of the given thickness end square at the cylinder.

    Notes
    -----
    Seen along the axis the end of a beam reaches to both sides of its line: by half of its
    thickness, and by what its twist moves its outer and inner corner. Two neighbours at an
    angle φ below a right one that reach w and w' towards each other stay apart where the radius
    is at least ``(w + w' cos φ) / sin φ``, w the smaller, at either corner. The cylinder
    reaches over the whole end. As the corners depend on the radius, both are found in turns.

    All cylinders have one radius: where some nodes would need more than short beams leave room
    for, it is the one that spoils the fewest ends, and beams that run into each other or cannot
    be cut are told where they are found.
    """
    if annuli.n_annuli == 0:
        return 0.0
    ends, nodes = node_rings(annuli), annuli.edge_vertices.ravel()
    half = thickness / 2 * np.abs(dot(np.repeat(annuli.frames[:, 2], 2, axis=0), ends.left))
    corners, axes = annuli.corners.reshape(-1, 2, 3), node_points(annuli).reshape(-1, 1, 3)
    before = need = _needs(ends, nodes, corners - axes, half)
    for _ in range(RADIUS_ROUNDS):
        cut, exists = cut_corners(annuli, (need[nodes] + node_gap).reshape(-1, 2, 1))
        exists = np.repeat(exists, 2)[:, None, None]
        shifts = np.where(exists, cut.reshape(-1, 2, 3), corners) - axes
        before, need = need, _needs(ends, nodes, shifts, half)
    need = np.maximum(before, need)
    lengths = norm(annuli.corners[:, 1] - annuli.corners[:, 0]).min(axis=1)
    tried, needed = np.unique(need[nodes]), np.sort(need[nodes])
    ends_that_meet = len(nodes) - np.searchsorted(needed, tried, "right")
    beams_without_room = np.searchsorted(np.sort(lengths / ROOM), tried)
    least = tried[np.argmin(ends_that_meet + 2 * beams_without_room)]
    return max(float(least) - node_gap, 0.0)


def _needs(ends: BeamEnds, nodes: IntArray, shifts: FloatArray, half: FloatArray) -> FloatArray:
    """Radii that nodes need, by vertex: of corners (2B, 2, 3) seen from the axes."""
    aside = dot(shifts, ends.left[:, None])
    to_right, to_left = half[:, None] - aside, half[:, None] + aside
    result = np.zeros(int(nodes.max()) + 1)
    np.maximum.at(result, nodes, np.maximum(to_right, to_left).max(axis=1))
    is_sharp = (ends.angles > 0) & (ends.angles < np.pi / 2)
    own, other = to_left[is_sharp], to_right[ends.following[is_sharp]]
    angles = ends.angles[is_sharp, None]
    apart = np.minimum(own, other) + np.maximum(own, other) * np.cos(angles)
    np.maximum.at(result, nodes[is_sharp], (apart / np.sin(angles)).max(axis=1))
    return result
