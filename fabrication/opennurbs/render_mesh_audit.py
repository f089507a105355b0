"""Judges the render meshes inside Breps from their bytes alone."""

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, dot, norm
from ...kernel.spheres.incidence import normals, signed_distance
from ...kernel.tolerances import SINGLE_EPSILON
from .brep_layout import FaceMesh
from .stream_reader import BufferPlace, buffer_content


def audit_render_meshes(
    streams: NDArray[np.uint8], mesh: FaceMesh, rows: FloatArray, origins: FloatArray
) -> tuple[FloatArray, list[tuple[str, BoolArray]]]:
    """How far the vertices of render meshes lie from their spheres, and what else is wrong.

    Unit rows (n, 5) of the spheres are relative to origins (n, 3). The largest distances (n,)
    are in model units; of vertices in float32 alone, what their rounding does not explain. Then
    each defect and the streams (n,) that have it.
    """
    points, rounding = _vertices(streams, mesh)
    local = points - origins[:, None]
    distances = np.abs(signed_distance(rows[:, None], local)).max(1)
    if mesh.points is None:
        distances = np.where(distances > rounding, distances, 0)
    rounded = _points(streams, mesh.floats, "<f4")
    vectors = _points(streams, mesh.normals, "<f4")
    triangles = mesh.triangles.astype(np.int64)
    corners = points[:, triangles]
    areas = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    facing = dot(areas, vectors[:, triangles[:, 0]]).sum(1)
    is_finite: BoolArray = norm(points).max(1) < np.inf
    is_rounded: BoolArray = norm(rounded - points.astype("<f4")).max(1) == 0
    allowed = 8 * SINGLE_EPSILON + 2 * np.abs(rows[:, 0]) * rounding
    is_normal: BoolArray = norm(vectors - normals(rows[:, None], local)).max(1) <= allowed
    return distances, [
        ("a number of the render mesh is not finite", ~is_finite),
        ("the vertices of the render mesh differ", ~is_rounded),
        ("a normal of the render mesh is not that of the sphere", ~is_normal),
        ("the render mesh looks inwards", ~(facing > 0)),
    ]


def _vertices(streams: NDArray[np.uint8], mesh: FaceMesh) -> tuple[FloatArray, FloatArray]:
    """Vertices (n, V, 3) as exact as they are there, and how far rounding moves them (n,)."""
    if mesh.points is not None:
        return _points(streams, mesh.points, "<f8"), np.zeros(len(streams))
    points = _points(streams, mesh.floats, "<f4")
    return points, SINGLE_EPSILON * np.abs(points).max((1, 2))


def _points(streams: NDArray[np.uint8], buffer: BufferPlace, dtype: str) -> FloatArray:
    """Points (n, V, 3) of a buffer; a deflated one is the same in all streams."""
    if buffer.is_deflated:
        content = np.frombuffer(buffer_content(streams[0].tobytes(), buffer), dtype)
        raw = np.broadcast_to(content, (len(streams), len(content)))
    else:
        raw = np.ascontiguousarray(streams[:, buffer.start : buffer.stop]).view(dtype)
    return raw.astype(np.float64).reshape(len(streams), -1, 3)
