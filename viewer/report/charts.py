"""Histograms, as SVG: sharp on screen and on paper."""

from collections.abc import Sequence
from html import escape

import numpy as np

from ...kernel.arrays import FloatArray

WIDTH, HEIGHT, FOOT = 640, 190, 26
BINS = 40

Series = tuple[str, str, FloatArray]
"""A name, a colour and values."""


def histogram(series: Sequence[Series], unit: str, *, label: str) -> str:
    """Shares of values in equal steps, one series before the other; empty ones are left out.

    The scale ends where all but one value in two hundred have been counted; what is beyond
    stands in the last step.
    """
    known = [(name, color, values[np.isfinite(values)]) for name, color, values in series]
    known = [each for each in known if len(each[2])]
    if not known:
        return ""
    everything = np.concatenate([values for _, _, values in known])
    high = _round_up(float(np.quantile(everything, 0.995)))
    counts = [
        np.histogram(np.clip(values, 0, high), BINS, (0, high))[0] / len(values)
        for _, _, values in known
    ]
    most = max(float(shares.max()) for shares in counts)
    bars = [
        _bars(shares / most, color) for (_, color, _), shares in zip(known, counts, strict=True)
    ]
    ticks = [
        f'<text x="{WIDTH * k / 4:.0f}" y="{HEIGHT + 16}" '
        f'text-anchor="{("start", "middle", "middle", "middle", "end")[k]}">'
        f"{high * k / 4:.3g}{escape(unit)}</text>"
        for k in range(5)
    ]
    keys = "".join(
        f'<span><i style="background:{color}"></i>{escape(name)}</span>'
        for name, color, _ in known
    )
    return (
        f'<p class="keys">{keys}</p><svg viewBox="0 0 {WIDTH} {HEIGHT + FOOT}" role="img" '
        f'aria-label="{escape(label)}">{"".join(bars)}'
        f'<line x1="0" y1="{HEIGHT}" x2="{WIDTH}" y2="{HEIGHT}"/>{"".join(ticks)}</svg>'
    )


def _bars(shares: FloatArray, color: str) -> str:
    step = WIDTH / BINS
    return "".join(
        f'<rect x="{k * step + 0.5:.1f}" y="{HEIGHT * (1 - share):.1f}" '
        f'width="{step - 1:.1f}" height="{HEIGHT * share:.1f}" fill="{color}" opacity=".75"/>'
        for k, share in enumerate(shares.tolist())
        if share > 0
    )


def _round_up(value: float) -> float:
    """The next number of one or two simple digits."""
    if not value > 0:
        return 1.0
    power = 10 ** np.floor(np.log10(value))
    return float(power * next(k for k in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if k * power >= value))
