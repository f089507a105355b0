"""Why faces are no mesh: the true cause, the faces that it concerns, and what repairs it."""

import numpy as np

from ..arrays import BoolArray, IntArray
from ..errors import MeshError, name_ids
from .orientation import faces_to_flip

CURE = "repair_mesh (--repair)"


def repeated_corner(corners: IntArray, offsets: IntArray, faces: IntArray) -> MeshError:
    """The error of faces that pass a vertex more than once.

    Parameters
    ----------
    faces : (n,) int array
        The faces, at least one.

    Returns
    -------
    MeshError
        Says of the first face whether it has a hole.
    """
    face = corners[offsets[faces[0]] : offsets[faces[0] + 1]]
    sides = set(zip(face.tolist(), np.roll(face, -1).tolist(), strict=True))
    bridges = [(a, b) for a, b in sides if a < b and (b, a) in sides]
    ids = faces.tolist()
    is_spike = (np.roll(face, 1) == np.roll(face, -1)).any()
    is_double = (np.roll(face, 1) == face).any()
    if bridges and not is_spike and not is_double:
        a, b = min(bridges)
        return MeshError(
            f"face {{0}} has a hole: it runs along the bridge edge {a}-{b} there and back, a "
            f"repeated corner at both ends; {CURE} cuts it into triangles",
            ids,
        )
    return MeshError(
        f"faces {{faces}} have a repeated corner; remove the duplicate, or {CURE} does", ids
    )


def repeated_face(corners: IntArray, offsets: IntArray, faces: IntArray) -> MeshError | None:
    """The error of two faces with the same corners.

    Parameters
    ----------
    faces : (n,) int array
        Faces to look at, in ascending order.

    Returns
    -------
    MeshError or None
        None if no face repeats another.
    """
    seen: dict[tuple[int, ...], int] = {}
    for face in faces.tolist():
        ring = corners[offsets[face] : offsets[face + 1]].tolist()
        forward, backward = _from_least(ring), _from_least(ring[::-1])
        for key, how in ((forward, ""), (backward, " turned over")):
            if key in seen:
                return MeshError(
                    f"face {{0}} repeats face {{1}}{how}; delete it, or {CURE} does",
                    [face, seen[key]],
                )
        seen[forward] = face
    return None


def _from_least(ring: list[int]) -> tuple[int, ...]:
    start = ring.index(min(ring))
    return (*ring[start:], *ring[:start])


def crowded_edge(
    corners: IntArray, offsets: IntArray, ends: tuple[int, int], faces: IntArray
) -> MeshError:
    """The error of an edge with more than two faces.

    Parameters
    ----------
    ends : tuple of int
        Vertices of the edge.
    faces : (n,) int array
        Its faces.

    Returns
    -------
    MeshError
        Says if one of the faces repeats another.
    """
    return repeated_face(corners, offsets, faces) or MeshError(
        f"edge {ends[0]}-{ends[1]} is non-manifold: it has more than two faces {{faces}}; "
        f"panel what meets there layer by layer, or let {CURE} separate it",
        faces.tolist(),
    )


def disagreeing_normals(
    corners: IntArray, offsets: IntArray, links: IntArray, is_aligned: BoolArray
) -> MeshError:
    """The error of faces that run along an edge in the same direction.

    Parameters
    ----------
    links : (n, 2) int array
        Half-edges on the same edge, in the order of the faces.
    is_aligned : (n,) bool array
        Whether both run in the same direction; somewhere they do.

    Returns
    -------
    MeshError
        Names the faces that are to be turned over, or says that there is no way to.
    """
    degrees = np.diff(offsets)
    owners = np.repeat(np.arange(len(degrees)), degrees)
    a, b = links[np.flatnonzero(is_aligned)[0]].tolist()
    pair = np.unique(owners[[a, b]])
    same = repeated_face(corners, offsets, pair)
    if same:
        return same
    head = offsets[owners[a]] + (a + 1 - offsets[owners[a]]) % degrees[owners[a]]
    where = f"run along edge {corners[a]}-{corners[head]} in the same direction"
    is_flipped, is_met = faces_to_flip(len(degrees), owners[links], is_aligned)
    if not is_met.all():
        return MeshError(
            f"faces [{{0}}, {{1}}] {where}, and no choice of normals helps: the mesh is "
            "non-orientable, with one side only like a Möbius strip; cut it open there, or let "
            f"{CURE} do so",
            owners[[a, b]].tolist(),
        )
    flipped = np.flatnonzero(is_flipped)
    counts = (
        f"the normals of {len(flipped)} of {len(degrees)} faces {name_ids(flipped.tolist())}"
    )
    return MeshError(
        f"faces [{{0}}, {{1}}] {where}: {counts} disagree with the others; unify the face "
        f"normals, or let {CURE} turn these over",
        owners[[a, b]].tolist(),
    )


def split_vertex(vertex: int, faces: IntArray) -> MeshError:
    """The error of a vertex around which the faces make more than one fan.

    Parameters
    ----------
    faces : (n,) int array
        Faces at the vertex.

    Returns
    -------
    MeshError
        Names them.
    """
    return MeshError(
        f"vertex {vertex} is non-manifold: faces {{faces}} meet there without sharing an edge; "
        f"duplicate the vertex, or let {CURE} do so",
        faces.tolist(),
    )
