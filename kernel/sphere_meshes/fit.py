"""Spheres for the faces of a mesh to start from: planes, and least squares."""

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray, dot, sum_by
from ..errors import InputError
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..spheres.circles import circle_pencils, face_circles, pencil_spheres
from ..spheres.incidence import evaluate
from ..tolerances import CIRCULAR
from .sphere_mesh import SphereMesh


def face_planes(mesh: Mesh) -> SphereMesh:
    """
    The plane of every face.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    SphereMesh
        Rows with A = 0: the plane through the centroid across the vector area.

    Raises
    ------
    InputError
        If a face has no area.

    References
    ----------
    Meshes with Spherical Faces, Sec. 3, initialisation (i).
    """
    circles, _ = face_circles(mesh)
    planes, _ = circle_pencils(circles)
    return SphereMesh.from_local(mesh, planes)


def fit_spheres(mesh: Mesh, ring: int = 1) -> SphereMesh:
    """
    Sphere of every face that fits its vertices and those of the faces around it.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    ring : int
        How many rings of faces, joined along edges, take part around each face.

    Returns
    -------
    SphereMesh
        On circular faces the best sphere through the circle, else the best of all spheres, by
        least squares of the sphere equation under Pratt's norm ``|B|² - 4 A C = 1``. Exact on
        vertices of one sphere or plane, and covariant under similarities. A circular face
        without vertices around it gets its plane.

    Raises
    ------
    InputError
        If `ring` is negative or a face has no area.

    References
    ----------
    Meshes with Spherical Faces, Sec. 3, initialisation (ii); V. Pratt, Direct least-squares
    fitting of algebraic surfaces, 1987.
    """
    if ring < 0:
        raise InputError(f"ring must be 0 or more, not {ring}")
    circles, miss = face_circles(mesh)
    faces, vertices = _rings(mesh, ring)
    origins = face_centroids(mesh)
    points = mesh.vertices[vertices] - origins[faces]
    planes, great_spheres = circle_pencils(circles)
    first, second = evaluate(planes[faces], points), evaluate(great_spheres[faces], points)
    rounding = CIRCULAR * mean_edge_length(mesh)
    angles = _pencil_fit(faces, first, second, mesh.n_faces, rounding)
    rows = pencil_spheres(planes, great_spheres, angles)

    is_free = miss > rounding
    if is_free.any():
        chosen = is_free[faces]
        rows[is_free] = _pratt_fit(faces[chosen], points[chosen], mesh.n_faces)[is_free]
        backwards = is_free & (dot(rows[:, 1:4], circles.normals) < 0)
        rows[backwards] *= -1
    return SphereMesh.from_local(mesh, rows)


def _rings(mesh: Mesh, ring: int) -> tuple[IntArray, IntArray]:
    """Pairs (face, vertex) of each face with the distinct vertices of its rings."""
    from scipy.sparse import csr_array, eye_array

    topology = mesh.topology
    shape = (mesh.n_faces, mesh.n_vertices)
    incidence = csr_array(
        (np.ones(len(mesh.corners), bool), mesh.corners, mesh.offsets), shape=shape
    )
    left, right = topology.edge_faces.T
    pairs = (np.concatenate([left, right]), np.concatenate([right, left]))
    ones = np.ones(len(pairs[0]), bool)
    adjacency = csr_array((ones, pairs), shape=(mesh.n_faces, mesh.n_faces))
    step: Any = adjacency + eye_array(mesh.n_faces, dtype=bool)
    reach: Any = incidence
    for _ in range(ring):
        reach = csr_array(step @ reach)
    starts, vertices = np.asarray(reach.indptr), np.asarray(reach.indices, np.int64)
    return np.repeat(np.arange(mesh.n_faces), np.diff(starts)), vertices


def _pencil_fit(
    faces: IntArray, first: FloatArray, second: FloatArray, count: int, rounding: float
) -> FloatArray:
    """
    Angle t that minimises the sum of ``(cos t P(x) + sin t Q(x))²``: a 2x2 eigenproblem.

    Zero, the plane, where all points lie on the circle up to `rounding`.
    """
    difference = sum_by(faces, first**2 - second**2, count)
    mixed = sum_by(faces, 2 * first * second, count)
    # The quadratic form is constant plus half of (difference cos 2t + mixed sin 2t).
    least = rounding**2 * np.bincount(faces, minlength=count)
    is_undetermined = np.hypot(difference, mixed) <= least
    return np.where(is_undetermined, 0.0, np.arctan2(-mixed, -difference) / 2)


def _pratt_fit(faces: IntArray, points: FloatArray, count: int) -> FloatArray:
    """Least-squares rows of norm 1, for the faces that occur; zero for the others."""
    present, local = np.unique(faces, return_inverse=True)
    size = np.sqrt(sum_by(local, dot(points, points), len(present)) / np.bincount(local))
    scaled = points / size[local, None]
    equations = np.concatenate(
        [dot(scaled, scaled)[:, None], -scaled, np.ones((len(scaled), 1))], axis=1
    )
    products = (equations[:, :, None] * equations[:, None, :]).reshape(-1, 25)
    moments = sum_by(local, products, len(present)).reshape(-1, 5, 5)
    inverse_norm = np.diag([0.0, 1.0, 1.0, 1.0, 0.0])
    inverse_norm[0, 4] = inverse_norm[4, 0] = -0.5
    values, vectors = np.linalg.eig(inverse_norm @ moments)
    candidates = np.real(vectors).transpose(0, 2, 1)
    norms = dot(candidates[..., 1:4], candidates[..., 1:4]) - (
        4 * candidates[..., 0] * candidates[..., 4]
    )
    # Among the eigenvectors of positive norm the one of least residual is the fit.
    cost = np.where(norms > 0, np.abs(np.real(values)), np.inf)
    best = np.argmin(cost, axis=1)
    chosen = candidates[np.arange(len(present)), best]
    chosen = chosen / np.sqrt(norms[np.arange(len(present)), best])[:, None]
    chosen[:, 0] /= size
    chosen[:, 4] *= size
    rows = np.zeros((count, 5))
    rows[present] = chosen
    return rows
