"""Points along the edges of panels, once for each edge that two panels have in common.

Triangles of neighbours then meet to the bit: no light falls between them, and a closed model is
a closed net of triangles. Edges with a joint or a gap between them stay two.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, norm
from ..solvers.weighted_graphs import piece_labels
from ..spheres.arcs import Arcs, arc_points
from ..tolerances import SAME_EDGE
from .panels import Panels, opposite_corners


@dataclass(frozen=True)
class Rims:
    """Points along the H edges of panels, on each side of them.

    Attributes
    ----------
    steps : (H,) int array
        Steps of each edge, the same on both sides.
    starts : (H,) int array
        First point of each edge. As many points as steps follow, without the end, which is
        the start of the next edge.
    sides : tuple of (N, 3) float array
        Points of the outer faces, and of the inner ones if they are asked for.
    """

    steps: IntArray
    starts: IntArray
    sides: tuple[FloatArray, ...]


def divide_edges(
    panels: Panels, sides: Sequence[Arcs], steps: IntArray, shifts: FloatArray
) -> Rims:
    """Divide the edges of panels.

    Parameters
    ----------
    panels : Panels
        P panels with H edges.
    sides : sequence of Arcs
        H local arcs of the outer faces, and of the inner ones if wanted.
    steps : (P,) int array
        Steps per edge that each panel needs; a common edge gets what the finer panel needs.
    shifts : (P, 3) float array
        From the local origins to the common one of the points.
    """
    owners, twins = panels.corner_panels, opposite_corners(panels)
    moved = [_moved(arcs, shifts[owners]) for arcs in sides]
    corners = [_common_corners(panels, arcs, twins) for arcs in moved]
    common = [
        _common_edges(panels, arcs, ids, twins)
        for arcs, ids in zip(moved, corners, strict=True)
    ]
    own = steps[owners]
    both = np.logical_or.reduce(common)
    counts = np.where(both, np.maximum(own, own[twins]), own)
    starts = np.cumsum(counts) - counts
    points = [
        _divided(arcs, ids, np.where(shared, twins, -1), counts, starts)
        for arcs, ids, shared in zip(moved, corners, common, strict=True)
    ]
    return Rims(counts, starts, tuple(points))


def _moved(arcs: Arcs, shifts: FloatArray) -> Arcs:
    return Arcs(arcs.starts + shifts, arcs.ends + shifts, arcs.rises, arcs.sagittas)


def _common_corners(panels: Panels, arcs: Arcs, twins: IntArray) -> IntArray:
    """Of each corner the first one that stands at the same place, itself or a neighbour's."""
    edges = np.flatnonzero(twins >= 0)
    beyond = panels.next_corners[twins[edges]]
    apart = norm(arcs.starts[edges] - arcs.starts[beyond])
    same = apart <= SAME_EDGE * norm(arcs.ends[edges] - arcs.starts[edges])
    groups = piece_labels(edges[same], beyond[same], len(twins))
    _, first = np.unique(groups, return_index=True)
    return first[groups]


def _common_edges(panels: Panels, arcs: Arcs, corners: IntArray, twins: IntArray) -> BoolArray:
    """Whether both ends of an edge and its middle are those of the neighbour's."""
    ends = corners[panels.next_corners]
    found = (twins >= 0) & (corners == ends[twins]) & (ends == corners[twins])
    tops = (arcs.starts + arcs.ends) / 2 + arcs.sagittas[:, None] * arcs.rises
    length = norm(arcs.ends - arcs.starts)
    return found & (norm(tops - tops[twins]) <= SAME_EDGE * length)


def _divided(
    arcs: Arcs, corners: IntArray, twins: IntArray, steps: IntArray, starts: IntArray
) -> FloatArray:
    """Points of all edges: those of the later twin are those of the earlier one, turned."""
    points = np.empty((int(steps.sum()), 3))
    points[starts] = arcs.starts[corners]
    for count in np.unique(steps).tolist():
        if count == 1:
            continue
        own = (steps == count) & ((twins < 0) | (twins > np.arange(len(twins))))
        edges = np.flatnonzero(own)
        chosen = Arcs(
            arcs.starts[edges], arcs.ends[edges], arcs.rises[edges], arcs.sagittas[edges]
        )
        inner = arc_points(chosen, np.linspace(-1, 1, count + 1)[1:-1])
        places: IntArray = np.arange(1, int(count))
        points[starts[edges][:, None] + places] = inner
        paired = twins[edges] >= 0
        points[starts[twins[edges][paired]][:, None] + places] = inner[paired, ::-1]
    return points
