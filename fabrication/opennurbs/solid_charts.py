"""Faces of solids as exact surfaces of openNURBS, their edges as exact trims in (u, v).

A sphere is seen from its pole through the stereographic chart of `sphere_patches`, where
circles are circular arcs; a plane by two of its axes; a cylinder through

    x(u, v) = c + r (cos θ X + sin θ Y) + v Z,    u = 2 r tan(θ / 2),

rational in u and straight in v, where rulings and cross circles are lines, and a plane cuts it
in a rational cubic. A whole cylinder has u = r θ at quarters of its circle, and lines alone.
Surfaces look out of the solid: their rings run counter-clockwise in (u, v).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from ...kernel.arrays import FloatArray, dot, unit
from ..breps.records import BrepBatch, EdgeBatch, FaceBatch, Ring
from .sphere_patches import (
    circle_charts,
    patch_control_points,
    trim_control_points,
    turned,
)

TrimKind: TypeAlias = Literal["line", "conic", "cubic"]
SurfaceKind: TypeAlias = Literal["plane", "net"]

_MARGIN = 0.02
"""How far surfaces reach beyond their trims, relative to their size."""


class Conic(NamedTuple):
    """A curved edge as homogeneous control points (m, n, 4), from its start to its end."""

    points: FloatArray
    middles: FloatArray


class Trim(NamedTuple):
    """An edge in (u, v): homogeneous control points (m, n, 3), in the sense of its ring."""

    kind: TrimKind
    points: FloatArray


@dataclass(frozen=True)
class FaceChart:
    """A face of m solids, about their own origins.

    Surfaces are planes (frames in rows and origins), or nets of homogeneous control points
    (m, n, k, 4), quadratic in u, in v quadratic or straight; knots are those of openNURBS,
    without the first and last of other notations. Trims follow the rings, holes last.
    """

    kind: SurfaceKind
    origins: FloatArray
    frames: FloatArray
    knots: tuple[FloatArray, FloatArray]
    net: FloatArray
    trims: tuple[tuple[Trim, ...], ...]


def edge_conics(batch: BrepBatch, spans: int) -> list[Conic | None]:
    """Circles and ellipses of the edges of a batch in Bézier spans; None for lines."""
    return [None if edge.kind == "LINE" else _conic(batch, edge, spans) for edge in batch.edges]


def conic_sweeps(batch: BrepBatch) -> FloatArray:
    """The largest angle (m,) that an edge runs along its circle or ellipse, no whole ones."""
    sweeps = [
        _parameters(batch, edge)[1]
        for edge in batch.edges
        if edge.kind != "LINE" and edge.start != edge.end
    ]
    return np.max(sweeps, axis=0) if sweeps else np.zeros(len(batch.rows))


def edge_axes(edge: EdgeBatch) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centres (m, 3) of circles or ellipses, and their half axes at a quarter turn."""
    centers, axes, x = (edge.numbers[:, i : i + 3] for i in (0, 3, 6))
    first, second = edge.numbers[:, 9, None], edge.numbers[:, -1, None]
    return centers, first * x, second * np.cross(axes, x)


def _parameters(batch: BrepBatch, edge: EdgeBatch) -> tuple[FloatArray, FloatArray]:
    """Angles at the start, and how far the edge runs."""
    centers, a, b = edge_axes(edge)
    angles: list[FloatArray] = []
    for corner in (edge.start, edge.end):
        relative = batch.corners[:, corner] - centers
        angles.append(np.arctan2(dot(relative, b) / dot(b, b), dot(relative, a) / dot(a, a)))
    return angles[0], (angles[1] - angles[0]) % (2 * np.pi)


def _conic(batch: BrepBatch, edge: EdgeBatch, spans: int) -> Conic:
    centers, a, b = edge_axes(edge)
    if edge.start == edge.end:
        spans, first, sweep = 4, _parameters(batch, edge)[0], np.full(len(a), 2 * np.pi)
    else:
        first, sweep = _parameters(batch, edge)
    half = sweep[:, None] / (2 * spans)
    angles = first[:, None] + half * np.arange(2 * spans + 1)
    weights = np.where(np.arange(2 * spans + 1) % 2 == 1, np.cos(half), 1.0)
    on = np.cos(angles)[..., None] * a[:, None] + np.sin(angles)[..., None] * b[:, None]
    points = on + weights[..., None] * centers[:, None]
    points[:, 0], points[:, -1] = batch.corners[:, edge.start], batch.corners[:, edge.end]
    turn = (first + sweep / 2)[:, None]
    middles = centers + np.cos(turn) * a + np.sin(turn) * b
    return Conic(np.concatenate([points, weights[..., None]], axis=-1), middles)


