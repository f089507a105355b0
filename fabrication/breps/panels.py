"""Panels as boundary representations: spheres, planes, circles and lines, all exact.

Every part is made about the rounded origin of its panel, wherever the model stands on the site:
the remainder is in its own numbers, and no digit is lost. The sphere of a face has its axes
turned so that the panel lies away from the seam and the poles.
"""

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, unit
from ...kernel.panels.panels import Panels, panel_arcs
from ...kernel.spheres.arcs import Arcs, arc_circles
from ...kernel.spheres.rows import center_radius
from .panel_geometry import surface_frames
from .records import (
    BrepBatch,
    EdgeBatch,
    FaceBatch,
    Ring,
    batches_by_kind,
    brep_batch,
    circle_numbers,
)


def panel_batches(panels: Panels) -> list[BrepBatch]:
    """A face per panel, or a closed solid where panels have a thickness, about their origins.

    Panels need finite numbers. Faces are oriented along N, solids outwards: a solid has the
    outer face, the concentric inner face and a plane wall per edge.
    """
    outer = _Layer(panels, panels.spheres, panel_arcs(panels))
    if not panels.thickness > 0:
        return batches_by_kind(_kinds(panels, [outer]), lambda ids: _surfaces(outer, ids))
    inner = _Layer(panels, panels.inner_spheres, panel_arcs(panels, "inner"))
    return batches_by_kind(
        _kinds(panels, [outer, inner]), lambda ids: _solids(panels, outer, inner, ids)
    )


class _Layer:
    """Numbers of the outer or inner faces of panels and of their edges."""

    def __init__(self, panels: Panels, rows: FloatArray, arcs: Arcs) -> None:
        self.offsets, self.points = panels.offsets, arcs.starts
        self.sides = np.sign(rows[:, 0])
        frames = surface_frames(rows, arcs, panels.offsets)
        centers, squares = center_radius(rows)
        self.planes = np.concatenate([frames[:, 2], frames[:, 0]], axis=1)
        self.spheres = np.column_stack([centers, self.planes, np.sqrt(squares)])
        circles = arc_circles(arcs)
        self.is_line = np.isinf(circles.radii)
        self.lines = unit(arcs.ends - arcs.starts)
        self.circles = circle_numbers(arcs, circles)

    def edge(self, ids: IntArray, start: int, end: int, first: int) -> EdgeBatch:
        """Edge from a corner to another of panels that are alike; their corners from first."""
        rows = self.offsets[ids] + start
        if self.is_line[rows[0]]:
            return EdgeBatch(first + start, first + end, "LINE", self.lines[rows])
        return EdgeBatch(first + start, first + end, "CIRCLE", self.circles[rows])

    def face(self, ids: IntArray, ring: Ring, first: int, *, is_along: bool) -> FaceBatch:
        """Face along N or against it."""
        side = self.sides[ids[0]]
        if side == 0:
            return FaceBatch("PLANE", self._plane(ids, is_along=is_along), ring, corner=first)
        # N points away from the centre where the sphere bulges to the outer side.
        numbers = self.spheres[ids]
        return FaceBatch("SPHERICAL_SURFACE", numbers, ring, bool(side < 0) == is_along)

    def _plane(self, ids: IntArray, *, is_along: bool) -> FloatArray:
        return self.planes[ids] * np.repeat([1.0 if is_along else -1.0, 1.0], 3)


def _kinds(panels: Panels, layers: list[_Layer]) -> FloatArray:
    """Degree, and the kinds of surfaces and edges, of each panel."""
    owners, width = panels.corner_panels, int(panels.degrees.max(initial=0))
    within = np.arange(len(owners)) - panels.offsets[owners]
    columns = [panels.degrees.astype(float), *(layer.sides for layer in layers)]
    lines = np.zeros((panels.n_panels, len(layers), width))
    for i, layer in enumerate(layers):
        lines[owners, i, within] = layer.is_line
    return np.column_stack([*columns, lines.reshape(panels.n_panels, -1)])


def _ring(degree: int) -> list[tuple[int, int]]:
    return [(i, (i + 1) % degree) for i in range(degree)]


def _surfaces(outer: _Layer, ids: IntArray) -> BrepBatch:
    degree = int(outer.offsets[ids[0] + 1] - outer.offsets[ids[0]])
    corners: list[FloatArray] = [outer.points[outer.offsets[ids] + i] for i in range(degree)]
    edges = [outer.edge(ids, i, j, 0) for i, j in _ring(degree)]
    ring = tuple((i, True) for i in range(degree))
    face = outer.face(ids, ring, 0, is_along=True)
    return brep_batch(ids, corners, edges, [face], is_solid=False)


def _solids(panels: Panels, outer: _Layer, inner: _Layer, ids: IntArray) -> BrepBatch:
    """Corners and edges are the outer ones, then the inner ones; then come the posts."""
    first = panels.offsets[ids]
    degree = int(panels.degrees[ids[0]])
    ring = _ring(degree)
    corners = [layer.points[first + i] for layer in (outer, inner) for i in range(degree)]
    edges = [outer.edge(ids, i, j, 0) for i, j in ring]
    edges += [inner.edge(ids, i, j, degree) for i, j in ring]
    edges += [
        EdgeBatch(degree + i, i, "LINE", unit(corners[i] - corners[degree + i]))
        for i in range(degree)
    ]
    upper: Ring = tuple((i, True) for i in range(degree))
    lower: Ring = tuple((degree + i, False) for i in reversed(range(degree)))
    faces = [
        outer.face(ids, upper, 0, is_along=True),
        inner.face(ids, lower, degree, is_along=False),
    ]
    for i, j in ring:
        normals = -panels.plane_normals[first + i]
        numbers = np.concatenate([normals, unit(corners[j] - corners[i])], axis=1)
        wall = (degree + i, True), (2 * degree + j, True), (i, False), (2 * degree + i, False)
        faces.append(FaceBatch("PLANE", numbers, wall, corner=i))
    return brep_batch(ids, corners, edges, faces)
