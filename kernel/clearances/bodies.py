"""Panels, beams and node cylinders as intersections of what single faces bound.

A body is where all of its functions ``g(x) = B·x - A |x⊥|² - C`` are at least zero: half
spaces, balls and cylinders and what is outside of them. A cylinder has an axis, and x⊥ is x
across it. Near a face g is the distance from it. Parts with a corner that turns inwards are
unions of such bodies.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, unit
from ..beams.beams import Beams, inward_directions, section_arcs, side_arcs
from ..beams.node_cylinders import NodeCylinders
from ..panels.panels import Panels, panel_arcs
from ..spheres.arcs import arc_points
from ..spheres.rows import from_plane, recenter


@dataclass(frozen=True)
class Bodies:
    """Bodies, each of at most m faces.

    Attributes
    ----------
    parts : (n,) int array
        The part that each belongs to.
    origins : (n, 3) float array
        Origins of their coordinates.
    rows : (n, m, 5) float array
        Unit rows of the faces, local; N points into the body. Faces that do not count have
        ``(0, 0, 0, 0, -1)``, scaled: they hold everywhere.
    axes : (n, m, 3) float array
        Axes of the faces that are cylinders; zero for planes and spheres.
    points : (n, k, 3) float array
        Corners and points of the edges, local.
    edges : (n, e, 3) int array
        Points of each edge that is an arc: where it begins, its middle, where it ends.
    boxes : (n, 2, 3) float array
        Least and largest coordinates of boxes about them, in model coordinates.
    """

    parts: IntArray
    origins: FloatArray
    rows: FloatArray
    axes: FloatArray
    points: FloatArray
    edges: IntArray
    boxes: FloatArray

    @property
    def n_bodies(self) -> int:
        """Number of bodies."""
        return len(self.parts)


def select_bodies(bodies: Bodies, rows: IntArray) -> Bodies:
    """Some of the bodies, in the order of the rows."""
    return Bodies(*(values[rows] for values in vars(bodies).values()))


def panel_bodies(panels: Panels) -> Bodies:
    """Bodies of panels with a thickness.

    A corner that turns inwards lies beyond one of its two edges only: the panel is the union of
    the bodies without one and without the other.
    """
    degrees = panels.degrees
    width = int(degrees.max(initial=0))
    place = np.arange(len(panels.corners)) - panels.offsets[:-1][panels.corner_panels]
    planes = np.full((panels.n_panels, width, 5), 0.0)
    sizes = np.maximum.reduceat(norm(panels.corners), panels.offsets[:-1])
    planes[..., 4] = -4 * sizes[:, None]
    planes[panels.corner_panels, place] = from_plane(panels.plane_normals, panels.plane_offsets)
    rows = np.concatenate([-panels.spheres[:, None], panels.inner_spheres[:, None], planes], 1)
    points = _panel_points(panels, width)
    whole = Bodies(
        np.arange(panels.n_panels), panels.origins, rows, np.zeros((*rows.shape[:2], 3)),
        points, _panel_edges(panels, width),
        _boxes(points, panels.origins, _panel_bulges(panels)),
    )  # fmt: skip
    return _split_panels(panels, whole, place)


def _panel_points(panels: Panels, width: int) -> FloatArray:
    """Corners and middles of edges of both faces, and their middles; repeated to fill up."""
    degrees = panels.degrees[:, None]
    chosen = panels.offsets[:-1, None] + np.minimum(np.arange(width), degrees - 1)
    found: list[FloatArray] = []
    for face in ("outer", "inner"):
        arcs = panel_arcs(panels, face)
        middles = arc_points(arcs, np.zeros(1))[:, 0]
        found += [arcs.starts[chosen], middles[chosen]]
    outer, _, inner, _ = found
    centers = [points.mean(axis=1, keepdims=True) for points in (outer, inner)]
    return np.concatenate([*found, *centers], 1)


def _panel_edges(panels: Panels, width: int) -> IntArray:
    """Points of the edges of both faces, as `_panel_points` has them."""
    place = np.minimum(np.arange(width), panels.degrees[:, None] - 1)
    after = np.where(place + 1 < panels.degrees[:, None], place + 1, 0)
    ring = np.stack([place, width + place, after], 2)
    return np.concatenate([ring, ring + 2 * width], 1)


def _panel_bulges(panels: Panels) -> FloatArray:
    """By how much panels may reach beyond the boxes of their points."""
    sizes = np.maximum.reduceat(
        norm(panels.corners - panels.corners[panels.offsets[:-1]][panels.corner_panels]),
        panels.offsets[:-1],
    )
    curvature = np.maximum(np.abs(panels.spheres[:, 0]), np.abs(panels.inner_spheres[:, 0]))
    # The sagitta of an arc over the longest diagonal.
    root = np.sqrt(np.maximum(1 - (curvature * sizes) ** 2, 0.0))
    return curvature * sizes**2 / 2 / (1 + root) + 1e-12 * sizes


def _split_panels(panels: Panels, whole: Bodies, place: IntArray) -> Bodies:
    """The bodies, those of panels with a corner that turns inwards cut in two for each."""
    owners = panels.corner_panels
    previous = np.empty(len(owners), np.int64)
    previous[panels.next_corners] = np.arange(len(owners))
    up = panels.spheres[owners, 1:4]
    turn = dot(np.cross(panels.plane_normals[previous], panels.plane_normals), up)
    result = whole
    for corner in np.flatnonzero(turn < 0).tolist():
        mine = np.flatnonzero(result.parts == owners[corner])
        first = _without(select_bodies(result, mine), 2 + int(place[corner]))
        second = _without(select_bodies(result, mine), 2 + int(place[previous[corner]]))
        others = select_bodies(result, np.flatnonzero(result.parts != owners[corner]))
        result = join_bodies([others, first, second])
    return result


def _without(bodies: Bodies, face: int) -> Bodies:
    rows = bodies.rows.copy()
    rows[:, face] = 0
    rows[:, face, 4] = -4 * norm(bodies.points).max(axis=1)
    return replace(bodies, rows=rows)


def join_bodies(groups: Iterable[Bodies]) -> Bodies:
    """Bodies of several groups with the same number of faces and points, in one."""
    listed = [vars(group) for group in groups]
    return Bodies(*(np.concatenate([group[name] for group in listed]) for name in listed[0]))


HALF_ARC: Final = 0.35
"""Half of an arc lies over its chord by no more than this share of what the whole does."""

_BEAM_EDGES: Final = np.array([[0, 12, 6], [3, 13, 9], [2, 14, 8], [5, 15, 11]])
"""Points of the four long edges: corners by end, face and level, then the middles."""


def beam_bodies(beams: Beams) -> Bodies:
    """Bodies of beams; ends with a notch make two of each."""
    annuli = beams.annuli
    count = beams.n_beams
    across, half = annuli.frames[:, 2], beams.thickness / 2
    inward = inward_directions(annuli)
    sides = [from_plane(sign * across, np.full(count, -half)) for sign in (1.0, -1.0)]
    rows = [-annuli.outer, annuli.inner, *sides]
    axes = [across, across, 0 * across, 0 * across]
    levels, insets = beams.levels, beams.insets
    ends = np.empty((count, 2, 2, 5))
    for end in (0, 1):
        for side in (0, 1):
            rise = levels[:, end, side + 1] - levels[:, end, side]
            change = insets[:, end, side + 1] - insets[:, end, side]
            if side == 0:
                rise = np.where(beams.is_flat[:, end], 2 * half, rise)
                change = np.where(
                    beams.is_flat[:, end], insets[:, end, 2] - insets[:, end, 0], change
                )
            normal = unit(rise[:, None] * inward[:, end] - change[:, None] * across)
            ends[:, end, side] = from_plane(
                normal, dot(normal, beams.corners[:, end, 0, 2 * side])
            )
        ends[beams.is_flat[:, end], end, 1] = ends[beams.is_flat[:, end], end, 0]
    table = np.concatenate([np.stack(rows, 1), ends.reshape(count, 4, 5)], 1)
    points = beams.corners.reshape(count, 12, 3)
    points = np.concatenate([points, _beam_middles(beams)], 1)
    starts, middles, ends = np.moveaxis(points[:, _BEAM_EDGES], 2, 0)
    sagittas = norm(middles - (starts + ends) / 2).max(axis=1)
    whole = Bodies(
        np.arange(count), annuli.origins, table,
        np.stack(axes + [0 * across] * 4, 1), points,
        np.broadcast_to(_BEAM_EDGES, (count, *_BEAM_EDGES.shape)),
        _boxes(points, annuli.origins, HALF_ARC * sagittas),
    )  # fmt: skip
    return _split_beams(beams, whole)


def _beam_middles(beams: Beams) -> FloatArray:
    """Middles of the four long edges, and of outer and inner faces, (B, 6, 3)."""
    arcs = [*side_arcs(beams, 0), *side_arcs(beams, 2), *section_arcs(beams)]
    return np.stack([arc_points(each, np.zeros(1))[:, 0] for each in arcs], 1)


def _split_beams(beams: Beams, whole: Bodies) -> Bodies:
    """The bodies, those of beams with a notch at an end cut in two there."""
    levels, insets = beams.levels, beams.insets
    share = (levels[..., 1] - levels[..., 0]) / (levels[..., 2] - levels[..., 0])
    straight = insets[..., 0] + share * (insets[..., 2] - insets[..., 0])
    is_notched = (insets[..., 1] - straight > 1e-9 * beams.thickness) & ~beams.is_flat
    result = whole
    for end in (0, 1):
        notched = is_notched[result.parts, end]
        rest = select_bodies(result, np.flatnonzero(~notched))
        cut = select_bodies(result, np.flatnonzero(notched))
        pieces = [rest]
        for side, sign in ((0, -1.0), (1, 1.0)):
            rows = cut.rows.copy()
            ridge = sign * levels[cut.parts, end, 1]
            across = beams.annuli.frames[cut.parts, 2]
            rows[:, 4 + 2 * end + (1 - side)] = from_plane(sign * across, ridge)
            pieces.append(replace(cut, rows=rows))
        result = join_bodies(pieces)
    return result


def cylinder_bodies(cylinders: NodeCylinders) -> Bodies:
    """Bodies of node cylinders, about the centres of their outer discs."""
    count, radius = cylinders.n_nodes, cylinders.radius
    down, zero = cylinders.directions, np.zeros(count)
    around = np.zeros((count, 5))
    around[:, 0], around[:, 4] = 0.5 / radius, -radius / 2
    rows = np.stack([around, from_plane(down, zero), from_plane(-down, -cylinders.heights)], 1)
    axes = np.stack([down, 0 * down, 0 * down], 1)
    other = np.eye(3)[np.argmin(np.abs(down), axis=1)]
    x = unit(np.cross(other, down))
    turns = 2 * np.pi * np.arange(8)[:, None] / 8
    ring = radius * (np.cos(turns) * x[:, None] + np.sin(turns) * np.cross(down, x)[:, None])
    points = np.concatenate([ring, ring + (cylinders.heights[:, None] * down)[:, None]], 1)
    bulges = np.full(count, radius / 8)
    return Bodies(
        np.arange(count), cylinders.origins, rows, axes, points,
        np.zeros((count, 0, 3), np.int64), _boxes(points, cylinders.origins, bulges),
    )  # fmt: skip


def _boxes(points: FloatArray, origins: FloatArray, bulges: FloatArray) -> FloatArray:
    low, high = points.min(axis=1), points.max(axis=1)
    return np.stack([low - bulges[:, None], high + bulges[:, None]], 1) + origins[:, None]


def common_frame(
    first: Bodies, second: Bodies
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Rows (n, m + m', 5) and axes of pairs of bodies, and points of both, about one origin.

    That of the first body of each pair.
    """
    shift = first.origins - second.origins
    rows = recenter_faces(second.rows, second.axes, shift[:, None])
    return (
        np.concatenate([first.rows, rows], 1),
        np.concatenate([first.axes, second.axes], 1),
        first.points,
        second.points - shift[:, None],
    )


def recenter_faces(rows: FloatArray, axes: FloatArray, origins: FloatArray) -> FloatArray:
    """Rows of faces in coordinates about other points; those of cylinders stay upright."""
    across = origins - dot(origins, axes)[..., None] * axes
    return recenter(rows, across)


def face_values(rows: FloatArray, axes: FloatArray, points: FloatArray) -> FloatArray:
    """Functions g of faces (..., m) at a point (..., 3) for each row of faces."""
    along = np.einsum("...mi,...i->...m", axes, points)
    square = dot(points, points)[..., None] - along**2
    linear = np.einsum("...mi,...i->...m", rows[..., 1:4], points)
    return linear - rows[..., 0] * square - rows[..., 4]


def face_slopes(rows: FloatArray, axes: FloatArray, points: FloatArray) -> FloatArray:
    """Gradients of the functions, (..., m, 3)."""
    along = np.einsum("...mi,...i->...m", axes, points)
    across = points[..., None, :] - along[..., None] * axes
    return rows[..., 1:4] - 2 * rows[..., :1] * across
