"""The shape of a NURBS surface also where its parameters fail: at poles and apexes."""

from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm, unit
from ..tolerances import EPSILON, POLE, SMOOTH_JOINT
from .nurbs import (
    NurbsSurface,
    SurfaceCurvature,
    evaluate_nurbs,
    nurbs_curvatures,
    principal_values,
)

_MERIDIANS = 16
_INWARDS = 1e-3


class Pole(NamedTuple):
    """A side of the domain that is one point: its parameter (0 for u, 1 for v), and its end."""

    axis: int
    end: int


def surface_size(surface: NurbsSurface) -> float:
    """Longest side of the box around the control points.

    Returns
    -------
    float
        In model units.
    """
    places = surface.points[..., :3] / surface.points[..., 3:]
    return float(np.ptp(places, axis=(0, 1)).max())


def find_poles(surface: NurbsSurface) -> list[Pole]:
    """Sides of the domain that are a single point of space.

    Returns
    -------
    list of Pole
        At most four.
    """
    places = np.abs(surface.points[..., :3] / surface.points[..., 3:]).max()
    # Far from the origin a pole is only as round as the digits of its place.
    least = POLE * surface_size(surface) + 16 * EPSILON * places
    found: list[Pole] = []
    for axis in (0, 1):
        low, high = surface.domain[1 - axis]
        for end in (0, 1):
            uv = np.tile(surface.domain.mean(1), (_MERIDIANS + 1, 1))
            uv[:, axis] = surface.domain[axis, end]
            uv[:, 1 - axis] = np.linspace(low, high, _MERIDIANS + 1)
            points = evaluate_nurbs(surface, *uv.T).points
            if norm(points - points[0]).max() <= least:
                found.append(Pole(axis, end))
    return found


def shape_at(surface: NurbsSurface, uv: FloatArray) -> tuple[SurfaceCurvature, BoolArray]:
    """Normals and curvatures, finite everywhere.

    Parameters
    ----------
    uv : (N, 2) float array
        Parameters in the domain.

    Returns
    -------
    shape : SurfaceCurvature
        As `nurbs_curvatures` gives it; at a pole the limit, which is exact.
    is_smooth : (N,) bool array
        Whether the surface has a tangent plane there that its parameters show.

    Notes
    -----
    All meridians of a pole start in its tangent plane, so that each has a known normal
    curvature; the second fundamental form is what fits them. At other singular points, such
    as the corners of a disc that is the image of a square, the shape is taken a thousandth of
    the domain farther inside.
    """
    uv = np.clip(uv, *surface.domain.T)
    shape = nurbs_curvatures(surface, *uv.T)
    jet = evaluate_nurbs(surface, *uv.T)
    area, sides = norm(np.cross(jet.u, jet.v)), norm(jet.u) * norm(jet.v)
    is_regular = np.isfinite(shape.first) & (area > POLE * sides)
    is_smooth = is_regular.copy()
    result = SurfaceCurvature(*(each.copy() for each in shape))
    for pole in find_poles(surface):
        is_here = uv[:, pole.axis] == surface.domain[pole.axis, pole.end]
        if is_here.any():
            limit, smooth = _limit(surface, pole)
            _put(result, is_here, limit)
            is_smooth[is_here] = smooth
            is_regular[is_here] = bool(np.isfinite(limit.first[0]))
    rest = ~is_regular
    if rest.any():
        inside = uv[rest] + _INWARDS * (surface.domain.mean(1) - uv[rest])
        _put(result, rest, nurbs_curvatures(surface, *inside.T))
    return _finite(result), is_smooth


def _put(result: SurfaceCurvature, where: BoolArray, values: SurfaceCurvature) -> None:
    for array, value in zip(result, values, strict=True):
        array[where] = value


def _finite(shape: SurfaceCurvature) -> SurfaceCurvature:
    """What is still unknown, on surfaces that are a line or a point, is flat."""
    return SurfaceCurvature(*map(np.nan_to_num, shape))


def _limit(surface: NurbsSurface, pole: Pole) -> tuple[SurfaceCurvature, bool]:
    low, high = surface.domain[1 - pole.axis]
    uv = np.empty((_MERIDIANS, 2))
    uv[:, pole.axis] = surface.domain[pole.axis, pole.end]
    # Midpoints: the ends of a closed surface would count twice.
    uv[:, 1 - pole.axis] = low + (np.arange(_MERIDIANS) + 0.5) / _MERIDIANS * (high - low)
    jet = evaluate_nurbs(surface, *uv.T)
    along, bend = (jet.u, jet.uu) if pole.axis == 0 else (jet.v, jet.vv)
    # Near the pole the other derivative is the mixed one times the way into the domain.
    sign = (1 - 2 * pole.end) * (1 if pole.axis == 0 else -1)
    normals = sign * unit(np.cross(along, jet.uv))
    normal = unit(normals.mean(0))
    steepest = dot(along, along)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = dot(bend, normal) / steepest
        # The normal of a tangent plane that all meridians share.
        leaning = np.abs(dot(unit(along), normal)).max()
    frame = unit(along[0] - dot(along[0], normal) * normal)
    c, s = dot(along, frame), dot(along, np.cross(normal, frame))
    terms = np.stack([c * c, 2 * c * s, s * s], 1) / np.where(steepest, steepest, 1)[:, None]
    if not np.isfinite(values).all() or not norm(normal):
        nothing = np.full((1, 3), np.nan)
        return principal_values(nothing, nothing, nothing), False
    form = np.asarray(np.linalg.lstsq(terms, values, rcond=None)[0], np.float64)
    miss = np.abs(terms @ form - values).max()
    is_smooth = bool(
        leaning <= SMOOTH_JOINT
        and (dot(normals, normal) > 1 - SMOOTH_JOINT).all()
        and miss <= SMOOTH_JOINT * np.abs(values).max(initial=0)
    ) or bool(leaning <= SMOOTH_JOINT and not values.any())
    return principal_values(normal[None], frame[None], form[None]), is_smooth
