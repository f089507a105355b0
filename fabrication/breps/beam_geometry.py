"""Corners, faces, circles and cuts of beams: for all solids alike."""

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
    """Solids of beams, about their rounded origins.

    The frames of outer and inner faces have z along the axis and x from the beam to the axis of
    a cylinder, or out of the outer face of a plane beam reversed.
    """

    beams: Beams
    places: FloatArray  # (B, 3) where the solids stand
    corners: FloatArray  # (B, 2, 2, 3, 3) by end, face (outer, inner) and level
    centers: FloatArray  # (B, 2, 3) points of the axes of these faces; not finite for planes
    radii: FloatArray  # (B, 2) radii of the faces; infinite for planes
    frames: FloatArray  # (B, 2, 3, 3) unit axes x, y, z of the faces in rows
    is_dome: BoolArray  # (B, 2) the normal away from the axis points to the outer side
    arcs: dict[int, tuple[Arcs, Arcs]]  # outer and inner edges, lower (0) and upper (2) side
    circles: dict[int, tuple[ArcCircles, ArcCircles]]
    cuts: dict[tuple[int, int], EndEdges]  # edges across the thickness, by their levels
    tolerances: FloatArray  # (B,) how far edges miss faces, or large numbers are rounded


def beam_geometry(beams: Beams, confusion: float = CONFUSION) -> BeamGeometry:
    """Geometry of the solids of beams; the confusion is the least tolerance, in their unit.

    Raises InputError if a beam has numbers that are not finite.
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
