"""A surface as panels of a size see it: its curvatures at their scale, and convex spheres."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, norm
from ..errors import InputError
from ..hexagons.tangent_offsets import CLOSEST, grow_offsets, tangent_surface
from ..meshes.isotropic_remeshing import remesh_triangles
from ..meshes.mesh import Mesh, face_vector_areas, mean_edge_length
from ..surfaces.surface import Surface
from ..tolerances import CREASE
from .curved_refinement import refined
from .surface_curvatures import SurfaceCurvatures, surface_curvatures

FINENESS = 2.4
"""Edges of the triangles under a net, as parts of its own edges."""

EVENING_ROUNDS = 10
"""How often the triangles are evened out."""

MOST_TRIANGLES = 10_000
"""More triangles are not made to tell curvatures: the mesh itself tells them."""

USUAL_BOUND = np.radians(15)
"""Largest angle of the node axes of hexagons, unless another is asked for."""


GROWN = 1 / 3
"""Share of their bound that axes use while spheres grow; polishing and flips use the rest."""


class PanelScale(NamedTuple):
    """What a surface is to panels of a size.

    Attributes
    ----------
    mesh : Mesh
        The vertices that the rest is known at.
    curvatures : SurfaceCurvatures
        Exact where the shape is; else without what is smaller than panels, as noise is.
    convex : (V,) float array or None
        Curvature of the largest spheres whose hexagons are convex and have upright axes.
    """

    mesh: Mesh
    curvatures: SurfaceCurvatures
    convex: FloatArray | None


def even_triangles(mesh: Mesh, edge: float) -> Mesh:
    """Triangles of nearly one size on the smooth surface that a mesh stands for."""
    return remesh_triangles(refined(mesh, edge), edge, EVENING_ROUNDS, CREASE)


def at_panel_scale(
    source: Mesh | Surface, edge: float, bound: float = USUAL_BOUND
) -> PanelScale:
    """A surface as panels with edges of a length see it.

    Parameters
    ----------
    source : Mesh or Surface
    edge : float
    bound : float
        Largest angle of the node axes of hexagons, in radians.

    Raises
    ------
    InputError
        If the curvature is known nowhere.
    """
    mesh = source.mesh if isinstance(source, Surface) else source
    if isinstance(source, Surface) or _count(mesh, edge / FINENESS) > MOST_TRIANGLES:
        found = surface_curvatures(source)
    else:
        mesh = even_triangles(mesh, edge / FINENESS)
        found = curvatures_on(source, mesh)
    dual_edge = float(np.sqrt(3)) * edge
    if _count(mesh, dual_edge) > MOST_TRIANGLES:
        return PanelScale(mesh, found, None)
    try:
        convex = _convex_spheres(even_triangles(mesh, dual_edge), mesh, bound)
    except InputError:  # panels too large for the surface: their own pattern says so
        convex = None
    return PanelScale(mesh, found, convex)


def _count(mesh: Mesh, edge: float) -> float:
    """How many triangles of an edge cover a mesh."""
    return float(norm(face_vector_areas(mesh)).sum()) / (np.sqrt(3) / 4 * edge**2)


def curvatures_on(source: Mesh | Surface, triangles: Mesh) -> SurfaceCurvatures:
    """Exact curvatures where they are known; else those of triangles on the surface.

    Estimates on the boundary, from one side, do not count.

    Raises
    ------
    InputError
        If the curvature is known nowhere.
    """
    if isinstance(source, Surface):
        return surface_curvatures(source)
    found = surface_curvatures(triangles)
    inner = np.where(triangles.topology.is_boundary_vertex, 0.0, found.weights)
    return replace(found, weights=inner / inner.sum()) if inner.sum() > 0 else found


def _convex_spheres(triangles: Mesh, mesh: Mesh, bound: float) -> FloatArray:
    """Signed curvatures at the vertices of a mesh, from triangles as large as hexagons'."""
    surface, _ = tangent_surface(triangles)
    offsets = grow_offsets(surface, CLOSEST * surface.radii, GROWN * bound)
    values = surface.side / (offsets * mean_edge_length(triangles))
    return spread_to(mesh.vertices, triangles.vertices, values)


def spread_to(points: FloatArray, places: FloatArray, values: FloatArray) -> FloatArray:
    """Values (N,) at points: those of the nearest places."""
    from scipy.spatial import KDTree

    return values[KDTree(places).query(points)[1]]
