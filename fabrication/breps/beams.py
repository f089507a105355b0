"""Beams as boundary representations: planes, cylinders, lines, circles and ellipses, all exact.

A beam has two plane sides, an outer and an inner face - cylinders, or planes where the arcs
are straight - and one or two plane faces at each end. A plane cuts a cylinder in an ellipse, or
in lines if it is parallel to the axis.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, unit
from ...kernel.beams.end_edges import EndEdges
from .beam_geometry import LEVELS, BeamGeometry
from .records import (
    BrepBatch,
    EdgeBatch,
    FaceBatch,
    Ring,
    batches_by_kind,
    brep_batch,
    circle_numbers,
)

_Levels = tuple[int, int]


def beam_batches(geometry: BeamGeometry) -> list[BrepBatch]:
    """A closed solid per beam: B solids, about the rounded origins of the beams."""
    circles = {
        (k, level): circle_numbers(geometry.arcs[level][k], circles)
        for level, pair in geometry.circles.items()
        for k, circles in enumerate(pair)
    }
    ellipses = {
        (k, levels): _cut_numbers(geometry, k, levels) for k in (0, 1) for levels in LEVELS
    }
    curves = _Curves(circles, ellipses)
    return batches_by_kind(_kinds(geometry), lambda ids: _Batch(geometry, curves, ids).solids())


@dataclass(frozen=True)
class _Curves:
    """Circles by face and level; ellipses by face and levels, (B, 2, 11) at both ends."""

    circles: dict[_Levels, FloatArray]
    ellipses: dict[tuple[int, _Levels], FloatArray]


def _cut_numbers(geometry: BeamGeometry, k: int, levels: _Levels) -> FloatArray:
    cuts: EndEdges = geometry.cuts[levels]
    minor = np.broadcast_to(geometry.radii[:, None, k], cuts.radii[:, :, k].shape)
    major = np.maximum(cuts.radii[:, :, k], minor)
    axes = [values[:, :, k] for values in (cuts.centers, cuts.normals, cuts.majors)]
    return np.concatenate([*axes, major[..., None], minor[..., None]], axis=-1)


def _kinds(geometry: BeamGeometry) -> FloatArray:
    """The kinds of ends, faces and edges of each beam."""
    kinds = [geometry.beams.is_flat, np.isinf(geometry.radii), geometry.is_dome]
    kinds += [np.isinf(circles.radii) for pair in geometry.circles.values() for circles in pair]
    kinds += [cuts.is_line for cuts in geometry.cuts.values()]
    count = geometry.beams.n_beams
    return np.concatenate([kind.reshape(count, -1) for kind in kinds], axis=1).astype(float)


class _Batch:
    """Beams of one topology: corners and edges by number, as edges and faces refer to them."""

    def __init__(self, geometry: BeamGeometry, curves: _Curves, ids: IntArray) -> None:
        self.geometry, self.curves, self.ids = geometry, curves, ids
        self.points = geometry.corners[ids]
        self.steps = [
            [(0, 2)] if is_flat else [(0, 1), (1, 2)]
            for is_flat in geometry.beams.is_flat[ids[0]].tolist()
        ]
        corners = [
            (end, k, level)
            for end, k, level in product((0, 1), (0, 1), (0, 1, 2))
            if level != 1 or len(self.steps[end]) > 1
        ]
        self.corners = {corner: i for i, corner in enumerate(corners)}
        self.edges: list[EdgeBatch] = []
        self.arcs = {(k, level): self._arc(k, level) for k in (0, 1) for level in (0, 2)}
        self.lines = {
            (end, level): self._line((end, 0, level), (end, 1, level))
            for end, k, level in corners
            if k == 0
        }
        self.uprights = {
            (end, k, step): self._upright(end, k, step)
            for end, k in product((0, 1), (0, 1))
            for step in self.steps[end]
        }

    def solids(self) -> BrepBatch:
        corners = [self.points[:, end, k, level] for end, k, level in self.corners]
        faces = [*self._sides(), *self._ends(), self._long_face(0), self._long_face(1)]
        return brep_batch(self.ids, corners, self.edges, faces)

    def _add(self, edge: EdgeBatch) -> int:
        self.edges.append(edge)
        return len(self.edges) - 1

    def _line(self, start: tuple[int, int, int], end: tuple[int, int, int]) -> int:
        change: FloatArray = self.points[:, *end] - self.points[:, *start]
        return self._add(
            EdgeBatch(self.corners[start], self.corners[end], "LINE", unit(change))
        )

    def _arc(self, k: int, level: int) -> int:
        start, end = (0, k, level), (1, k, level)
        if np.isinf(self.geometry.circles[level][k].radii[self.ids[0]]):
            return self._line(start, end)
        circles = self.curves.circles[k, level][self.ids]
        return self._add(EdgeBatch(self.corners[start], self.corners[end], "CIRCLE", circles))

    def _upright(self, end: int, k: int, step: _Levels) -> int:
        low, high = (end, k, step[0]), (end, k, step[1])
        if self.geometry.cuts[step].is_line[self.ids[0], end, k]:
            return self._line(low, high)
        ellipses = self.curves.ellipses[k, step][self.ids, end]
        return self._add(EdgeBatch(self.corners[low], self.corners[high], "ELLIPSE", ellipses))

    def _sides(self) -> list[FaceBatch]:
        frames = self.geometry.beams.annuli.frames[self.ids]
        faces: list[FaceBatch] = []
        for level, sense in ((0, -1.0), (2, 1.0)):
            axes = np.concatenate([sense * frames[:, 2], frames[:, 0]], axis=1)
            ring: Ring = (
                (self.arcs[1, level], True), (self.lines[1, level], False),
                (self.arcs[0, level], False), (self.lines[0, level], True),
            )  # fmt: skip
            ring = ring if level else _backwards(ring)
            faces.append(FaceBatch("PLANE", axes, ring, corner=self.corners[0, 0, level]))
        return faces

    def _ends(self) -> list[FaceBatch]:
        faces: list[FaceBatch] = []
        for end in (0, 1):
            down: FloatArray = self.geometry.beams.annuli.end_directions[self.ids, end]
            for low, high in self.steps[end]:
                rise: FloatArray = self.points[:, end, 0, high] - self.points[:, end, 0, low]
                normals = (1.0 if end else -1.0) * unit(np.cross(rise, down))
                ring: Ring = (
                    (self.uprights[end, 0, (low, high)], True), (self.lines[end, high], True),
                    (self.uprights[end, 1, (low, high)], False), (self.lines[end, low], False),
                )  # fmt: skip
                ring = ring if end else _backwards(ring)
                axes = np.concatenate([normals, down], axis=1)
                faces.append(FaceBatch("PLANE", axes, ring, corner=self.corners[end, 0, low]))
        return faces

    def _long_face(self, k: int) -> FaceBatch:
        """Outer (0) or inner (1) face."""
        up = [(self.uprights[0, k, step], True) for step in self.steps[0]]
        down = [(self.uprights[1, k, step], False) for step in reversed(self.steps[1])]
        ring = (*up, (self.arcs[k, 2], True), *down, (self.arcs[k, 0], False))
        ring = ring if k == 0 else _backwards(ring)
        frames, radii = self.geometry.frames[self.ids, k], self.geometry.radii[self.ids, k]
        if np.isinf(radii[0]):
            normals = -frames[:, 0] if k == 0 else frames[:, 0]
            axes = np.concatenate([normals, frames[:, 2]], axis=1)
            return FaceBatch("PLANE", axes, ring, corner=self.corners[0, k, 0])
        centers = self.geometry.centers[self.ids, k]
        numbers = np.column_stack([centers, frames[:, 2], frames[:, 0], radii])
        is_along = bool(self.geometry.is_dome[self.ids[0], k]) == (k == 0)
        return FaceBatch("CYLINDRICAL_SURFACE", numbers, ring, is_along)


def _backwards(ring: Ring) -> Ring:
    return tuple((edge, not is_forward) for edge, is_forward in reversed(ring))
