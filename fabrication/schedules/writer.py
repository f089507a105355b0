"""The schedule of panels and beams as a table, a workbook or JSON."""

import json
import os
from pathlib import Path
from typing import Any

from ...kernel.errors import InputError
from ..files import check_suffix, replacing
from ..model import Model, Written, check_model
from ..tables import format_xlsx, write_csv
from .beams import beam_tables
from .panels import panel_tables


def write_schedule(model: Model, path: str | os.PathLike[str]) -> Written:
    """Write the schedule as a table or as JSON, by the suffix of the path.

    ``.csv`` has one table, in UTF-8 with byte order mark, as spreadsheets expect (lists are
    separated by blanks, points by semicolons); ``.xlsx`` sheets of panels and moulds, of beams
    and nodes, the lists as in CSV; ``.json`` the lists ``panels`` and ``moulds``, ``beams`` and
    ``nodes``.

    Raises InputError if the suffix or the units are unknown, there is nothing to write, two
    parts have the same name or one is not finite, panels and beams are to share a ``.csv``, or
    the file cannot be written; MissingLibraryError if xlsxwriter is missing, which writes
    ``.xlsx``.
    """
    target = Path(path)
    check_suffix(target, ".csv", ".json", ".xlsx")
    check_model(model, target)
    panels, beams, units = model.panels, model.beams, model.units
    is_csv = target.suffix.lower() == ".csv"
    if is_csv and panels is not None and beams is not None:
        raise InputError(
            f"{target} holds one table: write panels and beams to a .csv each, or both to "
            ".json or .xlsx"
        )
    tables: dict[str, list[dict[str, Any]]] = {}
    if panels is not None:
        tables |= panel_tables(panels, units)
    if beams is not None:
        tables |= beam_tables(beams, units)
    workbook = format_xlsx(tables) if target.suffix.lower() == ".xlsx" else b""
    with replacing(target) as temporary:
        if is_csv:
            write_csv(next(iter(tables.values())), temporary)
        elif workbook:
            temporary.write_bytes(workbook)
        else:
            temporary.write_text(_json(tables), encoding="utf-8")
    return Written(target)


def _json(tables: dict[str, list[dict[str, Any]]]) -> str:
    """The lists by their names, a row on each line."""
    encode = json.JSONEncoder(allow_nan=False).encode
    lists = (
        f'"{name.lower()}": [\n' + ",\n".join(map(encode, rows)) + "\n]"
        for name, rows in tables.items()
    )
    return ",\n".join(('{"units": "mm"', *lists)) + "\n}\n"
