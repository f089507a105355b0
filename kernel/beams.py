"""
Beams: annuli of a thickness, cut at the nodes so that neighbours do not run into each other.

A beam has two plane sides at half the thickness from the plane of its annulus, an outer and an
inner face (cylinders, or planes where the arcs are straight), and at each end one or two planes
that contain the direction of the node axis. All of them are ruled by lines along the end
direction, so an end is told by three levels across the thickness - the lower side, the ridge
where its two planes meet, the upper side - and by how far the cut lies inside at each.
"""

from dataclasses import dataclass, replace

import numpy as np

from .annuli import Annuli, select_annuli
from .arcs import Arcs, segment_areas, sphere_arcs
from .arrays import BoolArray, FloatArray, dot, norm, unit
from .beam_checks import RejectedBeam
from .errors import InputError
from .spheres import meet_lines, recenter, rescale
from .tolerances import MITRE_LIMIT, PARALLEL_PLANES


@dataclass(frozen=True)
class Beams:
    """
    Beams that can be made, in the order of their edges.

    Attributes
    ----------
    annuli : Annuli
        Planes, circles and ends, one row per beam; points are local to its origins.
    levels : (B, 2, 3) float array
        Heights, along the normal of the plane, of the lower side, the ridge and the upper side
        at both ends.
    insets : (B, 2, 3) float array
        Distances of the cut from the line of the end, into the beam, at the three levels;
        between them the cut is plane.
    is_flat : (B, 2) bool array
        Whether the end is one plane; its ridge is then a line of that plane.
    corners : (B, 2, 2, 3, 3) float array
        Corners at both ends, on the outer and on the inner face, at the three levels; local.
    sections : (B, 2, 2, 3) float array
        Corners of the section in the middle of the thickness: at both ends, outer and inner.
    thickness, node_gap, node_radius : float
        As they were asked for, in model units.
    """

    annuli: Annuli
    levels: FloatArray
    insets: FloatArray
    is_flat: BoolArray
    corners: FloatArray
    sections: FloatArray
    thickness: float
    node_gap: float
    node_radius: float

    @property
    def n_beams(self) -> int:
        """
        Number of beams.

        Returns
        -------
        int
            B.
        """
        return self.annuli.n_annuli


def cut_beams(
    annuli: Annuli, thickness: float, node_gap: float = 0.0, node_radius: float = 0.0
) -> tuple[Beams, tuple[RejectedBeam, ...]]:
    """
    Give annuli a thickness and cut their ends.

    Parameters
    ----------
    annuli : Annuli
        The annuli; at least one.
    thickness : float
        Thickness of the beams, half of it to either side, in model units.
    node_gap : float
        Width of the gap between neighbouring beams, or between beams and node cylinders.
    node_radius : float
        Radius of cylinders about the node axes at which beams end square; 0 for mitres.

    Returns
    -------
    beams : Beams
        The beams that can be made.
    rejected : tuple of RejectedBeam
        The others, each with its reason.

    Raises
    ------
    InputError
        If there are no annuli, or a length is negative or not finite, or the thickness zero.

    Notes
    -----
    A mitre is the half plane through the node axis that bisects the angle of a beam and its
    neighbour around the axis, on either side: neighbours touch in it, all beams of a node in
    the axis. Where the next beam is more than 270 degrees away, as for a single beam, the end
    is cut square on that side.

    References
    ----------
    Meshes with Spherical Faces, Fig. 7.
    """
    _check_options(annuli, thickness, node_gap, node_radius)
    annuli = _outer_side_up(annuli)
    if node_radius > 0:
        half_angles = np.full((annuli.n_annuli, 2, 2), np.pi / 2)
        push = node_radius + node_gap
    else:
        half_angles, push = mitre_angles(annuli), node_gap / 2
    levels, insets, is_flat = _end_cuts(half_angles, push, thickness / 2)
    corners, exists = _cut_corners(annuli, insets)
    middle = _inset_at(levels, insets, np.zeros(annuli.n_annuli))
    sections, section_exists = _cut_corners(annuli, middle[..., None])
    heights = levels[:, :, None, :, None] * annuli.frames[:, None, None, None, 2]
    beams = Beams(
        annuli, levels, insets, is_flat, corners + heights, sections[:, :, :, 0],
        float(thickness), float(node_gap), float(node_radius),
    )  # fmt: skip
    reasons = _rejection_reasons(beams, half_angles, exists & section_exists)
    rejected = tuple(
        RejectedBeam(annuli.ids[row], int(annuli.edge_ids[row]), reason)
        for row, reason in sorted(reasons.items())
    )
    keep = np.ones(annuli.n_annuli, bool)
    keep[list(reasons)] = False
    return select_beams(beams, keep), rejected


