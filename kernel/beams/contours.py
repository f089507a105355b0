"""Flat contours of beams, for cutting: two arcs and two lines in a plane.

A contour is the section of a beam in the middle of its thickness, in coordinates of its own
plane: x along the edge, y to the outer side. Mitred ends are bevelled after cutting.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, dot, norm
from ..spheres.arcs import arc_points
from .beams import Beams, section_arcs

CORNERS = 4
"""Corners of a contour: inner start, inner end, outer end, outer start."""


@dataclass(frozen=True)
class Contours:
    """Closed contours, counter-clockwise.

    Attributes
    ----------
    corners : (B, 4, 2) float array
        Inner start, inner end, outer end, outer start, in model units.
    bulges : (B, 4) float array
        Tangent of a quarter of the sweep of the side that begins at each corner; positive
        where the side is an arc that runs counter-clockwise, 0 for lines.
    centers : (B, 3, 2) float array
        Points on the middle line: near the start, in the middle, near the end.
    widths : (B,) float array
        Distance of the two arcs in the middle.
    bevels : (B, 2, 2) float array
        Angles of the cuts at both ends, on the lower and the upper side, in radians; a right
        angle is a square cut.
    """

    corners: FloatArray
    bulges: FloatArray
    centers: FloatArray
    widths: FloatArray
    bevels: FloatArray


def beam_contours(beams: Beams) -> Contours:
    """Contours of beams."""
    outer, inner = section_arcs(beams)
    axes = beams.annuli.frames[:, :2]
    corners = np.stack([inner.starts, inner.ends, outer.ends, outer.starts], 1)
    bulges = np.zeros((beams.n_beams, CORNERS))
    for side, arcs, turn in ((0, inner, -1), (2, outer, 1)):
        bulges[:, side] = turn * arcs.sagittas / (norm(arcs.ends - arcs.starts) / 2)
    near = np.array([-0.6, 0.0, 0.6])
    top, bottom = arc_points(outer, near), arc_points(inner, near)
    change = beams.insets[..., ::2] - beams.insets[..., 1:2]
    rise = np.abs(beams.levels[..., ::2] - beams.levels[..., 1:2])
    return Contours(
        _in_plane(corners, axes), bulges, _in_plane((top + bottom) / 2, axes),
        norm(top[:, 1] - bottom[:, 1]), np.arctan2(rise, change),
    )  # fmt: skip


def _in_plane(points: FloatArray, axes: FloatArray) -> FloatArray:
    return np.stack([dot(points, axes[:, None, i]) for i in (0, 1)], -1)


def contour_boxes(contours: Contours) -> FloatArray:
    """Rectangles about the sides, no more than half circles: least and largest, (B, 2, 2)."""
    starts = contours.corners
    ends = np.roll(starts, -1, axis=1)
    # A positive bulge lies to the right of its side.
    right = np.stack([(ends - starts)[..., 1], -(ends - starts)[..., 0]], -1)
    shift = contours.bulges[..., None] * right / 2
    points = np.concatenate([starts, starts + shift, ends + shift], 1)
    return np.stack([points.min(axis=1), points.max(axis=1)], 1)


def shelves(
    sizes: FloatArray, sheet: tuple[float, float], spacing: float
) -> tuple[FloatArray, list[int], list[int]]:
    """Lay rectangles on sheets, in rows.

    Parameters
    ----------
    sizes : (n, 2) float array
        Widths and heights.
    sheet : (float, float)
        Width and height of a sheet.
    spacing : float
        Distance between rectangles, and from the rim.

    Returns
    -------
    places : (n, 2) float array
        Lower left corners, on their sheets.
    sheets : list of int
        Sheet of each.
    oversize : list of int
        Rectangles that are larger than a sheet: each has a sheet of its own, the last ones.

    Notes
    -----
    Highest first, from left to right, a new row where the width is used up, a new sheet where
    the height is.
    """
    places = np.full((len(sizes), 2), spacing)
    sheets = [0] * len(sizes)
    fits = np.asarray((sizes + 2 * spacing <= np.array(sheet)).all(axis=1))
    x, y, row, count = spacing, spacing, 0.0, 0
    for i in np.lexsort((-sizes[:, 0], -sizes[:, 1])).tolist():
        if not fits[i]:
            continue
        width, height = sizes[i].tolist()
        if x + width + spacing > sheet[0]:
            x, y, row = spacing, y + row + spacing, 0.0
        if y + height + spacing > sheet[1]:
            x, y, row, count = spacing, spacing, 0.0, count + 1
        places[i], sheets[i] = (x, y), count
        x, row = x + width + spacing, max(row, height)
    oversize = np.flatnonzero(~fits).tolist()
    first = count + 1 if fits.any() else 0
    for i, each in enumerate(oversize):
        sheets[each] = first + i
    return places, sheets, oversize
