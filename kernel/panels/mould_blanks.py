"""Mould blanks: the smallest cap that holds each panel, and how many of which size."""

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..errors import ConvergenceError, InputError
from ..spheres.arcs import ArcCircles, Arcs, arc_circles
from ..spheres.incidence import normals, project
from ..tolerances import ENCLOSING
from .congruent import CongruentPanels
from .panels import Panels, boundaries

_MAX_STEPS = 100


@dataclass(frozen=True)
class PanelCaps:
    """Smallest caps of the moulds that hold both faces of panels.

    Attributes
    ----------
    centers : (P, 3) float array
        Centres of the rim circles, local to the panels.
    axes : (P, 3) float array
        Unit axes, to the side of N.
    radii : (P,) float array
        Radii of the rim circles; the chord diameter is twice that.
    sagittas : (P,) float array
        Signed heights of the crowns over the rim planes along the axes: positive where the
        mould bulges to N, 0 on planes.
    openings : (P,) float array
        Full opening angles seen from the centres of the moulds, in radians; 0 on planes.
    """

    centers: FloatArray
    axes: FloatArray
    radii: FloatArray
    sagittas: FloatArray
    openings: FloatArray


@dataclass(frozen=True)
class MouldBlanks:
    """Blanks per mould: one size that holds every panel of the mould, or a few sizes.

    Attributes
    ----------
    labels : (B,) int array
        Mould of each row.
    radii : (B,) float array
        Radius of the mould; infinite for a flat one.
    diameters : (B,) float array
        Chord diameter of the blanks of this row.
    sagittas : (B,) float array
        Height of these blanks, without thickness.
    openings : (B,) float array
        Full opening angle of these blanks, in radians.
    counts : (B,) int array
        Number of panels that are cut from blanks of this size.
    shapes : (B,) int array
        Number of different shapes among them.
    """

    labels: IntArray
    radii: FloatArray
    diameters: FloatArray
    sagittas: FloatArray
    openings: FloatArray
    counts: IntArray
    shapes: IntArray


def panel_caps(panels: Panels) -> PanelCaps:
    """Smallest cap of each panel's mould over which both of its faces lie; local to it.

    Raises
    ------
    ConvergenceError
        If the exchange does not end, which was never seen.

    Notes
    -----
    Faces are laid on the mould along its radii. On a sphere the smallest cap (of less than a
    half sphere) lies in the smallest ball around the outline, which at most three points of
    the outline determine. They are found by exchange: the farthest point of the arcs, in
    closed form, joins the three; the smallest ball of the four keeps those that determine it;
    its radius only grows.
    """
    arcs, owners = _arcs_on_moulds(panels)
    circles = arc_circles(arcs)
    first = _first_of_each(owners, panels.n_panels)
    support = np.repeat(arcs.starts[first][:, None], 3, axis=1)
    centers, radii = _ball_of_three(support)
    for _ in range(_MAX_STEPS):
        candidates, distances = _farthest(arcs, circles, centers[owners])
        farthest = _argmax_by(owners, distances, panels.n_panels)
        outside = distances[farthest] > radii * (1 + ENCLOSING)
        if not outside.any():
            break
        grown = np.concatenate([support, candidates[farthest][:, None]], axis=1)
        support[outside] = _support_of_four(grown[outside])
        centers, radii = _ball_of_three(support)
    else:
        raise ConvergenceError("the caps of the blanks did not close: report this panel set")
    rows = panels.design_spheres
    axes = unit(normals(rows, project(rows, centers)))
    # A mould that bulges to N has a negative curvature.
    curvature = -2 * rows[:, 0]
    sine = np.minimum(np.abs(curvature) * radii, 1.0)
    sagittas = curvature * radii**2 / (1 + np.sqrt(1 - sine**2))
    return PanelCaps(centers, axes, radii, sagittas, 2 * np.arcsin(sine))


def mould_blanks(
    panels: Panels, same: CongruentPanels, size_step: float = 0.0, caps: PanelCaps | None = None
) -> MouldBlanks:
    """How many blanks of which size every mould must give.

    Parameters
    ----------
    panels : Panels
        P panels; those without a mould do not count.
    same : CongruentPanels
        Which of them are identical.
    size_step : float
        Blanks come in diameters that are multiples of this length, in model units; 0 for one
        size per mould, that of its largest panel.
    caps : PanelCaps, optional
        `panel_caps` of the panels, where they are known.

    Returns
    -------
    MouldBlanks
        A row per mould and size, the moulds ascending and their sizes as well.

    Raises
    ------
    InputError
        If the step is negative or not finite.
    """
    if not (np.isfinite(size_step) and size_step >= 0):
        raise InputError(f"the step of blank sizes must be at least 0, not {size_step}")
    members = np.flatnonzero(panels.labels >= 0)
    labels, diameters = panels.labels[members], 2 * (caps or panel_caps(panels)).radii[members]
    moulds, which = np.unique(labels, return_inverse=True)
    curvatures = 2 * np.abs(panels.design_spheres[members, 0])
    # Small panels of a very large mould are built as planes; the mould is no flatter for it.
    bends = np.zeros(len(moulds))
    np.maximum.at(bends, which, curvatures)
    if size_step > 0:
        # A diameter that is a multiple itself needs no larger blank, give or take rounding.
        sizes = size_step * np.ceil(diameters / size_step * (1 - 4 * ENCLOSING))
    else:
        largest = np.zeros(len(moulds))
        np.maximum.at(largest, which, diameters)
        sizes = largest[which]
    keys, row = np.unique(np.stack([which, sizes], 1), axis=0, return_inverse=True)
    row = row.ravel()
    kind: IntArray = keys[:, 0].astype(np.int64)
    sizes: FloatArray = keys[:, 1].astype(np.float64)
    shapes = np.unique(np.stack([row, same.labels[members]], 1), axis=0)[:, 0]
    curvature = bends[kind]
    sine = np.minimum(curvature * sizes / 2, 1.0)
    radii = np.divide(1.0, curvature, out=np.full(len(kind), np.inf), where=curvature > 0)
    return MouldBlanks(
        labels=moulds[kind],
        radii=radii,
        diameters=sizes,
        sagittas=curvature * (sizes / 2) ** 2 / (1 + np.sqrt(1 - sine**2)),
        openings=2 * np.arcsin(sine),
        counts=np.bincount(row, minlength=len(kind)),
        shapes=np.bincount(shapes, minlength=len(kind)),
    )


