"""Which triangle is seen in each sample of a picture: scanlines and a depth buffer, in arrays.

Every triangle is cut into its rows of samples, every row runs between the two sides that cross
it. A side is always followed from its upper end, so that two triangles with a common side share
the samples out without gaps and without overlap. A picture is taken in bands of rows: memory is
that of a band.
"""

import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..kernel.arrays import BoolArray, FloatArray, IntArray

_BATCH = 1 << 20
"""Samples that are drawn at a time, about: what bounds the memory."""

_DEPTH_STEPS = 2**31 - 1

_LOW, _HIGH = (1, 0) if sys.byteorder == "big" else (0, 1)
"""Which half of a whole number of 64 bits in memory is its triangle, and which its depth."""


_NOTHING = np.int64(-(2**63)) | np.int64(0xFFFFFFFF)
"""Of a sample in which nothing is seen: no triangle (-1), and the least of all depths."""


@dataclass(frozen=True)
class DepthPicture:
    """The nearest triangle of every sample, (height, width), and how near it is there.

    Nearness is counted in whole steps from the lowest one; the triangle is -1, and the steps
    are below 0, where there is none.
    """

    triangles: NDArray[np.int32]
    steps: NDArray[np.int32]
    lowest: float
    step: float

    @property
    def nearness(self) -> FloatArray:
        """Nearness of every sample, to about nine digits; -inf where nothing is seen."""
        return np.where(self.steps < 0, -np.inf, self.lowest + self.step * self.steps)


def affine_over_triangles(
    points: FloatArray, triangles: IntArray, values: FloatArray
) -> FloatArray:
    """Values (T, 3) at corners as affine functions over the picture of each triangle.

    Coefficients c (3, T) of ``c0 + c1 x + c2 y``, the mean where a triangle is seen edge on;
    points (N, 3) are samples to the right and downwards, and anything.
    """
    (ax, bx, cx), (ay, by, cy) = (points[:, k][triangles].T for k in (0, 1))
    bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
    va, vb, vc = values.T
    vb, vc = vb - va, vc - va
    area = bx * cy - by * cx
    is_thin = np.abs(area) < 1e-9
    area[is_thin] = np.inf
    along_x, along_y = (vb * cy - vc * by) / area, (vc * bx - vb * cx) / area
    constant = va - along_x * ax - along_y * ay
    constant[is_thin] = values[is_thin].mean(axis=1)
    return np.stack([constant, along_x, along_y])


def turns_left(points: FloatArray, triangles: IntArray) -> BoolArray:
    """Which triangles run counter-clockwise in the picture, where y points downwards."""
    (ax, bx, cx), (ay, by, cy) = (points[:, k][triangles].T for k in (0, 1))
    return (bx - ax) * (cy - ay) < (by - ay) * (cx - ax)


