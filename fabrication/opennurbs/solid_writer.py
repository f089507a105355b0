"""Writes solids as openNURBS Breps: exact faces, edges and trims, byte by byte.

Objects and records are those of `brep_writer`. Every edge is shared by two faces; the seam of a
whole cylinder is shared by its two ends in u.
"""

from collections.abc import Sequence
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, IntArray, norm, unit
from ..breps.records import BrepBatch, EdgeBatch, select_rows
from . import stream_codes as codes
from .brep_writer import EMPTY_BOX, plane_records
from .solid_charts import (
    Conic,
    FaceChart,
    Trim,
    conic_sweeps,
    edge_axes,
    edge_conics,
    face_chart,
    ring_ends,
)
from .stream_writer import Chunk, Piece, Slot, class_object, doubles, fill, ints, table

_ONE_SPAN_SWEEP = 2.0
"""Edges that turn farther, in radians, are cut into two spans, as all patches of the solid."""

_ONE_SPAN_WEIGHT = 0.25

_ISO_TOLERANCE = 16 * 2.0**-26
"""Of the domain: a trim no wider runs along u or v for openNURBS, which wants it told."""

_SIDES = {0: (3, 5, 1), 1: (4, 6, 2)}
"""Codes of trims along a bound of the domain (low, high), or inside of it: u, then v, fixed."""


def solid_streams(batches: Sequence[BrepBatch], places: FloatArray) -> list[bytes]:
    """Parts, each as the stream of one `ON_Brep`, in the order of their rows.

    Parts stand at places (n, 3), where their own origins go.
    """
    result: dict[int, bytes] = {}
    for batch in batches:
        shapes = _shapes(batch, 1)
        is_bent = _is_bent(shapes)
        if is_bent.any():
            chosen = (select_rows(batch, np.flatnonzero(rows)) for rows in (~is_bent, is_bent))
            both = [_shapes(rows, spans) for rows, spans in zip(chosen, (1, 2), strict=True)]
        else:
            both = [shapes]
        for each in both:
            if len(each.batch.rows):
                result.update(_streams(each, places[each.batch.rows]))
    return [result[row] for row in sorted(result)]


class _Shapes(NamedTuple):
    """Parts of one topology, their curved edges and their faces."""

    batch: BrepBatch
    conics: list[Conic | None]
    charts: list[FaceChart]


def _shapes(batch: BrepBatch, spans: int) -> _Shapes:
    """Parts whose curves and patches have so many Bézier spans."""
    conics = edge_conics(batch, spans)
    return _Shapes(
        batch, conics, [face_chart(batch, face, conics, spans) for face in batch.faces]
    )


def _is_bent(shapes: _Shapes) -> BoolArray:
    """Which parts (m,) need two spans, so that weights stay well positive."""
    least = np.ones(len(shapes.batch.rows))
    for chart in shapes.charts:
        least = np.minimum(least, chart.net[..., 3].min(axis=(1, 2), initial=1.0))
    return (conic_sweeps(shapes.batch) > _ONE_SPAN_SWEEP) | (least < _ONE_SPAN_WEIGHT)


def _streams(shapes: _Shapes, places: FloatArray) -> dict[int, bytes]:
    batch, conics, charts = shapes
    topology = _topology(batch)
    numbers: dict[str, NDArray[Any]] = {
        "vertices": batch.corners + places[:, None],
        "lengths": np.stack([_length(batch, edge) for edge in batch.edges], axis=1),
        "iso": np.stack([_iso(charts[use.face], use.trim(charts)) for use in topology], axis=1),
        "box": _box(batch, conics, charts, places)[:, None],
    }
    for i, edge in enumerate(batch.edges):
        numbers[f"edge {i}"] = _edge_numbers(batch, edge, conics[i], places)[:, None]
    for i, use in enumerate(topology):
        numbers[f"trim {i}"] = _trim_numbers(use.trim(charts))[:, None]
    for i, chart in enumerate(charts):
        numbers |= _surface_numbers(i, chart, places)
    streams = fill(_brep(batch, charts, conics, topology), numbers)
    return dict(zip(batch.rows.tolist(), streams, strict=True))


