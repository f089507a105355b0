"""
Planarisation: sphere meshes whose nodes are free of torsion.

The planes of the circles around a node meet in a line, the node axis, exactly if the spheres
span a subspace of dimension 3 in R⁵ and pass through the node: then the mesh of spheres has
planar faces in P⁴.

Nothing but the constraints is minimised. There are about two of them less than unknowns for
every face, and of all Gauss-Newton steps the damping picks the least one: what keeps a net near
its start and fair is the norm that the damping uses, not a term of the energy. Such terms would
end in a compromise, in which it is cheaper for two spheres of a short edge to become one than
for the net to move; and a node whose spheres share a circle is planar and of no use.

Meshes with Spherical Faces, Prop. 4.3 and Sec. 6.4.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...arrays import BoolArray, FloatArray, batches_by_count, dot, norm, sum_by, unit
from ...errors import InputError
from ...meshes.mesh import Mesh, face_vector_areas, local_corners, mean_edge_length
from ...solvers.levenberg_marquardt import Descent, Status, levenberg_marquardt
from ...sphere_meshes.sphere_mesh import SphereMesh
from ...spheres.rows import recenter, rescale
from ...tolerances import DEGENERATE, NODE_EXACT
from ..field.smooth_surface import SmoothSurface
from .node_sites import Site, on_surface
from .step_norm import StepNorm, step_norm
from .steps import linearize
from .system import Net, PlanarSystem, energies, move, must_be_planar, planar_system

STEPS = 60
"""Largest number of linear systems."""

RIM_STEPS = 2
"""Linear systems in which the boundary counts as well."""

APPROACH = 0.5
"""The approach to a surface ends when a step does not halve what is missed."""


@dataclass(frozen=True)
class Planarization:
    """
    A planarised sphere mesh and how it was reached.

    Attributes
    ----------
    sphere_mesh : SphereMesh
        Moved nodes and changed spheres, on the same faces.
    shifts : (V,) float array
        How far each node moved, in mean edges.
    status : {"converged", "stalled", "exhausted"}
        How the descent ended; if it converged, nodes are planar as exactly as asked for.
    iterations : int
        Linear systems solved.
    """

    sphere_mesh: SphereMesh
    shifts: FloatArray
    status: Status
    iterations: int


@dataclass(frozen=True)
class Nodes:
    """
    What the spheres around each node have in common.

    Attributes
    ----------
    is_inner : (V,) bool array
        Nodes inside the mesh.
    planarity : (V,) float array
        Fourth singular value of the rows seen from the node, relative to the first; zero for
        less than four spheres.
    axes : (V, 3) float array
        Unit directions of the node axes, through both common points; NaN where there is none:
        where spheres share a circle or all of them are planes, and at the nodes of the
        boundary with less than four faces.
    is_real : (V,) bool array
        Whether the spheres meet in two real points, by least squares; False where the boundary
        has no axis.
    """

    is_inner: BoolArray
    planarity: FloatArray
    axes: FloatArray
    is_real: BoolArray


def planarize(
    sphere_mesh: SphereMesh,
    fairness: float = 1.0,
    surface: SmoothSurface | None = None,
    rim_weight: float = 1.0,
    exact: float = NODE_EXACT,
) -> Planarization:
    """
    Make the nodes of a sphere mesh planar in P⁴, and put them on their spheres.

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
    for site, steps in [] if surface is None else _approach(system.mesh, surface, rim_weight):
        descent = _descend(replace(system, site=site), start, size, steps, APPROACH)
        start, first = descent.state, first + descent.iterations
    descent = _descend(system, start, size, STEPS - first, 0.0)
    result = _assembled(system, descent.state)
    shifts = norm(descent.state.shifts)
    return Planarization(result, shifts, descent.status, first + descent.iterations)


