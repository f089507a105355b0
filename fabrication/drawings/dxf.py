"""DXF as text: what is drawn, set into an empty document of AutoCAD 2010 in millimetres.

The empty document is ``template.dxf``, made by ezdxf, with marks where layers, extents and
entities stand. It has no dates and random identifiers: a drawing has the same bytes always.
"""

from functools import cache
from itertools import count
from pathlib import Path
from typing import Final

from .drawing import PENS, Align, Circle, Drawing, Line, Text

_FIRST_HANDLE: Final = 0x100
"""Numbers below are those of the template."""

_SPACE: Final = "17"
"""Number of the model space, which has all entities."""

_LAYER: Final = (
    "  0\nLAYER\n  5\n{handle:X}\n330\n1\n100\nAcDbSymbolTableRecord\n100\n"
    "AcDbLayerTableRecord\n  2\n{name}\n 70\n0\n 62\n{color}\n  6\n{dash}\n370\n{width}\n"
    "390\n13\n347\n21\n"
)

_ENTITY: Final = f"\n  5\n%X\n330\n{_SPACE}\n100\nAcDbEntity\n  8\n%s\n100\n"

_RING: Final = f"  0\nLWPOLYLINE{_ENTITY}AcDbPolyline\n 90\n%d\n 70\n%d\n"

_TEXT: Final = f"  0\nTEXT{_ENTITY}AcDbText\n 10\n%s\n 20\n%s\n 30\n0\n 40\n%s\n  1\n%s\n"

_ALIGNMENTS: Final[dict[Align, tuple[int, int]]] = {
    "left": (0, 0), "center": (1, 0), "middle": (1, 2), "right": (2, 0),
}  # fmt: skip
"""Codes of where a text has its point, along the line and across it."""

_LINE_WIDTHS: Final = (13, 18, 25, 35, 50)
"""Hundredths of a millimetre, as DXF has them."""


def format_dxf(drawing: Drawing, layers: tuple[str, ...], decimals: int = 4) -> str:
    """A drawing as the text of a DXF file.

    Parameters
    ----------
    drawing : Drawing
    layers : tuple of str
        Layers to declare, used or not; those in use are declared besides.
    decimals : int
        Of the coordinates; bulges have four more.

    Returns
    -------
    str
        The text.
    """
    handles = count(_FIRST_HANDLE)
    names = [name for name in PENS if name in {*layers, *drawing.layers()}]
    declared = "".join(
        _LAYER.format(
            handle=next(handles), name=name, color=PENS[name].color,
            dash="DASHED" if PENS[name].is_dashed else "Continuous",
            width=_line_width(PENS[name].width),
        )
        for name in names
    )  # fmt: skip
    number = f"%.{decimals}f"
    entities = [
        *(_format_line(line, next(handles), number, decimals) for line in drawing.lines),
        *(_format_circle(each, next(handles), number) for each in drawing.circles),
        *(_format_text(text, next(handles), number) for text in drawing.texts),
    ]
    (left, bottom), (right, top) = drawing.low, drawing.high
    values = {
        "left": left, "bottom": bottom, "right": right, "top": top,
        "middle_x": (left + right) / 2, "middle_y": (bottom + top) / 2,
        "view_height": max(top - bottom, (right - left) / 1.6) or 1.0,
        "line_scale": max(top - bottom, right - left) / 500 or 1.0,
    }  # fmt: skip
    marks = {name: f"{value:.6f}" for name, value in values.items()} | {
        "next_handle": f"{next(handles):X}", "layer_count": str(2 + len(names)),
        "layers": declared, "entities": "".join(entities),
    }  # fmt: skip
    parts = _template().split("@")
    return "".join(marks[part] if i % 2 else part for i, part in enumerate(parts))


@cache
def _template() -> str:
    return Path(__file__).with_name("template.dxf").read_text("utf-8")


def _line_width(width: float) -> int:
    return min(_LINE_WIDTHS, key=lambda each: abs(each - 100 * width))


def _format_line(line: Line, handle: int, number: str, decimals: int) -> str:
    points = line.points
    head = _RING % (handle, line.layer, len(points), line.is_closed)
    vertex = f" 10\n{number}\n 20\n{number}\n"
    if not any(point[2] for point in points):
        return head + (vertex * len(points)) % tuple(
            value for point in points for value in point[:2]
        )
    vertex += f" 42\n%.{decimals + 4}f\n"
    return head + (vertex * len(points)) % tuple(value for point in points for value in point)


def _format_circle(circle: Circle, handle: int, number: str) -> str:
    body = f"AcDbCircle\n 10\n{number}\n 20\n{number}\n 30\n0\n 40\n%.9f\n"
    numbers = (circle.x, circle.y, circle.radius)
    return f"  0\nCIRCLE{_ENTITY}" % (handle, circle.layer) + body % numbers


def _format_text(text: Text, handle: int, number: str) -> str:
    x, y = number % text.x, number % text.y
    entry = _TEXT % (handle, text.layer, x, y, f"{text.height:.6g}", text.text)
    if text.turn:
        entry += f" 50\n{text.turn:.9g}\n"
    along, across = _ALIGNMENTS[text.align]
    if not along:
        return f"{entry}100\nAcDbText\n"
    entry += f" 72\n{along}\n 11\n{x}\n 21\n{y}\n 31\n0\n100\nAcDbText\n"
    return entry + (f" 73\n{across}\n" if across else "")
