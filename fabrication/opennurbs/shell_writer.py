"""Writes all panels joined into one Brep: neighbours share their edges and vertices.

Records are those of one-faced Breps (`brep_writer`). An edge is the arc of the first
of its two panels; how far the other one misses it is the tolerance of the edge.
"""

from collections import defaultdict
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.errors import InputError
from ...kernel.panels.panels import Panels, panel_arcs
from ...kernel.spheres.arcs import arc_lengths, arc_points
from .brep_writer import edge_streams, face_streams
from .render_meshes import RenderMeshes, mesh_streams
from .stream_codes import ANONYMOUS, BOUNDARY_TRIM, BREP, MATED_TRIM, OUTER_LOOP
from .stream_writer import Chunk, Encoded, Piece, class_object, doubles, encode, ints, table

_SAMPLES = 5


class Shell(NamedTuple):
    """A Brep of many faces, and how many edges of neighbours it leaves open."""

    stream: bytes
    n_open: int


@dataclass(frozen=True)
class _Joints:
    """What H corners of panels share.

    `edges` (H,) edge of the side that leaves each corner, `firsts` (E,) the corner whose arc
    the edge is, `is_reversed` (H,) whether the side runs against it, `edge_gaps` (E,), `ends`
    (E, 2) its vertices; `vertices` (H,), `points` (V, 3) in model coordinates and `vertex_gaps`
    (V,); `n_open` edges of neighbours that lie too far apart.
    """

    edges: IntArray
    firsts: IntArray
    is_reversed: IntArray
    edge_gaps: FloatArray
    ends: IntArray
    vertices: IntArray
    points: FloatArray
    vertex_gaps: FloatArray
    n_open: int


def join_panels(panels: Panels, largest_gap: float, meshes: RenderMeshes | None) -> Shell:
    """Outer faces of panels as one `ON_Brep`, whose face p is panel p.

    Edges of neighbours are joined if they lie at most the largest gap apart, in model units.
    Raises InputError if no two neighbours are close enough.
    """
    joints = _join(panels, largest_gap)
    if joints.n_open and not joints.is_reversed.any():
        raise InputError(
            f"all neighbours lie more than {largest_gap:.3g} apart and cannot be joined: cut "
            "them along intersections and without a joint, or write them one by one"
        )
    surfaces, trims = face_streams(panels)
    curves = edge_streams(panels)
    firsts: list[int] = joints.firsts.tolist()
    one = ints(1)
    points = panels.corners + panels.origins[panels.corner_panels]
    margin = largest_gap + np.abs(panels.spheres[:, 0]).max() * np.ptp(points, 0).max() ** 2
    box = [*(points.min(0) - margin).tolist(), *(points.max(0) + margin).tolist()]
    face_meshes: list[Piece] = [b"\0"] * panels.n_panels
    if meshes is not None:
        face_meshes = [x for mesh in mesh_streams(meshes) for x in (b"\1", Encoded(mesh))]
    brep = class_object(
        BREP, b"\x33",
        table(0, [(one, Encoded(trim)) for trim in trims]),
        table(0, [(one, Encoded(curves[first])) for first in firsts]),
        table(0, [(one, Encoded(surface)) for surface in surfaces]),
        table(0, _vertex_records(joints)),
        table(0, _edge_records(panels, joints)),
        table(0, _trim_records(panels, joints)),
        table(0, _loop_records(panels)),
        _face_table(panels),
        doubles(*box), Chunk(ANONYMOUS, tuple(face_meshes)),
        Chunk(ANONYMOUS, (bytes(panels.n_panels),)), ints(0),
        Chunk(ANONYMOUS, (ints(1, 1), b"\0")),
    )  # fmt: skip
    return Shell(encode(brep), joints.n_open)


