"""Centres of mass of beams."""

import numpy as np

from ..arrays import FloatArray, dot
from ..spheres.arcs import Arcs, segment_areas, segment_moments
from .beams import Beams, beam_sections


def beam_centroids(beams: Beams) -> FloatArray:
    """Centres of mass (B, 3) of beams, in model coordinates, without their holes.

    The moments of plane sections, integrated over the thickness as `beam_volumes` does.
    """
    planes = beams.annuli.frames[:, 2]
    volumes, moments = np.zeros((beams.n_beams, 1)), np.zeros((beams.n_beams, 3))
    for weights, heights, outer, inner in beam_sections(beams):
        areas, section = _section(outer, inner, planes)
        volumes += (weights * areas)[:, None]
        moments += weights[:, None] * (section + (areas * heights)[:, None] * planes)
    return beams.annuli.origins + moments / volumes


def _section(outer: Arcs, inner: Arcs, planes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Areas (B,) and first moments (B, 3) between two arcs."""
    total, moments = np.zeros(len(planes)), np.zeros((len(planes), 3))
    corner = inner.starts
    for first, second in ((inner.ends, outer.ends), (outer.ends, outer.starts)):
        areas = dot(np.cross(first - corner, second - corner), planes) / 2
        total += areas
        moments += areas[:, None] * (corner + first + second) / 3
    for sign, arcs in ((1, outer), (-1, inner)):
        areas = sign * segment_areas(arcs)
        total += areas
        moments += areas[:, None] * (arcs.starts + arcs.ends) / 2
        moments += sign * segment_moments(arcs)[:, None] * arcs.rises
    return total, moments
