"""Least radius of node cylinders, before which beams end clear of each other."""

from typing import Final

import numpy as np

from ..arrays import FloatArray, norm
from ..support.annuli import Annuli, end_depths, twist_angles
from .cutting import neighbor_angles

LARGEST_SHARE: Final = 1 / 3
"""Largest radius of a node cylinder, in lengths of the shortest beam of the node."""


def least_node_radius(annuli: Annuli, thickness: float, node_gap: float = 0.0) -> float:
    """Least radius of node cylinders at which no two beams of a node run into each other.

    In model units; the beams of the given thickness end square at the cylinder.

    Notes
    -----
    Seen along the axis the end of a beam is as wide as its thickness, and wider by what its
    twist moves the inner against the outer corner: half of it is w. Two ends at an angle φ stay
    apart where the radius is at least ``w / tan(φ / 2)``; beyond a right angle, and for the
    cylinder to reach over the whole end, it is w at least. Nodes that would need more than a
    third of their shortest beam are left out: one fold must not swell all cylinders, and beams
    that run into each other there are told by the audit.
    """
    if annuli.n_annuli == 0:
        return 0.0
    ends = annuli.edge_vertices
    count = int(ends.max()) + 1
    widths = half_widths(annuli, thickness)
    widest, need, shortest = np.zeros(count), np.zeros(count), np.full(count, np.inf)
    np.maximum.at(widest, ends, widths)
    np.minimum.at(
        shortest, ends, norm(annuli.corners[:, 1, 0] - annuli.corners[:, 0, 0])[:, None]
    )
    angles = np.minimum(neighbor_angles(annuli).min(axis=2), np.pi / 4)
    sound = angles > 0  # beams in the same direction are rejected when they are cut
    np.maximum.at(need, ends[sound], widest[ends[sound]] / np.tan(angles[sound]))
    is_wide = need <= LARGEST_SHARE * shortest
    least = float(need[is_wide].max(initial=0.0)) or float((LARGEST_SHARE * shortest).min())
    return max(least - node_gap, 0.0)


def half_widths(annuli: Annuli, thickness: float) -> FloatArray:
    """Half of the widths (B, 2) of beams of a thickness, seen along the node axes."""
    twist = twist_angles(annuli)
    half: FloatArray = thickness * np.cos(twist) / 2 + end_depths(annuli) * np.sin(twist)
    return half
