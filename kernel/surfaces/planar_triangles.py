"""Triangles on any region of the plane, holes included, from the points of its boundary."""

from itertools import pairwise

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, norm
from ..errors import InputError
from ..tolerances import FLAT_TRIANGLE
from .planar_grids import PlanarMesh

_CLEARANCE = 0.65
"""Least distance of points inside from the boundary, in spacings."""


def triangulate_region(loops: list[FloatArray], spacing: float) -> PlanarMesh:
    """Triangles of a nearly equal size that keep the boundary.

    Parameters
    ----------
    loops : list of (k, 2) float array
        Points of closed boundaries, none twice: the outer one and those of the holes.
    spacing : float
        Length of the edges inside.

    Returns
    -------
    PlanarMesh
        The points of the loops in their order, then those inside.

    Raises
    ------
    InputError
        If the boundary crosses or touches itself.

    Notes
    -----
    A Delaunay triangulation of the boundary and of a lattice inside. Segments of the boundary
    that it lacks, because they are long where other parts of the boundary are near, are brought
    in by flips (Sloan, A fast algorithm for generating constrained Delaunay triangulations,
    1993).
    """
    from scipy.spatial import Delaunay, QhullError

    rim = np.concatenate(loops)
    points = np.concatenate([rim, _lattice(loops, spacing)])
    center, size = points.mean(0), np.ptp(points, axis=0).max()
    local = (points - center) / size
    try:
        triangles = np.asarray(Delaunay(local).simplices, np.int64)
    except QhullError as error:
        raise InputError("has no area") from error
    triangles = _turned_left(local, triangles)
    segments = _segments(loops)
    if len(np.unique(triangles)) < len(points):
        raise InputError("has a boundary that touches itself")
    triangles = _with_segments(local, triangles, segments)
    is_flat = (triangles < len(rim)).all(1) & (
        _areas(local, triangles) <= FLAT_TRIANGLE * (spacing / size) ** 2
    )
    middles = points[triangles].mean(1)
    triangles = triangles[inside_loops(loops, middles) & ~is_flat]
    expected = abs(sum(_loop_area(loop) for loop in _turned_loops(loops)))
    covered = _areas(points, triangles).sum()
    if not abs(covered - expected) <= np.sqrt(FLAT_TRIANGLE) * expected:
        raise InputError("has a boundary that crosses itself")
    return PlanarMesh(points, triangles)


def inside_loops(loops: list[FloatArray], points: FloatArray) -> BoolArray:
    """Whether points are inside a boundary and outside of its holes, (n,).

    Parameters
    ----------
    loops : list of (k, 2) float array
        Closed boundaries.
    points : (n, 2) float array
        Points off the boundary.

    Returns
    -------
    (n,) bool array
        True where a ray crosses the loops an odd number of times.
    """
    is_inside = np.zeros(len(points), bool)
    order = np.argsort(points[:, 1], kind="stable")
    heights = points[order, 1]
    for loop in loops:
        for a, b in zip(loop, np.roll(loop, -1, 0), strict=True):
            if a[1] == b[1]:
                continue
            low, high = np.searchsorted(heights, sorted((a[1], b[1])), "left")
            between = order[low:high]
            x, y = points[between].T
            crossing = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            is_inside[between] ^= x < crossing
    return is_inside


def _lattice(loops: list[FloatArray], spacing: float) -> FloatArray:
    """Points of a triangular lattice inside, not too near to the boundary."""
    from scipy.spatial import cKDTree

    outer = np.concatenate(loops)
    low, high = outer.min(0), outer.max(0)
    height = spacing * np.sqrt(0.75)
    counts = np.ceil((high - low) / (spacing, height)).astype(int) + 1
    n, m = counts.tolist()
    x, y = np.meshgrid(np.arange(float(n)), np.arange(float(m)), indexing="ij")
    # Centred, so that a symmetric region gets a symmetric lattice.
    start = (low + high - (counts - 1) * (spacing, height)) / 2
    grid = start + np.stack([(x + (y % 2) / 2) * spacing, y * height], -1).reshape(-1, 2)
    grid = grid[inside_loops(loops, grid)]
    dense = [
        a
        + np.linspace(0, 1, max(2, int(np.ceil(norm(b - a) / spacing * 4))))[:, None] * (b - a)
        for loop in loops
        for a, b in zip(loop, np.roll(loop, -1, 0), strict=True)
    ]
    distances, _ = cKDTree(np.concatenate(dense)).query(grid)
    return grid[distances > _CLEARANCE * spacing]


