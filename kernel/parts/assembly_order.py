"""In which order parts may be put up: from below, each beside one that stands."""

from heapq import heapify, heappop, heappush

import numpy as np

from ..arrays import FloatArray, IntArray


def assembly_order(heights: FloatArray, pairs: IntArray) -> IntArray:
    """Place of each part in the order, from 1.

    The lowest comes first, then always the lowest that touches a part in place; where none
    does, the lowest of the others.

    Parameters
    ----------
    heights : (n,) float array
        How high parts are; among equal ones the first comes first.
    pairs : (m, 2) int array
        Parts that touch each other.

    Returns
    -------
    (n,) int array
        A permutation of 1 to n.

    Examples
    --------
    >>> assembly_order(np.array([0.0, 2.0, 1.0, 0.5]), np.array([[0, 1], [0, 2]]))
    array([1, 3, 2, 4])
    """
    count = len(heights)
    beside: list[list[int]] = [[] for _ in range(count)]
    touching: list[tuple[int, int]] = pairs.tolist()
    for first, second in touching:
        beside[first].append(second)
        beside[second].append(first)
    levels: list[float] = heights.tolist()
    waiting = [(level, part) for part, level in enumerate(levels)]
    heapify(waiting)
    places, place = [0] * count, 0
    while waiting:
        reachable = [heappop(waiting)]
        while reachable:
            _, part = heappop(reachable)
            if places[part]:
                continue
            place += 1
            places[part] = place
            for other in beside[part]:
                if not places[other]:
                    heappush(reachable, (levels[other], other))
    return np.array(places, np.int64)
