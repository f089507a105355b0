"""The mesh: vertices, and faces of mixed degree stored in compressed rows."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import FloatArray, IntArray, norm, read_only, sum_by, unit
from ..errors import InputError, name_ids
from .defects import repeated_corner
from .topology import Topology, build_topology


@dataclass(frozen=True, init=False, eq=False)
class Mesh:
    """An orientable manifold mesh with boundary, faces of mixed degree.

    Parameters
    ----------
    vertices : (V, 3) array_like of float
        Points, in model units.
    faces : sequence of sequences of int, or (F, k) int array
        Vertex ids of each face, counter-clockwise seen from the side of the normal.

    Attributes
    ----------
    vertices : (V, 3) float array
        Points; read-only.
    corners : (H,) int array
        Vertex of each corner, face after face; read-only.
    offsets : (F + 1,) int array
        First corner of each face, and H; read-only.
    topology : Topology
        Half-edges, edges and boundary.

    Raises
    ------
    InputError
        If a coordinate is not finite, an index out of range, a corner repeated within a face,
        or the faces are no orientable manifold; the message names the elements.

    Examples
    --------
    >>> mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> mesh.n_faces, [face.tolist() for face in mesh.faces]
    (2, [[0, 1, 2], [0, 2, 3]])
    """

    vertices: FloatArray
    corners: IntArray
    offsets: IntArray
    topology: Topology = field(repr=False)

    def __init__(
        self, vertices: ArrayLike, faces: IntArray | Iterable[Sequence[int] | IntArray]
    ) -> None:
        corners, offsets = compress_faces(faces)
        points = np.array(vertices, np.float64)
        _check_elements(points, corners, offsets)
        topology = build_topology(corners, offsets, len(points))
        object.__setattr__(self, "vertices", read_only(points))
        object.__setattr__(self, "corners", read_only(corners))
        object.__setattr__(self, "offsets", read_only(offsets))
        object.__setattr__(self, "topology", topology)

    @property
    def faces(self) -> tuple[IntArray, ...]:
        """Vertex ids of each face.

        Returns
        -------
        tuple of F int arrays
            In the order of the corners.
        """
        return tuple(np.split(self.corners, self.offsets[1:-1]))

    @property
    def n_vertices(self) -> int:
        """Number of vertices.

        Returns
        -------
        int
            V.
        """
        return len(self.vertices)

    @property
    def n_faces(self) -> int:
        """Number of faces.

        Returns
        -------
        int
            F.
        """
        return len(self.offsets) - 1

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of elements by the letters that stand for them in shapes of arrays.

        Returns
        -------
        dict
            Of vertices "V", faces "F" and interior edges "E".
        """
        return {"V": self.n_vertices, "F": self.n_faces, "E": len(self.topology.edge_corners)}

    @property
    def degrees(self) -> IntArray:
        """Number of corners of each face, (F,).

        Returns
        -------
        (F,) int array
            Number of corners of each face, (F,).
        """
        return np.diff(self.offsets)


def with_vertices(mesh: Mesh, vertices: FloatArray) -> Mesh:
    """The same faces on other points.

    Parameters
    ----------
    mesh : Mesh
    vertices : (V, 3) float array
        New points; finite.

    Returns
    -------
    Mesh
        Shares faces and topology with `mesh`.
    """
    result = Mesh.__new__(Mesh)
    object.__setattr__(result, "vertices", read_only(vertices.copy()))
    for name in ("corners", "offsets", "topology"):
        object.__setattr__(result, name, getattr(mesh, name))
    return result


def compress_faces(
    faces: IntArray | Iterable[Sequence[int] | IntArray],
) -> tuple[IntArray, IntArray]:
    """Faces in compressed rows; a plain (F, k) array is not split into rows.

    Parameters
    ----------
    faces : sequence of sequences of int, or (F, k) int array
        Vertex ids of each face.

    Returns
    -------
    corners : (H,) int array
        Vertex of each corner, face after face.
    offsets : (F + 1,) int array
        First corner of each face, and H.

    Raises
    ------
    InputError
        If an index is no whole number.
    """
    if isinstance(faces, np.ndarray) and faces.ndim == 2:
        table = cast("NDArray[Any]", faces)
        corners = _whole_numbers(table.ravel())
        degrees = np.full(len(table), len(corners) // max(len(table), 1), np.int64)
    else:
        rows = [np.asarray(face).ravel() for face in faces]
        corners = _whole_numbers(np.concatenate(rows) if rows else np.zeros(0))
        degrees = np.array([len(row) for row in rows], np.int64)
    return corners, np.concatenate([np.zeros(1, np.int64), np.cumsum(degrees)])


def _whole_numbers(indices: NDArray[Any]) -> IntArray:
    if indices.dtype.kind not in "iu":
        is_whole = np.isfinite(indices) & (indices == np.floor(indices))
        if not is_whole.all():
            raise InputError("faces must refer to vertices by whole numbers")
    return indices.astype(np.int64)


def _check_elements(points: FloatArray, corners: IntArray, offsets: IntArray) -> None:
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"vertices must have shape (V, 3), not {points.shape}")
    if len(offsets) < 2:
        raise InputError("the mesh has no faces")
    bad_vertices = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad_vertices):
        raise InputError(
            f"vertices {name_ids(bad_vertices.tolist())} have coordinates that are not finite"
        )
    degrees = np.diff(offsets)
    corner_faces = np.repeat(np.arange(len(degrees)), degrees)
    if (degrees < 3).any():
        bad = name_ids(np.flatnonzero(degrees < 3).tolist())
        raise InputError(f"faces {bad} have fewer than 3 corners")
    outside = (corners < 0) | (corners >= len(points))
    if outside.any():
        bad = name_ids(np.unique(corner_faces[outside]).tolist())
        raise InputError(
            f"faces {bad} refer to vertices out of range: the mesh has {len(points)} vertices"
        )
    order = np.lexsort((corners, corner_faces))
    repeated = (np.diff(corners[order]) == 0) & (np.diff(corner_faces[order]) == 0)
    if repeated.any():
        faces = np.unique(corner_faces[order][1:][repeated])
        raise repeated_corner(corners, offsets, faces)


