"""Supports whose beams stand in the walls of the panels: on node axes, or upright.

Vertices and spheres stay where they are. With node axes (`beam_axes`) a beam lies in the plane
of its chord and its two axes: none of this depends on the radii of the spheres, so any number
of moulds is possible. Where the spheres themselves have exact nodes, their axes are taken, and
these planes are those in which the spheres meet.
"""

from dataclasses import dataclass
from typing import Any, Final, Literal, NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..meshes.mesh import Mesh, mean_edge_length
from ..panels.cutting import cutting_planes, flatten_nearly_plane, gaps_along_edges
from ..panels.edge_axes import EdgeMode, outward_axes
from ..sphere_meshes.fit import fit_spheres
from ..sphere_meshes.planarity_circularity import planarity
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ..tolerances import BEAM_TILT, COMMON_VERTEX, NODE_TORSION, UPRIGHT_BEAMS
from .annulus_construction import AnnuliReport, AnnulusSupport, annulus_report
from .beam_axes import (
    LEAN_WEIGHT,
    LOOSE_LEAN_WEIGHT,
    beam_axes,
    beam_edges,
    upright_directions,
)
from .node_axes import support_structure

TOLD_BULGE: Final = 1e-5
"""Faces whose corners lie farther off their plane, in mean edges, tell their own sphere."""

MOSTLY_TOLD: Final = 0.9
"""Share of the faces that have to tell their own sphere for a mesh to have spheres."""

WallKind = Literal["axis", "bisector"]


class NodeAxes(NamedTuple):
    """Two points of each node axis (V, 2, 3), outer side first, and whether spheres give them.

    The first point is the vertex, the second lies one mean edge inside.
    """

    points: FloatArray
    is_exact: bool


def support_axes(sphere_mesh: SphereMesh) -> NodeAxes:
    """Node axes for beams in planes of their edge and its axes.

    Notes
    -----
    Those of the spheres where all of them are exact already: hexagonal and remeshed nets. Else
    those of the axis problem; of triangles, which have more edges than axes can please, with
    the smaller price on leaning.
    """
    exact = exact_directions(sphere_mesh)
    mesh = sphere_mesh.mesh
    if exact is not None:
        return NodeAxes(axis_points(mesh, exact), is_exact=True)
    weight = LOOSE_LEAN_WEIGHT if is_mostly_triangles(mesh) else LEAN_WEIGHT
    return NodeAxes(axis_points(mesh, beam_axes(mesh, weight)), is_exact=False)


def is_mostly_triangles(mesh: Mesh) -> bool:
    """Whether most faces are triangles."""
    return 2 * int((mesh.degrees == 3).sum()) > mesh.n_faces


def axis_points(mesh: Mesh, directions: FloatArray) -> FloatArray:
    """Two points (V, 2, 3) of the axes through the vertices along unit directions (V, 3)."""
    inside = mesh.vertices + mean_edge_length(mesh) * directions
    return np.stack([mesh.vertices, inside], 1)


def exact_directions(sphere_mesh: SphereMesh) -> FloatArray | None:
    """Directions (V, 3) of node axes that the spheres have in common; None if they do not.

    They do if all vertices lie on their spheres, the planes on these axes are those where
    spheres meet, no node has torsion and beams stand upright.
    """
    inside = ~sphere_mesh.mesh.topology.is_boundary_vertex
    miss = float(vertex_error(sphere_mesh).max()) / mean_edge_length(sphere_mesh.mesh)
    if miss > COMMON_VERTEX or not inside.any():
        return None
    directions = support_structure(sphere_mesh).directions
    planes = wall_planes(sphere_mesh, "axis", axis_points(sphere_mesh.mesh, directions))
    meet = wall_planes(sphere_mesh, "intersection", None)
    torsion = node_torsion(beam_edges(sphere_mesh.mesh), planes, directions)
    tilt = inner_tilt(sphere_mesh, planes)
    is_exact = (
        torsion.max() <= NODE_TORSION
        and np.percentile(tilt, 95) <= UPRIGHT_BEAMS
        and tilt.max() <= BEAM_TILT
        and plane_angles(planes, meet)[_is_inner(sphere_mesh.mesh)].max() <= NODE_TORSION
    )
    return directions if is_exact else None


def own_spheres(mesh: Mesh) -> SphereMesh | None:
    """The spheres that a mesh has already, if their nodes are exact; None if not.

    Its faces have to tell them: nearly all of them bulge, where plane ones would leave the
    sphere open or be planes already.
    """
    is_told = planarity(mesh) > TOLD_BULGE * mean_edge_length(mesh)
    if is_told.mean() < MOSTLY_TOLD:
        return None
    spheres = fit_spheres(mesh, 0)
    return None if exact_directions(spheres) is None else spheres


def inner_tilt(sphere_mesh: SphereMesh, planes: FloatArray) -> FloatArray:
    """Angles (E,) between planes (B, 3) of all edges and those that bisect the faces.

    Of inner edges, in radians.
    """
    upright = wall_planes(sphere_mesh, "bisector", None)
    return plane_angles(planes, upright)[_is_inner(sphere_mesh.mesh)]


