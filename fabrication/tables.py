"""Tables of plain values as files: CSV for spreadsheets and programs, and XLSX."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from types import NoneType
from typing import Any, Final, TypeAlias

import numpy as np

from ..kernel.errors import MissingLibraryError

_UNDATED: Final = datetime(2000, 1, 1, tzinfo=UTC).replace(tzinfo=None)
"""When every workbook was made, as it says itself."""

LARGE = 1e3
"""Numbers from here on are written with six decimals."""


# What comes from xlsxwriter is not typed.
_Untyped: TypeAlias = Any


def finite_or_none(value: np.float64) -> float | None:
    """A number as a plain value; None if it is not finite, such as the radius of a plane."""
    return float(value) if np.isfinite(value) else None


def write_csv(rows: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write a table as CSV, in UTF-8 with byte order mark, as spreadsheets expect.

    All rows have the same columns. Lists are separated by blanks, lists of lists by semicolons;
    what is None is an empty cell, or a dash in a list.
    """
    with path.open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file)
        for number, row in enumerate(rows):
            if number == 0:
                writer.writerow(row)
            writer.writerow(map(_cell, row.values()))


def format_xlsx(sheets: Mapping[str, list[dict[str, Any]]]) -> bytes:
    """Tables as a workbook: rows of the same columns by the title of their sheet.

    Lists are written as in CSV. Raises MissingLibraryError if xlsxwriter is missing.
    """
    return format_sheets(
        {
            title: [
                list(rows[0]) if rows else ["none"],
                *([_plain(value) for value in row.values()] for row in rows),
            ]
            for title, rows in sheets.items()
        }
    )


def _plain(value: object) -> object:
    return value if isinstance(value, int | float) else _cell(value)


def format_sheets(sheets: Mapping[str, Sequence[Sequence[object]]]) -> bytes:
    """A workbook of rows of texts and numbers, the first of each sheet its header.

    The header stays in sight. Numbers stay numbers, and text stays text, whatever it begins
    with; what is None is an empty cell. The same tables give the same bytes. Raises
    MissingLibraryError if xlsxwriter is missing.
    """
    try:
        import xlsxwriter  # pyright: ignore[reportMissingTypeStubs]
    except ImportError as error:
        raise MissingLibraryError(
            "a schedule in .xlsx needs xlsxwriter: install spheremesh[excel], or write .csv"
        ) from error
    stream = io.BytesIO()
    library: _Untyped = xlsxwriter
    book = library.Workbook(stream, {"in_memory": True, "constant_memory": True})
    book.set_properties({"created": _UNDATED})
    bold = book.add_format({"bold": True})
    for title, rows in sheets.items():
        sheet = book.add_worksheet(title)
        sheet.freeze_panes(1, 1)
        sheet.set_row(0, None, bold)
        for j, name in enumerate(rows[0]):
            sheet.set_column(j, j, max(8, len(str(name))))
        for i, row in enumerate(rows):
            for j, value in enumerate(row):
                if isinstance(value, int | float):
                    sheet.write_number(i, j, value)
                elif value is not None:
                    sheet.write_string(i, j, str(value))
    book.close()
    return stream.getvalue()


def _cell(value: object) -> str:
    return _FORMATS.get(type(value), str)(value)


def _list(items: list[object]) -> str:
    if items and isinstance(items[0], list):
        return "; ".join(map(_cell, items))
    return " ".join([_cell(item) or "-" for item in items])


def _number(value: float) -> str:
    """Nine digits, and more where coordinates are large: in millimetres, a nanometre."""
    if -LARGE < value < LARGE:
        return f"{value:.9g}"
    return f"{value:.6f}".rstrip("0").rstrip(".")


def _nothing(_value: None) -> str:
    return ""


_FORMATS: Final[dict[type, Callable[[Any], str]]] = {
    float: _number, list: _list, NoneType: _nothing,
}  # fmt: skip
"""How values are written that are not text already, by their types."""
