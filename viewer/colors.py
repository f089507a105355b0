"""What the colours of panels mean, and the words for a legend that says so."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..kernel.arrays import FloatArray
from ..kernel.errors import InputError
from ..kernel.panels.facts import (
    corner_angles,
    corner_misses,
    edge_angles,
    panel_radii,
    wall_tilts,
)
from ..kernel.panels.panels import Panels, panel_areas
from ..kernel.parts.colors import UNLABELLED, Color, mould_color
from ..kernel.parts.findings import Finding

ColorBy = Literal[
    "mould", "radius", "angle", "area", "planarity", "tilt", "convexity", "finding", "none"
]

WHITE: Color = (226, 226, 222)
OUTWARDS, INWARDS = (214, 118, 92), (92, 138, 190)
ERROR, NOTE, GOOD = (206, 58, 44), (232, 164, 38), (214, 219, 222)
CONVEX, REENTRANT = (126, 174, 142), (196, 112, 134)

SHADES = 256


@dataclass(frozen=True)
class Legend:
    """What colours mean: kinds with a line each, or a scale.

    Attributes
    ----------
    titles : tuple of str
        Headings of the columns; of a scale its name alone.
    kinds : sequence of (Color, sequence of str)
        A colour and a word for each column.
    scale : sequence of (Color, str)
        Colours from low to high, and what is written beside each; often nothing.
    """

    titles: tuple[str, ...]
    kinds: Sequence[tuple[Color, Sequence[str]]] = ()
    scale: Sequence[tuple[Color, str]] = ()


def panel_colors(
    panels: Panels, color_by: ColorBy, findings: Sequence[Finding] = ()
) -> tuple[FloatArray, Legend | None]:
    """Colours of panels (P, 3), sRGB from 0 to 255, and what they mean.

    No legend where they mean nothing: there is one colour, or no panel has a mould.
    """
    if not panels.n_panels:
        raise InputError("there are no panels to draw")
    if color_by == "none":
        return np.tile(np.array(WHITE, float), (panels.n_panels, 1)), None
    if color_by == "mould":
        return _moulds(panels)
    if color_by == "radius":
        return _curvatures(panels)
    if color_by == "finding":
        return _findings(panels, findings)
    if color_by == "convexity":
        return _convexity(panels)
    return _measures(panels, color_by)


def _moulds(panels: Panels) -> tuple[FloatArray, Legend | None]:
    labels, first, counts = np.unique(panels.labels, return_index=True, return_counts=True)
    count = int(labels.max(initial=-1)) + 1
    palette = np.array([mould_color(label, count) for label in range(-1, count)], float)
    colors = palette[panels.labels + 1]
    if not count:
        return colors, None
    radii: list[float] = panel_radii(panels).radii[first].tolist()
    kinds = [
        (
            mould_color(label, count),
            ("-" if label < 0 else str(label + 1), _radius(radius), str(number)),
        )
        for label, radius, number in zip(labels.tolist(), radii, counts.tolist(), strict=True)
    ]
    return colors, Legend(("mould", "radius", "panels"), kinds)


def _radius(radius: float) -> str:
    return f"{radius:#.4g}" if np.isfinite(radius) else "plane"


def _curvatures(panels: Panels) -> tuple[FloatArray, Legend | None]:
    """Red where a panel curves outwards, blue where inwards, pale where flat."""
    curvature = -panels.spheres[:, 0]
    limit = float(np.quantile(np.abs(curvature), 0.95))
    if not limit > 0:
        return np.tile(np.array(WHITE, float), (panels.n_panels, 1)), None
    shares = np.linspace(-1, 1, 9)
    bar = _diverging(shares).astype(int).tolist()
    texts = [f"in {_radius(0.5 / limit)}", *[""] * 3, "plane", *[""] * 3]
    texts.append(f"out {_radius(0.5 / limit)}")
    scale = [(tuple(color), text) for color, text in zip(bar, texts, strict=True)]
    return _diverging(curvature / limit), Legend(("radius",), scale=scale)


def _diverging(shares: FloatArray) -> FloatArray:
    """From blue (-1) over white to red (1): steps of light, as sRGB."""
    share = np.clip(shares, -1, 1)[:, None]
    ends = np.where(share > 0, np.array(OUTWARDS) / 255, np.array(INWARDS) / 255) ** 2.2
    white = (np.array(WHITE) / 255) ** 2.2
    result: FloatArray = 255 * (white + np.abs(share) * (ends - white)) ** (1 / 2.2)
    return result


def _findings(panels: Panels, findings: Sequence[Finding]) -> tuple[FloatArray, Legend | None]:
    worst = {f.id: GOOD for f in findings}
    worst |= {f.id: NOTE for f in findings if f.severity == "note"}
    worst |= {f.id: ERROR for f in findings if f.severity == "error"}
    colors = [worst.get(name, GOOD) for name in panels.ids]
    kinds = [
        (color, (name, str(colors.count(color))))
        for color, name in ((ERROR, "errors"), (NOTE, "notes"), (GOOD, "nothing found"))
    ]
    return np.array(colors, float), Legend(("audit", "panels"), kinds)


def _convexity(panels: Panels) -> tuple[FloatArray, Legend | None]:
    is_over = corner_angles(panels) > np.pi * (1 + 1e-9)
    reentrant = np.add.reduceat(is_over, panels.offsets[:-1]) > 0
    colors = np.where(reentrant[:, None], np.array(REENTRANT), np.array(CONVEX))
    count = int(reentrant.sum())
    kinds = [
        (CONVEX, ("convex", str(panels.n_panels - count))),
        (REENTRANT, ("with reentrant corners", str(count))),
    ]
    return colors.astype(float), Legend(("corners", "panels"), kinds)


def _measures(panels: Panels, color_by: ColorBy) -> tuple[FloatArray, Legend | None]:
    """Along the path of colours of moulds, but for one panel in a hundred at both ends."""
    values, name, unit = _measured(panels, color_by)
    known = np.isfinite(values)
    if not known.any():
        return np.tile(np.array(UNLABELLED, float), (panels.n_panels, 1)), None
    low, high = np.quantile(values[known], [0.01, 0.99]).tolist()
    spread = high - low if high - low > 1e-9 * max(abs(high), 1e-300) else np.inf
    shares = np.clip((np.where(known, values, low) - low) / spread, 0, 1)
    palette = np.array([mould_color(shade, SHADES) for shade in range(SHADES)], float)
    colors = np.where(
        known[:, None], palette[np.rint(shares * (SHADES - 1)).astype(int)], UNLABELLED
    )
    places = np.linspace(0, 1, 9)
    scale = [
        (
            mould_color(round(place * (SHADES - 1)), SHADES),
            f"{low + place * (high - low):.3g}{unit}" if step % 4 == 0 else "",
        )
        for step, place in enumerate(places.tolist())
    ]
    return colors, Legend((name,), scale=scale)


def _measured(panels: Panels, color_by: ColorBy) -> tuple[FloatArray, str, str]:
    first = panels.offsets[:-1]
    if color_by == "angle":
        return np.degrees(np.fmax.reduceat(edge_angles(panels), first)), "angle at edges", "°"
    if color_by == "tilt":
        return np.degrees(np.fmax.reduceat(wall_tilts(panels), first)), "tilt of walls", "°"
    if color_by == "area":
        return panel_areas(panels), "area", ""
    return corner_misses(panels), "corners off their plane", ""