def _check_options(
    annuli: Annuli, thickness: float, node_gap: float, node_radius: float
) -> None:
    if annuli.n_annuli == 0:
        raise InputError("there are no annuli to make beams of")
    if not (np.isfinite(thickness) and thickness > 0):
        raise InputError(f"thickness must be a length above 0, not {thickness}")
    for name, value in (("node gap", node_gap), ("node radius", node_radius)):
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"{name} must be a length of at least 0, not {value}")


def _outer_side_up(annuli: Annuli) -> Annuli:
    """Annuli whose outer arc is that on the outer side: a power may lead to either side."""
    steps = annuli.corners[:, :, 1] - annuli.corners[:, :, 0]
    is_up = dot(steps, annuli.end_directions).sum(axis=1) < 0
    return replace(
        annuli,
        outer=np.where(is_up[:, None], annuli.inner, annuli.outer),
        inner=np.where(is_up[:, None], annuli.outer, annuli.inner),
        corners=np.where(
            is_up[:, None, None, None], annuli.corners[:, :, ::-1], annuli.corners
        ),
    )


def mitre_angles(annuli: Annuli) -> FloatArray:
    """
    Half the angles to the neighbouring beams around the node axes.

    Parameters
    ----------
    annuli : Annuli
        B annuli.

    Returns
    -------
    (B, 2, 2) float array
        At both ends, to the lower and to the upper side of the plane, in radians; a right
        angle where the neighbour is farther than twice `MITRE_LIMIT`.
    """
    axes = annuli.node_axes.reshape(-1, 3)
    away = inward_directions(annuli).reshape(-1, 3)
    away = unit(away - dot(away, axes)[:, None] * axes)
    _, first, groups = np.unique(
        annuli.edge_vertices.ravel(), return_index=True, return_inverse=True
    )
    zero = away[first][groups]
    turns = np.arctan2(dot(away, np.cross(axes, zero)), dot(away, zero))
    order = np.lexsort((turns, groups))
    starts = np.flatnonzero(np.diff(groups[order], prepend=-1))
    ends = np.append(starts[1:], len(order)) - 1
    following = np.arange(1, len(order) + 1)
    following[ends] = starts
    gaps = turns[order][following] - turns[order]
    gaps[ends] += 2 * np.pi
    after, before = np.empty(len(order)), np.empty(len(order))
    after[order] = gaps
    before[order[following]] = gaps
    normals = np.repeat(annuli.frames[:, 2], 2, axis=0)
    is_upper = dot(np.cross(axes, away), normals) > 0
    half = np.stack([np.where(is_upper, before, after), np.where(is_upper, after, before)], 1)
    half = half / 2
    return np.where(half > MITRE_LIMIT, np.pi / 2, half).reshape(-1, 2, 2)


def inward_directions(annuli: Annuli) -> FloatArray:
    """
    Unit vectors from the lines of the ends into the annuli, across them in their planes.

    Parameters
    ----------
    annuli : Annuli
        B annuli.

    Returns
    -------
    (B, 2, 3) float array
        Vectors at both ends.
    """
    across = np.cross(annuli.end_directions, annuli.frames[:, None, 2])
    outer = annuli.corners[:, :, 0]
    chords = outer[:, ::-1] - outer
    return np.where(dot(across, chords)[..., None] < 0, -across, across)


