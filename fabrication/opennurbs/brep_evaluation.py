"""Evaluates trims, edges, surfaces and volumes of Breps, many of one layout at a time."""

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, dot, norm
from .brep_layout import BrepLayout, Curve, Face, Surface
from .stream_codes import CRC, LINE_CURVE, NURBS_CURVE, PLANE_SURFACE, Checksum

_SAMPLES = 9
"""Points per Bézier span of a trim and per edge, the ends included."""

_WRONG = "the checksum at byte {} is wrong"

_SIGNLESS, _LOW_EXPONENT = 0x7F, 0xF0
"""The two highest bytes of a float64 that is not finite: with their other bits cleared."""

_STEPS, _SETTLED = 5, 1e-8
"""The most towards the nearest point of a conic; what follows a shorter one is rounding."""


def stream_numbers(streams: NDArray[np.uint8], place: int, count: int) -> FloatArray:
    """Float64 numbers (n, count) that begin at a place of streams (n, bytes) of one layout."""
    raw = np.ascontiguousarray(streams[:, place : place + 8 * count])
    return raw.view("<f8").astype(np.float64)


def finite_streams(streams: NDArray[np.uint8], layout: BrepLayout) -> BoolArray:
    """Which streams (n,) of one layout hold finite numbers alone: by their exponents."""
    places = [np.arange(start, start + 8 * count, 8) for start, count in layout.numbers]
    last = np.concatenate(places) + 7
    is_suspect = (streams[:, last] & _SIGNLESS == _SIGNLESS) & (
        streams[:, last - 1] >= _LOW_EXPONENT
    )
    return ~is_suspect.any(axis=1)


def checksum_defects(streams: NDArray[np.uint8], layout: BrepLayout) -> list[str]:
    """Which checksum of each of n streams of one layout is wrong; empty for none.

    Checksums of bytes that are the same in all streams are computed for the first alone.
    """
    result = [""] * len(streams)
    varying: list[Checksum] = []
    first = memoryview(streams[0].tobytes())
    for checksum in layout.checksums:
        if not all(layout.fixed[start:stop].all() for start, stop in checksum.ranges):
            varying.append(checksum)
            continue
        stored = streams[:, checksum.place : checksum.place + CRC.size]
        computed = np.frombuffer(CRC.pack(checksum.compute(first)), np.uint8)
        for i in np.flatnonzero((stored != computed).any(axis=1)).tolist():
            result[i] = result[i] or _WRONG.format(checksum.place)
    for i, row in enumerate(streams):
        data = memoryview(row.tobytes())
        for checksum in varying:
            if CRC.unpack_from(data, checksum.place)[0] != checksum.compute(data):
                result[i] = result[i] or _WRONG.format(checksum.place)
                break
    return result


def trim_points(streams: NDArray[np.uint8], curve: Curve) -> FloatArray:
    """Points (n, q, 2) of a trim in (u, v), ends included, in streams (n, bytes)."""
    if curve.uuid == LINE_CURVE:
        return _between(stream_numbers(streams, curve.points, 6).reshape(-1, 2, 3)[..., :2])
    return _nurbs_points(streams, curve)


def _spans(streams: NDArray[np.uint8], curve: Curve) -> list[FloatArray]:
    """Homogeneous control points (n, order, dimension + 1) of each Bézier span."""
    size = curve.dimension + 1
    points = stream_numbers(streams, curve.points, size * curve.n_points)
    points = points.reshape(len(streams), curve.n_points, size)
    degree = curve.order - 1
    return [points[:, i : i + degree + 1] for i in range(0, curve.n_points - 1, degree)]


def _nurbs_points(streams: NDArray[np.uint8], curve: Curve) -> FloatArray:
    basis = _bernstein(np.linspace(0, 1, _SAMPLES), curve.order - 1)
    spans = [basis @ points for points in _spans(streams, curve)]
    joined = np.concatenate([spans[0], *(span[:, 1:] for span in spans[1:])], 1)
    return joined[..., :-1] / joined[..., -1:]


