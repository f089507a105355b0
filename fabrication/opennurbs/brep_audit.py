"""Judges one-faced Breps from their bytes alone, before they reach a file.

openNURBS calls a Brep valid whose vertex is off by a thousandth, whose surface is shifted or
whose loop runs backwards. Here the stream (layout: `brep_writer`) is parsed afresh,
with its checksums, and trims, edges, vertices and sphere are evaluated and compared.

Streams of the same layout are judged together: the first is parsed, the others must equal it in
every byte that is neither a float64 nor a checksum.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm
from ...kernel.spheres.incidence import normals, signed_distance
from ...kernel.spheres.minkowski import minkowski
from ...kernel.tolerances import EPSILON, EXACT_BREP
from .brep_evaluation import (
    distances_to_edge,
    edge_points,
    stream_numbers,
    surface_points,
    trim_points,
)
from .brep_layout import BrepLayout, Side, Surface
from .brep_reader import parse_brep
from .render_mesh_audit import audit_render_meshes
from .stream_codes import CRC, PLANE_SURFACE, Checksum
from .stream_reader import UnreadableError

_ROUNDING = 16
"""Spacings of float64, at the largest coordinate, that the parts of a Brep may differ by."""


@dataclass(frozen=True)
class BrepErrors:
    """How far the parts of a Brep of one face lie apart, in model units.

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
    is_counter_clockwise: bool = False  # the loop, in (u, v)
    is_outward: bool = False  # the normal of the face agrees with N of the sphere

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

    def reason(self) -> str:
        """Why the Brep is to be refused; empty for a sound one.

        Its distances are at most `EXACT_BREP` times the scale, and rounding.
        """
        if self.defect:
            return self.defect
        allowed = EXACT_BREP * self.scale + self.rounding
        for distance, text in self._distances():
            if not distance <= allowed:
                return f"{text}: {distance:.3g} where {allowed:.3g} is allowed"
        if not self.is_counter_clockwise:
            return "the loop runs clockwise"
        return "" if self.is_outward else "the face looks inwards"


