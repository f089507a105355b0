"""Edges that are shorter where a surface bends more."""

import numpy as np

from ..arrays import FloatArray
from ..errors import InputError
from ..meshes.mesh import Mesh
from ..surfaces.surface import Surface
from .panel_scale import FINENESS, curvatures_on, spread_to
from .surface_curvatures import vertex_areas

MOST_UNEVEN = 1.6
"""Largest factor by which edges are longer, or shorter, than asked for."""

EVENED = round(FINENESS**2)
"""Rounds of means over neighbours: curvature counts as an edge of the pattern sees it."""


def even_spacing(source: Mesh | Surface, triangles: Mesh, density: float) -> FloatArray | None:
    """Length of edges at the vertices of triangles, so that neighbours turn more alike.

    Parameters
    ----------
    source : Mesh or Surface
    triangles : Mesh
        On the same surface.
    density : float
        0 for edges of one length; at 1 they are as the radius of curvature, within limits.

    Returns
    -------
    (V,) float array or None
        In edge lengths; the number of panels stays much as it is. None for edges of one length.

    Raises
    ------
    InputError
        If the density is not between 0 and 1.
    """
    if not 0 <= density <= 1:
        raise InputError(f"the density lies between 0 and 1, not {density:g}")
    if density == 0:
        return None
    found = curvatures_on(source, triangles)
    bend = np.maximum(np.abs(found.first), np.abs(found.second))
    if isinstance(source, Surface):
        bend = spread_to(triangles.vertices, source.mesh.vertices, bend)
    areas = vertex_areas(triangles)
    middle = areas @ bend / areas.sum()
    if not middle > 0:
        return None
    least, most = MOST_UNEVEN**-density, MOST_UNEVEN**density
    ratio = middle / np.maximum(_evened(triangles, bend), middle / MOST_UNEVEN**2)
    spacing = np.clip(ratio**density, least, most)
    return np.clip(spacing * np.sqrt(areas @ spacing**-2 / areas.sum()), least, most)


def _evened(mesh: Mesh, values: FloatArray) -> FloatArray:
    """Means (V,) over neighbours, again and again; estimates at the boundary do not count."""
    heads = mesh.corners[mesh.topology.next_corners]
    ends = np.concatenate([mesh.corners, heads]), np.concatenate([heads, mesh.corners])
    weights = np.where(mesh.topology.is_boundary_vertex, 0.0, 1.0)
    total = weights * values
    for _ in range(EVENED):
        total = total + np.bincount(ends[0], total[ends[1]], mesh.n_vertices)
        weights = weights + np.bincount(ends[0], weights[ends[1]], mesh.n_vertices)
        count = weights.max()
        total, weights = total / count, weights / count
    return np.divide(total, weights, out=values.copy(), where=weights > 0)
