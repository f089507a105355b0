"""Discrete sphere congruences and the points that their spheres have in common.

A congruence with spheres at the vertices of a mesh has its envelopes on the dual mesh: two
points for every face. Given the other way round, as a sphere mesh with spheres on the faces,
the vertices are one envelope and their mirror images in the planes of the centres the other.

Points are null vectors of the Minkowski product that are orthogonal to the rows of their
spheres, so planes and points at infinity are nothing special.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, batches_by_count, dot, norm, sum_by
from ..errors import InputError
from ..meshes.mesh import Mesh, face_centroids, local_corners, mean_edge_length
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import normals, signed_distance
from ..spheres.pentaspherical import from_pentaspherical, pentaspherical
from ..spheres.row_checks import check_rows, unit_rows
from ..spheres.rows import lift_points, recenter
from ..tolerances import DEGENERATE, EPSILON

EnvelopeOrder: TypeAlias = Literal["nearest", "oriented"]

_SIGNATURE = np.array([1.0, 1.0, 1.0, 1.0, -1.0])
_CONTACT_STEPS = 40


@dataclass(frozen=True)
class Envelope:
    """The two points that the spheres of each face have in common.

    Attributes
    ----------
    points_plus, points_minus : (F, 3) float array
        Points; NaN where they are not real, infinite where one is at infinity.
    is_real : (F,) bool array
        Whether the spheres meet in two real points.
    residuals : (F,) float array
        Largest distance of a finite one of the two points from a sphere of the face, in model
        units; zero up to rounding for faces of three corners. NaN where they are not real.
    """

    points_plus: FloatArray
    points_minus: FloatArray
    is_real: BoolArray
    residuals: FloatArray


@dataclass(frozen=True)
class MirrorPoints:
    """The second points that the spheres around each vertex have in common.

    Attributes
    ----------
    points : (V, 3) float array
        Points v-; NaN on the boundary and where the spheres share a circle, infinite where the
        plane of the centres is at infinity (all spheres are planes).
    residuals : (V,) float array
        Distance of v- from the farthest of its spheres, in model units: zero for a
        Q-congruence. NaN where `is_valid` is False.
    is_valid : (V,) bool array
        Whether v- is a point of space.
    """

    points: FloatArray
    residuals: FloatArray
    is_valid: BoolArray


def envelope(mesh: Mesh, spheres: ArrayLike, order: EnvelopeOrder = "nearest") -> Envelope:
    """Both envelopes of a discrete congruence with spheres at the vertices of a mesh.

    Parameters
    ----------
    mesh : Mesh
        Combinatorics of the congruence; its vertices only say where the faces are.
    spheres : (V, 5) array_like of float
        Real rows of any positive scale, planes included, in model coordinates.
    order : {"nearest", "oriented"}
        Which point is plus: the one nearer to the centroid of the face; or, for spheres whose
        N points to the centre (A > 0), the one to the side of the normal of the face of the
        centres, as in the paper. Turning all spheres over exchanges the oriented ones.

    Returns
    -------
    Envelope
        For faces of degree 3 exact; beyond, least squares of the products with the rows.

    Raises
    ------
    InputError
        If the rows do not match the vertices, are not finite, or a sphere of a face is
        imaginary or a point; the message names the vertices.

    Notes
    -----
    The complement of three rows is spanned by two vectors. The product restricted to them is a
    quadratic form: indefinite, it has two null vectors, the points; definite, it has none. A
    face whose spheres share a circle or more has no envelope points: `is_real` is False.

    References
    ----------
    Meshes with Spherical Faces, Def. 2.4 and Sec. 2.3.1; below Prop. 4.3.
    """
    if order not in ("nearest", "oriented"):
        raise InputError(f"order must be 'nearest' or 'oriented', not {order!r}")
    size = mean_edge_length(mesh)
    rows = _rows_at_corners(mesh, np.asarray(spheres, float), size)
    plus = np.full((mesh.n_faces, 3), np.nan)
    minus, is_real = plus.copy(), np.zeros(mesh.n_faces, bool)
    for faces, corners in batches_by_count(mesh.topology.corner_faces, mesh.n_faces):
        found, exists = _common_points(pentaspherical(rows[corners]))
        first, second = _finite_points(found)
        if order == "nearest":
            swap = (norm(second) < norm(first))[:, None]
            first, second = np.where(swap, second, first), np.where(swap, first, second)
        plus[faces[exists]], minus[faces[exists]] = first[exists], second[exists]
        is_real[faces] = exists
    distances = np.maximum(
        _corner_distances(rows, plus[mesh.topology.corner_faces]),
        _corner_distances(rows, minus[mesh.topology.corner_faces]),
    )
    residuals = np.maximum.reduceat(distances, mesh.offsets[:-1]) * size
    residuals[~is_real] = np.nan
    origins = face_centroids(mesh)
    return Envelope(origins + size * plus, origins + size * minus, is_real, residuals)


def _rows_at_corners(mesh: Mesh, spheres: FloatArray, size: float) -> FloatArray:
    """Unit rows (H, 5) seen from the centroid of the face, in the unit `size`."""
    check_rows(spheres, mesh.n_vertices, "vertex")
    rows = recenter(spheres[mesh.corners], face_centroids(mesh)[mesh.topology.corner_faces])
    rows = rows * np.array([size, 1.0, 1.0, 1.0, 1 / size])
    return unit_rows(rows, mesh.corners, ": an envelope needs real spheres or planes there")


def _common_points(rows: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Null vectors (n, 2, 5) orthogonal to rows (n, k, 5), in oriented order; real or not."""
    _, values, basis = np.linalg.svd(rows * _SIGNATURE)
    complement = basis[:, 3:]
    form = (complement * _SIGNATURE) @ complement.transpose(0, 2, 1)
    weights, axes = np.linalg.eigh(form)
    is_real = (values[:, 2] > DEGENERATE * values[:, 0]) & (weights[:, 0] < 0)
    is_real &= weights[:, 1] > 0
    along = np.sqrt(np.maximum(weights[:, 1:], 0)) * axes[:, :, 0]
    across = np.sqrt(np.maximum(-weights[:, :1], 0)) * axes[:, :, 1]
    found = np.stack([along + across, along - across], 1) @ complement
    found = found * np.copysign(1.0, found[..., 4:])
    # Determinants of each row between its neighbours and the two points: the side of the face.
    pair = np.broadcast_to(found[:, None], (*rows.shape[:2], 2, 5))
    triples = np.stack([np.roll(rows, 1, axis=1), rows, np.roll(rows, -1, axis=1)], 2)
    side = np.linalg.det(np.concatenate([triples, pair], 2)).sum(axis=1)
    return np.where((side < 0)[:, None, None], found[:, ::-1], found), is_real


