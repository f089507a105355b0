"""Legends beside pictures."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .colors import Legend
from .shapes import INK

LEADING = 1.6
"""Distance of the lines of a legend, in sizes of its type."""


def font_size(legend: Legend, height: int) -> int:
    """Size of type, in pixels, at which the kinds fit in the height."""
    lines = max(len(legend.kinds), len(legend.scale)) + 1
    return int(np.clip(0.9 * height / lines / LEADING, 9, max(9, height / 45)))


def legend_width(legend: Legend, width: int, height: int) -> int:
    """Pixels that a legend takes at the right of a picture."""
    size = font_size(legend, height)
    return min(int(_columns(legend, size)[-1] + 4 * size), width // 2)


def _columns(legend: Legend, size: int) -> list[float]:
    """Right ends of the columns of words, from the left end of the swatches."""
    font = ImageFont.load_default(size)
    rows = [legend.titles, *(words for _, words in legend.kinds)]
    rows += [(text,) for _, text in legend.scale]
    ends: list[float] = []
    place = 2.0 * size
    for column in range(len(legend.titles)):
        place += max(font.getlength(row[column]) for row in rows)
        ends.append(place)
        place += size
    return ends


def draw_legend(image: Image.Image, legend: Legend) -> None:
    """Swatches and words at the right, in the middle of the height."""
    size = font_size(legend, image.height)
    step = LEADING * size
    lines = legend.scale[::-1] or legend.kinds
    shown = min(len(lines), int(0.9 * image.height / step) - 1)
    font, draw = ImageFont.load_default(size), ImageDraw.Draw(image)
    ends = _columns(legend, size)
    left, top = image.width - ends[-1] - 2 * size, (image.height - step * (shown + 1)) / 2

    def write(line: int, words: tuple[str, ...]) -> None:
        """Words of a line, the end of each at that of its column."""
        for end, word in zip(ends, words, strict=True):
            draw.text((left + end, top + line * step), word, fill=INK, font=font, anchor="ra")

    write(0, legend.titles)
    for line, (color, words) in enumerate(lines[:shown], start=1):
        y = top + line * step
        # The steps of a scale touch, kinds stand apart.
        bottom = y + (step if legend.scale else size)
        draw.rectangle((left, y, left + 1.4 * size, bottom), fill=color)
        write(line, (words,) if isinstance(words, str) else tuple(words))
    if shown < len(lines):
        write(shown + 1, (*[""] * (len(ends) - 1), f"and {len(lines) - shown} more"))
