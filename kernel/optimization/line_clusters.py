"""The best clusters of numbers on a line, exactly: k-means in one dimension.

Clusters of sorted numbers are runs, so the least sum of squared distances to their means
follows by dynamic programming. Where the last run of the best clustering begins never
decreases with the number at which it ends: each search halves the next ones, and a level of
the halving is one array (Wang and Song, Ckmeans.1d.dp, 2011; Wu, Optimal quantization by
matrix searching, 1991).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from ..arrays import FloatArray, IntArray


@dataclass(frozen=True)
class _Sums:
    """Sums over the first n numbers, for n from 0: of weights, and of the first two moments."""

    weights: FloatArray
    firsts: FloatArray
    seconds: FloatArray

    def cost(self, starts: IntArray, ends: IntArray) -> FloatArray:
        """Sum of squared distances to the mean of each run ``[start, end)``, not empty."""
        weight = self.weights[ends] - self.weights[starts]
        first = self.firsts[ends] - self.firsts[starts]
        second = self.seconds[ends] - self.seconds[starts]
        return np.maximum(second - first**2 / weight, 0.0)


def line_clusters(values: FloatArray, weights: FloatArray, k: int) -> list[FloatArray]:
    """Means of the best clusters, for each number of clusters.

    Parameters
    ----------
    values : (n,) float array
        Distinct numbers, ascending.
    weights : (n,) float array
        How often each occurs, positive.
    k : int
        Largest number of clusters, from 1 to n.

    Returns
    -------
    list of (m,) float array
        Ascending means of m = 1 to k clusters, whose sum of squared distances is the least.

    Examples
    --------
    >>> means = line_clusters(np.array([0.0, 1, 10, 11, 20]), np.ones(5), 3)
    >>> [each.round(9).tolist() for each in means]
    [[8.4], [0.5, 13.666666667], [0.5, 10.5, 20.0]]
    """
    return list(islice(each_line_clusters(values, weights), k))


def each_line_clusters(values: FloatArray, weights: FloatArray) -> Iterator[FloatArray]:
    """Ascending means of the best 1, 2, ... clusters, up to one for each number.

    As `line_clusters`, for whoever does not know beforehand how many are needed: a cluster more
    costs no more than one search.
    """
    middle = float(np.average(values, weights=weights))
    centered = values - middle  # sums of squares keep their digits
    sums = _Sums(*(
        np.concatenate([[0.0], np.cumsum(weights * centered**power)]) for power in range(3)
    ))  # fmt: skip
    ends = np.arange(len(values) + 1)
    least = np.concatenate([[0.0], sums.cost(np.zeros_like(ends[1:]), ends[1:])])
    begins = [np.zeros_like(ends)]
    yield _means(begins, sums) + middle
    for count in range(1, len(values)):
        least, begin = _one_cluster_more(least, sums, count)
        begins.append(begin)
        yield _means(begins, sums) + middle


def _one_cluster_more(
    least: FloatArray, sums: _Sums, count: int
) -> tuple[FloatArray, IntArray]:
    """Least costs of the first n numbers with a cluster more than `count`, and its begin."""
    size = len(least)
    costs, begins = np.full(size, np.inf), np.full(size, count)
    step = 1 << (size - count).bit_length()
    while step := step // 2:
        ends = np.arange(count + step, size, 2 * step)
        if not len(ends):
            continue
        lows, after = begins[ends - step], ends + step
        highs = np.where(after < size, begins[np.minimum(after, size - 1)], size)
        highs = np.minimum(highs, ends - 1)
        counts = highs - lows + 1
        firsts = np.cumsum(counts) - counts
        starts: IntArray = np.arange(int(counts.sum())) - np.repeat(firsts - lows, counts)
        found = least[starts] + sums.cost(starts, np.repeat(ends, counts))
        costs[ends] = np.minimum.reduceat(found, firsts)
        ties = np.flatnonzero(found == np.repeat(costs[ends], counts))
        _, first_of_each = np.unique(np.repeat(ends, counts)[ties], return_index=True)
        begins[ends] = starts[ties[first_of_each]]
    return costs, begins


def _means(begins: list[IntArray], sums: _Sums) -> FloatArray:
    """Means of the clusters that end with the last number."""
    bounds = [len(sums.weights) - 1]
    for begin in reversed(begins):
        bounds.append(int(begin[bounds[-1]]))
    ends = np.array(bounds[::-1])
    return np.diff(sums.firsts[ends]) / np.diff(sums.weights[ends])
