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

from ..kernel.arcs import arc_circles, arc_lengths, arc_points
from ..kernel.arrays import FloatArray, IntArray, dot, norm, unit
from ..kernel.errors import InputError
from ..kernel.panels import Panels, neighbor_ids, panel_arcs, panel_areas, panel_volumes
from ..kernel.spheres import center_radius
from .files import replacing
from .units import millimeters_per

SQUARE_METER: Final = 1e6
"""Square millimetres in a square metre."""


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
        ``shape`` (sphere or plane), ``bulge`` (out, in or flat, seen along the face normal),
        ``radius_mm`` and ``center_mm`` (None for planes), ``area_m2``, ``volume_m3``,
        ``thickness_mm``, ``size_mm`` (length, width and rise of the box around the outer face,
        its length along the first edge's chord), ``edge_lengths_mm``, ``arc_radii_mm`` (None
        for straight edges), ``sagittas_mm``, ``neighbors`` (ids; None where there is none) and
        ``corners_mm``. Edge i runs from corner i to the next.
    """
    scale = millimeters_per(units)
    arcs = panel_arcs(panels)
    circles = arc_circles(arcs)
    centers, radii_squared = center_radius(panels.spheres)
    radii = np.sqrt(radii_squared) * scale
    centers = (centers + panels.origins) * scale
    areas = panel_areas(panels) * scale**2 / SQUARE_METER
    volumes = panel_volumes(panels) * (scale / 1000) ** 3
    sizes = _bounding_sizes(panels) * scale
    lengths, sagittas = arc_lengths(arcs) * scale, arcs.sagittas * scale
    corners = (panels.corners + panels.origins[panels.corner_panels]) * scale
    names = neighbor_ids(panels)

    rows: list[dict[str, Any]] = []
    for i, name in enumerate(panels.ids):
        edges = slice(int(panels.offsets[i]), int(panels.offsets[i + 1]))
        curvature, label = panels.spheres[i, 0], int(panels.labels[i])
        is_plane = curvature == 0
        rows.append(
            {
                "id": name,
                "face": int(panels.face_ids[i]),
                "mould": label + 1 if label >= 0 else None,
                "shape": "plane" if is_plane else "sphere",
                "bulge": "flat" if is_plane else "out" if curvature < 0 else "in",
                "radius_mm": None if is_plane else float(radii[i]),
                "center_mm": None if is_plane else centers[i].tolist(),
                "area_m2": float(areas[i]),
                "volume_m3": float(volumes[i]),
                "thickness_mm": panels.thickness * scale,
                "size_mm": sizes[i].tolist(),
                "edge_lengths_mm": lengths[edges].tolist(),
                "arc_radii_mm": _finite(circles.radii[edges] * scale),
                "sagittas_mm": sagittas[edges].tolist(),
                "neighbors": names[edges],
                "corners_mm": corners[edges].tolist(),
            }
        )
    return rows


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
        Rows of ``mould`` (from 1), ``radius_mm`` (None for a flat mould), ``panels`` (number)
        and ``ids``; empty without clustering.
    """
    scale = millimeters_per(units)
    rows: list[dict[str, Any]] = []
    for label in np.unique(panels.labels[panels.labels >= 0]):
        members = np.flatnonzero(panels.labels == label)
        curvature = float(np.abs(panels.spheres[members, 0]).mean())
        rows.append(
            {
                "mould": int(label) + 1,
                "radius_mm": scale / (2 * curvature) if curvature > 0 else None,
                "panels": len(members),
                "ids": [panels.ids[i] for i in members],
            }
        )
    return rows


def write_schedule(panels: Panels, path: str | os.PathLike[str], units: str = "m") -> Path:
    """
    Write the schedule as a table or as JSON, by the suffix of the path.

    Parameters
    ----------
    panels : Panels
        P panels.
    path : path
        File ending in ``.csv`` (UTF-8 with byte order mark, as spreadsheets expect; lists are
        separated by blanks, points by semicolons) or ``.json``.
    units : str
        Model units: mm, cm, m, in or ft.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the suffix or the units are unknown or the file cannot be written.
    """
    target = Path(path)
    rows = schedule_rows(panels, units)
    if target.suffix.lower() == ".csv":
        with replacing(target) as temporary:
            _write_csv(rows, temporary)
    elif target.suffix.lower() == ".json":
        content = {"units": "mm", "moulds": mould_rows(panels, units), "panels": rows}
        with replacing(target) as temporary:
            temporary.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    else:
        raise InputError(f"cannot write a schedule to {target}: end the name in .csv or .json")
    return target


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


def _finite(values: FloatArray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _bounding_sizes(panels: Panels) -> FloatArray:
    """Length, width and rise (P, 3) of the boxes around the outer faces."""
    first: IntArray = panels.offsets[:-1]
    up = unit(panels.spheres[:, 1:4])
    along = panels.corners[panels.next_corners[first]] - panels.corners[first]
    along = unit(along - dot(along, up)[:, None] * up)
    axes = np.stack([along, np.cross(up, along), up], 1)
    samples = arc_points(panel_arcs(panels), np.linspace(-1, 1, 9))
    coordinates = np.einsum("hij,hnj->hni", axes[panels.corner_panels], samples)
    low = np.minimum.reduceat(coordinates.min(1), first)
    high = np.maximum.reduceat(coordinates.max(1), first)
    # The crown of the patch, above (or below) the local origin, belongs to the box as well.
    crown = panels.spheres[:, 4] * 2 / (1 + norm(panels.spheres[:, 1:4]))
    low[:, 2], high[:, 2] = np.minimum(low[:, 2], crown), np.maximum(high[:, 2], crown)
    return high - low
