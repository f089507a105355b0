"""Sheets of panels, by moulds: every panel seen from outside, with its measures."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ...kernel.arrays import FloatArray, dot, norm
from ...kernel.panels.mould_blanks import panel_caps
from ...kernel.panels.panels import Panels, boundaries, scale_panels
from ...kernel.parts.colors import mould_name
from ..schedules.records import Record, record_rows
from ..units import millimeters_per
from .drawing import Drawing, Line, Point, Text, text_width
from .outlines import axis_frames, outline_rings
from .pages import Page, draw_axes, fitted_text, new_page, paper_area, usual_scale

_CELL: Final = (95.0, 84.0)
"""Least width and height of the cell of a panel."""

_HEAD: Final = 13.0
_LETTER: Final = 1.9
_TABLE: Final = 0.45
"""Share of the width of a cell that its table has."""


@dataclass(frozen=True)
class _Views:
    """Panels as they are drawn: rings by layer about (0, 0), and the axes of the page."""

    rings: list[list[tuple[str, FloatArray]]]
    axes: FloatArray


def panel_pages(
    panels: Panels, units: str, records: Mapping[str, Record], paper: str
) -> list[Page]:
    """Pages of the panels of every mould; those without a mould come last.

    All panels of a page have one scale. Each is seen along the axis of its cap, edge 1 to the
    right: corners are numbered, edges have their lengths and the names of the panels beyond,
    and three arrows show where the axes of the site point. A table has what the picture cannot
    show.
    """
    made = scale_panels(panels, millimeters_per(units))
    views = _views(made)
    rows, edges = record_rows(records["panels"]), record_rows(records["panel_edges"])
    labels = np.unique(made.labels)
    count = int(labels.max(initial=-1)) + 1
    (left, low), (right, high) = paper_area(paper)
    columns = max(1, int((right - left) // _CELL[0]))
    lines = max(1, int((high - low) // _CELL[1]))
    size = (right - left) / columns, (high - low) / lines
    pages: list[Page] = []
    for label in np.roll(labels, -int((labels < 0).sum())).tolist():
        members: list[int] = np.flatnonzero(made.labels == label).tolist()
        name = mould_name(label, count) if label >= 0 else "Panels without mould"
        for start in range(0, len(members), columns * lines):
            here = members[start : start + columns * lines]
            page = new_page(paper, name, _scale([views.rings[i] for i in here], size))
            for place, i in enumerate(here):
                line, column = divmod(place, columns)
                corner = left + column * size[0], high - (line + 1) * size[1]
                own = edges[made.offsets[i] : made.offsets[i + 1]]
                _draw_cell(page, corner, size, rows[i], own, views.rings[i], views.axes[i])
            pages.append(page)
    return pages


def _views(made: Panels) -> _Views:
    caps = panel_caps(made)
    frames = axis_frames(made, caps.axes)
    faces = [
        (layer, outline_rings(made, arcs, frames, caps.centers))
        for layer, (_, arcs) in zip(("OUTER", "INNER"), boundaries(made), strict=False)
    ]
    rings = [[(layer, outlines[i]) for layer, outlines in faces] for i in range(made.n_panels)]
    # About the middle of what is seen.
    for each in rings:
        points = np.concatenate([ring for _, ring in each])[:, :2]
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        for _, ring in each:
            ring[:, :2] -= middle
    return _Views(rings, frames)


def _scale(views: list[list[tuple[str, FloatArray]]], size: Point) -> float:
    """A scale at which every panel fits, with room for the texts at its edges."""
    reach = np.max(
        [np.abs(ring[:, :2]).max(axis=0) for view in views for _, ring in view], axis=0
    )
    room = _picture(size)
    return usual_scale(float(max(2 * reach[0] / room[0], 2 * reach[1] / room[1])))


def _picture(size: Point) -> Point:
    return size[0] * (1 - _TABLE) - 14.0, size[1] - _HEAD - 12.0


def _draw_cell(
    page: Page, corner: Point, size: Point, row: dict[str, Any], edges: list[dict[str, Any]],
    rings: list[tuple[str, FloatArray]], axes: FloatArray,
) -> None:  # fmt: skip
    drawing, (x, y), (width, height) = page.drawing, corner, size
    drawing.add_rectangle("TABLE", (x, y), (x + width, y + height))
    _draw_head(drawing, (x, y + height), width, row)
    room = _picture(size)
    middle = x + room[0] / 2 + 7.0, y + room[1] / 2 + 6.0
    placed = [
        (layer, np.column_stack([ring[:, :2] / page.scale + middle, ring[:, 2]]))
        for layer, ring in rings
    ]
    drawing.lines += [Line(layer, ring.tolist(), is_closed=True) for layer, ring in placed]
    _draw_marks(drawing, _chords(placed[0][1], len(edges)), edges)
    draw_axes(drawing, (x + width * (1 - _TABLE) + 12.0, y + 10.0), axes)
    _draw_table(drawing, (x + width * (1 - _TABLE), y + height - _HEAD), width * _TABLE, edges)


def _chords(ring: FloatArray, count: int) -> FloatArray:
    """The chords (count, 3) of the edges of a ring with their bulges, about."""
    pieces = len(ring) // count
    chords = ring[::pieces].copy()
    # The angles of pieces of an edge add up.
    turns = np.arctan(ring[:, 2]).reshape(count, pieces).sum(axis=1)
    chords[:, 2] = np.tan(turns)
    return chords


def _draw_head(drawing: Drawing, at: Point, width: float, row: dict[str, Any]) -> None:
    x, top = at
    radius = "flat" if row["radius_mm"] is None else f"R {row['radius_mm']:.1f} {row['bulge']}"
    mass = "" if row["mass_kg"] is None else f"   {row['mass_kg']:.1f} kg"
    same = "" if row["same_as"] == row["id"] else f"   as {row['same_as']}"
    first = f"{row['material']}   t {row['thickness_mm']:g}   {row['area_m2']:.3f} m²{mass}"
    second = (
        f"box {row['box_length_mm']:.0f} x {row['box_width_mm']:.0f} x "
        f"{row['box_height_mm']:.0f}   blank ø{row['blank_diameter_mm']:.1f} x "
        f"{row['blank_sagitta_mm']:.1f}   order {row['assembly_order']}{same}"
    )
    half = width / 2 - 3
    drawing.texts += [
        fitted_text("TEXT", row["id"], (x + 2, top - 5.0), 3.5, half),
        fitted_text("TEXT", radius, (x + width / 2, top - 5.0), 2.5, half),
        fitted_text("TABLE", first, (x + 2, top - 8.4), 1.8, width - 4),
        fitted_text("TABLE", second, (x + 2, top - 11.4), 1.8, width - 4),
    ]
    drawing.add_segments("TABLE", (x, top - _HEAD, x + width, top - _HEAD))


def _draw_marks(drawing: Drawing, sides: FloatArray, edges: list[dict[str, Any]]) -> None:
    """Numbers of the corners inside; lengths outside and neighbours inside along the edges.

    The sides (n, 3) are those of the outer outline with their bulges, chords of the edges.
    """
    starts = sides[:, :2]
    steps = np.roll(starts, -1, axis=0) - starts
    lengths = norm(steps)
    out = np.stack([steps[:, 1], -steps[:, 0]], 1) / lengths[:, None]
    center = starts.mean(axis=0)
    # How far the edges are from the middle says how large letters may be.
    letter = min(_LETTER, float(dot(starts - center, out).min()) / 3.6)
    shorter = np.minimum(lengths, np.roll(lengths, 1))
    numbers = np.clip(shorter / 3, 0.3 * letter, letter)
    away = norm(center - starts)
    inward = np.minimum(1.6 * numbers + 0.2 * letter, 0.35 * away) / away
    places = starts + inward[:, None] * (center - starts)
    # An arc stands off its chord by its bulge times half of that.
    middles = starts + steps / 2 + (sides[:, 2] * lengths / 2)[:, None] * out
    turns = np.arctan2(steps[:, 1], steps[:, 0])
    # Texts never stand on their heads.
    upright = np.degrees(
        np.where((turns > -1.5) & (turns <= np.pi - 1.5), turns, turns + np.pi)
    )
    for i, edge in enumerate(edges):
        x, y = places[i].tolist()
        drawing.texts.append(Text("MARK", str(i + 1), x, y, float(numbers[i]), "middle"))
        turn, length = float(upright[i]), float(lengths[i])
        for layer, text, shift, height in (
            ("DIMENSION", f"{edge['length_mm']:.1f}", 1.3 * _LETTER, _LETTER),
            ("TEXT", edge["neighbor"], -1.1 * letter, 0.8 * letter),
        ):
            x, y = (middles[i] + shift * out[i]).tolist()
            # Beside short edges letters are smaller, as long as they can be read.
            fits = max(1.1 * length / text_width(text), 0.4 * height)
            drawing.texts.append(Text(layer, text, x, y, min(height, fits), "middle", turn))
    x, y = center.tolist()
    drawing.texts.append(Text("DIMENSION", "OUTSIDE", x, y, 0.6 * letter, "middle"))


_COLUMNS: Final = ("edge", "beyond", "length", "rise", "wall°", "to°")
_WIDTHS: Final = (0.13, 0.2, 0.2, 0.17, 0.15, 0.15)


def _draw_table(drawing: Drawing, at: Point, width: float, edges: list[dict[str, Any]]) -> None:
    """A row for each edge, then the diagonals."""
    count = len(edges)
    lines = [
        (
            f"{i + 1}-{(i + 1) % count + 1}", edge["neighbor"], f"{edge['length_mm']:.1f}",
            f"{edge['sagitta_mm']:.2f}", f"{edge['wall_tilt_deg']:.1f}",
            "-" if edge["neighbor_angle_deg"] is None else f"{edge['neighbor_angle_deg']:.2f}",
        )
        for i, edge in enumerate(edges)
    ]  # fmt: skip
    x, y = at
    pitch = min(3.6, 50.0 / (2 * count + 3))
    letter = 0.47 * pitch
    rooms = [share * (width - 2) for share in _WIDTHS]
    rows = (_COLUMNS, *lines)
    size = min(
        (room - 0.5) / text_width(text)
        for row in rows
        for room, text in zip(rooms, row, strict=True)
    )
    for row in rows:
        y -= pitch
        place = x
        for text, room in zip(row, rooms, strict=True):
            layer = "TABLE" if row is _COLUMNS else "TEXT"
            drawing.texts.append(Text(layer, text, place, y, min(letter, size)))
            place += room
    y -= pitch / 2
    seen: set[tuple[int, int]] = set()
    for i, edge in enumerate(edges):
        pair = (i + 1, (i + 2) % count + 1)
        if count < 4 or pair[::-1] in seen:
            continue
        seen.add(pair)
        y -= pitch
        text = f"diagonal {pair[0]}-{pair[1]}   {edge['diagonal_mm']:.1f}"
        drawing.texts.append(fitted_text("TEXT", text, (x, y), letter, width - 3))
