"""Joints of panels on beams: wide enough that panels clear each other at the nodes.

The walls of the panels around a node have no line in common where it has torsion: with a
thickness, panels that are no neighbours reach over the axis into each other, by a hair.
"""

from typing import Final

import numpy as np

from ..arrays import FloatArray, dot, unit
from ..meshes.mesh import mean_edge_length
from ..panels.edge_axes import EdgeMode, outward_axes
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ..tolerances import EPSILON
from .beam_axes import beam_edges
from .beam_supports import wall_planes

WIDEST_JOINT: Final = 0.1
"""Widest joint, in mean edges, that is taken for it; nodes that need more are left out."""


NO_JOINT: Final = 3e-6
"""Joints narrower than this, in mean edges (3 µm per m), are none."""


def least_joint(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray, thickness: float
) -> float:
    """Least width of joints at which the panels around a node stay in their sectors.

    Edges are "bisector" or "axis" as in `cutting_planes`; axes (V, 2, 3) of the nodes,
    thickness of the panels and result in model units.

    Notes
    -----
    The sectors of a node lie between half planes through its axis and the edges. The wall along
    an edge differs from its half plane by an angle δ, so it leaves the sector by ``h tan δ`` at
    a distance h from the edge, and h is at most the thickness and by what spheres miss the
    vertex. Where all panels of a node are neighbours no joint is needed.
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    ends = beam_edges(mesh)
    chords = (mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])[:, None]
    sectors = unit(np.cross(outward_axes(mesh, axes)[ends], chords))
    planes = wall_planes(sphere_mesh, edges, axes)[:, None]
    cosines = np.abs(dot(sectors, planes))
    tangents = np.sqrt(np.maximum(1 - cosines**2, 0)) / np.maximum(cosines, EPSILON)
    reach = thickness + vertex_error(sphere_mesh)
    around = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    has_others = around > np.where(topology.is_boundary_vertex, 2, 3)
    widths = 2 * reach[ends] * tangents * has_others[ends]
    size = mean_edge_length(mesh)
    width = float(widths[widths <= WIDEST_JOINT * size].max(initial=0.0))
    return width if thickness > 0 and width > NO_JOINT * size else 0.0