def _arcs_on_moulds(panels: Panels) -> tuple[Arcs, IntArray]:
    """Edges of both faces carried along the radii onto the moulds, and their panels."""
    faces = boundaries(panels)
    owners, mould = panels.corner_panels, panels.design_spheres
    carried: list[Arcs] = []
    for rows, arcs in faces:
        # Concentric spheres are scaled by the ratio of their radii, planes by 1.
        scale = np.ones(panels.n_panels)
        np.divide(rows[:, 0], mould[:, 0], out=scale, where=mould[:, 0] != 0)
        starts = project(mould[owners], arcs.starts)
        ends = project(mould[owners], arcs.ends)
        sagittas = arcs.sagittas * scale[owners]
        carried.append(replace(arcs, starts=starts, ends=ends, sagittas=sagittas))
    joined = Arcs(
        *(
            np.concatenate([getattr(arcs, name) for arcs in carried])
            for name in ("starts", "ends", "rises", "sagittas")
        )
    )
    return joined, np.concatenate([owners] * len(faces))


def _first_of_each(owners: IntArray, count: int) -> IntArray:
    first = np.empty(count, np.int64)
    first[owners[::-1]] = np.arange(len(owners))[::-1]
    return first


def _argmax_by(owners: IntArray, values: FloatArray, count: int) -> IntArray:
    """Index of the largest value of each owner."""
    order = np.lexsort((values, owners))
    last = np.searchsorted(owners[order], np.arange(count), side="right") - 1
    return order[last]


def _farthest(
    arcs: Arcs, circles: ArcCircles, centers: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Farthest points of arcs from other points, and their distances."""
    start, end = norm(arcs.starts - centers), norm(arcs.ends - centers)
    points = np.where((start >= end)[:, None], arcs.starts, arcs.ends)
    distances = np.maximum(start, end)
    # The farthest point of a whole circle, where it lies on the arc: beyond its chord.
    round_ = np.isfinite(circles.radii)
    radii = np.where(round_, circles.radii, 0.0)
    middle = np.where(round_[:, None], circles.centers, 0.0)
    away = middle - centers
    away = unit(away - dot(away, circles.axes)[:, None] * circles.axes)
    summit = middle + radii[:, None] * away
    on_arc = _beyond_chord(arcs, summit) & round_
    height = norm(summit - centers)
    higher = on_arc & (height > distances)
    return np.where(higher[:, None], summit, points), np.where(higher, height, distances)


def _beyond_chord(arcs: Arcs, points: FloatArray) -> BoolArray:
    """Whether points of the circles of arcs lie on the side of the chord where the arc is."""
    return dot(points - arcs.starts, arcs.rises) * arcs.sagittas > 0


def _ball_of_three(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Centre and radius of the smallest sphere through three points; they may coincide."""
    a, b, c = points[:, 0], points[:, 1], points[:, 2]
    u, v = b - a, c - a
    normal = np.cross(u, v)
    square = dot(normal, normal)
    safe = np.where(square > 0, square, 1.0)[:, None]
    offset = np.cross(dot(u, u)[:, None] * v - dot(v, v)[:, None] * u, normal) / (2 * safe)
    # Where two of the points coincide, the others span a diameter.
    is_pair = square == 0
    far = np.where((dot(u, u) >= dot(v, v))[:, None], u, v)
    center = a + np.where(is_pair[:, None], far / 2, offset)
    return center, norm(points - center[:, None]).max(axis=1)


def _support_of_four(points: FloatArray) -> FloatArray:
    """Three of four points (n, 4, 3), repeated where two suffice, whose ball holds all."""
    count = len(points)
    subsets = np.array(
        [[i, j, j] for i in range(4) for j in range(i + 1, 4)]
        + [[i, j, k] for i in range(4) for j in range(i + 1, 4) for k in range(j + 1, 4)]
    )
    triples = points[:, subsets]
    centers, radii = _ball_of_three(triples.reshape(-1, 3, 3))
    centers, radii = centers.reshape(count, -1, 3), radii.reshape(count, -1)
    reach = norm(points[:, None] - centers[:, :, None]).max(axis=2)
    holds = reach <= radii * (1 + ENCLOSING)
    # Where rounding leaves none, the one that misses least.
    cost = np.where(holds, radii, np.inf)
    best = cost.argmin(axis=1)
    stuck = ~holds.any(axis=1)
    best[stuck] = (reach - radii)[stuck].argmin(axis=1)
    return triples[np.arange(count), best]
