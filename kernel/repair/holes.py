"""Faces that pass a vertex twice, such as faces with a hole, cut into triangles."""

from dataclasses import replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, norm, unit
from ..errors import MeshError
from ..tolerances import DEGENERATE
from .raw_mesh import RawMesh


def faces_with_repeats(raw: RawMesh) -> IntArray:
    """Faces (n,) that pass a vertex more than once."""
    order = np.lexsort((raw.corners, raw.corner_faces))
    corners, faces = raw.corners[order], raw.corner_faces[order]
    is_repeat = (corners[1:] == corners[:-1]) & (faces[1:] == faces[:-1])
    return np.unique(faces[1:][is_repeat])


def triangulate_holes(raw: RawMesh, faces: IntArray) -> RawMesh:
    """Triangles in place of some faces, after all others.

    Parameters
    ----------
    faces : (n,) int array
        Faces whose boundary touches but does not cross itself, seen along their normal.

    Raises
    ------
    MeshError
        If the boundary of a face crosses itself.
    """
    corners: list[IntArray] = []
    numbers: list[int] = []
    for face in faces.tolist():
        ring: IntArray = np.arange(int(raw.offsets[face]), int(raw.offsets[face + 1]))
        flat = _flattened(raw.vertices[raw.corners[ring]])
        for loop in _loops(np.arange(len(ring)), raw.corners[ring], flat):
            triangles = _cut_ears(flat[loop])
            if triangles is None:
                raise MeshError(
                    "the boundary of face {0} crosses itself, no triangles fill it; delete it",
                    [int(raw.face_ids[face])],
                )
            corners.append(ring[loop[triangles]].ravel())
            numbers += [face] * len(triangles)
    kept = ~np.isin(np.arange(raw.n_faces), faces)
    order = np.concatenate([np.flatnonzero(kept[raw.corner_faces]), *corners])
    degrees = np.concatenate([raw.degrees[kept], np.full(len(numbers), 3)])
    return replace(
        raw,
        corners=raw.corners[order],
        corner_ids=raw.corner_ids[order],
        offsets=np.concatenate([np.zeros(1, np.int64), np.cumsum(degrees)]),
        face_ids=np.concatenate([raw.face_ids[kept], raw.face_ids[numbers]]),
    )


def _flattened(points: FloatArray) -> FloatArray:
    """Corners (n, 2) in the plane of their polygon, in units of its size."""
    points = points - points[:1]
    crosses = np.cross(points, np.concatenate([points[1:], points[:1]]))
    normal = unit(crosses.sum(axis=0, keepdims=True))
    first = unit(np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)]))
    axes = np.concatenate([first, np.cross(normal, first)])
    return points @ axes.T / norm(points).max()


def _loops(ring: IntArray, vertices: IntArray, flat: FloatArray) -> list[IntArray]:
    """Cut a polygon where it touches itself from outside: both loops run the same way round.

    Parameters
    ----------
    ring : (n,) int array
        Rows of `vertices` and `flat` in their order around the polygon.
    """
    seen: dict[int, int] = {}
    for place, vertex in enumerate(vertices[ring].tolist()):
        start = seen.get(vertex)
        seen[vertex] = place
        if start is None:
            continue
        inner, outer = ring[start:place], np.concatenate([ring[:start], ring[place:]])
        if min(_area(flat[inner]), _area(flat[outer])) > DEGENERATE:
            return _loops(inner, vertices, flat) + _loops(outer, vertices, flat)
    return [ring]


def _area(points: FloatArray) -> float:
    """Twice the area of a polygon (n, 2)."""
    x, y = points.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _cut_ears(flat: FloatArray) -> IntArray | None:
    """Triangles (n - 2, 3) of a polygon (n, 2), shortest diagonals first; None if it crosses.

    An ear is cut where its diagonal leaves both of its corners to the inside and meets no side:
    corners are told by their place in the ring, not by their point, so that both banks of a
    bridge keep their own side.
    """
    ring = list(range(len(flat)))
    triangles: list[list[int]] = []
    while len(ring) > 3:
        before, after = ring[-1:] + ring[:-1], ring[1:] + ring[:1]
        for tip in np.argsort(norm(flat[after] - flat[before]), kind="stable").tolist():
            if _is_ear(flat[before[tip:] + before[:tip]]):
                break
        else:
            return None
        triangles.append([before[tip], ring[tip], after[tip]])
        del ring[tip]
    if _turn(*flat[ring]) <= DEGENERATE:
        return None
    return np.array([*triangles, ring])


def _is_ear(points: FloatArray) -> bool:
    """Whether the second of the points (n, 2) around a polygon can be cut off."""
    start, tip, end = points[:3]
    if _turn(start, tip, end) <= DEGENERATE:
        return False
    is_open = _leaves_inwards(points[-1], start, tip, end) and _leaves_inwards(
        tip, end, points[3 % len(points)], start
    )
    if not is_open:
        return False
    # Sides that do not end at the diagonal must not cross it, nor end within it.
    a, b = points, np.roll(points, -1, axis=0)
    left, right = _turns(start, end, a), _turns(start, end, b)
    first, second = _turns(a, b, start), _turns(a, b, end)
    is_crossing = (left * right < 0) & (first * second < 0)
    along = end - start
    place = (points - start) @ along / (along @ along)
    is_within: BoolArray = (np.abs(left) <= DEGENERATE) & (place > 0) & (place < 1)
    is_end = (points == start).all(axis=1) | (points == end).all(axis=1)
    return not (is_crossing.any() or (is_within & ~is_end).any())


def _leaves_inwards(
    before: FloatArray, corner: FloatArray, after: FloatArray, target: FloatArray
) -> bool:
    """Whether the way from a corner to a point starts inside of the polygon, off its sides."""
    if _turn(before, corner, after) > 0:
        return bool(
            _turn(corner, after, target) > DEGENERATE
            and _turn(before, corner, target) > DEGENERATE
        )
    return bool(
        _turn(corner, after, target) > DEGENERATE or _turn(before, corner, target) > DEGENERATE
    )


def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return float((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]))


def _turns(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    ab, ac = b - a, c - a
    return ab[..., 0] * ac[..., 1] - ab[..., 1] * ac[..., 0]