def _finite_points(found: FloatArray) -> tuple[FloatArray, FloatArray]:
    rows = from_pentaspherical(found)
    is_infinite = rows[..., 0] <= 8 * EPSILON * norm(rows)
    divisor = np.where(is_infinite, 1.0, 2 * rows[..., 0])[..., None]
    points = np.where(is_infinite[..., None], np.inf, rows[..., 1:4] / divisor)
    return points[:, 0], points[:, 1]


def _corner_distances(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Distances of points from unit rows; zero for points that are not finite."""
    is_finite = _are_finite(points)
    at = np.where(is_finite[:, None], points, 0.0)
    return np.where(is_finite, np.abs(signed_distance(rows, at)), 0.0)


def mirror_points(sphere_mesh: SphereMesh) -> MirrorPoints:
    """Second envelope of a sphere mesh: where the spheres around a vertex meet once more.

    The spheres pass through the vertices. Mirror images of the interior vertices in the planes
    of the centres; around vertices of more than three faces by least squares.

    Notes
    -----
    Inversion at the vertex turns its spheres into the planes ``N·q = A``: their common point,
    in homogeneous coordinates, is a null vector of the rows ``(N, -A)``.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.3.1 and proof of Prop. 4.2.
    """
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    rows = _rows_at_vertices(sphere_mesh, size)
    relative = np.full((mesh.n_vertices, 3), np.nan)
    for vertices, corners in batches_by_count(mesh.corners, mesh.n_vertices):
        if corners.shape[1] < 3:
            continue
        system = np.concatenate([rows[corners, 1:4], -rows[corners, :1]], -1)
        _, values, basis = np.linalg.svd(system)
        inverse, weight = basis[:, 3, :3], basis[:, 3, 3:]
        square = dot(inverse, inverse)[:, None]
        is_infinite = square <= (8 * EPSILON) ** 2
        points = inverse * weight / np.where(is_infinite, 1.0, square)
        points = np.where(is_infinite, np.inf, points)
        points[values[:, 2] <= DEGENERATE * values[:, 0]] = np.nan
        relative[vertices] = points
    relative[mesh.topology.is_boundary_vertex] = np.nan
    is_valid = _are_finite(relative)
    distances = _corner_distances(rows, relative[mesh.corners])
    residuals = np.zeros(mesh.n_vertices)
    np.maximum.at(residuals, mesh.corners, distances)
    residuals = np.where(is_valid, residuals * size, np.nan)
    return MirrorPoints(mesh.vertices + size * relative, residuals, is_valid)


def _rows_at_vertices(sphere_mesh: SphereMesh, size: float) -> FloatArray:
    """Rows (H, 5) of the faces seen from their corners, in the unit `size`."""
    mesh = sphere_mesh.mesh
    rows = recenter(sphere_mesh.local_spheres[mesh.topology.corner_faces], local_corners(mesh))
    return rows * np.array([size, 1.0, 1.0, 1.0, 1 / size])


def contact_points(sphere_mesh: SphereMesh) -> tuple[FloatArray, FloatArray]:
    """Discrete contact points: the points nearest to all spheres around each vertex.

    Least squares (V, 3) of the distances from the spheres, by steps of least length from the
    vertices: a vertex on fewer than three spheres moves no farther than it must. Unused
    vertices stay. Also the distances (V,) from the farthest of the spheres, in model units.

    References
    ----------
    Meshes with Spherical Faces, Def. 2.4.
    """
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    rows = _rows_at_vertices(sphere_mesh, size)
    moved = np.zeros((mesh.n_vertices, 3))
    cost, step = _contact_step(mesh, rows, moved)
    share = np.ones(mesh.n_vertices)
    for _ in range(_CONTACT_STEPS):
        trial = moved + share[:, None] * step
        trial_cost, trial_step = _contact_step(mesh, rows, trial)
        better = trial_cost < cost
        if not better.any() and (share * norm(step) <= EPSILON).all():
            break
        moved[better], step[better] = trial[better], trial_step[better]
        cost, share = np.where(better, trial_cost, cost), np.where(better, 1.0, share / 2)
    residuals = np.zeros(mesh.n_vertices)
    np.maximum.at(residuals, mesh.corners, np.abs(signed_distance(rows, moved[mesh.corners])))
    return mesh.vertices + size * moved, residuals * size


def _contact_step(
    mesh: Mesh, rows: FloatArray, moved: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Sum of squared distances at displaced vertices, and the Gauss-Newton step from there."""
    points = moved[mesh.corners]
    gradients = normals(rows, points)
    length = norm(gradients)[:, None]
    gradients = np.divide(gradients, length, out=np.zeros_like(gradients), where=length > 0)
    distances = signed_distance(rows, points)
    outer = (gradients[:, :, None] * gradients[:, None, :]).reshape(-1, 9)
    matrices = sum_by(mesh.corners, outer, mesh.n_vertices).reshape(-1, 3, 3)
    right = sum_by(mesh.corners, gradients * distances[:, None], mesh.n_vertices)
    inverse = np.linalg.pinv(matrices, rcond=DEGENERATE, hermitian=True)
    step = -np.einsum("nij,nj->ni", inverse, right)
    return sum_by(mesh.corners, distances**2, mesh.n_vertices), step


def ribaucour_residuals(sphere_mesh: SphereMesh) -> tuple[FloatArray, FloatArray]:
    """How far the two envelopes of a sphere mesh are from circular nets.

    It is a Q-congruence if its `mirror_points` have no residuals. Of each face (F,) of the
    mesh, and of the face of its mirror points: least singular value of the lifted corners that
    must vanish on a circle, relative to the largest. Zero for triangles; NaN where a corner has
    no mirror point.

    Notes
    -----
    If the congruence is a Q-congruence and one net is circular, the other is so by Miquel's
    theorem: the congruence is a discrete Ribaucour congruence.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.3.2.
    """
    mesh = sphere_mesh.mesh
    mirrored = mirror_points(sphere_mesh).points[mesh.corners]
    plus = np.zeros(mesh.n_faces)
    minus = np.zeros(mesh.n_faces)
    for faces, corners in batches_by_count(mesh.topology.corner_faces, mesh.n_faces):
        plus[faces] = _off_circle(mesh.vertices[mesh.corners[corners]])
        minus[faces] = _off_circle(mirrored[corners])
    return plus, minus


def _off_circle(points: FloatArray) -> FloatArray:
    """Fourth singular value of lifted points (n, k, 3) of unit size, relative to the first."""
    is_finite = _are_finite(points.reshape(len(points), -1))
    relative = np.where(is_finite[:, None, None], points, 0.0)
    relative = relative - relative.mean(axis=1, keepdims=True)
    size = np.sqrt(dot(relative, relative).mean(axis=1))[:, None, None]
    scaled = np.divide(relative, size, out=np.zeros_like(relative), where=size > 0)
    values = np.linalg.svd(pentaspherical(lift_points(scaled)), compute_uv=False)
    result = values[:, 3] / values[:, 0] if values.shape[1] > 3 else np.zeros(len(values))
    return np.where(is_finite, result, np.nan)


def _are_finite(rows: FloatArray) -> BoolArray:
    return np.asarray(np.isfinite(rows).all(axis=1), np.bool_)
