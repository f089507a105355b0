"""Separate pieces of a mesh: what shares no vertex shares no length either.

Energies measure in mean edges. Of a mesh of several pieces each has its own, so that a large
piece does not change what a small one becomes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..meshes.mesh import Mesh, with_vertices
from ..solvers.weighted_graphs import piece_labels
from ..sphere_meshes.sphere_mesh import SphereMesh


@dataclass(frozen=True)
class Piece:
    """One piece of a mesh.

    Attributes
    ----------
    mesh : Mesh
        The piece by itself; faces, corners and vertices in the order of the whole.
    faces, corners, vertices : int arrays
        Their numbers in the whole.
    """

    mesh: Mesh
    faces: IntArray
    corners: IntArray
    vertices: IntArray

    def spheres(self, whole: SphereMesh) -> SphereMesh:
        """Its spheres."""
        return SphereMesh.from_local(self.mesh, whole.local_spheres[self.faces])

    def edge_values(self, whole: Mesh, values: FloatArray) -> FloatArray:
        """Of values (E,) over the interior edges of the whole those over its own."""
        by_corner = np.zeros(len(whole.corners))
        edges = whole.topology.edge_corners
        by_corner[edges] = values
        by_corner[whole.topology.twins[edges]] = values
        return by_corner[self.corners[self.mesh.topology.edge_corners]]


def mesh_pieces(mesh: Mesh) -> list[Piece]:
    """Pieces of a mesh, by their first vertices; vertices of no face are in none."""
    heads = mesh.corners[mesh.topology.next_corners]
    labels = piece_labels(mesh.corners, heads, mesh.n_vertices)[mesh.corners]
    pieces: list[Piece] = []
    for label in np.unique(labels):
        corners = np.flatnonzero(labels == label)
        faces = np.unique(mesh.topology.corner_faces[corners])
        vertices, places = np.unique(mesh.corners[corners], return_inverse=True)
        sizes = np.diff(mesh.offsets)[faces]
        own = np.split(places, np.cumsum(sizes)[:-1])
        pieces.append(Piece(Mesh(mesh.vertices[vertices], own), faces, corners, vertices))
    return pieces


def join_pieces(
    whole: SphereMesh, pieces: Sequence[Piece], found: Sequence[SphereMesh]
) -> SphereMesh:
    """The whole, with what its pieces became."""
    points, rows = whole.mesh.vertices.copy(), whole.local_spheres.copy()
    for piece, part in zip(pieces, found, strict=True):
        points[piece.vertices] = part.mesh.vertices
        rows[piece.faces] = part.local_spheres
    return SphereMesh.from_local(with_vertices(whole.mesh, points), rows)
