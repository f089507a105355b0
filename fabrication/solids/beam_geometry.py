"""Corners, faces, circles and cuts of beams: for OpenCASCADE and for STEP files alike."""

from dataclasses import dataclass, replace

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, norm
from ...kernel.beams.beams import Beams, side_arcs
from ...kernel.beams.end_edges import EndEdges, end_edges
from ...kernel.spheres.arcs import ArcCircles, Arcs, arc_circles
from ...kernel.tolerances import EPSILON
from .panel_geometry import CONFUSION, check_finite, rounded_origins

LEVELS = ((0, 1), (1, 2), (0, 2))
"""Lower and upper level of the edges across the thickness; the last at flat ends."""


@dataclass(frozen=True)
class BeamGeometry:
    """
    Solids of beams, about their rounded origins.

    Attributes
    ----------
    beams : Beams
        B beams.
    places : (B, 3) float array
        Where their solids stand.
    corners : (B, 2, 2, 3, 3) float array
        Corners by end, face (outer, inner) and level.
    centers : (B, 2, 3) float array
        Points of the axes of the outer and inner faces; not finite for planes.
    radii : (B, 2) float array
        Radii of these faces; infinite for planes.
    frames : (B, 2, 3, 3) float array
        Unit axes x, y, z of these faces in rows: x from the beam to the axis of a cylinder,
        or out of the outer face of a plane beam reversed; z along the axis.
    is_dome : (B, 2) bool array
        Whether the normal away from the axis points to the outer side.
    arcs : dict of int to (Arcs, Arcs)
        Outer and inner edges of the lower (0) and the upper (2) side.
    circles : dict of int to (ArcCircles, ArcCircles)
    cuts : dict of (int, int) to EndEdges
        Edges across the thickness, by their levels.
    tolerances : (B,) float array
        How far edges miss faces, or large numbers are rounded.
    """

    beams: Beams
    places: FloatArray
    corners: FloatArray
    centers: FloatArray
    radii: FloatArray
    frames: FloatArray
    is_dome: BoolArray
    arcs: dict[int, tuple[Arcs, Arcs]]
    circles: dict[int, tuple[ArcCircles, ArcCircles]]
    cuts: dict[tuple[int, int], EndEdges]
    tolerances: FloatArray


def beam_geometry(beams: Beams, confusion: float = CONFUSION) -> BeamGeometry:
    """
    Geometry of the solids of beams.

    Parameters
    ----------
    beams : Beams
    confusion : float
        Least tolerance, in the unit of the beams.

    Returns
    -------
    BeamGeometry
        About rounded origins.

    Raises
    ------
    InputError
        If a beam has numbers that are not finite.
    """
    annuli = beams.annuli
    places = rounded_origins(annuli.origins)
    shifts = annuli.origins - places
    corners = beams.corners + shifts[:, None, None, None]
    rows = np.stack([annuli.outer, annuli.inner], 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        radii = 0.5 / np.abs(rows[..., 0])
        centers = rows[..., 1:4] / (2 * rows[..., :1]) + shifts[:, None]
    up, axis = annuli.frames[:, None, 1], annuli.frames[:, None, 2]
    # On a plane the frame stands on it: along z, with the normal to the outer side.
    x = np.where(rows[..., :1] > 0, up, np.where(rows[..., :1] < 0, -up, -rows[..., 1:4]))
    frames = np.stack([x, np.cross(axis, x), np.broadcast_to(axis, x.shape)], 2)
    cuts = {levels: end_edges(beams, corners, centers, radii, levels) for levels in LEVELS}
    arcs = {level: _moved(side_arcs(beams, level), shifts) for level in (0, 2)}
    circles = {level: (arc_circles(a), arc_circles(b)) for level, (a, b) in arcs.items()}
    tolerances = _tolerances(beams, radii, cuts, confusion)
    return BeamGeometry(
        beams, places, corners, centers, radii, frames, rows[..., 0] < 0, arcs, circles, cuts,
        tolerances,
    )  # fmt: skip


def _moved(arcs: tuple[Arcs, Arcs], shifts: FloatArray) -> tuple[Arcs, Arcs]:
    outer, inner = (
        replace(each, starts=each.starts + shifts, ends=each.ends + shifts) for each in arcs
    )
    return outer, inner


def _tolerances(
    beams: Beams, radii: FloatArray, cuts: dict[tuple[int, int], EndEdges], confusion: float
) -> FloatArray:
    misses = 8 * EPSILON * np.where(np.isfinite(radii), radii, 0.0).max(axis=1)
    misses = np.maximum(misses, 8 * EPSILON * norm(beams.annuli.origins))
    for cut in cuts.values():
        misses = np.maximum(misses, 4 * cut.misses.max(axis=(1, 2)))
    tolerances = np.maximum(confusion, misses)
    is_finite = np.isfinite(beams.corners).all(axis=(1, 2, 3, 4)) & np.isfinite(tolerances)
    check_finite("beam", beams.annuli.ids, is_finite)
    return tolerances
