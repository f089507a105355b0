"""
The schedule: a row per panel with all that a workshop asks for, in millimetres.

Coordinates are those of the model. The same ids stand in STEP, Rhino and report files. Rows of
beams are in `fabrication.beam_schedule`.
"""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from ...kernel.errors import InputError
from ...kernel.panels.congruent import CongruentPanels, congruent_panels
from ...kernel.panels.facts import panel_facts
from ...kernel.panels.mould_blanks import mould_blanks
from ...kernel.panels.panels import Panels, neighbor_ids, scale_panels
from ..audit.panels import AuditLimits, PanelSubject, check_panels, findings_by_id, warning_text
from ..files import check_suffix, replacing
from ..model import Model, Written, check_model
from ..tables import finite_or_none, format_xlsx, write_csv
from ..units import CUBIC_METER, SQUARE_METER, millimeters_per
from .beams import beam_rows, node_rows


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
        runs from corner i to the next; tilts are those of the cutting planes.
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
                "radius_mm": finite_or_none(facts.radii[i]),
                "outer_radius_mm": finite_or_none(facts.outer_radii[i]),
                "inner_radius_mm": finite_or_none(facts.inner_radii[i]),
                "center_mm": None if is_plane else facts.centers[i].tolist(),
                "area_m2": float(facts.areas[i]) / SQUARE_METER,
                "volume_m3": float(facts.volumes[i]) / CUBIC_METER,
                "thickness_mm": float(made.thicknesses[i]),
                "size_mm": facts.sizes[i].tolist(),
                "blank_diameter_mm": 2 * float(facts.caps.radii[i]),
                "blank_sagitta_mm": abs(float(facts.caps.sagittas[i])),
                "edge_lengths_mm": facts.edge_lengths[edges].tolist(),
                "arc_radii_mm": [finite_or_none(radius) for radius in facts.arc_radii[edges]],
                "sagittas_mm": facts.sagittas[edges].tolist(),
                "wall_tilts_deg": tilts[edges].tolist(),
                "corner_angles_deg": angles[edges].tolist(),
                "neighbors": names[edges],
                "corners_mm": facts.corners[edges].tolist(),
                "warnings": warning_text(warnings.get(name, ())),
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
                "radius_mm": finite_or_none(blanks.radii[i]),
                "panels": int(blanks.counts[i]),
                "shapes": int(blanks.shapes[i]),
                "blank_diameter_mm": float(blanks.diameters[i]),
                "blank_sagitta_mm": float(blanks.sagittas[i]),
                "blank_opening_deg": float(np.degrees(blanks.openings[i])),
                "ids": [made.ids[member] for member in members],
            }
        )
    return rows


def write_schedule(model: Model, path: str | os.PathLike[str]) -> Written:
    """
    Write the schedule as a table or as JSON, by the suffix of the path.

    Parameters
    ----------
    model : Model
        At least one panel or beam.
    path : path
        File ending in ``.csv`` (one table, in UTF-8 with byte order mark, as spreadsheets
        expect; lists are separated by blanks, points by semicolons), ``.xlsx`` (sheets of
        panels and moulds, of beams and nodes, the lists as in CSV) or ``.json`` (the lists
        ``panels`` and ``moulds``, ``beams`` and ``nodes``).

    Returns
    -------
    Written
        The file.

    Raises
    ------
    InputError
        If the suffix or the units are unknown, there is nothing to write, two parts have the
        same name or one is not finite, panels and beams are to share a ``.csv``, or the file
        cannot be written.
    MissingLibraryError
        If openpyxl is missing, which writes ``.xlsx``.
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
        tables |= {"Panels": schedule_rows(panels, units), "Moulds": mould_rows(panels, units)}
    if beams is not None:
        tables |= {"Beams": beam_rows(beams, units), "Nodes": node_rows(beams, units)}
    workbook = format_xlsx(tables) if target.suffix.lower() == ".xlsx" else b""
    with replacing(target) as temporary:
        if is_csv:
            write_csv(next(iter(tables.values())), temporary)
        elif workbook:
            temporary.write_bytes(workbook)
        else:
            content = {"units": "mm"} | {name.lower(): rows for name, rows in tables.items()}
            text = json.dumps(content, indent=1, allow_nan=False) + "\n"
            temporary.write_text(text, encoding="utf-8")
    return Written(target)