def face_chart(
    batch: BrepBatch, face: FaceBatch, conics: list[Conic | None], spans: int
) -> FaceChart:
    """Surface and trims of a face; patches of spheres and cylinders have so many spans."""
    if face.kind == "PLANE":
        return _plane_chart(batch, face, conics)
    if face.kind == "SPHERICAL_SURFACE":
        return _sphere_chart(batch, face, conics, spans)
    if any(batch.edges[edge].start == batch.edges[edge].end for edge, _ in face.ring):
        return _whole_cylinder_chart(batch, face)
    return _cylinder_chart(batch, face, spans)


def ring_ends(batch: BrepBatch, ring: Ring) -> list[tuple[int, int]]:
    """Corners where each side of a ring begins and ends."""
    edges = ((batch.edges[edge], is_forward) for edge, is_forward in ring)
    return [(e.start, e.end) if is_forward else (e.end, e.start) for e, is_forward in edges]


def _rings(face: FaceBatch) -> tuple[Ring, ...]:
    return face.ring, *face.holes


def _plane_chart(batch: BrepBatch, face: FaceBatch, conics: list[Conic | None]) -> FaceChart:
    normals = face.numbers[:, :3] * (1.0 if face.is_along else -1.0)
    origins = batch.corners[:, face.corner]
    ends = ring_ends(batch, face.ring)
    starts = batch.corners[:, [start for start, _ in ends]] - origins[:, None]
    first = batch.corners[:, ends[0][1]] - batch.corners[:, ends[0][0]]
    first = first if len(ends) > 1 else face.numbers[:, 3:6]
    x = unit(first - dot(first, normals)[:, None] * normals)
    frames = np.stack([x, np.cross(normals, x), normals], axis=1)
    frames = turned(frames, np.einsum("mij,mkj->mki", frames, starts)[..., :2])

    def project(points: FloatArray) -> FloatArray:
        relative = points[..., :3] - points[..., 3:] * origins[:, None]
        uv = np.einsum("mij,mkj->mki", frames[:, :2], relative)
        return np.concatenate([uv, points[..., 3:]], axis=-1)

    trims = _projected(batch, face, conics, project)
    hull = _hull(trims)
    low, high = hull.min(axis=1), hull.max(axis=1)
    margin = _MARGIN * (high - low).max(axis=1, keepdims=True)
    low, high = low - margin, high + margin
    knots = tuple(np.stack([low[:, i], high[:, i]], axis=1) for i in (0, 1))
    return FaceChart("plane", origins, frames, (knots[0], knots[1]), _none(batch), trims)


def _projected(
    batch: BrepBatch,
    face: FaceBatch,
    conics: list[Conic | None],
    project: Callable[[FloatArray], FloatArray],
) -> tuple[tuple[Trim, ...], ...]:
    """Trims of a plane face, by the projection of homogeneous points to (u, v)."""
    rings: list[tuple[Trim, ...]] = []
    for ring in _rings(face):
        trims: list[Trim] = []
        for (start, end), (edge, is_forward) in zip(ring_ends(batch, ring), ring, strict=True):
            conic = conics[edge]
            if conic is None:
                ones = np.ones((len(batch.rows), 2, 1))
                points = np.concatenate([batch.corners[:, [start, end]], ones], axis=-1)
                trims.append(Trim("line", project(points)))
            else:
                points = conic.points if is_forward else conic.points[:, ::-1]
                trims.append(Trim("conic", project(points)))
        rings.append(tuple(trims))
    return tuple(rings)


def _none(batch: BrepBatch) -> FloatArray:
    return np.zeros((len(batch.rows), 0, 0, 4))


def _hull(trims: tuple[tuple[Trim, ...], ...]) -> FloatArray:
    """Control points (m, n, 2) of trims: they lie in the hull of these."""
    points = np.concatenate([trim.points for ring in trims for trim in ring], axis=1)
    return points[..., :2] / points[..., 2:]


