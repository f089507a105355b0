"""Spherical panels as exact rational patches and trims, in stereographic charts.

A sphere of row (A, B, C), seen from its point o with normal N, is the image of

    x(u, v) = o + (u e1 + v e2 + A (u² + v²) N) / (1 + A² (u² + v²)),

the inverse stereographic projection from the point opposite o: biquadratic, (u, v) in model
units, N along x_u × x_v, and at A = 0 the plane itself. Circles on
the sphere are circular arcs in (u, v): trims are exact rational quadratics.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ...kernel.panels.panels import Panels
from ...kernel.spheres.arcs import Arcs, arc_points
from ...kernel.spheres.incidence import normals, project

_MARGIN = 0.02
"""How far the patch reaches beyond its trims, relative to its size."""

_ONE_SPAN_BULGE = 0.5
_ONE_SPAN_WEIGHT = 0.25
"""Arcs that bulge more, and patches with a smaller middle weight, are cut into two spans."""


@dataclass(frozen=True)
class PanelCharts:
    """Panels of one degree k in their stereographic charts, P of them.

    `frames` holds e1, e2, N as rows; `uv` the corners, `bulges` the tangents of a quarter of
    the sweep of the trims, positive where they turn left; `reaches` how far patches extend to
    both sides of the origin, along u and v.
    """

    ids: IntArray
    corner_ids: IntArray
    curvatures: FloatArray
    origins: FloatArray
    frames: FloatArray
    uv: FloatArray
    bulges: FloatArray
    reaches: FloatArray


def panel_charts(panels: Panels, arcs: Arcs, ids: IntArray) -> PanelCharts:
    """Stereographic charts of panels `ids` (n,) of the same degree; arcs are outer edges.

    They are turned so that no trim runs along u or v.
    """
    corner_ids = panels.offsets[ids][:, None] + np.arange(int(panels.degrees[ids[0]]))
    rows = panels.spheres[ids]
    feet = project(rows, np.zeros((len(ids), 3)))
    n_axes = unit(normals(rows, feet))
    corners = panels.corners[corner_ids] - feet[:, None]
    middles = arc_points(arcs, np.zeros(1))[corner_ids, 0] - feet[:, None]
    charts = circle_charts(rows[:, 0], n_axes, corners, middles)
    origins = feet + panels.origins[ids]
    return replace(charts, ids=ids, corner_ids=corner_ids, origins=origins)


def circle_charts(
    curvatures: FloatArray, n_axes: FloatArray, corners: FloatArray, middles: FloatArray
) -> PanelCharts:
    """Charts of P pieces of spheres with k sides: their arcs by ends and middles (P, k, 3).

    Points are relative to the origin of the chart, where the unit normals (P, 3) are N of rows
    of these curvatures A (P,).
    """
    # With u nearly along the first edge the patch is small, and its isocurves look natural.
    chords = corners[:, 1] - corners[:, 0]
    e1 = unit(chords - dot(chords, n_axes)[:, None] * n_axes)
    frames = np.stack([e1, np.cross(n_axes, e1), n_axes], 1)
    frames = turned(frames, _project_chart(curvatures, frames, corners))
    uv, middle_uv = (_project_chart(curvatures, frames, x) for x in (corners, middles))
    first, second = middle_uv - uv, np.roll(uv, -1, 1) - middle_uv
    cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    # The tangent turns by half of the sweep between the two half chords.
    bulges = cross / (norm(first) * norm(second) + dot(first, second))
    ids = np.arange(len(curvatures))
    charts = PanelCharts(
        ids, ids[:, None], curvatures, 0 * n_axes, frames, uv, bulges, uv[:, 0]
    )
    hull = trim_control_points(charts, 2)
    count = int(np.prod(hull.shape[1:-1]))  # none of no panels either
    hull = (hull[..., :2] / hull[..., 2:]).reshape(len(ids), count, 2)
    # On a domain symmetric about the origin the middle isocurves are great circles: by them
    # Rhino recognises the sphere.
    return replace(charts, reaches=(1 + _MARGIN) * np.abs(hull).max(1))


def turned(frames: FloatArray, uv: FloatArray) -> FloatArray:
    """Frames turned about N so that no trim runs along u or v.

    openNURBS wants such trims flagged, by a tolerance of its own. The first of 1, 2, ...
    degrees is taken that keeps all chords of the trims clear of the axes.
    """
    chords = np.roll(uv, -1, 1) - uv
    angles = np.arctan2(chords[..., 1], chords[..., 0])
    turns: FloatArray = np.radians(np.arange(1.0, uv.shape[1] + 2))
    off = (angles[..., None] - turns) % (np.pi / 2)
    is_clear = (np.minimum(off, np.pi / 2 - off) > np.radians(0.4)).all(1)
    turn = turns[is_clear.argmax(1)]
    cosine, sine, zero, one = np.cos(turn), np.sin(turn), 0 * turn, 0 * turn + 1
    rotation = np.stack([cosine, sine, zero, -sine, cosine, zero, zero, zero, one], 1)
    return rotation.reshape(-1, 3, 3) @ frames


def _project_chart(curvatures: FloatArray, frames: FloatArray, x: FloatArray) -> FloatArray:
    """Chart coordinates (P, k, 2) of points (P, k, 3) relative to the origin of the chart."""
    along = np.einsum("pij,pkj->pki", frames, x)
    return along[..., :2] / (1 - curvatures[:, None, None] * along[..., 2:])


def select_charts(charts: PanelCharts, chosen: BoolArray) -> PanelCharts:
    """The charts where chosen (P,)."""
    return PanelCharts(*(values[chosen] for values in vars(charts).values()))


def span_counts(charts: PanelCharts) -> IntArray:
    """Bézier spans (P,) of the trims and, each way, of the patch.

    1 or 2, so that all weights are positive; 0 for planes.
    """
    middle_weights = 1 - charts.curvatures**2 * dot(charts.reaches, charts.reaches)
    is_bent = np.abs(charts.bulges).max(1) > _ONE_SPAN_BULGE
    spans = np.where(is_bent | (middle_weights < _ONE_SPAN_WEIGHT), 2, 1)
    return np.where(charts.curvatures == 0, 0, spans)


def trim_control_points(charts: PanelCharts, spans: int) -> FloatArray:
    """Homogeneous control points (P, k, 2 spans + 1, 3) of the trims over [-1, 1].

    The arc ``(h τ (1 + b²), h b (1 - τ²)) / (1 + b² τ²)`` over its chord, see
    `kernel.spheres.arcs`; a control point (u, v and 1, times the weight) is its polar form at
    two consecutive knots.
    """
    knots = np.repeat(np.linspace(-1, 1, spans + 1), 2)
    total, product = knots[:-1] + knots[1:], knots[:-1] * knots[1:]
    starts, ends = charts.uv, np.roll(charts.uv, -1, 1)
    bulge = charts.bulges[..., None]
    scale = 1 + bulge**2
    weight = ((1 + bulge**2 * product) / scale)[..., None]
    along = np.broadcast_to(total / 2, weight.shape[:-1])[..., None]
    across = (bulge * (1 - product) / scale)[..., None]
    half = ((ends - starts) / 2)[:, :, None]
    # An arc that turns left lies to the right of its chord.
    right = np.stack([half[..., 1], -half[..., 0]], -1)
    middle = ((starts + ends) / 2)[:, :, None]
    points = middle * weight + half * along + right * across
    points[:, :, 0], points[:, :, -1] = starts, ends
    return np.concatenate([points, weight], -1)


def patch_control_points(charts: PanelCharts, knots: FloatArray) -> FloatArray:
    """Homogeneous control points (P, n, n, 4) of the patches: x, y, z and 1, times the weight.

    Knots (P, 2, n + 1) in u and v are without the first and last knot of other notations.
    """
    mean = (knots[..., :-1] + knots[..., 1:]) / 2
    product = knots[..., :-1] * knots[..., 1:]
    square = product[:, 0, :, None] + product[:, 1, None, :]
    a = charts.curvatures[:, None, None]
    weight = (1 + a**2 * square)[..., None]
    e1, e2, n_axis = charts.frames[:, :, None, None].transpose(1, 0, 2, 3, 4)
    relative = (
        mean[:, 0, :, None, None] * e1
        + mean[:, 1, None, :, None] * e2
        + (a * square)[..., None] * n_axis
    )
    origin = charts.origins[:, None, None]
    return np.concatenate([relative + weight * origin, weight], -1)
