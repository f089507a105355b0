"""Triangles for the formats that have nothing else."""

import numpy as np

from ..kernel.arrays import FloatArray, IntArray
from ..kernel.meshes.mesh import Mesh, face_vector_areas, local_corners


def fan_triangles(mesh: Mesh) -> tuple[IntArray, IntArray]:
    """Cut each face into a fan of triangles from the corner that suits its shape best.

    Vertex ids (T, 3), turning like their face, of which a degree d gives d - 2 triangles; and
    the face (T,) of each triangle, ascending. The apex is the corner whose smallest triangle,
    measured along the normal of the face, is largest: a face with one reflex corner, or two
    opposite ones, is covered without overlap.
    """
    points, areas = local_corners(mesh), face_vector_areas(mesh)
    triangles: list[IntArray] = []
    triangle_faces: list[IntArray] = []
    degrees: list[int] = np.unique(mesh.degrees).tolist()
    for degree in degrees:
        faces = np.flatnonzero(mesh.degrees == degree)
        corners = mesh.offsets[faces, None] + np.arange(degree)
        best = _fans(corners)
        largest = _smallest_area(points[best], areas[faces])
        for apex in range(1, degree if degree > 3 else 1):
            fans = _fans(np.roll(corners, -apex, axis=1))
            smallest = _smallest_area(points[fans], areas[faces])
            is_better = smallest > largest
            best[is_better], largest[is_better] = fans[is_better], smallest[is_better]
        triangles.append(mesh.corners[best].reshape(-1, 3))
        triangle_faces.append(np.repeat(faces, degree - 2))
    owners = np.concatenate(triangle_faces)
    order = np.argsort(owners, kind="stable")
    return np.concatenate(triangles)[order], owners[order]


def _fans(corners: IntArray) -> IntArray:
    """The fan from the first of (n, d) corners, as (n, d - 2, 3) corners."""
    apex = np.broadcast_to(corners[:, :1], (len(corners), corners.shape[1] - 2))
    return np.stack([apex, corners[:, 1:-1], corners[:, 2:]], axis=2)


def _smallest_area(points: FloatArray, along: FloatArray) -> FloatArray:
    """The smallest of (n, t, 3, 3) triangles of each face, measured along (n, 3) vectors."""
    first, second, third = points[:, :, 0], points[:, :, 1], points[:, :, 2]
    crosses = np.cross(second - first, third - first)
    return np.einsum("ntx,nx->nt", crosses, along).min(axis=1)
