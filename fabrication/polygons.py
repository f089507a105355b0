"""What a mesh file says: polygons, before they are known to be a mesh."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ..kernel.arrays import FloatArray, IntArray, norm
from ..kernel.errors import InputError, MeshError
from ..kernel.meshes.defects import CURE
from ..kernel.meshes.mesh import Mesh
from ..kernel.solvers.weighted_graphs import piece_labels


@dataclass(frozen=True)
class Polygons:
    """Polygons of mixed degree as a file lists them.

    Attributes
    ----------
    vertices : (V, 3) float array
        Points, in model units.
    corners : (H,) int array
        Vertex of each corner, face after face, from 0; not checked.
    degrees : (F,) int array
        Number of corners of each face.
    vertex_lines : (V,) int array
        Line of each vertex in a text file, from 1; empty for binary files.
    face_lines : (F,) int array
        Line of each face in a text file, from 1; empty for binary files.
    """

    vertices: FloatArray
    corners: IntArray
    degrees: IntArray
    vertex_lines: ArrayLike = ()
    face_lines: ArrayLike = ()


NO_SURFACES: Final = "the edge length is for surfaces, and changes nothing: there are none"
"""Remark on a file of meshes that is asked for an edge length."""


@dataclass(frozen=True)
class FileContent:
    """What was read from a file, before it is known to be a mesh.

    Attributes
    ----------
    polygons : Polygons
        Faces of all that was read, in the order of the file.
    units : str
        Model unit that the file names, one of `units.MILLIMETERS`; empty if it names none.
    remarks : tuple of str
        Sentences for the user: what was left out and why, what was mended in reading.
    sources : tuple of (str, int)
        Objects in their order, such as ``mesh 'shell' on layer 'Roof::Glass'``, and how many
        faces each has; empty for files without objects.
    """

    polygons: Polygons
    units: str = ""
    remarks: tuple[str, ...] = ()
    sources: tuple[tuple[str, int], ...] = ()


def to_mesh(polygons: Polygons, sources: Sequence[tuple[str, int]] = ()) -> Mesh:
    """The polygons as a mesh: same vertices, same faces, same order.

    Parameters
    ----------
    sources : sequence of (str, int)
        Objects that the faces are from, as in `FileContent`.

    Raises
    ------
    InputError
        If the polygons are no orientable manifold mesh, or two neighbouring corners of a face
        coincide; the message says why and names the faces, by lines or objects where they are
        known.
    """
    if not len(polygons.degrees):
        raise InputError("the file has no faces; export the model as a polygon mesh")
    try:
        mesh = Mesh(polygons.vertices, _faces(polygons))
        _check_coincident_corners(mesh)
    except MeshError as error:
        raise error.naming(partial(_face_name, polygons, sources)) from error
    except InputError:
        _raise_at_line(polygons)
        raise
    return mesh


def _check_coincident_corners(mesh: Mesh) -> None:
    following = mesh.corners[mesh.topology.next_corners]
    is_point = (mesh.vertices[mesh.corners] == mesh.vertices[following]).all(axis=1)
    if is_point.any():
        first = int(np.flatnonzero(is_point)[0])
        faces = np.unique(mesh.topology.corner_faces[is_point]).tolist()
        raise MeshError(
            f"two corners of faces {{faces}} coincide, such as vertices {mesh.corners[first]} "
            f"and {following[first]}; leave one out, or let {CURE} do so",
            faces,
        )


def _face_name(polygons: Polygons, sources: Sequence[tuple[str, int]], face: int) -> str:
    """A face by its number from 0, and its line or object."""
    lines = np.asarray(polygons.face_lines)
    if face < len(lines):
        return f"{face} (line {lines[face]})"
    first = 0
    for name, count in sources:
        if face < first + count:
            return f"{face} ({name})"
        first += count
    return str(face)


def _faces(polygons: Polygons) -> IntArray | list[IntArray]:
    degrees = polygons.degrees
    if (degrees == max(degrees[0], 1)).all():
        return polygons.corners.reshape(-1, int(degrees[0]))
    return np.split(polygons.corners, np.cumsum(degrees)[:-1])


def _raise_at_line(polygons: Polygons) -> None:
    """Find the first line that is wrong by itself; Mesh has found that something is."""
    n_vertices = len(polygons.vertices)
    for line, point in zip(np.asarray(polygons.vertex_lines), polygons.vertices, strict=False):
        if not np.isfinite(point).all():
            raise InputError(
                f"line {line}: the coordinates {point.tolist()} are not finite; "
                "export the mesh again"
            )
    faces = np.split(polygons.corners, np.cumsum(polygons.degrees)[:-1])
    for line, face in zip(np.asarray(polygons.face_lines), faces, strict=False):
        if len(face) < 3:
            raise InputError(
                f"line {line}: the face has {len(face)} corners and needs 3; delete it"
            )
        if face.min() < 0 or face.max() >= n_vertices:
            raise InputError(
                f"line {line}: the face refers to a vertex out of range: the file has "
                f"{n_vertices} vertices; export the mesh again"
            )


def join_polygons(parts: Sequence[Polygons]) -> Polygons:
    """Polygons of several lists in one, without their lines.

    Parameters
    ----------
    parts : sequence of Polygons
        At least one.

    Returns
    -------
    Polygons
        All vertices and faces, one list after the other.
    """
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Polygons(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.corners + k for part, k in zip(parts, starts, strict=False)]),
        np.concatenate([part.degrees for part in parts]),
    )


def transform_polygons(polygons: Polygons, transform: FloatArray) -> Polygons:
    """Move polygons by an affine map.

    Parameters
    ----------
    transform : (4, 4) float array
        The map, for columns of homogeneous coordinates.

    Returns
    -------
    Polygons
        The same polygons there; a map that mirrors turns them over, so that their normals
        stay on their side.
    """
    if np.array_equal(transform, np.eye(4)):
        return polygons
    linear = transform[:3, :3]
    vertices = polygons.vertices @ linear.T + transform[:3, 3]
    corners = polygons.corners
    if np.linalg.det(linear) < 0:
        owners = np.repeat(np.arange(len(polygons.degrees)), polygons.degrees)
        order = np.lexsort([-np.arange(len(corners)), owners])
        corners = corners[order]
    return replace(polygons, vertices=vertices, corners=corners)


def drop_repeats(polygons: Polygons) -> Polygons:
    """Polygons without corners that repeat the one before, and without faces of no area left.

    Parameters
    ----------
    polygons : Polygons
        Polygons whose coincident vertices are one.

    Returns
    -------
    Polygons
        The same vertices; a quad with a side of no length is a triangle.
    """
    owners = np.repeat(np.arange(len(polygons.degrees)), polygons.degrees)
    ends = np.cumsum(polygons.degrees)
    before = np.arange(len(owners)) - 1
    before[ends - polygons.degrees] = ends - 1
    keep = polygons.corners != polygons.corners[before]
    degrees = np.bincount(owners[keep], minlength=len(polygons.degrees))
    keep &= (degrees > 2)[owners]
    return Polygons(polygons.vertices, polygons.corners[keep], degrees[degrees > 2])


def drop_unused(polygons: Polygons) -> Polygons:
    """The same polygons without the vertices that no face uses; the others keep their order.

    Parameters
    ----------
    polygons : Polygons
        Polygons whose corners may be out of range: these are left for `to_mesh` to report.

    Returns
    -------
    Polygons
        Polygons with renumbered corners.
    """
    n_vertices, corners = len(polygons.vertices), polygons.corners
    if ((corners < 0) | (corners >= n_vertices)).any():
        return polygons
    is_used = np.zeros(n_vertices, bool)
    is_used[corners] = True
    lines = np.asarray(polygons.vertex_lines)
    return replace(
        polygons,
        vertices=polygons.vertices[is_used],
        corners=(np.cumsum(is_used) - 1)[corners],
        vertex_lines=lines[is_used] if len(lines) else lines,
    )


def weld(points: FloatArray, distance: float = 0.0) -> tuple[FloatArray, IntArray]:
    """Merge coincident points.

    Parameters
    ----------
    points : (N, 3) float array
        Points, finite.
    distance : float
        Points that are this close, or linked by a chain of such pairs, are one point, at the
        place of the first; 0 merges equal points only. In model units.

    Returns
    -------
    vertices : (V, 3) float array
        The distinct points in order of first appearance.
    ids : (N,) int array
        Vertex of each point.

    Examples
    --------
    >>> import numpy as np
    >>> vertices, ids = weld(np.array([[1.0, 0, 0], [0, 0, 0], [1, 0, 0]]))
    >>> len(vertices), ids.tolist()
    (2, [0, 1, 0])
    """
    vertices, ids = _first_of_each(points, _equal_labels(points))
    if distance > 0:
        from scipy.spatial import KDTree

        pairs = KDTree(vertices).query_pairs(distance, output_type="ndarray")
        labels = piece_labels(pairs[:, 0], pairs[:, 1], len(vertices))
        vertices, merged = _first_of_each(vertices, labels)
        ids = merged[ids]
    return vertices, ids


def _equal_labels(points: FloatArray) -> IntArray:
    order = np.lexsort(points.T)
    is_new = np.ones(len(points), bool)
    is_new[1:] = (np.diff(points[order], axis=0) != 0).any(axis=1)
    labels = np.empty(len(points), np.int64)
    labels[order] = np.cumsum(is_new) - 1
    return labels


def _first_of_each(points: FloatArray, labels: IntArray) -> tuple[FloatArray, IntArray]:
    _, firsts, inverse = np.unique(labels, return_index=True, return_inverse=True)
    by_appearance = np.argsort(firsts)
    ranks = np.empty(len(firsts), np.int64)
    ranks[by_appearance] = np.arange(len(firsts))
    return points[firsts[by_appearance]], ranks[inverse]


def mean_side(polygons: Polygons) -> float:
    """Mean length of the sides of the polygons.

    Parameters
    ----------
    polygons : Polygons
        Polygons with corners in range.

    Returns
    -------
    float
        Mean over all sides, in model units.
    """
    ends = np.cumsum(polygons.degrees)
    following = np.arange(1, len(polygons.corners) + 1)
    following[ends - 1] = ends - polygons.degrees
    points = polygons.vertices[polygons.corners]
    return float(norm(points[following] - points).mean())
