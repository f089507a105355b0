"""Key plans: where every panel, beam and node of the drawings is."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm, unit
from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.panels.panels import Panels, panel_arcs, scale_panels
from ...kernel.parts.records import select_parts
from ..model import Model
from ..schedules.records import Record
from ..units import millimeters_per
from .drawing import Circle, Line, Text, text_width
from .outlines import outline_rings
from .pages import PAPERS, Page, draw_axes, new_page, paper_area, usual_scale

_VIEWS: Final = {
    "Plan": ((1, 0, 0), (0, 1, 0)),
    "Elevation from -y": ((1, 0, 0), (0, 0, 1)),
    "Elevation from +x": ((0, 1, 0), (0, 0, 1)),
    "Elevation from +y": ((-1, 0, 0), (0, 0, 1)),
    "Elevation from -x": ((0, -1, 0), (0, 0, 1)),
    "From below": ((1, 0, 0), (0, -1, 0)),
}
"""Directions to the right and upwards."""

_PLAN: Final = 3.0
"""How much rather panels are shown in plan than in elevation."""

_LEAST: Final = 1.3
"""Height on paper of names that are still read."""

_LARGEST: Final = 2.5
_SHARE: Final = 0.75
"""Of the room of a part that its name takes."""

_RIM: Final = 14.0
_MOST_TILES: Final = 12
"""Pages along one side into which a view is divided until names are read."""


class _Name(NamedTuple):
    """A name, the point of a view that it belongs to, and its direction in degrees."""

    layer: str
    text: str
    x: float
    y: float
    turn: float = 0.0


@dataclass(frozen=True)
class _View:
    """What is seen along an axis, in millimetres of the model: x to the right, y upwards.

    Outlines of panels (n, 3) with bulges, beams as lines (2, 2), and names.
    """

    title: str
    axes: FloatArray
    rings: list[FloatArray]
    lines: list[FloatArray]
    names: list[_Name]


def key_plan_pages(model: Model, records: Mapping[str, Record], paper: str) -> list[Page]:
    """Views of the model along the axes of the site, with the names of its parts.

    Panels first, then beams and their nodes. A part is shown from the side that it faces most,
    rather in plan. Where names would be too small the view is divided: its first page shows
    all, those after it show one part each.
    """
    factor = millimeters_per(model.units)
    views: list[_View] = []
    if model.panels is not None:
        panels = scale_panels(model.panels, factor)
        views += [_panel_view(panels, number) for number in range(len(_VIEWS))]
    if model.beams is not None:
        beams = scale_beams(model.beams, factor)
        views += [_beam_view(beams, records["nodes"], number) for number in range(len(_VIEWS))]
    return [page for view in views if view.names for page in _view_pages(view, paper)]


def _faces(directions: FloatArray, number: int) -> IntArray:
    """Rows of what is shown in a view, by the directions (n, 3) that parts face."""
    axes = np.array([np.cross(right, up) for right, up in _VIEWS.values()], np.float64)
    weights = np.array([_PLAN, *([1.0] * (len(_VIEWS) - 1))])
    return np.flatnonzero(np.argmax(weights * (directions @ axes.T), axis=1) == number)


def _empty_view(number: int, parts: str) -> _View:
    title, frame = list(_VIEWS.items())[number]
    return _View(f"{title}, {parts}", np.array(frame, np.float64), [], [], [])


def _panel_view(panels: Panels, number: int) -> _View:
    view = _empty_view(number, "panels")
    is_shown = np.zeros(panels.n_panels, bool)
    is_shown[_faces(unit(panels.spheres[:, 1:4]), number)] = True
    chosen = select_parts(panels, is_shown)
    if chosen.n_panels:
        frames = np.tile(view.axes, (chosen.n_panels, 1, 1))
        rings = outline_rings(chosen, panel_arcs(chosen), frames, -chosen.origins)
        view.rings.extend(rings)
        for ring, name in zip(rings, chosen.ids, strict=True):
            view.names.append(_Name("TEXT", name, *ring[:, :2].mean(axis=0).tolist()))
    return view


def _beam_view(beams: Beams, nodes: Record, number: int) -> _View:
    view = _empty_view(number, "beams and nodes")
    ends = (beams.annuli.corners[:, :, 0] + beams.annuli.origins[:, None]) @ view.axes.T
    shown = _faces(beams.annuli.frames[:, 1], number)
    for row in shown.tolist():
        line = ends[row]
        view.lines.append(line)
        along = line[1] - line[0]
        turn = float(np.degrees(np.arctan2(along[1], along[0])))
        upright = turn if -85 < turn <= 95 else turn + 180
        x, y = line.mean(axis=0).tolist()
        view.names.append(_Name("BEAM", beams.ids[row], x, y, upright))
    points = np.column_stack([nodes[f"{axis}_mm"] for axis in "xyz"]) @ view.axes.T
    ended = set(beams.annuli.edge_vertices[shown].ravel().tolist())
    for row in (i for i, vertex in enumerate(nodes["vertex"]) if vertex in ended):
        view.names.append(_Name("NODE", nodes["id"][row], *points[row].tolist()))
    return view


def _view_pages(view: _View, paper: str) -> list[Page]:
    low, high = _bounds(view)
    whole = _fitting_scale(high - low, paper)
    letter = _letter(view)
    if letter / whole >= _LEAST:
        return [_page(view, low, high, letter, paper)]
    # Parts fill pages on which the letters are read.
    counts = np.ceil((high - low) * _LEAST / (letter * _room(paper)) - 1e-9)
    columns, rows = np.clip(counts, 1, _MOST_TILES).astype(int).tolist()
    pages = [_page(view, low, high, 0.0, paper)]
    step = (high - low) / [columns, rows]
    for row, column in np.ndindex(rows, columns):
        start = low + step * np.array([column, rows - 1 - row])
        part = _part(view, f"{view.title}, part {row + 1}.{column + 1}", start, start + step)
        if part.names:
            pages.append(_page(part, *_bounds(part), letter, paper))
            _draw_part(pages[0], part, low, high, start, start + step)
    return pages


def _bounds(view: _View) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner of what is seen."""
    names = np.array([name[2:4] for name in view.names])
    points = np.concatenate([*(ring[:, :2] for ring in view.rings), *view.lines, names])
    return points.min(axis=0), points.max(axis=0)


