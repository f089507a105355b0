"""Energy E_ortho: node axes near the normals of a surface.

The centres ``v + λ n`` of tangent spheres form a triangle mesh; the node axes are orthogonal to
its triangles. The residual of a triangle is ``max(0, cos² α - c |c|)``, with α the angle
allowed and c the cosine between the axis and the normalised mean of the normals at the
corners. The sign in ``c |c|`` tells an axis upside down from an upright one.

References: Meshes with Spherical Faces, Sec. 7, with a hinge in place of slack variables.
"""

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, unit


def axis_deviations(
    points: FloatArray, normals: FloatArray, triangles: IntArray, offsets: FloatArray
) -> FloatArray:
    """Angles (T,) between node axes and surface normals, in [0, π].

    Normals (V, 3) are unit, to the side of the centres, triangles counter-clockwise about them,
    and offsets (V,) the distances λ of the centres along them. Beyond π/2 the triangle of the
    centres is turned over.
    """
    axes, upright = _axes_and_normals(points, normals, triangles, offsets)
    axes = unit(axes)
    return 2 * np.arctan2(norm(axes - upright), norm(axes + upright))


def ortho_residuals(
    points: FloatArray,
    normals: FloatArray,
    triangles: IntArray,
    offsets: FloatArray,
    bound: float,
) -> tuple[FloatArray, FloatArray]:
    """Residuals (T,) of the node axes, and derivatives (T, 3) by the offsets at the corners.

    Arrays as for `axis_deviations`. Zero where the angle between axis and normal is within the
    bound, in radians.
    """
    axes, upright = _axes_and_normals(points, normals, triangles, offsets)
    height, square = dot(axes, upright), dot(axes, axes)
    square = np.where(square > 0, square, 1.0)
    excess = np.cos(bound) ** 2 - height * np.abs(height) / square
    corners = (points + offsets[:, None] * normals)[triangles]
    opposite = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    changes = np.cross(normals[triangles], opposite)
    steeper = dot(changes, upright[:, None]) - (height / square)[:, None] * dot(
        changes, axes[:, None]
    )
    slopes = -2 * (np.abs(height) / square)[:, None] * steeper
    is_active = excess > 0
    return np.where(is_active, excess, 0.0), np.where(is_active[:, None], slopes, 0.0)


def _axes_and_normals(
    points: FloatArray, normals: FloatArray, triangles: IntArray, offsets: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Normals of the triangles of centres, as long as twice their areas; unit mean normals."""
    a, b, c = (points + offsets[:, None] * normals)[triangles].transpose(1, 0, 2)
    axes = np.asarray(np.cross(b - a, c - a), np.float64)
    return axes, unit(normals[triangles].sum(axis=1))
