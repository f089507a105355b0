"""Circular arcs on spheres, and what is bounded by them.

An arc is kept by its chord and its sagitta, so that straight edges of plane panels are arcs of
sagitta zero and nothing is divided by a curvature. With half chord h and bulge ``b = s / h``
(the tangent of a quarter of the sweep) the arc over ``τ in [-1, 1]`` is rational:

    x = h τ (1 + b²) / (1 + b² τ²),    y = s (1 - τ²) / (1 + b² τ²).
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, sum_by, unit
from .incidence import evaluate, normals, project


@dataclass(frozen=True)
class Arcs:
    """Arcs of at most a half circle.

    Attributes
    ----------
    starts, ends : (H, 3) float array
        End points.
    rises : (H, 3) float array
        Unit vectors across the chord in the plane of the arc; the sagitta is measured along it.
    sagittas : (H,) float array
        Signed height of the arc over its chord; 0 for a straight edge.
    """

    starts: FloatArray
    ends: FloatArray
    rises: FloatArray
    sagittas: FloatArray


@dataclass(frozen=True)
class ArcCircles:
    """The circles that carry arcs, for writers. Defined where the sagitta is not zero.

    Attributes
    ----------
    centers : (H, 3) float array
    axes : (H, 3) float array
        Unit axes; the arc runs counter-clockwise about its axis.
    radii : (H,) float array
        Radii; infinite for straight edges.
    sweeps : (H,) float array
        Angles from start to end, in radians; 0 for straight edges.
    """

    centers: FloatArray
    axes: FloatArray
    radii: FloatArray
    sweeps: FloatArray


def sphere_arcs(
    rows: FloatArray, plane_normals: FloatArray, starts: FloatArray, ends: FloatArray
) -> Arcs:
    """Shorter arcs in which planes cut spheres, between two points of both, each (H, 3).

    Unit rows (H, 5), where planes give straight edges, and unit normals (H, 3) of the cutting
    planes; `rises` points along N where the plane stands upright on the sphere.

    Notes
    -----
    The sagitta is the small root of ``A s² - w s - A h² = 0`` in the form without cancellation,
    with w the slope of the sphere equation across the chord.
    """
    chords = ends - starts
    rises = unit(np.cross(chords, plane_normals))
    half_squared = dot(chords, chords) / 4
    slope = dot(normals(rows, (starts + ends) / 2), rises)
    curvature = rows[:, 0]
    root = np.sqrt(slope**2 + 4 * curvature**2 * half_squared)
    denominator = slope + np.copysign(root, slope)
    # Both vanish where a plane is cut by itself: there is no arc, and any chord lies in it.
    sagittas = np.divide(
        -2 * curvature * half_squared,
        denominator,
        out=np.zeros_like(slope),
        where=denominator != 0,
    )
    return Arcs(starts, ends, rises, sagittas)


def arc_points(arcs: Arcs, parameters: FloatArray) -> FloatArray:
    """Points (H, n, 3) of arcs at n values of τ in [-1, 1]; ends and middle are exact."""
    middle = (arcs.starts + arcs.ends)[:, None] / 2
    half_chord = (arcs.ends - arcs.starts)[:, None] / 2
    square = _bulges(arcs)[:, None] ** 2
    denominator = 1 + square * parameters**2
    along = parameters * (1 + square) / denominator
    across = arcs.sagittas[:, None] * (1 - parameters**2) / denominator
    return middle + along[..., None] * half_chord + across[..., None] * arcs.rises[:, None]


def _arc_derivatives(arcs: Arcs, parameters: FloatArray) -> FloatArray:
    half_chord = (arcs.ends - arcs.starts)[:, None] / 2
    square = _bulges(arcs)[:, None] ** 2
    denominator = (1 + square * parameters**2) ** 2
    along = (1 + square) * (1 - square * parameters**2) / denominator
    across = -2 * arcs.sagittas[:, None] * parameters * (1 + square) / denominator
    return along[..., None] * half_chord + across[..., None] * arcs.rises[:, None]


def _bulges(arcs: Arcs) -> FloatArray:
    half = norm(arcs.ends - arcs.starts) / 2
    return np.divide(arcs.sagittas, half, out=np.zeros_like(half), where=half > 0)


def arc_lengths(arcs: Arcs) -> FloatArray:
    """Lengths of arcs, (H,); for a straight edge the length of the chord."""
    bulge = np.abs(_bulges(arcs))
    small = bulge < 1e-4
    safe = np.where(small, 1.0, bulge)
    ratio = np.where(small, 1 + 2 * bulge**2 / 3, (1 + safe**2) * np.arctan(safe) / safe)
    return norm(arcs.ends - arcs.starts) * ratio


def segment_areas(arcs: Arcs) -> FloatArray:
    """Areas between arcs and their chords, (H,), with the sign of the sagitta."""
    bulge = _bulges(arcs)
    chords = arcs.ends - arcs.starts
    square = bulge**2
    # The closed form cancels for flat arcs; the series is exact there.
    small = np.abs(bulge) < 0.02
    series = bulge * (4 / 3 + square * (4 / 15 - square * 4 / 105))
    safe = np.where(small, 1.0, bulge)
    closed = ((1 + safe**2) ** 2 * np.arctan(safe) - safe * (1 - safe**2)) / (2 * safe**2)
    return dot(chords, chords) / 4 * np.where(small, series, closed)


def arc_circles(arcs: Arcs) -> ArcCircles:
    """Centre, axis, radius and sweep of each arc; radius and centre infinite if straight."""
    middle = (arcs.starts + arcs.ends) / 2
    half = norm(arcs.ends - arcs.starts) / 2
    sagittas = arcs.sagittas
    with np.errstate(divide="ignore", invalid="ignore"):
        # Signed height of the centre over the chord: (s² - h²) / 2s.
        height = (sagittas - half**2 / sagittas) / 2
        radii = (np.abs(sagittas) + half**2 / np.abs(sagittas)) / 2
        centers = middle + height[:, None] * arcs.rises
    axes = np.cross(arcs.rises, unit(arcs.ends - arcs.starts))
    axes = np.where(sagittas[:, None] < 0, -axes, axes)
    return ArcCircles(centers, axes, radii, 4 * np.arctan(np.abs(_bulges(arcs))))


def circle_axes(arcs: Arcs, circles: ArcCircles) -> tuple[FloatArray, FloatArray]:
    """Unit vectors (H, 3) from the centres to the starts, and along the arcs there."""
    half = circles.sweeps[:, None] / 2
    along = unit(arcs.ends - arcs.starts)
    outward = np.copysign(1.0, arcs.sagittas)[:, None] * arcs.rises
    x = np.cos(half) * outward - np.sin(half) * along
    y = np.sin(half) * outward + np.cos(half) * along
    return x, y


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


def patch_areas(rows: FloatArray, arcs: Arcs, arc_rows: IntArray) -> FloatArray:
    """Areas (P,) of the pieces of spheres that lie to the left of closed chains of arcs.

    Unit rows (P, 5) in coordinates whose origin is near the piece, planes included; H arcs on
    them, counter-clockwise about N, and the row of each. Negative where the boundary runs
    clockwise.

    Notes
    -----
    The closed integral of ``(x dy - y dx) / (1 + cos θ)`` about the point o of the sphere
    nearest the origin, θ measured from N(o): 24 Gauss points per arc. It keeps its digits down
    to the plane, where the theorem of Gauss and Bonnet cancels. Pieces must not reach the
    antipode of o.
    """
    origin = project(rows, np.zeros((len(rows), 3)))
    axis = normals(rows, origin)[arc_rows][:, None]
    relative = arc_points(arcs, _NODES) - origin[arc_rows][:, None]
    speed = _arc_derivatives(arcs, _NODES)
    cosine = 1 - 2 * rows[arc_rows, :1] * dot(axis, relative)
    integrand = dot(np.cross(relative, speed), axis) / (1 + cosine)
    return sum_by(arc_rows, integrand @ _WEIGHTS, len(rows))


_NEARLY_FLAT = 0.1
"""Sine of an angle below which a series has all digits, where the closed form cancels."""


def patch_moments(rows: FloatArray, arcs: Arcs, arc_rows: IntArray) -> FloatArray:
    """First moments (P, 3) of pieces of spheres about the origin: the integrals of position.

    Rows, arcs and the row of each are those of `patch_areas`.

    Notes
    -----
    In polar coordinates about the point o of `patch_areas`, with r from there to the boundary,
    r' its part across the axis n, and θ measured from N(o): the closed integral of
    ``(r' g + n (r·n) / (2 + 2 cos θ)) (x dy - y dx)``, where
    ``g = (θ - sin θ cos θ) / (2 sin³ θ)``, which is 1/3 on planes.
    """
    origin = project(rows, np.zeros((len(rows), 3)))
    axis = normals(rows, origin)[arc_rows][:, None]
    relative = arc_points(arcs, _NODES) - origin[arc_rows][:, None]
    turn = dot(np.cross(relative, _arc_derivatives(arcs, _NODES)), axis)
    height = dot(relative, axis)
    across = relative - height[..., None] * axis
    curvature = 2 * rows[arc_rows, :1]
    cosine, sine = 1 - curvature * height, np.abs(curvature) * norm(across)
    small = sine < _NEARLY_FLAT
    square = sine**2
    series = 1 / 3 + square * (1 / 10 + square * (3 / 56 + square * (5 / 144 + square / 40)))
    safe = np.where(small, 1.0, sine)
    closed = (np.arctan2(safe, cosine) - safe * cosine) / (2 * safe**3)
    share = np.where(small & (cosine > 0), series, closed)
    moment = across * share[..., None] + axis * (height / (2 + 2 * cosine))[..., None]
    moments = sum_by(arc_rows, np.einsum("hni,hn,n->hi", moment, turn, _WEIGHTS), len(rows))
    return moments + patch_areas(rows, arcs, arc_rows)[:, None] * origin


def segment_moments(arcs: Arcs) -> FloatArray:
    """Moments (H,) of the areas between arcs and their chords, about the chords, along rises.

    Positive to either side: area and distance change their signs together.
    """
    square = _bulges(arcs)[:, None] ** 2
    denominator = 1 + square * _NODES**2
    heights = arcs.sagittas[:, None] * (1 - _NODES**2) / denominator
    speeds = (1 + square) * (1 - square * _NODES**2) / denominator**2
    return norm(arcs.ends - arcs.starts) / 2 * ((heights**2 / 2 * speeds) @ _WEIGHTS)


def arc_tangents(arcs: Arcs) -> tuple[FloatArray, FloatArray]:
    """Directions in which arcs leave their starts and reach their ends.

    Unit vectors (H, 3), both in the sense from start to end.
    """
    along, square = unit(arcs.ends - arcs.starts), _bulges(arcs)[:, None] ** 2
    # Half of the sweep, by the tangent of a quarter of it.
    cosine, sine = (1 - square) / (1 + square), 2 * _bulges(arcs)[:, None] / (1 + square)
    return cosine * along + sine * arcs.rises, cosine * along - sine * arcs.rises


def arc_reaches(arcs: Arcs, directions: FloatArray) -> FloatArray:
    """How far arcs reach in a direction (H, 3), a unit vector in the plane of the arc.

    Largest coordinate (H,) of a point of the arc along the direction, from the origin: that of
    an end, or of the point of the circle that lies in that direction if the arc has it.
    """
    ends = np.maximum(dot(arcs.starts, directions), dot(arcs.ends, directions))
    outward = np.copysign(1.0, arcs.sagittas)[:, None] * arcs.rises
    apex = (arcs.starts + arcs.ends) / 2 + arcs.sagittas[:, None] * arcs.rises
    turn = 2 * np.arctan2(norm(directions - outward), norm(directions + outward))
    circles = arc_circles(arcs)
    is_between = (turn < circles.sweeps / 2) & np.isfinite(circles.radii)
    # From the apex, not from a centre that may be far away.
    rise = np.where(is_between, circles.radii, 0.0) * 2 * np.sin(turn / 2) ** 2
    return np.where(is_between, dot(apex, directions) + rise, ends)


def arc_distances(rows: FloatArray, arcs: Arcs) -> tuple[FloatArray, FloatArray]:
    """Least and greatest signed distances (H,) of points of arcs from unit rows (H, 5).

    Positive on the side to which N points; exact.

    Notes
    -----
    On an arc the left side of a sphere's equation is ``(q0 + q1 τ + q2 τ²) / (1 + b² τ²)``, b
    the bulge: three values tell it, and a quadratic equation where it is extreme.
    """
    points = arc_points(arcs, np.array([-1.0, 0.0, 1.0]))
    before, middle, after = np.moveaxis(evaluate(rows[:, None], points), 1, 0)
    square = _bulges(arcs) ** 2
    q1 = (after - before) / 2 * (1 + square)
    q2 = (after + before) / 2 * (1 + square) - middle
    linear = 2 * (q2 - square * middle)
    root = linear + np.copysign(np.sqrt(linear**2 + 4 * square * q1**2), linear)
    near = np.divide(-2 * q1, root, out=np.zeros_like(q1), where=root != 0)
    bend = 2 * square * q1
    far = np.divide(root, bend, out=np.ones_like(q1), where=bend != 0)
    found: list[FloatArray] = [before, after]
    for place in (near, far):
        t = np.clip(place, -1.0, 1.0)
        found.append((middle + q1 * t + q2 * t**2) / (1 + square * t**2))
    values = np.stack(found)
    gradients = np.sqrt(np.maximum(1 + 4 * rows[:, 0] * values, 0.0))
    distances = -2 * values / (1 + gradients)
    return distances.min(axis=0), distances.max(axis=0)
