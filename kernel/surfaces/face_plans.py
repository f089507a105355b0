"""How a face of a polysurface can be divided: as a grid, a fan, a disc, or into triangles."""

from typing import Literal, NamedTuple

import numpy as np

from ..arrays import FloatArray, dot, norm, unit
from ..tolerances import POLE, SURFACE_CORNER
from .nurbs import evaluate_nurbs
from .planar_grids import disc_on_boundary, fan_on_sides, grid_on_sides
from .poles import surface_size
from .trimmed_faces import TrimmedFace

_SHARES = np.linspace(0, 1, 33)
_TRIAL = 16
_UNEVEN = 2.5
"""A fan has as many edges on each side: sides that differ more would show it."""
_MOST_CORNERS = 8


class FacePlan(NamedTuple):
    """How a face is divided.

    Attributes
    ----------
    kind : {"grid", "fan", "disc", "triangles"}
        See `planar_grids`; what fits none is divided into triangles.
    sides : list of list of int
        Trims of the outer loop that make each side, counter-clockwise.
    extents : (float, float)
        Of a grid, its lengths along the first and the second side, in model units.
    is_first_u : bool
        Of a grid, whether the first side runs along u.
    """

    kind: Literal["grid", "fan", "disc", "triangles"]
    sides: list[list[int]]
    extents: tuple[float, float] = (0.0, 0.0)
    is_first_u: bool = True


class RimSamples(NamedTuple):
    """Points along all trims of a face, 33 each: (t, 33, 2) in (u, v), (t, 33, 3) in space."""

    uv: FloatArray
    points: FloatArray


def sample_rim(face: TrimmedFace) -> RimSamples:
    """Points along the trims of all loops of a face, in their order.

    Returns
    -------
    RimSamples
        At equal steps of the parameters of the trims.
    """
    trims = [trim for loop in face.loops for trim in loop]
    uv = np.concatenate([trim.curve(_SHARES) for trim in trims])
    uv = np.clip(uv, *face.surface.domain.T)
    points = evaluate_nurbs(face.surface, *uv.T).points
    return RimSamples(
        uv.reshape(len(trims), len(_SHARES), 2), points.reshape(len(trims), len(_SHARES), 3)
    )


def plan_face(face: TrimmedFace, rim: RimSamples, *, is_even: bool) -> FacePlan:
    """The best way to divide a face.

    Parameters
    ----------
    rim : RimSamples
        Of this face.
    is_even : bool
        Whether edges of one length are wanted; numbers of rows otherwise.

    Returns
    -------
    FacePlan
        One that covers the face without folds.
    """
    outer = face.loops[0]
    each = [[i] for i in range(len(outer))]
    if len(face.loops) == 1:
        lines = _lines(face, rim)
        corners = _corners(lines)
        merged = _groups(corners, len(outer))
        for sides in (each, merged):
            plan = _plan_grid(face, sides, lines) if len(sides) == 4 else None
            if plan is not None:
                return plan
        has_pole = any(trim.edge < 0 for trim in outer)
        if len(corners) <= 2 and not has_pole:
            around = _resampled([[i for side in merged for i in side]], lines, 4 * _TRIAL)[0]
            if disc_on_boundary(around[:-1]) is not None:
                return FacePlan("disc", merged)
        elif 2 < len(outer) <= _MOST_CORNERS and not has_pole:
            lengths = [line.length for line in lines]
            is_balanced = max(lengths) <= _UNEVEN * min(lengths)
            sides_uv = _resampled(each, lines, _TRIAL)
            if (is_balanced or not is_even) and fan_on_sides(sides_uv) is not None:
                return FacePlan("fan", each)
    return FacePlan("triangles", each)


class _Line(NamedTuple):
    """A trim, sampled: points in (u, v) and in space, lengths up to each, at a pole shares."""

    uv: FloatArray
    points: FloatArray
    lengths: FloatArray
    length: float


