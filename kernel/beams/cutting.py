"""Cutting beams out of annuli: mitres between neighbours, or square ends at a node cylinder.

A mitre is the half plane through the node axis that bisects the angle between a beam and its
neighbour around the axis. What cannot be cut is listed with its reason.
"""

from dataclasses import replace

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, unit
from ..errors import InputError
from ..parts.records import RejectedPart, reject_parts
from ..support.annuli import Annuli
from ..support.annulus_checks import NO_CUT
from ..tolerances import MITRE_LIMIT, PARALLEL_PLANES
from .beams import Beams, cut_corners, insets_at, inward_directions


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

    References
    ----------
    Meshes with Spherical Faces, Fig. 7.
    """
    _check_options(thickness, node_gap, node_radius)
    annuli = _outer_side_up(annuli)
    if node_radius > 0:
        half_angles = np.full((annuli.n_annuli, 2, 2), np.pi / 2)
        push = node_radius + node_gap
    else:
        half_angles, push = mitre_angles(annuli), node_gap / 2
    levels, insets, is_flat = _end_cuts(half_angles, push, thickness / 2)
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
    ends = np.flatnonzero(np.diff(groups[order], append=-1))
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
    return half.reshape(-1, 2, 2) / 2


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
