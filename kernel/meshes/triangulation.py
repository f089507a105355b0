"""Cutting polygons into triangles along short diagonals."""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..errors import InputError, name_ids
from ..tolerances import DEGENERATE, SAME_LENGTH
from .mesh import Mesh, face_normals, local_corners


def triangulate(mesh: Mesh) -> Mesh:
    """Triangles in place of polygons, on the same vertices.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree, convex or not, planar or not.

    Returns
    -------
    Mesh
        The triangles of a face follow each other, in the order of the faces, and run as it
        does; triangles stay as they are.

    Raises
    ------
    InputError
        If a face crosses itself or has no area; the message names it.

    Notes
    -----
    Ears are cut off one after another, the one with the shortest diagonal first: a
    quadrilateral is split along its shorter diagonal, one with an inner corner through that
    corner. Of equally short diagonals that from the first corner of the face wins, so a regular
    net is split regularly.
    """
    degrees, offsets = mesh.degrees, mesh.offsets
    flat = _flattened_corners(mesh)
    points = local_corners(mesh)
    largest = int(degrees.max())
    polygons, owners = np.zeros((0, largest), np.int64), np.zeros(0, np.int64)
    triangles: list[IntArray] = []
    triangle_owners: list[IntArray] = []
    for degree in range(largest, 2, -1):
        faces = np.flatnonzero(degrees == degree)
        fresh = offsets[faces][:, None] + np.arange(degree)
        polygons = np.concatenate([polygons, fresh])
        owners = np.concatenate([owners, faces])
        if degree == 3:
            break
        tips = _shortest_ears(flat[polygons], points[polygons], owners)
        rows = np.arange(len(tips))[:, None]
        triangles.append(polygons[rows, (tips[:, None] + np.array([-1, 0, 1])) % degree])
        triangle_owners.append(owners)
        rest = np.arange(degree) != tips[:, None]
        polygons = polygons[rest].reshape(len(tips), degree - 1)
    corners = np.concatenate([*triangles, polygons])
    order = np.argsort(np.concatenate([*triangle_owners, owners]), kind="stable")
    return Mesh(mesh.vertices, mesh.corners[corners[order]])


def _flattened_corners(mesh: Mesh) -> FloatArray:
    """Corners (H, 2) in the plane of their face, in units of its size."""
    faces = mesh.topology.corner_faces
    corners = local_corners(mesh)
    size = np.sqrt(sum_by(faces, dot(corners, corners), mesh.n_faces) / mesh.degrees)
    normals = face_normals(mesh)
    helper = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    x_axis = unit(np.cross(normals, helper))
    axes = np.stack([x_axis, np.cross(normals, x_axis)], 1)
    scaled = np.divide(
        corners, size[faces, None], out=np.zeros_like(corners), where=size[faces, None] > 0
    )
    return np.einsum("hij,hj->hi", axes[faces], scaled)


def _shortest_ears(flat: FloatArray, points: FloatArray, owners: IntArray) -> IntArray:
    """Tip (n,) of the ear with the shortest diagonal of polygons (n, k, 2) and (n, k, 3)."""
    before, after = np.roll(points, 1, axis=1), np.roll(points, -1, axis=1)
    lengths = np.where(_is_ear(flat), norm(after - before), np.inf)
    shortest = lengths.min(axis=1)
    bad = owners[~np.isfinite(shortest)]
    if len(bad):
        raise InputError(
            f"faces {name_ids(np.unique(bad).tolist())} cross themselves or have no area; "
            "remove or repair them"
        )
    is_short = lengths <= shortest[:, None] * (1 + SAME_LENGTH)
    # The diagonal from the first corner of the face cuts off its second one.
    following = np.argmax(np.roll(is_short, -1, axis=1), axis=1)
    return (following + 1) % flat.shape[1]


def _is_ear(flat: FloatArray) -> BoolArray:
    """Corners (n, k) that can be cut off: convex, and with no other corner in the triangle."""
    degree = int(flat.shape[1])
    ring = np.stack([np.roll(flat, 1, axis=1), flat, np.roll(flat, -1, axis=1)], axis=2)
    sides = np.roll(ring, -1, axis=2) - ring  # (n, tips, 3, 2)
    is_convex = _cross(sides[:, :, 0], sides[:, :, 1]) > DEGENERATE
    away = flat[:, None, :, None] - ring[:, :, None]  # (n, tips, corners, 3, 2)
    is_inside = (_cross(sides[:, :, None], away) >= -DEGENERATE).all(axis=-1)
    order: IntArray = np.arange(degree)
    steps = (order - order[:, None] + 1) % degree
    return is_convex & ~(is_inside & (steps > 2)).any(axis=2)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def check_triangles(mesh: Mesh) -> None:
    """Refuse a mesh that is no triangulation.

    Raises
    ------
    InputError
        If faces are no triangles; the message names them.
    """
    bad = np.flatnonzero(mesh.degrees != 3)
    if len(bad):
        raise InputError(
            f"faces {name_ids(bad.tolist())} are no triangles: triangulate the mesh first"
        )
