"""Rows that users give: checked, seen from points, and made unit."""

from typing import Literal

import numpy as np

from ..arrays import FloatArray, IntArray, dot
from ..errors import InputError, name_ids
from ..tolerances import EPSILON
from .minkowski import minkowski
from .rows import Kind, kind, recenter


def check_rows(rows: FloatArray, count: int, element: Literal["face", "vertex"]) -> None:
    """Refuse rows that are not one per element, or not finite; the message names these."""
    if rows.shape != (count, 5):
        raise InputError(
            f"spheres must have shape ({count}, 5), not {rows.shape}: one per {element}"
        )
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        plural = "faces" if element == "face" else "vertices"
        raise InputError(f"the spheres of {plural} {name_ids(bad.tolist())} are not finite")


def seen_from(rows: FloatArray, points: FloatArray) -> FloatArray:
    """Rows (n, 5) with a point each (n, 3) as origin.

    Far from the origin a row rounds its last coefficient: where the point lies on its sphere
    up to this rounding, it lies on it exactly.
    """
    local = recenter(rows, points)
    scale = np.abs(rows[:, 4]) + np.abs(dot(rows[:, 1:4], points))
    scale = scale + np.abs(rows[:, 0]) * dot(points, points)
    local[np.abs(local[:, 4]) <= 8 * EPSILON * scale, 4] = 0
    return local


def unit_rows(rows: FloatArray, vertices: IntArray, need: str = "") -> FloatArray:
    """Real rows (n, 5) made unit.

    Raises
    ------
    InputError
        If a row is imaginary or a point; the message names the vertices and ends with the need.
    """
    kinds = kind(rows)
    bad = np.unique(vertices[(kinds == Kind.IMAGINARY) | (kinds == Kind.POINT)])
    if len(bad):
        raise InputError(
            f"the spheres of vertices {name_ids(bad.tolist())} are imaginary or points{need}"
        )
    return rows / np.sqrt(minkowski(rows, rows))[:, None]
