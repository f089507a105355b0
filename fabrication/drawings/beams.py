"""Cutting drawings of beams as DXF: exact contours, nested on sheets, in millimetres.

Layers: ``CUT`` has a closed polyline with exact arcs for every beam, ``ENGRAVE`` its id, the
names of its nodes and the bevels of its ends, ``DRILL`` circles where it is drilled, ``SHEET``
the outlines of the sheets.
"""

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, norm
from ...kernel.beams.beams import Beams, DrillMarks, scale_beams
from ...kernel.beams.contours import Contours, beam_contours, contour_boxes, shelves
from ...kernel.beams.drilling import mark_centers
from ...kernel.errors import InputError
from ...kernel.support.node_axes import node_name
from ..files import check_suffix, replacing
from ..model import Model, Written, check_parts
from ..units import millimeters_per
from .drawing import Circle, Drawing, Line, Text, text_width
from .dxf import format_dxf
from .nesting import Grain, Stock, nest_rectangles

_LAYERS: Final = ("CUT", "ENGRAVE", "DRILL", "SHEET")

_DECIMALS: Final = 9
"""Of coordinates: contours are cut as they stand there."""

_LABEL = 25.0
"""Largest height of a label, in millimetres."""

_LABEL_SHARE = 0.35
"""Labels are at most this share of the width of their beam."""


@dataclass(frozen=True)
class SheetOptions:
    """The sheets that beams are cut from.

    Attributes
    ----------
    size : (float, float)
        Width and height, in millimetres.
    spacing : float
        Distance between pieces, in millimetres: what a cut takes, and what shall stay.
    margin : float, optional
        Least distance from the rim, in millimetres; the spacing by default.
    nesting : {"rows", "rectangles"}
        One row above the other, at once; or as few sheets as a short search finds.
    grain : {"along", "any"}
        Whether beams lie along the width of the sheet or may be turned by a right angle.
    """

    size: tuple[float, float] = (3000.0, 1500.0)
    spacing: float = 10.0
    margin: float | None = None
    nesting: Literal["rows", "rectangles"] = "rows"
    grain: Grain = "along"


_USUAL_SHEETS: Final = SheetOptions()


class _Layout(NamedTuple):
    """Turns (B, 2, 2) and shifts (B, 2) of pieces; corners (n, 2, 2) of the sheets."""

    turns: FloatArray
    shifts: FloatArray
    sheets: FloatArray
    oversize: list[int]

    def place(self, points: FloatArray) -> FloatArray:
        """Points (B, n, 2) of pieces, where they lie."""
        return np.einsum("bij,bnj->bni", self.turns, points) + self.shifts[:, None]


def write_dxf(
    model: Model, path: str | os.PathLike[str], options: SheetOptions = _USUAL_SHEETS
) -> Written:
    """Write the flat contours of beams to a DXF file, replaced when the new one is complete.

    The contour is that in the middle of the thickness (`beam_contours`). A beam larger than a
    sheet is drawn on a larger one of its own: a note says which, and the counts how many
    ``sheets``. The same beams give the same bytes: the dates in the file are fixed.

    Raises InputError if there are no beams, two have one name or one is not finite, the unit is
    not known, sheet, spacing or margin are no lengths, or the folder does not exist;
    MissingLibraryError if rectpack is missing, which nests rectangles.
    """
    target = Path(path)
    check_suffix(target, ".dxf")
    scale = millimeters_per(model.units)
    beams = check_parts(model.beams, "beam", target)
    sheet, spacing, margin = options.size, options.spacing, options.margin or 0.0
    if not (np.isfinite([*sheet, spacing, margin]).all() and min(sheet) > 0 <= spacing):
        raise InputError(f"sheet {sheet} and spacing {spacing} must be lengths in millimetres")
    beams = scale_beams(beams, scale)
    contours = beam_contours(beams)
    layout = _layout(contour_boxes(contours), options)
    corners = layout.sheets
    drawing = Drawing((0.0, 0.0), (float(corners[:, 1, 0].max()), float(corners[-1, 1, 1])))
    for low, high in corners.tolist():
        drawing.add_rectangle("SHEET", low, high)
    drawing.lines += _contour_lines(contours, layout)
    drawing.texts += _labels(beams, contours, layout)
    if beams.marks is not None:
        drawing.circles += _holes(beams, beams.marks, layout)
    text = format_dxf(drawing, _LAYERS, _DECIMALS)
    with replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    shown = ", ".join(beams.ids[i] for i in layout.oversize[:8])
    note = f"{len(layout.oversize)} beams are larger than the sheet: {shown}"
    counts = {"sheets": len(corners)}
    return Written(target, notes=(note,) if layout.oversize else (), counts=counts)


