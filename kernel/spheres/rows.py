"""Rows of spheres, planes and points: their making, their kind, and their coordinates."""

from enum import IntEnum

import numpy as np

from ..arrays import FloatArray, IntArray, dot
from ..errors import InputError, name_ids
from ..tolerances import EPSILON
from .incidence import evaluate, normals
from .minkowski import minkowski


class Kind(IntEnum):
    """What a row stands for."""

    SPHERE = 0
    PLANE = 1
    POINT = 2
    IMAGINARY = 3


def kind(rows: FloatArray) -> IntArray:
    """Classify rows (..., 5) of any scale as sphere, plane, point or imaginary sphere.

    Values of `Kind`. A point is a row whose norm vanishes up to rounding.
    """
    a, b, c = rows[..., 0], rows[..., 1:4], rows[..., 4]
    discriminant = dot(b, b) - 4 * a * c
    rounding = 8 * EPSILON * (dot(b, b) + 4 * np.abs(a * c))
    result = np.full(discriminant.shape, int(Kind.SPHERE), np.int64)
    result[discriminant < -rounding] = Kind.IMAGINARY
    result[np.abs(discriminant) <= rounding] = Kind.POINT
    result[(a == 0) & (dot(b, b) > 0)] = Kind.PLANE
    return result


def from_center_radius(center: FloatArray, radius_squared: FloatArray) -> FloatArray:
    """Rows with A = 1, the paper's standard lift: N points to the centre; of norm ``4 r²``.

    Squared radii are zero for points, negative for imaginary spheres.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, standard lift.
    """
    center = np.asarray(center, float)
    a = np.ones((*center.shape[:-1], 1))
    c = dot(center, center) - np.asarray(radius_squared, float)
    return np.concatenate([a, 2 * center, c[..., None]], axis=-1)


def from_plane(normal: FloatArray, distance: FloatArray) -> FloatArray:
    """Unit rows (..., 5) with A = 0 of the planes ``n·x = d``, with unit normals n."""
    distance = np.asarray(distance, float)[..., None]
    normal, distance = np.broadcast_arrays(np.asarray(normal, float), distance)
    zero = np.zeros_like(distance[..., :1])
    return np.concatenate([zero, normal, distance[..., :1]], axis=-1)


def lift_points(points: FloatArray) -> FloatArray:
    """Rows of points, seen as spheres of radius zero: A = 1 and norm zero.

    ``<<s, p>> / -2`` is `evaluate` of s at p.
    """
    points = np.asarray(points, float)
    return from_center_radius(points, np.zeros(points.shape[:-1]))


def center_radius(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Centres and squared radii of rows of any scale, for display and for writers.

    ``B / 2A``, infinite for planes; and ``(|B|² - 4 A C) / 4 A²``, infinite for planes,
    negative for imaginary spheres.
    """
    a, b = rows[..., 0], rows[..., 1:4]
    with np.errstate(divide="ignore", invalid="ignore"):
        center = b / (2 * a[..., None])
        radius_squared = minkowski(rows, rows) / (4 * a * a)
    center[a == 0] = np.inf
    radius_squared = np.where(a == 0, np.inf, radius_squared)
    return center, radius_squared


def normalize(rows: FloatArray) -> FloatArray:
    """Rows of any scale scaled to norm +1 (real) or -1 (imaginary); the orientation is kept.

    Raises
    ------
    InputError
        If a row is a point, whose norm is zero.
    """
    is_point = np.atleast_1d(kind(rows) == Kind.POINT)
    if is_point.any():
        bad = name_ids(np.flatnonzero(is_point).tolist())
        raise InputError(f"rows {bad} are points (radius zero) and cannot be normalised")
    return rows / np.sqrt(np.abs(minkowski(rows, rows)))[..., None]


def recenter(rows: FloatArray, origin: FloatArray) -> FloatArray:
    """The same spheres in coordinates whose origin is another point (..., 3) of the old ones.

    Rows of the same norm; to go back, recentre at the negative of `origin`.
    """
    b = normals(rows, origin)
    c = evaluate(rows, origin)
    a = np.broadcast_to(rows[..., :1], (*b.shape[:-1], 1))
    return np.concatenate([a, b, c[..., None]], axis=-1)


def rescale(rows: FloatArray, factor: float) -> FloatArray:
    """Unit rows ``(A / factor, B, C factor)`` of the spheres scaled from the origin."""
    return rows * np.array([1 / factor, 1.0, 1.0, 1.0, factor])


def offset(rows: FloatArray, distance: FloatArray | float) -> FloatArray:
    """Parallel surfaces at a signed distance along N: concentric spheres, parallel planes.

    Unit rows ``(A, B, C + δ - A δ²) / (1 - 2 A δ)``, oriented as before; the distance is less
    than the radius where N points to the centre.

    Raises
    ------
    InputError
        If an offset reaches or passes the centre of its sphere.
    """
    distance = np.asarray(distance, float)
    factor = np.atleast_1d(1 - 2 * rows[..., 0] * distance)
    if (factor <= 0).any():
        bad = name_ids(np.flatnonzero(factor <= 0).tolist())
        raise InputError(f"the offset reaches the centre of spheres {bad}")
    result = rows.copy()
    result[..., 4] += distance - rows[..., 0] * distance**2
    return result / (1 - 2 * rows[..., 0] * distance)[..., None]
