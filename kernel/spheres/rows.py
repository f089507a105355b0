"""
Spheres and planes as rows, their Minkowski product, and what follows from it.

A sphere is a row ``(A, Bx, By, Bz, C)``: the points x with ``A |x|² - B·x + C = 0``. Planes are
the rows with A = 0 (B the normal, C the offset of ``n·x = d``) and are never a special case.

The sign of a row is its orientation: ``N(p) = B - 2 A p`` is the unit normal at a point p of a
unit row, and 2A the curvature with respect to N (centre ``p + N / 2A``). On a sphere mesh N
agrees with the normal of the face.

The Minkowski product ``<<s, t>> = B·B' - 2 (A C' + A' C)`` of two unit rows is the cosine of
the angle between their normals at a common point: +1 is smooth contact, -1 a spike.

The formulas are those of Section 2.1 of the paper "Meshes with Spherical Faces".
"""

from enum import IntEnum

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..errors import InputError, name_ids
from ..tolerances import EPSILON


class Kind(IntEnum):
    """What a row stands for."""

    SPHERE = 0
    PLANE = 1
    POINT = 2
    IMAGINARY = 3


def from_center_radius(center: FloatArray, radius_squared: FloatArray) -> FloatArray:
    """
    Rows with A = 1, the paper's standard lift: N points to the centre.

    Parameters
    ----------
    center : (..., 3) float array
        Centres.
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
    """
    Rows of the planes ``n·x = d``.

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


def minkowski(s: FloatArray, t: FloatArray) -> FloatArray:
    """
    Minkowski product ``B·B' - 2 (A C' + A' C)`` of rows.

    Parameters
    ----------
    s, t : (..., 5) float array
        Rows, broadcast against each other.

    Returns
    -------
    (...) float array
        For unit rows the cosine of the oriented angle of intersection.

    Notes
    -----
    Rows far from the origin lose digits (the terms grow with the square of the distance): see
    them from a near point with `recenter` first.

    References
    ----------
    Meshes with Spherical Faces, eq. (5), without its sign.
    """
    return dot(s[..., 1:4], t[..., 1:4]) - 2 * (s[..., 0] * t[..., 4] + s[..., 4] * t[..., 0])


def minkowski_gradient(rows: FloatArray) -> FloatArray:
    """
    Derivative of the Minkowski product by the coefficients of its other factor.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows ``(A, B, C)``.

    Returns
    -------
    (..., 5) float array
        ``(-2 C, B, -2 A)``.
    """
    return rows[..., [4, 1, 2, 3, 0]] * np.array([-2.0, 1.0, 1.0, 1.0, -2.0])


def kind(rows: FloatArray) -> IntArray:
    """
    Classify rows as sphere, plane, point or imaginary sphere.

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


def center_radius(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """
    Centres and squared radii, for display and for writers.

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
    """
    Rows scaled to norm +1 (real) or -1 (imaginary); the orientation is kept.

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


def stereographic(points: FloatArray) -> FloatArray:
    """
    Stereographic image of points of space on the unit 3-sphere, from the north pole.

    Parameters
    ----------
    points : (..., 3) float array
        Points.

    Returns
    -------
    (..., 4) float array
        Points of norm 1.
    """
    square = dot(points, points)[..., None]
    return np.concatenate([2 * points, square - 1], axis=-1) / (square + 1)


def inverse_stereographic(points: FloatArray) -> FloatArray:
    """
    Central projection from the north pole of the 3-sphere back to space.

    Parameters
    ----------
    points : (..., 4) float array
        Points of R⁴; of the unit 3-sphere, or poles of spheres (then centres come out).

    Returns
    -------
    (..., 3) float array
        Points; infinite for the north pole itself.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return points[..., :3] / (1 - points[..., 3:])


def pole(rows: FloatArray) -> tuple[FloatArray, BoolArray]:
    """
    Pole, with respect to the unit 3-sphere, of the stereographic image of a sphere.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows of any scale.

    Returns
    -------
    pole : (..., 4) float array
        ``(B, C - A) / (C + A)``; where the pole is at infinity, its direction.
    is_infinite : (...) bool array
        Where ``C + A = 0``: the image is a great sphere.

    References
    ----------
    Meshes with Spherical Faces, eq. (2).
    """
    coordinates = pentaspherical(rows)
    last = coordinates[..., 4]
    is_infinite = np.abs(last) <= EPSILON * norm(coordinates)
    divisor = np.where(is_infinite, 1.0, last)[..., None]
    return coordinates[..., :4] / divisor, is_infinite


def pentaspherical(rows: FloatArray) -> FloatArray:
    """
    Pentaspherical coordinates ``(B, C - A, C + A)``, of signature (+, +, +, +, -).

    Parameters
    ----------
    rows : (..., 5) float array
        Rows.

    Returns
    -------
    (..., 5) float array
        Coordinates with the same Minkowski product.
    """
    a, c = rows[..., :1], rows[..., 4:]
    return np.concatenate([rows[..., 1:4], c - a, c + a], axis=-1)


