"""Edges across the thickness of beams: where the planes of their ends cut cylinders."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm, unit
from ..tolerances import STRAIGHT_RULING
from .beams import Beams, inward_directions


@dataclass(frozen=True)
class EndEdges:
    """
    Edges (B, 2, 2) at both ends, of outer and inner faces: ellipses, or straight lines.

    Attributes
    ----------
    is_line : (B, 2, 2) bool array
        Whether the edge is a straight line; what describes an ellipse is then of no use.
    misses : (B, 2, 2) float array
        How far the edge errs, by its bulge or by rounding.
    centers, normals, majors : (B, 2, 2, 3) float array
        Centres, unit normals of the planes, unit vectors along the major axes; edges run
        counter-clockwise about the normals.
    radii : (B, 2, 2) float array
        Major radii; the minor ones are the radii of the cylinders.
    firsts, lengths : (B, 2, 2) float array
        Parameters of the starts, and how far the parameters run; the length of a line.
    """

    is_line: BoolArray
    misses: FloatArray
    centers: FloatArray
    normals: FloatArray
    majors: FloatArray
    radii: FloatArray
    firsts: FloatArray
    lengths: FloatArray


def end_edges(
    beams: Beams,
    corners: FloatArray,
    centers: FloatArray,
    radii: FloatArray,
    levels: tuple[int, int],
) -> EndEdges:
    """
    Edges in which the planes of the ends cut the outer and inner faces.

    Parameters
    ----------
    beams : Beams
    corners : (B, 2, 2, 3, 3) float array
        Their corners, in the coordinates of the centres.
    centers : (B, 2, 3) float array
        Centres of the outer and inner circles; not finite for planes.
    radii : (B, 2) float array
        Radii; infinite for planes.
    levels : (int, int)
        Lower and upper level of the edges.

    Returns
    -------
    EndEdges
        The edges, from the lower to the upper level.

    Notes
    -----
    A plane that leans by little cuts a cylinder in an ellipse whose centre is far away, and
    coordinates are rounded by its distance: the ends of the edge tell by how much. Where a
    straight line errs by less, it is the better edge.
    """
    low, high = levels
    axis = beams.annuli.frames[:, None, 2]
    change = beams.insets[..., high] - beams.insets[..., low]
    rise = beams.levels[..., high] - beams.levels[..., low]
    slant = change[..., None] * inward_directions(beams.annuli) + rise[..., None] * axis
    normal = unit(np.cross(beams.annuli.end_directions, slant))
    cosine = dot(normal, axis)[..., None]
    major = unit(axis - cosine * normal)
    first, last = corners[..., low, :], corners[..., high, :]
    flat = last - first
    flat = flat - dot(flat, axis[:, :, None])[..., None] * axis[:, :, None]
    radius = radii[:, None, :, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        bulge = dot(flat, flat) / (8 * radii[:, None])
        height = dot(first - centers[:, None], normal[:, :, None]) / cosine
        middles = centers[:, None] + height[..., None] * axis[:, :, None]
        reach = radii[:, None] / np.abs(cosine)
        far = reach[..., None] * major[:, :, None]
        near = radius * np.cross(normal, major)[:, :, None]
        angles, misses = zip(
            *(_ellipse_angles(points - middles, far, near) for points in (first, last)),
            strict=True,
        )
        rounding = np.maximum(*misses)
        # Where there is no ellipse at all, nothing is above it.
        is_line = ~(bulge > np.maximum(STRAIGHT_RULING * beams.thickness, rounding))
        span = (angles[1] - angles[0] + np.pi) % (2 * np.pi) - np.pi
    side = np.where(span < 0, -1.0, 1.0)
    lengths = np.where(is_line, norm(last - first), np.abs(span))
    return EndEdges(
        is_line, np.where(is_line, bulge, rounding), middles,
        side[..., None] * normal[:, :, None],
        np.broadcast_to(major[:, :, None], middles.shape), reach,
        np.where(is_line, 0.0, side * angles[0] % (2 * np.pi)), lengths,
    )  # fmt: skip


def _ellipse_angles(
    points: FloatArray, far: FloatArray, near: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Parameters of points seen from the centre of their ellipse, and by how much it misses."""
    angles = np.arctan2(dot(points, near) / dot(near, near), dot(points, far) / dot(far, far))
    reached = np.cos(angles)[..., None] * far + np.sin(angles)[..., None] * near
    return angles, norm(reached - points)
