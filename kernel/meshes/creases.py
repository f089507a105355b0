"""Creases: edges at which a surface turns too sharply to be taken for smooth."""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..errors import InputError
from ..solvers.weighted_graphs import piece_labels
from ..tolerances import SAME_TURN
from .mesh import Mesh, face_normals


def edge_turns(mesh: Mesh) -> FloatArray:
    """Angle between the planes of the two faces of each interior edge, (E,), in radians."""
    sides = face_normals(mesh)[mesh.topology.edge_faces]
    left, right = sides[:, 0], sides[:, 1]
    return np.arctan2(norm(np.cross(left, right)), dot(left, right))


def crease_edges(mesh: Mesh, crease: float) -> BoolArray:
    """Whether the planes of the faces of each interior edge (E,) turn by more than an angle.

    The angle is in radians, from 0 to π; at π there are no creases. Turns that are equal to it
    up to rounding are none, in any numbering and position of the mesh.

    Raises
    ------
    InputError
        If the angle is out of range.
    """
    if not 0 <= crease <= np.pi:
        raise InputError(
            f"a crease angle lies between 0 and 180 degrees, not {np.degrees(crease):g}"
        )
    if crease >= np.pi - SAME_TURN:
        return np.zeros(len(mesh.topology.edge_corners), bool)
    return edge_turns(mesh) > crease + SAME_TURN


def joined_parts(mesh: Mesh, joins: BoolArray) -> IntArray:
    """Parts of a mesh that hang together by the marked ones of its interior edges (E,).

    Number of the part of each face, (F,).
    """
    first, second = mesh.topology.edge_faces[joins].T
    return piece_labels(first, second, mesh.n_faces)
