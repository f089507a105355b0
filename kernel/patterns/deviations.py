"""How far a net is from its surface, and the surface from the net."""

from typing import Any, NamedTuple

import numpy as np

from ..analysis import deviation
from ..arrays import FloatArray, IntArray
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..meshes.triangulation import triangulate
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import project


class Deviations(NamedTuple):
    """Largest distances, in mean edges of a net.

    Attributes
    ----------
    nodes : float
        Of its nodes inside from the surface.
    panels : float
        Of its panels from the surface.
    surface : float
        Of the surface from the panels: what the net leaves out at the boundary counts.
    """

    nodes: float
    panels: float
    surface: float


def deviations(net: SphereMesh, surface: Mesh) -> Deviations:
    """How far a net is from a surface, and the surface from it."""
    mesh = net.mesh
    size, inner = mean_edge_length(mesh), ~mesh.topology.is_boundary_vertex
    lengths = (
        point_distances(mesh.vertices[inner], triangulate(surface)),
        deviation(net, surface),
        _distances_to(net, surface.vertices),
    )
    return Deviations(*(float(each.max(initial=0.0)) / size for each in lengths))


def point_distances(points: FloatArray, surface: Mesh) -> FloatArray:
    """Distances (N,) of points from the triangles of a mesh."""
    if not len(points):
        return np.zeros(0)
    origin = surface.vertices.mean(axis=0)
    return _distances(
        points - origin, surface.vertices - origin, surface.corners.reshape(-1, 3)
    )


def _distances_to(net: SphereMesh, points: FloatArray) -> FloatArray:
    """Distances (N,) of points from panels, each taken for triangles around its crown."""
    mesh = net.mesh
    centroids = face_centroids(mesh)
    crowns = centroids + project(net.local_spheres, np.zeros_like(centroids))
    origin = mesh.vertices.mean(axis=0)
    vertices = np.concatenate([mesh.vertices, crowns]) - origin
    heads = mesh.corners[mesh.topology.next_corners]
    triangles: IntArray = np.stack(
        [mesh.corners, heads, mesh.n_vertices + mesh.topology.corner_faces], 1
    )
    return _distances(points - origin, vertices, triangles)


def _distances(points: FloatArray, vertices: FloatArray, triangles: IntArray) -> FloatArray:
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    distance: Any = point_mesh_squared_distance
    squares, _, _ = distance(points, vertices, triangles)
    return np.sqrt(np.asarray(squares, np.float64))
