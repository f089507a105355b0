"""Pages of paper: sizes, frames, title blocks, and all pages of a set in one drawing."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, hypot, log10
from typing import Final

from ...kernel.arrays import FloatArray
from .drawing import Drawing, Point, Text, text_width

PAPERS: Final = {
    "A4": (297.0, 210.0), "A3": (420.0, 297.0), "A2": (594.0, 420.0), "A1": (841.0, 594.0),
    "A0": (1189.0, 841.0),
}  # fmt: skip
"""Width and height of pages across, in millimetres."""

MARGIN: Final = 10.0
_STRIP: Final = 12.0
"""Height of the title block, along the lower margin."""

_STEPS: Final = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.5)
"""Scales are 1 to these, times powers of ten."""

_AXES: Final = "xyz"

_ARROW: Final = 5.0
"""Length on paper of arrows that lie in the plane of what is drawn."""

_GAP: Final = 0.1
"""Between pages in one drawing, by their height."""


@dataclass(frozen=True)
class TitleBlock:
    """What all pages of a set say of themselves."""

    project: str
    revision: str
    date: str


@dataclass
class Page:
    """A page in millimetres of paper, on which lengths are 1 to the scale."""

    title: str
    drawing: Drawing
    scale: float = 1.0


def paper_area(paper: str) -> tuple[Point, Point]:
    """Lower left and upper right corner of what a page has room for."""
    width, height = PAPERS[paper]
    return (MARGIN, MARGIN + _STRIP), (width - MARGIN, height - MARGIN)


def new_page(paper: str, title: str, scale: float) -> Page:
    """A page with nothing but its frame."""
    width, height = PAPERS[paper]
    drawing = Drawing((0.0, 0.0), (width, height))
    drawing.add_rectangle("FRAME", (MARGIN, MARGIN), (width - MARGIN, height - MARGIN))
    return Page(title, drawing, scale)


def usual_scale(ratio: float) -> float:
    """The least usual scale, one to so many, at which what is `ratio` times too large fits.

    Examples
    --------
    >>> usual_scale(3.1), usual_scale(18), usual_scale(0.3), usual_scale(260)
    (4.0, 20.0, 0.3, 300.0)
    """
    power = 10.0 ** (ceil(log10(ratio)) - 1) if ratio > 0 else 1.0
    for step in _STEPS:
        if ratio <= step * power * (1 + 1e-9):
            return float(f"{step * power:.3g}")
    return 10 * power


def scale_name(scale: float) -> str:
    """A scale as people write it.

    Examples
    --------
    >>> scale_name(20), scale_name(0.5)
    ('1:20', '2:1')
    """
    return f"1:{scale:g}" if scale >= 1 else f"{1 / scale:g}:1"


def finish_pages(pages: Sequence[Page], block: TitleBlock) -> None:
    """Add the title block to every page: project, title, scale, revision, date, number."""
    for number, page in enumerate(pages, 1):
        drawing = page.drawing
        left, right, low = MARGIN, drawing.high[0] - MARGIN, MARGIN
        cells = (
            ("project", block.project, 0.26), ("drawing", page.title, 0.34),
            ("scale", scale_name(page.scale), 0.1), ("revision", block.revision, 0.1),
            ("date", block.date, 0.1), ("page", f"{number} / {len(pages)}", 0.1),
        )  # fmt: skip
        drawing.add_segments("FRAME", (left, low + _STRIP, right, low + _STRIP))
        x = left
        for name, value, share in cells:
            width = share * (right - left)
            drawing.texts += [
                Text("TABLE", name, x + 1.5, low + 8.6, 1.6),
                fitted_text("TEXT", value, (x + 1.5, low + 3.0), 3.2, width - 3),
            ]
            x += width
            if x < right - 1:
                drawing.add_segments("TABLE", (x, low, x, low + _STRIP))


def fitted_text(layer: str, text: str, at: Point, height: float, width: float) -> Text:
    """A text from a point on that is not wider than there is room."""
    fits = width / text_width(text) if text else height
    return Text(layer, text, *at, min(height, fits))


def draw_axes(drawing: Drawing, at: Point, frame: FloatArray) -> None:
    """Where the axes of the site point, seen as the panel is; those towards us are dots."""
    (x, y), labels = at, list[Point]()
    for name, (right, up) in zip(_AXES, frame.T.tolist(), strict=True):
        tip_x, tip_y = x + _ARROW * right, y + _ARROW * up
        length = hypot(right, up)
        if length < 0.15:
            continue
        drawing.add_segments("MARK", (x, y, tip_x, tip_y))
        for side in (-1, 1):
            back_x = tip_x - (right * 1.2 - side * up * 0.4) / length
            back_y = tip_y - (up * 1.2 + side * right * 0.4) / length
            drawing.add_segments("MARK", (tip_x, tip_y, back_x, back_y))
        reach = _ARROW + 1.6 / length
        while any(hypot(x + reach * right - a, y + reach * up - b) < 2.1 for a, b in labels):
            reach += 1.0 / length
        labels.append((x + reach * right, y + reach * up))
        drawing.texts.append(Text("MARK", name, *labels[-1], 1.6, "middle"))


def join_pages(pages: Sequence[Page], *, true_size: bool) -> Drawing:
    """All pages in one drawing, one below the other.

    Parameters
    ----------
    pages : sequence of Page
    true_size : bool
        Whether what is shown has its true size, and pages are as large as that makes them; or
        pages have the size of paper.

    Returns
    -------
    Drawing
        From x = 0 to the right and from y = 0 downwards; in true size it begins at frames.
    """
    joined, top, rims = Drawing(), 0.0, list[tuple[float, float, float, float]]()
    for page in pages:
        factor, rim = (page.scale, MARGIN * page.scale) if true_size else (1.0, 0.0)
        width, height = (factor * size for size in page.drawing.high)
        _add_scaled(joined, page.drawing, factor, top - height)
        rims.append((rim, top - height + rim, width - rim, top - rim))
        top -= (1 + _GAP) * height
    left, bottom, right, up = zip(*rims, strict=True)
    joined.low, joined.high = (min(left), min(bottom)), (max(right), max(up))
    return joined


def _add_scaled(target: Drawing, source: Drawing, factor: float, rise: float) -> None:
    target.lines += [
        line._replace(points=[(factor * x, factor * y + rise, b) for x, y, b in line.points])
        for line in source.lines
    ]
    target.circles += [
        c._replace(x=factor * c.x, y=factor * c.y + rise, radius=factor * c.radius)
        for c in source.circles
    ]
    target.texts += [
        t._replace(x=factor * t.x, y=factor * t.y + rise, height=factor * t.height)
        for t in source.texts
    ]