class _Use(NamedTuple):
    """A trim: its face, ring and side; its edge, whether it runs backwards, its corners."""

    face: int
    ring: int
    side: int
    loop: int
    edge: int
    is_reversed: bool
    ends: tuple[int, int]

    def trim(self, charts: list[FaceChart]) -> Trim:
        return charts[self.face].trims[self.ring][self.side]


def _topology(batch: BrepBatch) -> list[_Use]:
    uses: list[_Use] = []
    loops = count()
    for i, face in enumerate(batch.faces):
        for j, ring in enumerate((face.ring, *face.holes)):
            loop = next(loops)
            for k, (ends, (edge, is_forward)) in enumerate(
                zip(ring_ends(batch, ring), ring, strict=True)
            ):
                uses.append(_Use(i, j, k, loop, edge, not is_forward, ends))
    return uses


# Numbers


def _length(batch: BrepBatch, edge: EdgeBatch) -> FloatArray:
    """End of the domain of an edge, which begins at 0; 1 for ellipses."""
    change = batch.corners[:, edge.end] - batch.corners[:, edge.start]
    if edge.kind == "LINE":
        return norm(change)
    if edge.kind == "ELLIPSE":
        return np.ones(len(change))
    return edge.numbers[:, 9] * _sweep(edge, change)


def _sweep(edge: EdgeBatch, chord: FloatArray) -> FloatArray:
    """Angle of a circle that begins at its x axis."""
    if edge.start == edge.end:
        return np.full(len(chord), 2 * np.pi)
    _, a, b = edge_axes(edge)
    radii = edge.numbers[:, 9]
    x, y = ((chord * axis).sum(axis=1) / radii**2 for axis in (a, b))
    return np.arctan2(y, 1 + x) % (2 * np.pi)


def _edge_numbers(
    batch: BrepBatch, edge: EdgeBatch, conic: Conic | None, places: FloatArray
) -> FloatArray:
    start, end = (batch.corners[:, corner] + places for corner in (edge.start, edge.end))
    lengths = _length(batch, edge)
    zero = np.zeros_like(lengths)
    if edge.kind == "LINE":
        return np.column_stack([start, end, zero, lengths])
    if edge.kind == "ELLIPSE" and conic is not None:
        return _placed(conic.points, places).reshape(len(places), -1)
    centers, a, b = edge_axes(edge)
    centers, axes = centers + places, edge.numbers[:, 3:6]
    plane = plane_records(centers, unit(a), unit(b), axes)
    sweeps = _sweep(edge, batch.corners[:, edge.end] - batch.corners[:, edge.start])
    return np.column_stack([
        plane, edge.numbers[:, 9], centers + a, centers + b, centers - a,
        zero, sweeps, zero, lengths,
    ])  # fmt: skip


def _placed(points: FloatArray, places: FloatArray) -> FloatArray:
    """Homogeneous points (m, ..., 4), moved."""
    shape = (len(places), *(1,) * (points.ndim - 2), 3)
    moved = points[..., :3] + points[..., 3:] * places.reshape(shape)
    return np.concatenate([moved, points[..., 3:]], axis=-1)


def _trim_numbers(trim: Trim) -> FloatArray:
    count = len(trim.points)
    if trim.kind != "line":
        return trim.points.reshape(count, -1)
    ends = trim.points * np.array([1.0, 1.0, 0.0])
    domain = np.tile([0.0, 1.0], (count, 1))
    return np.concatenate([ends.reshape(count, -1), domain], axis=1)


def _surface_numbers(i: int, chart: FaceChart, places: FloatArray) -> dict[str, FloatArray]:
    u, v = chart.knots
    if chart.kind == "plane":
        x, y, z = chart.frames.transpose(1, 0, 2)
        plane = plane_records(chart.origins + places, x, y, z)
        return {f"plane {i}": np.column_stack([plane, u, v, u, v])[:, None]}
    net = _placed(chart.net, places)
    return {f"u {i}": u[:, None], f"v {i}": v[:, None], f"net {i}": net[:, None]}


