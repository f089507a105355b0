"""
The schedule: a row per panel with all that a workshop asks for, in millimetres.

Coordinates are those of the model. The same ids stand in STEP, Rhino and report files.
"""

import csv
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final, cast

import numpy as np

from ..kernel.congruent_panels import CongruentPanels, congruent_panels
from ..kernel.errors import MissingLibraryError
from ..kernel.mould_blanks import mould_blanks
from ..kernel.panel_checks import check_writable
from ..kernel.panel_facts import panel_facts
from ..kernel.panels import Panels, neighbor_ids, scale_panels
from .audit import AuditLimits, PanelSubject, check_panels, findings_by_id
from .files import check_suffix, replacing
from .units import millimeters_per

SQUARE_METER: Final = 1e6
"""Square millimetres in a square metre."""

CUBIC_METER: Final = 1e9
"""Cubic millimetres in a cubic metre."""


def schedule_rows(panels: Panels, units: str) -> list[dict[str, Any]]:
    """
    What the schedule says of each panel, as plain values.

    Parameters
    ----------
    panels : Panels
        P panels.
    units : str
        Model units: mm, cm, m, in or ft.

    Returns
    -------
    list of dict
        P rows of the columns ``id``, ``face``, ``mould`` (from 1; None without clustering),
        ``same_as`` (the first of identical panels), ``shape`` (sphere or plane), ``bulge``
        (out, in or flat, seen along the face normal), ``radius_mm`` (of the mould),
        ``outer_radius_mm``, ``inner_radius_mm`` and ``center_mm`` (None for planes),
        ``area_m2``, ``volume_m3``, ``thickness_mm``, ``size_mm`` (length, width and rise of
        the box around the outer face, its length along the first edge's chord),
        ``blank_diameter_mm`` and ``blank_sagitta_mm`` of the smallest cap of the mould that
        holds the panel, ``edge_lengths_mm``, ``arc_radii_mm`` (None for straight edges),
        ``sagittas_mm``, ``wall_tilts_deg``, ``corner_angles_deg``, ``neighbors`` (ids; None
        where there is none), ``corners_mm`` and ``warnings`` (findings of the audit). Edge i
        runs from corner i to the next; tilts are those of beams along the edges as well.
    """
    made = scale_panels(panels, millimeters_per(units))
    facts, names = panel_facts(made), neighbor_ids(made)
    models = _models(made, congruent_panels(made))
    warnings = findings_by_id(check_panels(PanelSubject(made, facts, AuditLimits())))
    tilts, angles = np.degrees(facts.wall_tilts), np.degrees(facts.corner_angles)

    rows: list[dict[str, Any]] = []
    for i, name in enumerate(made.ids):
        edges = slice(int(made.offsets[i]), int(made.offsets[i + 1]))
        curvature, label = float(made.design_spheres[i, 0]), int(made.labels[i])
        is_plane = curvature == 0
        rows.append(
            {
                "id": name,
                "face": int(made.face_ids[i]),
                "mould": label + 1 if label >= 0 else None,
                "same_as": models[i],
                "shape": "plane" if is_plane else "sphere",
                "bulge": "flat" if is_plane else "out" if curvature < 0 else "in",
                "radius_mm": _finite(facts.radii[i]),
                "outer_radius_mm": _finite(facts.outer_radii[i]),
                "inner_radius_mm": _finite(facts.inner_radii[i]),
                "center_mm": None if is_plane else facts.centers[i].tolist(),
                "area_m2": float(facts.areas[i]) / SQUARE_METER,
                "volume_m3": float(facts.volumes[i]) / CUBIC_METER,
                "thickness_mm": float(made.thicknesses[i]),
                "size_mm": facts.sizes[i].tolist(),
                "blank_diameter_mm": 2 * float(facts.caps.radii[i]),
                "blank_sagitta_mm": abs(float(facts.caps.sagittas[i])),
                "edge_lengths_mm": facts.edge_lengths[edges].tolist(),
                "arc_radii_mm": [_finite(radius) for radius in facts.arc_radii[edges]],
                "sagittas_mm": facts.sagittas[edges].tolist(),
                "wall_tilts_deg": tilts[edges].tolist(),
                "corner_angles_deg": angles[edges].tolist(),
                "neighbors": names[edges],
                "corners_mm": facts.corners[edges].tolist(),
                "warnings": "; ".join(
                    f"{finding.code} {finding.message}" for finding in warnings.get(name, [])
                ),
            }
        )
    return rows