def _sphere_chart(
    batch: BrepBatch, face: FaceBatch, conics: list[Conic | None], spans: int
) -> FaceChart:
    centers, x, radii = face.numbers[:, :3], face.numbers[:, 6:9], face.numbers[:, 9]
    sense = 1.0 if face.is_along else -1.0
    poles = centers - radii[:, None] * x
    starts = [start for start, _ in ring_ends(batch, face.ring)]
    arcs = [conic for edge, _ in face.ring if (conic := conics[edge]) is not None]
    middles = np.stack([arc.middles for arc in arcs], axis=1)
    charts = circle_charts(
        -sense / (2 * radii), -sense * x, batch.corners[:, starts] - poles[:, None],
        middles - poles[:, None],
    )  # fmt: skip
    charts = replace(charts, origins=poles)
    control = trim_control_points(charts, spans)
    trims = tuple(Trim("conic", control[:, i]) for i in range(control.shape[1]))
    knots = charts.reaches[..., None] * np.repeat(np.linspace(-1, 1, spans + 1), 2)
    net = patch_control_points(charts, knots)
    both = (knots[:, 0], knots[:, 1])
    return FaceChart("net", poles, charts.frames, both, net, (trims,))


class _Cylinder(NamedTuple):
    """Axes X, Y, Z of a cylinder as rows, Y turned so that the surface looks out."""

    centers: FloatArray
    frames: FloatArray
    radii: FloatArray

    def local(self, points: FloatArray) -> FloatArray:
        return np.einsum("mij,mkj->mki", self.frames, points - self.centers[:, None])

    def flat(self, points: FloatArray) -> FloatArray:
        """(u, v) of points (m, k, 3) on the cylinder."""
        x, y, v = np.moveaxis(self.local(points), -1, 0)
        radii = self.radii[:, None]
        return np.stack([2 * radii * y / (np.hypot(x, y) + x), v], axis=-1)


def _cylinder(face: FaceBatch, x: FloatArray) -> _Cylinder:
    z = face.numbers[:, 3:6]
    y = np.cross(z, x) * (1.0 if face.is_along else -1.0)
    return _Cylinder(face.numbers[:, :3], np.stack([x, y, z], axis=1), face.numbers[:, 9])


def _cylinder_chart(batch: BrepBatch, face: FaceBatch, spans: int) -> FaceChart:
    cylinder = _cylinder(face, -face.numbers[:, 6:9])
    trims: list[Trim] = []
    for (start, end), (edge, _) in zip(ring_ends(batch, face.ring), face.ring, strict=True):
        uv = cylinder.flat(batch.corners[:, [start, end]])
        trims.append(_cylinder_trim(batch.edges[edge], uv, cylinder))
    hull = _hull((tuple(trims),))
    reach = (1 + _MARGIN) * np.abs(hull[..., 0]).max(axis=1)
    v = _widened(hull[..., 1])
    u = reach[:, None] * np.repeat(np.linspace(-1, 1, spans + 1), 2)
    # Polar forms of r cos, r sin and 1, times 1 + tan², at two consecutive knots.
    radii = cylinder.radii[:, None]
    tangents = u / (2 * radii)
    total, product = tangents[:, :-1] + tangents[:, 1:], tangents[:, :-1] * tangents[:, 1:]
    across = np.stack([radii * (1 - product), radii * total], axis=-1)
    return _cylinder_face(cylinder, (u, v), across, 1 + product, tuple(trims))


def _cylinder_face(
    cylinder: _Cylinder, knots: tuple[FloatArray, FloatArray], across: FloatArray,
    weights: FloatArray, trims: tuple[Trim, ...],
) -> FaceChart:  # fmt: skip
    """A net quadratic in u, whose points across the axis (m, n, 2) are known, straight in v."""
    points = np.einsum("mni,mij->mnj", across, cylinder.frames[:, :2])[:, :, None]
    rise = knots[1][:, None, :, None] * cylinder.frames[:, None, None, 2]
    base = cylinder.centers[:, None, None] + rise
    points = points + weights[:, :, None, None] * base
    both = np.broadcast_to(weights[:, :, None, None], (*points.shape[:3], 1))
    net = np.concatenate([points, both], axis=-1)
    return FaceChart("net", cylinder.centers, cylinder.frames, knots, net, (trims,))


