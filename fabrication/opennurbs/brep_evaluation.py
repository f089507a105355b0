"""Evaluates the trims, edges and surfaces of Breps, many streams of one layout at a time."""

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray, dot, norm
from .brep_layout import Curve, Surface
from .stream_codes import LINE_CURVE, PLANE_SURFACE

_SAMPLES = 9
"""Points per Bézier span of a trim and per edge, the ends included."""


def stream_numbers(streams: NDArray[np.uint8], place: int, count: int) -> FloatArray:
    """Float64 numbers (n, count) that begin at a place of streams (n, bytes) of one layout."""
    raw = np.ascontiguousarray(streams[:, place : place + 8 * count])
    return raw.view("<f8").astype(np.float64)


def trim_points(streams: NDArray[np.uint8], curve: Curve) -> FloatArray:
    """Points (n, q, 2) of a trim in (u, v), ends included, in streams (n, bytes)."""
    if curve.uuid == LINE_CURVE:
        return _between(stream_numbers(streams, curve.points, 6).reshape(-1, 2, 3)[..., :2])
    points = stream_numbers(streams, curve.points, 3 * curve.n_points).reshape(
        -1, curve.n_points, 3
    )
    basis = _bernstein(np.linspace(0, 1, _SAMPLES))
    spans = [basis @ points[:, i : i + 3] for i in range(0, curve.n_points - 2, 2)]
    joined = np.concatenate([spans[0], *(span[:, 1:] for span in spans[1:])], 1)
    return joined[..., :2] / joined[..., 2:]


def _between(ends: FloatArray) -> FloatArray:
    """Points of segments (n, 2, d), (n, q, d)."""
    share = np.linspace(0, 1, _SAMPLES)[:, None]
    return ends[:, :1] * (1 - share) + ends[:, 1:] * share


def _bernstein(t: FloatArray) -> FloatArray:
    return np.stack([(1 - t) ** 2, 2 * t * (1 - t), t**2], -1)


def surface_points(streams: NDArray[np.uint8], surface: Surface, uv: FloatArray) -> FloatArray:
    """Points (n, q, 3) of a surface at uv (n, q, 2); NaN outside its domain."""
    if surface.uuid == PLANE_SURFACE:
        plane = stream_numbers(streams, surface.points, 12)
        domain = stream_numbers(streams, surface.knots[0], 4).reshape(-1, 2, 2)
        points = plane[:, None, :3] + uv @ plane[:, 3:9].reshape(-1, 2, 3)
        beyond = np.maximum(domain[:, None, :, 0] - uv, uv - domain[:, None, :, 1]).max(2)
        return np.where(beyond[..., None] > 0, np.nan, points)
    n_u, n_v = surface.n_points
    net = stream_numbers(streams, surface.points, 4 * n_u * n_v).reshape(-1, n_u, n_v, 4)
    along_u, along_v = (
        _spline_basis(stream_numbers(streams, place, count + 1), uv[..., axis])
        for axis, (place, count) in enumerate(zip(surface.knots, surface.n_points, strict=True))
    )
    points = np.einsum("nqi,nqj,nijd->nqd", along_u, along_v, net, optimize=True)
    return points[..., :3] / points[..., 3:]


def _spline_basis(knots: FloatArray, t: FloatArray) -> FloatArray:
    """Quadratic basis functions over double knots (n, m + 1) at t (n, q): (n, q, m)."""
    breaks = knots[:, ::2]
    result = np.zeros((*t.shape, knots.shape[1] - 1))
    is_open = (t >= breaks[:, :1]) & (t <= breaks[:, -1:])
    result[~is_open] = np.nan
    for span in range(breaks.shape[1] - 1):
        low, high = breaks[:, span, None], breaks[:, span + 1, None]
        here = is_open & (t <= high)
        is_open = is_open & ~here
        result[here, 2 * span : 2 * span + 3] = _bernstein((t - low) / (high - low))[here]
    return result


def edge_points(streams: NDArray[np.uint8], curve: Curve) -> FloatArray:
    """Points (n, q, 3) of an edge, ends included, in streams (n, bytes)."""
    if curve.uuid == LINE_CURVE:
        return _between(stream_numbers(streams, curve.points, 6).reshape(-1, 2, 3))
    circle = stream_numbers(streams, curve.points, 28)
    return _circle_points(circle, _between(circle[:, 26:28, None])[..., 0])


def _circle_points(circle: FloatArray, angles: FloatArray) -> FloatArray:
    """Points of circles at angles (n, q), as `ON_ArcCurve` evaluates them."""
    center, x_axis, y_axis = (circle[:, None, i : i + 3] for i in (0, 3, 6))
    radius = circle[:, 16, None, None]
    angles = angles[..., None]
    return center + radius * (np.cos(angles) * x_axis + np.sin(angles) * y_axis)


def distances_to_edge(
    streams: NDArray[np.uint8], curve: Curve, points: FloatArray
) -> FloatArray:
    """Distances (n, q) of points (n, q, 3) from an edge, in streams (n, bytes)."""
    if curve.uuid == LINE_CURVE:
        start, end = (
            stream_numbers(streams, curve.points, 6).reshape(-1, 2, 1, 3).transpose(1, 0, 2, 3)
        )
        chord = end - start
        share = np.clip(dot(points - start, chord) / dot(chord, chord), 0, 1)
        return norm(points - start - share[..., None] * chord)
    circle = stream_numbers(streams, curve.points, 28)
    relative = points - circle[:, None, :3]
    x, y = (dot(relative, circle[:, None, i : i + 3]) for i in (3, 6))
    first, last = circle[:, 26, None], circle[:, 27, None]
    middle, half = (first + last) / 2, (last - first) / 2
    turn = (np.arctan2(y, x) - middle + np.pi) % (2 * np.pi) - np.pi
    nearest = _circle_points(circle, middle + np.clip(turn, -half, half))
    return norm(points - nearest)