def _models(panels: Panels, same: CongruentPanels) -> list[str]:
    """Name of the first of the panels that are identical with each."""
    return [panels.ids[i] for i in same.representatives[same.labels].tolist()]


def mould_rows(panels: Panels, units: str) -> list[dict[str, Any]]:
    """
    What the schedule says of each mould.

    Parameters
    ----------
    panels : Panels
        P panels.
    units : str
        Model units: mm, cm, m, in or ft.

    Returns
    -------
    list of dict
        Rows of ``mould`` (from 1), ``radius_mm`` (None for a flat mould), ``panels`` (number),
        ``shapes`` (number of different ones), ``blank_diameter_mm``, ``blank_sagitta_mm`` and
        ``blank_opening_deg`` (of the cap that holds every panel of the mould) and ``ids``;
        empty without clustering.
    """
    made = scale_panels(panels, millimeters_per(units))
    blanks = mould_blanks(made, congruent_panels(made))
    rows: list[dict[str, Any]] = []
    for i, label in enumerate(blanks.labels.tolist()):
        members = np.flatnonzero(made.labels == label)
        rows.append(
            {
                "mould": label + 1,
                "radius_mm": _finite(blanks.radii[i]),
                "panels": int(blanks.counts[i]),
                "shapes": int(blanks.shapes[i]),
                "blank_diameter_mm": float(blanks.diameters[i]),
                "blank_sagitta_mm": float(blanks.sagittas[i]),
                "blank_opening_deg": float(np.degrees(blanks.openings[i])),
                "ids": [made.ids[member] for member in members],
            }
        )
    return rows


def write_schedule(panels: Panels, path: str | os.PathLike[str], units: str = "m") -> Path:
    """
    Write the schedule as a table or as JSON, by the suffix of the path.

    Parameters
    ----------
    panels : Panels
        P panels, at least one.
    path : path
        File ending in ``.csv`` (UTF-8 with byte order mark, as spreadsheets expect; lists are
        separated by blanks, points by semicolons), ``.xlsx`` (sheets of panels and moulds, the
        lists as in CSV) or ``.json``.
    units : str
        Model units: mm, cm, m, in or ft.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the suffix or the units are unknown, there are no panels, two have the same name or
        one is not finite, or the file cannot be written.
    MissingLibraryError
        If openpyxl is missing, which writes ``.xlsx``.
    """
    target = Path(path)
    check_suffix(target, ".csv", ".json", ".xlsx")
    check_writable(panels, target)
    rows, moulds = schedule_rows(panels, units), mould_rows(panels, units)
    with replacing(target) as temporary:
        if target.suffix.lower() == ".csv":
            _write_csv(rows, temporary)
        elif target.suffix.lower() == ".xlsx":
            _write_xlsx({"Panels": rows, "Moulds": moulds}, temporary)
        else:
            content = {"units": "mm", "moulds": moulds, "panels": rows}
            text = json.dumps(content, indent=1, allow_nan=False) + "\n"
            temporary.write_text(text, encoding="utf-8")
    return target


def _write_xlsx(sheets: Mapping[str, list[dict[str, Any]]], path: Path) -> None:
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
            sheet.append([_excel_cell(value) for value in row.values()])
    book.save(path)


def _excel_cell(value: object) -> str | int | float:
    """Numbers stay numbers; text that a spreadsheet would take for a formula is quoted."""
    if isinstance(value, int | float):
        return value
    text = _cell(value)
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text


def _write_csv(rows: Iterable[Mapping[str, Any]], path: Path) -> None:
    with path.open("w", encoding="utf-8-sig", newline="") as file:
        writer: csv.DictWriter[str] | None = None
        for row in rows:
            if writer is None:
                writer = csv.DictWriter(file, list(row))
                writer.writeheader()
            writer.writerow({name: _cell(value) for name, value in row.items()})


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, list):
        items = cast("list[object]", value)
        separator = "; " if items and isinstance(items[0], list) else " "
        return separator.join(_cell(item) or "-" for item in items)
    return str(value)


def _finite(value: np.float64) -> float | None:
    return float(value) if np.isfinite(value) else None
