"""Tidy tables as files: CSV and Parquet of one, a workbook of all."""

import csv
import io
import os
from pathlib import Path
from typing import Any, Final, TypeAlias

from ...kernel.errors import InputError, MissingLibraryError
from ..files import check_suffix, replacing
from ..model import Model, Written, check_model
from ..tables import format_sheets
from .beam_records import beam_records
from .data_dictionary import TABLES
from .materials import parse_material
from .panel_records import panel_records
from .records import Record

# What comes from pyarrow is not typed.
_Untyped: TypeAlias = Any

_OF_BEAMS: Final = ("beams", "beam_ends", "beam_holes", "nodes")


def write_tables(
    model: Model,
    path: str | os.PathLike[str],
    panel_material: str = "glass",
    beam_material: str = "steel",
) -> Written:
    """Write tidy tables: a row a part, a number or a text in each cell.

    ``.xlsx`` has a sheet for each table of what the model has. ``.csv`` and ``.parquet`` have
    the table in which the name of the file ends: ``panels.csv``, ``roof_panel_edges.csv``.
    CSV is in UTF-8 with byte order mark, as spreadsheets expect.

    Raises InputError if suffix, units, table or material are unknown, there is nothing to write
    or no part of that table, two parts have the same name or one is not finite, or the file
    cannot be written; MissingLibraryError if the library for .xlsx or .parquet is missing.
    """
    target = Path(path)
    check_suffix(target, ".csv", ".xlsx", ".parquet")
    suffix = target.suffix.lower()
    name = None if suffix == ".xlsx" else _table_name(target)
    check_model(_needed(model, name, target), target)
    materials = parse_material(panel_material), parse_material(beam_material)
    tables: dict[str, Record] = {}
    if model.panels is not None and name not in _OF_BEAMS:
        tables |= panel_records(model.panels, model.units, materials[0], name)
    if model.beams is not None and (name is None or name in _OF_BEAMS):
        tables |= beam_records(model.beams, model.units, materials[1], name)
    if name is None:
        content = format_sheets({title: _rows(table) for title, table in tables.items()})
    else:
        content = _csv(tables[name]) if suffix == ".csv" else _parquet(tables[name])
    with replacing(target) as temporary:
        temporary.write_bytes(content)
    return Written(target)


def _table_name(target: Path) -> str:
    """The longest name of a table in which the name of a file ends."""
    stem = target.stem.lower()
    found = [name for name in TABLES if stem.endswith(name)]
    if not found:
        raise InputError(
            f"cannot write {target}: it holds one table; end its name in one of "
            f"{', '.join(TABLES)}, or write .xlsx"
        )
    return max(found, key=len)


def _needed(model: Model, name: str | None, target: Path) -> Model:
    """The parts of which the table is."""
    if name is None:
        return model
    parts, kind = (model.beams, "beams") if name in _OF_BEAMS else (model.panels, "panels")
    if parts is None:
        raise InputError(f"there are no {kind} to write to {target}")
    return Model(beams=model.beams) if kind == "beams" else Model(panels=model.panels)


def _rows(table: Record) -> list[list[Any]]:
    return [list(table), *map(list, zip(*table.values(), strict=True))]


def _csv(table: Record) -> bytes:
    stream = io.StringIO(newline="")
    csv.writer(stream).writerows(_rows(table))
    return stream.getvalue().encode("utf-8-sig")


def _parquet(table: Record) -> bytes:
    try:
        import pyarrow  # pyright: ignore[reportMissingTypeStubs]
        from pyarrow import parquet  # pyright: ignore[reportMissingTypeStubs]
    except ImportError as error:
        raise MissingLibraryError(
            "tables in .parquet need pyarrow: install spheremesh[parquet], or write .csv"
        ) from error
    library: _Untyped = pyarrow
    writer: _Untyped = parquet
    stream = io.BytesIO()
    writer.write_table(library.table(table), stream)
    return stream.getvalue()
