"""Vertices at one place made one, within what the digits of their coordinates can tell."""

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray, IntArray, norm
from ..solvers.weighted_graphs import piece_labels
from ..tolerances import (
    EPSILON,
    ROUNDED_PLACES,
    SAME_PLACE,
    SINGLE_EPSILON,
    WELL_KNOWN_DIGITS,
    WIDEST_WELD,
)
from .raw_mesh import RawMesh


def weld_tolerance(raw: RawMesh) -> float:
    """Distance within which vertices are one, by the digits of their coordinates.

    Parameters
    ----------
    raw : RawMesh
        Faces with finite vertices.

    Returns
    -------
    float
        A few spacings of the numbers, at least 1e-6 and at most 1e-3 of the mean edge; in model
        units.
    """
    used = raw.vertices[raw.corners]
    if not len(used):
        return 0.0
    sides = norm(used[raw.next_corners] - used)
    mean = float(sides[sides > 0].mean()) if (sides > 0).any() else 0.0
    rounding = ROUNDED_PLACES * number_spacing(used)
    return max(rounding_error(raw), min(max(SAME_PLACE * mean, rounding), WIDEST_WELD * mean))


def rounding_error(raw: RawMesh) -> float:
    """Distance within which places differ by the rounding of float64 alone."""
    largest = float(np.abs(raw.vertices[raw.corners]).max(initial=0.0))
    return ROUNDED_PLACES * EPSILON * largest


def number_spacing(points: FloatArray) -> float:
    """Spacing of the numbers that coordinates were written with, at the largest of them.

    Returns
    -------
    float
        That of float32 if all are such numbers, that of their decimal digits if they have
        fewer than 15, else that of float64.

    Examples
    --------
    >>> import numpy as np
    >>> number_spacing(np.array([[12.3457, 0.00123457, 1 / 2]]))
    0.0001
    """
    numbers = np.unique(np.abs(points))
    numbers = numbers[numbers > 0]
    if not len(numbers):
        return 0.0
    largest = float(numbers[-1])
    with np.errstate(over="ignore"):
        is_single = np.array_equal(numbers.astype(np.float32).astype(np.float64), numbers)
    spacing = largest * (SINGLE_EPSILON if is_single else EPSILON)
    exponents = np.floor(np.log10(numbers))
    top = float(exponents[-1])
    for digits in range(1, WELL_KNOWN_DIGITS):
        shift = digits - 1 - exponents
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            up, down = 10.0 ** np.maximum(shift, 0), 10.0 ** np.maximum(-shift, 0)
            is_known = np.rint(numbers * up / down) * down / up == numbers
        if is_known.all():
            return max(spacing, 10.0 ** (top + 1 - digits))
        numbers, exponents = numbers[~is_known], exponents[~is_known]
    return spacing


def weld_vertices(raw: RawMesh, distance: float) -> RawMesh:
    """The faces on fewer vertices: those that are close, or linked by such pairs, are one.

    Parameters
    ----------
    distance : float
        How close, in model units.

    Returns
    -------
    RawMesh
        Corners name the first vertex of each group.
    """
    used = np.unique(raw.corners)
    firsts = np.arange(len(raw.vertices))
    firsts[used] = used[_first_of_group(raw.vertices[used], distance)]
    return replace(raw, corners=firsts[raw.corners])


def _first_of_group(points: FloatArray, distance: float) -> IntArray:
    from scipy.spatial import KDTree

    _, firsts, places = np.unique(points, axis=0, return_index=True, return_inverse=True)
    places = places.reshape(-1)
    if distance > 0 and len(firsts):
        pairs = KDTree(points[firsts]).query_pairs(distance, output_type="ndarray")
        places = piece_labels(pairs[:, 0], pairs[:, 1], len(firsts))[places]
    least = np.full(len(firsts), len(points))
    np.minimum.at(least, places, np.arange(len(points)))
    return least[places]
