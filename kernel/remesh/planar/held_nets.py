"""Planar nodes that stay near: on the surface that a net was made on, or where they are."""

from ...arrays import dot
from ...meshes.mesh import Mesh, face_vector_areas, mean_edge_length, shortest_edge
from ...sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ...support.node_axes import support_structure
from ...tolerances import NODE_LANDED, NODE_ON_SPHERES, NODE_ROUNDED, ON_SURFACE
from ..field.smooth_surface import SmoothSurface
from .node_sites import node_distances
from .planarize import Planarization, planarize
from .system import must_be_planar
from .turned_neighbors import turn_apart

RIM_WEIGHTS = (1.0, 0.5, 0.3, 0.2, 0.1, 0.0)
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
        Whether its beams meet, none of its nodes moved farther, and it stayed a net.

    Notes
    -----
    Where neighbours meet nearly smoothly, the plane of their circle is far less exact than they
    are. So the descent goes on to rounding, as near as it gets; and neighbours that are all but
    one sphere are turned apart before (`turn_apart`). Spheres so large that they are built as
    planes can share points far off, and their beams share nothing: beams are the judge.
    """
    result = planarize(turn_apart(sphere_mesh), exact=NODE_ROUNDED)
    found = result.sphere_mesh
    gap = vertex_error(found).max() / mean_edge_length(found.mesh)
    torsion = support_structure(found).torsion[must_be_planar(found.mesh)]
    is_near = (
        torsion.max(initial=0.0) <= NODE_LANDED
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
    first, last = shortest_edge(before), shortest_edge(after)
    least = max(KEPT_EDGE * first, min(first, SHORT_EDGE * mean_edge_length(after)))
    return not turned.any() and last >= least
