"""Drawings of moulds: every panel in its blank, seen along the blank's axis, in millimetres.

A drawing is laid out once, as lines, circles and labels on named layers, and then written as
DXF (for CAD and plotters) or SVG (for browsers and print).
"""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.etree import ElementTree

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, dot, unit
from ...kernel.panels.facts import panel_bulges
from ...kernel.panels.mould_blanks import PanelCaps, panel_caps
from ...kernel.panels.panels import Panels, boundaries, scale_panels
from ...kernel.parts.colors import mould_name
from ...kernel.spheres.arcs import Arcs, arc_points
from ..files import check_suffix, replacing
from ..model import Model, Written, check_parts
from ..units import millimeters_per
from .dxf import drawing_text, fixed_ezdxf, millimeter_drawing, text_width

_LAYERS: Final = {"OUTER": 7, "INNER": 8, "BLANK": 5, "TEXT": 3}
"""Layers and their colours in DXF: outer and inner outlines, rims of blanks, labels."""

_STROKES: Final = {"OUTER": "#000000", "INNER": "#808080", "BLANK": "#2060c0"}
"""Colours of the lines in SVG."""

_CHORD_MM: Final = 0.1
"""How far the drawn outlines stand off the arcs."""

_MAX_STEPS: Final = 128

_DECLARATION: Final = "<?xml version='1.0' encoding='utf-8'?>\n"


@dataclass(frozen=True)
class Label:
    """A line of text that begins at, or has the middle of its baseline at, a point, in mm.

    The height is that of its capitals.
    """

    text: str
    at: tuple[float, float]
    height: float
    is_centered: bool


@dataclass(frozen=True)
class Drawing:
    """What is drawn, in millimetres, y upwards: from x = 0 to the width, y = -height to 0.

    Layer and points (n, 2) of each closed line; centre x, y and radius of the rim of each
    blank.
    """

    outlines: list[tuple[str, FloatArray]]
    rims: list[tuple[float, float, float]]
    labels: list[Label]
    width: float
    height: float


def write_mould_drawings(model: Model, path: str | os.PathLike[str]) -> Written:
    """Draw the panels of every mould into one .dxf or .svg file, see `layout_moulds`.

    Raises InputError if the suffix or the units are unknown, there are no panels, two have the
    same name or one is not finite, or the file cannot be written.
    """
    target = Path(path)
    check_suffix(target, ".dxf", ".svg")
    drawing = layout_moulds(check_parts(model.panels, "panel", target), model.units)
    text = _dxf(drawing) if target.suffix.lower() == ".dxf" else _svg(drawing)
    with replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return Written(target)


def layout_moulds(panels: Panels, units: str = "m") -> Drawing:
    """Arrange the panels of every mould under its title.

    A block per mould, the sharpest first, panels without a mould last. Its title names radius,
    number of panels and the blank that holds them all. Every panel is projected along the axis
    of its smallest cap, seen from outside, outer and inner outline, in the rim of its mould's
    blank, with its id and the sagitta of its own cap.
    """
    made = scale_panels(panels, millimeters_per(units))
    caps = panel_caps(made)
    views = [
        (layer, _outlines(made, arcs, caps))
        for layer, (_, arcs) in zip(("OUTER", "INNER"), boundaries(made), strict=False)
    ]
    labels = np.unique(made.labels)
    drawing = Drawing([], [], [], 0.0, 0.0)
    count = int(labels.max(initial=-1)) + 1
    for label in np.roll(labels, -int((labels < 0).sum())).tolist():
        members = np.flatnonzero(made.labels == label)
        title = _title(made, caps, members, mould_name(label, count))
        drawing = _add_block(drawing, title, _cells(made, caps, views, members))
    return drawing


_Cell = tuple[str, str, float, list[tuple[str, FloatArray]]]
"""Id, remark, radius of the blank, and outlines about the middle of the blank."""


def _title(made: Panels, caps: PanelCaps, members: IntArray, name: str) -> str:
    blank = members[np.argmax(caps.radii[members])]
    count = f"{len(members)} panel{'s' if len(members) > 1 else ''}"
    size = f"blank {2 * caps.radii[blank]:.1f} x {abs(caps.sagittas[blank]):.1f} mm"
    if made.labels[members[0]] < 0:
        return f"Without mould: {count}, largest {size}"
    curvature = 2 * float(np.abs(made.design_spheres[members, 0]).mean())
    shape = f"radius {1 / curvature:.2f} mm" if curvature > 0 else "flat"
    return f"{name}: {shape}, {count}, {size}"


def _cells(
    made: Panels, caps: PanelCaps, views: list[tuple[str, list[FloatArray]]], members: IntArray
) -> list[_Cell]:
    largest = float(caps.radii[members].max())
    bulges = panel_bulges(made)
    is_mould = made.labels[members[0]] >= 0
    return [
        (
            made.ids[i],
            f"{2 * caps.radii[i]:.1f} x {abs(caps.sagittas[i]):.1f} {bulges[i]}",
            largest if is_mould else float(caps.radii[i]),
            [(layer, outlines[i]) for layer, outlines in views],
        )
        for i in members.tolist()
    ]


