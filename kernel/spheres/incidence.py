"""Points and lines against spheres: distances, normals, feet and crossings."""

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm


def evaluate(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Left side ``A |x|² - B·x + C`` of the sphere equation, rows (..., 5) at points (..., 3).

    Zero on the sphere, negative on the side to which N points.

    References
    ----------
    Meshes with Spherical Faces, eq. (1).
    """
    return rows[..., 0] * dot(points, points) - dot(rows[..., 1:4], points) + rows[..., 4]


def normals(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Gradient field ``N(p) = B - 2 A p``, (..., 3): the unit normal where p is on a unit row.

    Of length 1 exactly on the sphere.
    """
    return rows[..., 1:4] - 2 * rows[..., :1] * points


def signed_distance(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Distance of points (..., 3) from unit rows, positive on the side to which N points.

    Exact, without a division by A; planes included.
    """
    return -2 * evaluate(rows, points) / (1 + norm(normals(rows, points)))


def project(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Nearest points (..., 3) of unit rows, planes included; no point may be a centre."""
    gradient = normals(rows, points)
    length = norm(gradient)
    step = 2 * evaluate(rows, points) / (length * (length + 1))
    return points + step[..., None] * gradient


def meet_lines(
    rows: FloatArray, points: FloatArray, directions: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Where lines ``p + s u`` meet spheres (n, 5), nearest to p; planes included.

    With unit directions u the root s (n,) of least magnitude, in the form without cancellation;
    0 where there is none. Also whether the line meets the sphere.
    """
    slope = dot(normals(rows, points), directions)
    value = evaluate(rows, points)
    discriminant = slope**2 - 4 * rows[:, 0] * value
    denominator = slope + np.copysign(np.sqrt(np.maximum(discriminant, 0)), slope)
    exists = (discriminant >= 0) & ((denominator != 0) | (value == 0))
    use = exists & (denominator != 0)
    return np.divide(2 * value, denominator, out=np.zeros_like(slope), where=use), exists
