"""Minkowski product of rows: the cosine of the angle at which spheres meet."""

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm
from ..tolerances import EPSILON


def minkowski(s: FloatArray, t: FloatArray) -> FloatArray:
    """Minkowski product ``B·B' - 2 (A C' + A' C)`` of rows (..., 5), broadcast.

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
    """Derivative of the Minkowski product by its other factor: polar hyperplane of the rows.

    ``(-2 C, B, -2 A)`` for rows ``(A, B, C)``, (..., 5).
    """
    result = np.empty_like(rows)
    result[..., 0] = -2 * rows[..., 4]
    result[..., 1:4] = rows[..., 1:4]
    result[..., 4] = -2 * rows[..., 0]
    return result


def angle(s: FloatArray, t: FloatArray) -> FloatArray:
    """Oriented angle between unit rows, in [0, π]; accurate at smooth contact and at spikes.

    The rows (..., 5) are seen from a point near their intersection (see `recenter`). Radians: 0
    smooth, π a spike. Spheres that do not meet get 0 or π.

    Notes
    -----
    Uses the norms of s - t and s + t: the arc cosine would lose half of the digits at 0.
    """
    opening = minkowski(s - t, s - t)
    closing = minkowski(s + t, s + t)
    return 2 * np.arctan2(np.sqrt(np.maximum(opening, 0)), np.sqrt(np.maximum(closing, 0)))


def is_orthogonal(s: FloatArray, t: FloatArray) -> BoolArray:
    """Whether real spheres of any scale meet at a right angle: ``<<s, t>> = 0`` up to rounding.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1.
    """
    terms = norm(s[..., 1:4]) * norm(t[..., 1:4])
    terms = terms + 2 * np.abs(s[..., 0] * t[..., 4]) + 2 * np.abs(s[..., 4] * t[..., 0])
    return np.abs(minkowski(s, t)) <= 64 * EPSILON * terms