def _iso(chart: FaceChart, trim: Trim) -> IntArray:
    """Codes (m,) of trims that run along u or v, as openNURBS finds them."""
    points = trim.points[..., :2] / trim.points[..., 2:]
    low, high = points.min(axis=1), points.max(axis=1)
    first = np.stack([knots[:, 0] for knots in chart.knots], axis=1)
    last = np.stack([knots[:, -1] for knots in chart.knots], axis=1)
    size = last - first
    extent, allowed = high - low, _ISO_TOLERANCE * size
    axis = (extent / size).argmin(axis=1)
    result = np.zeros(len(points), np.int64)
    for i, (at_low, at_high, inside) in _SIDES.items():
        is_iso = (axis == i) & (extent[:, i] <= allowed[:, i])
        near_low = high[:, i] <= first[:, i] + allowed[:, i] / 2
        near_high = low[:, i] >= last[:, i] - allowed[:, i] / 2
        side = np.where(near_low, at_low, np.where(near_high, at_high, inside))
        result[is_iso] = side[is_iso]
    return result


def _box(
    batch: BrepBatch, conics: list[Conic | None], charts: list[FaceChart], places: FloatArray
) -> FloatArray:
    nets = [chart.net.reshape(len(places), -1, 4) for chart in charts]
    nets += [conic.points for conic in conics if conic is not None]
    hull = [net[..., :3] / net[..., 3:] for net in nets]
    points = np.concatenate([batch.corners, *hull], axis=1) + places[:, None]
    return np.concatenate([points.min(axis=1), points.max(axis=1)], axis=1)


# Bytes


def _brep(
    batch: BrepBatch,
    charts: list[FaceChart],
    conics: list[Conic | None],
    topology: list[_Use],
) -> Chunk:
    one = ints(1)
    n_corners, n_faces = batch.corners.shape[1], len(charts)
    trims = [(one, _trim_curve(i, use.trim(charts))) for i, use in enumerate(topology)]
    edges = [(one, _edge_curve(i, batch.edges[i], conics[i])) for i in range(len(conics))]
    surfaces = [(one, _surface(i, chart)) for i, chart in enumerate(charts)]
    # index, point, edges that meet here, tolerance
    meeting: list[list[int]] = [[] for _ in range(n_corners)]
    for i, edge in enumerate(batch.edges):
        meeting[edge.start].append(i)
        meeting[edge.end].append(i)
    vertices = [
        (ints(i), Slot("vertices", i, 3), ints(len(met), *met), doubles(0))
        for i, met in enumerate(meeting)
    ]
    n_loops = topology[-1].loop + 1
    loops = [
        [i for i, use in enumerate(topology) if use.loop == loop] for loop in range(n_loops)
    ]
    face_of = [topology[members[0]].face for members in loops]
    is_outer = [topology[members[0]].ring == 0 for members in loops]
    # index, trims, type, face
    loop_records = [
        (
            ints(
                i, len(members), *members, codes.OUTER_LOOP if outer else codes.INNER_LOOP, face
            ),
        )
        for i, (members, face, outer) in enumerate(zip(loops, face_of, is_outer, strict=True))
    ]
    # index, loops, surface, reversed, material channel; then the ids of all faces
    own = [[j for j, face in enumerate(face_of) if face == i] for i in range(n_faces)]
    faces = [ints(i, len(own[i]), *own[i], i, 0, 0) for i in range(n_faces)]
    face_table = (b"\x11", ints(n_faces), *faces, bytes(16 * n_faces))
    return class_object(
        codes.BREP, b"\x33", table(0, trims), table(0, edges), table(0, surfaces),
        table(0, vertices), table(0, _edge_records(batch, topology)),
        table(0, _trim_records(topology)), table(0, loop_records),
        Chunk(codes.ANONYMOUS, face_table), Slot("box", 0, 6),
        Chunk(codes.ANONYMOUS, (bytes(n_faces),)), Chunk(codes.ANONYMOUS, (bytes(n_faces),)),
        ints(1 if batch.is_solid else 3), Chunk(codes.ANONYMOUS, (ints(1, 1), b"\0")),
    )  # fmt: skip


