"""The vertices of hexagons: where three spheres meet, the point nearest the triangle (Sec. 7).

Three spheres meet in two points, mirror images in the plane of their centres.
Rows are seen from points near the place where they meet, so that neither the position of the
model nor the size of nearly flat spheres costs digits.
"""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..meshes.mesh import Mesh, mean_edge_length
from ..spheres.row_checks import check_rows, seen_from, unit_rows
from ..spheres.rows import recenter
from ..tolerances import DEGENERATE


def meet_three(rows: FloatArray) -> tuple[FloatArray, BoolArray]:
    """The common point (n, 3) of three spheres or planes that lies nearest the origin.

    Unit rows (n, 3, 5) in coordinates whose origin and unit suit the place where they meet.
    Where the two common points are not real, the point half way between them: of the radical
    axis, in the plane of the centres. Also whether they are real: False as well where the three
    have more than two common points.

    Notes
    -----
    With ``q = |x|²`` the equations ``B·x - A q = C`` are linear: their solutions form a line
    in the space of (x, q), which meets the paraboloid in the two points. The one of smaller
    parameter, counted from the solution of least length, is nearer the origin. Nothing is
    divided by A, and for planes the second point goes to infinity.
    """
    # Neighbours differ little: differences are exact, and keep the small system balanced.
    system = np.stack([rows[:, 0], rows[:, 1] - rows[:, 0], rows[:, 2] - rows[:, 0]], 1)
    size = norm(system)[..., None]
    system = np.divide(system, size, out=np.zeros_like(system), where=size > 0)
    a, b = system[..., 0], system[..., 1:4]
    axis = np.einsum("ni,nij->nj", a, np.cross(np.roll(b, -1, 1), np.roll(b, -2, 1)))
    line = np.concatenate([axis, dot(b[:, 0], np.cross(b[:, 1], b[:, 2]))[:, None]], 1)
    length = norm(line)
    is_line = length > DEGENERATE * norm(system[:, 1, :4]) * norm(system[:, 2, :4])
    is_line &= length > 0
    line = np.where(is_line[:, None], line / np.where(is_line, length, 1.0)[:, None], 0.0)
    matrix = np.concatenate([np.concatenate([b, -a[..., None]], -1), line[:, None]], 1)
    matrix[~is_line] = np.eye(4)
    right = np.concatenate([system[..., 4], np.zeros((len(rows), 1))], 1)
    right[~is_line] = 0
    start = np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0], np.float64)
    return _meet_line(start, line, is_line)


def _meet_line(
    start: FloatArray, line: FloatArray, is_line: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """Where lines of the space (x, q) meet the paraboloid q = |x|², the root of least size."""
    square = dot(line[:, :3], line[:, :3])
    slope = 2 * dot(start[:, :3], line[:, :3]) - line[:, 3]
    value = dot(start[:, :3], start[:, :3]) - start[:, 3]
    discriminant = slope**2 - 4 * square * value
    is_real = is_line & (discriminant >= 0)
    divisor = slope + np.copysign(np.sqrt(np.maximum(discriminant, 0)), slope)
    zeros = np.zeros_like(value)
    near = np.divide(-2 * value, divisor, out=zeros.copy(), where=divisor != 0)
    half_way = np.divide(-slope, 2 * square, out=zeros, where=square > 0)
    is_real &= (divisor != 0) | (value == 0)
    step = np.where(is_real, near, half_way)
    return start[:, :3] + step[:, None] * line[:, :3], is_real


def vertex_rows(mesh: Mesh, spheres: ArrayLike) -> FloatArray:
    """Spheres at the vertices of a mesh, seen from them: unit rows (V, 5), in model units.

    The spheres are real rows of any scale, in model coordinates; the orientation is kept.

    Raises
    ------
    InputError
        If the rows do not match the vertices, are not finite, or are no real spheres or planes;
        the message names the vertices.
    """
    rows = np.asarray(spheres, float)
    check_rows(rows, mesh.n_vertices, "vertex")
    return unit_rows(seen_from(rows, mesh.vertices), np.arange(mesh.n_vertices))


def triangle_points(
    mesh: Mesh, rows: FloatArray, faces: IntArray | None = None
) -> tuple[FloatArray, BoolArray]:
    """Common point of the spheres of each triangle, the one nearest the triangle.

    Of rows of `vertex_rows`, for all triangles by default. Points (n, 3) relative to the
    centroids; where they are not real (False), of the radical axis.

    References
    ----------
    Meshes with Spherical Faces, Sec. 7.
    """
    triangles = mesh.corners.reshape(-1, 3)
    corners = triangles if faces is None else triangles[faces]
    positions = mesh.vertices[corners]
    relative = positions - positions[:, :1]
    origins = relative.mean(axis=1, keepdims=True)
    return meet_near(rows[corners], origins - relative, mean_edge_length(mesh))


def corner_reach(mesh: Mesh, points: FloatArray) -> FloatArray:
    """How far the common points of triangles lie from them.

    Points (T, 3) of `triangle_points`; distances (T,) from the centroids, relative to the
    longest side of the triangle.
    """
    corners = mesh.vertices[mesh.corners.reshape(-1, 3)]
    sides = np.roll(corners, -1, axis=1) - corners
    square = dot(sides, sides).max(axis=1)
    return np.sqrt(dot(points, points) / np.where(square > 0, square, 1.0))


def meet_near(
    rows: FloatArray, origins: FloatArray, size: float
) -> tuple[FloatArray, BoolArray]:
    """The common point of three spheres at each of many places, nearest the place.

    Unit rows (n, 3, 5), each seen from a point of its own; the place, seen from these points;
    and a unit of length to compute in, about the distance between the points. Points (n, 3)
    relative to the place, and whether they are real, as of `meet_three`.
    """
    units = np.array([size, 1.0, 1.0, 1.0, 1 / size])
    points, is_real = meet_three(recenter(rows, origins) * units)
    return points * size, is_real
