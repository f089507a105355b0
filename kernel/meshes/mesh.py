"""The mesh: vertices, and faces of mixed degree stored in compressed rows."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray, IntArray, norm, read_only, sum_by, unit
from ..display import Shown, brief, counted, polygons_text, size_text
from ..errors import ArgumentError
from .faces import check_faces, compress_faces, padded_rows
from .topology import Topology, build_topology


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Mesh(Shown):
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
    >>> mesh
    Mesh(4 vertices; 2 triangles; 1 x 1 x 0)
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
        check_faces(points, corners, offsets)
        topology = build_topology(corners, offsets, len(points))
        object.__setattr__(self, "vertices", read_only(points))
        object.__setattr__(self, "corners", read_only(corners))
        object.__setattr__(self, "offsets", read_only(offsets))
        object.__setattr__(self, "topology", topology)

    def __repr__(self) -> str:
        return brief(
            "Mesh",
            [
                counted(self.n_vertices, "vertex"),
                polygons_text(self.degrees),
                size_text(self.vertices),
            ],
        )

    @classmethod
    def from_trimesh(cls, source: Any) -> "Mesh":  # noqa: ANN401, another library's
        """The mesh of a `trimesh.Trimesh`.

        Parameters
        ----------
        source : trimesh.Trimesh
            Its triangles; of a scene give ``scene.to_mesh()``.

        Returns
        -------
        Mesh
            The same vertices and faces.
        """
        _check_kind(source, "trimesh.Trimesh", "vertices", "faces")
        return cls(source.vertices, np.asarray(source.faces))

    @classmethod
    def from_pyvista(cls, source: Any) -> "Mesh":  # noqa: ANN401, another library's
        """The mesh of a `pyvista.PolyData`.

        Parameters
        ----------
        source : pyvista.PolyData
            Its polygons; of a grid give ``grid.extract_surface()``.

        Returns
        -------
        Mesh
            The same points and faces.
        """
        _check_kind(source, "pyvista.PolyData", "points", "faces")
        return cls(source.points, padded_rows(np.asarray(source.faces)))

    @classmethod
    def from_compas(cls, source: Any) -> "Mesh":  # noqa: ANN401, another library's
        """The mesh of a `compas.datastructures.Mesh`.

        Parameters
        ----------
        source : compas.datastructures.Mesh
            Polygons stay polygons.

        Returns
        -------
        Mesh
            Vertices and faces in the order of their keys.
        """
        _check_kind(source, "compas.datastructures.Mesh", "to_vertices_and_faces")
        return cls(*source.to_vertices_and_faces())

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


def _check_kind(source: object, kind: str, *names: str) -> None:
    """Refuse an object that lacks what another library's meshes have."""
    if not all(hasattr(source, name) for name in names):
        raise ArgumentError(
            f"Mesh.from_{kind.partition('.')[0]} needs a {kind}, not {type(source).__name__}; "
            "arrays go into Mesh(vertices, faces)"
        )


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
