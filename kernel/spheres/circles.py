"""Circles: as intersections of spheres, through points, and as carriers of pencils of spheres.

All spheres through a circle of radius ρ are ``S(t) = cos t P + sin t Q``, with P the oriented
plane of the circle and Q the sphere that has it as a great circle; both are unit rows and
``<<P, Q>> = 0``. The curvature of S(t) with respect to N is ``sin t / ρ``.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_vector_areas, local_corners
from ..tolerances import DEGENERATE, EPSILON
from .incidence import evaluate
from .minkowski import minkowski
from .rows import lift_points


class PencilKind(IntEnum):
    """What the spheres of a pencil have in common: a circle, a point, or nothing real."""

    ELLIPTIC = 0
    PARABOLIC = 1
    HYPERBOLIC = 2


@dataclass(frozen=True)
class Circles:
    """Oriented circles.

    Attributes
    ----------
    centers : (..., 3) float array
    normals : (..., 3) float array
        Unit normals of the planes.
    radii_squared : (...) float array
        Squared radii; negative for imaginary circles.
    """

    centers: FloatArray
    normals: FloatArray
    radii_squared: FloatArray


def pencil_kind(s: FloatArray, t: FloatArray) -> IntArray:
    """Kind of the pencil that two different spheres span: values of `PencilKind`.

    By the sign of ``<<s,s>> <<t,t>> - <<s,t>>²`` up to rounding, for rows (..., 5) of any
    scale.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, sphere pencils.
    """
    ss, tt, st = minkowski(s, s), minkowski(t, t), minkowski(s, t)
    discriminant = ss * tt - st**2
    # Each product is rounded at the size of its terms, which for spheres far from the origin
    # is much larger than itself.
    error_ss, error_tt = 64 * EPSILON * dot(s, s), 64 * EPSILON * dot(t, t)
    error_st = np.sqrt(error_ss * error_tt)
    rounding = (
        error_ss * np.abs(tt) + error_tt * np.abs(ss) + 2 * error_st * np.abs(st) + error_st**2
    )
    result = np.full(discriminant.shape, int(PencilKind.PARABOLIC), np.int64)
    result[discriminant > rounding] = PencilKind.ELLIPTIC
    result[discriminant < -rounding] = PencilKind.HYPERBOLIC
    return result


def intersection_circles(s: FloatArray, t: FloatArray) -> Circles:
    """Circles in which spheres meet, by unit rows (..., 5).

    Planes are allowed, but not two parallel planes or concentric spheres. The normal points
    along ``A B' - A' B``: for spheres of the same orientation from the centre of s to that of
    t. It changes sign when s and t swap. For two planes (a line, no circle) all entries are
    NaN.

    Notes
    -----
    The circle's plane is the member of the pencil with A = 0. Its centre is the foot, on that
    plane, of the centre of the least sphere of the pencil.

    References
    ----------
    Meshes with Spherical Faces, eq. (4).
    """
    plane = s[..., :1] * t - t[..., :1] * s
    length = norm(plane[..., 1:4])
    with np.errstate(divide="ignore", invalid="ignore"):
        plane = plane / length[..., None]
        # The member of the pencil orthogonal to the plane has the circle as a great circle.
        great = s - minkowski(s, plane)[..., None] * plane
        other = t - minkowski(t, plane)[..., None] * plane
        use_other = np.abs(other[..., 0]) > np.abs(great[..., 0])
        great = np.where(use_other[..., None], other, great)
        centers = great[..., 1:4] / (2 * great[..., :1])
        radii_squared = minkowski(great, great) / (4 * great[..., 0] ** 2)
    return Circles(centers, plane[..., 1:4], radii_squared)


def circle_pencils(circles: Circles) -> tuple[FloatArray, FloatArray]:
    """Orthogonal unit rows (..., 5) that span the spheres through real circles.

    P, the planes of the circles, and Q, the spheres with centre in the plane; N points to their
    centre.
    """
    radii = np.sqrt(circles.radii_squared)
    centers, unit_normals = circles.centers, circles.normals
    zero = np.zeros_like(radii)
    planes = np.concatenate(
        [zero[..., None], unit_normals, dot(unit_normals, centers)[..., None]], -1
    )
    constant = (dot(centers, centers) - circles.radii_squared) / (2 * radii)
    great_spheres = np.concatenate(
        [(0.5 / radii)[..., None], centers / radii[..., None], constant[..., None]], -1
    )
    return planes, great_spheres


def pencil_spheres(
    planes: FloatArray, great_spheres: FloatArray, angles: FloatArray
) -> FloatArray:
    """Members ``cos t P + sin t Q`` of circle pencils: unit rows (..., 5).

    P and Q are those of `circle_pencils`. The parameter t is 0 for the plane, ``asin(ρ κ)`` for
    the sphere of curvature κ.
    """
    return np.cos(angles)[..., None] * planes + np.sin(angles)[..., None] * great_spheres


def sphere_through_points(points: FloatArray) -> FloatArray:
    """Spheres or planes through four points (..., 4, 3), no four on a circle.

    Unit rows (..., 5); the orientation is arbitrary. NaN where the points coincide, or are not
    finite.
    """
    is_finite = np.asarray(np.isfinite(points).all(axis=(-2, -1)))
    points = np.where(is_finite[..., None, None], points, 0.0)
    center = points.mean(axis=-2, keepdims=True)
    size = norm(points - center).max(axis=-1)[..., None, None]
    is_point = ~(size > 0)
    size = np.where(is_point, 1.0, size)
    local = (points - center) / size
    system = lift_points(local) * np.array([1.0, -0.5, -0.5, -0.5, 1.0])
    # Rows of the system are (1, -p, |p|²); reordered, their null vector is (A, B, C).
    system = np.concatenate([system[..., 4:], system[..., 1:4], system[..., :1]], -1)
    row = np.linalg.svd(system)[2][..., -1, :]
    norms = np.where(is_point[..., 0, 0] | ~is_finite, np.nan, minkowski(row, row))
    row = row / np.sqrt(norms)[..., None]
    scale, shift = size[..., 0, 0], center[..., 0, :]
    a, b = row[..., 0] / scale, row[..., 1:4]
    constant = row[..., 4] * scale + a * dot(shift, shift) + dot(b, shift)
    b = b + 2 * a[..., None] * shift
    return np.concatenate([a[..., None], b, constant[..., None]], -1)


def angle_through_points(
    planes: FloatArray, great_spheres: FloatArray, points: FloatArray
) -> FloatArray:
    """Spheres of circle pencils through a further point (..., 3) each, off the circle.

    P and Q are those of `circle_pencils`. Their parameters t in (-π/2, π/2].
    """
    angles = np.arctan2(-evaluate(planes, points), evaluate(great_spheres, points))
    angles = np.where(angles > np.pi / 2, angles - np.pi, angles)
    return np.where(angles <= -np.pi / 2, angles + np.pi, angles)


def face_circles(mesh: Mesh) -> tuple[Circles, FloatArray]:
    """Best-fit circle of each face, in the coordinates local to the face.

    F circles, oriented by the face: in the plane through the centroid across the vector area,
    by linear least squares; exact for triangles and circular faces. Also the largest distance
    of a corner from the circle, (F,), in model units.

    Raises
    ------
    InputError
        If faces have no area, or corners in line; the message names them.
    """
    faces, count = mesh.topology.corner_faces, mesh.n_faces
    corners = local_corners(mesh)
    areas = face_vector_areas(mesh)
    size = np.sqrt(sum_by(faces, dot(corners, corners), count) / mesh.degrees)
    _refuse_degenerate(norm(areas) <= DEGENERATE * size**2)
    unit_normals = areas / norm(areas)[:, None]
    helper = np.eye(3)[np.argmin(np.abs(unit_normals), axis=1)]
    x_axis = unit(np.cross(unit_normals, helper))
    y_axis = np.cross(unit_normals, x_axis)
    scaled = corners / size[faces, None]
    x, y = dot(scaled, x_axis[faces]), dot(scaled, y_axis[faces])
    coordinates = np.stack([x, y, np.ones_like(x)], 1)
    square = x**2 + y**2
    outer = (coordinates[:, :, None] * coordinates[:, None, :]).reshape(-1, 9)
    matrices = sum_by(faces, outer, count).reshape(-1, 3, 3)
    right = sum_by(faces, coordinates * square[:, None], count)
    _refuse_degenerate(np.linalg.det(matrices) <= DEGENERATE**2)
    solution = np.linalg.solve(matrices, right[..., None])[..., 0]
    in_plane = solution[:, :2] / 2
    radii = np.sqrt(solution[:, 2] + dot(in_plane, in_plane)) * size
    centers = in_plane[:, :1] * x_axis + in_plane[:, 1:] * y_axis
    circles = Circles(centers * size[:, None], unit_normals, radii**2)
    return circles, _circle_miss(corners, circles, faces, mesh.offsets)


def _circle_miss(
    corners: FloatArray, circles: Circles, faces: IntArray, offsets: IntArray
) -> FloatArray:
    relative = corners - circles.centers[faces]
    height = dot(relative, circles.normals[faces])
    flat = norm(relative - height[:, None] * circles.normals[faces])
    distance = np.hypot(flat - np.sqrt(circles.radii_squared)[faces], height)
    return np.maximum.reduceat(distance, offsets[:-1])


def _refuse_degenerate(is_bad: BoolArray) -> None:
    if is_bad.any():
        bad = name_ids(np.flatnonzero(is_bad).tolist())
        raise InputError(f"faces {bad} have zero area or all corners in line; remove them")
