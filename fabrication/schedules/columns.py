"""What a page says of parts: the columns of the schedule that are known in a moment.

In millimetres and degrees, rounded to what anybody reads; parts are named by their row.
"""

from itertools import pairwise
from typing import Any

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams, beam_lengths
from ...kernel.panels.facts import (
    bounding_sizes,
    corner_misses,
    edge_angles,
    panel_bulges,
    panel_radii,
    wall_tilts,
)
from ...kernel.panels.panels import Panels, panel_arcs, panel_areas
from ...kernel.spheres.arcs import arc_lengths
from ...kernel.support.annuli import end_depths
from ...kernel.support.node_axes import node_name
from ..units import SQUARE_METER, millimeters_per

Column = list[Any]


def panel_columns(panels: Panels | None, units: str) -> dict[str, Column]:
    """Columns of P panels.

    ``id``, ``mould`` (from 1; None without), ``bulge``, ``radius_mm`` (None for planes),
    ``area_m2``, ``thickness_mm``, ``size_mm``, ``planarity_mm`` (how far corners are off their
    plane), ``tilt_deg`` (of the wall that leans most from the normals), and of each edge in
    order ``edge_lengths_mm``, ``sagittas_mm``, ``angles_deg`` (to the neighbour) and
    ``neighbors`` (rows; None where there is none).
    """
    if panels is None or not panels.ids:
        names = (
            "id", "mould", "bulge", "radius_mm", "area_m2", "thickness_mm", "size_mm",
            "planarity_mm", "tilt_deg",
            "edge_lengths_mm", "sagittas_mm", "angles_deg", "neighbors",
        )  # fmt: skip
        return {name: [] for name in names}
    scale, arcs, tilts = millimeters_per(units), panel_arcs(panels), wall_tilts(panels)
    rows = {face: row for row, face in enumerate(panels.face_ids.tolist())}
    faces: list[int] = panels.neighbors.tolist()
    return {
        "id": list(panels.ids),
        "mould": [label + 1 if label >= 0 else None for label in panels.labels.tolist()],
        "bulge": panel_bulges(panels),
        "radius_mm": _rounded(panel_radii(panels).radii * scale),
        "area_m2": _rounded(panel_areas(panels) * scale**2 / SQUARE_METER),
        "thickness_mm": _rounded(panels.thicknesses * scale),
        "size_mm": [_rounded(size) for size in bounding_sizes(panels) * scale],
        "planarity_mm": np.round(corner_misses(panels) * scale, 3).tolist(),
        "tilt_deg": _rounded(np.degrees(np.maximum.reduceat(tilts, panels.offsets[:-1])), 3),
        "edge_lengths_mm": _by_panel(panels, _rounded(arc_lengths(arcs) * scale)),
        "sagittas_mm": _by_panel(panels, _rounded(arcs.sagittas * scale, 3)),
        "angles_deg": _by_panel(panels, _rounded(np.degrees(edge_angles(panels)), 3)),
        "neighbors": _by_panel(panels, [rows.get(face) for face in faces]),
    }


def beam_columns(beams: Beams | None, panels: Panels | None, units: str) -> dict[str, Column]:
    """Columns of B beams.

    ``id``, ``panels`` (rows of the panels on both sides; None beyond the boundary), ``nodes``
    (names at both ends), ``length_mm``, ``depths_mm`` (at both ends), ``thickness_mm`` and
    ``tilt_deg``.
    """
    if beams is None or not beams.ids:
        names = "id", "panels", "nodes", "length_mm", "depths_mm", "thickness_mm", "tilt_deg"
        return {name: [] for name in names}
    scale, annuli = millimeters_per(units), beams.annuli
    faces: list[int] = panels.face_ids.tolist() if panels is not None else []
    rows = {face: row for row, face in enumerate(faces)}
    return {
        "id": list(beams.ids),
        "panels": [[rows.get(face) for face in pair] for pair in annuli.edge_faces.tolist()],
        "nodes": [[node_name(end) for end in pair] for pair in annuli.edge_vertices.tolist()],
        "length_mm": _rounded(beam_lengths(beams) * scale),
        "depths_mm": [_rounded(pair) for pair in end_depths(annuli) * scale],
        "thickness_mm": [round(beams.thickness * scale, 3)] * beams.n_beams,
        "tilt_deg": _rounded(np.degrees(annuli.tilt), 3),
    }


def _by_panel(panels: Panels, values: Column) -> list[Column]:
    """Values of edges, those of each panel together."""
    return [values[i:j] for i, j in pairwise(panels.offsets.tolist())]


def _rounded(values: FloatArray, digits: int = 4) -> Column:
    """Numbers with so many significant digits, six decimals; None where they are not finite."""
    finite = np.isfinite(values)
    safe = np.where(finite, values, 0.0)
    powers = 10.0 ** (digits - 1 - np.floor(np.log10(np.maximum(np.abs(safe), 1e-9))))
    numbers: list[float] = np.round(np.round(safe * powers) / powers, 6).tolist()
    known: list[bool] = finite.tolist()
    return [value if is_known else None for value, is_known in zip(numbers, known, strict=True)]
