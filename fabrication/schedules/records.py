"""Tidy tables: columns of plain values, a number or a text in each cell, no lists.

Numbers are rounded by the unit in the name of their column: to micrometres, and as fine
elsewhere.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np

from ...kernel.arrays import FloatArray

Record: TypeAlias = dict[str, list[Any]]
"""A table: its columns by name, of one length."""

_DECIMALS: Final = {"mm": 3, "deg": 4, "m2": 6, "m3": 9, "kg": 3}

SAME_HEIGHT: Final = 3
"""Decimals of millimetres to which heights are told apart when parts are put in order."""

_DIRECTION: Final = 9
"""Decimals of unit vectors."""


def round_column(name: str, values: FloatArray) -> list[float | None]:
    """Numbers as the unit in the name asks for; None where they are not finite."""
    decimals = _DECIMALS.get(name.rpartition("_")[2], _DIRECTION)
    # A zero has no sign.
    rounded = np.round(values, decimals) + 0.0
    numbers: list[float] = rounded.tolist()
    known: list[bool] = np.isfinite(rounded).tolist()
    if all(known):
        return list(numbers)
    return [value if is_known else None for value, is_known in zip(numbers, known, strict=True)]


def split_points(names: Sequence[str], points: FloatArray) -> dict[str, FloatArray]:
    """Columns of points (n, k) by k names."""
    return dict(zip(names, points.T, strict=True))


NONE: Final = "-"
"""What a column of texts says where there is nothing."""


def text_column(values: Iterable[str | None]) -> list[str]:
    """Texts, with `NONE` where there is none."""
    return [value or NONE for value in values]


def make_record(columns: Mapping[str, Sequence[Any] | FloatArray]) -> Record:
    """A table of columns; arrays of floats are rounded."""
    return {
        name: round_column(name, values) if isinstance(values, np.ndarray) else list(values)
        for name, values in columns.items()
    }


def record_rows(table: Record) -> list[dict[str, Any]]:
    """The rows of a table."""
    return [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
