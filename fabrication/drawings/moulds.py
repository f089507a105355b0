"""Drawings of moulds: every panel in its blank, seen along the blank's axis, in millimetres."""

import os
from pathlib import Path
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.panels.facts import panel_bulges
from ...kernel.panels.mould_blanks import PanelCaps, panel_caps
from ...kernel.panels.panels import Panels, boundaries, scale_panels
from ...kernel.parts.colors import mould_name
from ..files import check_suffix, replacing
from ..model import Model, Written, check_parts
from ..units import millimeters_per
from .drawing import Circle, Drawing, Line, Text, text_width
from .dxf import format_dxf
from .outlines import axis_frames, outline_rings
from .svg import format_svg

_LAYERS: Final = ("OUTER", "INNER", "BLANK", "TEXT")
"""Outer and inner outlines, rims of blanks, labels."""


def write_mould_drawings(model: Model, path: str | os.PathLike[str]) -> Written:
    """Draw the panels of every mould into one .dxf or .svg file, see `layout_moulds`.

    Raises InputError if the suffix or the units are unknown, there are no panels, two have the
    same name or one is not finite, or the file cannot be written.
    """
    target = Path(path)
    check_suffix(target, ".dxf", ".svg")
    drawing = layout_moulds(check_parts(model.panels, "panel", target), model.units)
    is_dxf = target.suffix.lower() == ".dxf"
    text = format_dxf(drawing, _LAYERS) if is_dxf else format_svg(drawing)
    with replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return Written(target)


def layout_moulds(panels: Panels, units: str = "m") -> Drawing:
    """Arrange the panels of every mould under its title.

    A block per mould, the sharpest first, panels without a mould last. Its title names radius,
    number of panels and the blank that holds them all. Every panel is projected along the axis
    of its smallest cap, seen from outside, outer and inner outline, in the rim of its mould's
    blank, with its id and the sagitta of its own cap. The drawing lies right of x = 0 and below
    y = 0.
    """
    made = scale_panels(panels, millimeters_per(units))
    caps = panel_caps(made)
    frames = axis_frames(made, caps.axes)
    views = [
        (layer, outline_rings(made, arcs, frames, caps.centers))
        for layer, (_, arcs) in zip(("OUTER", "INNER"), boundaries(made), strict=False)
    ]
    labels = np.unique(made.labels)
    drawing = Drawing()
    count = int(labels.max(initial=-1)) + 1
    for label in np.roll(labels, -int((labels < 0).sum())).tolist():
        members = np.flatnonzero(made.labels == label)
        title = _title(made, caps, members, mould_name(label, count))
        _add_block(drawing, title, _cells(made, caps, views, members))
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


def _add_block(drawing: Drawing, title: str, cells: list[_Cell]) -> None:
    """Add cells in rows below a title, below what is drawn."""
    pitch = 2.2 * max(radius for _, _, radius, _ in cells)
    letter = pitch / 40
    columns = int(np.ceil(np.sqrt(2 * len(cells))))
    top = 6 * letter - drawing.low[1]
    drawing.texts.append(Text("TEXT", title, letter, -top, 2 * letter))
    for index, (name, remark, radius, outlines) in enumerate(cells):
        row, column = divmod(index, columns)
        x, y = (column + 0.5) * pitch, -(top + 2 * letter + (row + 0.5) * pitch)
        drawing.circles.append(Circle("BLANK", x, y, radius))
        place = np.array([x, y, 0.0])
        drawing.lines += [
            Line(layer, (ring + place).tolist(), is_closed=True) for layer, ring in outlines
        ]
        size = min(letter, pitch / text_width(name))
        drawing.texts += [
            Text("TEXT", name, x, y, size, "center"),
            Text("TEXT", remark, x, y - 2 * letter, 0.8 * letter, "center"),
        ]
    height = top + 2 * letter + -(-len(cells) // columns) * pitch
    title_end = letter * (1 + 2 * text_width(title))
    width = max(drawing.high[0], min(columns, len(cells)) * pitch, title_end)
    drawing.low, drawing.high = (0.0, -height), (width, 0.0)
