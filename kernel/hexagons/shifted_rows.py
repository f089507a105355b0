"""Triangulations of quadrilateral grids whose rows are shifted by half a step."""

from typing import Literal, TypeAlias

import numpy as np

from ..arrays import BoolArray
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh
from ..meshes.topology import previous_corners
from ..meshes.vertex_fans import vertex_fans
from ..solvers.weighted_graphs import piece_labels

RowDirection: TypeAlias = Literal["first", "second"]


def shifted_rows(mesh: Mesh, along: RowDirection = "first") -> Mesh:
    """Nearly regular triangles from every second vertex of a quadrilateral grid.

    Parameters
    ----------
    mesh : Mesh
        Quadrilaterals, four around every inner vertex.
    along : {"first", "second"}
        Rows of triangles run along the first and third sides of the faces, or along the second
        and fourth.

    Returns
    -------
    Mesh
        Triangles. Of each row every second vertex is kept, in alternation from row to row, so
        the vertices lie where they lay. They are equilateral where the steps across rows are
        √3 times those along them. Where rows end, the boundary is a zigzag: to fill it would
        take obtuse triangles.

    Raises
    ------
    InputError
        If the mesh is no such grid, or a closed row has an odd number of faces.
    """
    if along not in ("first", "second"):
        raise InputError(f"along must be 'first' or 'second', not {along!r}")
    _check_grid(mesh)
    topology = mesh.topology
    heads = mesh.corners[topology.next_corners]
    tails_before = mesh.corners[previous_corners(topology)]
    dropped = np.setdiff1d(mesh.corners, np.flatnonzero(_is_even(mesh)))
    fans = vertex_fans(topology, mesh.corners, dropped, "last")
    first = fans.offsets[:-1]
    is_inner = ~topology.is_boundary_vertex[dropped]
    ring = heads[fans.corners[first[is_inner][:, None] + np.arange(4)]]
    starts_across = (fans.corners[first] % 2 == 1) != (along == "second")
    ring = np.where(starts_across[is_inner, None], np.roll(ring, -1, axis=1), ring)
    start = first[~is_inner & ~starts_across & (np.diff(fans.offsets) == 2)]
    last = fans.corners[start + 1]
    rim = np.stack([heads[fans.corners[start]], heads[last], tails_before[last]], 1)
    triangles = np.concatenate([ring[:, [0, 1, 2]], ring[:, [0, 2, 3]], rim])
    used, numbers = np.unique(triangles, return_inverse=True)
    return Mesh(mesh.vertices[used], numbers.reshape(-1, 3))


def _check_grid(mesh: Mesh) -> None:
    bad = np.flatnonzero(mesh.degrees != 4)
    if len(bad):
        raise InputError(f"faces {name_ids(bad.tolist())} are no quadrilaterals")
    topology = mesh.topology
    valence = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    most = np.where(topology.is_boundary_vertex, 2, 4)
    irregular = (valence > most) | (~topology.is_boundary_vertex & (valence != 4))
    bad = np.flatnonzero(irregular)
    if len(bad):
        raise InputError(
            f"vertices {name_ids(bad.tolist())} are irregular: shifted rows need a grid with "
            "four faces around every inner vertex"
        )
    ids = np.flatnonzero(topology.twins >= 0)
    bad = np.unique(topology.corner_faces[ids[(ids - topology.twins[ids]) % 2 == 1]])
    if len(bad):
        raise InputError(
            f"faces {name_ids(bad.tolist())} start with another side than a neighbour: "
            "rows need faces whose first sides run along"
        )


def _is_even(mesh: Mesh) -> BoolArray:
    """Vertices an even number of steps away from the first one of their part of the mesh."""
    count = mesh.n_vertices
    tails, heads = mesh.corners, mesh.corners[mesh.topology.next_corners]
    # Two copies of the vertices, edges lead from one to the other.
    ends = np.concatenate([tails, heads]), np.concatenate([heads, tails]) + count
    labels = piece_labels(*ends, 2 * count)
    if (labels[tails] == labels[tails + count]).any():
        raise InputError("a closed row has an odd number of faces: use an even number")
    return labels[:count] < labels[count:]