def _lines(face: TrimmedFace, rim: RimSamples) -> list[_Line]:
    least = POLE * surface_size(face.surface)
    lines: list[_Line] = []
    for trim, uv, points in zip(face.loops[0], *rim, strict=False):
        lengths = np.concatenate([[0.0], np.cumsum(norm(np.diff(points, axis=0)))])
        if trim.edge < 0 or lengths[-1] <= least:
            lines.append(_Line(uv, points, _SHARES, 0.0))
        else:
            lines.append(_Line(uv, points, lengths, float(lengths[-1])))
    return lines


def _corners(lines: list[_Line]) -> list[int]:
    """Trims that begin at a corner."""
    found: list[int] = []
    for i, line in enumerate(lines):
        before = lines[i - 1]
        if not (line.length and before.length):
            found.append(i)
            continue
        arriving = unit(before.points[-1] - before.points[-2])
        leaving = unit(line.points[1] - line.points[0])
        # The chords of samples turn by one step each even where the curve is smooth.
        bend = _turn(before.points[-3:]) / 2 + _turn(line.points[:3]) / 2
        if np.arccos(np.clip(dot(arriving, leaving), -1, 1)) > SURFACE_CORNER + bend:
            found.append(i)
    return found


def _turn(points: FloatArray) -> float:
    first, second = unit(np.diff(points, axis=0))
    return float(np.arccos(np.clip(dot(first, second), -1, 1)))


def _groups(corners: list[int], count: int) -> list[list[int]]:
    """Trims from corner to corner; all of them without corners."""
    starts = corners or [0]
    stops = [*starts[1:], starts[0] + count]
    return [[i % count for i in range(a, b)] for a, b in zip(starts, stops, strict=True)]


def _resampled(sides: list[list[int]], lines: list[_Line], count: int) -> list[FloatArray]:
    """Points in (u, v) of sides, at equal distances in space."""
    found: list[FloatArray] = []
    for side in sides:
        parts = [lines[i] for i in side]
        starts = np.cumsum([0.0, *(part.lengths[-1] for part in parts)])
        lengths = np.concatenate([p.lengths + s for p, s in zip(parts, starts, strict=False)])
        uv = np.concatenate([part.uv for part in parts])
        targets = np.linspace(0, float(lengths[-1]), count + 1)
        places = np.empty((count + 1, 2))
        for axis in (0, 1):
            places[:, axis] = np.interp(targets, lengths, uv[:, axis])
        found.append(places)
    return found


def _plan_grid(
    face: TrimmedFace, sides: list[list[int]], lines: list[_Line]
) -> FacePlan | None:
    uv = _resampled(sides, lines, _TRIAL)
    if grid_on_sides(uv) is None:
        return None
    lengths = [sum(lines[i].length for i in side) for side in sides]
    middles = _middle_lengths(face, uv)
    extents = [
        max(middle, (lengths[d] + middle + lengths[d + 2]) / 3)
        for d, middle in enumerate(middles)
    ]
    along = np.abs(uv[0][-1] - uv[0][0]) + np.abs(uv[2][-1] - uv[2][0])
    share = along / np.diff(face.surface.domain)[:, 0]
    return FacePlan("grid", sides, (extents[0], extents[1]), bool(share[0] >= share[1]))


def _middle_lengths(face: TrimmedFace, uv: list[FloatArray]) -> tuple[float, float]:
    """Lengths of the lines in the middle of a grid, along its first and its second side."""
    bottom, right, top, left = uv[0], uv[1], uv[2][::-1], uv[3][::-1]
    half, t = _TRIAL // 2, np.linspace(0, 1, _TRIAL + 1)[:, None]
    found: list[float] = []
    for first, last, start, end in (
        (bottom, top, left[half], right[half]),
        (left, right, bottom[half], top[half]),
    ):
        mean = (first + last) / 2
        line = mean + (1 - t) * (start - mean[0]) + t * (end - mean[-1])
        line = np.clip(line, *face.surface.domain.T)
        points = evaluate_nurbs(face.surface, *line.T).points
        found.append(float(norm(np.diff(points, axis=0)).sum()))
    return found[0], found[1]
