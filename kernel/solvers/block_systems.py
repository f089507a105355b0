"""Newton systems of several groups of unknowns, reduced to the first and factorised.

Elements of a later group that touch none of their own group (points of vertices, axes of nodes)
are eliminated one by one: their part of the matrix is block diagonal. What remains, the Schur
complement on the elements that are kept, is factorised front by front.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray, batches_by_count
from .block_patterns import PairKind, add_up, sum_matrix
from .factorization import Solver, SparseArray
from .multifrontal import FrontalPattern, factorize_fronts, frontal_pattern, solve_fronts


class Blocks(NamedTuple):
    """A symmetric matrix, block by block.

    Attributes
    ----------
    diagonal : tuple of (count, width, width) float arrays
        A table per group.
    mixed : mapping of kind to (slots, width, width) float arrays
        Blocks of pairs of elements.
    """

    diagonal: tuple[FloatArray, ...]
    mixed: Mapping[PairKind, FloatArray]


class Elimination(NamedTuple):
    """How one group leaves the system.

    Attributes
    ----------
    group : int
    kinds : tuple of kinds
        Kinds of pairs that join it to elements that are kept.
    elements, kept : (m,) int arrays
        Eliminated and kept element of each of those pairs.
    first, second : (p,) int arrays
        Pairs that share an eliminated element and join it to two kept ones.
    straight, turned : sparse matrices
        How their products add to the pairs of kept elements.
    """

    group: int
    kinds: tuple[PairKind, ...]
    elements: IntArray
    kept: IntArray
    first: IntArray
    second: IntArray
    straight: SparseArray
    turned: SparseArray


@dataclass(frozen=True)
class SystemPattern:
    """How systems of one pattern are solved.

    Attributes
    ----------
    counts, widths : tuple of int
        Elements of each group and unknowns of each.
    kept : tuple of int
        Groups that stay, one after the other.
    width : int
        Unknowns of a kept element; narrower ones are filled up.
    kinds : tuple of kinds
        Kinds of pairs among kept elements.
    own_slots : tuple of (m,) int arrays
        Where these kinds go among all pairs of kept elements.
    eliminations : tuple of Elimination
    fronts : FrontalPattern
    """

    counts: tuple[int, ...]
    widths: tuple[int, ...]
    kept: tuple[int, ...]
    width: int
    kinds: tuple[PairKind, ...]
    own_slots: tuple[IntArray, ...]
    eliminations: tuple[Elimination, ...]
    n_pairs: int
    fronts: FrontalPattern

    @property
    def first_kept(self) -> dict[int, int]:
        """First kept element of each kept group."""
        sizes = [self.counts[group] for group in self.kept]
        return dict(zip(self.kept, np.cumsum([0, *sizes]).tolist(), strict=False))


def system_pattern(
    pairs: Mapping[PairKind, IntArray],
    widths: tuple[int, ...],
    points: tuple[FloatArray, ...],
) -> SystemPattern:
    """Plan the solution of systems.

    Parameters
    ----------
    pairs : mapping of kind to (slots, 2) int arrays
        Pairs of elements that have a block, as in `HessianPattern.pairs`.
    widths : tuple of int
        Unknowns per element of each group.
    points : tuple of (count, 3) float arrays
        Where the elements of each group are.
    """
    counts = tuple(len(table) for table in points)
    kept = tuple(
        group
        for group, count in enumerate(counts)
        if count and (group == 0 or (group, group) in pairs)
    )
    sizes = [counts[group] for group in kept]
    offset = dict(zip(kept, np.cumsum([0, *sizes]).tolist(), strict=False))
    total = sum(sizes)
    kinds = tuple(kind for kind in pairs if set(kind) <= set(kept))
    own = [pairs[i, j] + [offset[i], offset[j]] for i, j in kinds]
    joined = [
        _joined(group, pairs, offset) for group in range(len(counts)) if group not in kept
    ]
    joined = [found for found in joined if len(found.elements)]
    coupled = [_coupled(found.elements, found.kept) for found in joined]
    own_keys = [table[:, 0] * total + table[:, 1] for table in own]
    new = [
        np.sort(np.stack([found.kept[p], found.kept[q]], axis=1), axis=1)
        for found, (p, q) in zip(joined, coupled, strict=True)
    ]
    new_keys = [table[:, 0] * total + table[:, 1] for table in new]
    keys = np.unique(np.concatenate([np.zeros(0, np.int64), *own_keys, *new_keys]))
    eliminations = tuple(
        _elimination(found, pair, np.searchsorted(keys, slots), len(keys))
        for found, pair, slots in zip(joined, coupled, new_keys, strict=True)
    )
    width = max(widths[group] for group in kept)
    where = np.concatenate([points[group] for group in kept])
    elements = np.stack(np.divmod(keys, max(total, 1)), axis=1)
    return SystemPattern(
        counts, widths, kept, width, kinds,
        tuple(np.searchsorted(keys, found) for found in own_keys),
        eliminations, len(keys), frontal_pattern(where, elements, width),
    )  # fmt: skip


class _Joined(NamedTuple):
    group: int
    kinds: tuple[PairKind, ...]
    elements: IntArray
    kept: IntArray


def _joined(
    group: int, pairs: Mapping[PairKind, IntArray], offset: Mapping[int, int]
) -> _Joined:
    """Pairs of an eliminated group with elements that are kept."""
    kinds = tuple(kind for kind in pairs if group in kind)
    for kind in kinds:
        if kind[1] != group or kind[0] not in offset:
            raise ValueError("eliminated groups touch only kept groups before them")
    none = np.zeros(0, np.int64)
    elements = np.concatenate([none, *(pairs[kind][:, 1] for kind in kinds)])
    kept = np.concatenate([none, *(pairs[kind][:, 0] + offset[kind[0]] for kind in kinds)])
    return _Joined(group, kinds, elements, kept)


def _coupled(elements: IntArray, kept: IntArray) -> tuple[IntArray, IntArray]:
    """All pairs of rows that share an element and differ in what is kept."""
    firsts, seconds = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for _, rows in batches_by_count(elements, int(elements.max(initial=-1)) + 1):
        a, b = np.triu_indices(rows.shape[1], 1)
        firsts.append(rows[:, a].ravel())
        seconds.append(rows[:, b].ravel())
    first, second = np.concatenate(firsts), np.concatenate(seconds)
    differ = kept[first] != kept[second]
    return first[differ], second[differ]


def _elimination(
    found: _Joined, pair: tuple[IntArray, IntArray], slots: IntArray, n_pairs: int
) -> Elimination:
    first, second = pair
    is_turned = found.kept[first] > found.kept[second]
    return Elimination(
        *found, first, second,
        sum_matrix(slots, n_pairs, ~is_turned), sum_matrix(slots, n_pairs, is_turned),
    )  # fmt: skip


class Reduction(NamedTuple):
    """What one eliminated group leaves behind: inverses (n, q, q) and couplings (m, w, q)."""

    elimination: Elimination
    inverses: FloatArray
    couplings: FloatArray


def factorize_system(pattern: SystemPattern, blocks: Blocks, shift: float) -> Solver | None:
    """Factorise ``H + shift I``: a function that solves, or None if not positive definite.

    The function takes and returns flat vectors, group after group.
    """
    width = pattern.width
    diagonal = _kept_diagonal(pattern, blocks, shift)
    mixed = np.zeros((pattern.n_pairs, width, width))
    for kind, slots in zip(pattern.kinds, pattern.own_slots, strict=True):
        values = blocks.mixed[kind]
        mixed[slots, : values.shape[1], : values.shape[2]] += values
    reductions: list[Reduction] = []
    for elimination in pattern.eliminations:
        reduction = _reduction(elimination, blocks, shift, width)
        if reduction is None:
            return None
        _eliminate(reduction, diagonal, mixed)
        reductions.append(reduction)
    factors = factorize_fronts(pattern.fronts, diagonal, mixed)
    if factors is None:
        return None

    def _solve(right: FloatArray) -> FloatArray:
        parts = _split(pattern, right)
        kept = _gathered(pattern, parts)
        for reduction in reductions:
            found = reduction.elimination
            inner = np.einsum("nij,nj->ni", reduction.inverses, parts[found.group])
            change = np.einsum("mij,mj->mi", reduction.couplings, inner[found.elements])
            np.subtract.at(kept, found.kept, change)
        kept = solve_fronts(factors, kept)
        results = _scattered(pattern, kept)
        for reduction in reductions:
            found = reduction.elimination
            rest = parts[found.group].copy()
            change = np.einsum("mij,mi->mj", reduction.couplings, kept[found.kept])
            np.subtract.at(rest, found.elements, change)
            results[found.group] = np.einsum("nij,nj->ni", reduction.inverses, rest)
        return np.concatenate([table.ravel() for table in results])

    return _solve


def _kept_diagonal(pattern: SystemPattern, blocks: Blocks, shift: float) -> FloatArray:
    tables: list[FloatArray] = []
    for group in pattern.kept:
        narrow = blocks.diagonal[group]
        table = np.tile(np.eye(pattern.width), (len(narrow), 1, 1))
        size = narrow.shape[1]
        table[:, :size, :size] = narrow + shift * np.eye(size)
        tables.append(table)
    return np.concatenate(tables)


def _reduction(
    elimination: Elimination, blocks: Blocks, shift: float, width: int
) -> Reduction | None:
    own = blocks.diagonal[elimination.group]
    size = own.shape[1]
    own = own + shift * np.eye(size)
    try:
        np.linalg.cholesky(own)
    except np.linalg.LinAlgError:
        return None
    tables: list[FloatArray] = []
    for kind in elimination.kinds:
        values = blocks.mixed[kind]
        filled = np.zeros((len(values), width, size))
        filled[:, : values.shape[1]] = values
        tables.append(filled)
    couplings = np.concatenate(tables)
    inverses = np.asarray(np.linalg.inv(own), np.float64)
    return Reduction(elimination, inverses, couplings)


def _eliminate(reduction: Reduction, diagonal: FloatArray, mixed: FloatArray) -> None:
    found, inverses, couplings = reduction
    scaled = couplings @ inverses[found.elements]
    turned = couplings.transpose(0, 2, 1)
    np.subtract.at(diagonal, found.kept, scaled @ turned)
    products = scaled[found.first] @ turned[found.second]
    mixed -= add_up(found.straight, products)
    mixed -= add_up(found.turned, products.transpose(0, 2, 1))


def _split(pattern: SystemPattern, vector: FloatArray) -> list[FloatArray]:
    sizes = np.multiply(pattern.counts, pattern.widths)
    parts = np.split(vector, np.cumsum(sizes)[:-1])
    return [
        part.reshape(count, width)
        for part, count, width in zip(parts, pattern.counts, pattern.widths, strict=True)
    ]


def _gathered(pattern: SystemPattern, parts: list[FloatArray]) -> FloatArray:
    total = sum(pattern.counts[group] for group in pattern.kept)
    kept = np.zeros((total, pattern.width))
    for group, first in pattern.first_kept.items():
        kept[first : first + pattern.counts[group], : pattern.widths[group]] = parts[group]
    return kept


def _scattered(pattern: SystemPattern, kept: FloatArray) -> list[FloatArray]:
    results = [
        np.zeros((count, width))
        for count, width in zip(pattern.counts, pattern.widths, strict=True)
    ]
    for group, first in pattern.first_kept.items():
        results[group][:] = kept[first : first + pattern.counts[group], : pattern.widths[group]]
    return results