class Raster:
    """Triangles made ready to be drawn band by band.

    Points (N, 3) are samples to the right and downwards, and the nearness; triangles (T, 3) may
    have either orientation. Of `is_veil` (T,) only every other sample is drawn, like a
    chessboard.
    """

    def __init__(
        self,
        points: FloatArray,
        triangles: IntArray,
        width: int,
        is_veil: BoolArray | None = None,
    ) -> None:
        self.width = width
        self.is_veil = is_veil
        nearness = points[:, 2][triangles]
        self.lowest = float(nearness.min(initial=np.inf))
        spread = float(nearness.max(initial=-np.inf)) - self.lowest
        self.step = spread / _DEPTH_STEPS if spread > 0 else 1.0
        steps = (nearness - self.lowest) / self.step
        # From here on, the middles of the samples have whole coordinates.
        x, y = (points[:, k][triangles].T - 0.5 for k in (0, 1))
        depth = affine_over_triangles(points, triangles, steps)
        depth[0] += 0.5 * (depth[1] + depth[2])
        self.depth = depth
        self.first, self.last = _whole(y.min(axis=0)), _whole(y.max(axis=0))
        beside = (x.max(axis=0) < 0) | (x.min(axis=0) > width)
        self.last[beside] = self.first[beside]
        self.reach = np.minimum(np.ptp(x, axis=0), width) / 2 + 4
        self._order(x, y)

    def _order(self, x: FloatArray, y: FloatArray) -> None:
        """Sides from their upper ends: the long one, and those above and below the middle."""
        order = np.argsort(y, axis=0)
        (ax, bx, cx), (ay, by, cy) = (np.take_along_axis(each, order, 0) for each in (x, y))
        self.top, self.middle = ay, by

        def slope(x: FloatArray, y: FloatArray) -> FloatArray:
            return np.divide(x, y, out=np.zeros_like(x), where=y > 0)

        self.upper, self.upper_middle = ax, bx
        self.long, self.above = slope(cx - ax, cy - ay), slope(bx - ax, by - ay)
        self.below = slope(cx - bx, cy - by)

    def band(self, top: int, bottom: int) -> DepthPicture:
        """The rows from `top` to before `bottom`: of equally near triangles the last."""
        # Depth and triangle in one integer: the largest wins, whatever the order of work.
        buffer = np.full(self.width * (bottom - top), _NOTHING)
        chosen = np.flatnonzero((self.first < bottom) & (self.last > top))
        first = np.maximum(self.first[chosen], top)
        counts = np.minimum(self.last[chosen], bottom) - first
        load = np.cumsum(counts * self.reach[chosen])
        cuts = np.searchsorted(load, np.arange(_BATCH, float(load[-1:].sum()), _BATCH)).tolist()
        for start, end in zip([0, *cuts], [*cuts, len(chosen)], strict=True):
            part = slice(start, end)
            self._draw(buffer, top, chosen[part], first[part], counts[part])
        halves = buffer.view(np.int32).reshape(bottom - top, self.width, 2)
        found, steps = halves[..., _LOW].copy(), halves[..., _HIGH].copy()
        return DepthPicture(found, steps, self.lowest, self.step)

    def _draw(
        self, buffer: IntArray, top: int, owners: IntArray, first: IntArray, counts: IntArray
    ) -> None:
        """Draw rows of triangles, as many of each as it counts from its first."""
        rows = np.repeat(first, counts) + _steps(counts)
        left, right = self._crossings(owners, counts, rows)
        column = np.clip(_whole(left), 0, self.width)
        length = np.maximum(np.clip(_whole(right), 0, self.width) - column, 0)
        constant, along_x, along_y = (np.repeat(each[owners], counts) for each in self.depth)
        # Of all rows one after the other, the places are counted through.
        before = np.cumsum(length) - length
        constant += along_y * rows + along_x * (column - before)
        whose = np.repeat(owners, counts).astype(np.int32)
        place = np.arange(int(length.sum()))
        key = np.empty(len(place), np.int64)
        depth = np.repeat(along_x, length)
        depth *= place
        depth += np.repeat(constant, length)
        halves = key.view(np.int32).reshape(-1, 2)
        halves[:, _HIGH] = np.clip(depth, 0, _DEPTH_STEPS, out=depth)
        halves[:, _LOW] = np.repeat(whose, length)
        place += np.repeat((rows - top) * self.width + column - before, length)
        if self.is_veil is not None:
            is_odd = (place // self.width + place) & 1 == 1
            kept = ~(is_odd & self.is_veil[halves[:, _LOW]])
            key, place = key[kept], place[kept]
        np.maximum.at(buffer, place, key)

    def _crossings(
        self, owners: IntArray, counts: IntArray, rows: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """Where rows of samples enter and leave their triangles."""
        top, upper, long, above = (
            np.repeat(each[owners], counts)
            for each in (self.top, self.upper, self.long, self.above)
        )
        down = rows - top
        one, other = upper + down * long, upper + down * above
        middle = np.repeat(self.middle[owners], counts)
        lower = np.flatnonzero(rows >= middle)
        whose = np.repeat(owners, counts)[lower]
        other[lower] = (
            self.upper_middle[whose] + (rows[lower] - middle[lower]) * self.below[whose]
        )
        return np.minimum(one, other), np.maximum(one, other)


def rasterize(points: FloatArray, triangles: IntArray, width: int, height: int) -> DepthPicture:
    """A whole picture of triangles, in one band: see `Raster`."""
    return Raster(points, triangles, width).band(0, height)


def close_hairlines(picture: DepthPicture, is_veil: BoolArray | None = None) -> DepthPicture:
    """Fill gaps of one sample with what lies beside them.

    Samples behind both of their neighbours (left and right, or above and below) take the
    triangle of the first of them: a crack between two triangles, or a joint too narrow to be
    seen through. The holes of veils (T,) stay open.
    """
    triangles, steps = picture.triangles.copy(), picture.steps.copy()
    # A hundredth of the nearness, which is not that of its steps.
    behind = 0.01 * picture.lowest / picture.step
    for axis in (0, 1):
        t, n = np.moveaxis(triangles, axis, 0), np.moveaxis(steps, axis, 0)
        nearer = np.minimum(n[:-2], n[2:])
        is_crack = (n[1:-1] < 0.99 * nearer - behind) & (nearer >= 0)
        row, *rest = np.nonzero(is_crack)
        if is_veil is not None:
            kept = ~is_veil[t[(row, *rest)]]
            row, *rest = row[kept], *(each[kept] for each in rest)
        t[(row + 1, *rest)], n[(row + 1, *rest)] = t[(row, *rest)], n[(row, *rest)]
    return DepthPicture(triangles, steps, picture.lowest, picture.step)


def _whole(values: FloatArray) -> IntArray:
    """The first whole number from each value on; huge ones stay within reach of integers."""
    return np.ceil(np.clip(values, -(2.0**40), 2.0**40)).astype(np.int64)


def _steps(counts: IntArray) -> IntArray:
    """0, 1, 2, ... up to each count, one run after the other."""
    steps: IntArray = np.arange(int(counts.sum()))
    return steps - np.repeat(np.cumsum(counts) - counts, counts)