def _join(panels: Panels, largest_gap: float) -> _Joints:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    count = len(panels.corners)
    corners: IntArray = np.arange(count)
    arcs = arc_points(panel_arcs(panels), np.linspace(-1, 1, _SAMPLES))
    arcs = arcs + panels.origins[panels.corner_panels][:, None]
    twins = _twins(panels, arcs[:, _SAMPLES // 2])
    gaps = norm(arcs - arcs[twins, ::-1]).max(1)
    is_open = (twins >= 0) & ~(gaps <= largest_gap)
    twins[is_open] = -1
    has_twin = twins >= 0
    is_first = ~has_twin | (corners < twins)
    firsts = np.flatnonzero(is_first)
    edges = np.zeros(count, np.int64)
    edges[firsts] = np.arange(len(firsts))
    edges[~is_first] = edges[twins[~is_first]]
    edge_gaps = np.zeros(len(firsts))
    second = np.flatnonzero(~is_first)
    edge_gaps[edges[second]] = gaps[second]
    turned = panels.next_corners[twins[has_twin]]
    pairs = coo_matrix((np.ones(len(turned)), (corners[has_twin], turned)), (count, count))
    n_vertices, vertices = connected_components(pairs, directed=False)
    vertices = vertices.astype(np.int64)
    _, members = np.unique(vertices, return_index=True)
    points = arcs[members, 0]
    vertex_gaps = np.zeros(n_vertices)
    np.maximum.at(vertex_gaps, vertices, norm(arcs[:, 0] - points[vertices]))
    ends = np.stack([vertices[firsts], vertices[panels.next_corners[firsts]]], 1)
    is_reversed = (~is_first).astype(np.int64)
    return _Joints(
        edges, firsts, is_reversed, edge_gaps, ends, vertices, points, vertex_gaps,
        int(is_open.sum()) // 2,
    )  # fmt: skip


def _twins(panels: Panels, middles: FloatArray) -> IntArray:
    """The corner whose side is the same edge of the neighbour; -1 where there is none."""
    faces: list[int] = panels.face_ids[panels.corner_panels].tolist()
    beyond: list[int] = panels.neighbors.tolist()
    sides: defaultdict[tuple[int, int], list[int]] = defaultdict(list)
    for corner, pair in enumerate(zip(faces, beyond, strict=True)):
        sides[pair].append(corner)
    twins = np.full(len(faces), -1)
    for corner, (face, other) in enumerate(zip(faces, beyond, strict=True)):
        found = sides.get((other, face), []) if other >= 0 else []
        if found:
            # Two panels may share several edges.
            apart = norm(middles[found] - middles[corner])
            twins[corner] = found[int(apart.argmin())]
    is_mutual = twins[np.maximum(twins, 0)] == np.arange(len(twins))
    return np.where(is_mutual & (twins >= 0), twins, -1)


def _vertex_records(joints: _Joints) -> list[tuple[bytes]]:
    """Index, point, edges that meet here, tolerance."""
    meeting: list[list[int]] = [[] for _ in joints.points]
    ends: list[list[int]] = joints.ends.tolist()
    for edge, (start, end) in enumerate(ends):
        meeting[start].append(edge)
        meeting[end].append(edge)
    rows = zip(joints.points.tolist(), meeting, joints.vertex_gaps.tolist(), strict=True)
    return [
        (ints(i) + doubles(*point) + ints(len(edges), *edges) + doubles(gap),)
        for i, (point, edges, gap) in enumerate(rows)
    ]


def _edge_records(panels: Panels, joints: _Joints) -> list[tuple[bytes]]:
    """Index, curve, reversed, domain of the curve, vertices, trims, tolerance, domain."""
    lengths: list[float] = arc_lengths(panel_arcs(panels))[joints.firsts].tolist()
    order = np.argsort(joints.edges, kind="stable")
    bounds = np.searchsorted(joints.edges[order], np.arange(1, len(joints.firsts)))
    users = [part.tolist() for part in np.split(order, bounds)]
    rows = zip(lengths, joints.ends.tolist(), users, joints.edge_gaps.tolist(), strict=True)
    return [
        (
            ints(i, i, 0) + doubles(0, length) + ints(*ends, len(trims), *trims)
            + doubles(gap, 0, length),
        )
        for i, (length, ends, trims, gap) in enumerate(rows)
    ]  # fmt: skip


def _trim_records(panels: Panels, joints: _Joints) -> list[tuple[bytes]]:
    """The records of `brep_writer`, for every side of every panel."""
    is_mated = np.bincount(joints.edges)[joints.edges] > 1
    columns = np.stack([
        joints.edges, joints.vertices, joints.vertices[panels.next_corners],
        joints.is_reversed, np.where(is_mated, MATED_TRIM, BOUNDARY_TRIM),
        0 * joints.edges, panels.corner_panels,
    ], 1)  # fmt: skip
    rows: list[list[int]] = columns.tolist()
    tail = doubles(0, 0, -1, 1) + bytes(32) + doubles(0, 0)
    return [(ints(i, i) + doubles(-1, 1) + ints(*row) + tail,) for i, row in enumerate(rows)]


def _loop_records(panels: Panels) -> list[tuple[bytes]]:
    """Index, trims, type, face."""
    bounds: list[int] = panels.offsets.tolist()
    return [
        (ints(i, last - first, *range(first, last), OUTER_LOOP, i),)
        for i, (first, last) in enumerate(pairwise(bounds))
    ]


def _face_table(panels: Panels) -> Chunk:
    """Index, loops, surface, reversed, material channel; then the ids of all faces."""
    records = (ints(i, 1, i, i, 0, 0) for i in range(panels.n_panels))
    version, count = b"\x11", ints(panels.n_panels)
    return Chunk(ANONYMOUS, (version, count, *records, bytes(16 * panels.n_panels)))
