"""Pairs of bodies whose boxes are near: by a tree, none is missed."""

from itertools import chain
from typing import Any, cast

import numpy as np

from ..arrays import FloatArray, IntArray, norm


def near_pairs(
    boxes: FloatArray, others: FloatArray, distance: float
) -> tuple[IntArray, IntArray]:
    """Pairs of boxes (n, 2, 3) and others (m, 2, 3) that are no farther apart than a distance.

    Rows of both; boxes in cubes as large as the farthest two can be apart are looked at.
    """
    from scipy.spatial import KDTree

    if len(boxes) == 0 or len(others) == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    middles, radii = boxes.mean(axis=1), norm(boxes[:, 1] - boxes[:, 0]) / 2
    other_middles, other_radii = others.mean(axis=1), norm(others[:, 1] - others[:, 0]) / 2
    found: list[IntArray] = []
    rows: list[IntArray] = []
    # Large boxes are few: by size, so that they do not widen the search for all.
    order = np.argsort(other_radii)
    for part in np.array_split(order, 4):
        if len(part) == 0:
            continue
        tree = cast("Any", KDTree)(other_middles[part])
        reach = radii + other_radii[part].max() + distance
        lists: list[list[int]] = tree.query_ball_point(middles, reach).tolist()
        rows.append(np.repeat(np.arange(len(boxes)), [len(each) for each in lists]))
        found.append(part[np.array(list(chain.from_iterable(lists)), np.int64)])
    first, second = np.concatenate(rows), np.concatenate(found)
    gaps = np.maximum(boxes[first, 0] - others[second, 1], others[second, 0] - boxes[first, 1])
    near = (gaps <= distance).all(axis=1)
    return first[near], second[near]