def _end_cuts(
    half_angles: FloatArray, push: float, half: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Levels and insets (B, 2, 3), and flatness (B, 2), of half planes pushed inwards."""
    lower, upper = half_angles[..., 0], half_angles[..., 1]
    total, difference = (lower + upper) / 2, (upper - lower) / 2
    # Beams in the same direction are rejected later; their cut is anywhere.
    reach = push / np.maximum(np.sin(total), PARALLEL_PLANES)
    ridge, ridge_level = reach * np.cos(difference), reach * np.sin(difference)
    sides = [
        (push + half * np.cos(angle)) / np.maximum(np.sin(angle), PARALLEL_PLANES)
        for angle in (lower, upper)
    ]
    is_flat = np.abs(np.pi - lower - upper) < PARALLEL_PLANES
    ridge = np.where(is_flat, (sides[0] + sides[1]) / 2, ridge)
    ridge_level = np.where(is_flat, 0.0, ridge_level)
    levels = np.stack([np.full_like(ridge, -half), ridge_level, np.full_like(ridge, half)], -1)
    return levels, np.stack([sides[0], ridge, sides[1]], -1), is_flat


def _inset_at(levels: FloatArray, insets: FloatArray, heights: FloatArray) -> FloatArray:
    """Insets (B, 2) of both ends at one height (B,) of each beam, between the levels."""
    height = heights[:, None]
    upper = height > levels[..., 1]
    near, far = insets[..., 1], np.where(upper, insets[..., 2], insets[..., 0])
    span = np.where(upper, levels[..., 2], levels[..., 0]) - levels[..., 1]
    share = np.divide(height - levels[..., 1], span, out=np.zeros_like(span), where=span != 0)
    return near + share * (far - near)


def _cut_corners(annuli: Annuli, insets: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Points of the plane (B, 2, 2, n, 3) where lines at insets (B, 2, n) meet both circles."""
    across = inward_directions(annuli)[:, :, None, None]
    points = annuli.corners[:, :, :, None] + insets[:, :, None, :, None] * across
    along = np.broadcast_to(annuli.end_directions[:, :, None, None], points.shape)
    rows = np.stack([annuli.outer, annuli.inner], 1)[:, None, :, None]
    rows = np.broadcast_to(rows, (*points.shape[:-1], 5))
    steps, exists = meet_lines(rows.reshape(-1, 5), points.reshape(-1, 3), along.reshape(-1, 3))
    steps, exists = steps.reshape(points.shape[:-1]), exists.reshape(points.shape[:-1])
    reaches = np.asarray(exists.reshape(len(points), -1).all(axis=1))
    return points + steps[..., None] * along, reaches


def _rejection_reasons(
    beams: Beams, half_angles: FloatArray, exists: BoolArray
) -> dict[int, str]:
    """Why beams cannot be cut; of several reasons the first."""
    reasons: dict[int, str] = {}

    def _note(is_bad: BoolArray, reason: str) -> None:
        for row in np.flatnonzero(is_bad).tolist():
            reasons.setdefault(row, reason)

    closest = half_angles.min(axis=(1, 2))
    _note(closest < PARALLEL_PLANES, "another beam leaves the node in the same direction")
    _note(~exists, "the cut of an end misses a circle: make the beams thinner")
    ridges = np.abs(beams.levels[..., 1]) >= beams.thickness / 2
    _note(
        np.asarray((ridges & ~beams.is_flat).any(axis=1)),
        "the node gap cuts off one mitre: use a smaller gap or thicker beams",
    )
    whole = beams.annuli.corners[:, 1] - beams.annuli.corners[:, 0]
    left = beams.corners[:, 1] - beams.corners[:, 0]
    backwards = dot(left, whole[:, :, None]) <= 0
    _note(
        np.asarray(backwards.any(axis=(1, 2))),
        "the cuts of the two ends cross: make the beams thinner or the node smaller",
    )
    return reasons


def select_beams(beams: Beams, keep: BoolArray) -> Beams:
    """
    Some of the beams.

    Parameters
    ----------
    beams : Beams
        B beams.
    keep : (B,) bool array
        Which ones.

    Returns
    -------
    Beams
        The chosen beams, in the same order.
    """
    return replace(
        beams,
        annuli=select_annuli(beams.annuli, keep),
        levels=beams.levels[keep],
        insets=beams.insets[keep],
        is_flat=beams.is_flat[keep],
        corners=beams.corners[keep],
        sections=beams.sections[keep],
    )


def scale_beams(beams: Beams, factor: float) -> Beams:
    """
    Beams in another unit of length.

    Parameters
    ----------
    beams : Beams
        B beams.
    factor : float
        Positive number of new units in an old one.

    Returns
    -------
    Beams
        The same beams; every length is multiplied by the factor.
    """
    annuli = beams.annuli
    scaled = replace(
        annuli,
        origins=annuli.origins * factor,
        outer=rescale(annuli.outer, factor),
        inner=rescale(annuli.inner, factor),
        corners=annuli.corners * factor,
        kappa=annuli.kappa * factor**2,
        depth=annuli.depth * factor,
    )
    return replace(
        beams,
        annuli=scaled,
        levels=beams.levels * factor,
        insets=beams.insets * factor,
        corners=beams.corners * factor,
        sections=beams.sections * factor,
        thickness=beams.thickness * factor,
        node_gap=beams.node_gap * factor,
        node_radius=beams.node_radius * factor,
    )


def section_arcs(beams: Beams) -> tuple[Arcs, Arcs]:
    """
    Outer and inner arcs in the middle of the thickness, between the cuts of the ends.

    Parameters
    ----------
    beams : Beams
        B beams.

    Returns
    -------
    outer, inner : Arcs
        B arcs each, local, from the first to the second end.
    """
    return _level_arcs(beams, beams.sections, np.zeros(beams.n_beams))


def side_arcs(beams: Beams, level: int) -> tuple[Arcs, Arcs]:
    """
    Outer and inner arcs that bound a side.

    Parameters
    ----------
    beams : Beams
        B beams.
    level : int
        0 for the lower, 2 for the upper side.

    Returns
    -------
    outer, inner : Arcs
        B arcs each, local, from the first to the second end.
    """
    return _level_arcs(beams, beams.corners[:, :, :, level], beams.levels[:, 0, level])


def _level_arcs(beams: Beams, corners: FloatArray, heights: FloatArray) -> tuple[Arcs, Arcs]:
    planes = beams.annuli.frames[:, 2]
    lift = heights[:, None] * planes
    outer, inner = (
        sphere_arcs(recenter(rows, -lift), -planes, corners[:, 0, k], corners[:, 1, k])
        for k, rows in enumerate((beams.annuli.outer, beams.annuli.inner))
    )
    return outer, inner


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def beam_volumes(beams: Beams) -> FloatArray:
    """
    Volumes of beams.

    Parameters
    ----------
    beams : Beams
        B beams.

    Returns
    -------
    (B,) float array
        Volumes, in cubed model units: the areas of plane sections, integrated over the
        thickness with 6 Gauss points between the levels of the two ridges.
    """
    half = np.full(beams.n_beams, beams.thickness / 2)
    ridges = np.sort(beams.levels[:, :, 1], axis=1)
    bounds = np.column_stack([-half, ridges, half])
    total = np.zeros(beams.n_beams)
    for low, high in zip(bounds.T[:-1], bounds.T[1:], strict=True):
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            heights = (low + high) / 2 + node * (high - low) / 2
            total += weight * (high - low) / 2 * _section_areas(beams, heights)
    return total


def _section_areas(beams: Beams, heights: FloatArray) -> FloatArray:
    insets = _inset_at(beams.levels, beams.insets, heights)
    corners = _cut_corners(beams.annuli, insets[..., None])[0][:, :, :, 0]
    outer, inner = _level_arcs(beams, corners, np.zeros(beams.n_beams))
    diagonal, other = outer.ends - inner.starts, outer.starts - inner.ends
    quadrilaterals = dot(np.cross(diagonal, other), beams.annuli.frames[:, 2]) / 2
    return quadrilaterals + segment_areas(outer) - segment_areas(inner)


def node_axis_segments(beams: Beams) -> tuple[tuple[int, ...], FloatArray]:
    """
    The lines in which the beams of each node meet.

    Parameters
    ----------
    beams : Beams
        B beams.

    Returns
    -------
    vertices : tuple of int
        The vertices that carry beams.
    segments : (n, 2, 3) float array
        Outer and inner corner at each, of its first beam, in model coordinates.
    """
    annuli = beams.annuli
    vertices, first = np.unique(annuli.edge_vertices.ravel(), return_index=True)
    corners = annuli.corners.reshape(-1, 2, 3) + np.repeat(annuli.origins, 2, axis=0)[:, None]
    return tuple(vertices.tolist()), corners[first]


def beam_lengths(beams: Beams) -> FloatArray:
    """
    Largest lengths of the pieces.

    Parameters
    ----------
    beams : Beams
        B beams.

    Returns
    -------
    (B,) float array
        Longest chord between the corners of the two ends, in model units.
    """
    ends = beams.corners.reshape(beams.n_beams, 2, -1, 3)
    return norm(ends[:, 0, :, None] - ends[:, 1, None]).max(axis=(1, 2))
