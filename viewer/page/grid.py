"""Coordinates of a page: whole steps from the middle of the model.

A page knows the model in units of its size, centred: single precision and the depth buffer are
then good for a millimetre as for a mile. Points are rounded to a grid so fine that no eye finds
it, and the same point is rounded alike wherever it occurs: what is closed stays closed.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray

STEPS: Final = 1 << 20
"""Steps of the grid along the longest side of a model."""


@dataclass(frozen=True)
class Grid:
    """The middle of a model and the length of its longest side, in model units."""

    center: FloatArray
    size: float

    def steps(self, points: FloatArray) -> IntArray:
        """Points (..., 3) in model coordinates as whole steps from the middle."""
        return np.rint((points - self.center) * (STEPS / self.size)).astype(np.int64)


def grid_about(*points: FloatArray) -> Grid:
    """The grid of a model that has these points (N, 3), in model coordinates."""
    low = np.min([each.min(axis=0) for each in points if len(each)], axis=0)
    high = np.max([each.max(axis=0) for each in points if len(each)], axis=0)
    return Grid((low + high) / 2, float((high - low).max()) or 1.0)
