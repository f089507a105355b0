"""Planarisation: sphere meshes whose nodes are free of torsion, where they are or on a surface.

Nothing but the conditions is minimised. There are about two of them less than unknowns for
every face, and of all Gauss-Newton steps the damping picks the least one: what keeps a net near
its start and fair is the norm that the damping uses, not a term of the energy. Such terms would
end in a compromise, in which it is cheaper for two spheres of a short edge to become one than
for the net to move; and a node whose spheres share a circle is planar and of no use.

Meshes with Spherical Faces, Prop. 4.3 and Sec. 6.4.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...arrays import FloatArray, dot, norm, sum_by
from ...errors import InputError
from ...meshes.curvature import vertex_normals
from ...meshes.mesh import Mesh, face_vector_areas, mean_edge_length, shortest_edge
from ...solvers.levenberg_marquardt import Descent, Status, levenberg_marquardt
from ...sphere_meshes.sphere_mesh import SphereMesh
from ...spheres.rows import recenter, rescale
from ...tolerances import NODE_EXACT, ON_SURFACE
from ..field.smooth_surface import SmoothSurface
from .conditions import (
    NetState,
    PlanarSystem,
    Site,
    anywhere,
    energies,
    move,
    node_distances,
    on_surface,
    planar_system,
    upright,
)
from .steps import StepNorm, linearize, step_norm

STEPS = 60
"""Largest number of linear systems."""

RIM_STEPS = 2
"""Linear systems in which the boundary counts as well."""

APPROACH = 0.5
"""The approach to a surface ends when a step does not halve what is missed."""

RIM_WEIGHTS = (1.0, 0.5, 0.3, 0.2, 0.1, 0.0)
"""How much the boundary counts: less where a net cannot meet it, down to nothing."""

KEPT_EDGE = 0.5
"""Share of its shortest edge that a net must keep to be held on its surface."""

SHORT_EDGE = 0.2
"""Edges shorter than this share of the mean are short: no net may get such."""

FARTHEST = 0.75
"""Mean edges by which its nodes may move at most."""


@dataclass(frozen=True)
class Planarization:
    """A planarised sphere mesh and how it was reached.

    Attributes
    ----------
    sphere_mesh : SphereMesh
        Moved nodes and changed spheres, on the same faces.
    shifts : (V,) float array
        How far each node moved, in mean edges.
    status : {"converged", "stalled", "exhausted"}
        How the descent ended; if it converged, nodes are planar as exactly as asked for.
    """

    sphere_mesh: SphereMesh
    shifts: FloatArray
    status: Status
    iterations: int


def planarize(
    sphere_mesh: SphereMesh,
    fairness: float = 1.0,
    surface: SmoothSurface | None = None,
    rim_weight: float = 1.0,
    exact: float = NODE_EXACT,
    lean: float | None = None,
    approach: float = APPROACH,
    slack: float = 0.0,
) -> Planarization:
    """Make the nodes of a sphere mesh planar in P⁴, and put them on their spheres.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A mesh of any face degrees whose spheres nearly pass through the nodes and are nearly
        planar around them: from a conjugate net on a congruence. Planes are welcome.
    fairness : float
        How much it counts against a step that neighbouring spheres change differently,
        relative to how much the steps themselves count.
    surface : SmoothSurface, optional
        A surface on which the nodes shall lie, up to the last steps; those of the boundary,
        which stay on it seen from above, lie near it.
    rim_weight : float
        How much heights of the boundary count in the first steps, relative to those inside.
    exact : float
        Residuals of a node, in mean edges and radians, that count as zero.
    lean : float, optional
        Angle with the normals beyond which node axes are turned back in the first steps.
    approach : float
        The first steps end when one does not lower what is missed by this share.
    slack : float
        Distance from the surface, in mean edges, that counts as none.

    Returns
    -------
    Planarization
        Torsion-free if it converged. Nets that are planar are returned as they are.

    Raises
    ------
    InputError
        If the fairness is negative or not finite.

    Notes
    -----
    Convergence is quadratic unless the spheres of a node are about to share a circle: then
    their subspace loses a dimension, the Jacobian its rank, and steps only halve the residuals.
    This happens where neighbouring spheres differ by less than they must move.

    Fairness is of the spheres: nodes follow from them, and are coupled with nothing else.

    Each edge that ends on the boundary of the surface is one condition for its two spheres.
    Where lines of the net meet the boundary askew, all of them together are nearly more than
    what is left free: met exactly they would move nodes by half an edge. So the first steps
    count them, and the others do not. On closed nets planar nodes are nearly dependent
    conditions already, and a surface is known as well as its mesh tells it: the last steps
    make nodes planar alone, which moves them by a hair.

    References
    ----------
    Meshes with Spherical Faces, Prop. 4.3 and Sec. 6.4; Tang et al. 2014.
    """
    if not (np.isfinite(fairness) and fairness >= 0):
        raise InputError(f"the fairness must be a number from 0 on, not {fairness}")
    system = replace(planar_system(sphere_mesh), exact=exact)
    size = step_norm(system, fairness)
    start, first = system.start, 0
    for site, steps in _approach(system.mesh, surface, rim_weight, lean, slack):
        descent = _descend(replace(system, site=site), start, size, steps, approach)
        start, first = descent.state, first + descent.iterations
    descent = _descend(system, start, size, STEPS - first, 0.0)
    result = _assembled(system, descent.state)
    shifts = norm(descent.state.shifts)
    return Planarization(result, shifts, descent.status, first + descent.iterations)


def _approach(
    mesh: Mesh,
    surface: SmoothSurface | None,
    rim_weight: float,
    lean: float | None,
    slack: float,
) -> list[tuple[Site, int]]:
    """Where nodes shall be at first, and in how many steps: with the boundary, then without."""
    if surface is None:
        return [] if lean is None else [(_leaning_less(anywhere, mesh, lean), STEPS // 2)]
    is_rim = mesh.topology.is_boundary_vertex
    meets_rim = is_rim & (np.bincount(mesh.corners, minlength=mesh.n_vertices) > 1)
    sites = [
        (on_surface(surface, mesh, np.where(meets_rim, weight, 1.0), slack), steps)
        for weight, steps in ((rim_weight, RIM_STEPS), (0.0, STEPS // 2))
    ]
    return [(_leaning_less(site, mesh, lean), steps) for site, steps in sites]


def _leaning_less(site: Site, mesh: Mesh, lean: float | None) -> Site:
    return site if lean is None else upright(site, vertex_normals(mesh), lean)


def _descend(
    system: PlanarSystem, start: NetState, size: StepNorm, steps: int, tolerance: float
) -> Descent[NetState]:
    return levenberg_marquardt(
        start,
        lambda net: energies(system, net),
        lambda net: linearize(system, net, size),
        move,
        tolerance=tolerance,
        max_iterations=steps,
    )


def _assembled(system: PlanarSystem, net: NetState) -> SphereMesh:
    mesh, faces = system.mesh, system.mesh.topology.corner_faces
    size = mean_edge_length(mesh)
    drift = sum_by(faces, net.shifts[mesh.corners], mesh.n_faces) / mesh.degrees[:, None]
    rows = rescale(recenter(net.rows, drift), size)
    moved = Mesh(mesh.vertices + size * net.shifts, mesh.faces)
    return SphereMesh.from_local(moved, rows)


def planarize_held(
    sphere_mesh: SphereMesh, surface: SmoothSurface, fairness: float = 1.0
) -> tuple[Planarization, bool]:
    """Make nodes planar and keep them on a surface if the net stays a net.

    The surface is the one that the net was made on, the fairness that of `planarize`. Also
    whether the nodes inside lie on the surface: else, as around singular points, edges would
    shrink or faces turn over.

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


def _is_held(before: Mesh, held: Planarization, surface: SmoothSurface) -> bool:
    after = held.sphere_mesh.mesh
    inner = ~after.topology.is_boundary_vertex
    return bool(
        held.status == "converged"
        and held.shifts.max() <= FARTHEST
        and node_distances(surface, after)[inner].max(initial=0.0) <= ON_SURFACE
        and is_kept(before, after)
    )


def is_kept(before: Mesh, after: Mesh) -> bool:
    """Whether a net is still a net: False if a face turned over or edges became too short."""
    turned = dot(face_vector_areas(before), face_vector_areas(after)) <= 0
    first, last = shortest_edge(before), shortest_edge(after)
    least = max(KEPT_EDGE * first, min(first, SHORT_EDGE * mean_edge_length(after)))
    return not turned.any() and last >= least
