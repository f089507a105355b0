"""Writes the outer faces of panels as openNURBS Breps: exact trimmed spheres, byte by byte.

rhino3dm can read any Brep but builds only simple ones; it decodes the streams made here. The
layout is that of openNURBS, which is public (`opennurbs_3dm.h` for type codes,
`opennurbs_brep_io.cpp`, `opennurbs_arccurve.cpp`, `opennurbs_linecurve.cpp`,
`opennurbs_nurbscurve.cpp`, `opennurbs_nurbssurface.cpp`, `opennurbs_planesurface.cpp`); chunks
and objects are those of `stream_codes`. An object begins with one byte, 16 x major +
minor version:

- `ON_LineCurve` 1.0: from ddd, to ddd, domain dd, i dimension.
- `ON_ArcCurve` 1.0: plane (origin, x, y, z axes, equation: 16 d), d radius, three points of the
  circle (9 d), angles dd, domain dd, i dimension.
- `ON_NurbsCurve` 1.1: i dimension, i rational, i order, i points, ii reserved, box 6 d, counted
  knots, counted homogeneous points, one byte.
- `ON_NurbsSurface` 1.0: i dimension, i rational, ii orders, ii points, ii reserved, box 6 d,
  counted knots of u, of v, counted homogeneous points (v runs fastest).
- `ON_PlaneSurface` 1.1: plane 16 d, domains of u and v, extents of u and v (dd each).
- `ON_Brep` 3.3: anonymous chunks with version byte and count: curves in (u,v), curves in space
  and surfaces (each ``i 1`` and the object), vertices, edges, trims, loops, faces; then the
  box 6 d, chunks of render and analysis meshes (per face one byte 0, or 1 and the mesh),
  i solid, a chunk with the region topology (none). The records are in `_brep`.

Knot vectors of openNURBS lack the first and last knot of other notations.
"""

from collections.abc import Iterator

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, norm, unit
from ...kernel.panels.panels import Panels, panel_arcs
from ...kernel.spheres.arcs import ArcCircles, Arcs, arc_circles, arc_lengths
from . import stream_codes as codes
from .render_meshes import RenderMeshes, mesh_numbers, mesh_object
from .sphere_patches import (
    PanelCharts,
    panel_charts,
    patch_control_points,
    select_charts,
    span_counts,
    trim_control_points,
)
from .stream_writer import Chunk, Piece, Slot, class_object, doubles, fill, ints, table


def brep_streams(panels: Panels, meshes: RenderMeshes | None = None) -> list[bytes]:
    """Outer faces of panels, each as the stream of one `ON_Brep`, with render meshes if given.

    In model coordinates; the normal of a Brep is N of its panel. Batched over the panels of one
    degree; about 0.05 ms and 4 kB per panel. Patches that open far or whose trims sweep far are
    cut into 2 x 2 spans, so that all weights are positive.
    """
    arcs = panel_arcs(panels)
    curves = _edge_records(panels, arcs)
    lengths = arc_lengths(arcs)
    points = panels.corners + panels.origins[panels.corner_panels]
    result = [b""] * panels.n_panels
    for group, spans, kind in _groups(panels, arcs, meshes):
        corners = group.corner_ids
        numbers = {
            "vertex": points[corners],
            "edge": lengths[corners],
            "curve": curves[corners],
            **_patch_numbers(group, spans),
        }
        face_mesh: tuple[Piece, ...] = (b"\0",)
        if meshes is not None:
            numbers |= mesh_numbers(meshes, group.ids)
            face_mesh = (b"\1", mesh_object(meshes, kind))
        brep = _brep(int(corners.shape[1]), spans, face_mesh)
        for panel, stream in zip(group.ids, fill(brep, numbers), strict=True):
            result[panel] = stream
    return result


def face_streams(panels: Panels) -> tuple[list[bytes], list[bytes]]:
    """Surfaces and trims of the outer faces, to be joined.

    P surfaces in model coordinates, and H trims over [-1, 1] in (u, v), one per corner.
    """
    surfaces, trims = [b""] * panels.n_panels, [b""] * len(panels.corners)
    for group, spans, _ in _groups(panels, panel_arcs(panels), None):
        numbers = _patch_numbers(group, spans)
        for panel, stream in zip(group.ids, fill(_surface(spans), numbers), strict=True):
            surfaces[panel] = stream
        for side, corners in enumerate(group.corner_ids.T):
            filled = fill(_trim_curve(side, spans), numbers)
            for corner, stream in zip(corners, filled, strict=True):
                trims[corner] = stream
    return surfaces, trims


def _groups(
    panels: Panels, arcs: Arcs, meshes: RenderMeshes | None
) -> Iterator[tuple[PanelCharts, int, int]]:
    """Panels whose streams have one layout, their spans and the kind of their meshes."""
    degrees: list[int] = np.unique(panels.degrees).tolist()
    for degree in degrees:
        charts = panel_charts(panels, arcs, np.flatnonzero(panels.degrees == degree))
        spans = span_counts(charts)
        kinds = np.zeros_like(spans) if meshes is None else meshes.kinds[charts.ids]
        pairs: list[list[int]] = np.unique(np.stack([spans, kinds], 1), axis=0).tolist()
        for count, kind in pairs:
            yield select_charts(charts, (spans == count) & (kinds == kind)), count, kind


