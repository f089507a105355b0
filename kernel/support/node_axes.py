"""Support structures: the axes of nodes, and whether the beams that meet there share them.

Neighbouring spheres meet in a circle, and a beam along their edge lies in the plane of that
circle. The node at a vertex is free of torsion if the planes of its beams have a line in
common, the node axis; then, and only then, the centres of the spheres around the vertex lie in
a plane, and the vertex mirrored in that plane lies on all of its spheres.

Section 4.1 of the paper "Meshes with Spherical Faces". Planes are spheres like others: their
centres are points at infinity, and nothing divides by A.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, batches_by_count, dot, norm, sum_by, unit
from ..meshes.mesh import Mesh, local_corners, mean_edge_length
from ..panels.cutting import flatten_nearly_plane
from ..reports import Report
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import signed_distance
from ..spheres.minkowski import angle
from ..spheres.rows import recenter
from ..tolerances import (
    AXIS_LEAN,
    MIRROR_LEAST,
    MIRROR_REACH,
    NODE_LINE,
    NODE_TORSION,
    PARALLEL_PLANES,
    SAME_PLANE,
)
from .beam_tilt import beam_tilt
from .rim_axes import rim_axes


@dataclass(frozen=True)
class ArcPlanes:
    """Planes of the circles in which neighbouring spheres meet, one per interior edge.

    Attributes
    ----------
    normals : (E, 3) float array
        Unit normals, along ``A B' - A' B`` (left and right face); zero where there is none.
    offsets : (E,) float array
        Offsets d of ``n·x = d``, with the middle of the edge's chord as origin.
    exists : (E,) bool array
        False where both faces lie on the same sphere: any plane would do.
    """

    normals: FloatArray
    offsets: FloatArray
    exists: BoolArray


@dataclass(frozen=True)
class SupportStructure:
    """The nodes of a support structure, one per vertex.

    Attributes
    ----------
    axes : (V, 2, 3) float array
        Two points of each node axis: the vertex and, where `has_mirror`, its mirror image;
        elsewhere the point of the axis one mean edge inside.
    directions : (V, 3) float array
        Unit vectors along the axes, to the inner side; zero for unused vertices.
    normals : (V, 3) float array
        Unit normals of the spheres at the vertices, averaged over the faces.
    torsion : (V,) float array
        Largest angle between an arc plane and the axis, in radians.
    line_miss : (V,) float array
        Distance of the farthest arc plane from the line along the axis that is nearest to all
        of them, in model units: 0 where they have a line in common.
    mirror_miss : (V,) float array
        Distance of the mirror image from the farthest of its spheres, in model units; NaN
        where it is at infinity.
    coplanarity, rank : (V,) float array
        Fourth singular value, relative to the first, of the centres around the vertex in
        homogeneous coordinates (Prop. 4.2) and of the lifted spheres (Prop. 4.3).
    has_mirror : (V,) bool array
        Whether the mirror image is at a distance between `MIRROR_LEAST` and `MIRROR_REACH`
        mean edges.
    """

    axes: FloatArray
    directions: FloatArray
    normals: FloatArray
    torsion: FloatArray
    line_miss: FloatArray
    mirror_miss: FloatArray
    coplanarity: FloatArray
    rank: FloatArray
    has_mirror: BoolArray


def arc_planes(sphere_mesh: SphereMesh) -> ArcPlanes:
    """Planes of the circles in which neighbouring spheres meet.

    Nearly plane faces are flattened before (`flatten_nearly_plane`). Two planes meet in a line:
    theirs is the plane through the edge that bisects them. A sphere and a plane meet in a
    circle of that plane.

    References
    ----------
    Meshes with Spherical Faces, eq. (4) and Sec. 4.1.
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    size = mean_edge_length(mesh)
    starts = local_corners(mesh)
    middles = (starts + starts[topology.next_corners]) / 2
    along = unit(starts[topology.next_corners] - starts)[topology.edge_corners]
    first = topology.edge_corners
    second = topology.twins[first]
    units = np.array([size, 1.0, 1.0, 1.0, 1 / size])
    left = recenter(sphere_mesh.local_spheres[topology.edge_faces[:, 0]], middles[first])
    right = recenter(sphere_mesh.local_spheres[topology.edge_faces[:, 1]], middles[second])
    left, right = left * units, right * units
    radical = left[:, :1] * right - right[:, :1] * left
    scale = np.abs(left[:, 0]) + np.abs(right[:, 0])
    is_flat = scale == 0
    turned = right[:, 1:4] - left[:, 1:4]
    radical[is_flat, 1:4] = (turned - dot(turned, along)[:, None] * along)[is_flat]
    length = norm(radical[:, 1:4])
    exists = (length > SAME_PLANE * np.where(is_flat, 1.0, scale)) & (
        angle(left, right) > SAME_PLANE
    )
    radical = np.where(exists[:, None], radical, 0.0) / np.where(exists, length, 1.0)[:, None]
    return ArcPlanes(radical[:, 1:4], radical[:, 4] * size, exists)


