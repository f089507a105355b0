"""What is to be known of every beam: for schedules, drawings, files and audits."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, dot, norm
from ..spheres.arcs import Arcs, arc_circles, arc_lengths, arc_reaches
from ..support.annuli import corner_mismatch, end_depths, line_misses, twist_angles
from ..tolerances import MITRE_LIMIT
from .beams import Beams, beam_lengths, beam_volumes, level_arcs, section_arcs
from .contours import beam_contours
from .cutting import mitre_normals, neighbor_angles, node_points


@dataclass(frozen=True)
class BeamFacts:
    """Measures of beams, in the unit of the beams; points in model coordinates.

    Arcs are those of the contour: in the middle of the thickness, between the cuts of the ends.

    Attributes
    ----------
    lengths : (B,) float array
        Longest chord between corners of the two ends.
    outer_lengths, inner_lengths : (B,) float array
        Lengths along the outer and the inner arc.
    outer_radii, inner_radii : (B,) float array
        Radii of the arcs; infinite for straight ones.
    chords, sagittas : (B,) float array
        Chord of the outer arc, and its height over it, positive to the outer side.
    depths : (B, 2) float array
        Lengths of the ends on the node axes, before they are cut.
    widths : (B,) float array
        Distance of the two arcs in the middle.
    volumes : (B,) float array
        Volumes.
    sizes : (B, 2) float array
        Length (along the chord of the edge) and width of the rectangle about the whole piece,
        seen along the normal of its plane.
    bevels : (B, 2, 2) float array
        Angles of the cuts at both ends, on the lower and the upper side, in radians; a right
        angle is a square cut.
    tilts : (B,) float array
        Angles between the planes and the normals of the surface, in radians.
    twists : (B, 2) float array
        Angles between the planes and the node axes at both ends, in radians.
    line_misses : (B, 2) float array
        How far the planes pass the best line in common at both ends.
    mismatches : (B, 2) float array
        How far the corners of each end are from the mean of those at the node.
    clearances : (B, 2) float array
        Gaps to neighbours that are cut alike: twice the distances of the ends from the half
        planes through the node axes that bisect the angles to their neighbours. Negative where
        beams run into each other; infinite where no neighbour is near on either side.
    ends : (B, 2, 3) float array
        Outer corners on the node axes.
    """

    lengths: FloatArray
    outer_lengths: FloatArray
    inner_lengths: FloatArray
    outer_radii: FloatArray
    inner_radii: FloatArray
    chords: FloatArray
    sagittas: FloatArray
    depths: FloatArray
    widths: FloatArray
    volumes: FloatArray
    sizes: FloatArray
    bevels: FloatArray
    tilts: FloatArray
    twists: FloatArray
    line_misses: FloatArray
    mismatches: FloatArray
    clearances: FloatArray
    ends: FloatArray


def beam_facts(beams: Beams) -> BeamFacts:
    """Measure beams."""
    annuli, contours = beams.annuli, beam_contours(beams)
    outer, inner = section_arcs(beams)
    return BeamFacts(
        lengths=beam_lengths(beams),
        outer_lengths=arc_lengths(outer),
        inner_lengths=arc_lengths(inner),
        outer_radii=arc_circles(outer).radii,
        inner_radii=arc_circles(inner).radii,
        chords=norm(outer.ends - outer.starts),
        sagittas=outer.sagittas,
        depths=end_depths(annuli),
        widths=contours.widths,
        volumes=beam_volumes(beams),
        sizes=_rectangle_sizes(beams),
        bevels=contours.bevels,
        tilts=annuli.tilt,
        twists=twist_angles(annuli),
        line_misses=line_misses(annuli),
        mismatches=corner_mismatch(annuli),
        clearances=_clearances(beams),
        ends=annuli.corners[:, :, 0] + annuli.origins[:, None],
    )


def _clearances(beams: Beams) -> FloatArray:
    """Twice the distances (B, 2) from the bisecting half planes, the smaller of both sides."""
    half_angles = neighbor_angles(beams.annuli)
    mitres = mitre_normals(beams.annuli, half_angles)
    apart = beams.corners - node_points(beams.annuli)[:, :, None, None]
    # Between its side and its ridge a cut is plane: the nearest point is at one of them.
    distances = np.stack(
        [
            dot(mitres[:, :, side, None, None], apart[:, :, :, levels]).min(axis=(2, 3))
            for side, levels in enumerate((slice(0, 2), slice(1, 3)))
        ],
        2,
    )
    # Beyond the limit of mitres there is nobody to run into, also where a beam that was there
    # when the end was cut could not be made.
    is_near = half_angles <= MITRE_LIMIT
    return 2 * np.where(is_near, distances, np.inf).min(axis=2)


def _rectangle_sizes(beams: Beams) -> FloatArray:
    """Lengths and widths (B, 2) of the rectangles about all levels, seen along the normals."""
    normals = beams.annuli.frames[:, 2]
    flat = beams.corners - beams.levels[:, :, None, :, None] * normals[:, None, None, None]
    arcs = [
        side
        for level in range(3)
        for side in level_arcs(beams, flat[:, :, :, level], np.zeros(beams.n_beams))
    ]
    axes = np.moveaxis(beams.annuli.frames[:, :2], 1, 0)
    return np.stack([_reach(arcs, axis) + _reach(arcs, -axis) for axis in axes], 1)


def _reach(arcs: list[Arcs], directions: FloatArray) -> FloatArray:
    return np.max([arc_reaches(each, directions) for each in arcs], axis=0)
