"""Annuli: flat beams, bounded by two circular arcs and the lines of their ends.

Each annulus has its own origin, near the middle of its edge and in its plane. A circle is kept
as the unit row of the sphere that has it as a great circle, so that straight beams are planes
and nothing divides by A. `kernel.support.annulus_construction` finds the annuli of a sphere
mesh.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, sum_by
from ..display import Shown, brief, counted, radii_text, size_text
from ..spheres.rows import center_radius
from ..tolerances import PARALLEL_PLANES


@dataclass(frozen=True, repr=False)
class Annuli(Shown):
    """Annuli that can be made, in the order of their edges.

    Points and rows are local: seen from the origin of the annulus, not turned.

    Attributes
    ----------
    ids : tuple of str
        Stable names ``B0000``, one per annulus.
    edge_ids : (B,) int array
        Edge of the mesh: interior and boundary edges, counted by their first half-edge.
    edge_vertices : (B, 2) int array
        Vertices at the two ends.
    edge_faces : (B, 2) int array
        Faces left and right of the edge; -1 beyond the boundary.
    panel_ids : tuple of (str or None, str or None)
        Names of the panels of these faces; None beyond the boundary.
    origins : (B, 3) float array
        Origins, in model coordinates: points of the planes near the middle of the edges.
    frames : (B, 3, 3) float array
        Unit vectors in rows: along the edge, across it to the outer side, and the normal of
        the plane, which points to the right face.
    outer, inner : (B, 5) float array
        Unit rows of the spheres that have the outer and the inner circle as great circles;
        N points to the outer side.
    corners : (B, 2, 2, 3) float array
        Corners at both ends: on the outer and on the inner circle.
    end_directions : (B, 2, 3) float array
        Unit directions of the lines of the two ends, to the inner side: the node axes,
        projected to the plane.
    node_axes : (B, 2, 3) float array
        Unit directions of the node axes at both ends, to the inner side.
    tilt : (B,) float array
        Angles between the planes and the planes that bisect the faces, in radians.
    kappa : float
        Power ``R² - r²`` of all annuli, in squared model units; 0 for a constant depth.
    depth : float
        Depth on the node axes, in model units; 0 for a constant power.
    """

    ids: tuple[str, ...]
    edge_ids: IntArray
    edge_vertices: IntArray
    edge_faces: IntArray
    panel_ids: tuple[tuple[str | None, str | None], ...]
    origins: FloatArray
    frames: FloatArray
    outer: FloatArray
    inner: FloatArray
    corners: FloatArray
    end_directions: FloatArray
    node_axes: FloatArray
    tilt: FloatArray
    kappa: float
    depth: float

    def __repr__(self) -> str:
        tilt = np.degrees(self.tilt.max(initial=0))
        return brief(
            "Annuli",
            [
                counted(self.n_annuli, "annulus"),
                size_text((self.corners + self.origins[:, None, None]).reshape(-1, 3)),
                radii_text(self.radii[:, 0]),
                f"depth {self.depth:.3g}" if self.depth else f"kappa {self.kappa:.3g}",
                f"tilt up to {tilt:.3g} degrees",
            ],
        )

    @property
    def radii(self) -> FloatArray:
        """Radii of the outer and the inner circles, (B, 2); infinite for straight beams."""
        return np.sqrt(center_radius(np.stack([self.outer, self.inner], 1))[1])

    @property
    def centers(self) -> FloatArray:
        """Centres of the outer circles in model coordinates, (B, 3); infinite if straight."""
        return center_radius(self.outer)[0] + self.origins

    @property
    def planes(self) -> FloatArray:
        """Planes ``n·x = d`` of the annuli in model coordinates, (B, 4): n and d."""
        normals = self.frames[:, 2]
        return np.column_stack([normals, dot(normals, self.origins)])

    @property
    def element_ids(self) -> IntArray:
        """Edge of each annulus, (B,)."""
        return self.edge_ids

    @property
    def n_annuli(self) -> int:
        """Number of annuli."""
        return len(self.edge_ids)


def corner_mismatch(annuli: Annuli) -> FloatArray:
    """How far the ends of the annuli that meet at a node are apart, (B, 2).

    Distance of the corners of each end from the mean of those at the node, the larger of outer
    and inner, in model units.
    """
    nodes = annuli.edge_vertices.ravel()
    # Differences to one end per node keep their digits far from the origin.
    _, first, groups = np.unique(nodes, return_index=True, return_inverse=True)
    origins = np.repeat(annuli.origins, 2, axis=0)
    shifts = origins - origins[first][groups]
    points = annuli.corners.reshape(-1, 2, 3) + shifts[:, None]
    count = np.bincount(groups)[:, None]
    means = sum_by(groups, points.reshape(-1, 6), len(first)) / count
    return norm(points - means[groups].reshape(-1, 2, 3)).max(axis=1).reshape(-1, 2)


def line_misses(annuli: Annuli) -> FloatArray:
    """How far planes of annuli pass the best line in common at their nodes, (B, 2).

    Of the lines along the node axis the one nearest to all planes there, in least squares;
    distances at both ends, in model units. 0 where two planes meet, whatever their place.
    """
    nodes, planes = annuli.edge_vertices.ravel(), np.repeat(annuli.frames[:, 2], 2, axis=0)
    _, first, groups = np.unique(nodes, return_index=True, return_inverse=True)
    origins, axes = np.repeat(annuli.origins, 2, axis=0), annuli.node_axes.reshape(-1, 3)
    # From the corner of one end per node, near which the line is.
    tops = (annuli.corners[:, :, 0] + annuli.origins[:, None]).reshape(-1, 3)
    shifts = tops[first][groups] - origins
    across = planes - dot(planes, axes)[:, None] * axes
    levels = -dot(planes, shifts)
    squares = (across[:, :, None] * across[:, None]).reshape(-1, 9)
    grams = sum_by(groups, squares, len(first)).reshape(-1, 3, 3)
    pulls = sum_by(groups, across * levels[:, None], len(first))
    inverse = np.linalg.pinv(grams, rcond=PARALLEL_PLANES, hermitian=True)
    moves = np.einsum("nij,nj->ni", inverse, pulls)[groups]
    return np.abs(dot(across, moves) - levels).reshape(-1, 2)


def twist_angles(annuli: Annuli) -> FloatArray:
    """Angles by which the planes of annuli miss node axes: 0 where a node has no torsion.

    (B, 2) radians in [0, π/2], at both ends.
    """
    sines = np.abs(dot(annuli.node_axes, annuli.frames[:, None, 2]))
    return np.arcsin(np.minimum(sines, 1.0))


def end_depths(annuli: Annuli) -> FloatArray:
    """Lengths of the ends, along the lines that the beams of a node share.

    (B, 2), from outer to inner corner, in model units.
    """
    return norm(annuli.corners[:, :, 1] - annuli.corners[:, :, 0])


def mean_end_depth(annuli: Annuli) -> float:
    """Mean length of the ends, from outer to inner corner, in model units; 0 without annuli."""
    lengths = end_depths(annuli)
    return float(lengths.mean()) if lengths.size else 0.0
