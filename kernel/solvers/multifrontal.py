"""Cholesky factors of sparse symmetric matrices made of blocks, front by front.

The elements (of a few unknowns each) are ordered by nested dissection. The separators are the
fronts: small dense matrices, in which LAPACK eliminates the front's own elements and hands what
is left of those that come later to the front above. So nearly all the work is dense, at the
speed of the processor, with nothing to install. A matrix that is not positive definite has a
front that is not: LAPACK says so, and the factorisation ends there. That is the check of the
inertia that Newton's method needs.
"""

import itertools
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from .dissection import dissect

SMALLEST_TRIANGLE = 32
"""Triangles of so few unknowns are not halved."""

Run: TypeAlias = tuple[int, int, int]
"""First and end of unknowns side by side, and where the first of them goes."""


class Front(NamedTuple):
    """One front: which unknowns it eliminates, and where entries go.

    Attributes
    ----------
    start, stop : int
        Its unknowns, in the order of elimination.
    later : (m,) int array
        Unknowns of later fronts that it touches, ascending.
    parent : int
        Front to which what is left is handed; -1 for none.
    into_own, into_later : tuples of Run
        Where `later` is among the unknowns, and among the later unknowns, of the parent.
    diagonal_places, own_pairs, own_places, later_pairs, later_places : int arrays
        Where the blocks of the diagonal and of the pairs go in the two tables of the front.
    """

    start: int
    stop: int
    later: IntArray
    parent: int
    into_own: tuple[Run, ...]
    into_later: tuple[Run, ...]
    diagonal_places: IntArray
    own_pairs: IntArray
    own_places: IntArray
    later_pairs: IntArray
    later_places: IntArray


@dataclass(frozen=True)
class FrontalPattern:
    """How matrices of one pattern are factorised.

    Attributes
    ----------
    width : int
        Unknowns per element.
    order : (n,) int array
        Elements in the order of elimination.
    is_upper : (m,) bool array
        Pairs whose first element is eliminated first: their blocks are turned over.
    fronts : tuple of Front
        Children before their parents.
    """

    width: int
    order: IntArray
    is_upper: BoolArray
    fronts: tuple[Front, ...]

    @property
    def entries(self) -> int:
        """Numbers that the factors keep."""
        sizes = ((front.stop - front.start, len(front.later)) for front in self.fronts)
        return sum(own * (own + later) for own, later in sizes)


@dataclass(frozen=True)
class FrontalFactors:
    """Cholesky factors: of each front the triangle (k, k) of its own, and (m, k) below."""

    pattern: FrontalPattern
    triangles: tuple[FloatArray, ...]
    below: tuple[FloatArray, ...]


def frontal_pattern(points: FloatArray, pairs: IntArray, width: int) -> FrontalPattern:
    """Plan the factorisation of matrices with a block per element and per pair.

    Parameters
    ----------
    points : (n, d) float array
        Where the elements are; elements that touch should lie near.
    pairs : (m, 2) int array
        Elements with a block off the diagonal, each pair once.
    width : int
        Unknowns per element.
    """
    nodes = dissect(points, pairs)
    levels = _levels(nodes)
    deepest = int(levels.max(initial=0))
    # Children before parents: by the end of the interval of leaves below, then from below.
    ends = (nodes - (1 << levels) + 1) << (deepest - levels)
    order = np.lexsort((nodes, -levels, ends))
    places = np.empty(len(nodes), np.int64)
    places[order] = np.arange(len(nodes))
    earlier, later = np.sort(places[pairs], axis=1).T
    touched = _touched(nodes[order], levels[order], earlier, later)

    kept, starts, counts = np.unique(nodes[order], return_index=True, return_counts=True)
    own = {
        int(node): (int(start), int(start + count))
        for node, start, count in zip(kept, starts, counts, strict=True)
    }
    tree = np.array(sorted(own, key=lambda node: own[node][0]), np.int64)
    numbers = {int(node): number for number, node in enumerate(tree)}
    firsts = np.array([own[int(node)][0] for node in tree], np.int64)
    by_front = np.asarray(np.searchsorted(firsts, earlier, side="right"), np.int64)
    sorted_pairs = np.argsort(by_front, kind="stable")
    bounds = np.searchsorted(by_front[sorted_pairs], np.arange(1, len(tree) + 2))
    fronts: list[Front] = []
    for number, node in enumerate(tree.tolist()):
        parent = node // 2
        while parent and parent not in own:
            parent //= 2
        above = own.get(parent, (0, 0)), touched.get(parent, np.zeros(0, np.int64))
        ids = sorted_pairs[bounds[number] : bounds[number + 1]]
        rows, columns = later[ids], earlier[ids]
        mine = own[node], touched.get(node, np.zeros(0, np.int64))
        fronts.append(_front(mine, above, numbers.get(parent, -1), (ids, rows, columns), width))
    return FrontalPattern(
        width, order, places[pairs[:, 0]] < places[pairs[:, 1]], tuple(fronts)
    )


