"""PDF pages by reportlab: arcs as Bézier curves, texts as text."""

import io
from collections import defaultdict
from collections.abc import Iterator, Sequence
from math import atan, ceil, cos, hypot, pi, radians, sin, tan
from typing import Any, Final, TypeAlias

from ...kernel.errors import MissingLibraryError
from .drawing import PENS, Line, Text
from .pages import Page

# What comes from reportlab is not typed.
_Untyped: TypeAlias = Any

_MM: Final = 72 / 25.4
"""Points in a millimetre."""

_CAPITALS: Final = 0.718
"""Height of the capitals of Helvetica, by the size of the font."""

_LATIN: Final = "Helvetica"
_OTHERS: Final = "HeiseiKakuGo-W5"
"""A font for all scripts that Helvetica lacks and viewers know: Greek, Cyrillic, East Asian."""

_CIRCLE: Final = ((1.0, 0.0, 1.0), (-1.0, 0.0, 1.0))
"""Two half circles, as points with bulges."""

_DASHES: Final = (2.0, 1.0)


def format_pdf(pages: Sequence[Page], title: str) -> bytes:
    """Pages as a PDF file; the same pages give the same bytes.

    Raises MissingLibraryError if reportlab is missing.
    """
    try:
        from reportlab.pdfbase import cidfonts, pdfmetrics
        from reportlab.pdfgen import canvas
    except ImportError as error:
        raise MissingLibraryError(
            "drawings in .pdf need reportlab: install spheremesh[drawings], or write .dxf"
        ) from error
    library: _Untyped = canvas
    metrics: _Untyped = pdfmetrics
    fonts: _Untyped = cidfonts
    metrics.registerFont(fonts.UnicodeCIDFont(_OTHERS))
    stream = io.BytesIO()
    book = library.Canvas(stream, invariant=1, pageCompression=1)
    book.setTitle(title)
    book.setCreator("spheremesh")
    for page in pages:
        width, height = page.drawing.high
        book.setPageSize((width * _MM, height * _MM))
        book.bookmarkPage(page.title)
        book.addOutlineEntry(page.title, page.title)
        _draw_lines(book, page)
        _draw_texts(book, page.drawing.texts, metrics)
        book.showPage()
    book.save()
    return stream.getvalue()


def _draw_lines(book: _Untyped, page: Page) -> None:
    """One path for each pen."""
    drawing = page.drawing
    by_layer: dict[str, list[Line]] = defaultdict(list)
    for line in drawing.lines:
        by_layer[line.layer].append(line)
    for layer, x, y, r in drawing.circles:
        points = [(x + r * u, y + r * v, bulge) for u, v, bulge in _CIRCLE]
        by_layer[layer].append(Line(layer, points, is_closed=True))
    for name in PENS:
        if name not in by_layer:
            continue
        pen = PENS[name]
        book.setStrokeColor(pen.stroke)
        book.setLineWidth(pen.width * _MM)
        book.setDash(*([[d * _MM for d in _DASHES]] if pen.is_dashed else []))
        path = book.beginPath()
        for line in by_layer[name]:
            _add_line(path, line)
        book.drawPath(path)


def _add_line(path: _Untyped, line: Line) -> None:
    points = line.points
    path.moveTo(points[0][0] * _MM, points[0][1] * _MM)
    ends = (*points[1:], points[0]) if line.is_closed else points[1:]
    for (x, y, bulge), (to_x, to_y, _) in zip(points, ends, strict=False):
        if abs(bulge) * hypot(to_x - x, to_y - y) < _STRAIGHT:
            path.lineTo(to_x * _MM, to_y * _MM)
            continue
        for curve in bezier_arcs(x, y, to_x, to_y, bulge):
            path.curveTo(*(value * _MM for value in curve))
    if line.is_closed:
        path.close()


_STRAIGHT: Final = 1e-3
"""Twice the height in millimetres below which nobody sees an arc on paper."""


def bezier_arcs(
    x: float, y: float, to_x: float, to_y: float, bulge: float
) -> Iterator[tuple[float, float, float, float, float, float]]:
    """Bézier curves of an arc, of a quarter circle at most.

    Two control points and the end of each.
    """
    sweep = 4 * atan(bulge)
    chord = hypot(to_x - x, to_y - y)
    radius = chord * (1 + bulge**2) / (4 * bulge)  # negative if it runs clockwise
    height = radius - bulge * chord / 2
    center_x = (x + to_x) / 2 - height * (to_y - y) / chord
    center_y = (y + to_y) / 2 + height * (to_x - x) / chord
    count = ceil(abs(sweep) / (pi / 2) - 1e-9)
    step = sweep / count
    arm = 4 / 3 * tan(step / 4)
    u, v = x - center_x, y - center_y
    for k in range(1, count + 1):
        c, s = cos(k * step), sin(k * step)
        next_u = (x - center_x) * c - (y - center_y) * s
        next_v = (x - center_x) * s + (y - center_y) * c
        yield (
            center_x + u - arm * v, center_y + v + arm * u,
            center_x + next_u + arm * next_v, center_y + next_v - arm * next_u,
            center_x + next_u, center_y + next_v,
        )  # fmt: skip
        u, v = next_u, next_v


def _draw_texts(book: _Untyped, texts: Sequence[Text], metrics: _Untyped) -> None:
    """One text object for each colour."""
    by_color: dict[str, list[Text]] = defaultdict(list)
    for text in texts:
        by_color[PENS[text.layer].stroke].append(text)
    for color, group in sorted(by_color.items()):
        writer = book.beginText()
        writer.setFillColor(color)
        for text in group:
            font = _LATIN if _is_latin(text.text) else _OTHERS
            size = text.height / _CAPITALS * _MM
            writer.setFont(font, size)
            width = metrics.stringWidth(text.text, font, size)
            back = {"left": 0.0, "right": width}.get(text.align, width / 2)
            down = text.height / 2 * _MM if text.align == "middle" else 0.0
            c, s = cos(radians(text.turn)), sin(radians(text.turn))
            left = text.x * _MM - back * c + down * s
            base = text.y * _MM - back * s - down * c
            writer.setTextTransform(c, s, -s, c, left, base)
            writer.textOut(text.text)
        book.drawText(writer)


def _is_latin(text: str) -> bool:
    try:
        text.encode("cp1252")
    except UnicodeEncodeError:
        return False
    return True
