"""Sheets of beams: every shape in its plane, with its measures and the cuts of its ends."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.beams.contours import beam_contours, contour_boxes
from ...kernel.beams.drilling import mark_centers
from ..schedules.records import NONE, Record, record_rows
from ..units import millimeters_per
from .drawing import Circle, Drawing, Line, Point, Text
from .pages import Page, fitted_text, new_page, paper_area, usual_scale

_WIDTH: Final = 190.0
"""Least width of the cell of a beam; that of a page if it is less."""

_HEAD: Final = 8.0
_TABLE: Final = 23.0
_SIDE: Final = 16.0
"""Room for the names of nodes at both ends of a beam."""

_ALIKE: Final = 2
"""Decimals of millimetres in which pieces of one shape agree."""

_PROFILE: Final = (13.0, 11.0)
"""Width and height of the picture of an end."""


class _Shape(NamedTuple):
    """A contour (4, 3) with bulges and holes (n, 2), about (0, 0); the beams that have it."""

    ring: FloatArray
    holes: FloatArray
    size: FloatArray
    beams: list[int]


def beam_pages(
    beams: Beams, units: str, records: Mapping[str, Record], paper: str
) -> list[Page]:
    """Pages of the shapes of beams, seen against w, the outer side up; a page has one scale.

    Pieces of one shape are drawn once, with their number and their names. The cuts of both ends
    are drawn as they are seen from the outer side.
    """
    made = scale_beams(beams, millimeters_per(units))
    shapes = _shapes(made)
    rows, ends = record_rows(records["beams"]), record_rows(records["beam_ends"])
    (left, low), (right, high) = paper_area(paper)
    columns = max(1, int((right - left) // _WIDTH))
    width = (right - left) / columns
    room = np.array([width - 2 * _SIDE, high - low - _HEAD - _TABLE - 10])
    largest = np.max([shape.size for shape in shapes], axis=0)
    least = usual_scale(float((largest / room).max()))
    lines = max(1, int((high - low) // (_HEAD + _TABLE + 10 + largest[1] / least)))
    size = width, (high - low) / lines
    room[1] = size[1] - _HEAD - _TABLE - 8
    pages: list[Page] = []
    for start in range(0, len(shapes), columns * lines):
        here = shapes[start : start + columns * lines]
        widest = np.max([shape.size for shape in here], axis=0)
        page = new_page(paper, "Beams", usual_scale(float((widest / room).max())))
        for place, shape in enumerate(here):
            line, column = divmod(place, columns)
            corner = left + column * width, high - (line + 1) * size[1]
            first = shape.beams[0]
            own = ends[2 * first : 2 * first + 2]
            _draw_cell(page, corner, size, shape, [rows[i] for i in shape.beams], own)
        pages.append(page)
    return pages


def _shapes(made: Beams) -> list[_Shape]:
    contours = beam_contours(made)
    boxes = contour_boxes(contours)
    middles = boxes.mean(axis=1)
    rings = np.concatenate(
        [contours.corners - middles[:, None], contours.bulges[..., None]], -1
    )
    holes = np.zeros((made.n_beams, 0, 2))
    fits = np.zeros(made.n_beams, bool)
    if made.marks is not None:
        fits = made.marks.fits
        holes = mark_centers(made, made.marks) - middles[:, None]
    features = np.column_stack(
        [
            rings[..., :2].reshape(made.n_beams, -1),
            # A bulge tells the height of its arc over half the chord.
            1e3 * rings[..., 2],
            (made.insets - made.insets[..., 1:2]).reshape(made.n_beams, -1),
            made.levels.reshape(made.n_beams, -1),
            np.where(fits[:, None], holes.reshape(made.n_beams, -1), 0.0),
            fits,
        ]
    )
    groups: dict[bytes, list[int]] = defaultdict(list)
    for i, key in enumerate(np.round(features, _ALIKE) + 0.0):
        groups[key.tobytes()].append(i)
    return [
        _Shape(
            rings[members[0]],
            holes[members[0]] if fits[members[0]] else np.zeros((0, 2)),
            boxes[members[0], 1] - boxes[members[0], 0],
            members,
        )
        for members in groups.values()
    ]


def _draw_cell(
    page: Page, corner: Point, size: Point, shape: _Shape, rows: list[dict[str, Any]],
    ends: list[dict[str, Any]],
) -> None:  # fmt: skip
    drawing, (x, y), (width, height), row = page.drawing, corner, size, rows[0]
    drawing.add_rectangle("TABLE", (x, y), (x + width, y + height))
    drawing.add_segments("TABLE", (x, y + _TABLE, x + width, y + _TABLE))
    top = y + height
    pieces = f"{len(rows)} pieces" if len(rows) > 1 else "1 piece"
    about = (
        f"{pieces}   {row['material']}   t {row['thickness_mm']:g}   {row['mass_kg']:.2f} kg   "
        f"order {row['assembly_order']}"
    )
    drawing.texts += [
        fitted_text("TEXT", row["id"], (x + 2, top - 5.5), 3.5, 0.3 * width),
        fitted_text("TEXT", about, (x + 0.3 * width, top - 5.5), 2.2, 0.7 * width - 2),
    ]
    middle = x + width / 2, (y + _TABLE + top - _HEAD) / 2
    _draw_piece(page, middle, width, shape, row)
    lines = _table_lines(row, ends)
    drawing.texts += [
        fitted_text("TEXT", text, (x + 2, y + _TABLE - 3.6 * (i + 1)), 1.8, width - 48)
        for i, text in enumerate((*lines, _names(rows)))
    ]
    for end, place, side in ((0, width - 44, -1), (1, width - 22, 1)):
        at = x + place + 11, y + _TABLE / 2 + 1.5
        _draw_profile(drawing, at, side, row["thickness_mm"], ends[end])
        text = f"end {end + 1}, {ends[end]['node']}"
        drawing.texts.append(Text("TABLE", text, at[0], y + 1.6, 1.5, "center"))


def _draw_piece(
    page: Page, middle: Point, width: float, shape: _Shape, row: dict[str, Any]
) -> None:
    """Contour and holes, and round about what lies where."""
    drawing = page.drawing
    points = np.column_stack([shape.ring[:, :2] / page.scale + middle, shape.ring[:, 2]])
    drawing.lines.append(Line("CUT", points.tolist(), is_closed=True))
    radius = (row["hole_diameter_mm"] or 0.0) / 2 / page.scale
    drawing.circles += [
        Circle("DRILL", u, v, radius) for u, v in (shape.holes / page.scale + middle).tolist()
    ]
    half = shape.size / page.scale / 2
    (x, y), reach = middle, _SIDE - 3
    outer, inner = (
        f"{side}   {_radius(row[f'{side}_radius_mm'])}   L {row[f'{side}_length_mm']:.1f}   "
        f"chord {row[chord]:.1f}   rise {row[rise]:.2f}"
        for side, chord, rise in (
            ("outer", "chord_mm", "sagitta_mm"),
            ("inner", "inner_chord_mm", "inner_sagitta_mm"),
        )
    )
    drawing.texts += [
        _centered("DIMENSION", outer, (x, y + half[1] + 1.4), 1.8, width - 6),
        _centered("DIMENSION", inner, (x, y - half[1] - 3.2), 1.8, width - 6),
        fitted_text("NODE", row["end_node"], (x + half[0] + 1.5, y - 0.9), 2.0, reach),
        fitted_text(
            "NODE", row["start_node"], (x - half[0] - 1.5, y - 0.9), 2.0, reach
        )._replace(align="right"),
    ]


def _centered(layer: str, text: str, at: Point, height: float, width: float) -> Text:
    return fitted_text(layer, text, at, height, width)._replace(align="center")


def _radius(radius: float | None) -> str:
    return "straight" if radius is None else f"R {radius:.1f}"


def _table_lines(row: dict[str, Any], ends: list[dict[str, Any]]) -> list[str]:
    depths = " / ".join(f"{end['depth_mm']:.1f}" for end in ends)
    box = " x ".join(f"{row[f'box_{side}_mm']:.1f}" for side in ("length", "width", "height"))
    lines = [
        f"width {row['width_mm']:.1f}   depth {depths}   length {row['length_mm']:.1f}   "
        f"box {box}   tilt {row['tilt_deg']:.1f}°",
        f"towards us (+w): {_panel(row['right_panel'])}   behind (-w): "
        f"{_panel(row['left_panel'])}   holes: {_holes(row)}",
    ]
    lines += [
        f"end {end['end']} ({end['node']})   +w: {end['upper_bevel_deg']:.1f}° "
        f"{_signed(end['upper_setback_mm'])}   ridge w {_signed(end['ridge_w_mm'])}: "
        f"{_signed(end['ridge_setback_mm'])}   -w: {end['lower_bevel_deg']:.1f}° "
        f"{_signed(end['lower_setback_mm'])}"
        for end in ends
    ]
    return lines


def _signed(length: float) -> str:
    return f"{round(length, 2) + 0.0:+.2f}"


def _panel(name: str) -> str:
    return "no panel" if name == NONE else name


def _holes(row: dict[str, Any]) -> str:
    return f"{row['holes']} x ø{row['hole_diameter_mm']:g}" if row["holes"] else "none"


def _names(rows: list[dict[str, Any]]) -> str:
    """The other pieces of a shape, with their nodes."""
    if len(rows) == 1:
        return "setbacks in mm: + ends before the contour, - beyond it"
    others = [f"{row['id']} ({row['start_node']}-{row['end_node']})" for row in rows[1:7]]
    more = f" and {len(rows) - 7} more, see beams in the tables" if len(rows) > 7 else ""
    return f"alike: {', '.join(others)}{more}"


def _draw_profile(
    drawing: Drawing, at: Point, side: int, thickness: float, end: dict[str, Any]
) -> None:
    """The end as seen from the outer side: -w below, the beam towards the middle."""
    cuts = [
        (-end["lower_setback_mm"], -thickness / 2),
        (-end["ridge_setback_mm"], end["ridge_w_mm"]),
        (-end["upper_setback_mm"], thickness / 2),
    ]
    tip, back = max(u for u, _ in cuts), min(u for u, _ in cuts) - 0.6 * thickness
    factor = min(_PROFILE[0] / (tip - back), _PROFILE[1] / thickness)
    points = [(back, -thickness / 2), *cuts, (back, thickness / 2)]
    shift = (tip + back) / 2
    drawing.lines.append(
        Line(
            "BEAM",
            [(at[0] + side * factor * (u - shift), at[1] + factor * w, 0.0) for u, w in points],
        )
    )
