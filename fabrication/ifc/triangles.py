"""Closed triangulations of panels, beams and nodes, part by part and about their origins."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.beams.triangles import cylinder_triangles
from ...kernel.panels.panels import Panels
from ...kernel.panels.tessellation import MAX_STEPS, tessellate
from ...kernel.spheres.arcs import Arcs, arc_points
from ..breps.beam_geometry import BeamGeometry

_TOLERANCE: Final = 0.002
"""Largest distance of triangles from a panel or a beam, relative to half its size."""


@dataclass(frozen=True)
class Triangles:
    """Points (n, 3) of a part and its triangles (t, 3), counter-clockwise seen from outside."""

    points: FloatArray
    triangles: IntArray


def panel_triangles(panels: Panels) -> list[Triangles]:
    """Of each panel, about its origin; corners of faces and walls are one point."""
    made = tessellate(panels, _TOLERANCE)
    order = np.argsort(made.panels, kind="stable")
    bounds = np.cumsum(np.bincount(made.panels, minlength=panels.n_panels))[:-1]
    result: list[Triangles] = []
    shifts = made.origin - panels.origins
    for triangles, shift in zip(np.split(made.triangles[order], bounds), shifts, strict=True):
        used, corners = np.unique(triangles, return_inverse=True)
        points, ids = np.unique(made.points[used], axis=0, return_inverse=True)
        result.append(Triangles(points + shift, ids.ravel()[corners].reshape(-1, 3)))
    return result


def beam_triangles(geometry: BeamGeometry) -> list[Triangles]:
    """Of each beam, with the cuts of its ends, about its rounded origin."""
    arcs = {level: geometry.arcs[level] for level in (0, 2)}
    sagittas = np.max([np.abs(arc.sagittas) for pair in arcs.values() for arc in pair], axis=0)
    outer = arcs[0][0]
    halves = norm(outer.ends - outer.starts) / 2
    steps = np.clip(np.ceil(np.sqrt(sagittas / (_TOLERANCE * halves))), 1, MAX_STEPS)
    result: dict[int, Triangles] = {}
    for count in np.unique(steps).astype(np.int64).tolist():
        members = np.flatnonzero(steps == count)
        rows = [
            arc_points(_some(arcs[level][k], members), np.linspace(-1, 1, count + 1))
            for level in (0, 2)
            for k in (0, 1)
        ]
        middles = geometry.corners[members, :, :, 1].reshape(len(members), 4, 3)
        points = np.concatenate([*rows, middles], axis=1)
        for place, beam in enumerate(members.tolist()):
            flat = tuple(geometry.beams.is_flat[beam].tolist())
            result[beam] = Triangles(points[place], _beam_triangles(count, flat))
    return [result[beam] for beam in sorted(result)]


def _some(arcs: Arcs, members: IntArray) -> Arcs:
    return Arcs(*(values[members] for values in vars(arcs).values()))


def _beam_triangles(count: int, is_flat: tuple[bool, ...]) -> IntArray:
    """Rows of points: outer and inner arc of the lower side, of the upper side, middles.

    The middles are outer and inner corners of the start, then of the end; ends that are flat
    do without.
    """
    width = count + 1
    rows = np.arange(4 * width).reshape(4, width)
    low_outer, low_inner, high_outer, high_inner = rows
    middle = 4 * width + np.arange(4).reshape(2, 2)
    strips = [
        (low_inner, low_outer), (high_outer, high_inner),
        (low_outer, high_outer), (high_inner, low_inner),
    ]  # fmt: skip
    triangles = [_strip(first, second) for first, second in strips]
    for end, at in ((0, 0), (1, -1)):
        low, high = rows[:2, at], rows[2:, at]
        levels = [low, high] if is_flat[end] else [low, middle[end], high]
        ends = [
            _strip(np.array([a[0], b[0]]), np.array([a[1], b[1]])) for a, b in pairwise(levels)
        ]
        if not is_flat[end]:
            # The outer and the inner face reach to the middle.
            (outer, inner), (b_outer, b_inner), (c_outer, c_inner) = levels
            ends.append(np.array([[outer, b_outer, c_outer], [inner, c_inner, b_inner]]))
        triangles += [each if end == 0 else each[:, ::-1] for each in ends]
    return np.concatenate(triangles)


def _strip(first: IntArray, second: IntArray) -> IntArray:
    lower = np.stack([first[:-1], second[:-1], second[1:]], 1)
    return np.concatenate([lower, np.stack([first[:-1], second[1:], first[1:]], 1)])


def cylinder_bodies(
    origins: FloatArray, directions: FloatArray, heights: FloatArray, radius: float
) -> Iterator[Triangles]:
    """Of each cylinder that begins at a disc about its origin."""
    made = cylinder_triangles(origins, directions, heights, radius, _TOLERANCE)
    for points in made.points:
        places, ids = np.unique(points, axis=0, return_inverse=True)
        yield Triangles(places, ids.ravel()[made.triangles])