def _approach(mesh: Mesh, surface: SmoothSurface, rim_weight: float) -> list[tuple[Site, int]]:
    """Where nodes shall be at first, and in how many steps: with the boundary, then without."""
    is_rim = mesh.topology.is_boundary_vertex
    meets_rim = is_rim & (np.bincount(mesh.corners, minlength=mesh.n_vertices) > 1)
    return [
        (on_surface(surface, mesh, np.where(meets_rim, rim_weight, 1.0)), RIM_STEPS),
        (on_surface(surface, mesh, np.where(meets_rim, 0.0, 1.0)), STEPS // 2),
    ]


def _descend(
    system: PlanarSystem, start: Net, size: StepNorm, steps: int, tolerance: float
) -> Descent[Net]:
    return levenberg_marquardt(
        start,
        lambda net: energies(system, net),
        lambda net: linearize(system, net, size),
        move,
        tolerance=tolerance,
        max_iterations=steps,
    )


def _assembled(system: PlanarSystem, net: Net) -> SphereMesh:
    mesh, faces = system.mesh, system.mesh.topology.corner_faces
    size = mean_edge_length(mesh)
    drift = sum_by(faces, net.shifts[mesh.corners], mesh.n_faces) / mesh.degrees[:, None]
    rows = rescale(recenter(net.rows, drift), size)
    moved = Mesh(mesh.vertices + size * net.shifts, mesh.faces)
    return SphereMesh.from_local(moved, rows)


def measure_nodes(sphere_mesh: SphereMesh) -> Nodes:
    """
    Planarity, axes and reality of the nodes of a sphere mesh.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    Nodes
        By least squares where the nodes are not planar.

    Notes
    -----
    The spheres orthogonal to those of a node are a pencil. Its plane holds their centres: the
    axis is normal to it. Its points, null vectors of the product, are the common points.

    References
    ----------
    Meshes with Spherical Faces, Prop. 4.2 and 4.3.
    """
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    local = rescale(sphere_mesh.local_spheres, 1 / size)[mesh.topology.corner_faces]
    rows = recenter(local, local_corners(mesh) / size)
    planarity = np.zeros(mesh.n_vertices)
    axes = np.full((mesh.n_vertices, 3), np.nan)
    is_real = np.zeros(mesh.n_vertices, np.bool_)
    is_planar = must_be_planar(mesh)
    for group, around in batches_by_count(mesh.corners, mesh.n_vertices):
        if around.shape[1] < 3:
            continue
        nodes, corners = group[is_planar[group]], around[is_planar[group]]
        _, values, basis = np.linalg.svd(rows[corners])
        if values.shape[1] > 3:
            planarity[nodes] = values[:, 3] / values[:, 0]
        is_full = values[:, 2] > DEGENERATE * values[:, 0]
        # Forms on rows; the first and last coefficients trade places in the sphere they stand
        # for, so that without a last coefficient it is a plane.
        first, second = basis[:, 3], basis[:, 4]
        plane = second[:, 4:] * first[:, 1:4] - first[:, 4:] * second[:, 1:4]
        has_axis = is_full & (norm(plane) > DEGENERATE)
        axes[nodes[has_axis]] = unit(plane[has_axis])
        mixed = _form(first, second)
        is_real[nodes] = is_full & (mixed**2 > _form(first, first) * _form(second, second))
    return Nodes(~mesh.topology.is_boundary_vertex, planarity, axes, is_real)


def _form(first: FloatArray, second: FloatArray) -> FloatArray:
    """Minkowski product of the spheres that linear forms of rows stand for."""
    ends = first[:, 0] * second[:, 4] + first[:, 4] * second[:, 0]
    return dot(first[:, 1:4], second[:, 1:4]) - ends / 2


def axis_angles(sphere_mesh: SphereMesh, nodes: Nodes) -> FloatArray:
    """
    Angles between the node axes and the normals of the mesh.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    nodes : Nodes
        Measures of its nodes.

    Returns
    -------
    (V,) float array
        Radians from 0 to π/2; NaN where there is no axis, or no normal since faces fold back.

    Notes
    -----
    The normals are sums of the vector areas of faces: nets that went wrong have them as well.
    """
    mesh = sphere_mesh.mesh
    areas = face_vector_areas(mesh)[mesh.topology.corner_faces]
    normals = unit(sum_by(mesh.corners, areas, mesh.n_vertices))
    across = norm(np.cross(nodes.axes, normals))
    angles = np.arctan2(across, np.abs(dot(nodes.axes, normals)))
    return np.where(norm(normals) > 0, angles, np.nan)
