"""Outlines of panels as they are seen along an axis: circular arcs on paper.

An edge is a circle in space and an ellipse on paper. Few circles follow it as closely as
anybody cuts.
"""

from itertools import pairwise
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, dot, norm, unit
from ...kernel.panels.panels import Panels
from ...kernel.spheres.arcs import Arcs, arc_points

CLOSE_MM: Final = 0.01
"""How far arcs on paper may be from what they show, in true size."""

_PIECES: Final = (1, 2, 4, 8, 16, 32)
"""Arcs for an edge: more where the last number was not close enough."""


def axis_frames(panels: Panels, axes: FloatArray) -> FloatArray:
    """Directions (P, 2, 3) to the right and upwards of views against unit axes (P, 3).

    The chord of the first edge of each panel runs to the right.
    """
    first = panels.offsets[:-1]
    along = panels.corners[panels.next_corners[first]] - panels.corners[first]
    along = unit(along - dot(along, axes)[:, None] * axes)
    return np.stack([along, np.cross(axes, along)], 1)


def outline_rings(
    panels: Panels, arcs: Arcs, frames: FloatArray, centers: FloatArray
) -> list[FloatArray]:
    """Outline (n, 3) of each panel: x, y and bulge of the sides.

    Parameters
    ----------
    panels : Panels
    arcs : Arcs
        H edges of one of their faces, in millimetres.
    frames : (P, 2, 3) float array
        Directions to the right and upwards.
    centers : (P, 3) float array
        Local points that are at the origin of the paper.

    Returns
    -------
    list of (n, 3) float array
        An arc for every edge where that comes as near as `CLOSE_MM`, more of them elsewhere.
    """
    owners = panels.corner_panels
    result = [np.zeros((0, 3))] * panels.n_panels
    left = np.ones(panels.n_panels, bool)
    for count in _PIECES:
        edges = np.flatnonzero(left[owners])
        chosen = Arcs(*(values[edges] for values in vars(arcs).values()))
        points = _flat(chosen, frames[owners[edges]], centers[owners[edges]], count)
        bulges, misses = _bulges(points)
        bulges[chosen.sagittas == 0] = 0.0
        worst = np.zeros(panels.n_panels)
        np.maximum.at(worst, owners[edges], misses.max(axis=1))
        is_close = (worst <= CLOSE_MM) | (count == _PIECES[-1])
        sides = np.concatenate([points[:, :-1:4], bulges[..., None]], -1).reshape(-1, 3)
        rows = np.flatnonzero(left)
        bounds = [0, *np.cumsum(count * panels.degrees[rows]).tolist()]
        for row, (start, end) in zip(rows.tolist(), pairwise(bounds), strict=True):
            result[row] = sides[start:end]
        left &= ~is_close
        if not left.any():
            break
    return result


def _flat(arcs: Arcs, frames: FloatArray, centers: FloatArray, count: int) -> FloatArray:
    """Points (H, 4 count + 1, 2) of arcs on paper, four steps to a piece."""
    points = arc_points(arcs, np.linspace(-1, 1, 4 * count + 1))
    return np.einsum("hij,hnj->hni", frames, points - centers[:, None])


def _bulges(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bulges (H, n) of circles through every other of 4 n + 1 points, and misses of the others.

    Notes
    -----
    On a circle two chords that follow each other turn by half of the sweep over both.
    """
    start, middle, end = points[:, :-1:4], points[:, 2::4], points[:, 4::4]
    turn = _turns(start, middle, end)
    chord = norm(end - start)
    misses: list[FloatArray] = []
    for k in (1, 3):
        between = points[:, k::4]
        change = np.abs(_turns(start, between, end) - turn)
        area = change * norm(between - start) * norm(end - between)
        misses.append(np.divide(area, chord, out=np.zeros_like(area), where=chord > 0))
    return np.tan(turn / 2), np.maximum(*misses)


def _turns(start: FloatArray, middle: FloatArray, end: FloatArray) -> FloatArray:
    before, after = middle - start, end - middle
    sine = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    return np.arctan2(sine, dot(before, after))
