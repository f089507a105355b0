"""
Beams as solids of STEP files: planes, cylinders, lines, circles and ellipses, all exact.

A beam has two plane sides, an outer and an inner face - cylinders, or planes where the arcs
are straight - and one or two plane faces at each end. A plane cuts a cylinder in an ellipse, or
in lines if it is parallel to the axis.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, unit
from ...kernel.beams.end_edges import EndEdges
from ...kernel.spheres.arcs import ArcCircles, Arcs, circle_axes
from ..solids.beam_numbers import LEVELS, BeamNumbers
from .bodies import Body, EdgeBatch, FaceBatch, Ring, bodies

_Levels = tuple[int, int]


def beam_bodies(numbers: BeamNumbers) -> list[Body]:
    """
    A closed solid per beam.

    Parameters
    ----------
    numbers : BeamNumbers
        B beams.

    Returns
    -------
    list of Body
        B solids, about the rounded origins of the beams.
    """
    curves = _Curves(
        {
            (k, level): _arc_numbers(numbers.arcs[level][k], circles)
            for level, pair in numbers.circles.items()
            for k, circles in enumerate(pair)
        },
        {(k, levels): _cut_numbers(numbers, k, levels) for k in (0, 1) for levels in LEVELS},
    )
    result: dict[int, Body] = {}
    for ids in _alike(numbers):
        made = _Batch(numbers, curves, ids).solids()
        result.update(zip(ids.tolist(), made, strict=True))
    return [result[beam] for beam in range(numbers.beams.n_beams)]


@dataclass(frozen=True)
class _Curves:
    """Circles by face and level; ellipses by face and levels, (B, 2, 11) at both ends."""

    circles: dict[_Levels, FloatArray]
    ellipses: dict[tuple[int, _Levels], FloatArray]


def _arc_numbers(arcs: Arcs, circles: ArcCircles) -> FloatArray:
    x, _ = circle_axes(arcs, circles)
    return np.column_stack([circles.centers, circles.axes, x, circles.radii])


def _cut_numbers(numbers: BeamNumbers, k: int, levels: _Levels) -> FloatArray:
    cuts: EndEdges = numbers.cuts[levels]
    minor = np.broadcast_to(numbers.radii[:, None, k], cuts.radii[:, :, k].shape)
    major = np.maximum(cuts.radii[:, :, k], minor)
    axes = [values[:, :, k] for values in (cuts.centers, cuts.normals, cuts.majors)]
    return np.concatenate([*axes, major[..., None], minor[..., None]], axis=-1)


def _alike(numbers: BeamNumbers) -> list[IntArray]:
    """Beams of the same kinds of ends, faces and edges."""
    count = numbers.beams.n_beams
    kinds = [numbers.beams.is_flat, np.isinf(numbers.radii), numbers.is_dome]
    kinds += [np.isinf(circles.radii) for pair in numbers.circles.values() for circles in pair]
    kinds += [cuts.is_line for cuts in numbers.cuts.values()]
    keys = np.concatenate([kind.reshape(count, -1) for kind in kinds], axis=1)
    _, groups = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(groups.ravel(), kind="stable")
    return np.split(order, np.flatnonzero(np.diff(groups.ravel()[order])) + 1)


class _Batch:
    """Beams of one topology: corners and edges by number, as edges and faces refer to them."""

    def __init__(self, numbers: BeamNumbers, curves: _Curves, ids: IntArray) -> None:
        self.numbers, self.curves, self.ids = numbers, curves, ids
        self.points = numbers.corners[ids]
        self.steps = [
            [(0, 2)] if is_flat else [(0, 1), (1, 2)]
            for is_flat in numbers.beams.is_flat[ids[0]].tolist()
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

    def solids(self) -> list[Body]:
        corners = [self.points[:, end, k, level] for end, k, level in self.corners]
        faces = [*self._sides(), *self._ends(), self._long_face(0), self._long_face(1)]
        return bodies(corners, self.edges, faces)

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
        if np.isinf(self.numbers.circles[level][k].radii[self.ids[0]]):
            return self._line(start, end)
        circles = self.curves.circles[k, level][self.ids]
        return self._add(EdgeBatch(self.corners[start], self.corners[end], "CIRCLE", circles))

    def _upright(self, end: int, k: int, step: _Levels) -> int:
        low, high = (end, k, step[0]), (end, k, step[1])
        if self.numbers.cuts[step].is_line[self.ids[0], end, k]:
            return self._line(low, high)
        ellipses = self.curves.ellipses[k, step][self.ids, end]
        return self._add(EdgeBatch(self.corners[low], self.corners[high], "ELLIPSE", ellipses))

    def _sides(self) -> list[FaceBatch]:
        frames = self.numbers.beams.annuli.frames[self.ids]
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
            down = self.numbers.beams.annuli.end_directions[self.ids, end]
            for low, high in self.steps[end]:
                rise = self.points[:, end, 0, high] - self.points[:, end, 0, low]
                normals = (1.0 if end else -1.0) * _cross(rise, down)
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
        frames, radii = self.numbers.frames[self.ids, k], self.numbers.radii[self.ids, k]
        if np.isinf(radii[0]):
            normals = -frames[:, 0] if k == 0 else frames[:, 0]
            axes = np.concatenate([normals, frames[:, 2]], axis=1)
            return FaceBatch("PLANE", axes, ring, corner=self.corners[0, k, 0])
        centers = self.numbers.centers[self.ids, k]
        numbers = np.column_stack([centers, frames[:, 2], frames[:, 0], radii])
        is_along = bool(self.numbers.is_dome[self.ids[0], k]) == (k == 0)
        return FaceBatch("CYLINDRICAL_SURFACE", numbers, ring, is_along)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return unit(np.cross(a, b))


def _backwards(ring: Ring) -> Ring:
    return tuple((edge, not is_forward) for edge, is_forward in reversed(ring))
