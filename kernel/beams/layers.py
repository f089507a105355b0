"""Layers: beams begin below the panels that rest on them, at a clear distance.

The top of a beam is flat across its thickness, and panels slope away from its middle or bulge
into it. Along the normal n of the plane of a beam, the left side of a sphere's equation changes
by ``A z² - (B·n) z``, whatever the point of the plane: what a panel takes of the thickness is
one number, and a top that clears the panel is a circle in the plane of the beam that is clear
of the panel's own, raised by that number. So the depth that a beam needs is exact.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..errors import InputError
from ..panels.panels import Panels, panel_arcs
from ..parts.records import RejectedPart, reject_parts
from ..spheres.arcs import Arcs, arc_distances, arc_reaches, sphere_arcs
from ..spheres.incidence import evaluate, meet_lines, normals
from ..spheres.minkowski import minkowski
from ..spheres.rows import offset, recenter
from ..support.annuli import Annuli, end_depths
from ..support.annulus_checks import NO_ANNULUS, inner_reasons
from .beams import Beams, cut_corners, level_arcs
from .cutting import (
    cut_beams,
    mitre_normals,
    neighbor_angles,
    node_points,
    outer_side_up,
)


@dataclass(frozen=True)
class _Rests:
    """What rests on beams: R pairs of a beam and a panel beside it.

    Attributes
    ----------
    beams, panels : (R,) int array
    rows : (R, 5) float array
        Unit rows orthogonal to the planes of the beams, local to them: tops of beams are clear
        of the panels where they are inside of these.
    exists : (R,) bool array
        Whether the row is real.
    """

    beams: IntArray
    panels: IntArray
    rows: FloatArray
    exists: BoolArray


def beams_under_panels(
    annuli: Annuli,
    panels: Panels,
    thickness: float,
    node_gap: float = 0.0,
    node_radius: float = 0.0,
    bearing: float = 0.0,
) -> tuple[Beams, tuple[RejectedPart, ...]]:
    """Lower annuli until panels rest on them, and cut beams out of them.

    Parameters
    ----------
    annuli : Annuli
        Their depth is kept, and begins at the new upper edge.
    panels : Panels
        Whatever the side of their thickness and their joint; beams without a panel beside them
        follow the others at their nodes.
    thickness, node_gap, node_radius : float
        As in `cut_beams`.
    bearing : float
        Clear distance from panel to beam, in model units; 0 where they touch.

    Returns
    -------
    beams : Beams
        The beams that can be made. All beams of a node have their upper corners at one level
        of its axis, the lowest that one of them needs.
    rejected : tuple of RejectedPart
        The others, each with its reason.

    Raises
    ------
    InputError
        If a length is negative or not finite, or the thickness zero.
    """
    if not (np.isfinite(bearing) and bearing >= 0):
        raise InputError(f"bearing must be a length of at least 0, not {bearing}")
    annuli = outer_side_up(annuli)
    if annuli.n_annuli == 0 or panels.n_panels == 0:
        return cut_beams(annuli, thickness, node_gap, node_radius)
    rests = _rests(annuli, panels, thickness, bearing)
    lowered = _lowered(annuli, rests)
    size = float(norm(lowered.corners[:, 1, 0] - lowered.corners[:, 0, 0]).mean())
    reasons = dict.fromkeys(
        rests.beams[~rests.exists], "the panel above leaves no room for a beam"
    )
    reasons |= inner_reasons(lowered, size)
    lowered, refused = reject_parts(lowered, reasons, NO_ANNULUS)
    beams, rejected = cut_beams(lowered, thickness, node_gap, node_radius)
    if node_radius > 0:
        tops = _cylinder_tops(beams.annuli, panels, node_radius, bearing)
        beams = replace(beams, cylinder_tops=tops)
    return beams, (*refused, *rejected)


def lowered_annuli(
    annuli: Annuli, panels: Panels, thickness: float, bearing: float = 0.0
) -> Annuli:
    """Annuli below the panels that rest on them, as `beams_under_panels` has them."""
    annuli = outer_side_up(annuli)
    if annuli.n_annuli == 0 or panels.n_panels == 0:
        return annuli
    return _lowered(annuli, _rests(annuli, panels, thickness, bearing))


def _rests(annuli: Annuli, panels: Panels, thickness: float, bearing: float) -> _Rests:
    """The panels left and right of beams, and the circles below which their tops are clear."""
    beams, sides = np.nonzero(_panel_rows(panels, annuli.edge_faces) >= 0)
    found = _panel_rows(panels, annuli.edge_faces)[beams, sides]
    shifts = annuli.origins[beams] - panels.origins[found]
    rows = recenter(offset(panels.inner_spheres[found], -bearing), shifts)
    planes = annuli.frames[beams, 2]
    side = np.where(sides == 0, -1.0, 1.0)
    slopes = dot(rows[:, 1:4], planes)
    # A panel lies over its own side of the beam and as far beyond the middle as its edge does.
    beyond = _edge_reach(panels, found, shifts, -side[:, None] * planes)
    near = -side * np.clip(beyond, -thickness / 2, thickness / 2)
    far = side * thickness / 2
    curvature = rows[:, 0]
    inside = np.divide(slopes, 2 * curvature, out=near.copy(), where=curvature > 0)
    inside = np.clip(inside, np.minimum(near, far), np.maximum(near, far))
    least = np.min([curvature * z**2 - slopes * z for z in (near, far, inside)], axis=0)
    flat = rows.copy()
    flat[:, 1:4] -= slopes[:, None] * planes
    flat[:, 4] += least
    square = minkowski(flat, flat)
    flat /= np.sqrt(np.where(square > 0, square, 1.0))[:, None]
    return _Rests(beams, found, flat, square > 0)


def rest_clearances(beams: Beams, panels: Panels) -> tuple[IntArray, IntArray, FloatArray]:
    """How far tops of beams are below the panels that rest on them.

    Rows (n,) of beams and of the panels beside them, and distances in the planes of the beams:
    of the whole top as far as any of its ends reaches, over the side of the panel. Negative
    where it reaches into the panel, whose sphere is taken to go on.
    """
    annuli = beams.annuli
    rests = _rests(annuli, panels, beams.thickness, 0.0)
    widest = beams.insets.min(axis=2, keepdims=True)
    corners = cut_corners(annuli, widest)[0][:, :, :, 0]
    outer, _ = level_arcs(beams, corners, np.zeros(beams.n_beams))
    arcs = Arcs(*(values[rests.beams] for values in vars(outer).values()))
    _, highest = arc_distances(rests.rows, arcs)
    return rests.beams, rests.panels, np.where(rests.exists, -highest, -np.inf)


def _panel_rows(panels: Panels, faces: IntArray) -> IntArray:
    """Row of the panel of each face; -1 where there is none."""
    size = max(int(faces.max(initial=0)), int(panels.face_ids.max(initial=0)))
    rows = np.full(size + 2, -1)
    rows[panels.face_ids] = np.arange(panels.n_panels)
    return rows[faces]


def _edge_reach(
    panels: Panels, found: IntArray, shifts: FloatArray, directions: FloatArray
) -> FloatArray:
    """How far the edges of panels (R) that run along beams reach in directions.

    From the origins of the beams, at `shifts` from those of the panels; of the edges of a panel
    the one is meant whose middle is nearest to that origin.
    """
    degrees = panels.degrees[found]
    pairs = np.repeat(np.arange(len(found)), degrees)
    first = np.cumsum(degrees) - degrees
    corners = np.arange(len(pairs)) - first[pairs] + panels.offsets[found][pairs]
    middles = (panels.corners + panels.corners[panels.next_corners])[corners] / 2
    distances = norm(middles - shifts[pairs])
    order = np.lexsort((distances, pairs))
    edges = corners[order[first]]
    reach = np.full(len(found), -np.inf)
    for face in ("outer", "inner"):
        arcs = panel_arcs(panels, face)
        chosen = Arcs(*(values[edges] for values in vars(arcs).values()))
        planes = panels.plane_normals[edges]
        across = dot(directions, planes)
        within = directions - across[:, None] * planes
        high = norm(within) * arc_reaches(chosen, unit(within))
        reach = np.maximum(reach, high + across * dot(chosen.starts, planes))
    return reach - dot(shifts, directions)


def _lowered(annuli: Annuli, rests: _Rests) -> Annuli:
    """Annuli of the same depth at the ends, below the circles of what rests on them."""
    shape = annuli.n_annuli, 2
    axes, directions = annuli.node_axes, annuli.end_directions
    along = dot(axes, directions)
    levels = dot(annuli.corners[:, :, 0] - node_points(annuli), axes)
    needed = np.full(shape, -np.inf)
    tops = annuli.corners[rests.beams, :, 0].reshape(-1, 3)
    steps, _ = meet_lines(
        np.repeat(rests.rows, 2, axis=0), tops, directions[rests.beams].reshape(-1, 3)
    )
    steps = levels[rests.beams] + (steps.reshape(-1, 2) * along[rests.beams])
    np.maximum.at(needed, rests.beams, steps)
    _, groups = np.unique(annuli.edge_vertices.ravel(), return_inverse=True)
    of_nodes = np.full(groups.max() + 1, -np.inf)
    np.maximum.at(of_nodes, groups, needed.ravel())
    goal = of_nodes[groups].reshape(shape)
    drops = np.where(np.isfinite(goal), (goal - levels) / along, 0.0)
    outer_corners = annuli.corners[:, :, 0] + drops[..., None] * directions
    inner_corners = outer_corners + end_depths(annuli)[..., None] * directions
    outer = circles_through(annuli.outer, outer_corners)
    # Of the two arcs that are parallel to the panels, the lower one is clear of both.
    candidates = circles_through(rests.rows, outer_corners[rests.beams])
    planes = annuli.frames[rests.beams, 2]
    ends = np.moveaxis(outer_corners[rests.beams], 1, 0)
    heights = sphere_arcs(candidates, -planes, ends[0], ends[1]).sagittas
    order = np.lexsort((heights, rests.beams))
    carrying, lowest = np.unique(rests.beams[order], return_index=True)
    outer[carrying] = candidates[order[lowest]]
    return replace(
        annuli,
        outer=outer,
        inner=circles_through(outer, inner_corners),
        corners=np.stack([outer_corners, inner_corners], 2),
    )


def circles_through(rows: FloatArray, corners: FloatArray) -> FloatArray:
    """Circles through two points each that are nearest to parallel ones.

    Unit rows (n, 5) of spheres that have circles as great circles, and points (n, 2, 3) of
    their planes. Of the circles through both points that one whose centre is nearest: it is
    concentric where both are as far from the given circle, and a line stays a line. The rows
    keep their scale where no circle is left.

    Notes
    -----
    The row minus a linear function that vanishes it at both points and changes along their
    chord only.
    """
    middles, chords = corners.mean(axis=1), corners[:, 1] - corners[:, 0]
    levels = evaluate(rows[:, None], corners)
    square = dot(chords, chords)
    change = np.divide(
        levels[:, 1] - levels[:, 0], square, out=np.zeros_like(square), where=square > 0
    )
    slopes = change[:, None] * chords
    result = rows.copy()
    result[:, 1:4] += slopes
    result[:, 4] += dot(slopes, middles) - levels.mean(axis=1)
    norms = minkowski(result, result)
    return result / np.sqrt(np.where(norms > 0, norms, 1.0))[:, None]


def _cylinder_tops(annuli: Annuli, panels: Panels, radius: float, bearing: float) -> FloatArray:
    """Levels (B, 2) of discs about the node axes that are clear of the panels beside beams.

    From the outer corners of the beams, along the axes to the inner side; each panel is asked
    for the sector from a beam to the next one. Without any panel discs begin at the corners.
    """
    beams, sides = np.nonzero(_panel_rows(panels, annuli.edge_faces) >= 0)
    found = _panel_rows(panels, annuli.edge_faces)[beams, sides]
    shifts = annuli.origins[beams] - panels.origins[found]
    rows = recenter(offset(panels.inner_spheres[found], -bearing), shifts)
    result = np.full((annuli.n_annuli, 2), -np.inf)
    centers, axes = node_points(annuli)[beams], annuli.node_axes[beams]
    starts = dot(annuli.corners[beams, :, 0] - centers, axes)
    widths = 2 * neighbor_angles(annuli)[beams, :, sides]
    along, across = (
        mitre_normals(annuli, np.full((annuli.n_annuli, 2, 2), angle))[beams, :, sides]
        for angle in (np.pi / 2, np.pi)
    )
    for end in (0, 1):
        slope = normals(rows, centers[:, end])
        u, w = dot(slope, along[:, end]), dot(slope, across[:, end])
        width = widths[:, end]
        steepest = np.arctan2(w, u) % (2 * np.pi)
        at_ends = np.maximum(u, u * np.cos(width) + w * np.sin(width))
        rise = np.where(steepest <= width, np.hypot(u, w), at_ends)
        lifted = rows.copy()
        lifted[:, 4] += _least_on_ray(rows[:, 0], np.maximum(rise, 0.0), radius)
        levels, exists = meet_lines(lifted, centers[:, end], axes[:, end])
        levels = np.where(exists, levels, 0.0) - starts[:, end]
        np.maximum.at(result[:, end], beams, levels)
    result[np.isneginf(result)] = 0.0
    return result


def _least_on_ray(curvature: FloatArray, slope: FloatArray, length: float) -> FloatArray:
    """Least value of ``A r² - k r`` for r from 0 to a length, with slopes k of at least 0."""
    turn = np.divide(slope, 2 * curvature, out=np.full_like(slope, np.inf), where=curvature > 0)
    reach = np.minimum(turn, length)
    return np.minimum(0.0, curvature * reach**2 - slope * reach)
