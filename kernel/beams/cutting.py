"""Cutting beams out of annuli: mitres between neighbours, or square ends at a node cylinder.

A mitre is the half plane through the node axis that bisects the angle between a beam and its
neighbour around the axis. What cannot be cut is listed with its reason.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, sum_by, unit
from ..errors import InputError
from ..parts.records import RejectedPart, reject_parts
from ..support.annuli import Annuli
from ..support.annulus_checks import NO_CUT
from ..tolerances import MITRE_LIMIT, PARALLEL_PLANES
from .beams import Beams, cut_corners, insets_at, inward_directions

_ROUNDS = 5


def cut_beams(
    annuli: Annuli, thickness: float, node_gap: float = 0.0, node_radius: float = 0.0
) -> tuple[Beams, tuple[RejectedPart, ...]]:
    """Give annuli a thickness and cut their ends.

    Parameters
    ----------
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
    rejected : tuple of RejectedPart
        The others, each with its reason.

    Raises
    ------
    InputError
        If a length is negative or not finite, or the thickness zero.

    Notes
    -----
    A mitre is the half plane through the node axis that bisects the angle of a beam and its
    neighbour around the axis, on either side: neighbours touch in it, all beams of a node in
    the axis. Where the next beam is more than 270 degrees away, as for a single beam, the end
    is cut square on that side.

    The axis of a node is one line for all of its beams, through the mean of their outer
    corners. Where the plane of a beam misses it, cuts stay parallel to the line of the end and
    go as far in as the half plane does over the depth of the end: twisted beams leave a gap
    and never overlap.

    References
    ----------
    Meshes with Spherical Faces, Fig. 7.
    """
    _check_options(thickness, node_gap, node_radius)
    annuli = outer_side_up(annuli)
    if node_radius > 0:
        half_angles = np.full((annuli.n_annuli, 2, 2), np.pi / 2)
        push = node_radius + node_gap
    else:
        half_angles, push = mitre_angles(annuli), node_gap / 2
    cuts = _end_cuts(*_slanted(annuli, half_angles, push, annuli.corners), thickness / 2)
    # How far ends reach along their lines depends on where they are cut, by a hair.
    for _ in range(_ROUNDS):
        ends = cut_corners(annuli, cuts[1])[0].reshape(annuli.n_annuli, 2, 6, 3)
        cuts = _end_cuts(*_slanted(annuli, half_angles, push, ends), thickness / 2)
    levels, insets, is_flat = cuts
    corners, exists = cut_corners(annuli, insets)
    middle = insets_at(levels, insets, np.zeros(annuli.n_annuli))
    sections, section_exists = cut_corners(annuli, middle[..., None])
    heights = levels[:, :, None, :, None] * annuli.frames[:, None, None, None, 2]
    beams = Beams(
        annuli, levels, insets, is_flat, corners + heights, sections[:, :, :, 0],
        float(thickness), float(node_gap), float(node_radius),
    )  # fmt: skip
    reasons = _rejection_reasons(beams, half_angles, exists & section_exists)
    return reject_parts(beams, reasons, NO_CUT)


def _check_options(thickness: float, node_gap: float, node_radius: float) -> None:
    if not (np.isfinite(thickness) and thickness > 0):
        raise InputError(f"thickness must be a length above 0, not {thickness}")
    for name, value in (("node gap", node_gap), ("node radius", node_radius)):
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"{name} must be a length of at least 0, not {value}")


def outer_side_up(annuli: Annuli) -> Annuli:
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
    """Half angles (B, 2, 2) at which mitres are cut: those of `neighbor_angles`.

    A right angle where the neighbour is farther than twice `MITRE_LIMIT`.
    """
    half = neighbor_angles(annuli)
    return np.where(half > MITRE_LIMIT, np.pi / 2, half)


def neighbor_angles(annuli: Annuli) -> FloatArray:
    """Half the angles to the neighbouring beams around the node axes, (B, 2, 2).

    At both ends, to the lower and to the upper side of the plane, in radians; half a turn for a
    single beam.
    """
    ends = node_rings(annuli)
    before = np.empty(len(ends.angles))
    before[ends.following] = ends.angles
    normals = np.repeat(annuli.frames[:, 2], 2, axis=0)
    is_upper = (dot(ends.left, normals) > 0)[:, None]
    sides = np.stack([ends.angles, before], 1)
    half = np.where(is_upper, sides[:, ::-1], sides)
    return half.reshape(-1, 2, 2) / 2


class BeamEnds(NamedTuple):
    """The ends (2B) of beams, seen along their node axes.

    Attributes
    ----------
    left : (2B, 3) float array
        Unit directions to their left.
    following : (2B,) int array
        The end that follows there around the node.
    angles : (2B,) float array
        The angle to it, in radians; a whole turn for a single beam.
    """

    left: FloatArray
    following: IntArray
    angles: FloatArray


def node_rings(annuli: Annuli) -> BeamEnds:
    """The ends of beams in their order around the nodes."""
    axes = annuli.node_axes.reshape(-1, 3)
    away = inward_directions(annuli).reshape(-1, 3)
    away = unit(away - dot(away, axes)[:, None] * axes)
    _, first, groups = np.unique(
        annuli.edge_vertices.ravel(), return_index=True, return_inverse=True
    )
    zero = away[first][groups]
    turns = np.arctan2(dot(away, np.cross(axes, zero)), dot(away, zero))
    order = np.lexsort((turns, groups))
    last = np.flatnonzero(np.diff(groups[order], append=-1))
    ahead = np.arange(1, len(order) + 1)
    ahead[last] = np.flatnonzero(np.diff(groups[order], prepend=-1))
    gaps = turns[order][ahead] - turns[order]
    gaps[last] += 2 * np.pi
    following, angles = np.empty(len(order), np.int64), np.empty(len(order))
    following[order], angles[order] = order[ahead], gaps
    return BeamEnds(np.cross(axes, away), following, angles)


def node_points(annuli: Annuli) -> FloatArray:
    """Points (B, 2, 3) of the node axes at both ends: the mean of the outer corners there.

    Local to each annulus.
    """
    _, first, groups = np.unique(
        annuli.edge_vertices.ravel(), return_index=True, return_inverse=True
    )
    # Seen from the first beam of each node, coordinates keep their digits.
    origins = np.repeat(annuli.origins, 2, axis=0)
    shifts = origins - origins[first][groups]
    tops = annuli.corners[:, :, 0].reshape(-1, 3) + shifts
    means = sum_by(groups, tops, len(first)) / np.bincount(groups)[:, None]
    return (means[groups] - shifts).reshape(-1, 2, 3)


def mitre_normals(annuli: Annuli, half_angles: FloatArray) -> FloatArray:
    """Unit normals (B, 2, 2, 3), into the beams, of half planes through the node axes.

    At both ends, on the lower and on the upper side, at half angles (B, 2, 2) from the beams.
    """
    axes, planes = annuli.node_axes, annuli.frames[:, None, 2]
    away = inward_directions(annuli)
    away = unit(away - dot(away, axes)[..., None] * axes)
    across = np.cross(axes, away)
    across = np.where(dot(across, planes)[..., None] < 0, -across, across)
    sides = np.stack([-across, across], 2)
    sine, cosine = np.sin(half_angles)[..., None], np.cos(half_angles)[..., None]
    return sine * away[:, :, None] - cosine * sides


def _slanted(
    annuli: Annuli, half_angles: FloatArray, push: float, ends: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Half angles and pushes (B, 2, 2) of cuts along the lines of the ends.

    They stay behind the half planes through the node axes, pushed inwards, as far along the
    lines as points of the ends (B, 2, n, 3) are. Where there is no torsion, they are these half
    planes.
    """
    mitres = mitre_normals(annuli, half_angles)
    sine = dot(mitres, inward_directions(annuli)[:, :, None])
    cosine = dot(mitres, annuli.frames[:, None, None, 2]) * np.array([1.0, -1.0])
    length = np.hypot(sine, cosine)
    tops, down = annuli.corners[:, :, 0], annuli.end_directions
    apart = dot(mitres, (tops - node_points(annuli))[:, :, None])
    reach = dot(ends - tops[:, :, None], down[:, :, None])
    slope = dot(mitres, down[:, :, None])
    distances = np.minimum(
        slope * reach.min(axis=2)[..., None], slope * reach.max(axis=2)[..., None]
    )
    return np.arctan2(sine, cosine), (push - apart - distances) / length