Extent = tuple[tuple[int, int], IntArray]
"""First and end of a front's own elements, and the later elements that it touches."""


def _front(
    mine: Extent,
    above: Extent,
    parent: int,
    blocks: tuple[IntArray, IntArray, IntArray],
    width: int,
) -> Front:
    (start, stop), touched = mine
    (parent_start, parent_stop), parent_touched = above
    ids, rows, columns = blocks
    columns = columns - start
    inside = rows < stop
    is_own = (touched >= parent_start) & (touched < parent_stop)
    own, later = stop - start, len(touched)
    diagonal = np.arange(own)
    return Front(
        start * width,
        stop * width,
        _unknowns(touched, width),
        parent,
        _runs(np.flatnonzero(is_own), touched[is_own] - parent_start, width),
        _runs(
            np.flatnonzero(~is_own), np.searchsorted(parent_touched, touched[~is_own]), width
        ),
        _places(diagonal, diagonal, own, width),
        ids[inside],
        _places(rows[inside] - start, columns[inside], own, width),
        ids[~inside],
        _places(np.searchsorted(touched, rows[~inside]), columns[~inside], later, width),
    )


def _levels(nodes: IntArray) -> IntArray:
    return np.frexp(nodes.astype(np.float64))[1].astype(np.int64) - 1


def _runs(elements: IntArray, places: IntArray, width: int) -> tuple[Run, ...]:
    """Runs of unknowns that stay side by side."""
    breaks = np.flatnonzero((np.diff(places) != 1) | (np.diff(elements) != 1)) + 1
    bounds = [0, *breaks.tolist(), len(places)]
    return tuple(
        (
            width * int(elements[first]),
            width * int(elements[stop - 1] + 1),
            width * int(places[first]),
        )
        for first, stop in itertools.pairwise(bounds)
        if stop > first
    )


def _unknowns(elements: IntArray, width: int) -> IntArray:
    return (elements[:, None] * width + np.arange(width)).ravel()


def _places(rows: IntArray, columns: IntArray, height: int, width: int) -> IntArray:
    """Places of the entries of blocks in a table stored column after column."""
    inner = np.arange(width)
    row = rows[:, None, None] * width + inner[:, None]
    column = columns[:, None, None] * width + inner
    return (row + height * width * column).ravel()


def _touched(
    nodes: IntArray, levels: IntArray, earlier: IntArray, later: IntArray
) -> dict[int, IntArray]:
    """Elements of later fronts that remain when a front is eliminated, by node.

    Elements are in the order of elimination; so are those of each front.
    """
    n = np.int64(max(len(nodes), 1))
    leaves_front = nodes[earlier] != nodes[later]
    tails, heads = nodes[earlier[leaves_front]], later[leaves_front]
    tail_levels = levels[earlier[leaves_front]]
    handed_up = np.zeros(0, np.int64), np.zeros(0, np.int64)
    result: dict[int, IntArray] = {}
    for level in range(int(levels.max(initial=0)), 0, -1):
        here = tail_levels == level
        owner = np.concatenate([tails[here], handed_up[0]])
        element = np.concatenate([heads[here], handed_up[1]])
        keys = np.unique((owner * n + element)[nodes[element] != owner])
        owner, element = keys // n, keys % n
        found, starts = np.unique(owner, return_index=True)
        result |= zip(found.tolist(), np.split(element, starts)[1:], strict=True)
        handed_up = owner // 2, element
    return result


