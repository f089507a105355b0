"""What an energy of sphere meshes is made of: what stays fixed, and the unknowns.

Lengths are in mean edges. The row of a face is seen from the centroid of the face, so neither
units nor the position of the model change anything. Tables that formulas run along are stored
column after column.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ...arrays import FloatArray, IntArray, gather, sum_by, unit
from ...meshes.mesh import Mesh, face_centroids, face_normals, local_corners, mean_edge_length
from ...sphere_meshes.sphere_mesh import SphereMesh
from ...spheres.rows import rescale


class Group(IntEnum):
    """Groups of unknowns."""

    SPHERE = 0
    VERTEX = 1
    NORMAL = 2


WIDTHS = (5, 3, 3)


@dataclass(frozen=True)
class Unknowns:
    """The values that an energy depends on.

    Attributes
    ----------
    spheres : (F, 5) float array
        Unit rows, local to their face.
    displacements : (V, 3) float array
        How far each vertex has moved.
    normals : (N, 3) float array
        Unit dual normals: the directions of the node axes of the interior vertices.
    """

    spheres: FloatArray
    displacements: FloatArray
    normals: FloatArray


@dataclass(frozen=True)
class Setting:
    """What stays fixed while an energy is minimised.

    Attributes
    ----------
    corner_faces, corner_vertices : (H,) int array
        Face and vertex of each corner.
    corners : (H, 3) float array
        Corners of the mesh before any vertex moves, local to their face.
    edge_faces : (E, 2) int array
        Faces of each interior edge.
    edge_middles : pair of (E, 3) float arrays
        Middle of each interior edge, local to its first and to its second face.
    edge_directions : (E, 3) float array
        Unit vectors along the edges.
    edge_normals : (E, 3) float array
        Sum of the unit normals of the two faces.
    edge_weights : (E,) float array
        Weights of the angles.
    target_angle : float
        Angle at which neighbours shall meet, in radians.
    allowance : float
        How far a sphere may pass from the vertices of its face without cost.
    node_vertices : (N,) int array
        Interior vertices: the nodes.
    spoke_edges, spoke_nodes : (S,) int array
        Each pair of an interior edge and a node at one of its ends.
    ring_vertices : (N, k) int array
        Neighbours of each node along its edges; the node itself where it has fewer than k.
    node_umbrellas : (N, 3) float array
        Each node minus the mean of its neighbours, before any vertex moves.
    node_normals : (N, 3) float array
        Mean of the normals of the faces around each node, unit.
    n_vertices : int
        Number of vertices V.
    face_points, vertex_points, node_points : (F, 3), (V, 3) and (N, 3) float arrays
        Where faces, vertices and nodes lie: near is near.
    """

    corner_faces: IntArray
    corner_vertices: IntArray
    corners: FloatArray
    edge_faces: IntArray
    edge_middles: tuple[FloatArray, FloatArray]
    edge_directions: FloatArray
    edge_normals: FloatArray
    edge_weights: FloatArray
    target_angle: float
    allowance: float
    node_vertices: IntArray
    spoke_edges: IntArray
    spoke_nodes: IntArray
    ring_vertices: IntArray
    node_umbrellas: FloatArray
    node_normals: FloatArray
    n_vertices: int
    face_points: FloatArray
    vertex_points: FloatArray
    node_points: FloatArray

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return int(self.corner_faces[-1]) + 1


def energy_setting(
    mesh: Mesh, edge_weights: FloatArray, target_angle: float = 0.0, allowance: float = 0.0
) -> Setting:
    """Measure a mesh for its energies, in mean edges.

    (E,) weights of the angle over the interior edges; the target angle in radians; the
    allowance is how far a sphere may pass from the vertices of its face without cost, in mean
    edges.
    """
    topology = mesh.topology
    corners = local_corners(mesh) / mean_edge_length(mesh)
    heads = corners[topology.next_corners]
    middles = (corners + heads) / 2
    first = topology.edge_corners
    second = topology.twins[first]
    faces = topology.edge_faces
    normals = face_normals(mesh)

    nodes = np.flatnonzero(~topology.is_boundary_vertex)
    node_of = np.full(mesh.n_vertices, -1)
    node_of[nodes] = np.arange(len(nodes))
    ends = node_of[topology.edge_vertices]
    edges, sides = np.nonzero(ends >= 0)
    return Setting(
        corner_faces=topology.corner_faces,
        corner_vertices=mesh.corners,
        corners=np.asfortranarray(corners),
        edge_faces=faces,
        edge_middles=(gather(middles, first), gather(middles, second)),
        edge_directions=unit(gather(heads, first) - gather(corners, first)),
        edge_normals=gather(normals, faces[:, 0]) + gather(normals, faces[:, 1]),
        edge_weights=edge_weights,
        target_angle=target_angle,
        allowance=allowance,
        node_vertices=nodes,
        spoke_edges=edges,
        spoke_nodes=ends[edges, sides],
        ring_vertices=_rings(mesh, nodes),
        node_umbrellas=_umbrellas(mesh)[nodes],
        node_normals=_vertex_normals(mesh)[nodes],
        n_vertices=mesh.n_vertices,
        face_points=face_centroids(mesh),
        vertex_points=mesh.vertices,
        node_points=mesh.vertices[nodes],
    )


def _rings(mesh: Mesh, nodes: IntArray) -> IntArray:
    """Neighbours of each node, filled up with the node itself."""
    order = np.argsort(mesh.corners, kind="stable")
    tails = mesh.corners[order]
    heads = mesh.corners[mesh.topology.next_corners[order]]
    valences = np.bincount(tails, minlength=mesh.n_vertices)
    ranks = np.arange(len(tails)) - np.repeat(np.cumsum(valences) - valences, valences)
    widest = int(valences[nodes].max(initial=0))
    table = np.tile(np.arange(mesh.n_vertices)[:, None], (1, widest))
    inside = ranks < widest
    table[tails[inside], ranks[inside]] = heads[inside]
    return table[nodes]


def _umbrellas(mesh: Mesh) -> FloatArray:
    """Each vertex minus the mean of the ends of the half-edges that leave it."""
    heads = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    spokes = mesh.vertices[mesh.corners] - heads
    valences = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    sums = sum_by(mesh.corners, spokes, mesh.n_vertices)
    return sums / np.maximum(valences, 1)[:, None] / mean_edge_length(mesh)


def first_unknowns(sphere_mesh: SphereMesh) -> Unknowns:
    """Unknowns of a sphere mesh whose vertices have not moved.

    Rows in mean edges; dual normals along the mean of the normals of the faces around each
    interior vertex.
    """
    mesh = sphere_mesh.mesh
    spheres = rescale(sphere_mesh.local_spheres, 1 / mean_edge_length(mesh))
    return Unknowns(
        spheres,
        np.zeros((mesh.n_vertices, 3)),
        _vertex_normals(mesh)[~mesh.topology.is_boundary_vertex],
    )


def _vertex_normals(mesh: Mesh) -> FloatArray:
    """Unit mean of the normals of the faces around each vertex."""
    corner_normals = face_normals(mesh)[mesh.topology.corner_faces]
    return unit(sum_by(mesh.corners, corner_normals, mesh.n_vertices))
