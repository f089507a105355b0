"""Least radius of node cylinders, before which beams end clear of each other."""

from typing import Final

import numpy as np

from ..arrays import FloatArray, norm
from ..support.annuli import Annuli, end_depths, twist_angles
from .cutting import neighbor_angles

ROOM: Final = 3.0
"""Length of a beam, in radii of its node cylinders, that leaves a third of it between them."""


def least_node_radius(annuli: Annuli, thickness: float, node_gap: float = 0.0) -> float:
    """Least radius of node cylinders at which no two beams of a node run into each other.

    In model units; the beams of the given thickness end square at the cylinder.

    Notes
    -----
    Seen along the axis the end of a beam is as wide as its thickness, and wider by what its
    twist moves the inner against the outer corner: half of it is w. Two ends at an angle φ stay
    apart where the radius is at least ``w / tan(φ / 2)``; beyond a right angle, and for the
    cylinder to reach over the whole end, it is w at least. All cylinders have one radius: where
    some nodes would need more than short beams leave room for, it is the one that spoils the
    fewest ends, and beams that run into each other or cannot be cut are told where they are
    found.
    """
    if annuli.n_annuli == 0:
        return 0.0
    ends = annuli.edge_vertices
    widest, need = np.zeros(int(ends.max()) + 1), np.zeros(int(ends.max()) + 1)
    np.maximum.at(widest, ends, half_widths(annuli, thickness))
    angles = np.minimum(neighbor_angles(annuli).min(axis=2), np.pi / 4)
    sound = angles > 0  # beams in the same direction are rejected when they are cut
    np.maximum.at(need, ends[sound], widest[ends[sound]] / np.tan(angles[sound]))
    lengths = norm(annuli.corners[:, 1] - annuli.corners[:, 0]).min(axis=1)
    tried = np.unique(need[ends])
    ends_that_meet = len(ends) * 2 - np.searchsorted(
        np.sort(need[ends].ravel()), tried, "right"
    )
    beams_without_room = np.searchsorted(np.sort(lengths / ROOM), tried)
    least = tried[np.argmin(ends_that_meet + 2 * beams_without_room)]
    return max(float(least) - node_gap, 0.0)


def half_widths(annuli: Annuli, thickness: float) -> FloatArray:
    """Half of the widths (B, 2) of beams of a thickness, seen along the node axes."""
    twist = twist_angles(annuli)
    half: FloatArray = thickness * np.cos(twist) / 2 + end_depths(annuli) * np.sin(twist)
    return half
