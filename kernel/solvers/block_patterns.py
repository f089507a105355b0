"""Where the blocks of a Hessian go: built once, before any value is known.

The unknowns fall into groups (the spheres of faces, the points of vertices, the axes of nodes).
The residuals of a term depend on a few elements each, `Block` by `Block`; every pair of its
blocks adds a small table to the Hessian for each residual. Adding up is multiplication by a
sparse matrix of ones, made here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from .blocks import Block, Layout
from .factorization import SparseArray

PairKind = tuple[int, int]
"""Two groups, the first not after the second."""


class Addition(NamedTuple):
    """How the tables of one pair of blocks add up.

    Attributes
    ----------
    kind : (int, int)
        Groups of the two blocks.
    straight, turned : sparse (slots, m) matrices
        Which rows add to which slot as they are, and turned over.
    is_diagonal : bool
        Whether both are the same block.
    """

    kind: PairKind
    straight: SparseArray
    turned: SparseArray | None
    is_diagonal: bool


@dataclass(frozen=True)
class HessianPattern:
    """Where derivatives of the terms go.

    Attributes
    ----------
    layout : Layout
        Groups of unknowns, as derivatives come; groups without elements take no part.
    blocks : tuple of tuples of Block
        What the residuals of each term depend on.
    gradients : tuple of tuples of sparse (count, m) matrices
        For each term and block: which rows add to which element; None where it takes no part.
    additions : tuple of mappings of (int, int) to Addition
        For each term and pair of blocks.
    pairs : mapping of kind to (slots, 2) int arrays
        Pairs of elements that have a block off the diagonal; of one group, the lesser first.
    """

    layout: Layout
    blocks: tuple[tuple[Block, ...], ...]
    gradients: tuple[tuple[SparseArray | None, ...], ...]
    additions: tuple[dict[tuple[int, int], Addition], ...]
    pairs: dict[PairKind, IntArray]


def hessian_pattern(layout: Layout, terms: Sequence[Sequence[Block]]) -> HessianPattern:
    """Pattern of the Hessian of several terms, from what their residuals depend on."""
    keys = _pair_keys(layout, terms)
    return HessianPattern(
        layout,
        tuple(tuple(blocks) for blocks in terms),
        tuple(
            tuple(
                sum_matrix(block.ids, layout.counts[block.group])
                if layout.counts[block.group]
                else None
                for block in blocks
            )
            for blocks in terms
        ),
        tuple(
            {
                (i, j): _addition(layout, blocks[i], blocks[j], keys, is_diagonal=i == j)
                for i, j in _active_pairs(layout, blocks)
            }
            for blocks in terms
        ),
        {
            kind: np.stack(np.divmod(found, layout.counts[kind[1]]), axis=1)
            for kind, found in keys.items()
        },
    )


def _active_pairs(layout: Layout, blocks: Sequence[Block]) -> Iterator[tuple[int, int]]:
    active = [i for i, block in enumerate(blocks) if layout.counts[block.group]]
    return ((i, j) for i in active for j in active if i <= j)


def _key(layout: Layout, first: Block, second: Block) -> tuple[PairKind, IntArray, BoolArray]:
    """PairKind and key of each pair of elements, and which pairs are turned over."""
    kind = (first.group, second.group)
    if kind[0] > kind[1]:
        raise ValueError("blocks of a term come in the order of their groups")
    low, high = first.ids, second.ids
    is_turned = np.zeros(len(low), bool)
    if kind[0] == kind[1]:
        is_turned = low > high
        low, high = np.minimum(low, high), np.maximum(low, high)
    return kind, low * layout.counts[kind[1]] + high, is_turned


def _pair_keys(layout: Layout, terms: Sequence[Sequence[Block]]) -> dict[PairKind, IntArray]:
    found: dict[PairKind, list[IntArray]] = {}
    for blocks in terms:
        for i, j in _active_pairs(layout, blocks):
            if i != j:
                kind, keys, _ = _key(layout, blocks[i], blocks[j])
                distinct = (blocks[i].ids != blocks[j].ids) | (kind[0] != kind[1])
                found.setdefault(kind, []).append(np.unique(keys[distinct]))
    return {kind: np.unique(np.concatenate(keys)) for kind, keys in found.items()}


def _addition(
    layout: Layout,
    first: Block,
    second: Block,
    keys: dict[PairKind, IntArray],
    *,
    is_diagonal: bool,
) -> Addition:
    if is_diagonal:
        kind = (first.group, first.group)
        return Addition(
            kind, sum_matrix(first.ids, layout.counts[first.group]), None, is_diagonal=True
        )
    kind, wanted, is_turned = _key(layout, first, second)
    slots = np.searchsorted(keys[kind], wanted)
    # An element paired with itself stands where a table of neighbours was filled up: no entry.
    counts = (first.ids != second.ids) | (kind[0] != kind[1])
    slots = np.minimum(slots, len(keys[kind]) - 1)
    straight = sum_matrix(slots, len(keys[kind]), counts & ~is_turned)
    turned = None
    if is_turned.any():
        turned = sum_matrix(slots, len(keys[kind]), counts & is_turned)
    return Addition(kind, straight, turned, is_diagonal=False)


def sum_matrix(slots: IntArray, size: int, counts: BoolArray | None = None) -> SparseArray:
    """Matrix (size, m) that adds up the rows of each slot, those that count."""
    from scipy.sparse import csr_array

    rows = np.arange(len(slots))
    if counts is not None:
        rows, slots = rows[counts], slots[counts]
        length = len(counts)
    else:
        length = len(slots)
    ones = np.ones(len(slots))
    return csr_array(
        (ones, (slots.astype(np.int32), rows.astype(np.int32))), shape=(size, length)
    )


def add_up(matrix: SparseArray, rows: FloatArray) -> FloatArray:
    """Sums (size, ...) of the rows (m, ...) of each slot."""
    size = int(np.prod(rows.shape[1:], dtype=np.int64))
    flat: FloatArray = matrix @ rows.reshape(len(rows), size)
    return flat.reshape(matrix.shape[0], *rows.shape[1:])


def weighted(matrix: SparseArray, weights: FloatArray) -> SparseArray:
    """A `sum_matrix` whose rows (m,) count by their weight."""
    from scipy.sparse import csr_array

    parts = weights[matrix.indices], matrix.indices, matrix.indptr
    return csr_array(parts, shape=matrix.shape)


def add_up_products(matrix: SparseArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Sums (size, p, q) of the tables ``a bᵀ`` of rows (m, p) and (m, q) of each slot.

    The tables themselves, often far larger than all sums, are never made.
    """
    result = np.empty((matrix.shape[0], first.shape[1], second.shape[1]))
    for number, column in enumerate(first.T):
        result[:, number] = weighted(matrix, column) @ second
    return result