def support_structure(sphere_mesh: SphereMesh) -> SupportStructure:
    """Node axes, and how far the nodes are from being free of torsion.

    Spheres that bulge less than a workshop can tell count as planes, as they do for panels
    (`flatten_nearly_plane`).

    Notes
    -----
    The axis is the direction that is, in least squares, nearest to all arc planes around the
    vertex: the last right singular vector of their unit normals. Neighbours on the same sphere
    have no arc plane and are skipped. Where fewer than two different planes are left, as at
    most vertices of the boundary, the normal of the vertex completes them: the axis is the
    direction of the plane nearest to it, or the normal itself. Along sides of the boundary,
    from corner to corner, axes then turn by a little until the beams there are flat
    (`rim_axes`).

    The mirror image is ``v + t a`` with t the least squares solution of ``A t = N·a`` over the
    spheres of the vertex.

    References
    ----------
    Meshes with Spherical Faces, Def. 4.1, Prop. 4.2 and 4.3, Fig. 7.
    """
    sphere_mesh = flatten_nearly_plane(sphere_mesh)
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    rows = recenter(
        sphere_mesh.local_spheres[mesh.topology.corner_faces], local_corners(mesh)
    ) * np.array([size, 1.0, 1.0, 1.0, 1 / size])
    vertex_normals = unit(sum_by(mesh.corners, rows[:, 1:4], mesh.n_vertices))
    planes = arc_planes(sphere_mesh)
    directions, torsion = _axes(
        mesh, mesh.topology.edge_vertices[planes.exists], planes.normals[planes.exists],
        vertex_normals,
    )  # fmt: skip
    line_miss = _line_miss(sphere_mesh.mesh, planes, directions)
    reach, has_mirror, miss = _mirror(rows, mesh.corners, directions)
    steps = np.where(has_mirror, reach, 1.0)[:, None] * directions * size
    axes = np.stack([mesh.vertices, mesh.vertices + steps], 1)
    coplanarity = _fourth_value(rows[:, :4], mesh.corners, mesh.n_vertices)
    rank = _fourth_value(rows, mesh.corners, mesh.n_vertices)
    return SupportStructure(
        axes,
        directions,
        vertex_normals,
        torsion,
        line_miss,
        miss * size,
        coplanarity,
        rank,
        has_mirror,
    )