def _outlines(made: Panels, arcs: Arcs, caps: PanelCaps) -> list[FloatArray]:
    """Outline (n, 2) of each panel about the middle of its cap, seen against the axis."""
    owners, first = made.corner_panels, made.offsets[:-1]
    # An arc cut into n chords stands off them by its sagitta over n².
    sagittas = np.maximum.reduceat(np.abs(arcs.sagittas), first)
    steps = np.clip(np.ceil(np.sqrt(sagittas / _CHORD_MM)), 1, _MAX_STEPS).astype(np.int64)
    along = arcs.ends[first] - arcs.starts[first]
    along = unit(along - dot(along, caps.axes)[:, None] * caps.axes)
    frames = np.stack([along, np.cross(caps.axes, along)], 1)
    result = [np.zeros((0, 2))] * made.n_panels
    for count in np.unique(steps).tolist():
        panels = np.flatnonzero(steps == count)
        edges = np.flatnonzero(steps[owners] == count)
        chosen = Arcs(*(values[edges] for values in vars(arcs).values()))
        points = arc_points(chosen, np.linspace(-1, 1, count, endpoint=False))
        relative = points - caps.centers[owners[edges]][:, None]
        flat = np.einsum("hij,hnj->hni", frames[owners[edges]], relative).reshape(-1, 2)
        ends = np.cumsum(count * made.degrees[panels])
        for panel, outline in zip(panels.tolist(), np.split(flat, ends[:-1]), strict=True):
            result[panel] = outline
    return result


def _add_block(drawing: Drawing, title: str, cells: list[_Cell]) -> Drawing:
    """Cells in rows below a title, below what is drawn."""
    pitch = 2.2 * max(radius for _, _, radius, _ in cells)
    letter = pitch / 40
    columns = int(np.ceil(np.sqrt(2 * len(cells))))
    top = drawing.height + 6 * letter
    drawing.labels.append(Label(title, (letter, -top), 2 * letter, is_centered=False))
    for index, (name, remark, radius, outlines) in enumerate(cells):
        row, column = divmod(index, columns)
        x, y = (column + 0.5) * pitch, -(top + 2 * letter + (row + 0.5) * pitch)
        drawing.rims.append((x, y, radius))
        drawing.outlines.extend(
            (layer, points + np.array([x, y])) for layer, points in outlines
        )
        size = min(letter, pitch / text_width(name))
        drawing.labels.append(Label(name, (x, y), size, is_centered=True))
        below = (x, y - 2 * letter)
        drawing.labels.append(Label(remark, below, 0.8 * letter, is_centered=True))
    height = top + 2 * letter + -(-len(cells) // columns) * pitch
    title_end = letter * (1 + 2 * text_width(title))
    width = max(drawing.width, min(columns, len(cells)) * pitch, title_end)
    return Drawing(drawing.outlines, drawing.rims, drawing.labels, width, height)


def _dxf(drawing: Drawing) -> str:
    with fixed_ezdxf() as library:
        from ezdxf.enums import TextEntityAlignment

        document = millimeter_drawing(library, _LAYERS)
        model = document.modelspace()
        for layer, points in drawing.outlines:
            model.add_lwpolyline(points.tolist(), close=True, dxfattribs={"layer": layer})
        for x, y, radius in drawing.rims:
            model.add_circle((x, y), radius, dxfattribs={"layer": "BLANK"})
        for label in drawing.labels:
            text = model.add_text(label.text, height=label.height, dxfattribs={"layer": "TEXT"})
            centered, left = TextEntityAlignment.CENTER, TextEntityAlignment.LEFT
            text.set_placement(label.at, align=centered if label.is_centered else left)
        return drawing_text(document)


def _svg(drawing: Drawing) -> str:
    width, height = drawing.width, drawing.height
    root = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "width": f"{width:.3f}mm",
            "height": f"{height:.3f}mm",
            "viewBox": f"0 0 {width:.3f} {height:.3f}",
        },
    )
    # Lines of one width at every scale.
    line = {"fill": "none", "stroke-width": "1", "vector-effect": "non-scaling-stroke"}
    groups = {
        layer: ElementTree.SubElement(root, "g", {"id": layer, "stroke": color})
        for layer, color in _STROKES.items()
    }
    groups["TEXT"] = ElementTree.SubElement(
        root, "g", {"id": "TEXT", "font-family": "sans-serif"}
    )
    for layer, points in drawing.outlines:
        corners = "L".join(f"{x:.3f} {-y:.3f}" for x, y in points.tolist())
        ElementTree.SubElement(groups[layer], "path", {"d": f"M{corners}Z", **line})
    for x, y, radius in drawing.rims:
        circle = {"cx": f"{x:.3f}", "cy": f"{-y:.3f}", "r": f"{radius:.3f}"}
        ElementTree.SubElement(groups["BLANK"], "circle", circle | line)
    for label in drawing.labels:
        # The height of capitals is about 0.7 of the size of a font.
        place = {
            "x": f"{label.at[0]:.3f}",
            "y": f"{-label.at[1]:.3f}",
            "font-size": f"{label.height / 0.7:.3f}",
            "text-anchor": "middle" if label.is_centered else "start",
        }
        ElementTree.SubElement(groups["TEXT"], "text", place).text = label.text
    return _DECLARATION + ElementTree.tostring(root, encoding="unicode")
