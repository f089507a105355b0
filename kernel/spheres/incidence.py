"""Points and lines against spheres: distances, normals, feet and crossings."""

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm


def evaluate(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Left side ``A |x|² - B·x + C`` of the sphere equation.

    Parameters
    ----------
    rows : (..., 5) float array
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
    """Gradient field ``N(p) = B - 2 A p``: the unit normal where p lies on a unit row.

    Parameters
    ----------
    rows : (..., 5) float array
    points : (..., 3) float array

    Returns
    -------
    (..., 3) float array
        Vectors; of length 1 exactly on the sphere.
    """
    return rows[..., 1:4] - 2 * rows[..., :1] * points


def signed_distance(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Distance of points from unit rows, positive on the side to which N points.

    Parameters
    ----------
    rows : (..., 5) float array
        Unit rows, planes included.
    points : (..., 3) float array

    Returns
    -------
    (...) float array
        Exact signed distances, without a division by A.
    """
    return -2 * evaluate(rows, points) / (1 + norm(normals(rows, points)))


def project(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Nearest points of unit rows.

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


def meet_lines(
    rows: FloatArray, points: FloatArray, directions: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Where lines meet spheres, nearest to a point of the line.

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
