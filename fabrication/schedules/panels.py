"""Rows of the schedule for panels and moulds, with all that a workshop asks for.

In millimetres and degrees, coordinates those of the model. The same ids stand in STEP, Rhino,
drawings and report files.
"""

from typing import Any

import numpy as np

from ...kernel.panels.congruent import CongruentPanels
from ...kernel.panels.facts import panel_bulges
from ...kernel.panels.mould_blanks import mould_blanks
from ...kernel.panels.panels import Panels, neighbor_ids
from ..audit.panels import PanelSubject, check_panels, panel_subject, same_shapes
from ..audit.subjects import warning_texts
from ..tables import finite_or_none
from ..units import CUBIC_METER, SQUARE_METER


def panel_tables(panels: Panels, units: str) -> dict[str, list[dict[str, Any]]]:
    """What the schedule says of panels and their moulds, as plain values.

    ``Panels``: P rows of the columns ``id``, ``face``, ``mould`` (from 1; None without
    clustering), ``same_as`` (the first of identical panels), ``shape`` (sphere or plane),
    ``bulge`` (out, in or flat, seen along the face normal), ``radius_mm`` (of the mould),
    ``outer_radius_mm``, ``inner_radius_mm`` and ``center_mm`` (None for planes), ``area_m2``,
    ``volume_m3``, ``thickness_mm``, ``size_mm`` (length, width and rise of the box around the
    outer face, its length along the first edge's chord), ``blank_diameter_mm`` and
    ``blank_sagitta_mm`` of the smallest cap of the mould that holds the panel,
    ``edge_lengths_mm``, ``arc_radii_mm`` (None for straight edges), ``sagittas_mm``,
    ``wall_tilts_deg``, ``corner_angles_deg``, ``neighbors`` (ids; None where there is none),
    ``edge_kinds`` (smooth, crease or rim),
    ``corners_mm`` and ``warnings`` (findings of the audit). Edge i runs from corner i to the
    next; tilts are those of the cutting planes.

    ``Moulds``: rows of ``mould`` (from 1), ``radius_mm`` (None for a flat mould), ``panels``
    (number), ``shapes`` (number of different ones), ``blank_diameter_mm``, ``blank_sagitta_mm``
    and ``blank_opening_deg`` (of the cap that holds every panel of the mould) and ``ids``;
    empty without clustering.
    """
    subject = panel_subject(panels, units)
    same = same_shapes(subject.parts)
    return {"Panels": _panel_rows(subject, same), "Moulds": _mould_rows(subject, same)}


def _panel_rows(subject: PanelSubject, same: CongruentPanels) -> list[dict[str, Any]]:
    made, facts = subject.parts, subject.facts
    kinds = np.where(made.is_crease, "crease", np.where(made.edge_ids < 0, "rim", "smooth"))
    kinds = kinds.tolist()
    names, bulges = neighbor_ids(made), panel_bulges(made)
    first: list[int] = same.representatives[same.labels].tolist()
    warnings = warning_texts(check_panels(subject))
    tilts, angles = np.degrees(facts.wall_tilts), np.degrees(facts.corner_angles)

    rows: list[dict[str, Any]] = []
    for i, name in enumerate(made.ids):
        edges = slice(int(made.offsets[i]), int(made.offsets[i + 1]))
        label, is_plane = int(made.labels[i]), bulges[i] == "flat"
        rows.append(
            {
                "id": name,
                "face": int(made.face_ids[i]),
                "mould": label + 1 if label >= 0 else None,
                "same_as": made.ids[first[i]],
                "shape": "plane" if is_plane else "sphere",
                "bulge": bulges[i],
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
                "edge_kinds": kinds[edges],
                "corners_mm": facts.corners[edges].tolist(),
                "warnings": warnings.get(name, ""),
            }
        )
    return rows


def _mould_rows(subject: PanelSubject, same: CongruentPanels) -> list[dict[str, Any]]:
    made = subject.parts
    blanks = mould_blanks(made, same, caps=subject.facts.caps)
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
