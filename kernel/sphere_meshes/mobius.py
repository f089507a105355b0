"""Möbius maps of meshes and sphere meshes."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import dot, norm, sum_by
from ..meshes.mesh import (
    Mesh,
    face_centroids,
    face_normals,
    local_corners,
    mean_edge_length,
    reversed_corners,
)
from ..spheres.mobius_group import read_transform
from ..spheres.mobius_images import refuse_rows
from ..spheres.mobius_local import (
    LocalMap,
    bend_vectors,
    offset_images,
    point_images,
    row_images,
)
from ..spheres.rows import recenter
from ..tolerances import AT_INFINITY
from .sphere_mesh import SphereMesh


def map_mesh(mesh: Mesh, transform: ArrayLike) -> Mesh:
    """Image of a mesh: of its vertices, with straight sides between them.

    Vertices and faces keep their ids. Where right and left change places each face starts at
    the same vertex and runs the other way, so its normal stays on the same side.

    Raises
    ------
    InputError
        If a vertex is sent to infinity, or so close to it (`AT_INFINITY`) that its image is of
        no use; the message names them. If the transform is no Möbius map.
    """
    return _image_mesh(mesh, read_transform(transform))


def map_sphere_mesh(sphere_mesh: SphereMesh, transform: ArrayLike) -> SphereMesh:
    """Image of a sphere mesh: spheres, vertices and the angles between the spheres.

    Vertices and faces keep their ids, N agrees with the normal of the face as before, and
    neighbours meet at the same angles. Edges are numbered anew where faces run the other way.

    Raises
    ------
    InputError
        As `map_mesh`; and if the image of a face passes through infinity or is more than half
        a sphere, so that N would turn against the normal of the face. The message names them.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.
    """
    local, mesh = read_transform(transform), sphere_mesh.mesh
    image = _image_mesh(mesh, local)
    centroids, faces = face_centroids(mesh), mesh.topology.corner_faces
    too_near = "faces {} are too near the centre of the inversion; move it away"
    vectors, rounding = bend_vectors(local, centroids)
    refuse_rows(norm(vectors) <= rounding, too_near)
    steps = offset_images(local, centroids[faces], local_corners(mesh))
    shift = sum_by(faces, steps, mesh.n_faces) / mesh.degrees[:, None]
    rows = recenter(row_images(local, sphere_mesh.local_spheres, centroids), shift)
    before = dot(face_normals(mesh), sphere_mesh.local_spheres[:, 1:4])
    refuse_rows(before * dot(face_normals(image), rows[:, 1:4]) < 0, too_near)
    return SphereMesh.from_local(image, rows)


def _image_mesh(mesh: Mesh, local: LocalMap) -> Mesh:
    vectors, rounding = bend_vectors(local, mesh.vertices)
    reach = np.maximum(rounding, AT_INFINITY * local.strength * mean_edge_length(mesh))
    refuse_rows(
        norm(vectors) <= reach, "vertices {} are sent to infinity; move the centre away"
    )
    corners = reversed_corners(mesh) if local.reverses else mesh.corners
    return Mesh(point_images(local, mesh.vertices), np.split(corners, mesh.offsets[1:-1]))