def face_centroids(mesh: Mesh) -> FloatArray:
    """Mean of the corners of each face: the origin of the coordinates local to the face.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (F, 3) float array
        Centroids.
    """
    # The mean of differences to the first corner keeps its digits far from the origin.
    first = mesh.vertices[mesh.corners[mesh.offsets[:-1]]]
    corner_faces = mesh.topology.corner_faces
    relative = mesh.vertices[mesh.corners] - first[corner_faces]
    return first + sum_by(corner_faces, relative, mesh.n_faces) / mesh.degrees[:, None]


def local_corners(mesh: Mesh) -> FloatArray:
    """Corners in the coordinates local to their face.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (H, 3) float array
        Corner minus centroid of its face.
    """
    return mesh.vertices[mesh.corners] - face_centroids(mesh)[mesh.topology.corner_faces]


def face_vector_areas(mesh: Mesh) -> FloatArray:
    """Vector area of each face: half the sum of the cross products along its boundary.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (F, 3) float array
        For a planar face its area times its normal.
    """
    corners = local_corners(mesh)
    following = corners[mesh.topology.next_corners]
    crosses = np.cross(corners, following)
    return sum_by(mesh.topology.corner_faces, crosses, mesh.n_faces) / 2


def face_normals(mesh: Mesh) -> FloatArray:
    """Unit normal of each face, along its vector area.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (F, 3) float array
        Unit vectors.
    """
    return unit(face_vector_areas(mesh))


def shortest_edge(mesh: Mesh) -> float:
    """Length of the shortest edge.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    float
        In the units of the mesh.
    """
    ends = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    return float(norm(ends - mesh.vertices[mesh.corners]).min())


def mean_edge_length(mesh: Mesh) -> float:
    """Mean length of the sides of the faces: the unit in which tolerances are stated.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    float
        Mean over all half-edges, in model units.
    """
    ends = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    return float(norm(ends - mesh.vertices[mesh.corners]).mean())


def reversed_corners(mesh: Mesh) -> IntArray:
    """Vertices of the faces run the other way round, each from the same first one.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (H,) int array
        Vertex of each corner, in the offsets of the mesh.
    """
    faces = mesh.topology.corner_faces
    firsts = mesh.offsets[:-1][faces]
    place = (firsts - np.arange(len(faces))) % mesh.degrees[faces]
    return mesh.corners[firsts + place]


def edge_middles(mesh: Mesh) -> FloatArray:
    """Middles of the interior edges.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (E, 3) float array
        Means of the two vertices.
    """
    return mesh.vertices[mesh.topology.edge_vertices].mean(axis=1)


def corner_edges(mesh: Mesh) -> IntArray:
    """Edge that leaves each corner, boundary edges included.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    (H,) int array
        Numbers of edges, in the order of their first corners.
    """
    twins = mesh.topology.twins
    own = np.arange(len(twins))
    first = np.where(twins < 0, own, np.minimum(own, twins))
    return np.cumsum(first == own)[first] - 1


def edge_ends(mesh: Mesh, edges: IntArray) -> IntArray:
    """Vertices of all edges, boundary edges included.

    Parameters
    ----------
    mesh : Mesh
    edges : (H,) int array
        Edge that leaves each corner, of `corner_edges`.

    Returns
    -------
    (n, 2) int array
        Ends of each edge, as its first half-edge runs.
    """
    ends = np.stack([mesh.corners, mesh.corners[mesh.topology.next_corners]], 1)
    result = np.empty((int(edges.max()) + 1, 2), np.int64)
    # Backwards, so that the first half-edge is written last.
    result[edges[::-1]] = ends[::-1]
    return result
