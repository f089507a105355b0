"""How far a net is from its surface, and the surface from the net."""

from typing import Any

import numpy as np

from ..analysis import deviation
from ..arrays import FloatArray, IntArray
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import project


def deviations(net: SphereMesh, surface: Mesh) -> tuple[float, float]:
    """Largest distance of panels from a surface, and of the surface from the panels.

    In mean edges of the net. What the net leaves out at the boundary counts in the second.
    """
    size = mean_edge_length(net.mesh)
    there = float(deviation(net, surface).max()) / size
    return there, float(_distances_to(net, surface.vertices).max()) / size


def _distances_to(net: SphereMesh, points: FloatArray) -> FloatArray:
    """Distances (N,) of points from panels, each taken for triangles around its crown."""
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    mesh = net.mesh
    centroids = face_centroids(mesh)
    crowns = centroids + project(net.local_spheres, np.zeros_like(centroids))
    origin = mesh.vertices.mean(axis=0)
    vertices = np.concatenate([mesh.vertices, crowns]) - origin
    heads = mesh.corners[mesh.topology.next_corners]
    triangles: IntArray = np.stack(
        [mesh.corners, heads, mesh.n_vertices + mesh.topology.corner_faces], 1
    )
    distance: Any = point_mesh_squared_distance
    squares, _, _ = distance(points - origin, vertices, triangles)
    return np.sqrt(np.asarray(squares, np.float64))
