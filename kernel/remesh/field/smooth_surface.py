"""The smooth surface that a triangle mesh stands for, near its vertices a polynomial."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray, dot, norm
from .congruence_mesh import CongruenceMesh


@dataclass(frozen=True)
class SmoothSurface:
    """A surface that is smooth between the vertices of a mesh.

    Attributes
    ----------
    mesh : CongruenceMesh
        The mesh; everything is in its units, seen from its origin.
    heights : (V, 6) float array
        Heights over the tangential coordinates of `vertex_frames` at each vertex: value, two
        slopes, and the derivatives uu, uv, vv, as `fit_jets` finds them.
    """

    mesh: CongruenceMesh
    heights: FloatArray


def nearest_triangles(
    surface: CongruenceMesh, points: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Where points (n, 3) are nearest to the triangles.

    Corners of the nearest triangles (n, 3), and barycentric coordinates of the nearest points
    (n, 3).
    """
    import igl  # pyright: ignore[reportMissingTypeStubs]

    nearest: Any = igl.point_mesh_squared_distance  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
    _, triangles, feet = nearest(points, surface.points, surface.triangles)
    vertices = surface.triangles[np.asarray(triangles, np.int64)]
    return vertices, _barycentric(np.asarray(feet, np.float64), surface.points[vertices])


def surface_heights(
    surface: SmoothSurface, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Heights of points (n, 3) near a smooth surface over it.

    Signed distances (n,), to first order: those from the paraboloids at the corners of the
    nearest triangle, in the ratio of the barycentric coordinates; and their unit gradients
    (n, 3), but for the change of the ratio.
    """
    vertices, weights = nearest_triangles(surface.mesh, points)
    offsets = points[:, None] - surface.mesh.points[vertices]
    frames = surface.mesh.vertex_frames[vertices]
    x, y, z = np.einsum("ncij,ncj->inc", frames, offsets)
    value, x_slope, y_slope, xx, xy, yy = np.moveaxis(surface.heights[vertices], -1, 0)
    rise = value + x_slope * x + y_slope * y + (xx * x * x + yy * y * y) / 2 + xy * x * y
    slopes = np.stack([-x_slope - xx * x - xy * y, -y_slope - xy * x - yy * y], -1)
    gradients = frames[:, :, 2] + np.einsum("nci,ncij->ncj", slopes, frames[:, :, :2])
    height, gradient = dot(weights, z - rise), np.einsum("nc,ncj->nj", weights, gradients)
    length = norm(gradient)
    return height / length, gradient / length[:, None]


def _barycentric(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Barycentric coordinates (n, 3) of points in their triangles (n, 3, 3)."""
    opposite = np.roll(corners, -1, axis=1) - points[:, None]
    other = np.roll(corners, -2, axis=1) - points[:, None]
    sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(*sides)
    areas = np.einsum("nci,ni->nc", np.cross(opposite, other), normal)
    return areas / areas.sum(axis=1, keepdims=True)
