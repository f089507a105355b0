"""Judging a net with an exact support: what is kept of the design, what beams get."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, norm
from ..meshes.mesh import Mesh, mean_edge_length
from ..panels.cutting import edge_gaps
from ..remesh.planar.conditions import must_be_planar
from ..remesh.planar.planarize import is_kept
from ..sphere_meshes.fit import face_planes
from ..sphere_meshes.sphere_mesh import SphereMesh, intersection_angles, vertex_error
from ..support.beam_tilt import beam_tilt
from ..support.node_axes import axis_lean, support_structure
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
        Of the nodes that need a common axis.
    gaps : (E,) float array
        Between the two arcs of each inner edge, where spheres meet.
    vertex_miss : float
        Largest distance of a vertex from its spheres.
    tilt, angles, flat_angles : (E,) float array
        Tilt of the beams; angles of neighbouring spheres, and of flat panels on the design.
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
    structure = support_structure(found)
    nodes = must_be_planar(design)
    return Judgement(
        heights=np.abs(heights(surface, shifts)[0]),
        slides=norm(slides(surface, shifts)),
        across_rim=norm(across_rim(surface, shifts)[0]),
        moves=norm(shifts),
        torsion=structure.torsion[nodes],
        gaps=edge_gaps(found, "intersection") / size,
        vertex_miss=float(vertex_error(found).max()) / size,
        tilt=beam_tilt(found),
        angles=intersection_angles(found),
        flat_angles=intersection_angles(face_planes(design)),
        lean=axis_lean(structure)[nodes],
        is_kept=is_kept(design, found.mesh),
    )