def plane_angles(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles between planes of unit normals, in [0, π/2]."""
    angles = 2 * np.arctan2(norm(first - second), norm(first + second))
    return np.minimum(angles, np.pi - angles)


def _is_inner(mesh: Mesh) -> BoolArray:
    """Which of all edges lie between two faces, (B,)."""
    twins = mesh.topology.twins
    inner: BoolArray = twins[(twins > np.arange(len(twins))) | (twins < 0)] >= 0
    return inner


def bisector_axes(sphere_mesh: SphereMesh) -> FloatArray:
    """Two points of each node axis (V, 2, 3), as near as can be to upright beams.

    Notes
    -----
    The direction ``N + t`` that minimises ``Σ (m·(N + t))² + w² |t|²`` over the planes m of the
    beams of the node, w the weight of the axis problem.
    """
    mesh = sphere_mesh.mesh
    planes = wall_planes(sphere_mesh, "bisector", None)
    ends = beam_edges(mesh)
    nodes, around = ends.T.ravel(), np.concatenate([planes, planes])
    squares = (around[:, :, None] * around[:, None]).reshape(-1, 9)
    gram = sum_by(nodes, squares, mesh.n_vertices).reshape(-1, 3, 3)
    upright = upright_directions(mesh)
    across = np.eye(3) - upright[:, :, None] * upright[:, None]
    pull = np.einsum("vij,vjk,vk->vi", across, gram, upright)
    # Along the normal, and where there is none, the system is the identity: t is tangential.
    system = across @ (gram + LEAN_WEIGHT**2 * np.eye(3)) @ across
    is_used = norm(upright)[:, None, None] > 0
    system = np.where(is_used, system + upright[:, :, None] * upright[:, None], np.eye(3))
    leans = np.asarray(np.linalg.solve(system, pull[..., None]), np.float64)
    return axis_points(mesh, -unit(upright - leans.reshape(-1, 3)))


def wall_planes(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray | None
) -> FloatArray:
    """Unit normals (B, 3) of the planes that cut panels, in the order of `beam_edges`."""
    twins = sphere_mesh.mesh.topology.twins
    first = (twins > np.arange(len(twins))) | (twins < 0)
    return cutting_planes(flatten_nearly_plane(sphere_mesh), edges, axes)[0][first]


@dataclass(frozen=True, eq=False)
class SupportReport(AnnuliReport):
    """What a user must know about beams that stand in the walls of the panels.

    Attributes
    ----------
    kind : {"axis", "bisector"}
    is_exact : bool
        Whether the axes are those of the spheres, and the planes those where spheres meet.
    inner_tilt_deg : dict
        Angles between the planes of inner beams and those that bisect the faces: ``p95`` and
        ``max``.
    torsion_deg : dict
        Angles between the axes and the planes of their beams: ``p95`` and ``max`` over nodes.
    lean_deg : dict
        Angles between the axes and the normals of the mesh: ``p95`` and ``max``.
    gap : dict
        Between the arcs of neighbouring panels in these planes, in mean edges: ``p95`` and
        ``max`` in the middle of edges, ``corner_p95`` and ``corner_max`` at their ends.
    node_radius : float
        Least radius of node cylinders that take up the torsion, in model units; 0 where none
        is needed.
    """

    kind: str
    is_exact: bool
    inner_tilt_deg: dict[str, float]
    torsion_deg: dict[str, float]
    lean_deg: dict[str, float]
    gap: dict[str, float]
    node_radius: float


def beam_support_report(
    sphere_mesh: SphereMesh,
    found: AnnulusSupport,
    kind: WallKind,
    axes: NodeAxes,
    node_radius: float = 0.0,
) -> SupportReport:
    """The report of annuli that stand in the walls of the panels."""
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    used = np.zeros(mesh.n_vertices, bool)
    used[mesh.corners] = True
    directions = -outward_axes(mesh, axes.points)
    planes = wall_planes(sphere_mesh, kind, axes.points)
    torsion = np.degrees(node_torsion(beam_edges(mesh), planes, directions))[used]
    lean = np.degrees(lean_angles(mesh, directions))[used]
    gaps = gaps_along_edges(sphere_mesh, kind, axes.points)
    common: dict[str, Any] = dict(annulus_report(found, size))
    return SupportReport(
        **common,
        kind=kind,
        is_exact=axes.is_exact,
        inner_tilt_deg=upper_values(np.degrees(inner_tilt(sphere_mesh, planes))),
        torsion_deg=upper_values(torsion),
        lean_deg=upper_values(lean),
        gap={
            **upper_values(gaps.middle / size),
            **{f"corner_{key}": gap for key, gap in upper_values(gaps.ends / size).items()},
        },
        node_radius=node_radius,
    )


def node_torsion(ends: IntArray, planes: FloatArray, directions: FloatArray) -> FloatArray:
    """Largest angle (V,) between an axis and the planes of its beams, in radians.

    Vertices (B, 2) and unit normals (B, 3) of the beams, unit directions (V, 3) of the axes.
    """
    sines = np.abs(dot(directions[ends], planes[:, None]))
    result = np.zeros(len(directions))
    np.maximum.at(result, ends.ravel(), np.arcsin(np.minimum(sines, 1.0)).ravel())
    return result


def lean_angles(mesh: Mesh, directions: FloatArray) -> FloatArray:
    """Angles (V,) between axes to the inner side and the normals of the mesh, in radians."""
    upright = upright_directions(mesh)
    return 2 * np.arctan2(norm(upright + directions), norm(upright - directions))


def upper_values(values: FloatArray) -> dict[str, float]:
    """``p95`` and ``max`` of those values that are numbers; 0 without any."""
    known: FloatArray = values[np.isfinite(values)]
    if len(known) == 0:
        return {"p95": 0.0, "max": 0.0}
    return {"p95": float(np.percentile(known, 95)), "max": float(known.max())}
