"""Planar nodes that stay near: on the surface that a net was made on, or where they are."""

from ..arrays import dot, norm
from ..mesh import Mesh, face_vector_areas, mean_edge_length
from ..sphere_mesh import SphereMesh, vertex_error
from ..tolerances import NODE_ON_SPHERES, NODE_ROUNDED, ON_SURFACE, TORSION_FREE
from .node_sites import node_distances
from .planarize import Planarization, measure_nodes, planarize
from .smooth_surface import SmoothSurface

RIM_WEIGHTS = (1.0, 0.1, 0.0)
"""How much the boundary counts: less where a net cannot meet it, down to nothing."""

KEPT_EDGE = 0.5
"""Share of its shortest edge that a net must keep to be held on its surface."""

SHORT_EDGE = 0.2
"""Edges shorter than this share of the mean are short: no net may get such."""

FARTHEST = 0.75
"""Mean edges by which its nodes may move at most."""


def planarize_held(
    sphere_mesh: SphereMesh, surface: SmoothSurface, fairness: float = 1.0
) -> tuple[Planarization, bool]:
    """
    Make nodes planar and keep them on a surface if the net stays a net.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The net.
    surface : SmoothSurface
        The surface that it was made on.
    fairness : float
        As in `planarize`.

    Returns
    -------
    result : Planarization
        The planarised net.
    is_held : bool
        Whether the nodes inside lie on the surface: else, as around singular points, edges
        would shrink or faces turn over.

    Raises
    ------
    InputError
        If the fairness is negative or not finite.
    """
    for rim_weight in RIM_WEIGHTS:
        held = planarize(sphere_mesh, fairness, surface, rim_weight)
        if _is_held(sphere_mesh.mesh, held, surface):
            return held, True
    return planarize(sphere_mesh, fairness), False


def planarize_near(sphere_mesh: SphereMesh, farthest: float) -> tuple[Planarization, bool]:
    """
    Make nodes planar if that moves them by little.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A mesh whose nodes are nearly planar, as an optimised support structure.
    farthest : float
        How far nodes may move, in mean edges.

    Returns
    -------
    result : Planarization
        The planarised mesh.
    is_near : bool
        Whether its nodes are planar, none of them moved farther, and it stayed a net.

    Notes
    -----
    Where neighbours meet nearly smoothly, the plane of their circle is far less exact than they
    are. So the descent goes on to rounding, as near as it gets.
    """
    result = planarize(sphere_mesh, exact=NODE_ROUNDED)
    found = result.sphere_mesh
    gap = vertex_error(found).max() / mean_edge_length(found.mesh)
    is_near = (
        measure_nodes(found).planarity.max(initial=0.0) <= TORSION_FREE
        and gap <= NODE_ON_SPHERES
        and result.shifts.max(initial=0.0) <= farthest
        and _is_kept(sphere_mesh.mesh, found.mesh)
    )
    return result, bool(is_near)


def _is_held(before: Mesh, held: Planarization, surface: SmoothSurface) -> bool:
    after = held.sphere_mesh.mesh
    inner = ~after.topology.is_boundary_vertex
    return bool(
        held.status == "converged"
        and held.shifts.max() <= FARTHEST
        and node_distances(surface, after)[inner].max(initial=0.0) <= ON_SURFACE
        and _is_kept(before, after)
    )


def _is_kept(before: Mesh, after: Mesh) -> bool:
    turned = dot(face_vector_areas(before), face_vector_areas(after)) <= 0
    first, last = _shortest(before), _shortest(after)
    least = max(KEPT_EDGE * first, min(first, SHORT_EDGE * mean_edge_length(after)))
    return not turned.any() and last >= least


def _shortest(mesh: Mesh) -> float:
    ends = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    return float(norm(ends - mesh.vertices[mesh.corners]).min())
