"""Unknowns in groups of elements: the spheres of faces, say, and the points of vertices.

A residual depends on a few elements; which ones is known before any value is. No column of a
derivative is ever counted by hand.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

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


def block_diagonal(blocks: FloatArray) -> SparseArray:
    """The matrix with given blocks (count, width, width) on its diagonal; all else is zero."""
    from scipy.sparse import bsr_array

    count, width = blocks.shape[:2]
    starts = np.arange(count + 1, dtype=np.int64)
    return bsr_array((blocks, starts[:-1], starts), shape=(count * width, count * width))
