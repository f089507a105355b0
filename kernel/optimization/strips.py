"""Strips: rows of faces whose spheres join smoothly along the row, and only there.

Seen from afar such a mesh is a sequence of canal surfaces along one family of its parameter
lines (Sec. 6.3). All that it takes are weights on the edges between neighbours of a row.
"""

from typing import Literal

import numpy as np

from ..arrays import FloatArray, IntArray, dot, unit
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_normals
from ..solvers.weighted_graphs import piece_labels

Family = Literal["first", "second"]


def strip_weights(mesh: Mesh, family: Family) -> FloatArray:
    """Weights that join quadrilaterals along one of their two directions.

    Parameters
    ----------
    mesh : Mesh
        Mesh of quadrilaterals; other faces belong to no strip.
    family : {"first", "second"}
        Strips run along the first side of the first quadrilateral of each piece of the mesh,
        from its first to its second corner, or across.

    Returns
    -------
    (E,) float array
        1 on edges between neighbours of a strip, 0 on all others.

    Raises
    ------
    InputError
        If the mesh has no quadrilateral, or going around an irregular vertex exchanges the two
        directions.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.3, Fig. 25.
    """
    topology = mesh.topology
    is_quad = mesh.degrees == 4
    if not is_quad.any():
        raise InputError("strips run through quadrilaterals: the mesh has none")
    first = topology.edge_corners
    second = topology.twins[first]
    joins = is_quad[topology.edge_faces].all(axis=1)
    side = (np.arange(len(mesh.corners)) - mesh.offsets[topology.corner_faces]) % 2
    runs_second = _family_of_sides(mesh, topology.edge_faces[joins], side[first[joins]],
                                   side[second[joins]])  # fmt: skip
    along = runs_second[topology.edge_faces[:, 0]] ^ side[first]
    wanted = 1 if family == "first" else 0
    return (joins & (along == wanted)).astype(np.float64)


def strip_weights_along(mesh: Mesh, direction: FloatArray) -> FloatArray:
    """Weights (E,) that join faces along a direction in space, (3,) or (F, 3).

    1 on edges that cross the direction at more than 45 degrees, 0 on the others, and where the
    direction stands upright on the mesh.

    Raises
    ------
    InputError
        If the direction is zero, not finite, or has another shape.
    """
    field = np.asarray(direction, np.float64)
    if field.shape not in ((3,), (mesh.n_faces, 3)):
        raise InputError(
            f"a direction must have shape (3,) or ({mesh.n_faces}, 3), not {field.shape}"
        )
    field = np.broadcast_to(field, (mesh.n_faces, 3))
    bad = np.flatnonzero(~np.isfinite(field).all(axis=1) | ~field.any(axis=1))
    if len(bad):
        raise InputError(
            f"the direction at faces {name_ids(bad.tolist())} is zero or not finite"
        )
    normals = face_normals(mesh)
    tangents = unit(field) - dot(unit(field), normals)[:, None] * normals
    a, b = mesh.topology.edge_faces.T
    ends = mesh.vertices[mesh.topology.edge_vertices]
    edges = unit(ends[:, 1] - ends[:, 0])
    # A direction is a line: of the two tangents one may point backwards.
    turn = np.where(dot(tangents[a], tangents[b]) < 0, -1.0, 1.0)
    along = dot(tangents[a] + turn[:, None] * tangents[b], edges)
    size = dot(tangents[a], tangents[a]) + dot(tangents[b], tangents[b])
    return (2 * along**2 < size * 2).astype(np.float64) * (size > 0)


def _family_of_sides(
    mesh: Mesh, pairs: IntArray, sides: IntArray, other_sides: IntArray
) -> IntArray:
    """Whether even sides of each face belong to the second family, 0 or 1 (F,)."""
    a, b = pairs.T
    # Two nodes per face, for its even and its odd sides; an edge joins the sides it is, and
    # the sides that it is not.
    rows = np.concatenate([2 * a + sides, 2 * a + 1 - sides])
    columns = np.concatenate([2 * b + other_sides, 2 * b + 1 - other_sides])
    labels = piece_labels(rows, columns, 2 * mesh.n_faces)
    even, odd = labels[::2], labels[1::2]
    twisted = np.flatnonzero((even == odd) & (mesh.degrees == 4))
    if len(twisted):
        raise InputError(
            f"the two directions of faces {name_ids(twisted.tolist())} change places around an "
            "irregular vertex: give a direction in space instead"
        )
    # The smallest label of a piece is that of its first face's even sides.
    return (even > odd).astype(np.int64)
