"""Pentaspherical coordinates, and the stereographic image of space on the unit 3-sphere."""

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm
from ..tolerances import EPSILON

SIGNATURE = np.diag([1.0, 1.0, 1.0, 1.0, -1.0])
"""J: the Minkowski product of pentaspherical coordinates s and t is ``sᵀ J t``."""


def pentaspherical(rows: FloatArray) -> FloatArray:
    """Pentaspherical coordinates ``(B, C - A, C + A)``, of signature (+, +, +, +, -)."""
    a, c = rows[..., :1], rows[..., 4:]
    return np.concatenate([rows[..., 1:4], c - a, c + a], axis=-1)


def from_pentaspherical(coordinates: FloatArray) -> FloatArray:
    """Rows of pentaspherical coordinates ``(B, C - A, C + A)``, (..., 5)."""
    minus, plus = coordinates[..., 3:4], coordinates[..., 4:5]
    return np.concatenate(
        [(plus - minus) / 2, coordinates[..., :3], (plus + minus) / 2], axis=-1
    )


def stereographic(points: FloatArray) -> FloatArray:
    """Stereographic image (..., 4) of points on the unit 3-sphere, from the north pole."""
    square = dot(points, points)[..., None]
    return np.concatenate([2 * points, square - 1], axis=-1) / (square + 1)


def inverse_stereographic(points: FloatArray) -> FloatArray:
    """Central projection from the north pole of the 3-sphere back to space, (..., 3).

    Of points (..., 4) of the unit 3-sphere, or poles of spheres (then centres come out);
    infinite for the north pole itself.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return points[..., :3] / (1 - points[..., 3:])


def pole(rows: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Pole, with respect to the unit 3-sphere, of the stereographic image of a sphere.

    ``(B, C - A) / (C + A)``, (..., 4), for rows of any scale; where ``C + A = 0`` the image is
    a great sphere and the pole at infinity: its direction, and True.

    References
    ----------
    Meshes with Spherical Faces, eq. (2).
    """
    coordinates = pentaspherical(rows)
    last = coordinates[..., 4]
    is_infinite = np.abs(last) <= EPSILON * norm(coordinates)
    divisor = np.where(is_infinite, 1.0, last)[..., None]
    return coordinates[..., :4] / divisor, is_infinite
