"""Judging a net with an exact support: what is kept of the design, what beams get."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, norm
from ..meshes.mesh import Mesh, mean_edge_length
from ..panels.cutting import gaps_along_edges
from ..remesh.planar.planarize import is_kept
from ..sphere_meshes.fit import face_planes
from ..sphere_meshes.sphere_mesh import SphereMesh, intersection_angles, vertex_error
from ..support.beam_axes import beam_edges
from ..support.beam_supports import (
    axis_points,
    inner_tilt,
    lean_angles,
    node_torsion,
    wall_planes,
)
from .axes import common_axes
from .design_surface import DesignSurface, across_rim, heights, slides
from .setting import Bounds, shifts_between


@dataclass(frozen=True)
class Judgement:
    """Measures of a sphere mesh whose vertices moved; lengths in mean edges, radians.

    Attributes
    ----------
    heights, slides : (V,) float array
        How far vertices moved off the surface and within it.
    across_rim : (R,) float array
        How far vertices of the boundary moved off it.
    moves : (V,) float array
        How far vertices moved.
    torsion : (N,) float array
        Angles between the axes of nodes and their beams, those of the boundary included.
    gaps : (E,) float array
        Between the two arcs of each inner edge, in the plane of the edge and its axes.
    vertex_miss : float
        Largest distance of a vertex from its spheres.
    tilt, angles, flat_angles : (E,) float array
        Tilt of these planes from upright; angles of neighbouring spheres, and of flat panels
        on the design.
    lean : (N,) float array
        Angles of the node axes to the normals.
    is_kept : bool
        No face turned over, no edge became much shorter.
    """

    heights: FloatArray
    slides: FloatArray
    across_rim: FloatArray
    moves: FloatArray
    torsion: FloatArray
    gaps: FloatArray
    vertex_miss: float
    tilt: FloatArray
    angles: FloatArray
    flat_angles: FloatArray
    lean: FloatArray
    is_kept: bool

    @property
    def is_smoother(self) -> bool:
        """Whether neighbours meet no more sharply, on the mean, than flat panels do."""
        return _mean(self.angles) <= _mean(self.flat_angles)

    def is_within(self, bounds: Bounds) -> bool:
        """Whether no vertex moved farther than allowed."""
        return bool(
            self.heights.max(initial=0.0) <= bounds.height
            and self.slides.max(initial=0.0) <= bounds.slide
        )


def _mean(values: FloatArray) -> float:
    return float(values.mean()) if len(values) else 0.0


def judge(design: Mesh, surface: DesignSurface, found: SphereMesh) -> Judgement:
    """Measure a sphere mesh against the design that it was made from."""
    shifts = shifts_between(design, found.mesh)
    size = mean_edge_length(design)
    axes = common_axes(found)
    points = axis_points(found.mesh, axes)
    planes = wall_planes(found, "axis", points)
    gaps = gaps_along_edges(found, "axis", points)
    nodes = np.unique(design.corners)
    return Judgement(
        heights=np.abs(heights(surface, shifts)[0]),
        slides=norm(slides(surface, shifts)),
        across_rim=norm(across_rim(surface, shifts)[0]),
        moves=norm(shifts),
        torsion=node_torsion(beam_edges(design), planes, axes)[nodes],
        gaps=np.nan_to_num(np.maximum(gaps.middle, gaps.ends), nan=np.inf) / size,
        vertex_miss=float(vertex_error(found).max()) / size,
        tilt=inner_tilt(found, planes),
        angles=intersection_angles(found),
        flat_angles=intersection_angles(face_planes(design)),
        lean=lean_angles(found.mesh, axes)[nodes],
        is_kept=is_kept(design, found.mesh),
    )
