"""Drilling marks: where beams are bolted at their nodes, along the lines of their ends.

A row of holes lies on a line parallel to the node axis, at a distance from the cut end; every
hole has the same share of that line. Marks are kept with the beams, for whoever draws them.
"""

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray, dot, norm
from ..errors import InputError
from ..parts.findings import Finding
from ..spheres.incidence import signed_distance
from .beams import Beams, DrillMarks, cut_corners, inward_directions

NO_MARKS = "B208"
"""Code of a beam into which the marks asked for do not fit."""


def drill_beams(
    beams: Beams, count: int, diameter: float, inset: float
) -> tuple[Beams, tuple[Finding, ...]]:
    """Mark the holes at both ends of beams.

    Parameters
    ----------
    beams : Beams
        B beams; marks that they have are replaced.
    count : int
        Number of holes at each end.
    diameter : float
        Diameter of the holes, in model units.
    inset : float
        Distance of their centres from the end, in model units: from where its cut reaches
        farthest into the beam.

    Returns
    -------
    beams : Beams
        The same beams, with marks wherever they fit.
    findings : tuple of Finding
        Notes on the beams that get none, with the reason.

    Raises
    ------
    InputError
        If the number is not at least 1, the diameter is no length above 0, or the holes would
        break through the ends.

    Notes
    -----
    Marks fit where all holes of a beam lie inside of it, from side to side, and none touches
    another.
    """
    _check_options(count, diameter, inset)
    annuli = beams.annuli
    lines = beams.insets.max(axis=2, keepdims=True) + inset
    bounds, exists = cut_corners(annuli, lines)
    shares = (np.arange(count)[:, None] + 0.5) / count
    outer, inner = bounds[:, :, 0], bounds[:, :, 1]
    centers = outer + shares * (inner - outer)
    marks = DrillMarks(centers, np.ones(beams.n_beams, bool), float(diameter))
    reasons: dict[int, str] = {}
    for is_bad, reason in (
        (~exists, "their line misses an arc of the beam"),
        (_pitch(marks.holes) < diameter, "they touch each other"),
        (_arc_margin(beams, marks.holes) < diameter / 2, "they break through an arc"),
        (_end_margin(beams, marks.holes) < diameter / 2, "the beam is too short for them"),
    ):
        for row in np.flatnonzero(is_bad).tolist():
            reasons.setdefault(row, reason)
    marks.fits[list(reasons)] = False
    findings = tuple(
        Finding(NO_MARKS, annuli.ids[row], f"no drilling marks: {reason}", severity="note")
        for row, reason in sorted(reasons.items())
    )
    return replace(beams, marks=marks), findings


def _check_options(count: int, diameter: float, inset: float) -> None:
    if count < 1:
        raise InputError(f"there must be at least 1 hole at an end, not {count}")
    if not (np.isfinite(diameter) and diameter > 0):
        raise InputError(f"diameter must be a length above 0, not {diameter}")
    if not (np.isfinite(inset) and inset > diameter / 2):
        raise InputError(
            f"inset must be more than half the diameter {diameter:g}, not {inset}: the holes "
            "would break through the ends"
        )


def _pitch(holes: FloatArray) -> FloatArray:
    """Least distance (B,) of two centres of a beam."""
    itself: FloatArray = np.where(np.eye(holes.shape[1], dtype=bool), np.inf, 0.0)
    return (norm(holes[:, :, None] - holes[:, None]) + itself).min(axis=(1, 2))


def _arc_margin(beams: Beams, holes: FloatArray) -> FloatArray:
    """Least distance (B,) of the centres from the arcs; negative outside of the beam."""
    annuli = beams.annuli
    outer = -signed_distance(annuli.outer[:, None], holes)
    inner = signed_distance(annuli.inner[:, None], holes)
    return np.minimum(outer, inner).min(axis=1)


def _end_margin(beams: Beams, holes: FloatArray) -> FloatArray:
    """Least distance (B,) of the centres from the cuts of the ends, at any level."""
    annuli = beams.annuli
    across = inward_directions(annuli)
    cuts = annuli.corners[:, :, 0] + beams.insets.max(axis=2)[..., None] * across
    return dot(holes[:, None] - cuts[:, :, None], across[:, :, None]).min(axis=(1, 2))


def mark_centers(beams: Beams, marks: DrillMarks) -> FloatArray:
    """Centres (B, 2 n, 2) of drilling marks in the planes of their contours.

    Along the edge and to the outer side, as in `kernel.contours.Contours`.
    """
    return dot(marks.holes[:, :, None], beams.annuli.frames[:, None, :2])