def factorize_fronts(
    pattern: FrontalPattern, diagonal: FloatArray, mixed: FloatArray
) -> FrontalFactors | None:
    """Cholesky factors, or None where the matrix is not positive definite.

    Parameters
    ----------
    diagonal : (n, width, width) float array
        Blocks on the diagonal.
    mixed : (m, width, width) float array
        Blocks of the pairs, rows by the first element.
    """
    from scipy.linalg.blas import dsyrk
    from scipy.linalg.lapack import dpotrf

    diagonal = diagonal[pattern.order]
    mixed = np.where(pattern.is_upper[:, None, None], mixed.transpose(0, 2, 1), mixed)
    waiting: list[list[tuple[Front, FloatArray]]] = [[] for _ in pattern.fronts]
    triangles: list[FloatArray] = []
    below: list[FloatArray] = []
    for number, front in enumerate(pattern.fronts):
        own, under, rest = _assembled(front, pattern.width, diagonal, mixed, waiting[number])
        waiting[number].clear()
        own, failed = dpotrf(own, lower=1, overwrite_a=1, clean=0)
        if failed:
            return None
        if len(front.later):
            _divide(under, own)
            rest = dsyrk(-1.0, under, beta=1.0, c=rest, lower=1, overwrite_c=1)
            waiting[front.parent].append((front, rest))
        triangles.append(own)
        below.append(under)
    return FrontalFactors(pattern, tuple(triangles), tuple(below))


def _divide(rows: FloatArray, triangle: FloatArray) -> None:
    """Multiply rows (m, k) by the inverse of the transpose of a triangle (k, k), in place.

    Halves of it by multiplication of matrices, which is several times faster than the routine
    for triangles; that one does the small rest.
    """
    from scipy.linalg.blas import dgemm, dtrsm

    size = len(triangle)
    if size <= SMALLEST_TRIANGLE:
        dtrsm(1.0, triangle, rows, side=1, lower=1, trans_a=1, overwrite_b=1)
        return
    half = size // 2
    first, second = rows[:, :half], rows[:, half:]
    _divide(first, triangle[:half, :half])
    below = triangle[half:, :half]
    dgemm(-1.0, first, below, beta=1.0, c=second, trans_b=1, overwrite_c=1)
    _divide(second, triangle[half:, half:])


def _assembled(
    front: Front,
    width: int,
    diagonal: FloatArray,
    mixed: FloatArray,
    handed_up: list[tuple[Front, FloatArray]],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Lower triangle of a front: own by own, later by own, later by later."""
    size, later = front.stop - front.start, len(front.later)
    own, under = np.zeros(size * size), np.zeros(later * size)
    own[front.own_places] = mixed[front.own_pairs].ravel()
    own[front.diagonal_places] = diagonal[front.start // width : front.stop // width].ravel()
    under[front.later_places] = mixed[front.later_pairs].ravel()
    # Columns are rows of the transposed table: entries of a column lie side by side.
    own_t, under_t = own.reshape(size, size), under.reshape(size, later)
    rest_t = np.zeros((later, later))
    for child, rest in handed_up:
        left = rest.T
        for number, run in enumerate(child.into_own):
            for other in child.into_own[number:]:
                _add(own_t, left, run, other)
            for other in child.into_later:
                _add(under_t, left, run, other)
        for number, run in enumerate(child.into_later):
            for other in child.into_later[number:]:
                _add(rest_t, left, run, other)
    return own_t.T, under_t.T, rest_t.T


def _add(table: FloatArray, values: FloatArray, rows: Run, columns: Run) -> None:
    """Add runs of rows and columns of values to a table, where they go."""
    first, stop, row = rows
    start, end, column = columns
    table[row : row + stop - first, column : column + end - start] += values[
        first:stop, start:end
    ]


def solve_fronts(factors: FrontalFactors, right: FloatArray) -> FloatArray:
    """Solve with the factors; the right side is (n, width)."""
    from scipy.linalg.blas import dtrsv

    solve: Any = dtrsv
    pattern = factors.pattern
    x = right[pattern.order].ravel()
    steps = list(zip(pattern.fronts, factors.triangles, factors.below, strict=True))
    for front, triangle, under in steps:
        own = solve(triangle, x[front.start : front.stop], lower=1)
        x[front.start : front.stop] = own
        x[front.later] -= under @ own
    for front, triangle, under in reversed(steps):
        own = x[front.start : front.stop] - under.T @ x[front.later]
        x[front.start : front.stop] = solve(triangle, own, lower=1, trans=1)
    result = np.empty_like(right)
    result[pattern.order] = x.reshape(right.shape)
    return result
