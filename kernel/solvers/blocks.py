"""Sparse Jacobians made of small dense blocks.

The unknowns fall into groups (the spheres of faces, say, and the points of vertices), each with
so many elements of so many numbers. A residual depends on a few elements; which ones is known
before any value is. So the pattern of the Jacobian is built once, and no column is ever counted
by hand.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from .factorization import SparseArray


class Block(NamedTuple):
    """The elements of one group that the rows of a term depend on.

    Attributes
    ----------
    group : int
        Group of unknowns.
    ids : (m,) int array
        Element that each row depends on.
    """

    group: int
    ids: IntArray


@dataclass(frozen=True)
class Layout:
    """Groups of unknowns, one after the other in a flat vector.

    Attributes
    ----------
    counts : tuple of int
        Number of elements of each group; a group of none takes no part.
    widths : tuple of int
        Numbers per element of each group.
    """

    counts: tuple[int, ...]
    widths: tuple[int, ...]

    @property
    def starts(self) -> IntArray:
        """First unknown of each group, ascending, and their number: (groups + 1,)."""
        sizes = np.multiply(self.counts, self.widths)
        return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)

    def split(self, vector: FloatArray) -> tuple[FloatArray, ...]:
        """Views (count, width) of a flat vector, a table per group, in their order."""
        starts = self.starts
        return tuple(
            vector[starts[i] : starts[i + 1]].reshape(count, width)
            for i, (count, width) in enumerate(zip(self.counts, self.widths, strict=True))
        )

    def columns(self, block: Block) -> IntArray:
        """Columns (m, width) of the flat vector that a block fills."""
        width = self.widths[block.group]
        first = self.starts[block.group] + width * block.ids
        return first[:, None] + np.arange(width)


@dataclass(frozen=True)
class JacobianPattern:
    """Where the entries of a Jacobian go.

    Attributes
    ----------
    blocks : tuple of tuples of Block
        Blocks of each term that lie in groups taking part.
    columns : (nnz,) int32 array
        Column of each entry, row after row.
    starts : (m + 1,) int32 array
        First entry of each row, and nnz.
    """

    layout: Layout
    blocks: tuple[tuple[Block, ...], ...]
    columns: NDArray[np.int32]
    starts: NDArray[np.int32]


def jacobian_pattern(layout: Layout, terms: Sequence[Sequence[Block]]) -> JacobianPattern:
    """Pattern of the Jacobian of several terms, built once.

    Blocks of empty groups are left out.
    """
    blocks = tuple(
        tuple(block for block in term if layout.counts[block.group]) for term in terms
    )
    tables = [np.hstack([layout.columns(block) for block in term]) for term in blocks if term]
    widths = [np.full(len(table), table.shape[1]) for table in tables]
    starts = np.concatenate([[0], np.cumsum(np.concatenate(widths))])
    columns = np.concatenate([table.ravel() for table in tables])
    # Narrow indices halve what a product has to read.
    return JacobianPattern(layout, blocks, columns.astype(np.int32), starts.astype(np.int32))


def jacobian_matrix(
    pattern: JacobianPattern, entries: Sequence[Sequence[FloatArray]]
) -> SparseArray:
    """The Jacobian as a sparse matrix (m, n); entries that happen to be zero are kept.

    The entries are the values (m, width) of the blocks of each term, as in
    `JacobianPattern.blocks`.
    """
    from scipy.sparse import csr_array

    data = np.empty(len(pattern.columns))
    place = 0
    for tables in entries:
        if len(tables):
            count, width = len(tables[0]), sum(table.shape[1] for table in tables)
            rows = data[place : place + count * width].reshape(count, width)
            np.concatenate(tables, axis=1, out=rows)
            place += count * width
    shape = (len(pattern.starts) - 1, int(pattern.layout.starts[-1]))
    return csr_array((data, pattern.columns, pattern.starts), shape=shape)


def block_diagonal(blocks: FloatArray) -> SparseArray:
    """The matrix with given blocks (count, width, width) on its diagonal; all else is zero."""
    from scipy.sparse import bsr_array

    count, width = blocks.shape[:2]
    starts = np.arange(count + 1, dtype=np.int64)
    return bsr_array((blocks, starts[:-1], starts), shape=(count * width, count * width))
