"""The node axes that the spheres of a net have in common."""

import numpy as np

from ..arrays import FloatArray, dot, unit
from ..meshes.mesh import mean_edge_length
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.rows import rescale
from ..support.beam_axes import upright_directions
from .descent import meet_axes
from .design_surface import design_surface
from .setting import Bounds, make_setting, upright_state


def common_axes(sphere_mesh: SphereMesh) -> FloatArray:
    """Directions (V, 3) to the inner side of the axes that all spheres of a node share.

    Beams between them are flat. Where neighbours are one sphere these leave an axis open, and
    the planes in which spheres meet do not tell it: then flat beams do. Nodes of planes, whose
    axes nothing tells, keep their normal; those of unused vertices are zero.
    """
    mesh = sphere_mesh.mesh
    rows = rescale(sphere_mesh.local_spheres, 1 / mean_edge_length(mesh))
    setting = make_setting(mesh, design_surface(mesh), Bounds(1.0, 1.0), 2 * rows[:, 0])
    poles = meet_axes(setting, upright_state(setting, rows)).poles
    result = -upright_directions(mesh)
    found = unit(poles)
    is_told = found.any(axis=1)
    inward = np.sign(dot(found, result[setting.nodes]))[:, None] * found
    result[setting.nodes[is_told]] = inward[is_told]
    return result
