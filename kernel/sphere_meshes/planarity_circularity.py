"""How flat and how circular the faces of a mesh are."""

import numpy as np

from ..arrays import FloatArray, dot
from ..meshes.mesh import Mesh, face_normals, local_corners
from ..spheres.circles import face_circles


def planarity(mesh: Mesh) -> FloatArray:
    """How far (F,) the corners of each face lie off its plane, in model units.

    The plane passes through the centroid across the vector area; zero for triangles.
    """
    faces = mesh.topology.corner_faces
    heights = np.abs(dot(local_corners(mesh), face_normals(mesh)[faces]))
    return np.maximum.reduceat(heights, mesh.offsets[:-1])


def circularity(mesh: Mesh) -> FloatArray:
    """How far (F,) the corners of each face lie off its best-fit circle, in model units.

    Zero for triangles.

    Raises
    ------
    InputError
        If a face has no area.
    """
    return face_circles(mesh)[1]
