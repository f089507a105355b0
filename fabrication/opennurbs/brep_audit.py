"""Judges Breps from their bytes alone, before they reach a file.

openNURBS calls a Brep valid whose vertex is off by a thousandth, whose surface is shifted or
whose loop runs backwards. Here the stream (layout: `brep_writer`) is parsed afresh,
with its checksums, and trims, edges, vertices and sphere are evaluated and compared.

Streams of the same layout are judged together: the first is parsed, the others must equal it in
every byte that is neither a float64 nor a checksum.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm
from ...kernel.spheres.incidence import normals, signed_distance
from ...kernel.spheres.minkowski import minkowski
from ...kernel.tolerances import BREP_VOLUME, EPSILON, EXACT_BREP
from .brep_evaluation import (
    brep_volumes,
    checksum_defects,
    distances_to_edge,
    edge_points,
    finite_streams,
    stream_numbers,
    surface_knots,
    surface_points,
    trim_points,
)
from .brep_layout import BrepLayout, Face, Side, Surface
from .brep_reader import parse_brep
from .render_mesh_audit import audit_render_meshes
from .stream_codes import ARC_CURVE, PLANE_SURFACE
from .stream_reader import UnreadableError

_AT_A_TIME = 512
"""Streams that are judged together: more do not fit the cache, and need memory."""

_LARGEST_RADIUS = 1e3
"""Of the edges of a solid, in its sizes, beyond which errors may not grow with it."""

_ROUNDING = 16
"""Spacings of float64, at the largest coordinate, that the parts of a Brep may differ by."""


@dataclass(frozen=True)
class BrepErrors:
    """How far the parts of a Brep lie apart, in model units: the largest of all faces.

    With a defect, which says why the stream cannot be judged, all errors are infinite.
    """

    defect: str = ""
    scale: float = 1.0  # what errors are relative to: radius, or size of a plane panel
    rounding: float = 0.0  # what float64 leaves of coordinates as large as these
    trim_to_edge: float = np.inf  # points of trims, lifted to the surface, from arcs or lines
    trim_to_vertex: float = np.inf  # lifted ends of trims from vertices; has gaps of the loop
    edge_to_vertex: float = np.inf  # ends of edges from vertices
    to_sphere: float = np.inf  # vertices, edges and surface from the sphere
    mesh_to_sphere: float = np.inf  # vertices of the render mesh from it; 0 without one
    is_counter_clockwise: bool = False  # the loops, in (u, v); holes run clockwise
    is_outward: bool = False  # the face looks along N of the sphere, a solid away from itself
    volume: float = np.nan  # what closed faces enclose

    @property
    def worst(self) -> float:
        """The largest distance: in model units."""
        return max(distance for distance, _ in self._distances())

    def _distances(self) -> tuple[tuple[float, str], ...]:
        return (
            (self.trim_to_edge, "a trim leaves its edge"),
            (self.trim_to_vertex, "the loop is open at a vertex"),
            (self.edge_to_vertex, "an edge does not end in its vertices"),
            (self.to_sphere, "the surface is not the sphere of the panel"),
            (self.mesh_to_sphere, "the render mesh leaves the sphere"),
        )

    def reason(self, volume: float | None = None) -> str:
        """Why the Brep is to be refused; empty for a sound one.

        Its distances are at most `EXACT_BREP` times the scale, and rounding. If the volume of
        the part is given, it is closed and encloses that, to `BREP_VOLUME` of it.
        """
        if self.defect:
            return self.defect
        allowed = EXACT_BREP * self.scale + self.rounding
        for distance, text in self._distances():
            if not distance <= allowed:
                return f"{text}: {distance:.3g} where {allowed:.3g} is allowed"
        if not self.is_counter_clockwise:
            return "the loop runs clockwise"
        if not self.is_outward:
            return "the face looks inwards"
        if volume is not None and not abs(self.volume - volume) <= BREP_VOLUME * volume:
            return f"it encloses a volume of {self.volume:.9g} where {volume:.9g} is meant"
        return ""


def verify_breps(
    streams: Sequence[bytes],
    spheres: FloatArray | None = None,
    origins: FloatArray | None = None,
) -> list[BrepErrors]:
    """Errors of Breps, measured from their bytes; those of the same layout together.

    Takes P `ON_Brep`, as written by `brep_streams`, `solid_streams` or by openNURBS; unit rows
    (P, 5) that the first faces must lie on, by default those of the surfaces of open Breps; and
    origins (P, 3) of the coordinates of the rows, by default the model's own. A stream that
    cannot be read has a defect and no errors.
    """
    result = [BrepErrors()] * len(streams)
    if origins is None:
        origins = np.zeros((len(streams), 3))
    by_length: dict[int, list[int]] = {}
    for i, stream in enumerate(streams):
        by_length.setdefault(len(stream), []).append(i)
    for ids in by_length.values():
        pending: IntArray = np.array(ids)
        while len(pending):
            first = int(pending[0])
            try:
                layout = parse_brep(streams[first])
            except UnreadableError as error:
                result[first] = BrepErrors(str(error))
                pending = pending[1:]
                continue
            example = np.frombuffer(streams[first], np.uint8)
            others: list[int] = []
            for begin in range(0, len(pending), _AT_A_TIME):
                some = pending[begin : begin + _AT_A_TIME]
                rows: list[int] = some.tolist()
                joined = np.frombuffer(b"".join(streams[i] for i in rows), np.uint8)
                matrix = joined.reshape(len(some), -1)
                is_alike = ~((matrix != example) & layout.fixed).any(axis=1)
                same = some[is_alike]
                others += some[~is_alike].tolist()
                if not len(same):
                    continue
                known = None if spheres is None else spheres[same]
                errors = _measure(matrix[is_alike], layout, known, origins[same])
                for i, record in zip(same.tolist(), errors, strict=True):
                    result[i] = record
            pending = np.array(others, np.int64)
    return result


def _measure(
    streams: NDArray[np.uint8], layout: BrepLayout, rows: FloatArray | None, origins: FloatArray
) -> list[BrepErrors]:
    """Errors of streams (n, bytes) of one layout; rows local to the origins, if known."""
    defects = _defects(streams, layout)
    # Defective streams may hold any number; their errors are not used.
    with np.errstate(all="ignore"):
        faces = [_face_samples(streams, face) for face in layout.faces]
        if rows is None and not layout.is_closed:
            origins = faces[0].vertices.mean(1)
            rows = _fit_spheres(faces[0], origins)
        first = faces[0]
        distances = np.max([_distances(samples) for samples in faces], axis=0)
        columns = [_scales(streams, layout, faces, rows), _rounding(faces), *distances.T]
        columns.append(_to_sphere(first, rows, origins))
        columns.append(_mesh_errors(streams, layout, rows, origins, defects))
        turns = np.min([samples.turns.min(axis=1) for samples in faces], axis=0)
        is_outward = np.ones(len(streams), bool)
        if rows is not None:
            facing = _facing(first, rows, origins) * np.sign(first.turns[:, 0])
            is_outward = (-facing if layout.faces[0].is_reversed else facing) > 0
        volumes = np.full(len(streams), np.nan)
        if layout.is_closed:
            volumes = brep_volumes(streams, layout)
            is_outward &= volumes > 0
    table = np.column_stack([*columns, turns, is_outward, volumes]).tolist()
    return [
        BrepErrors(defect)
        if defect
        else BrepErrors("", *row, is_counter_clockwise=turn > 0, is_outward=bool(out), volume=v)
        for defect, (*row, turn, out, v) in zip(defects, table, strict=True)
    ]


def _mesh_errors(
    streams: NDArray[np.uint8],
    layout: BrepLayout,
    rows: FloatArray | None,
    origins: FloatArray,
    defects: list[str],
) -> FloatArray:
    """Distances of the render mesh of the first face from the sphere; its defects are added."""
    mesh = layout.faces[0].mesh
    if mesh is None or rows is None:
        return np.zeros(len(streams))
    distances, found = audit_render_meshes(streams, mesh, rows, origins)
    for defect, is_bad in found:
        for i in np.flatnonzero(is_bad):
            defects[i] = defects[i] or defect
    return distances


# Numbers


def _defects(streams: NDArray[np.uint8], layout: BrepLayout) -> list[str]:
    """Why streams cannot be measured; empty where they can."""
    found = [("a number is not finite", ~finite_streams(streams, layout)[:, None])]
    found += [
        (defect, is_bad)
        for face in layout.faces
        for side in face.sides
        for defect, is_bad in _side_defects(streams, side)
    ]
    for face in layout.faces:
        found += _surface_defects(streams, face.surface)
    result = checksum_defects(streams, layout)
    for defect, is_bad in found:
        for i in np.flatnonzero(is_bad.any(1)):
            result[i] = result[i] or defect
    return result


def _side_defects(streams: NDArray[np.uint8], side: Side) -> list[tuple[str, BoolArray]]:
    found: list[tuple[str, BoolArray]] = []
    for curve, place in ((side.trim, side.trim_domain), (side.edge, side.edge_domain)):
        domain = np.hstack([stream_numbers(streams, at, 1) for at in curve.domain])
        found.append(("a curve is used in part", stream_numbers(streams, place, 2) != domain))
        found.append(("a curve runs backwards", np.diff(domain) <= 0))
    for name, curve in (("a trim", side.trim), ("an edge", side.edge)):
        if curve.n_knots:
            size = curve.dimension + 1
            numbers = stream_numbers(streams, curve.points, size * curve.n_points)
            knots = stream_numbers(streams, curve.knots, curve.n_knots)
            is_off = _off_bezier(knots, curve.order - 1)
            found.append((f"{name} is not made of Bézier spans", is_off))
            found.append(("a weight is not positive", numbers[:, size - 1 :: size] <= 0))
    return found


def _surface_defects(
    streams: NDArray[np.uint8], surface: Surface
) -> list[tuple[str, BoolArray]]:
    if surface.uuid == PLANE_SURFACE:
        domains, extents = np.split(stream_numbers(streams, surface.knots[0], 8), 2, axis=1)
        return [("the extents of a plane are not its domains", domains != extents)]
    n_u, n_v = surface.n_points
    weights = stream_numbers(streams, surface.points, 4 * n_u * n_v)[:, 3::4]
    found = [("a weight is not positive", weights <= 0)]
    for axis, order in enumerate(surface.orders):
        is_off = _off_bezier(surface_knots(streams, surface, axis), order - 1)
        found.append(("the surface is not made of Bézier spans", is_off))
    return found


def _off_bezier(knots: FloatArray, degree: int) -> BoolArray:
    """Where knots (n, ...) are not as often as the degree, or do not increase between spans."""
    spans = knots.reshape(len(knots), -1, degree)
    is_apart = (spans != spans[..., :1]).any(axis=2)
    return np.hstack([is_apart, np.diff(spans[..., 0], axis=1) <= 0])


# Geometry


@dataclass(frozen=True)
class _Samples:
    """Points of a face of n Breps of one layout, which has k sides.

    `vertices` (n, k, 3) where the sides begin, and `ends` (n, k, 2, 3) where each begins and
    ends; `edges` (n, m, 3) in the sense of the loops, and `edge_ends` (n, k, 2, 3); `trims`
    (n, q, 3) lifted to the surface, and `trim_ends`; `off_edges` (n, k) largest distances of
    lifted trims from their edges, `interior` (n, p, 3) points of the surface, `turns` signed
    areas (n, loops) in (u, v), those of holes negated.
    """

    vertices: FloatArray
    ends: FloatArray
    edges: FloatArray
    edge_ends: FloatArray
    trims: FloatArray
    trim_ends: FloatArray
    off_edges: FloatArray
    interior: FloatArray
    turns: FloatArray


def _face_samples(streams: NDArray[np.uint8], face: Face) -> _Samples:
    sides = face.sides
    ends = [[stream_numbers(streams, at, 3) for at in (side.start, side.end)] for side in sides]
    uv = [trim_points(streams, side.trim) for side in sides]
    lifted = surface_points(streams, face.surface, np.concatenate(uv, 1))
    trims = np.split(lifted, np.cumsum([points.shape[1] for points in uv])[:-1], axis=1)
    edges = [edge_points(streams, side.edge) for side in sides]
    edges = [
        points[:, ::-1] if side.is_reversed else points
        for side, points in zip(sides, edges, strict=True)
    ]
    off_edges = [
        distances_to_edge(streams, side.edge, points).max(1)
        for side, points in zip(sides, trims, strict=True)
    ]
    bounds = np.cumsum([0, *(len(loop) for loop in face.loops)])
    outlines = [
        np.concatenate([points[:, :-1] for points in uv[first:last]], 1)
        for first, last in pairwise(bounds.tolist())
    ]
    center = outlines[0].mean(1, keepdims=True)
    halfway = np.concatenate([center, (outlines[0] + center) / 2], 1)
    turns = [_signed_areas(outline) for outline in outlines]
    return _Samples(
        np.stack([start for start, _ in ends], 1),
        np.stack([np.stack(pair, 1) for pair in ends], 1),
        np.concatenate(edges, 1),
        np.stack([points[:, [0, -1]] for points in edges], 1),
        lifted,
        np.stack([points[:, [0, -1]] for points in trims], 1),
        np.stack(off_edges, 1),
        surface_points(streams, face.surface, halfway),
        np.stack([turns[0], *(-turn for turn in turns[1:])], 1),
    )


def _distances(samples: _Samples) -> FloatArray:
    """Columns trim to edge and vertex, edge to vertex; (n, 3)."""
    return np.column_stack([
        samples.off_edges.max(1),
        norm(samples.trim_ends - samples.ends).max((1, 2)),
        norm(samples.edge_ends - samples.ends).max((1, 2)),
    ])  # fmt: skip


def _scales(
    streams: NDArray[np.uint8],
    layout: BrepLayout,
    faces: list[_Samples],
    rows: FloatArray | None,
) -> FloatArray:
    """What errors are relative to (n,): the radius of the first face, if it is known.

    Else the largest radius of an edge, as points of a circle are rounded as its radius is; or
    the size of the largest face.
    """
    points = [samples.edges for samples in faces]
    sizes = [2 * norm(x - x.mean(1, keepdims=True)).max(1) for x in points]
    size = np.max(sizes, axis=0)
    if rows is not None:
        curvatures = 2 * np.abs(rows[:, 0])
        return np.where(curvatures * size > EPSILON, 1 / curvatures, size)
    arcs = [side.edge for face in layout.faces for side in face.sides]
    radii = [
        stream_numbers(streams, arc.points, 17)[:, -1] for arc in arcs if arc.uuid == ARC_CURVE
    ]
    largest = np.max([size, *radii], axis=0)
    return np.minimum(largest, _LARGEST_RADIUS * size)


def _rounding(faces: list[_Samples]) -> FloatArray:
    largest = np.max([np.abs(samples.vertices).max((1, 2)) for samples in faces], axis=0)
    return _ROUNDING * EPSILON * largest


def _to_sphere(samples: _Samples, rows: FloatArray | None, origins: FloatArray) -> FloatArray:
    """How far vertices, edges and surface of a face are from its sphere, (n,)."""
    if rows is None:
        return np.zeros(len(samples.vertices))
    points = [samples.vertices, samples.edges, samples.trims, samples.interior]
    local = np.concatenate(points, 1) - origins[:, None]
    return np.abs(signed_distance(rows[:, None], local)).max(1)


def _fit_spheres(samples: _Samples, origins: FloatArray) -> FloatArray:
    """Unit rows, local to the origins, of the spheres that surfaces lie on."""
    count = len(origins)
    points = np.concatenate([samples.trims, samples.interior], 1)
    points = points - origins[:, None]
    size = norm(points).max(1)[:, None]
    points = np.nan_to_num(points / size[:, None])
    # Null vectors of the sphere equation A |x|² - B·x + C at all points.
    system = np.dstack([dot(points, points), -points, np.ones(points.shape[:2])])
    rows = np.linalg.svd(system, full_matrices=False)[2][:, -1]
    rows = rows * np.hstack([1 / size, np.ones((count, 3)), size])
    length = np.sqrt(minkowski(rows, rows))[:, None]
    rows = rows / length
    return rows * np.sign(_facing(samples, rows, origins))[:, None]


def _facing(samples: _Samples, rows: FloatArray, origins: FloatArray) -> FloatArray:
    """Positive where the loop runs counter-clockwise about N of the rows, (n,)."""
    center = samples.vertices.mean(1)
    spokes = samples.edges - center[:, None]
    normal = np.cross(spokes, np.roll(spokes, -1, 1)).sum(1)
    return dot(normal, normals(rows, center - origins))


def _signed_areas(outlines: FloatArray) -> FloatArray:
    spokes = outlines - outlines.mean(1, keepdims=True)
    following = np.roll(spokes, -1, 1)
    return (spokes[..., 0] * following[..., 1] - spokes[..., 1] * following[..., 0]).sum(1) / 2
