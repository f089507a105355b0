"""Whether the boundary of a face on a sphere crosses itself: exact tests of arcs."""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..tolerances import CROSSING, PARALLEL_PLANES
from .arcs import Arcs
from .incidence import evaluate, normals


def crossing_boundaries(
    rows: FloatArray,
    offsets: IntArray,
    plane_normals: FloatArray,
    plane_offsets: FloatArray,
    arcs: Arcs,
) -> BoolArray:
    """Whether two arcs of a boundary meet elsewhere than in their common corner.

    Parameters
    ----------
    rows : (P, 5) float array
        Unit rows, one per boundary; planes included.
    offsets : (P + 1,) int array
        First arc of each boundary, and H.
    plane_normals, plane_offsets : (H, 3), (H,) float array
        Planes ``n·x = d`` of the arcs, unit normals, in the coordinates of the rows.
    arcs : Arcs
        H arcs on the spheres, each from the end of the one before.

    Returns
    -------
    (P,) bool array
        True where the boundary crosses or touches itself.
    """
    result = np.zeros(len(rows), bool)
    degrees = np.diff(offsets)
    for degree in np.unique(degrees):
        members = np.flatnonzero(degrees == degree)
        first = offsets[members]
        for i in range(degree):
            for j in range(i + 1, degree):
                points = _plane_pair_points(
                    rows[members], plane_normals, plane_offsets, first + i, first + j
                )
                for point, is_finite in points:
                    result[members] |= (
                        is_finite
                        & _inside(arcs, first + i, point)
                        & _inside(arcs, first + j, point)
                    )
    return result


def _plane_pair_points(
    rows: FloatArray,
    plane_normals: FloatArray,
    plane_offsets: FloatArray,
    first: IntArray,
    second: IntArray,
) -> list[tuple[FloatArray, BoolArray]]:
    """The two points of each row on two planes, and whether they are points of space."""
    n, m = plane_normals[first], plane_normals[second]
    direction = np.cross(n, m)
    square = dot(direction, direction)
    is_parallel = square < PARALLEL_PLANES**2
    weight = np.where(is_parallel, 1.0, square)[:, None]
    foot = (
        plane_offsets[first][:, None] * np.cross(m, direction)
        + plane_offsets[second][:, None] * np.cross(direction, n)
    ) / weight
    direction = unit(direction)
    slope = dot(normals(rows, foot), direction)
    value = evaluate(rows, foot)
    discriminant = slope**2 - 4 * rows[:, 0] * value
    is_real = (discriminant >= 0) & ~is_parallel
    half = (slope + np.copysign(np.sqrt(np.maximum(discriminant, 0)), slope)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        near, far = value / half, half / rows[:, 0]
    result: list[tuple[FloatArray, BoolArray]] = []
    for root in (near, far):
        is_finite = is_real & np.isfinite(root)
        point = foot + np.where(is_finite, root, 0.0)[:, None] * direction
        result.append((point, is_finite))
    return result


def _inside(arcs: Arcs, ids: IntArray, points: FloatArray) -> BoolArray:
    """Whether points of the circles of arcs lie strictly between the ends of the arcs."""
    half = (arcs.ends[ids] - arcs.starts[ids]) / 2
    relative = points - (arcs.starts[ids] + arcs.ends[ids]) / 2
    square = dot(half, half)
    along = np.divide(
        dot(relative, half), square, out=np.full_like(square, np.inf), where=square > 0
    )
    across = dot(relative, arcs.rises[ids])
    sagitta = arcs.sagittas[ids]
    on_this_side = np.abs(across - sagitta) <= np.abs(sagitta) + CROSSING * norm(half)
    return (np.abs(along) < 1 - CROSSING) & on_this_side
