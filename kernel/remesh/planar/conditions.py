"""The conditions of planar nodes: unknowns, residuals, derivatives, and where nodes lie.

Seen from its node, a sphere through the node is a row ``(A, N, 0)``: half its curvature and its
normal there. The spheres around a node span a subspace of dimension 3 where their ``(a A, N)``
have a common normal m in R⁴, with any factor a; the last three components of m point along the
node axis. The lift of the node is the other normal of the subspace of R⁵. With two free normals
instead there would be a gauge to fix. The factor makes curvatures as large as normals: without
it spheres that are nearly planes would pass for planar around any node.

Unknowns: the row S of each face, in coordinates local to it; of each node the shift of its
point and the normal m. Lengths are in mean edges. Every residual belongs to a corner, a face or
a node.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from ...arrays import BoolArray, FloatArray, dot, norm, sum_by, unit
from ...meshes.mesh import Mesh, local_corners, mean_edge_length
from ...sphere_meshes.sphere_mesh import SphereMesh
from ...spheres.incidence import evaluate, normals
from ...spheres.minkowski import minkowski
from ...spheres.rows import rescale
from ...tolerances import FLATTEST, LINE_CORNER, NODE_EXACT
from ..field.smooth_surface import SmoothSurface, surface_heights

FACE, POINT, NODE = 5, 3, 7
"""Unknowns of a face, of the point of a node, and of a node."""

ALWAYS_PLANAR = 3
"""Spheres of a node on the boundary that have a common axis whatever they are."""


class Misses(NamedTuple):
    """How far nodes are from where they shall be, and axes from how they shall stand.

    Attributes
    ----------
    lengths, slopes : (V, k) and (V, k, 7) float arrays
        Distances, in mean edges, and their gradients by the unknowns of the node.
    """

    lengths: FloatArray
    slopes: FloatArray


@dataclass(frozen=True)
class NetState:
    """Values of the unknowns.

    Attributes
    ----------
    rows : (F, 5) float array
        Spheres, seen from where the centroid of their face is at the start.
    shifts : (V, 3) float array
        Nodes, relative to the start.
    normals : (V, 4) float array
        Common normal m of the ``(a A, N)`` around each node that shall be planar; else zero.
    """

    rows: FloatArray
    shifts: FloatArray
    normals: FloatArray


Site: TypeAlias = Callable[[NetState], Misses]
"""From a net to what its nodes miss."""


def anywhere(net: NetState) -> Misses:
    """Let nodes be where they like: a `Site` without misses, (V, 0)."""
    return Misses(np.zeros((len(net.shifts), 0)), np.zeros((len(net.shifts), 0, NODE)))


@dataclass(frozen=True)
class PlanarSystem:
    """What stays as it is while a sphere mesh is planarised.

    Attributes
    ----------
    mesh : Mesh
        The mesh at the start; its corners and their faces are the incidences.
    corners : (H, 3) float array
        Corners at the start, local to their face.
    is_planar : (V,) bool array
        Nodes that shall be planar; the others, on the boundary, just lie on their spheres.
    scales : (5,) float array
        Units ``(a, 1, 1, 1, 1)`` of the coefficients of a row; 1 / a is the curvature of the
        net, its root mean square.
    site : callable
        Where the nodes shall be.
    exact : float
        Residuals below this count as zero.
    """

    mesh: Mesh
    start: NetState
    corners: FloatArray
    is_planar: BoolArray
    scales: FloatArray
    site: Site = anywhere
    exact: float = NODE_EXACT


class Residuals(NamedTuple):
    """How far a net is from planar nodes.

    Attributes
    ----------
    corners : (H, 2) float array
        Incidence of node and sphere, and ``m · (a A, N)``: with unit rows and normals the
        distance of the node, and the sine of the angle from the subspace.
    rows, normals : (F,) and (V,) float arrays
        ``<<S, S>> - 1`` and ``|m|² - 1``.
    sites : (V, k) float array
        Distances of the nodes from where they shall be.
    """

    corners: FloatArray
    rows: FloatArray
    normals: FloatArray
    sites: FloatArray


class CornerJacobian(NamedTuple):
    """Derivatives of the residuals of the corners.

    Attributes
    ----------
    by_face, by_node : (H, 2, 5) and (H, 2, 7) float arrays
        By the row; by the point and the normal of the node.
    """

    by_face: FloatArray
    by_node: FloatArray


def planar_system(sphere_mesh: SphereMesh) -> PlanarSystem:
    """The problem of planarising a sphere mesh, in mean edges; its first normals fit best.

    Notes
    -----
    A change of A is measured by the curvature of the net. By its effect within a face it would
    be all but free, and radii that vary along the net tilt the node axes.
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    size = mean_edge_length(mesh)
    rows = rescale(sphere_mesh.local_spheres, 1 / size)
    corners = local_corners(mesh) / size
    is_planar = must_be_planar(mesh)
    curvature = max(2 * float(np.sqrt((rows[:, 0] ** 2).mean())), FLATTEST)
    scales = np.array([1 / curvature, 1.0, 1.0, 1.0, 1.0])
    seen = rows[topology.corner_faces]
    arrows = np.concatenate([scales[0] * seen[:, :1], normals(seen, corners)], axis=1)
    products = (arrows[:, :, None] * arrows[:, None]).reshape(-1, 16)
    gram = sum_by(mesh.corners, products, mesh.n_vertices).reshape(-1, 4, 4)
    common = np.linalg.eigh(gram)[1][..., 0] * is_planar[:, None]
    start = NetState(rows, np.zeros((mesh.n_vertices, 3)), common)
    return PlanarSystem(mesh, start, corners, is_planar, scales)


