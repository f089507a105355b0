"""Spheres for the faces of a mesh to start from: planes, and least squares."""

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray, batches_by_count, dot, sum_by
from ..errors import InputError
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..spheres.circles import circle_pencils, face_circles, pencil_spheres
from ..spheres.incidence import evaluate
from ..spheres.minkowski import minkowski
from ..tolerances import CIRCULAR
from .sphere_mesh import SphereMesh


def face_planes(mesh: Mesh) -> SphereMesh:
    """The plane of every face: through the centroid across the vector area, A = 0.

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
    """Sphere of every face that fits its vertices and those of `ring` rings of faces around it.

    Rings are joined along edges. On circular faces the best sphere through the circle, else the
    best of all spheres, by least squares of the sphere equation under Pratt's norm
    ``|B|² - 4 A C = 1``. Exact on vertices of one sphere or plane, and covariant under
    similarities. A circular face without vertices around it gets its plane.

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
    """Angle t that minimises the sum of ``(cos t P(x) + sin t Q(x))²``: a 2x2 eigenproblem.

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
    squares = sum_by(faces, dot(points, points), count)
    sizes = np.sqrt(squares / np.maximum(np.bincount(faces, minlength=count), 1))
    rows = np.zeros((count, 5))
    for present, chosen in batches_by_count(faces, count):
        scaled = points[chosen] / sizes[present, None, None]
        fitted = _best_unit_rows(scaled)
        fitted[:, 0] /= sizes[present]
        fitted[:, 4] *= sizes[present]
        rows[present] = fitted
    return rows


def _best_unit_rows(points: FloatArray) -> FloatArray:
    """Rows (n, 5) of norm 1 with the least sum of squares over their points (n, k, 3).

    Rows are written as ``T y`` with ``|y|²`` proportional to the sum of squares: the best is
    the one of the largest norm, a symmetric eigenproblem. T comes from the singular values of
    the equations themselves: those of their products would be squares, and where four corners
    lie nearly on a circle, half the digits were lost with them.
    """
    n, k, _ = points.shape
    equations = np.zeros((n, max(k, 5), 5))
    equations[:, :k, 0] = dot(points, points)
    equations[:, :k, 1:4] = -points
    equations[:, :k, 4] = 1
    _, values, axes = np.linalg.svd(np.linalg.qr(equations, mode="r"))
    # What the points leave undetermined costs nothing, and is not divided by.
    shares = np.divide(values[:, 4:], values, out=np.ones_like(values), where=values > 0)
    ways = axes * shares[:, :, None]
    norms, vectors = np.linalg.eigh(minkowski(ways[:, :, None], ways[:, None]))
    best = (vectors[:, None, :, -1] @ ways)[:, 0]
    return best / np.sqrt(norms[:, -1:])