def _widened(values: FloatArray) -> FloatArray:
    """Bounds (m, 2) of values (m, n), with a margin."""
    low, high = values.min(axis=1), values.max(axis=1)
    margin = _MARGIN * (high - low)
    return np.stack([low - margin, high + margin], axis=1)


def _cylinder_trim(edge: EdgeBatch, uv: FloatArray, cylinder: _Cylinder) -> Trim:
    """Rulings and circles across are lines; a plane cuts in a cubic."""
    ones = np.ones((*uv.shape[:2], 1))
    if edge.kind != "ELLIPSE":
        return Trim("line", np.concatenate([uv, ones], axis=-1))
    radii = cylinder.radii
    center = cylinder.local(edge.numbers[:, None, :3])[:, 0]
    n = np.einsum("mij,mj->mi", cylinder.frames, edge.numbers[:, 3:6])
    level = dot(n, center) / n[:, 2]
    a, b = uv[..., 0].T / (2 * radii)
    # Polar forms of t, t² and t³ at the knots of the four control points.
    first = np.stack([a, (2 * a + b) / 3, (a + 2 * b) / 3, b], axis=1)
    square = np.stack([a * a, (a * a + 2 * a * b) / 3, (2 * a * b + b * b) / 3, b * b], axis=1)
    cube = np.stack([a**3, a * a * b, a * b * b, b**3], axis=1)
    weights = 1 + square
    slope = (radii / n[:, 2])[:, None]
    v = level[:, None] * weights - slope * (n[:, :1] * (1 - square) + 2 * n[:, 1:2] * first)
    points = np.stack([2 * radii[:, None] * (first + cube), v, weights], axis=-1)
    for i in (0, -1):
        points[:, i, :2] = uv[:, i] * weights[:, i, None]
    return Trim("cubic", points)


def _whole_cylinder_chart(batch: BrepBatch, face: FaceBatch) -> FaceChart:
    """The whole circle in u, from the seam on; the ring walks around the domain."""
    x = _seam(batch, face)
    cylinder = _cylinder(face, x)
    length = 2 * np.pi * cylinder.radii
    at = np.zeros_like(length)
    trims: list[Trim] = []
    for (start, end), (edge, is_forward) in zip(
        ring_ends(batch, face.ring), face.ring, strict=True
    ):
        v = cylinder.local(batch.corners[:, [start, end]])[..., 2]
        is_circle = batch.edges[edge].kind == "CIRCLE"
        step = length * ((1.0 if is_forward == face.is_along else -1.0) if is_circle else 0.0)
        u = np.stack([at, at + step], axis=1)
        at = at + step
        trims.append(Trim("line", np.stack([u, v, np.ones_like(u)], axis=-1)))
    hull = _hull((tuple(trims),))
    low, high = hull[..., 0].min(axis=1), hull[..., 0].max(axis=1)
    u = np.stack([low, high], axis=1) @ np.stack([1 - _QUARTERS, _QUARTERS])
    v = _widened(hull[..., 1])
    square = np.stack([_SQUARE_X, _SQUARE_Y], axis=-1) * _SQUARE_WEIGHTS[:, None]
    around = cylinder.radii[:, None, None] * square
    weights = np.broadcast_to(_SQUARE_WEIGHTS, around.shape[:2])
    return _cylinder_face(cylinder, (u, v), around, weights, tuple(trims))


_QUARTERS = np.repeat(np.linspace(0, 1, 5), 2)
_SQUARE_X = np.array([1.0, 1, 0, -1, -1, -1, 0, 1, 1])
_SQUARE_Y = np.array([0.0, 1, 1, 1, 0, -1, -1, -1, 0])
_SQUARE_WEIGHTS = np.where(np.arange(9) % 2 == 1, np.sqrt(0.5), 1.0)
"""A circle in four quarters: corners and middles of the square about it."""


def _seam(batch: BrepBatch, face: FaceBatch) -> FloatArray:
    """Unit vectors from the axis to the seam."""
    z = face.numbers[:, 3:6]
    relative = batch.corners[:, ring_ends(batch, face.ring)[0][0]] - face.numbers[:, :3]
    return unit(relative - dot(relative, z)[:, None] * z)
