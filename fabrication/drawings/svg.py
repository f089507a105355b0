"""SVG as text, for browsers and print: in true size, a group for each layer."""

from html import escape
from typing import Final

from .drawing import PENS, Align, Circle, Drawing, Line, Text

CAPITALS: Final = 0.7
"""Height of the capitals of usual fonts, by the size of the font."""

_ANCHORS: Final[dict[Align, str]] = {
    "left": "start", "center": "middle", "middle": "middle", "right": "end",
}  # fmt: skip

_HALF_TURN: Final = 1.0
"""Bulge of a half circle."""


def format_svg(drawing: Drawing, *, on_paper: bool = False) -> str:
    """A drawing as the text of an SVG file.

    Parameters
    ----------
    drawing : Drawing
    on_paper : bool
        Whether lines have their widths on paper, or one width at every scale.

    Returns
    -------
    str
        The text.
    """
    (left, bottom), (right, top) = drawing.low, drawing.high
    width, height = f"{right - left:.3f}", f"{top - bottom:.3f}"
    parts = [
        "<?xml version='1.0' encoding='utf-8'?>\n"
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
        f'viewBox="{left:.3f} {-top:.3f} {width} {height}">'
    ]
    effect = "" if on_paper else ' vector-effect="non-scaling-stroke"'
    shapes: dict[str, list[str]] = {name: [] for name in drawing.layers()}
    for line in drawing.lines:
        shapes[line.layer].append(_format_line(line, effect))
    for circle in drawing.circles:
        shapes[circle.layer].append(_format_circle(circle, effect))
    texts: dict[str, list[str]] = {name: [] for name in shapes}
    for text in drawing.texts:
        texts[text.layer].append(_format_text(text))
    parts += [
        _group(name, "".join(drawn), "".join(texts[name]), on_paper=on_paper)
        for name, drawn in shapes.items()
    ]
    return "\n".join(parts) + "\n</svg>\n"


def _group(name: str, shapes: str, texts: str, *, on_paper: bool) -> str:
    look = PENS[name]
    letters = f'font-family="sans-serif" fill="{look.stroke}"'
    if not shapes:
        return f'<g id="{name}" {letters}>{texts}</g>'
    width = look.width if on_paper else 1
    style = f'stroke="{look.stroke}" fill="none" stroke-width="{width}"'
    if look.is_dashed and on_paper:
        style += ' stroke-dasharray="2 1"'
    inner = f'<g stroke="none" {letters}>{texts}</g>' if texts else ""
    return f'<g id="{name}" {style}>{shapes}{inner}</g>'


def _format_line(line: Line, effect: str) -> str:
    points = line.points
    words = [f"M{points[0][0]:.3f} {-points[0][1]:.3f}"]
    ends = (*points[1:], points[0]) if line.is_closed else points[1:]
    for (x, y, bulge), (to_x, to_y, _) in zip(points, ends, strict=False):
        if not bulge:
            words.append(f"L{to_x:.3f} {-to_y:.3f}")
            continue
        chord = ((to_x - x) ** 2 + (to_y - y) ** 2) ** 0.5
        radius = chord * (1 + bulge**2) / (4 * abs(bulge))
        # y runs downwards in SVG: what runs counter-clockwise has the flag 0.
        flags = f"{int(abs(bulge) > _HALF_TURN)} {int(bulge < 0)}"
        words.append(f"A{radius:.3f} {radius:.3f} 0 {flags} {to_x:.3f} {-to_y:.3f}")
    return f'<path d="{"".join(words)}{"Z" if line.is_closed else ""}"{effect}/>'


def _format_circle(circle: Circle, effect: str) -> str:
    x, y, radius = circle.x, -circle.y, circle.radius
    return f'<circle cx="{x:.3f}" cy="{y:.3f}" r="{radius:.3f}"{effect}/>'


def _format_text(text: Text) -> str:
    x, y = f"{text.x:.3f}", f"{-text.y:.3f}"
    shift = f' dy="{text.height / 2:.3f}"' if text.align == "middle" else ""
    turn = f' transform="rotate({-text.turn:.3f} {x} {y})"' if text.turn else ""
    return (
        f'<text x="{x}" y="{y}" font-size="{text.height / CAPITALS:.3f}" '
        f'text-anchor="{_ANCHORS[text.align]}"{shift}{turn}>{escape(text.text)}</text>'
    )
