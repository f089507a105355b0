"""A triangle mesh with a sphere at every vertex, seen in the unit of its mean edge."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import FloatArray, IntArray, dot, norm, sum_by, unit
from ...errors import InputError, name_ids
from ...meshes.curvature import vertex_normals
from ...meshes.mesh import Mesh, face_centroids, face_vector_areas, mean_edge_length
from ...meshes.topology import Topology
from ...meshes.triangulation import check_triangles
from ...solvers.weighted_graphs import piece_labels
from ...spheres.incidence import normals
from ...spheres.minkowski import minkowski
from ...spheres.row_checks import check_rows, seen_from, unit_rows
from ...spheres.rows import recenter, rescale
from ...tolerances import DEGENERATE
from .tree_signs import tree_signs


@dataclass(frozen=True)
class CongruenceMesh:
    """A triangulated sphere congruence, centred, with mean edge 1.

    Attributes
    ----------
    points : (V, 3) float array
        Vertices.
    triangles : (F, 3) int array
        Faces; corner ``3 f + i`` is the i-th of face f, as in `topology`.
    topology : Topology
        Half-edges of the mesh.
    rows : (V, 5) float array
        Unit rows of the spheres, each seen from its vertex, continuously oriented.
    vertex_frames : (V, 3, 3) float array
        Two tangents and the normal at each vertex, orthonormal and right-handed.
    face_frames : (F, 3, 3) float array
        First side, the direction across, and the normal of each face.
    face_areas : (F,) float array
        Areas.
    origin : (3,) float array
        Model coordinates of the origin.
    size : float
        Mean edge length of the model, in model units.
    """

    points: FloatArray
    triangles: IntArray
    topology: Topology
    rows: FloatArray
    vertex_frames: FloatArray
    face_frames: FloatArray
    face_areas: FloatArray
    origin: FloatArray
    size: float

    @property
    def vertex_areas(self) -> FloatArray:
        """A third of the areas of the faces around each vertex, (V,), in squared mean edges."""
        shares = np.repeat(self.face_areas / 3, 3)
        return sum_by(self.triangles.ravel(), shares, len(self.points))


def congruence_mesh(mesh: Mesh, spheres: ArrayLike) -> CongruenceMesh:
    """Check a triangle mesh with spheres at its vertices, and bring it into local coordinates.

    The spheres are real rows (V, 5) of any scale, not zero, in model coordinates; planes
    included.

    Raises
    ------
    InputError
        If a face is no triangle or has no area, the mesh is not connected, or a sphere is
        missing, not finite, imaginary or a point; the message names the elements.

    Notes
    -----
    A row far from the origin has lost the digits of its last coefficient. Where a sphere passes
    through its vertex within that rounding, its local row does so exactly.

    Signs are chosen along a spanning tree so that neighbours meet at less than 90 degrees, and
    over all so that most spheres agree with the normals of the faces.
    """
    areas = _checked_areas(mesh)
    size = mean_edge_length(mesh)
    origin = face_centroids(mesh).mean(axis=0)
    points = (mesh.vertices - origin) / size
    rows = _vertex_rows(mesh, np.asarray(spheres, float), size)
    vertex_frames = _tangent_frames(vertex_normals(mesh))
    triangles = mesh.corners.reshape(-1, 3)
    sides = unit(points[triangles[:, 1]] - points[triangles[:, 0]])
    face_normals = unit(areas)
    face_frames = np.stack([sides, np.cross(face_normals, sides), face_normals], 1)
    oriented = _oriented_rows(mesh, points, rows, vertex_frames[:, 2])
    return CongruenceMesh(
        points, triangles, mesh.topology, oriented, vertex_frames, face_frames,
        norm(areas) / size**2, origin, size,
    )  # fmt: skip


def _tangent_frames(vectors: FloatArray) -> FloatArray:
    """Two tangents and the normal (n, 3, 3) of unit normals."""
    axes = np.eye(3)[np.abs(vectors).argmin(axis=1)]
    first = unit(np.cross(vectors, axes))
    return np.stack([first, np.cross(vectors, first), vectors], 1)


def _checked_areas(mesh: Mesh) -> FloatArray:
    """Vector areas of the faces (F, 3) of a connected triangle mesh."""
    check_triangles(mesh)
    areas = face_vector_areas(mesh)
    sides = (
        mesh.vertices[mesh.corners[mesh.topology.next_corners]] - mesh.vertices[mesh.corners]
    )
    squares = sum_by(mesh.topology.corner_faces, dot(sides, sides), mesh.n_faces)
    flat = np.flatnonzero(~(norm(areas) > DEGENERATE * squares))
    if len(flat):
        raise InputError(f"faces {name_ids(flat.tolist())} have no area: remove them")
    unused = np.setdiff1d(np.arange(mesh.n_vertices), mesh.corners)
    if len(unused):
        raise InputError(f"vertices {name_ids(unused.tolist())} belong to no face: remove them")
    left, right = mesh.topology.edge_faces.T
    count = piece_labels(left, right, mesh.n_faces).max() + 1
    if count > 1:
        raise InputError(f"the mesh has {count} separate pieces: remesh them one by one")
    return areas


def _vertex_rows(mesh: Mesh, spheres: FloatArray, size: float) -> FloatArray:
    """Unit rows (V, 5), each seen from its vertex, in the unit `size`."""
    check_rows(spheres, mesh.n_vertices, "vertex")
    rows = rescale(seen_from(spheres, mesh.vertices), 1 / size)
    need = ": remeshing needs real spheres or planes"
    return unit_rows(rows, np.arange(mesh.n_vertices), need)


def _oriented_rows(
    mesh: Mesh, points: FloatArray, rows: FloatArray, vertex_normals: FloatArray
) -> FloatArray:
    from scipy.sparse import csr_array

    tails, heads = mesh.corners, mesh.corners[mesh.topology.next_corners]
    products = minkowski(rows[tails], recenter(rows[heads], points[tails] - points[heads]))
    likeness = csr_array((products, (tails, heads)), shape=(len(rows), len(rows)))
    oriented = rows * tree_signs(likeness)[:, None]
    agreement = dot(normals(oriented, np.zeros(3)), vertex_normals)
    return oriented * np.copysign(1.0, agreement.sum())