def _segments(loops: list[FloatArray]) -> IntArray:
    starts = np.cumsum([0, *(len(loop) for loop in loops)]).tolist()
    rings: list[IntArray] = [np.arange(a, b) for a, b in pairwise(starts)]
    return np.concatenate([np.stack([ring, np.roll(ring, -1)], 1) for ring in rings])


def _areas(points: FloatArray, triangles: IntArray) -> FloatArray:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return _cross(b - a, c - a) / 2


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _loop_area(loop: FloatArray) -> float:
    local = loop - loop[0]
    return float(_cross(local, np.roll(local, -1, 0)).sum() / 2)


def _turned_loops(loops: list[FloatArray]) -> list[FloatArray]:
    """The outer loop, the largest, counter-clockwise; the others clockwise."""
    areas = [_loop_area(loop) for loop in loops]
    largest = int(np.argmax(np.abs(areas)))
    return [
        loop if (area > 0) == (i == largest) else loop[::-1]
        for i, (loop, area) in enumerate(zip(loops, areas, strict=True))
    ]


def _turned_left(points: FloatArray, triangles: IntArray) -> IntArray:
    is_right = _areas(points, triangles) < 0
    return np.where(is_right[:, None], triangles[:, ::-1], triangles)


def _with_segments(points: FloatArray, triangles: IntArray, segments: IntArray) -> IntArray:
    """The triangulation with these edges in it, by flips of the edges that cross them."""
    opposite = {
        (int(t[i]), int(t[(i + 1) % 3])): int(t[(i + 2) % 3])
        for t in triangles
        for i in range(3)
    }
    missing = [
        (int(a), int(b)) for a, b in segments
        if (int(a), int(b)) not in opposite and (int(b), int(a)) not in opposite
    ]  # fmt: skip
    if not missing:
        return triangles
    for a, b in missing:
        # Flips for one segment may have brought in another.
        if (a, b) not in opposite and (b, a) not in opposite:
            _insert(points, opposite, a, b)
    found = {tuple(np.roll(t, -int(np.argmin(t)))) for t in _triangles_of(opposite)}
    return np.array(sorted(found), np.int64)


def _triangles_of(opposite: dict[tuple[int, int], int]) -> IntArray:
    return np.array([(a, b, c) for (a, b), c in opposite.items()], np.int64)


def _insert(
    points: FloatArray, opposite: dict[tuple[int, int], int], start: int, end: int
) -> None:
    crossing = _crossed_edges(points, opposite, start, end)
    budget = 8 * len(crossing) ** 2 + 64
    while crossing and budget:
        budget -= 1
        a, b = crossing.pop(0)
        c, d = opposite[a, b], opposite[b, a]
        # The edge may be flipped where its two triangles are a convex quad a, d, b, c.
        if _side(points, c, d, a) * _side(points, c, d, b) >= 0:
            crossing.append((a, b))
            continue
        for edge in ((a, b), (b, a)):
            del opposite[edge]
        opposite |= {(c, a): d, (a, d): c, (d, c): a, (d, b): c, (b, c): d, (c, d): b}
        if {c, d} & {start, end}:
            continue
        if _side(points, start, end, c) * _side(points, start, end, d) < 0:
            crossing.append((c, d))
    if crossing:
        raise InputError("has a boundary that crosses itself")


def _side(points: FloatArray, a: int, b: int, c: int) -> float:
    p, q, r = points[a], points[b], points[c]
    return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))


def _crossed_edges(
    points: FloatArray, opposite: dict[tuple[int, int], int], start: int, end: int
) -> list[tuple[int, int]]:
    """Edges that a segment crosses, one after the other."""
    for (a, b), c in opposite.items():
        if (
            c == start
            and _side(points, start, end, a) < 0 < _side(points, start, end, b)
            and _side(points, a, b, end) < 0
        ):
            break
    else:
        # A point of the boundary lies on the segment.
        raise InputError("has a boundary that touches itself")
    found = [(a, b)]
    while (b, a) in opposite and (tip := opposite[b, a]) != end:
        side = _side(points, start, end, tip)
        if side == 0:
            raise InputError("has a boundary that touches itself")
        a, b = (tip, b) if side < 0 else (a, tip)
        found.append((a, b))
    return found