def verify_breps(
    streams: Sequence[bytes],
    spheres: FloatArray | None = None,
    origins: FloatArray | None = None,
) -> list[BrepErrors]:
    """Errors of Breps, measured from their bytes; those of the same layout together.

    Takes P `ON_Brep` of one face and one loop, as written by `brep_streams` or by openNURBS;
    unit rows (P, 5) that the faces must lie on, by default those of the surfaces; and origins
    (P, 3) of the coordinates of the rows, by default the model's own. A stream that cannot be
    read has a defect and no errors.
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
            waiting: list[int] = pending.tolist()
            matrix = np.frombuffer(b"".join(streams[i] for i in waiting), np.uint8)
            matrix = matrix.reshape(len(pending), -1)
            is_alike = (matrix[:, layout.fixed] == matrix[0, layout.fixed]).all(1)
            same, pending = pending[is_alike], pending[~is_alike]
            rows = None if spheres is None else spheres[same]
            errors = _measure(matrix[is_alike], layout, rows, origins[same])
            for i, record in zip(same, errors, strict=True):
                result[i] = record
    return result


def _measure(
    streams: NDArray[np.uint8], layout: BrepLayout, rows: FloatArray | None, origins: FloatArray
) -> list[BrepErrors]:
    """Errors of streams (n, bytes) of one layout; rows local to the origins, if known."""
    defects = _defects(streams, layout)
    # Defective streams may hold any number; their errors are not used.
    with np.errstate(all="ignore"):
        samples = _samples(streams, layout)
        if rows is None:
            origins = samples.vertices.mean(1)
            rows = _fit_spheres(samples, origins)
        distances = _distances(samples, rows, origins)
        on_meshes = np.zeros(len(streams))
        if layout.mesh is not None:
            on_meshes, found = audit_render_meshes(streams, layout.mesh, rows, origins)
            for defect, is_bad in found:
                for i in np.flatnonzero(is_bad):
                    defects[i] = defects[i] or defect
        distances = np.column_stack([distances, on_meshes])
        turns = _signed_areas(samples.outlines)
        faces = _facing(samples, rows, origins) * np.sign(turns)
        if layout.is_reversed:
            faces = -faces
    return [
        BrepErrors(defect)
        if defect
        else BrepErrors("", *row, is_counter_clockwise=turn > 0, is_outward=face > 0)
        for defect, row, turn, face in zip(
            defects, distances.tolist(), turns.tolist(), faces.tolist(), strict=True
        )
    ]


# Numbers


def _defects(streams: NDArray[np.uint8], layout: BrepLayout) -> list[str]:
    """Why streams cannot be measured; empty where they can."""
    found = [
        ("a number is not finite", ~np.isfinite(stream_numbers(streams, *at)))
        for at in layout.numbers
    ]
    found += [
        (defect, is_bad)
        for side in layout.sides
        for defect, is_bad in _side_defects(streams, side)
    ]
    found += _surface_defects(streams, layout.surface)
    result = _checksum_defects(streams, layout.checksums)
    for defect, is_bad in found:
        for i in np.flatnonzero(is_bad.any(1)):
            result[i] = result[i] or defect
    return result


def _checksum_defects(streams: NDArray[np.uint8], checksums: tuple[Checksum, ...]) -> list[str]:
    result = [""] * len(streams)
    for i, row in enumerate(streams):
        data = memoryview(row.tobytes())
        for checksum in checksums:
            if CRC.unpack_from(data, checksum.place)[0] != checksum.compute(data):
                result[i] = f"the checksum at byte {checksum.place} is wrong"
                break
    return result


def _side_defects(streams: NDArray[np.uint8], side: Side) -> list[tuple[str, BoolArray]]:
    found: list[tuple[str, BoolArray]] = []
    for curve, place in ((side.trim, side.trim_domain), (side.edge, side.edge_domain)):
        domain = np.hstack([stream_numbers(streams, at, 1) for at in curve.domain])
        found.append(("a curve is used in part", stream_numbers(streams, place, 2) != domain))
        found.append(("a curve runs backwards", np.diff(domain) <= 0))
    trim = side.trim
    if trim.n_knots:
        weights = stream_numbers(streams, trim.points, 3 * trim.n_points)[:, 2::3]
        knots = stream_numbers(streams, trim.knots, trim.n_knots)
        found.append(("a trim is not made of Bézier spans", _off_bezier(knots)))
        found.append(("a weight is not positive", weights <= 0))
    return found


def _surface_defects(
    streams: NDArray[np.uint8], surface: Surface
) -> list[tuple[str, BoolArray]]:
    if surface.uuid == PLANE_SURFACE:
        domains, extents = np.split(stream_numbers(streams, surface.knots[0], 8), 2, axis=1)
        return [("the extents of a plane are not its domains", domains != extents)]
    n_u, n_v = surface.n_points
    weights = stream_numbers(streams, surface.points, 4 * n_u * n_v)[:, 3::4]
    knots = [
        stream_numbers(streams, place, count + 1)
        for place, count in zip(surface.knots, surface.n_points, strict=True)
    ]
    return [
        ("a weight is not positive", weights <= 0),
        *(("the surface is not made of Bézier spans", _off_bezier(k)) for k in knots),
    ]


def _off_bezier(knots: FloatArray) -> BoolArray:
    """Where knots (n, 2 m) are not double, or do not increase from span to span."""
    first, second = knots[:, ::2], knots[:, 1::2]
    return np.hstack([first != second, np.diff(first, axis=1) <= 0])


# Geometry


@dataclass(frozen=True)
class _Samples:
    """Points of n Breps of one layout with k sides.

    `vertices` (n, k, 3) in the order of the loop, `edges` (n, k, m, 3), `trims` (n, k, q, 3)
    lifted to the surface, `off_edges` (n, k) largest distances of lifted trims from their
    edges, `interior` (n, p, 3) points of the surface, `outlines` (n, p, 2) of the loops in
    (u, v).
    """

    vertices: FloatArray
    edges: FloatArray
    trims: FloatArray
    off_edges: FloatArray
    interior: FloatArray
    outlines: FloatArray


def _samples(streams: NDArray[np.uint8], layout: BrepLayout) -> _Samples:
    sides = layout.sides
    vertices = np.stack([stream_numbers(streams, side.start, 3) for side in sides], 1)
    uv = [trim_points(streams, side.trim) for side in sides]
    trims = [surface_points(streams, layout.surface, points) for points in uv]
    off_edges = [
        distances_to_edge(streams, side.edge, points).max(1)
        for side, points in zip(sides, trims, strict=True)
    ]
    outlines = np.concatenate([points[:, :-1] for points in uv], 1)
    center = outlines.mean(1, keepdims=True)
    halfway = np.concatenate([center, (outlines + center) / 2], 1)
    return _Samples(
        vertices,
        np.stack([edge_points(streams, side.edge) for side in sides], 1),
        np.stack(trims, 1),
        np.stack(off_edges, 1),
        surface_points(streams, layout.surface, halfway),
        outlines,
    )


def _distances(samples: _Samples, rows: FloatArray, origins: FloatArray) -> FloatArray:
    """Columns scale, rounding, trim to edge and vertex, edge to vertex, to sphere; (n, 6)."""
    starts = samples.vertices
    ends = np.stack([starts, np.roll(starts, -1, 1)], 2)
    count = len(starts)
    points = [starts, samples.edges, samples.trims, samples.interior]
    local = np.concatenate([x.reshape(count, -1, 3) for x in points], 1) - origins[:, None]
    size = 2 * norm(starts - starts.mean(1, keepdims=True)).max(1)
    curvatures = 2 * np.abs(rows[:, 0])
    is_curved = curvatures * size > EPSILON
    return np.column_stack([
        np.where(is_curved, 1 / curvatures, size),
        _ROUNDING * EPSILON * np.abs(starts).max((1, 2)),
        samples.off_edges.max(1),
        norm(samples.trims[:, :, [0, -1]] - ends).max((1, 2)),
        norm(samples.edges[:, :, [0, -1]] - ends).max((1, 2)),
        np.abs(signed_distance(rows[:, None], local)).max(1),
    ])  # fmt: skip


def _fit_spheres(samples: _Samples, origins: FloatArray) -> FloatArray:
    """Unit rows, local to the origins, of the spheres that surfaces lie on."""
    count = len(origins)
    points = np.concatenate([samples.trims.reshape(count, -1, 3), samples.interior], 1)
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
    spokes = samples.edges.reshape(len(center), -1, 3) - center[:, None]
    normal = np.cross(spokes, np.roll(spokes, -1, 1)).sum(1)
    return dot(normal, normals(rows, center - origins))


def _signed_areas(outlines: FloatArray) -> FloatArray:
    spokes = outlines - outlines.mean(1, keepdims=True)
    following = np.roll(spokes, -1, 1)
    return (spokes[..., 0] * following[..., 1] - spokes[..., 1] * following[..., 0]).sum(1) / 2