def _axes(
    mesh: Mesh, ends: IntArray, plane_normals: FloatArray, vertex_normals: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Axis directions (V, 3) of arc planes between the vertices `ends` (E, 2), and torsion."""
    nodes, around = ends.T.ravel(), np.concatenate([plane_normals, plane_normals])
    result = -vertex_normals
    only = np.zeros_like(result)
    for vertices, ids in batches_by_count(nodes, len(vertex_normals)):
        _, values, basis = np.linalg.svd(around[ids])
        normal, first = vertex_normals[vertices], basis[:, 0]
        within = normal - dot(normal, first)[:, None] * first
        spread = values[:, 1] if values.shape[1] > 1 else np.zeros(len(values))
        is_line = spread > PARALLEL_PLANES * values[:, 0]
        found = np.where(is_line[:, None], basis[:, 2], unit(within))
        result[vertices] = np.where(dot(found, normal)[:, None] > 0, -found, found)
        only[vertices] = np.where(is_line[:, None], np.nan, first)
    result = rim_axes(mesh, result, only)
    torsion = np.zeros(len(vertex_normals))
    sines = np.abs(dot(around, result[nodes]))
    np.maximum.at(torsion, nodes, np.arcsin(np.minimum(sines, 1.0)))
    return result, torsion


def _line_miss(mesh: Mesh, planes: ArcPlanes, directions: FloatArray) -> FloatArray:
    """Distances (V,) of the farthest arc planes from the best lines along the axes."""
    first = mesh.topology.edge_corners[planes.exists]
    starts = local_corners(mesh)
    chords = (starts[mesh.topology.next_corners] - starts)[first]
    normals, offsets = planes.normals[planes.exists], planes.offsets[planes.exists]
    rises = dot(chords, normals) / 2
    nodes = mesh.topology.edge_vertices[planes.exists].T.ravel()
    levels = np.concatenate([-rises - offsets, rises - offsets])
    around = np.concatenate([normals, normals])
    around = around - dot(around, directions[nodes])[:, None] * directions[nodes]
    result = np.zeros(mesh.n_vertices)
    for vertices, ids in batches_by_count(nodes, mesh.n_vertices):
        # The least move of the vertex across its axis, to where planes are nearest on average.
        inverse = np.linalg.pinv(around[ids], rcond=PARALLEL_PLANES)
        moves = -np.einsum("vik,vk->vi", inverse, levels[ids])
        misses = levels[ids] + np.einsum("vki,vi->vk", around[ids], moves)
        result[vertices] = np.abs(misses).max(axis=1)
    return result


def _mirror(
    rows: FloatArray, corners: IntArray, directions: FloatArray
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """Signed distances of mirror images along the axes, which are of use, and their miss."""
    curvature, count = rows[:, 0], len(directions)
    along = dot(rows[:, 1:4], directions[corners])
    numerator = sum_by(corners, curvature * along, count)
    denominator = sum_by(corners, curvature**2, count)
    is_finite = (np.abs(numerator) <= MIRROR_REACH * denominator) & (denominator > 0)
    reach = np.divide(numerator, denominator, out=np.zeros(count), where=is_finite)
    distances = np.abs(signed_distance(rows, (reach[:, None] * directions)[corners]))
    miss = np.zeros(count)
    np.maximum.at(miss, corners, distances)
    has_mirror = is_finite & (np.abs(reach) >= MIRROR_LEAST)
    return reach, has_mirror, np.where(is_finite, miss, np.nan)


def _fourth_value(rows: FloatArray, corners: IntArray, n_vertices: int) -> FloatArray:
    """Fourth singular value of the rows around each vertex, relative to the first."""
    result = np.zeros(n_vertices)
    for vertices, ids in batches_by_count(corners, n_vertices):
        if ids.shape[1] > 3:
            values = np.linalg.svd(rows[ids], compute_uv=False)
            result[vertices] = values[:, 3] / values[:, 0]
    return result


def node_reasons(structure: SupportStructure, size: float) -> dict[int, str]:
    """Why nodes are not valid, by vertex: of several reasons the first.

    The size is the mean edge of the mesh.
    """
    reasons: dict[int, str] = {}
    is_unused = ~structure.directions.any(axis=1)
    for vertex in np.flatnonzero(is_unused).tolist():
        reasons[vertex] = "the vertex belongs to no face"
    torsion = np.degrees(structure.torsion)
    for vertex in np.flatnonzero(structure.torsion > NODE_TORSION).tolist():
        reasons.setdefault(
            vertex, f"the beams' planes miss the axis by up to {torsion[vertex]:.3g} degrees"
        )
    miss = structure.line_miss / size
    for vertex in np.flatnonzero(miss > NODE_LINE).tolist():
        reasons.setdefault(
            vertex,
            f"the beams' planes miss a common line by {structure.line_miss[vertex]:.3g}, "
            f"{100 * miss[vertex]:.2g} % of an edge",
        )
    lean = axis_lean(structure)
    for vertex in np.flatnonzero(lean > AXIS_LEAN).tolist():
        reasons.setdefault(
            vertex, f"the axis leans {np.degrees(lean[vertex]):.3g} degrees from the normal"
        )
    return dict(sorted(reasons.items()))


def axis_lean(structure: SupportStructure) -> FloatArray:
    """Angles (V,) between the axes and the normals of the vertices, in [0, π/2].

    In radians; 0 for unused vertices.
    """
    inward, normal = structure.directions, -structure.normals
    return 2 * np.arctan2(norm(inward - normal), norm(inward + normal))


@dataclass(frozen=True, eq=False)
class NodesReport(Report):
    """What a user must know about the nodes and beams of a sphere mesh.

    Attributes
    ----------
    torsion_deg : dict
        ``mean`` and ``max`` over the interior vertices, ``boundary_max``.
    line_miss : float
        Largest distance of a beam's plane from the line that the beams of a node have in
        common, in mean edges, over all nodes.
    mirror_miss : float
        Largest distance of a mirror point from its spheres, in mean edges, over the interior
        nodes of at least three faces.
    beam_tilt_deg : dict
        ``p95`` and ``max``.
    axes_without_mirror : int
        Axes that end one mean edge inside.
    edges_without_circle : int
        Neighbours on the same sphere.
    invalid : list of dict
        ``id``, ``vertex`` and ``reason`` of each node.
    """

    torsion_deg: dict[str, float]
    line_miss: float
    mirror_miss: float
    beam_tilt_deg: dict[str, float]
    axes_without_mirror: int
    edges_without_circle: int
    valid: int
    invalid: list[dict[str, Any]]


def support_report(sphere_mesh: SphereMesh, structure: SupportStructure) -> NodesReport:
    """The report of nodes."""
    topology = sphere_mesh.mesh.topology
    inside = ~topology.is_boundary_vertex
    degrees = np.degrees(structure.torsion)
    enough = np.bincount(sphere_mesh.mesh.corners, minlength=len(inside)) >= 3
    miss = np.nan_to_num(structure.mirror_miss[inside & enough])
    tilt = np.degrees(beam_tilt(sphere_mesh))
    size = mean_edge_length(sphere_mesh.mesh)
    reasons = node_reasons(structure, size)
    return NodesReport(
        torsion_deg={
            "mean": float(degrees[inside].mean()) if inside.any() else 0.0,
            "max": float(degrees[inside].max(initial=0.0)),
            "boundary_max": float(degrees[~inside].max(initial=0.0)),
        },
        line_miss=float(structure.line_miss.max(initial=0.0)) / size,
        mirror_miss=float(miss.max(initial=0.0)) / size,
        beam_tilt_deg={
            "p95": float(np.percentile(tilt, 95)) if len(tilt) else 0.0,
            "max": float(tilt.max(initial=0.0)),
        },
        axes_without_mirror=int((~structure.has_mirror).sum()),
        edges_without_circle=int((~arc_planes(flatten_nearly_plane(sphere_mesh)).exists).sum()),
        valid=len(inside) - len(reasons),
        invalid=[
            {"id": node_name(vertex), "vertex": vertex, "reason": reason}
            for vertex, reason in reasons.items()
        ],
    )


def node_name(vertex: int) -> str:
    """Stable name of a node: ``N0000`` for the first.

    Examples
    --------
    >>> node_name(7)
    'N0007'
    """
    return f"N{vertex:04d}"
