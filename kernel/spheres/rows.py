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
    """Classify rows as sphere, plane, point or imaginary sphere.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows of any scale.

    Returns
    -------
    (...) int array
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
    """Rows with A = 1, the paper's standard lift: N points to the centre.

    Parameters
    ----------
    center : (..., 3) float array
    radius_squared : (...) float array
        Squared radii; zero for points, negative for imaginary spheres.

    Returns
    -------
    (..., 5) float array
        Rows; their norm is ``4 r²``.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, standard lift.
    """
    center = np.asarray(center, float)
    a = np.ones((*center.shape[:-1], 1))
    c = dot(center, center) - np.asarray(radius_squared, float)
    return np.concatenate([a, 2 * center, c[..., None]], axis=-1)


def from_plane(normal: FloatArray, distance: FloatArray) -> FloatArray:
    """Rows of the planes ``n·x = d``.

    Parameters
    ----------
    normal : (..., 3) float array
        Unit normals.
    distance : (...) float array
        Signed distances of the origin, along the normal.

    Returns
    -------
    (..., 5) float array
        Unit rows with A = 0.
    """
    normal = np.asarray(normal, float)
    distance = np.broadcast_to(np.asarray(distance, float), normal.shape[:-1])
    zero = np.zeros((*normal.shape[:-1], 1))
    return np.concatenate([zero, normal, distance[..., None]], axis=-1)


def lift_points(points: FloatArray) -> FloatArray:
    """Rows of points, seen as spheres of radius zero.

    Parameters
    ----------
    points : (..., 3) float array

    Returns
    -------
    (..., 5) float array
        Rows with A = 1 and norm zero; ``<<s, p>> / -2`` is `evaluate` of s at p.
    """
    points = np.asarray(points, float)
    return from_center_radius(points, np.zeros(points.shape[:-1]))


def center_radius(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Centres and squared radii, for display and for writers.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows of any scale.

    Returns
    -------
    center : (..., 3) float array
        ``B / 2A``; infinite for planes.
    radius_squared : (...) float array
        ``(|B|² - 4 A C) / 4 A²``; infinite for planes, negative for imaginary spheres.
    """
    a, b = rows[..., 0], rows[..., 1:4]
    with np.errstate(divide="ignore", invalid="ignore"):
        center = b / (2 * a[..., None])
        radius_squared = minkowski(rows, rows) / (4 * a * a)
    center[a == 0] = np.inf
    radius_squared = np.where(a == 0, np.inf, radius_squared)
    return center, radius_squared


def normalize(rows: FloatArray) -> FloatArray:
    """Rows scaled to norm +1 (real) or -1 (imaginary); the orientation is kept.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows of any scale.

    Returns
    -------
    (..., 5) float array
        Rows with ``<<s, s>> = ±1``.

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
    """The same spheres in coordinates whose origin is another point.

    Parameters
    ----------
    rows : (..., 5) float array
    origin : (..., 3) float array
        New origins, in the old coordinates.

    Returns
    -------
    (..., 5) float array
        Rows of the same norm; to go back, recentre at the negative of `origin`.
    """
    b = normals(rows, origin)
    c = evaluate(rows, origin)
    a = np.broadcast_to(rows[..., :1], (*b.shape[:-1], 1))
    return np.concatenate([a, b, c[..., None]], axis=-1)


def rescale(rows: FloatArray, factor: float) -> FloatArray:
    """Unit rows of the spheres scaled from the origin.

    Parameters
    ----------
    rows : (..., 5) float array
        Unit rows.
    factor : float
        Positive factor.

    Returns
    -------
    (..., 5) float array
        Unit rows ``(A / factor, B, C factor)``.
    """
    return rows * np.array([1 / factor, 1.0, 1.0, 1.0, factor])


def offset(rows: FloatArray, distance: FloatArray | float) -> FloatArray:
    """Parallel surfaces at a signed distance along N: concentric spheres, parallel planes.

    Parameters
    ----------
    rows : (..., 5) float array
        Unit rows.
    distance : (...) float array or float
        Signed distances along N; less than the radius where N points to the centre.

    Returns
    -------
    (..., 5) float array
        Unit rows ``(A, B, C + δ - A δ²) / (1 - 2 A δ)``, oriented as before.

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
