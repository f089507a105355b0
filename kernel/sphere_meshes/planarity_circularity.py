"""How flat and how circular the faces of a mesh are."""

import numpy as np

from ..arrays import FloatArray, dot
from ..meshes.mesh import Mesh, face_normals, local_corners
from ..spheres.circles import face_circles


def planarity(mesh: Mesh) -> FloatArray:
    """How far the corners of each face lie off its plane.

    Returns
    -------
    (F,) float array
        Largest distance of a corner from the plane through the centroid across the vector
        area, in model units; zero for triangles.
    """
    faces = mesh.topology.corner_faces
    heights = np.abs(dot(local_corners(mesh), face_normals(mesh)[faces]))
    return np.maximum.reduceat(heights, mesh.offsets[:-1])


def circularity(mesh: Mesh) -> FloatArray:
    """How far the corners of each face lie off its best-fit circle.

    Returns
    -------
    (F,) float array
        Largest distance of a corner from the circle, in model units; zero for triangles.

    Raises
    ------
    InputError
        If a face has no area.
    """
    return face_circles(mesh)[1]
