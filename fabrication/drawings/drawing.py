"""What is drawn, before it is DXF, SVG or PDF: lines with arcs, circles and texts on layers.

In millimetres, x to the right and y upwards.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Literal, NamedTuple
from unicodedata import east_asian_width


class Pen(NamedTuple):
    """What a layer is drawn with.

    Attributes
    ----------
    color : int
        AutoCAD's index, for DXF.
    stroke : str
        The colour in SVG and PDF, as #rrggbb; an index of DXF means other shades on black.
    width : float
        Of lines on paper, in millimetres.
    is_dashed : bool
    """

    color: int
    stroke: str
    width: float
    is_dashed: bool = False


PENS: Final = {
    "CUT": Pen(1, "#c00000", 0.25),
    "ENGRAVE": Pen(3, "#007000", 0.18),
    "DRILL": Pen(5, "#2040c0", 0.25),
    "SHEET": Pen(8, "#808080", 0.25),
    "OUTER": Pen(7, "#000000", 0.35),
    "INNER": Pen(8, "#808080", 0.18, is_dashed=True),
    "PLAN": Pen(7, "#000000", 0.13),
    "BLANK": Pen(5, "#2060c0", 0.18),
    "TEXT": Pen(3, "#000000", 0.18),
    "DIMENSION": Pen(4, "#205080", 0.13),
    "MARK": Pen(1, "#c00000", 0.25),
    "BEAM": Pen(32, "#705c4a", 0.25),
    "NODE": Pen(6, "#800080", 0.18),
    "FRAME": Pen(7, "#000000", 0.5),
    "TABLE": Pen(8, "#606060", 0.13),
}  # fmt: skip
"""Pens of the layers of all drawings, in the order in which they are named in files."""

Point = tuple[float, float]
Align = Literal["left", "center", "middle", "right"]
"""Where a text has its point: on its baseline, or in the middle of its capitals (middle)."""


class Line(NamedTuple):
    """Sides one after the other.

    Attributes
    ----------
    layer : str
    points : sequence of (float, float, float)
        Where a side begins, x and y, and its bulge: the tangent of a quarter of the sweep of an
        arc that runs counter-clockwise, negative if clockwise, 0 for straight ones.
    is_closed : bool
        Whether a side leads from the last point to the first.
    """

    layer: str
    points: Sequence[Sequence[float]]
    is_closed: bool = False


class Circle(NamedTuple):
    """A circle by its centre and radius."""

    layer: str
    x: float
    y: float
    radius: float


class Text(NamedTuple):
    """A line of text.

    Attributes
    ----------
    layer, text : str
    x, y : float
    height : float
        That of its capitals.
    align : {"left", "center", "middle", "right"}
    turn : float
        Direction of the line, in degrees.
    """

    layer: str
    text: str
    x: float
    y: float
    height: float
    align: Align = "left"
    turn: float = 0.0


@dataclass
class Drawing:
    """What is drawn between two corners, the lower left and the upper right."""

    low: Point = (0.0, 0.0)
    high: Point = (0.0, 0.0)
    lines: list[Line] = field(default_factory=list[Line])
    circles: list[Circle] = field(default_factory=list[Circle])
    texts: list[Text] = field(default_factory=list[Text])

    def layers(self) -> list[str]:
        """Names of the layers in use."""
        used = {each.layer for each in (*self.lines, *self.circles, *self.texts)}
        return [name for name in PENS if name in used]

    def add_segments(self, layer: str, *segments: tuple[float, float, float, float]) -> None:
        """Add straight lines, each by the x and y of both ends."""
        self.lines += [
            Line(layer, ((x, y, 0.0), (to_x, to_y, 0.0))) for x, y, to_x, to_y in segments
        ]

    def add_rectangle(self, layer: str, low: Point, high: Point) -> None:
        """Add a rectangle by its lower left and upper right corner."""
        (left, bottom), (right, top) = low, high
        ring = ((left, bottom, 0.0), (right, bottom, 0.0), (right, top, 0.0), (left, top, 0.0))
        self.lines.append(Line(layer, ring, is_closed=True))


_LETTER: Final = 0.9
"""Width of letters, in heights; twice as wide in the scripts of East Asia."""


def text_width(text: str) -> float:
    """Width of a line of text, on the safe side: in heights of its capitals."""
    wide = sum(east_asian_width(letter) in "WF" for letter in text)
    return _LETTER * (len(text) + wide)