def trim_steps(
    streams: NDArray[np.uint8], curve: Curve, shares: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Points and derivatives (n, q, 2) of a trim at shares (q,) of each of its Bézier spans."""
    if curve.uuid == LINE_CURVE:
        ends = stream_numbers(streams, curve.points, 6).reshape(-1, 2, 3)[..., :2]
        step = ends[:, 1:] - ends[:, :1]
        return ends[:, :1] + shares[:, None] * step, np.repeat(step, len(shares), axis=1)
    degree = curve.order - 1
    basis, slopes = _bernstein(shares, degree), _bernstein_slopes(shares, degree)
    points: list[FloatArray] = []
    steps: list[FloatArray] = []
    for span in _spans(streams, curve):
        x, dx = basis @ span, slopes @ span
        flat = x[..., :2] / x[..., 2:]
        points.append(flat)
        steps.append((dx[..., :2] - flat * dx[..., 2:]) / x[..., 2:])
    return np.concatenate(points, axis=1), np.concatenate(steps, axis=1)


def _between(ends: FloatArray) -> FloatArray:
    """Points of segments (n, 2, d), (n, q, d)."""
    share = np.linspace(0, 1, _SAMPLES)[:, None]
    # A coordinate that stays the same must not leave the domain by rounding.
    return ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * share


def _bernstein(t: FloatArray, degree: int) -> FloatArray:
    # By the recursion of de Casteljau: powers would take twice as long.
    values = [np.ones_like(t)]
    for _ in range(degree):
        left, right = ([(1 - t) * x for x in values], [t * x for x in values])
        inner = [a + b for a, b in zip(left[1:], right[:-1], strict=True)]
        values = [left[0], *inner, right[-1]]
    return np.stack(values, -1)


def _bernstein_slopes(t: FloatArray, degree: int) -> FloatArray:
    lower = _bernstein(t, degree - 1)
    zero = np.zeros((*t.shape, 1))
    before, after = (np.concatenate(pair, -1) for pair in ((zero, lower), (lower, zero)))
    return degree * (before - after)


def surface_points(streams: NDArray[np.uint8], surface: Surface, uv: FloatArray) -> FloatArray:
    """Points (n, q, 3) of a surface at uv (n, q, 2); NaN outside its domain."""
    if surface.uuid == PLANE_SURFACE:
        plane = stream_numbers(streams, surface.points, 12)
        domain = stream_numbers(streams, surface.knots[0], 4).reshape(-1, 2, 2)
        points = plane[:, None, :3] + uv @ plane[:, 3:9].reshape(-1, 2, 3)
        beyond = np.maximum(domain[:, None, :, 0] - uv, uv - domain[:, None, :, 1]).max(2)
        return np.where(beyond[..., None] > 0, np.nan, points)
    net = surface_net(streams, surface)
    along_u, along_v = (
        spline_basis(surface_knots(streams, surface, axis), uv[..., axis], order - 1)[0]
        for axis, order in enumerate(surface.orders)
    )
    rows = np.matmul(along_u, net.reshape(*net.shape[:2], -1)).reshape(*uv.shape[:2], -1, 4)
    points = np.matmul(along_v[:, :, None], rows)[:, :, 0]
    return points[..., :3] / points[..., 3:]


def surface_net(streams: NDArray[np.uint8], surface: Surface) -> FloatArray:
    """Homogeneous control points (n, k, m, 4) of a rational surface."""
    n_u, n_v = surface.n_points
    return stream_numbers(streams, surface.points, 4 * n_u * n_v).reshape(-1, n_u, n_v, 4)


def surface_knots(streams: NDArray[np.uint8], surface: Surface, axis: int) -> FloatArray:
    """Knots of a rational surface in u or v, as openNURBS has them."""
    count = surface.n_points[axis] + surface.orders[axis] - 2
    return stream_numbers(streams, surface.knots[axis], count)


def spline_basis(
    knots: FloatArray, t: FloatArray, degree: int
) -> tuple[FloatArray, FloatArray]:
    """Basis functions and their slopes (n, q, m) at t (n, q), NaN outside of the domain.

    Knots (n, ...) stand as often as the degree.
    """
    breaks = knots[:, ::degree]
    n_spans = breaks.shape[1] - 1
    if n_spans == 1:
        low, size = breaks[:, :1], np.diff(breaks)
        share = (t - low) / size
        share = np.where((t >= low) & (t <= breaks[:, 1:]), share, np.nan)
        return _bernstein(share, degree), _bernstein_slopes(share, degree) / size[..., None]
    shape = (*t.shape, knots.shape[1] - degree + 1)
    values, slopes = np.zeros(shape), np.zeros(shape)
    is_open = (t >= breaks[:, :1]) & (t <= breaks[:, -1:])
    outside = ~is_open
    for span in range(n_spans):
        low, size = breaks[:, span, None], np.diff(breaks[:, span : span + 2])
        here = is_open & (t <= breaks[:, span + 1, None])
        is_open = is_open & ~here
        share = np.where(here, (t - low) / size, 0.0)
        place = slice(degree * span, degree * span + degree + 1)
        values[..., place] += here[..., None] * _bernstein(share, degree)
        slopes[..., place] += (
            here[..., None] * _bernstein_slopes(share, degree) / size[..., None]
        )
    values[outside] = slopes[outside] = np.nan
    return values, slopes


def edge_points(streams: NDArray[np.uint8], curve: Curve) -> FloatArray:
    """Points (n, q, 3) of an edge, ends included, in streams (n, bytes)."""
    if curve.uuid == LINE_CURVE:
        return _between(stream_numbers(streams, curve.points, 6).reshape(-1, 2, 3))
    if curve.uuid == NURBS_CURVE:
        return _nurbs_points(streams, curve)
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
    if curve.uuid == NURBS_CURVE:
        return np.min([_to_conic(span, points) for span in _spans(streams, curve)], axis=0)
    circle = stream_numbers(streams, curve.points, 28)
    relative = points - circle[:, None, :3]
    x, y = (dot(relative, circle[:, None, i : i + 3]) for i in (3, 6))
    first, last = circle[:, 26, None], circle[:, 27, None]
    middle, half = (first + last) / 2, (last - first) / 2
    turn = (np.arctan2(y, x) - middle + np.pi) % (2 * np.pi) - np.pi
    nearest = _circle_points(circle, middle + np.clip(turn, -half, half))
    return norm(points - nearest)


def _to_conic(span: FloatArray, points: FloatArray) -> FloatArray:
    """Distances (n, q) of points from rational quadratics (n, 3, 4), by Gauss and Newton.

    From where the points lie along the chord: wherever the search ends is on the curve, so a
    distance is never told too small.
    """
    origins, ends = (span[:, i, None, :3] / span[:, i, None, 3:] for i in (0, 2))
    points, chords = points - origins, ends - origins
    span = np.concatenate([span[..., :3] - span[..., 3:] * origins, span[..., 3:]], axis=2)
    start = span[:, None, 0]
    first, second = 2 * (span[:, None, 1] - start), start - 2 * span[:, None, 1]
    second = second + span[:, None, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.nan_to_num(np.clip(dot(points, chords) / dot(chords, chords), 0, 1))
    for _ in range(_STEPS):
        x, dx = _conic_steps(start, first, second, t)
        before, t = t, np.clip(t + dot(points - x, dx) / dot(dx, dx), 0, 1)
        if not (np.abs(t - before) > _SETTLED).any():
            break
    return norm(points - _conic_steps(start, first, second, t)[0])


def _conic_steps(
    start: FloatArray, first: FloatArray, second: FloatArray, t: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Points and derivatives of rational quadratics at t (n, q), by their coefficients."""
    t = t[..., None]
    x, dx = start + t * (first + t * second), first + 2 * t * second
    at = x[..., :3] / x[..., 3:]
    return at, (dx[..., :3] - at * dx[..., 3:]) / x[..., 3:]


# Volumes

_NODES, _LENGTHS = np.polynomial.legendre.leggauss(10)
_SHARES, _WEIGHTS = (_NODES + 1) / 2, _LENGTHS / 2


def brep_volumes(streams: NDArray[np.uint8], layout: BrepLayout) -> FloatArray:
    """Volumes (n,) that Breps of one layout enclose; negative if their faces look inwards.

    By the theorem of Gauss a face adds a third of the integral of x · n over it, in (u, v) that
    of ``x · (x_u × x_v)`` over the inside of its trims. By Green's that is the integral of
    ``P dv`` along them, where P is the integral along u from the left of the domain: Gauss
    points along every span of the trims and, for each, along u.
    """
    origins = stream_numbers(streams, layout.faces[0].sides[0].start, 3)
    total = np.zeros(len(streams))
    for face in layout.faces:
        share = _face_share(streams, face, origins)
        total += -share if face.is_reversed else share
    return total / 3


def _face_share(streams: NDArray[np.uint8], face: Face, origins: FloatArray) -> FloatArray:
    steps = [trim_steps(streams, side.trim, _SHARES) for side in face.sides]
    uv, changes = (np.concatenate(parts, axis=1) for parts in zip(*steps, strict=True))
    weights = np.tile(_WEIGHTS, uv.shape[1] // len(_WEIGHTS))
    if face.surface.uuid == PLANE_SURFACE:
        plane = stream_numbers(streams, face.surface.points, 9).reshape(-1, 3, 3)
        height = dot(plane[:, 0] - origins, np.cross(plane[:, 1], plane[:, 2]))
        return height * ((uv[..., 0] * changes[..., 1]) @ weights)
    return (_along_u(streams, face, origins, uv) * changes[..., 1]) @ weights


def _along_u(
    streams: NDArray[np.uint8], face: Face, origins: FloatArray, uv: FloatArray
) -> FloatArray:
    """Integrals (n, q) of x · (x_u × x_v) from the left of the domain to points."""
    surface = face.surface
    knots = [surface_knots(streams, surface, axis) for axis in (0, 1)]
    net = surface_net(streams, surface)
    net = np.concatenate(
        [net[..., :3] - net[..., 3:] * origins[:, None, None], net[..., 3:]], -1
    )
    basis, slopes = spline_basis(knots[1], uv[..., 1], surface.orders[1] - 1)
    # Curves in u through the points, and how they change with v: (n, q, k, 4).
    flat = net.transpose(0, 2, 1, 3).reshape(len(net), net.shape[2], -1)
    shape = (*uv.shape[:2], net.shape[1], 4)
    curves, turns = (np.matmul(part, flat).reshape(shape) for part in (basis, slopes))
    breaks = knots[0][:, :: surface.orders[0] - 1]
    total = np.zeros(uv.shape[:2])
    for low, high in zip(breaks.T[:-1], breaks.T[1:], strict=True):
        end = np.clip(uv[..., 0], low[:, None], high[:, None])
        length = end - low[:, None]
        u = low[:, None, None] + length[..., None] * _SHARES
        along, rises = spline_basis(knots[0], u.reshape(len(u), -1), surface.orders[0] - 1)
        along, rises = (x.reshape(*u.shape, -1) for x in (along, rises))
        x: FloatArray = np.matmul(along, curves)
        x_u: FloatArray = np.matmul(rises, curves)
        x_v: FloatArray = np.matmul(along, turns)
        flux = _triple(x, x_u, x_v) / x[..., 3] ** 3
        total += length * (flux @ _WEIGHTS)
    return total


def _triple(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Triple products of the first three components, several times as fast as by `cross`."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (np.moveaxis(x, -1, 0)[:3] for x in (a, b, c))
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
