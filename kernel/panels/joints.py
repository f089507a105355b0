"""Joints between panels: steps, gaps and holes, anywhere along an edge and at its nodes."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, batches_by_count, dot, norm, unit
from ..solvers.weighted_graphs import piece_labels
from ..spheres.arcs import Arcs, arc_distances, sphere_arcs
from ..spheres.incidence import meet_lines
from ..spheres.minkowski import minkowski
from ..spheres.rows import recenter
from ..tolerances import PARALLEL_PLANES
from .panels import Panels, corner_points, opposite_corners


@dataclass(frozen=True)
class PanelJoints:
    """How panels fit their neighbours, per edge or corner, in the unit of the panels.

    Attributes
    ----------
    steps : (H,) float array
        Across the surface: greatest height of one outer edge over the other, anywhere along
        the joint; NaN where there is no neighbour.
    gaps : (H,) float array
        In the surface: greatest distance of the two walls beyond the width of the joint, 0
        where they are no farther apart; NaN where there is no neighbour.
    holes : (H,) float array
        How far the corners at the node of each corner are apart, across the lines in which
        edges meet there, without the joint; 0 at nodes of the boundary.
    """

    steps: FloatArray
    gaps: FloatArray
    holes: FloatArray


def panel_joints(panels: Panels) -> PanelJoints:
    """Measure the joints of panels."""
    twins = opposite_corners(panels)
    first = np.flatnonzero(twins > np.arange(len(twins)))
    steps, gaps = np.full((2, len(twins)), np.nan)
    if len(first):
        found = _along_joints(panels, first, twins[first])
        steps[first], gaps[first] = found
        steps[twins[first]], gaps[twins[first]] = found
    return PanelJoints(steps, gaps, _holes(panels))


def _along_joints(
    panels: Panels, first: IntArray, second: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Steps and gaps of pairs of edges, seen in the plane halfway between their walls."""
    owners, following = panels.corner_panels, panels.next_corners
    own, other = owners[first], owners[second]
    shift = panels.origins[other] - panels.origins[own]
    starts = np.stack([panels.corners[first], panels.corners[following[second]] + shift], 1)
    ends = np.stack([panels.corners[following[first]], panels.corners[second] + shift], 1)
    middle = (starts + ends).mean(axis=1) / 2
    normals = panels.plane_normals
    away: FloatArray = np.subtract(normals[first], normals[second])
    normal = unit(away)
    chord: FloatArray = (ends - starts).mean(axis=1)
    chord = chord - dot(chord, normal)[:, None] * normal
    across: FloatArray = np.cross(chord, normal)
    rise = unit(across)
    rows = np.stack([panels.spheres[own], recenter(panels.spheres[other], -shift)], 1)
    circles = recenter(rows, middle[:, None])
    slopes = dot(circles[..., 1:4], normal[:, None])
    circles[..., 1:4] -= slopes[..., None] * normal[:, None]
    square = minkowski(circles, circles)
    circles /= np.sqrt(np.where(square > 0, square, 1.0))[..., None]
    arcs: list[Arcs] = []
    for k in (0, 1):
        points = [_onto(corners[:, k] - middle, normal) for corners in (starts, ends)]
        heights = [meet_lines(circles[:, k], point, rise)[0] for point in points]
        a, b = (p + h[:, None] * rise for p, h in zip(points, heights, strict=True))
        arcs.append(sphere_arcs(circles[:, k], normal, a, b))
    apart = [np.abs(arc_distances(circles[:, 1 - k], arcs[k])).max(axis=0) for k in (0, 1)]
    # The normal points into the first panel. Walls are plane, and farthest apart at an end.
    opening = dot(np.stack([starts, ends], 1), normal[:, None, None])
    opening = (opening[:, :, 0] - opening[:, :, 1]).max(axis=1) - panels.joint_gap
    return np.maximum(*apart), np.maximum(opening, 0.0)


def _onto(points: FloatArray, normals: FloatArray) -> FloatArray:
    return points - dot(points, normals)[:, None] * normals


def corner_nodes(panels: Panels) -> IntArray:
    """The node of each corner (H,): corners that neighbours share across edges have one."""
    twins = opposite_corners(panels)
    has_twin = np.flatnonzero(twins >= 0)
    return piece_labels(has_twin, panels.next_corners[twins[has_twin]], len(twins))


def unjointed_corners(panels: Panels) -> tuple[FloatArray, FloatArray]:
    """Corners (H, 3) of the outer and inner faces as they would be without joints; local."""
    planes = panels.plane_normals, panels.plane_offsets - panels.joint_gap / 2, panels.offsets
    outer, inner = (
        corner_points(rows[panels.corner_panels], *planes, corners)[0]
        for rows, corners in (
            (panels.spheres, panels.corners),
            (panels.inner_spheres, panels.inner_corners),
        )
    )
    return outer, inner


def _holes(panels: Panels) -> FloatArray:
    """Extents (H,) of the corners at each node, across the lines of their edges."""
    owners = panels.corner_panels
    corners = np.stack(unjointed_corners(panels), 1)
    up = panels.spheres[owners, 1:4]
    previous = np.empty(len(owners), np.int64)
    previous[panels.next_corners] = np.arange(len(owners))
    lines = np.cross(panels.plane_normals[previous], panels.plane_normals)
    # Where edges are in line, the sphere's own normal has to do.
    lines = np.where(dot(lines, up)[:, None] < 0, -lines, lines)
    lines += PARALLEL_PLANES * up
    nodes, twins = corner_nodes(panels), opposite_corners(panels)
    is_open = np.zeros(len(owners), bool)
    is_open[nodes[(twins < 0) | (twins[previous] < 0)]] = True
    inside = np.flatnonzero(~is_open[nodes])
    result = np.zeros(len(owners))
    for _, rows in batches_by_count(nodes[inside], int(nodes.max(initial=-1)) + 1):
        members = inside[rows]
        shifts = panels.origins[owners[members]] - panels.origins[owners[members[:, :1]]]
        points = corners[members] + shifts[:, :, None]
        axis = unit(lines[members].sum(axis=1))[:, None, None]
        points = points - dot(points, axis)[..., None] * axis
        apart = norm(points[:, :, None] - points[:, None]).max(axis=(1, 2, 3))
        result[members] = apart[:, None]
    return result
