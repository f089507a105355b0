"""What keeps an annulus from being made: planes that lie flat, ends that lean or cross."""

from typing import Final

import numpy as np

from ..arrays import BoolArray, dot, norm
from ..spheres.incidence import normals
from ..tolerances import AXIS_LEAN, DEGENERATE
from .annuli import Annuli

NO_ANNULUS: Final = "B100"
"""Code of a beam whose edge has no annulus."""

NO_CUT: Final = "B101"
"""Code of a beam whose annulus cannot be cut at the nodes."""


def standing_reasons(annuli: Annuli, is_real: BoolArray, max_tilt: float) -> dict[int, str]:
    """Why annuli, without inner arcs, cannot stand, whatever their depth; the first reason.

    By row; annuli that stand do not occur. `is_real` (B,) tells whether their circles are real
    and meet the lines of both ends; the tilt is the angle to the bisecting plane, in radians.
    """
    reasons: dict[int, str] = {}
    for row in np.flatnonzero(~is_real).tolist():
        reasons[row] = "the two spheres do not meet in a circle near the edge"
    tilt = np.degrees(annuli.tilt)
    for row in np.flatnonzero(annuli.tilt > max_tilt).tolist():
        reasons.setdefault(
            row,
            f"the plane tilts {tilt[row]:.3g} degrees from the bisecting plane, more than "
            f"{np.degrees(max_tilt):.3g}",
        )
    inward = -annuli.frames[:, None, 1]
    lean = 2 * np.arctan2(
        norm(annuli.end_directions - inward), norm(annuli.end_directions + inward)
    ).max(axis=1)
    for row in np.flatnonzero(lean > AXIS_LEAN).tolist():
        reasons.setdefault(
            row, f"a node axis leans {np.degrees(lean[row]):.3g} degrees along the beam"
        )
    return reasons


def inner_reasons(annuli: Annuli, size: float) -> dict[int, str]:
    """Why annuli have no inner arc; of several reasons the first, by row.

    The size is the mean edge of the mesh. Sound annuli do not occur.
    """
    reasons: dict[int, str] = {}
    deep = np.flatnonzero(-2 * annuli.outer[:, 0] * annuli.depth >= 1).tolist()
    for row in deep:
        radius = -1 / (2 * annuli.outer[row, 0])
        reasons[row] = (
            f"the depth {annuli.depth:g} is not less than the radius {radius:.6g} of the arc"
        )
    outer_chords = annuli.corners[:, 1, 0] - annuli.corners[:, 0, 0]
    inner_chords = annuli.corners[:, 1, 1] - annuli.corners[:, 0, 1]
    backwards = dot(outer_chords, inner_chords) <= 0
    for row in np.flatnonzero(backwards).tolist():
        reasons.setdefault(row, "the lines of the two ends cross within the depth")
    heights = norm(annuli.corners[:, :, 1] - annuli.corners[:, :, 0]).min(axis=1)
    for row in np.flatnonzero(heights <= DEGENERATE * size).tolist():
        reasons.setdefault(
            row, "the arc is straight, and a constant power gives it no depth: give a depth"
        )
    across = [
        dot(annuli.end_directions, normals(rows[:, None], points)) >= 0
        for rows, points in (
            (annuli.outer, annuli.corners[:, :, 0]),
            (annuli.inner, annuli.corners[:, :, 1]),
        )
    ]
    for row in np.flatnonzero(np.any(across, axis=(0, 2))).tolist():
        reasons.setdefault(row, "a node axis leans across the arc at its end")
    sides = dot(annuli.corners[:, :, 1] - annuli.corners[:, :, 0], annuli.end_directions)
    for row in np.flatnonzero(sides[:, 0] * sides[:, 1] < 0).tolist():
        reasons.setdefault(row, "the two arcs cross: one end reaches inside, one outside")
    return reasons
