"""Faces that are none: out of range, without area, repeated; corners that repeat."""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, batches_by_count, norm
from ..tolerances import FARTHEST_PLACE
from .raw_mesh import RawMesh, keep_corners, keep_faces


def usable_faces(raw: RawMesh) -> BoolArray:
    """Faces (F,) with three corners or more, all of them on places that there are."""
    is_bad = (raw.corners < 0) | (raw.corners >= len(raw.vertices))
    no_places = np.flatnonzero(~(np.abs(raw.vertices) <= FARTHEST_PLACE).all(axis=1))
    is_bad |= np.isin(raw.corners, no_places)
    bad = np.bincount(raw.corner_faces[is_bad], minlength=raw.n_faces)
    return (bad == 0) & (raw.degrees > 2)


def drop_repeats(raw: RawMesh) -> RawMesh:
    """Faces without corners that repeat the one before, or lead to a vertex and back.

    Returns
    -------
    RawMesh
        The same faces, in the same order; some may have less than three corners.
    """
    while len(raw.corners):
        following = raw.next_corners
        before = np.empty_like(following)
        before[following] = np.arange(len(following))
        is_repeat = raw.corners == raw.corners[before]
        if not is_repeat.any():
            is_repeat = raw.corners[before] == raw.corners[following]
        # What is left of a face after its spikes is for the next round.
        if not is_repeat.any():
            break
        raw = keep_corners(raw, ~is_repeat)
    return raw


def narrow_faces(raw: RawMesh, width: float) -> BoolArray:
    """Faces (F,) of less than three corners, or all of whose corners lie close to a line.

    Parameters
    ----------
    width : float
        How close, in model units. The line leads from a corner that is farthest from the first
        one to the corner farthest from that.
    """
    result = raw.degrees < 3
    for faces, rows in batches_by_count(raw.corner_faces, raw.n_faces):
        if rows.shape[1] > 2:
            result[faces] = _widths(raw.vertices[raw.corners[rows]]) <= width
    return result


def _widths(points: FloatArray) -> FloatArray:
    """Largest distance (n,) of polygons (n, k, 3) from their longest extent."""
    polygons = np.arange(len(points))
    points = points - points[:, :1]
    start = points[polygons, norm(points).argmax(axis=1)][:, None]
    reach = norm(points - start)
    along = (points[polygons, reach.argmax(axis=1)] - start[:, 0])[:, None]
    length = np.where(reach.max(axis=1) > 0, reach.max(axis=1), 1.0)
    return norm(np.cross(points - start, along)).max(axis=1) / length


def repeated_faces(raw: RawMesh) -> IntArray:
    """Which faces repeat another: same corners around, in either direction.

    Returns
    -------
    (F,) int array
        For each face the first with its corners: itself, unless it repeats.
    """
    result = np.arange(raw.n_faces)
    for faces, rows in batches_by_count(raw.corner_faces, raw.n_faces):
        rings = _canonical_rings(raw.corners[rows])
        _, firsts, groups = np.unique(rings, axis=0, return_index=True, return_inverse=True)
        result[faces] = faces[firsts[groups.reshape(-1)]]
    return result


def _canonical_rings(rings: IntArray) -> IntArray:
    """Rings (n, k) from their least vertex on, towards the lesser of its neighbours."""
    degree = int(rings.shape[1])
    steps: IntArray = np.arange(degree)
    start = rings.argmin(axis=1)[:, None]
    forward = np.take_along_axis(rings, (start + steps) % degree, axis=1)
    backward = np.take_along_axis(rings, (start - steps) % degree, axis=1)
    is_forward = forward[:, 1:2] <= forward[:, -1:]
    return np.where(is_forward, forward, backward)


def drop_narrow_and_repeated(raw: RawMesh, width: float) -> tuple[RawMesh, IntArray, IntArray]:
    """Faces without those that have no area or repeat another.

    Returns
    -------
    raw : RawMesh
        The faces that are left, in their order.
    narrow : (n,) int array
        Input numbers of faces without area.
    repeats : (m, 2) int array
        Input numbers of faces that repeat another, and of that.
    """
    is_narrow = narrow_faces(raw, width)
    narrow = raw.face_ids[is_narrow]
    if is_narrow.any():
        raw = keep_faces(raw, ~is_narrow)
    same = repeated_faces(raw)
    is_repeat = same != np.arange(raw.n_faces)
    repeats = np.stack([raw.face_ids[is_repeat], raw.face_ids[same[is_repeat]]], 1)
    if is_repeat.any():
        raw = keep_faces(raw, ~is_repeat)
    return raw, narrow, repeats
