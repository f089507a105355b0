"""Beams: annuli of a thickness, cut at the nodes so that neighbours do not run into each other.

A beam has two plane sides at half the thickness from the plane of its annulus, an outer and an
inner face (cylinders, or planes where the arcs are straight), and at each end one or two planes
that contain the direction of the node axis. All of them are ruled by lines along the end
direction, so an end is told by three levels across the thickness - the lower side, the ridge
where its two planes meet, the upper side - and by how far the cut lies inside at each.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..display import Shown, brief, counted, radii_text, size_text
from ..parts.records import MAY_BE_NAN
from ..spheres.arcs import Arcs, segment_areas, sphere_arcs
from ..spheres.incidence import meet_lines
from ..spheres.rows import recenter, rescale
from ..support.annuli import Annuli


@dataclass(frozen=True)
class DrillMarks:
    """Holes at the ends of beams (`kernel.beams.drilling`).

    Attributes
    ----------
    centers : (B, 2, n, 3) float array
        Centres at both ends, from the outer to the inner side; local, in the planes of the
        annuli.
    fits : (B,) bool array
        Beams that get them; what is said of the others is of no use.
    diameter : float
        Diameter of all, in model units.
    """

    centers: FloatArray
    fits: BoolArray
    diameter: float

    @property
    def holes(self) -> FloatArray:
        """Local centres of all holes of each beam, (B, 2 n, 3), the first end first."""
        n_beams, n_ends, count, _ = self.centers.shape
        return self.centers.reshape(n_beams, n_ends * count, 3)


@dataclass(frozen=True, repr=False)
class Beams(Shown):
    """Beams that can be made, in the order of their edges.

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
    marks : DrillMarks, optional
        Where holes are to be drilled.
    cylinder_tops : (B, 2) float array, optional
        How far below the outer corners of the ends, along the node axes to the inner side,
        node cylinders may begin: panels lie above.
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
    marks: DrillMarks | None = field(default=None, metadata=MAY_BE_NAN)
    cylinder_tops: FloatArray | None = field(default=None, metadata=MAY_BE_NAN)

    def __repr__(self) -> str:
        annuli = self.annuli
        corners = self.corners.reshape(len(self.corners), -1, 3) + annuli.origins[:, None]
        return brief(
            "Beams",
            [
                counted(self.n_beams, "beam"),
                size_text(corners.reshape(-1, 3)),
                radii_text(annuli.radii[:, 0]),
                f"thickness {self.thickness:.3g}",
            ],
        )

    @property
    def radii(self) -> FloatArray:
        """Radii of the outer and the inner circles, (B, 2); infinite for straight beams."""
        return self.annuli.radii

    @property
    def centers(self) -> FloatArray:
        """Centres of the outer circles in model coordinates, (B, 3); infinite if straight."""
        return self.annuli.centers

    @property
    def planes(self) -> FloatArray:
        """Middle planes ``n·x = d`` in model coordinates, (B, 4): n and d."""
        return self.annuli.planes

    @property
    def ids(self) -> tuple[str, ...]:
        """Stable names, those of the annuli: one per beam."""
        return self.annuli.ids

    @property
    def element_ids(self) -> IntArray:
        """Edge of each beam, (B,)."""
        return self.annuli.edge_ids

    @property
    def n_beams(self) -> int:
        """Number of beams."""
        return self.annuli.n_annuli


def inward_directions(annuli: Annuli) -> FloatArray:
    """Unit vectors from the lines of the ends into the annuli, across them, (B, 2, 3)."""
    across = np.cross(annuli.end_directions, annuli.frames[:, None, 2])
    outer = annuli.corners[:, :, 0]
    chords = outer[:, ::-1] - outer
    return np.where(dot(across, chords)[..., None] < 0, -across, across)


def insets_at(levels: FloatArray, insets: FloatArray, heights: FloatArray) -> FloatArray:
    """How far cuts lie inside at a height (B,) over the plane of each annulus: (B, 2).

    Levels and insets (B, 2, 3) of the ends are those of `Beams`.
    """
    height = heights[:, None]
    upper = height > levels[..., 1]
    near, far = insets[..., 1], np.where(upper, insets[..., 2], insets[..., 0])
    span = np.where(upper, levels[..., 2], levels[..., 0]) - levels[..., 1]
    share = np.divide(height - levels[..., 1], span, out=np.zeros_like(span), where=span != 0)
    return near + share * (far - near)


