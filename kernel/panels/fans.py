"""Triangles of a face by its outline: a fan about its middle, or ears."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot


def are_stars(outlines: FloatArray) -> BoolArray:
    """Whether polygons (n, m, 2) can be seen whole from the origin, counter-clockwise."""
    return np.all(_cross(outlines, np.roll(outlines, -1, axis=1)) > 0, axis=1)


def cut_fan(steps: int, edges: Sequence[int]) -> IntArray:
    """Triangles of a fan with a sector for each edge, in so many steps from its middle.

    Point 0 is the middle; rings of 1, 2, ... points for each sector follow, and as the last one
    the rim, with as many points as each edge has steps.

    Examples
    --------
    >>> cut_fan(1, (1, 1, 2)).tolist()
    [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]
    """
    rings = [[[0]] * len(edges)]
    first = 1
    for ring in range(1, steps + 1):
        counts = edges if ring == steps else [ring] * len(edges)
        rings.append(_sectors(first, counts))
        first += sum(counts)
    triangles: list[tuple[int, int, int]] = []
    for inner, outer in pairwise(rings):
        for low, high in zip(inner, outer, strict=True):
            triangles += _between(low, high)
    return np.array(triangles, np.int64)


def _sectors(first: int, counts: Sequence[int]) -> list[list[int]]:
    """Points of a ring, sector by sector, each with the first point of the next one."""
    total = sum(counts)
    starts = np.cumsum([0, *counts]).tolist()
    return [
        [first + place % total for place in range(start, end + 1)]
        for start, end in pairwise(starts)
    ]


def _between(inner: list[int], outer: list[int]) -> list[tuple[int, int, int]]:
    """Triangles between two rows of points, evenly from their starts to their ends."""
    i, j, last, end = 0, 0, len(inner) - 1, len(outer) - 1
    triangles: list[tuple[int, int, int]] = []
    while i < last or j < end:
        # Whichever row's next step has its middle first.
        if i == last or (j < end and (2 * j + 1) * last <= (2 * i + 1) * end):
            triangles.append((inner[i], outer[j], outer[j + 1]))
            j += 1
        else:
            triangles.append((inner[i], outer[j], inner[i + 1]))
            i += 1
    return triangles


def cut_ears(outline: FloatArray) -> IntArray:
    """Triangulate a simple polygon (n, 2), counter-clockwise, by its ears: (n - 2, 3).

    A polygon that crosses itself, and has no ear left, is closed by triangles that may overlap.

    Examples
    --------
    >>> arrow = np.array([[0.0, 0.0], [2.0, -1.0], [1.0, 0.0], [2.0, 1.0]])
    >>> cut_ears(arrow).tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    left = list(range(len(outline)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        best = max(range(len(left)), key=lambda i: _ear_quality(outline, left, i))
        triangles.append((left[best - 1], left[best], left[(best + 1) % len(left)]))
        del left[best]
    triangles.append((left[0], left[1], left[2]))
    return np.array(triangles, np.int64)


def _ear_quality(outline: FloatArray, left: list[int], index: int) -> float:
    """Height over base of the triangle at a corner; below 0 where it is no ear."""
    others = [left[index - 1], left[index], left[(index + 1) % len(left)]]
    a, b, c = outline[others]
    area = float(_cross(b - a, c - a))
    rest = outline[[i for i in left if i not in others]]
    is_inside = (
        (_cross(b - a, rest - a) >= 0)
        & (_cross(c - b, rest - b) >= 0)
        & (_cross(a - c, rest - c) >= 0)
    )
    longest = max(float(dot(side, side)) for side in (b - a, c - b, a - c))
    return area / longest if area > 0 and not is_inside.any() else -1.0


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
