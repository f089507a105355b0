"""Quads on a region of the plane from the points of its boundary: grids, fans and discs.

A region with four sides is one grid, the Coons patch of its sides. A region with another number
of sides is divided from its middle into a grid for each corner. A region with a smooth boundary
is a square of quads in the middle, and four grids around it.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray

_INNER = 0.55
"""Size of the square inside a disc: there the angles at its corners are the best."""


class PlanarMesh(NamedTuple):
    """Faces in the plane that keep the points of a boundary.

    Attributes
    ----------
    points : (n, 2) float array
        First the points of the boundary as they were given, then those inside.
    faces : (m, 4) or (m, 3) int array
        Counter-clockwise quads or triangles.
    """

    points: FloatArray
    faces: IntArray


def grid_on_sides(sides: list[FloatArray]) -> PlanarMesh | None:
    """One grid between four sides.

    Parameters
    ----------
    sides : list of four (k + 1, 2) float array
        Points of the sides with both ends, counter-clockwise; opposite sides have as many.

    Returns
    -------
    PlanarMesh or None
        None where the grid would fold.
    """
    builder = _Builder(sides)
    builder.fill(builder.sides)
    return builder.finish()


def fan_on_sides(sides: list[FloatArray]) -> PlanarMesh | None:
    """A grid for each corner of a region, around its middle.

    Parameters
    ----------
    sides : list of (2 k + 1, 2) float array
        Points of the sides with both ends, counter-clockwise; all sides have as many.

    Returns
    -------
    PlanarMesh or None
        None where a grid would fold.
    """
    builder = _Builder(sides)
    half = len(sides[0]) // 2
    center = np.mean([side[half] for side in sides], axis=0)
    spokes = [builder.line(side[half], center, half) for side in builder.sides]
    last = builder.add(center[None])
    inwards = [
        np.concatenate([side[half : half + 1], spoke, last])
        for side, spoke in zip(builder.sides, spokes, strict=True)
    ]
    for i, side in enumerate(builder.sides):
        before = builder.sides[i - 1]
        builder.fill([side[: half + 1], inwards[i], inwards[i - 1][::-1], before[half:]])
    return builder.finish()


def disc_on_boundary(boundary: FloatArray) -> PlanarMesh | None:
    """A square of quads and four grids around it.

    Parameters
    ----------
    boundary : (4 k, 2) float array
        Points of a closed boundary, counter-clockwise, none twice.

    Returns
    -------
    PlanarMesh or None
        None where a grid would fold.
    """
    count = len(boundary) // 4
    closed = np.concatenate([boundary, boundary[:1]])
    sides = [closed[i * count : (i + 1) * count + 1] for i in range(4)]
    builder = _Builder(sides)
    center = boundary.mean(0)
    corners = [center + _INNER * (side[0] - center) for side in sides]
    rings = max(1, round(count / 2 * (1 - _INNER)))
    ids = [builder.add(corner[None]) for corner in corners]
    spokes = [
        np.concatenate(
            [outer[:1], builder.line(outer[0], corner, rings), inner],
        )
        for outer, corner, inner in zip(builder.sides, corners, ids, strict=True)
    ]
    # The square is round to half of what the boundary is.
    inner_sides: list[IntArray] = []
    for i, side in enumerate(sides):
        share = np.linspace(0, 1, count + 1)[1:-1, None]
        chord = corners[i] + share * (corners[(i + 1) % 4] - corners[i])
        bent = center + _INNER * (side[1:-1] - center)
        between = builder.add((chord + bent) / 2)
        inner_sides.append(np.concatenate([ids[i], between, ids[(i + 1) % 4]]))
    for i, outer in enumerate(builder.sides):
        after = spokes[(i + 1) % 4]
        builder.fill([outer, after, inner_sides[i][::-1], spokes[i][::-1]])
    builder.fill(inner_sides)
    return builder.finish()


class _Builder:
    """Points and quads of a region; the sides are numbered as a closed boundary."""

    def __init__(self, sides: list[FloatArray]) -> None:
        starts = np.cumsum([0, *(len(side) - 1 for side in sides)])
        self.count = int(starts[-1])
        self.parts = [np.concatenate([side[:-1] for side in sides])]
        self.sides: list[IntArray] = [
            np.arange(start, start + len(side)) % self.count
            for start, side in zip(starts, sides, strict=False)
        ]
        self.quads: list[IntArray] = []

    def add(self, points: FloatArray) -> IntArray:
        """Add points: their ids."""
        ids: IntArray = np.arange(self.count, self.count + len(points))
        self.parts.append(points)
        self.count += len(points)
        return ids

    def line(self, start: IntArray, end: FloatArray, steps: int) -> IntArray:
        """Add the points between a point, given by its id, and a place."""
        first = self.place(start)
        share = np.linspace(0, 1, steps + 1)[1:-1, None]
        return self.add(first + share * (end - first))

    def place(self, ids: IntArray) -> FloatArray:
        return np.concatenate(self.parts)[ids]

    def fill(self, sides: list[IntArray]) -> None:
        """Add a grid between four sides."""
        bottom, right, top, left = sides[0], sides[1], sides[2][::-1], sides[3][::-1]
        ids = np.empty((len(bottom), len(right)), np.int64)
        ids[:, 0], ids[:, -1], ids[0], ids[-1] = bottom, top, left, right
        grid = _coons(*map(self.place, (bottom, right, top, left)))
        inner = grid[1:-1, 1:-1]
        ids[1:-1, 1:-1] = self.add(inner.reshape(-1, 2)).reshape(inner.shape[:2])
        quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
        self.quads.append(quads.reshape(-1, 4))

    def finish(self) -> PlanarMesh | None:
        points, quads = np.concatenate(self.parts), np.concatenate(self.quads)
        a, b, c, d = np.moveaxis(points[quads], 1, 0)
        first, second = c - a, d - b
        is_left = first[:, 0] * second[:, 1] > first[:, 1] * second[:, 0]
        return PlanarMesh(points, quads) if is_left.all() else None


def _coons(
    bottom: FloatArray, right: FloatArray, top: FloatArray, left: FloatArray
) -> FloatArray:
    """The grid of points that four sides span, (n + 1, m + 1, 2)."""
    s = np.linspace(0, 1, len(bottom))[:, None, None]
    t = np.linspace(0, 1, len(right))[None, :, None]
    ruled = (1 - t) * bottom[:, None] + t * top[:, None] + (1 - s) * left + s * right
    low = (1 - s) * bottom[0] + s * bottom[-1]
    high = (1 - s) * top[0] + s * top[-1]
    return ruled - (1 - t) * low - t * high