def _part(view: _View, title: str, low: FloatArray, high: FloatArray) -> _View:
    """What has its middle in a rectangle."""

    def is_inside(point: FloatArray) -> bool:
        return bool((point >= low).all() and (point <= high).all())

    return _View(
        title,
        view.axes,
        [ring for ring in view.rings if is_inside(ring[:, :2].mean(axis=0))],
        [line for line in view.lines if is_inside(line.mean(axis=0))],
        [name for name in view.names if is_inside(np.array(name[2:4]))],
    )


def _letter(view: _View) -> float:
    """Height of letters, in the model, with which usual names have room in usual parts."""
    sizes = [np.ptp(ring[:, :2], axis=0).min() for ring in view.rings]
    # On a beam there is its own name, and half of those of its nodes.
    sizes += [norm(line[1] - line[0]) / 2 for line in view.lines]
    widest = max(text_width(name.text) for name in view.names)
    return float(np.median(sizes)) * _SHARE / widest if sizes else 0.0


def _fitting_scale(size: FloatArray, paper: str) -> float:
    return usual_scale(float((size / _room(paper)).max()))


def _room(paper: str) -> FloatArray:
    low, high = paper_area(paper)
    return np.subtract(high, low) - 2 * _RIM


def _page(view: _View, low: FloatArray, high: FloatArray, letter: float, paper: str) -> Page:
    """A page of a rectangle of a view; with the letter 0 there are no names."""
    scale = _fitting_scale(high - low, paper)
    page = new_page(paper, view.title, scale)
    shift = _middle(paper) - (low + high) / 2 / scale
    drawing = page.drawing
    for ring in view.rings:
        points = np.column_stack([ring[:, :2] / scale + shift, ring[:, 2]])
        drawing.lines.append(Line("PLAN", points.tolist(), is_closed=True))
    for line in view.lines:
        (x, y), (to_x, to_y) = (line / scale + shift).tolist()
        drawing.add_segments("BEAM", (x, y, to_x, to_y))
    height = min(_LARGEST, letter / scale)
    for name in view.names if letter else ():
        x, y = (np.array(name[2:4]) / scale + shift).tolist()
        # Names of beams stand over their lines, those of nodes beside them.
        lift = {"BEAM": 0.9, "NODE": 0.7}.get(name.layer, 0.0) * height
        turn = radians(name.turn)
        at = x - lift * sin(turn), y + lift * cos(turn)
        align = "left" if name.layer == "NODE" else "middle"
        if name.layer == "NODE":
            at = x + lift, y + lift
            drawing.circles.append(Circle("NODE", x, y, 0.3 * height))
        drawing.texts.append(Text(name.layer, name.text, *at, height, align, name.turn))
    (left, bottom), _ = paper_area(paper)
    draw_axes(drawing, (left + 10.0, bottom + 10.0), view.axes)
    return page


def _draw_part(
    page: Page, part: _View, low: FloatArray, high: FloatArray, start: FloatArray,
    end: FloatArray,
) -> None:  # fmt: skip
    """The rectangle of a part on the page that shows all, with its number."""
    paper = next(name for name, size in PAPERS.items() if size == page.drawing.high)
    shift = _middle(paper) - (low + high) / 2 / page.scale
    (left, bottom), (right, top) = ((p / page.scale + shift).tolist() for p in (start, end))
    page.drawing.add_rectangle("MARK", (left, bottom), (right, top))
    number = part.title.rpartition(" ")[2]
    at = (left + right) / 2, (bottom + top) / 2
    page.drawing.texts.append(Text("MARK", number, *at, 4.0, "middle"))


def _middle(paper: str) -> FloatArray:
    return np.mean(paper_area(paper), axis=0)