def must_be_planar(mesh: Mesh) -> BoolArray:
    """Nodes (V,) whose beams need a common axis.

    Those inside; and on the boundary those of more than three faces, since the planes of two
    beams always meet in a line.
    """
    has_many = np.bincount(mesh.corners, minlength=mesh.n_vertices) > ALWAYS_PLANAR
    return ~mesh.topology.is_boundary_vertex | has_many


def planar_residuals(system: PlanarSystem, net: NetState) -> Residuals:
    """How far a net is from planar nodes; zero for a torsion-free sphere mesh of unit rows."""
    rows, points, common = _at_corners(system, net)
    curvatures = system.scales[0] * rows[:, 0]
    tilt = common[:, 0] * curvatures + dot(common[:, 1:], normals(rows, points))
    return Residuals(
        np.stack([evaluate(rows, points), tilt], axis=1),
        minkowski(net.rows, net.rows) - 1,
        (dot(net.normals, net.normals) - 1) * system.is_planar,
        system.site(net).lengths,
    )


def energies(system: PlanarSystem, net: NetState) -> FloatArray:
    """Sums of the squared residuals, one for each of their four kinds.

    All are zero if no residual is above `exact`: on closed nets the constraints are nearly
    dependent, and the last digits come slowly.
    """
    miss = planar_residuals(system, net)
    is_exact = all((np.abs(r) <= system.exact).all() for r in miss)
    return np.array([0.0 if is_exact else (r**2).sum() for r in miss])


def move(net: NetState, step: FloatArray) -> NetState:
    """Move a net along a step (5 F + 7 V,).

    It holds changes of the rows, then of the shift and the normal of each node.
    """
    rows, shifts, common = split_step(step, len(net.rows))
    return NetState(net.rows + rows, net.shifts + shifts, net.normals + common)


def corner_jacobian(system: PlanarSystem, net: NetState) -> CornerJacobian:
    """Derivatives of incidence and planarity: blocks of the corners."""
    rows, points, common = _at_corners(system, net)
    axes, arrows = common[:, 1:], normals(rows, points)
    by_face = np.zeros((len(rows), 2, FACE))
    by_face[:, 0, 0] = dot(points, points)
    by_face[:, 0, 1:4] = -points
    by_face[:, 0, 4] = 1
    by_face[:, 1, 0] = common[:, 0] * system.scales[0] - 2 * dot(axes, points)
    by_face[:, 1, 1:4] = axes
    by_node = np.zeros((len(rows), 2, NODE))
    by_node[:, 0, :3] = -arrows
    by_node[:, 1, :3] = -2 * rows[:, :1] * axes
    by_node[:, 1, 3] = system.scales[0] * rows[:, 0]
    by_node[:, 1, 4:] = arrows
    by_node[:, 1] *= system.is_planar[system.mesh.corners, None]
    return CornerJacobian(by_face, by_node)


