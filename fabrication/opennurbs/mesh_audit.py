"""Judges the render meshes inside Breps from their bytes alone."""

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, dot, norm
from ...kernel.spheres.incidence import normals, signed_distance
from ...kernel.tolerances import SINGLE_EPSILON
from .brep_layout import FaceMesh
from .cursor import Buffer, inflated


def mesh_defects(
    streams: NDArray[np.uint8], mesh: FaceMesh, rows: FloatArray, origins: FloatArray
) -> list[tuple[str, BoolArray]]:
    """
    What is wrong with the render meshes of streams of one layout, other than their distances.

    Parameters
    ----------
    streams : (n, bytes) uint8 array
        The streams.
    mesh : FaceMesh
        Where the mesh stands.
    rows : (n, 5) float array
        Unit rows of the spheres, local.
    origins : (n, 3) float array
        Their origins.

    Returns
    -------
    list of (str, (n,) bool array)
        Each defect and the streams that have it.
    """
    points, rounding = _vertices(streams, mesh)
    rounded = _points(streams, mesh.floats, "<f4")
    vectors = _points(streams, mesh.normals, "<f4")
    exact = normals(rows[:, None], points - origins[:, None])
    triangles = mesh.triangles.astype(np.int64)
    corners = points[:, triangles]
    areas = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    facing = dot(areas, vectors[:, triangles[:, 0]]).sum(1)
    is_finite: BoolArray = norm(points).max(1) < np.inf
    is_rounded: BoolArray = norm(rounded - points.astype("<f4")).max(1) == 0
    allowed = 8 * SINGLE_EPSILON + 2 * np.abs(rows[:, 0]) * rounding
    is_normal: BoolArray = norm(vectors - exact).max(1) <= allowed
    return [
        ("a number of the render mesh is not finite", ~is_finite),
        ("the vertices of the render mesh differ", ~is_rounded),
        ("a normal of the render mesh is not that of the sphere", ~is_normal),
        ("the render mesh looks inwards", ~(facing > 0)),
    ]


def mesh_distances(
    streams: NDArray[np.uint8], mesh: FaceMesh, rows: FloatArray, origins: FloatArray
) -> FloatArray:
    """
    How far the vertices of render meshes lie from their spheres.

    Parameters
    ----------
    streams : (n, bytes) uint8 array
        Streams of one layout.
    mesh : FaceMesh
        Where the mesh stands.
    rows : (n, 5) float array
        Unit rows of the spheres, local.
    origins : (n, 3) float array
        Their origins.

    Returns
    -------
    (n,) float array
        The largest distances, in model units; of vertices in float32 alone, what their
        rounding does not explain.
    """
    points, rounding = _vertices(streams, mesh)
    distances = np.abs(signed_distance(rows[:, None], points - origins[:, None])).max(1)
    return np.where(distances > rounding, distances, 0) if mesh.points is None else distances


def _vertices(streams: NDArray[np.uint8], mesh: FaceMesh) -> tuple[FloatArray, FloatArray]:
    """Vertices (n, V, 3) as exact as they are there, and how far rounding moves them (n,)."""
    if mesh.points is not None:
        return _points(streams, mesh.points, "<f8"), np.zeros(len(streams))
    points = _points(streams, mesh.floats, "<f4")
    return points, SINGLE_EPSILON * np.abs(points).max((1, 2))


def _points(streams: NDArray[np.uint8], buffer: Buffer, dtype: str) -> FloatArray:
    """Points (n, V, 3) of a buffer; a deflated one is the same in all streams."""
    if buffer.is_deflated:
        content = np.frombuffer(inflated(streams[0].tobytes(), buffer), dtype)
        raw = np.broadcast_to(content, (len(streams), len(content)))
    else:
        raw = np.ascontiguousarray(streams[:, buffer.start : buffer.stop]).view(dtype)
    return raw.astype(np.float64).reshape(len(streams), -1, 3)