def _edge_records(batch: BrepBatch, topology: list[_Use]) -> list[tuple[Piece, ...]]:
    """Index, curve, reversed, domain of the curve, vertices, trims, tolerance, domain."""
    records: list[tuple[Piece, ...]] = []
    for i, edge in enumerate(batch.edges):
        users = [j for j, use in enumerate(topology) if use.edge == i]
        length = Slot("lengths", i, 1)
        records.append((
            ints(i, i, 0), doubles(0), length, ints(edge.start, edge.end, len(users), *users),
            doubles(0, 0), length,
        ))  # fmt: skip
    return records


def _trim_records(topology: list[_Use]) -> list[tuple[Piece, ...]]:
    """Those of `brep_writer`."""
    records: list[tuple[Piece, ...]] = []
    faces: dict[int, list[int]] = {}
    for use in topology:
        faces.setdefault(use.edge, []).append(use.loop)
    for i, use in enumerate(topology):
        users = faces[use.edge]
        kind = codes.MATED_TRIM if len(users) > 1 else codes.BOUNDARY_TRIM
        kind = codes.SEAM_TRIM if users.count(use.loop) > 1 else kind
        head = ints(i, i) + doubles(0, 1) + ints(use.edge, *use.ends, use.is_reversed, kind)
        tail = doubles(0, 0, 0, 1) + bytes(32) + doubles(0, 0)
        records.append((head, Slot("iso", i, 1, "<i4"), ints(use.loop), tail))
    return records


def _trim_curve(i: int, trim: Trim) -> Chunk:
    if trim.kind == "line":
        return class_object(codes.LINE_CURVE, b"\x10", Slot(f"trim {i}", 0, 8), ints(2))
    return _nurbs_curve(f"trim {i}", 2, 4 if trim.kind == "cubic" else 3, trim.points.shape[1])


def _edge_curve(i: int, edge: EdgeBatch, conic: Conic | None) -> Chunk:
    name = f"edge {i}"
    if edge.kind == "LINE":
        return class_object(codes.LINE_CURVE, b"\x10", Slot(name, 0, 8), ints(3))
    if edge.kind == "ELLIPSE" and conic is not None:
        return _nurbs_curve(name, 3, 3, conic.points.shape[1])
    return class_object(codes.ARC_CURVE, b"\x10", Slot(name, 0, 30), ints(3))


def _nurbs_curve(name: str, dimension: int, order: int, n_points: int) -> Chunk:
    """A rational curve in Bézier spans over [0, 1]."""
    degree = order - 1
    knots = np.repeat(np.linspace(0, 1, (n_points - 1) // degree + 1), degree)
    head = ints(dimension, 1, order, n_points, 0, 0) + EMPTY_BOX
    points = Slot(name, 0, (dimension + 1) * n_points)
    return class_object(
        codes.NURBS_CURVE, b"\x11", head, ints(len(knots)), doubles(*knots.tolist()),
        ints(n_points), points, b"\0",
    )  # fmt: skip


def _surface(i: int, chart: FaceChart) -> Chunk:
    if chart.kind == "plane":
        return class_object(codes.PLANE_SURFACE, b"\x11", Slot(f"plane {i}", 0, 24))
    n_u, n_v = chart.net.shape[1:3]
    order_v = 2 if n_v == 2 else 3
    head = ints(3, 1, 3, order_v, n_u, n_v, 0, 0) + EMPTY_BOX
    n_knots = [knots.shape[1] for knots in chart.knots]
    return class_object(
        codes.NURBS_SURFACE, b"\x10", head,
        ints(n_knots[0]), Slot(f"u {i}", 0, n_knots[0]),
        ints(n_knots[1]), Slot(f"v {i}", 0, n_knots[1]),
        ints(n_u * n_v), Slot(f"net {i}", 0, 4 * n_u * n_v),
    )  # fmt: skip