def cut_corners(annuli: Annuli, insets: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Where lines parallel to the ends meet the circles.

    Insets (B, 2, n) of the lines from those of the ends, into the annuli. Points
    (B, 2, 2, n, 3) at both ends, on the outer and the inner circle, local, in the planes; and
    whether all lines of an annulus meet its circles.
    """
    across = inward_directions(annuli)[:, :, None, None]
    points = annuli.corners[:, :, :, None] + insets[:, :, None, :, None] * across
    along = np.broadcast_to(annuli.end_directions[:, :, None, None], points.shape)
    rows = np.stack([annuli.outer, annuli.inner], 1)[:, None, :, None]
    rows = np.broadcast_to(rows, (*points.shape[:-1], 5))
    steps, exists = meet_lines(rows.reshape(-1, 5), points.reshape(-1, 3), along.reshape(-1, 3))
    steps, exists = steps.reshape(points.shape[:-1]), exists.reshape(points.shape[:-1])
    reaches = np.asarray(exists.all(axis=(1, 2, 3)))
    return points + steps[..., None] * along, reaches


def scale_beams(beams: Beams, factor: float) -> Beams:
    """Beams in another unit of length: every length is multiplied by the factor."""
    annuli, marks, tops = beams.annuli, beams.marks, beams.cylinder_tops
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
        marks=marks and DrillMarks(marks.centers * factor, marks.fits, marks.diameter * factor),
        cylinder_tops=None if tops is None else tops * factor,
    )


def section_arcs(beams: Beams) -> tuple[Arcs, Arcs]:
    """Outer and inner arcs in the middle of the thickness, between the cuts of the ends.

    B arcs each, local, from the first to the second end.
    """
    return level_arcs(beams, beams.sections, np.zeros(beams.n_beams))


def side_arcs(beams: Beams, level: int) -> tuple[Arcs, Arcs]:
    """Outer and inner arcs that bound a side: level 0 for the lower, 2 for the upper side.

    B arcs each, local, from the first to the second end.
    """
    return level_arcs(beams, beams.corners[:, :, :, level], beams.levels[:, 0, level])


def level_arcs(beams: Beams, corners: FloatArray, heights: FloatArray) -> tuple[Arcs, Arcs]:
    """Outer and inner arcs at a height (B,), between given corners.

    Local corners (B, 2, 2, 3) at both ends, outer and inner. B arcs each, local, from the first
    to the second end.
    """
    planes = beams.annuli.frames[:, 2]
    lift = heights[:, None] * planes
    outer, inner = (
        sphere_arcs(recenter(rows, -lift), -planes, corners[:, 0, k], corners[:, 1, k])
        for k, rows in enumerate((beams.annuli.outer, beams.annuli.inner))
    )
    return outer, inner


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def beam_volumes(beams: Beams) -> FloatArray:
    """Volumes (B,) of beams, in cubed model units.

    The areas of plane sections, integrated over the thickness with 6 Gauss points between the
    levels of the two ridges.
    """
    planes = beams.annuli.frames[:, 2]
    total = np.zeros(beams.n_beams)
    for weights, _, outer, inner in beam_sections(beams):
        diagonal, other = outer.ends - inner.starts, outer.starts - inner.ends
        quadrilaterals = dot(np.cross(diagonal, other), planes) / 2
        total += weights * (quadrilaterals + segment_areas(outer) - segment_areas(inner))
    return total


def beam_sections(beams: Beams) -> Iterator[tuple[FloatArray, FloatArray, Arcs, Arcs]]:
    """Plane sections of beams at Gauss points over the thickness, between the ridges.

    Weights and heights (B,) of each, and its outer and inner arcs as they lie in the plane of
    the annulus.
    """
    half = np.full(beams.n_beams, beams.thickness / 2)
    ridges = np.sort(beams.levels[:, :, 1], axis=1)
    bounds = np.column_stack([-half, ridges, half])
    for low, high in zip(bounds.T[:-1], bounds.T[1:], strict=True):
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            heights = (low + high) / 2 + node * (high - low) / 2
            insets = insets_at(beams.levels, beams.insets, heights)
            corners = cut_corners(beams.annuli, insets[..., None])[0][:, :, :, 0]
            outer, inner = level_arcs(beams, corners, np.zeros(beams.n_beams))
            yield weight * (high - low) / 2, heights, outer, inner


def node_axis_segments(beams: Beams) -> tuple[tuple[int, ...], FloatArray]:
    """The lines in which the beams of each node meet.

    The vertices that carry beams; outer and inner corner at each, of its first beam, (n, 2, 3),
    in model coordinates.
    """
    annuli = beams.annuli
    vertices, first = np.unique(annuli.edge_vertices.ravel(), return_index=True)
    corners = annuli.corners.reshape(-1, 2, 3) + np.repeat(annuli.origins, 2, axis=0)[:, None]
    return tuple(vertices.tolist()), corners[first]


def beam_lengths(beams: Beams) -> FloatArray:
    """Longest chords (B,) between the corners of the two ends, in model units."""
    ends = beams.corners.reshape(beams.n_beams, 2, 6, 3)
    return norm(ends[:, 0, :, None] - ends[:, 1, None]).max(axis=(1, 2))
