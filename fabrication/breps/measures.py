"""Volume, area and centre of mass of boundary representations, from their own numbers.

By the theorem of Gauss all are integrals over faces: of 1, of ``x · n / 3`` and of
``x (x · n) / 4``. Every face has a chart (u, w) in which areas are true - planes, cylinders
unrolled, spheres by longitude and height, as Archimedes found -, so by Green's theorem they are
integrals along its rings, by Gauss points along every edge and, for each, along u.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ...kernel.arrays import FloatArray, dot
from .records import BrepBatch, EdgeBatch, FaceBatch, Ring, select_rows

_NODES, _LENGTHS = np.polynomial.legendre.leggauss(12)
_SHARES, _WEIGHTS = (_NODES + 1) / 2, _LENGTHS / 2

_AT_A_TIME = 512
"""Parts that are measured together: more would need memory."""


@dataclass(frozen=True)
class Measures:
    """Of n closed parts, about their own origins."""

    volumes: FloatArray  # (n,)
    areas: FloatArray  # (n,)
    centers: FloatArray  # (n, 3)


def brep_measures(batches: Iterable[BrepBatch]) -> Measures:
    """Measures of solids, in the order of their rows."""
    rows: list[int] = []
    found: list[FloatArray] = [np.zeros((0, 5))]
    for batch in batches:
        rows += batch.rows.tolist()
        for begin in range(0, len(batch.rows), _AT_A_TIME):
            some = np.arange(begin, min(begin + _AT_A_TIME, len(batch.rows)))
            found.append(_integrals(select_rows(batch, some)))
    values = np.concatenate(found)[np.argsort(rows)]
    volumes = values[:, 1] / 3
    return Measures(volumes, values[:, 0], values[:, 2:] / (4 * volumes[:, None]))


def _integrals(batch: BrepBatch) -> FloatArray:
    """Integrals (m, 5) of 1, x · n and x (x · n) over all faces."""
    edges = [_edge_points(batch, edge) for edge in batch.edges]
    total = np.zeros((len(batch.rows), 5))
    for face in batch.faces:
        for ring in (face.ring, *face.holes):
            total += _face_share(batch, face, ring, edges)
    return total


_Steps = tuple[FloatArray, FloatArray]
"""Points (m, q, 3) along an edge, and how they change."""


def _edge_points(batch: BrepBatch, edge: EdgeBatch) -> _Steps:
    start, end = batch.corners[:, edge.start, None], batch.corners[:, edge.end, None]
    if edge.kind == "LINE":
        change = end - start
        steps = np.repeat(change, len(_SHARES), axis=1)
        return start + _SHARES[:, None] * change, steps
    center, axis, x = (edge.numbers[:, None, i : i + 3] for i in (0, 3, 6))
    a, b = (
        edge.numbers[:, 9, None, None] * x,
        edge.numbers[:, -1, None, None] * np.cross(axis, x),
    )
    first, last = (
        np.arctan2(dot(p - center, b) / dot(b, b), dot(p - center, a) / dot(a, a))
        for p in (start, end)
    )
    is_whole = edge.start == edge.end
    sweep = np.full_like(first, 2 * np.pi) if is_whole else (last - first) % (2 * np.pi)
    angles = (first + sweep * _SHARES)[..., None]
    cosine, sine = np.cos(angles), np.sin(angles)
    return center + cosine * a + sine * b, sweep[..., None] * (cosine * b - sine * a)


def _face_share(
    batch: BrepBatch, face: FaceBatch, ring: Ring, edges: list[_Steps]
) -> FloatArray:
    parts = [edges[edge] if along else _reversed(edges[edge]) for edge, along in ring]
    points, steps = (np.concatenate(each, axis=1) for each in zip(*parts, strict=True))
    chart = _plane_chart if face.kind == "PLANE" else _round_chart
    u, rises, place = chart(batch, face, points, steps)
    # From anywhere: what is added along the whole ring vanishes.
    middle = u.mean(axis=1, keepdims=True)
    length = u - middle
    at, normals = place(middle[..., None] + length[..., None] * _SHARES)
    height = dot(at, normals)
    values = np.stack(
        [np.ones_like(height), height, *(at * height[..., None]).T.swapaxes(1, 3)]
    )
    inner = (values @ _WEIGHTS) * length * rises
    sense = 1.0 if face.is_along else -1.0
    sums = (inner.reshape(5, len(batch.rows), len(ring), -1) @ _WEIGHTS).sum(axis=2).T
    # The area is counted along the ring, which follows the normal of the face.
    return sums * np.array([sense, 1.0, 1.0, 1.0, 1.0])


def _reversed(steps: _Steps) -> _Steps:
    return steps[0][:, ::-1], -steps[1][:, ::-1]


_Chart = tuple[FloatArray, FloatArray, Callable[[FloatArray], _Steps]]
"""u along a ring, changes of w, and places and normals (m, q, g, 3) of other u, (m, q, g)."""


def _plane_chart(
    batch: BrepBatch, face: FaceBatch, points: FloatArray, steps: FloatArray
) -> _Chart:
    normal, x = face.numbers[:, None, :3], face.numbers[:, None, 3:6]
    y = np.cross(normal, x)
    origin = batch.corners[:, face.corner, None]
    w = dot(points - origin, y)

    def place(u: FloatArray) -> _Steps:
        flat = (origin + w[..., None] * y)[:, :, None] + u[..., None] * x[:, :, None]
        return flat, np.broadcast_to(normal[:, :, None], flat.shape)

    return dot(points - origin, x), dot(steps, y), place


def _round_chart(
    batch: BrepBatch,  # noqa: ARG001 - as of planes
    face: FaceBatch, points: FloatArray, steps: FloatArray,
) -> _Chart:  # fmt: skip
    """Angle about the axis, and the height along it times the radius."""
    center, z, x = (face.numbers[:, None, i : i + 3] for i in (0, 3, 6))
    y, radius = np.cross(z, x), face.numbers[:, 9, None]
    local = points - center
    height = dot(local, z)
    u = np.unwrap(np.arctan2(dot(local, y), dot(local, x)), axis=1)
    is_sphere = face.kind == "SPHERICAL_SURFACE"
    wide = np.sqrt(np.maximum(radius**2 - height**2, 0.0)) if is_sphere else radius + 0 * height

    def place(u: FloatArray) -> _Steps:
        cosine, sine = np.cos(u)[..., None], np.sin(u)[..., None]
        out = cosine * x[:, :, None] + sine * y[:, :, None]
        across = wide[..., None, None] * out
        up = (height[..., None] * z)[:, :, None]
        normals = (across + up) / radius[..., None, None] if is_sphere else out
        return center[:, :, None] + across + up, normals

    return u, dot(steps, z) * radius, place