def edge_streams(panels: Panels) -> list[bytes]:
    """Edges of the outer faces, each as the stream of an `ON_ArcCurve` or `ON_LineCurve`.

    H objects, in model coordinates, from corner h to the next.
    """
    is_line = panels.spheres[panels.corner_panels, 0] == 0
    return _curve_streams(_edge_records(panels, panel_arcs(panels)), is_line)


def arc_streams(arcs: Arcs) -> list[bytes]:
    """Arcs, each as the stream of an `ON_ArcCurve`; of an `ON_LineCurve` if it is straight."""
    circles, lengths, no_shift = arc_circles(arcs), arc_lengths(arcs), 0 * arcs.starts
    is_line = np.isinf(circles.radii)
    records = np.zeros((len(lengths), 30))
    records[is_line, :8] = _line_records(arcs, no_shift, lengths)[is_line]
    bent = ArcCircles(*(values[~is_line] for values in vars(circles).values()))
    starts, shift = arcs.starts[~is_line], no_shift[~is_line]
    records[~is_line] = _arc_records(bent, starts, shift, lengths[~is_line])
    return _curve_streams(records, is_line)


def line_streams(segments: FloatArray) -> list[bytes]:
    """Segments (n, 2, 3), each as the stream of an `ON_LineCurve`."""
    zero = np.zeros(len(segments))
    lengths = norm(segments[:, 1] - segments[:, 0])
    records = np.column_stack([segments.reshape(-1, 6), zero, lengths])
    return _curve_streams(records, np.ones(len(segments), bool))


def circle_streams(
    centers: FloatArray, x: FloatArray, axes: FloatArray, radii: FloatArray
) -> list[bytes]:
    """Whole circles about unit axes (n, 3), each as the stream of an `ON_ArcCurve`.

    They begin along unit vectors x (n, 3).
    """
    sweeps = np.full(len(centers), 2 * np.pi)
    circles = ArcCircles(centers, axes, radii, sweeps)
    starts = centers + radii[:, None] * x
    records = _arc_records(circles, starts, 0 * centers, sweeps * radii)
    return _curve_streams(records, np.zeros(len(centers), bool))


def _curve_streams(records: FloatArray, is_line: BoolArray) -> list[bytes]:
    result = [b""] * len(records)
    for is_straight in np.unique(is_line).tolist():
        ids = np.flatnonzero(is_line == is_straight)
        curve = _edge_curve(0, is_straight=is_straight)
        streams = fill(curve, {"curve": records[ids, None]})
        for edge, stream in zip(ids.tolist(), streams, strict=True):
            result[edge] = stream
    return result


# Bytes

EMPTY_BOX = doubles(1, 0, 0, -1, 0, 0)


def _edge_curve(edge: int, *, is_straight: bool) -> Chunk:
    if is_straight:
        return class_object(codes.LINE_CURVE, b"\x10", Slot("curve", edge, 8), ints(3))
    return class_object(codes.ARC_CURVE, b"\x10", Slot("curve", edge, 30), ints(3))


def _trim_curve(trim: int, spans: int) -> Chunk:
    if spans == 0:
        return class_object(codes.LINE_CURVE, b"\x10", Slot("trim", trim, 8), ints(2))
    count = 2 * spans + 1
    knots = doubles(*np.repeat(np.linspace(-1, 1, spans + 1), 2))
    head = ints(2, 1, 3, count, 0, 0) + EMPTY_BOX
    points = Slot("trim", trim, 3 * count)
    return class_object(
        codes.NURBS_CURVE, b"\x11", head, ints(count + 1), knots, ints(count), points, b"\0"
    )


def _surface(spans: int) -> Chunk:
    if spans == 0:
        return class_object(codes.PLANE_SURFACE, b"\x11", Slot("patch", 0, 24))
    count = 2 * spans + 1
    head = ints(3, 1, 3, 3, count, count, 0, 0) + EMPTY_BOX
    knots_u, knots_v = Slot("knots", 0, count + 1), Slot("knots", 1, count + 1)
    points = Slot("patch", 0, 4 * count * count)
    return class_object(
        codes.NURBS_SURFACE, b"\x10", head, ints(count + 1), knots_u, ints(count + 1), knots_v,
        ints(count * count), points,
    )  # fmt: skip


