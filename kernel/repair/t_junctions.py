"""Vertices that lie on the edge of a face and are no corner of it."""

from dataclasses import replace

import numpy as np

from ..arrays import IntArray, dot, norm
from .raw_mesh import RawMesh
from .sides import find_sides


def split_t_junctions(raw: RawMesh, distance: float) -> tuple[RawMesh, IntArray]:
    """Make vertices on the edge of a face corners of that face.

    Only edges with a single face are looked at, and vertices at the end of such edges.

    Parameters
    ----------
    raw : RawMesh
        Faces without repeated corners.
    distance : float
        How close to the edge, in model units.

    Returns
    -------
    raw : RawMesh
        Faces with more corners; the new ones come after the corner that their edge leaves.
    junctions : (n, 2) int array
        Faces of `raw` and the vertices that they were given.
    """
    sides, vertices = _touching(raw, distance)
    if not len(sides):
        return raw, np.zeros((0, 2), np.int64)
    start = raw.vertices[raw.corners[sides]]
    along = raw.vertices[raw.corners[raw.next_corners[sides]]] - start
    places = dot(raw.vertices[vertices] - start, along) / dot(along, along)
    order = np.lexsort((places, sides))
    sides, vertices = sides[order], vertices[order]
    faces = raw.corner_faces[sides]
    n_new = np.bincount(faces, minlength=raw.n_faces)
    result = replace(
        raw,
        corners=np.insert(raw.corners, sides + 1, vertices),
        corner_ids=np.insert(raw.corner_ids, sides + 1, vertices),
        offsets=raw.offsets + np.concatenate([np.zeros(1, np.int64), np.cumsum(n_new)]),
    )
    return result, np.stack([faces, vertices], 1)


def _touching(raw: RawMesh, distance: float) -> tuple[IntArray, IntArray]:
    """Sides with a single face, and the vertices that lie between their ends."""
    from scipy.spatial import KDTree

    found = find_sides(raw)
    sides = np.flatnonzero(found.counts[found.edges] == 1)
    heads = raw.corners[raw.next_corners]
    candidates = np.unique([raw.corners[sides], heads[sides]])
    if not len(sides):
        return sides, candidates
    start, end = raw.vertices[raw.corners[sides]], raw.vertices[heads[sides]]
    lengths = norm(end - start)
    near = KDTree(raw.vertices[candidates]).query_ball_point(
        (start + end) / 2, lengths / 2 + distance, return_sorted=True
    )
    counts = np.array([len(ids) for ids in near], np.int64)
    rows = np.repeat(np.arange(len(sides)), counts)
    vertices = candidates[np.concatenate([np.asarray(ids, np.int64) for ids in near])]
    relative = raw.vertices[vertices] - start[rows]
    along = (end - start)[rows] / lengths[rows, None]
    place = dot(relative, along)
    off = norm(relative - place[:, None] * along)
    is_on = (off <= distance) & (place > distance) & (place < lengths[rows] - distance)
    rows, vertices = rows[is_on], vertices[is_on]
    # A face that touches itself stays as it is.
    keys = raw.corner_faces * len(raw.vertices) + raw.corners
    is_own = np.isin(raw.corner_faces[sides[rows]] * len(raw.vertices) + vertices, keys)
    sides, vertices = sides[rows[~is_own]], vertices[~is_own]
    # On two edges of one face a vertex would become a corner twice.
    _, firsts = np.unique(
        raw.corner_faces[sides] * len(raw.vertices) + vertices, return_index=True
    )
    firsts.sort()
    return sides[firsts], vertices[firsts]