def _at_corners(
    system: PlanarSystem, net: NetState
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Row, point and normal at each corner, in the coordinates of its face."""
    nodes = system.mesh.corners
    rows = net.rows[system.mesh.topology.corner_faces]
    return rows, system.corners + net.shifts[nodes], net.normals[nodes]


def split_step(step: FloatArray, n_faces: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Changes of rows (F, 5), shifts (V, 3) and normals (V, 4) in a step (5 F + 7 V,)."""
    nodes = step[FACE * n_faces :].reshape(-1, NODE)
    return step[: FACE * n_faces].reshape(-1, FACE), nodes[:, :POINT], nodes[:, POINT:]


def on_surface(
    surface: SmoothSurface, mesh: Mesh, weights: FloatArray, slack: float = 0.0
) -> Site:
    """Keep nodes on a smooth surface, and those of the boundary on its boundary.

    The mesh is the net at the start, in model coordinates, its boundary on that of the surface;
    the weights (V,) say how much the height of each node counts, 0 where it does not; heights
    of at most the slack, in mean edges, miss nothing. Nodes of the boundary miss as well the
    distance from its tangent at the start, those at a corner that from the corner.
    """
    size = mean_edge_length(mesh)
    unit_length = surface.mesh.size
    points, step = (mesh.vertices - surface.mesh.origin) / unit_length, size / unit_length
    _, upward = surface_heights(surface, points)
    held = _held_directions(mesh, upward)

    def _misses(net: NetState) -> Misses:
        heights, gradients = surface_heights(surface, points + step * net.shifts)
        heights = heights / step
        beyond = np.maximum(np.abs(heights) - slack, 0.0)
        gradients = gradients * (weights * ((beyond > 0) | (slack == 0)))[:, None]
        heights = np.copysign(beyond, heights) * weights
        across = np.einsum("vki,vi->vk", held, net.shifts)
        lengths = np.concatenate([heights[:, None], across], axis=1)
        slopes = np.zeros((*lengths.shape, NODE))
        slopes[..., :POINT] = np.concatenate([gradients[:, None], held], axis=1)
        return Misses(lengths, slopes)

    return _misses


def upright(site: Site, normals_there: FloatArray, largest: float) -> Site:
    """A site whose node axes also lean by no more than an angle, in radians.

    The normals (V, 3) are those of the surface at the nodes.

    Notes
    -----
    Where neighbouring spheres are all but one, the plane of their circle, and with it the axes
    of its nodes, may turn to any side at no cost. What leans less than allowed misses nothing.
    """
    slope = np.tan(largest)

    def _misses(net: NetState) -> Misses:
        there = site(net)
        axes = net.normals[:, 1:]
        rise = dot(axes, normals_there)
        across = axes - rise[:, None] * normals_there
        reach = norm(across)
        excess = np.maximum(reach - slope * np.abs(rise), 0.0)
        outward = across / np.where(reach > 0, reach, 1.0)[:, None]
        slopes = np.zeros((len(axes), 1, NODE))
        slopes[:, 0, POINT + 1 :] = (
            outward - slope * np.sign(rise)[:, None] * normals_there
        ) * (excess > 0)[:, None]
        return Misses(
            np.concatenate([there.lengths, excess[:, None]], axis=1),
            np.concatenate([there.slopes, slopes], axis=1),
        )

    return _misses


def node_distances(surface: SmoothSurface, mesh: Mesh) -> FloatArray:
    """Distances (V,) of the nodes of a net from a smooth surface, in mean edges of the net."""
    points = (mesh.vertices - surface.mesh.origin) / surface.mesh.size
    heights, _ = surface_heights(surface, points)
    return np.abs(heights) * surface.mesh.size / mean_edge_length(mesh)


def _held_directions(mesh: Mesh, upward: FloatArray) -> FloatArray:
    """Tangents (V, 2, 3) along which nodes stay: across the boundary, at corners both."""
    topology = mesh.topology
    leaving = np.flatnonzero(topology.twins < 0)
    tails, heads = mesh.corners[leaving], mesh.corners[topology.next_corners[leaving]]
    sides = unit(mesh.vertices[heads] - mesh.vertices[tails])
    ahead, behind = np.zeros((2, mesh.n_vertices, 3))
    ahead[tails], behind[heads] = sides, sides
    along = unit(ahead + behind)
    along = unit(along - dot(along, upward)[:, None] * upward)
    is_corner = norm(ahead - behind) > 2 * np.sin(LINE_CORNER / 2)
    across = np.cross(upward, along)
    return np.stack([across, along * is_corner[:, None]], axis=1)
