"""Node axes as panels and beams use them: given as two points each, in any order."""

from typing import Literal

import numpy as np

from ..arrays import FloatArray, dot, sum_by, unit
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_normals

EdgeMode = Literal["bisector", "intersection", "axis"]
"""How panels are cut along their edges, see `cutting_planes`."""


def outward_axes(mesh: Mesh, axes: FloatArray) -> FloatArray:
    """Unit directions (V, 3) of node axes to the outer side of a mesh.

    The axes (V, 2, 3) are two points each, in any order. Zero for unused vertices.
    """
    normals = sum_by(
        mesh.corners, face_normals(mesh)[mesh.topology.corner_faces], mesh.n_vertices
    )
    directions = unit(axes[:, 0] - axes[:, 1])
    result: FloatArray = directions * np.sign(dot(directions, normals))[:, None]
    return result


def check_axes(mesh: Mesh, edges: EdgeMode, axes: FloatArray | None) -> None:
    """Refuse axes that are missing, not wanted, or not those of the vertices.

    Raises
    ------
    InputError
        If so.
    """
    if (edges == "axis") != (axes is not None):
        raise InputError(
            "edges='axis' needs axes, two points of each node axis as axis_support gives them"
            if axes is None
            else f"axes are for edges='axis', not for {edges!r}: leave them out"
        )
    if axes is None:
        return
    count = mesh.n_vertices
    if axes.shape != (count, 2, 3) or not np.isfinite(axes).all():
        raise InputError(
            f"axes must be two points for each of the {count} vertices, of shape ({count}, 2, "
            f"3), not {axes.shape}"
        )
    bad = np.setdiff1d(mesh.corners, np.flatnonzero(outward_axes(mesh, axes).any(axis=1)))
    if len(bad):
        raise InputError(
            f"the axes of vertices {name_ids(bad.tolist())} have no direction or lie in the "
            "surface: give two points of each, one inside"
        )
