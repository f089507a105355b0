"""Spheres through the circles of the faces and apexes placed by smoothing (Fig. 11)."""

from typing import Any

import numpy as np

from ..arrays import FloatArray, sum_by
from ..meshes.mesh import Mesh, local_corners, mean_edge_length
from ..spheres.circles import angle_through_points, circle_pencils, face_circles, pencil_spheres
from ..tolerances import APEX_SOLVE
from .sphere_mesh import SphereMesh


def smoothed_spheres(mesh: Mesh) -> SphereMesh:
    """Spheres through the circles of the faces and an apex each, placed by smoothing.

    Faces without a circumcircle take the best circle. Each apex is joined with the corners of
    its face; the apexes minimise ``sum |L v|²``, with L the mean of the neighbours minus the
    vertex, over the apexes and the interior vertices of the mesh, which stay fixed. Planes
    where a mesh has no interior vertex.

    Raises
    ------
    InputError
        If a face has no area.

    Notes
    -----
    Smoothing the apexes alone, as printed, leaves them at the centroids of their corners: that
    gives the planes back. The energy pulls towards them: on small squares of a sphere it finds
    0.8 of the curvature. With d the shift of an apex from the centroid it is
    ``sum |d|² + sum |b + W d|²``, so that the system ``1 + WᵀW`` is well conditioned.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.2, Fig. 11, corrected.
    """
    circles, _ = face_circles(mesh)
    planes, great_spheres = circle_pencils(circles)
    angles = angle_through_points(planes, great_spheres, _apex_shifts(mesh))
    return SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))


def _apex_shifts(mesh: Mesh) -> FloatArray:
    """Smoothed apexes (F, 3) in the coordinates local to the face."""
    from scipy.sparse import csr_array, eye_array
    from scipy.sparse.linalg import cg

    topology, count = mesh.topology, mesh.n_vertices
    faces, corners = topology.corner_faces, mesh.corners
    # Around an interior vertex there are as many faces as edges, one half-edge leaving each.
    share = np.where(topology.is_boundary_vertex, 0.0, 0.5)
    share = share / np.maximum(np.bincount(corners, minlength=count), 1)
    relative = local_corners(mesh)
    sides = mesh.vertices[corners[topology.next_corners]] - mesh.vertices[corners]
    fixed = share[:, None] * sum_by(corners, sides - relative, count)
    size = mean_edge_length(mesh)
    mean: Any = csr_array((share[corners], (corners, faces)), shape=(count, mesh.n_faces))
    system = eye_array(mesh.n_faces) + mean.T @ mean
    right = -(mean.T @ fixed) / size
    columns = [cg(system, column, rtol=APEX_SOLVE)[0] for column in right.T]
    return size * np.stack(columns, 1)
