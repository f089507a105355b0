"""Tables of plain values as files: CSV for spreadsheets and programs, and XLSX."""

import csv
import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from ..kernel.errors import MissingLibraryError

LARGE = 1e3
"""Numbers from here on are written with six decimals."""


# What comes from openpyxl is not typed.
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
        writer: csv.DictWriter[str] | None = None
        for row in rows:
            if writer is None:
                writer = csv.DictWriter(file, list(row))
                writer.writeheader()
            writer.writerow({name: _cell(value) for name, value in row.items()})


def format_xlsx(sheets: Mapping[str, list[dict[str, Any]]]) -> bytes:
    """Tables as a workbook: rows of the same columns by the title of their sheet.

    Lists are written as in CSV. Raises MissingLibraryError if openpyxl is missing.
    """
    try:
        import openpyxl  # pyright: ignore[reportMissingModuleSource]
    except ImportError as error:
        raise MissingLibraryError(
            "a schedule in .xlsx needs openpyxl: install spheremesh[excel], or write .csv"
        ) from error
    book = openpyxl.Workbook(write_only=True)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        sheet.freeze_panes = "B2"
        sheet.append(list(rows[0]) if rows else ["none"])
        for row in rows:
            sheet.append([_excel_cell(sheet, value) for value in row.values()])
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def _excel_cell(sheet: _Untyped, value: object) -> object:
    """Numbers stay numbers, and text stays text, whatever it begins with."""
    if isinstance(value, int | float):
        return value
    text = _cell(value)
    if not text.startswith("="):
        return text
    from openpyxl.cell import WriteOnlyCell  # pyright: ignore[reportMissingModuleSource]

    cell: _Untyped = WriteOnlyCell(sheet, text)
    cell.data_type = "s"
    return cell


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, list):
        items = cast("list[object]", value)
        separator = "; " if items and isinstance(items[0], list) else " "
        return separator.join(_cell(item) or "-" for item in items)
    return str(value)


def _number(value: float) -> str:
    """Nine digits, and more where coordinates are large: in millimetres, a nanometre."""
    if abs(value) < LARGE:
        return f"{value:.9g}"
    return f"{value:.6f}".rstrip("0").rstrip(".")