def _layout(boxes: FloatArray, options: SheetOptions) -> _Layout:
    """Where rectangles about pieces, least and largest (B, 2, 2), lie on which sheets."""
    sizes, spacing = boxes[:, 1] - boxes[:, 0], options.spacing
    margin = spacing if options.margin is None else options.margin
    if options.nesting == "rows":
        room = (
            options.size[0] - 2 * (margin - spacing),
            options.size[1] - 2 * (margin - spacing),
        )
        places, sheets, oversize = shelves(sizes, room, spacing)
        places = places + (margin - spacing)
        is_turned = np.zeros(len(sizes), bool)
    else:
        stock = Stock(options.size, spacing, margin, options.grain)
        found = nest_rectangles(sizes, stock)
        places, oversize, is_turned = found.places, found.oversize, found.is_turned
        sheets = found.sheets.tolist()
    corners = _sheet_corners(sizes, sheets, oversize, options.size, margin)
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    turns = np.where(is_turned[:, None, None], quarter, np.eye(2))
    low = np.where(is_turned[:, None], boxes[:, [1, 0], [1, 0]] * [-1.0, 1.0], boxes[:, 0])
    return _Layout(turns, places - low + corners[sheets, 0], corners, oversize)


def _sheet_corners(
    sizes: FloatArray,
    sheets: list[int],
    oversize: list[int],
    sheet: tuple[float, float],
    margin: float,
) -> FloatArray:
    """Lower left and upper right corners (n, 2, 2) of the sheets, one above the other."""
    extents = np.tile(np.array(sheet, float), (max(sheets) + 1, 1))
    for piece in oversize:
        extents[sheets[piece]] = sizes[piece] + 2 * margin
    gap = 0.2 * sheet[1]
    heights = np.concatenate([[0.0], np.cumsum(extents[:-1, 1] + gap)])
    low = np.stack([np.zeros_like(heights), heights], 1)
    return np.stack([low, low + extents], 1)


def _contour_lines(contours: Contours, layout: _Layout) -> list[Line]:
    corners = layout.place(contours.corners)
    rows = np.concatenate([corners, contours.bulges[..., None]], -1)
    return [Line("CUT", ring, is_closed=True) for ring in rows.tolist()]


def _labels(beams: Beams, contours: Contours, layout: _Layout) -> list[Text]:
    """Id of each beam in its middle, nodes and bevels near its ends."""
    result: list[Text] = []
    centers = layout.place(contours.centers)
    spans = contours.centers[:, 2, 0] - contours.centers[:, 0, 0]
    nodes: list[list[int]] = beams.annuli.edge_vertices.tolist()
    bevels: list[list[list[float]]] = np.degrees(contours.bevels).tolist()
    turns, curvatures = _turns(centers)
    for name, ends, cuts, points, span, width, along, curvature in zip(
        beams.annuli.ids, nodes, bevels, centers.tolist(), spans.tolist(),
        contours.widths.tolist(), np.degrees(turns).tolist(), curvatures.tolist(), strict=True,
    ):  # fmt: skip
        marks = [
            f"{node_name(vertex)} {low:.1f}/{high:.1f}"
            for vertex, (low, high) in zip(ends, cuts, strict=True)
        ]
        texts = [(marks[0], 0.5), (name, 1.0), (marks[1], 0.5)]
        lengths = [text_width(text) * share for text, share in texts]
        size = min(
            _LABEL, _LABEL_SHARE * width, span / sum(lengths),
            _straight_in_bow(max(lengths), width, curvature),
        )  # fmt: skip
        result += [
            Text("ENGRAVE", text, x, y, share * size, "middle", turn)
            for (text, share), (x, y), turn in zip(texts, points, along, strict=True)
        ]
    return result


def _turns(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Directions (B, 3) at three points of circles, and the curvatures (B,) of these."""
    chords = points[:, [1, 2, 2]] - points[:, [0, 1, 0]]
    first, second, both = np.arctan2(chords[..., 1], chords[..., 0]).T
    # A chord has the mean of the directions at its ends.
    turns = np.stack([2 * first - both, both, 2 * second - both], 1)
    return turns, 2 * np.abs(np.sin(second - first)) / norm(chords[:, 2])


def _straight_in_bow(length: float, width: float, curvature: float) -> float:
    """Height of a straight text, `length` heights long, that stays in a bow of some width."""
    # Half the height, and the sagitta of the length, take up half the width.
    sagitta = curvature * length**2 / 8
    return width / (0.5 + math.sqrt(0.25 + 2 * sagitta * width))


def _holes(beams: Beams, marks: DrillMarks, layout: _Layout) -> list[Circle]:
    centers = layout.place(mark_centers(beams, marks))[marks.fits]
    radius = marks.diameter / 2
    return [Circle("DRILL", x, y, radius) for x, y in centers.reshape(-1, 2).tolist()]
