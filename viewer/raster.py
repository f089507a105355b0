"""Which triangle is seen in each pixel: scanlines and a depth buffer, in arrays.

Every triangle is cut into its rows of pixels, every row runs between the two sides that cross
it. A side is always followed from its upper end, so that two triangles with a common side share
its pixels out without gaps and without overlap.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..kernel.arrays import FloatArray, IntArray

_BATCH = 1 << 21
"""What bounds the memory that is used."""

_DEPTH_STEPS = 2**31 - 1


@dataclass(frozen=True)
class DepthPicture:
    """The nearest triangle of every pixel, (height, width), and its nearness there.

    -1 and -inf where there is none; the nearness has about nine digits.
    """

    triangles: IntArray
    nearness: FloatArray


def affine_over_triangles(
    points: FloatArray, triangles: IntArray, values: FloatArray
) -> FloatArray:
    """Values (T, 3) at corners as affine functions over the picture of each triangle.

    Coefficients c (T, 3) of ``c0 + c1 x + c2 y``, the mean where a triangle is seen edge on;
    points (N, 3) are pixels to the right and downwards, and anything.
    """
    a, b, c = np.moveaxis(points[triangles, :2], 1, 0)
    (bx, by), (cx, cy) = (b - a).T, (c - a).T
    vb, vc = (values[:, 1:] - values[:, :1]).T
    area = bx * cy - by * cx
    is_thin = np.abs(area) < 1e-9
    area = np.where(is_thin, np.inf, area)
    along_x, along_y = (vb * cy - vc * by) / area, (vc * bx - vb * cx) / area
    constant = values[:, 0] - along_x * a[:, 0] - along_y * a[:, 1]
    coefficients = np.stack([constant, along_x, along_y], axis=1)
    coefficients[is_thin, 0] = values[is_thin].mean(axis=1)
    return coefficients


def rasterize(points: FloatArray, triangles: IntArray, width: int, height: int) -> DepthPicture:
    """The nearest triangle of every pixel; of equally near ones the last.

    Points (N, 3) are pixels to the right and downwards, and the nearness; triangles (T, 3) may
    have either orientation.
    """
    # Depth and triangle in one integer: the largest wins, whatever the order of work.
    buffer = np.full(width * height, -1, np.int64)
    nearness = points[:, 2][triangles]
    low, high = float(nearness.min(initial=np.inf)), float(nearness.max(initial=-np.inf))
    scale = _DEPTH_STEPS / max(high - low, np.finfo(float).tiny) if high > low else 1.0
    depth = affine_over_triangles(points, triangles, (nearness - low) * scale)
    for owner, x, y in _pixels(points, triangles, width, height):
        constant, along_x, along_y = depth[owner].T
        value = constant + along_x * (x + 0.5) + along_y * (y + 0.5)
        key = np.clip(value, 0, _DEPTH_STEPS).astype(np.int64) << 32 | owner
        np.maximum.at(buffer, y * width + x, key)
    seen = buffer >= 0
    found = np.where(seen, buffer & 0xFFFFFFFF, -1)
    near = np.where(seen, (buffer >> 32) / scale + low, -np.inf)
    return DepthPicture(found.reshape(height, width), near.reshape(height, width))


def close_hairlines(picture: DepthPicture) -> DepthPicture:
    """Fill gaps of one pixel with what lies beside them.

    Pixels behind both of their neighbours (left and right, or above and below) take the
    triangle of the first of them: a crack between two triangles, or a joint too narrow to be
    seen through.
    """
    triangles, nearness = picture.triangles.copy(), picture.nearness.copy()
    for axis in (0, 1):
        t, n = np.moveaxis(triangles, axis, 0), np.moveaxis(nearness, axis, 0)
        is_crack = n[1:-1] < 0.99 * np.minimum(n[:-2], n[2:])
        t[1:-1][is_crack] = t[:-2][is_crack]
        n[1:-1][is_crack] = n[:-2][is_crack]
    return DepthPicture(triangles, nearness)


def _pixels(
    points: FloatArray, triangles: IntArray, width: int, height: int
) -> Iterator[tuple[IntArray, IntArray, IntArray]]:
    """Batches of (triangle, column, row) of the pixels whose middle lies in a triangle."""
    # From here on, the middles of the pixels have whole coordinates.
    x, y = np.moveaxis(points[triangles, :2] - 0.5, 2, 0)
    first = np.clip(np.ceil(y.min(axis=1)), 0, height).astype(np.int64)
    counts = np.clip(np.ceil(y.max(axis=1)), 0, height).astype(np.int64) - first
    counts[(x.max(axis=1) < 0) | (x.min(axis=1) > width)] = 0
    sides = _Sides.of(x, y)
    load = np.cumsum(counts * (np.minimum(x.max(axis=1) - x.min(axis=1), width) / 2 + 4))
    starts = np.searchsorted(load, np.arange(0, float(load[-1]) if len(load) else 0, _BATCH))
    for begin, end in pairwise([*starts.tolist(), len(triangles)]):
        chosen: IntArray = np.arange(int(begin), int(end))
        owner, step = _expand(chosen, counts[chosen])
        row = first[owner] + step
        left, right = sides.cross(owner, row)
        column = np.clip(np.ceil(left), 0, width).astype(np.int64)
        length = np.clip(np.ceil(right), 0, width).astype(np.int64) - column
        ids, step = _expand(np.arange(len(row)), np.maximum(length, 0))
        yield owner[ids], column[ids] + step, row[ids]


def _expand(ids: IntArray, counts: IntArray) -> tuple[IntArray, IntArray]:
    """Each id as often as it counts, and 0, 1, 2, ... within each."""
    starts = np.cumsum(counts) - counts
    steps: IntArray = np.arange(int(counts.sum()))
    return np.repeat(ids, counts), steps - np.repeat(starts, counts)


@dataclass(frozen=True)
class _Sides:
    """Sides (3, T) of triangles, from their upper to their lower end."""

    x: FloatArray
    top: FloatArray
    bottom: FloatArray
    slope: FloatArray

    @classmethod
    def of(cls, x: FloatArray, y: FloatArray) -> "_Sides":
        next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
        is_down = y <= next_y
        top, bottom = np.minimum(y, next_y), np.maximum(y, next_y)
        upper_x, lower_x = np.where(is_down, x, next_x), np.where(is_down, next_x, x)
        rise = np.where(bottom > top, bottom - top, 1.0)
        return cls(
            upper_x.T.copy(), top.T.copy(), bottom.T.copy(), ((lower_x - upper_x) / rise).T
        )

    def cross(self, owners: IntArray, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        """Where rows of pixels enter and leave their triangles."""
        left, right = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
        for side in range(3):
            top = self.top[side][owners]
            x = self.x[side][owners] + (rows - top) * self.slope[side][owners]
            spans = (top <= rows) & (rows < self.bottom[side][owners])
            np.minimum(left, x, out=left, where=spans)
            np.maximum(right, x, out=right, where=spans)
        return left, right