def _end_cuts(
    half_angles: FloatArray, pushes: FloatArray, half: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Levels and insets (B, 2, 3), and flatness (B, 2), of half planes pushed inwards.

    One plane cuts the whole end where both are one, or meet beyond the sides.
    """
    lower, upper = np.moveaxis(half_angles, 2, 0)
    sines = np.maximum(np.sin(half_angles), PARALLEL_PLANES)
    # Beams in the same direction are rejected later; their cut is anywhere.
    middles, slopes = pushes / sines, np.cos(half_angles) / sines
    total = np.sin(lower + upper)
    is_one = np.abs(np.pi - lower - upper) < PARALLEL_PLANES
    divisor = np.where(is_one, 1.0, total)
    ridge = dot(pushes, np.cos(half_angles[..., ::-1])) / divisor
    level = (np.sin(upper) * pushes[..., 0] - np.sin(lower) * pushes[..., 1]) / divisor
    sides = middles + half * slopes
    # Where a ridge would be beyond the sides, the plane that goes farther in cuts it all.
    is_flat = is_one | (np.abs(level) >= half)
    by_upper = (middles[..., 1] > middles[..., 0]) & ~is_one
    whole = np.where(by_upper, middles[..., 1], middles[..., 0])
    slope = np.where(by_upper, -slopes[..., 1], slopes[..., 0])
    first = np.where(is_flat & ~is_one, whole + half * slope, sides[..., 0])
    last = np.where(is_flat & ~is_one, whole - half * slope, sides[..., 1])
    ridge = np.where(is_flat, (first + last) / 2, ridge)
    level = np.where(is_flat, 0.0, level)
    levels = np.stack([np.full_like(ridge, -half), level, np.full_like(ridge, half)], -1)
    return levels, np.stack([first, ridge, last], -1), is_flat


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
    _note(
        ~exists, "the cut of an end misses a circle: make the beams thinner or the node smaller"
    )
    whole = beams.annuli.corners[:, 1] - beams.annuli.corners[:, 0]
    left = beams.corners[:, 1] - beams.corners[:, 0]
    backwards = dot(left, whole[:, :, None]) <= 0
    _note(
        np.asarray(backwards.any(axis=(1, 2))),
        "the cuts of the two ends cross: make the beams thinner or the node smaller",
    )
    return reasons