def _brep(k: int, spans: int, face_mesh: tuple[Piece, ...]) -> Chunk:
    """A Brep of one face with k edges; `spans` of its trims and surface, 0 for a plane."""
    one = ints(1)
    sides = range(k)
    trims = [(one, _trim_curve(i, spans)) for i in sides]
    curves = [(one, _edge_curve(i, is_straight=spans == 0)) for i in sides]
    # index, point, edges that meet here, tolerance
    vertices = [
        (ints(i), Slot("vertex", i, 3), ints(2, (i - 1) % k, i), doubles(0)) for i in sides
    ]
    # index, curve, reversed, domain of the curve, vertices, trims, tolerance, domain
    edges = [
        (
            ints(i, i, 0), doubles(0), Slot("edge", i, 1), ints(i, (i + 1) % k, 1, i),
            doubles(0, 0), Slot("edge", i, 1),
        )
        for i in sides
    ]  # fmt: skip
    # index, curve, domain of the curve, edge, vertices, reversed, type, iso, loop, tolerances,
    # domain, flags of the proxy, legacy tolerances
    uses = [
        (
            ints(i, i) + doubles(-1, 1) + ints(i, i, (i + 1) % k, 0, codes.BOUNDARY_TRIM, 0, 0)
            + doubles(0, 0, -1, 1) + bytes(32) + doubles(0, 0),
        )
        for i in sides
    ]  # fmt: skip
    # index, trims, type, face
    loop = ints(0, k, *sides, codes.OUTER_LOOP, 0)
    # index, loops, surface, reversed, material channel; then the face's uuid
    face = ints(0, 1, 0, 0, 0, 0) + bytes(16)
    return class_object(
        codes.BREP, b"\x33", table(0, trims), table(0, curves),
        table(0, [(one, _surface(spans))]), table(0, vertices), table(0, edges),
        table(0, uses), table(0, [(loop,)]), table(1, [(face,)]), Slot("box", 0, 6),
        Chunk(codes.ANONYMOUS, face_mesh), Chunk(codes.ANONYMOUS, (b"\0",)), ints(0),
        Chunk(codes.ANONYMOUS, (ints(1, 1), b"\0")),
    )  # fmt: skip


# Geometry


def _edge_records(panels: Panels, arcs: Arcs) -> FloatArray:
    """Numbers of the edges, (H, 30): an arc's plane, circle and domains, or a line's."""
    shift = panels.origins[panels.corner_panels]
    records = np.zeros((len(shift), 30))
    lengths = arc_lengths(arcs)
    is_line = panels.spheres[panels.corner_panels, 0] == 0
    records[is_line, :8] = _line_records(arcs, shift, lengths)[is_line]
    circles = arc_circles(arcs)
    bent = ArcCircles(*(values[~is_line] for values in vars(circles).values()))
    bent_starts, bent_shift = arcs.starts[~is_line], shift[~is_line]
    records[~is_line] = _arc_records(bent, bent_starts, bent_shift, lengths[~is_line])
    return records


def _line_records(arcs: Arcs, shift: FloatArray, lengths: FloatArray) -> FloatArray:
    return np.column_stack([arcs.starts + shift, arcs.ends + shift, 0 * lengths, lengths])


def _arc_records(
    circles: ArcCircles, starts: FloatArray, shift: FloatArray, lengths: FloatArray
) -> FloatArray:
    x_axes = unit(starts - circles.centers)
    y_axes = np.cross(circles.axes, x_axes)
    centers = circles.centers + shift
    to_x, to_y = circles.radii[:, None] * x_axes, circles.radii[:, None] * y_axes
    zero = np.zeros_like(lengths)
    return np.column_stack([
        plane_records(centers, x_axes, y_axes, circles.axes), circles.radii,
        centers + to_x, centers + to_y, centers - to_x, zero, circles.sweeps, zero, lengths,
    ])  # fmt: skip


def plane_records(
    origins: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray
) -> FloatArray:
    """Records of `ON_Plane`, (n, 16)."""
    # openNURBS refuses a plane whose equation does not vanish at its origin; summed in its own
    # order it does so exactly, wherever the site lies.
    level = z[:, 0] * origins[:, 0] + z[:, 1] * origins[:, 1] + z[:, 2] * origins[:, 2]
    return np.column_stack([origins, x, y, z, z, -level])


def _patch_numbers(charts: PanelCharts, spans: int) -> dict[str, FloatArray]:
    """Trims, surface and box of panels whose patches have the same number of spans."""
    share = np.repeat(np.linspace(-1, 1, max(spans, 1) + 1), 2)
    knots = charts.reaches[..., None] * share
    net = patch_control_points(charts, knots)
    hull = (net[..., :3] / net[..., 3:]).reshape(len(net), -1, 3)
    box = np.concatenate([hull.min(1), hull.max(1)], 1)
    if spans == 0:
        e1, e2, n_axes = charts.frames.transpose(1, 0, 2)
        plane = plane_records(charts.origins, e1, e2, n_axes)
        domains = knots[..., 1:3].reshape(-1, 4)
        patch, trims = np.column_stack([plane, domains, domains]), _line_trims(charts)
    else:
        patch, trims = net, trim_control_points(charts, spans)
    return {"trim": trims, "knots": knots, "patch": patch[:, None], "box": box[:, None]}


def _line_trims(charts: PanelCharts) -> FloatArray:
    """Numbers of straight trims, (P, k, 8)."""
    ends = np.roll(charts.uv, -1, 1)
    zero = np.zeros((*ends.shape[:2], 1))
    return np.concatenate([charts.uv, zero, ends, zero, zero - 1, zero + 1], 2)