def from_pentaspherical(coordinates: FloatArray) -> FloatArray:
    """
    Rows of pentaspherical coordinates.

    Parameters
    ----------
    coordinates : (..., 5) float array
        Coordinates ``(B, C - A, C + A)``.

    Returns
    -------
    (..., 5) float array
        Rows.
    """
    minus, plus = coordinates[..., 3:4], coordinates[..., 4:5]
    return np.concatenate(
        [(plus - minus) / 2, coordinates[..., :3], (plus + minus) / 2], axis=-1
    )


def lift_points(points: FloatArray) -> FloatArray:
    """
    Rows of points, seen as spheres of radius zero.

    Parameters
    ----------
    points : (..., 3) float array
        Points.

    Returns
    -------
    (..., 5) float array
        Rows with A = 1 and norm zero; ``<<s, p>> / -2`` is `evaluate` of s at p.
    """
    points = np.asarray(points, float)
    return from_center_radius(points, np.zeros(points.shape[:-1]))


def evaluate(rows: FloatArray, points: FloatArray) -> FloatArray:
    """
    Left side ``A |x|² - B·x + C`` of the sphere equation.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows.
    points : (..., 3) float array
        Points, broadcast against the rows.

    Returns
    -------
    (...) float array
        Zero on the sphere, negative on the side to which N points.

    References
    ----------
    Meshes with Spherical Faces, eq. (1).
    """
    return rows[..., 0] * dot(points, points) - dot(rows[..., 1:4], points) + rows[..., 4]


def normals(rows: FloatArray, points: FloatArray) -> FloatArray:
    """
    Gradient field ``N(p) = B - 2 A p``: the unit normal where p lies on a unit row.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows.
    points : (..., 3) float array
        Points.

    Returns
    -------
    (..., 3) float array
        Vectors; of length 1 exactly on the sphere.
    """
    return rows[..., 1:4] - 2 * rows[..., :1] * points


def signed_distance(rows: FloatArray, points: FloatArray) -> FloatArray:
    """
    Distance of points from unit rows, positive on the side to which N points.

    Parameters
    ----------
    rows : (..., 5) float array
        Unit rows, planes included.
    points : (..., 3) float array
        Points.

    Returns
    -------
    (...) float array
        Exact signed distances, without a division by A.
    """
    return -2 * evaluate(rows, points) / (1 + norm(normals(rows, points)))


def project(rows: FloatArray, points: FloatArray) -> FloatArray:
    """
    Nearest points of unit rows.

    Parameters
    ----------
    rows : (..., 5) float array
        Unit rows, planes included.
    points : (..., 3) float array
        Points; not the centre of their sphere.

    Returns
    -------
    (..., 3) float array
        Points on the spheres.
    """
    gradient = normals(rows, points)
    length = norm(gradient)
    step = 2 * evaluate(rows, points) / (length * (length + 1))
    return points + step[..., None] * gradient


def recenter(rows: FloatArray, origin: FloatArray) -> FloatArray:
    """
    The same spheres in coordinates whose origin is another point.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows.
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
    """
    Unit rows of the spheres scaled from the origin.

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
    """
    Parallel surfaces at a signed distance along N: concentric spheres, parallel planes.

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


def angle(s: FloatArray, t: FloatArray) -> FloatArray:
    """
    Oriented angle between unit rows, in [0, π]; accurate at smooth contact and at spikes.

    Parameters
    ----------
    s, t : (..., 5) float array
        Unit rows, seen from a point near their intersection (see `recenter`).

    Returns
    -------
    (...) float array
        Angles in radians: 0 smooth, π a spike. Spheres that do not meet get 0 or π.

    Notes
    -----
    Uses the norms of s - t and s + t: the arc cosine would lose half of the digits at 0.
    """
    opening = minkowski(s - t, s - t)
    closing = minkowski(s + t, s + t)
    return 2 * np.arctan2(np.sqrt(np.maximum(opening, 0)), np.sqrt(np.maximum(closing, 0)))


def meet_lines(
    rows: FloatArray, points: FloatArray, directions: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """
    Where lines meet spheres, nearest to a point of the line.

    Parameters
    ----------
    rows : (n, 5) float array
        Rows, planes included.
    points : (n, 3) float array
        Points p of the lines ``p + s u``.
    directions : (n, 3) float array
        Unit directions u.

    Returns
    -------
    parameters : (n,) float array
        The root s of least magnitude, in the form without cancellation; 0 where there is none.
    exists : (n,) bool array
        Whether the line meets the sphere.
    """
    slope = dot(normals(rows, points), directions)
    value = evaluate(rows, points)
    discriminant = slope**2 - 4 * rows[:, 0] * value
    denominator = slope + np.copysign(np.sqrt(np.maximum(discriminant, 0)), slope)
    exists = (discriminant >= 0) & ((denominator != 0) | (value == 0))
    use = exists & (denominator != 0)
    return np.divide(2 * value, denominator, out=np.zeros_like(slope), where=use), exists
