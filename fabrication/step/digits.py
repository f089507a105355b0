"""How many digits of the numbers of a part are written.

Points are rounded to `ROUNDED_PART` of the size of the part, or to a hundredth of what CAD
programs take for one place, whichever is finer: 1e-9 mm for parts from 1 m on. Directions are
rounded so that what they lead to moves no farther. Everything is read back within that.
"""

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.tolerances import ROUNDED_PART
from .sharing import SharedGeometry


def last_places(sizes: FloatArray, confusion: float) -> FloatArray:
    """Last written place of the points of parts, in their unit."""
    return np.minimum(ROUNDED_PART * sizes, 0.01 * confusion)


def rounded_numbers(shared: SharedGeometry, confusion: float) -> FloatArray:
    """Points, directions and radii of parts, a row per part."""
    count, sizes = len(shared.members), shared.sizes
    reach = np.maximum(np.abs(shared.radii).max(axis=1, initial=0.0), sizes)
    places = last_places(sizes, confusion)[:, None]
    turns = np.where(shared.is_far, places / reach[:, None], places / sizes[:, None])
    return np.concatenate(
        [
            rounded(shared.points.reshape(count, -1), places),
            rounded(shared.directions, turns[..., None]).reshape(count, -1),
            rounded(shared.radii, places),
        ],
        axis=1,
    )


def rounded(values: FloatArray, places: FloatArray) -> FloatArray:
    """Values with decimals down to a place, or as they are where float64 has no more."""
    decimals = _decimals(places)
    powers = 10.0 ** np.clip(decimals, 0, 22)
    scaled = values * powers
    is_coarse = (decimals >= 0) & (decimals <= 22) & (np.abs(scaled) < 2.0**53)
    return np.where(is_coarse, np.rint(scaled) / powers, values)


def _decimals(places: FloatArray) -> IntArray:
    return np.ceil(-np.log10(places)).astype(np.int64)
