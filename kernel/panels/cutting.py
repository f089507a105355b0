"""Cutting panels out of the spheres of a mesh, by one plane per edge.

Neighbours share their cutting plane; their two arcs in it may differ by a gap, which is
measured here. What cannot be made is listed with its reason.
"""

from dataclasses import replace
from typing import NamedTuple, get_args

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..errors import InputError
from ..meshes.mesh import face_centroids, face_normals, local_corners, mean_edge_length
from ..meshes.topology import Topology
from ..parts.records import RejectedPart, part_ids, reject_parts
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.arcs import Arcs, sphere_arcs
from ..spheres.incidence import evaluate, meet_lines
from ..spheres.minkowski import angle
from ..spheres.rows import recenter
from ..tolerances import PLANE_SAGITTA, SAME_PLANE
from .checks import NO_PANEL, Found, rejection_reasons
from .edge_axes import EdgeMode, check_axes, outward_axes
from .panels import Panels, corner_points
from .thickness import ThicknessRule, ThicknessSide, panel_faces


def flatten_nearly_plane(sphere_mesh: SphereMesh) -> SphereMesh:
    """Replace spheres that bulge less than a workshop can tell by planes.

    A = 0 where the bulge ``L² / 8r`` of a face of size L is below `PLANE_SAGITTA` L. To be
    applied before cutting, so that neighbours agree.
    """
    mesh = sphere_mesh.mesh
    corners = local_corners(mesh)
    size = 2 * np.maximum.reduceat(norm(corners), mesh.offsets[:-1])
    rows = sphere_mesh.local_spheres.copy()
    is_flat = size * np.abs(rows[:, 0]) / 4 < PLANE_SAGITTA
    direction = unit(rows[:, 1:4])
    # The corners of a face average to the local origin: the plane through it is the mean one,
    # shifted by the sphere's own mean miss.
    heights = np.add.reduceat(
        evaluate(rows[mesh.topology.corner_faces], corners), mesh.offsets[:-1]
    )
    flat = np.zeros_like(rows)
    flat[:, 1:4] = direction
    flat[:, 4] = heights / mesh.degrees
    rows[is_flat] = flat[is_flat]
    return SphereMesh.from_local(mesh, rows)


def cutting_planes(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Plane that cuts each panel along each of its edges.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh, its nearly plane faces flattened (`flatten_nearly_plane`).
    edges : {"bisector", "intersection", "axis"}
        ``bisector``: the plane through the two vertices that bisects the two faces of the mesh.
        ``intersection``: the plane of the circle in which the two spheres meet; where they
        are the same sphere or one is a plane, the bisecting one. Boundary edges are cut by the
        plane through their vertices and the normal of their sphere. ``axis``: the plane
        through the two vertices and along the sum of their node axes, on the boundary as well.
    axes : (V, 2, 3) float array, optional
        Two points of each node axis, in any order: for ``axis`` alone.

    Returns
    -------
    plane_normals : (H, 3) float array
        Unit normals that point into the face of their corner; zero where two faces fold back
        onto each other, which no plane bisects.
    plane_offsets : (H,) float array
        Offsets of ``n·x = d`` in the coordinates local to the face.

    References
    ----------
    Meshes with Spherical Faces, Fig. 26 (a) and (d).
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    faces, twins = topology.corner_faces, topology.twins
    starts = local_corners(mesh)
    ends = starts[topology.next_corners]
    middles = (starts + ends) / 2
    rows = recenter(sphere_mesh.local_spheres[faces], middles)
    other = rows[twins]
    is_interior = twins >= 0
    across = face_normals(mesh)[faces]
    bisecting = across + across[twins]
    upright = np.where(is_interior[:, None], bisecting, unit(rows[:, 1:4]))
    if edges == "axis" and axes is not None:
        outward = outward_axes(mesh, axes)
        upright = outward[mesh.corners] + outward[mesh.corners[topology.next_corners]]
    # No plane bisects two faces that fold back onto each other.
    upright[norm(upright) < SAME_PLANE] = 0
    plane_normals = unit(np.cross(upright, ends - starts))
    plane_offsets = dot(plane_normals, middles)
    if edges == "intersection":
        radical = other[:, :1] * rows[:, 1:4] - rows[:, :1] * other[:, 1:4]
        constant = other[:, 0] * rows[:, 4] - rows[:, 0] * other[:, 4]
        length = norm(radical)
        scale = np.abs(rows[:, 0]) + np.abs(other[:, 0])
        # A plane meets a sphere in its own plane, which cannot cut it.
        curved = (rows[:, 0] != 0) & (other[:, 0] != 0)
        distinct = (length > SAME_PLANE * scale) & (angle(rows, other) > SAME_PLANE)
        use = is_interior & curved & distinct
        use &= upright.any(axis=1)
        side = np.where(dot(radical, plane_normals) < 0, -1.0, 1.0)
        divisor = np.where(use, side * length, 1.0)
        radical, constant = radical / divisor[:, None], constant / divisor
        plane_normals = np.where(use[:, None], radical, plane_normals)
        plane_offsets = np.where(use, constant + dot(radical, middles), plane_offsets)
    return plane_normals, plane_offsets


class _EdgeCuts(NamedTuple):
    """A mesh, nearly plane faces flattened, its cutting planes, and corners, if they exist."""

    sphere_mesh: SphereMesh
    plane_normals: FloatArray
    plane_offsets: FloatArray
    corners: FloatArray
    exists: BoolArray


def _cut_edges(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray | None, joint_gap: float = 0.0
) -> _EdgeCuts:
    """Cut the spheres along the edges; planes move into their faces by half of the gap."""
    sphere_mesh = flatten_nearly_plane(sphere_mesh)
    mesh = sphere_mesh.mesh
    plane_normals, plane_offsets = cutting_planes(sphere_mesh, edges, axes)
    plane_offsets = plane_offsets + joint_gap / 2
    rows = sphere_mesh.local_spheres[mesh.topology.corner_faces]
    corners, exists = corner_points(
        rows, plane_normals, plane_offsets, mesh.offsets, local_corners(mesh)
    )
    return _EdgeCuts(sphere_mesh, plane_normals, plane_offsets, corners, exists)


def edge_arcs(sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray | None = None) -> Arcs:
    """Arc of each half-edge on the sphere of its face, cut as in `cutting_planes`.

    H arcs in model coordinates, from corner to corner. The two arcs of an interior edge differ
    by its gap; where two spheres meet in a circle and are cut there, they coincide.

    References
    ----------
    Meshes with Spherical Faces, Fig. 26 (a), (c) and (d).
    """
    cuts = _cut_edges(sphere_mesh, edges, axes)
    mesh = cuts.sphere_mesh.mesh
    faces, following = mesh.topology.corner_faces, mesh.topology.next_corners
    rows = cuts.sphere_mesh.local_spheres[faces]
    arcs = sphere_arcs(rows, cuts.plane_normals, cuts.corners, cuts.corners[following])
    origins = face_centroids(mesh)[faces]
    return replace(arcs, starts=arcs.starts + origins, ends=arcs.ends + origins)


class EdgeGaps(NamedTuple):
    """Distances (E,) between the two arcs of interior edges, NaN where an arc does not exist.

    In the middle of the edge, and the larger of the two ends, in model units.
    """

    middle: FloatArray
    ends: FloatArray


def edge_gaps(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray | None = None
) -> FloatArray:
    """Largest distance (E,) between the two arcs of each interior edge, see `cutting_planes`.

    The largest of the gaps at the two ends and in the middle of each edge, in model units; NaN
    where an arc does not exist.
    """
    gaps = gaps_along_edges(sphere_mesh, edges, axes)
    return np.maximum(gaps.middle, gaps.ends)


def gaps_along_edges(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray | None = None
) -> EdgeGaps:
    """Distances between the two arcs of each interior edge, see `cutting_planes`.

    References
    ----------
    Meshes with Spherical Faces, Fig. 26 (d).
    """
    cuts = _cut_edges(sphere_mesh, edges, axes)
    mesh = cuts.sphere_mesh.mesh
    topology, starts = mesh.topology, local_corners(mesh)
    ends = starts[topology.next_corners]
    shifts = np.where(cuts.exists[:, None], cuts.corners - starts, np.nan)
    middles = (starts + ends) / 2
    rises = unit(np.cross(ends - starts, cuts.plane_normals))
    misses = cuts.plane_offsets - dot(cuts.plane_normals, middles)
    feet = middles + misses[:, None] * cuts.plane_normals
    rows = cuts.sphere_mesh.local_spheres[topology.corner_faces]
    heights, exists = meet_lines(rows, feet, rises)
    heights = np.where(exists, heights, np.nan)

    first, second = topology.edge_corners, topology.twins[topology.edge_corners]
    following = topology.next_corners
    start_gap = norm(shifts[first] - shifts[following[second]])
    end_gap = norm(shifts[following[first]] - shifts[second])
    return EdgeGaps(np.abs(heights[first] - heights[second]), np.maximum(start_gap, end_gap))


def gap_report(
    sphere_mesh: SphereMesh,
    edges: EdgeMode,
    face_ids: IntArray,
    axes: FloatArray | None = None,
) -> dict[str, float]:
    """Summary of the gaps between the arcs of neighbouring panels, of the faces (P,) made.

    ``max`` and ``mean`` over middles and ends, ``middle_p95`` and ``middle_max`` in the middle
    of edges, ``corner_p95`` and ``corner_max`` at their ends, in model units;
    ``relative_to_edge`` the maximum over the mean edge length, ``edges`` the number of edges
    measured; zeros if there are none. Edges of other faces, and those whose arcs exist with a
    joint only, are not measured.
    """
    is_made = np.zeros(sphere_mesh.mesh.n_faces, bool)
    is_made[face_ids] = True
    between = is_made[sphere_mesh.mesh.topology.edge_faces].all(axis=1)
    found = gaps_along_edges(sphere_mesh, edges, axes)
    between &= np.isfinite(found.middle + found.ends)
    middle, ends = found.middle[between], found.ends[between]
    gaps = np.maximum(middle, ends)
    largest = float(gaps.max(initial=0.0))
    return {
        "max": largest,
        "mean": float(gaps.mean()) if len(gaps) else 0.0,
        "relative_to_edge": largest / mean_edge_length(sphere_mesh.mesh),
        "middle_p95": float(np.percentile(middle, 95)) if len(gaps) else 0.0,
        "middle_max": float(middle.max(initial=0.0)),
        "corner_p95": float(np.percentile(ends, 95)) if len(gaps) else 0.0,
        "corner_max": float(ends.max(initial=0.0)),
        "edges": len(gaps),
    }


def cut_panels(
    sphere_mesh: SphereMesh,
    edges: EdgeMode = "bisector",
    thickness: float = 0.0,
    joint_gap: float = 0.0,
    labels: IntArray | None = None,
    side: ThicknessSide = "inward",
    layer: ThicknessRule = "offset",
    axes: FloatArray | None = None,
) -> tuple[Panels, tuple[RejectedPart, ...]]:
    """Cut a panel out of the sphere of every face.

    Parameters
    ----------
    edges : {"bisector", "intersection", "axis"}
        How panels are cut, see `cutting_planes`.
    thickness : float
        Distance of the inner from the outer face, in model units.
    joint_gap : float
        Width of the joint between neighbours, in model units; every cutting plane, those of
        the boundary included, moves into the panel by half of it.
    labels : (F,) int array, optional
        Mould of each face.
    side : {"inward", "outward", "centred"}
        Where the thickness goes from the sphere, see `panel_faces`.
    layer : {"offset", "power"}
        Whether the thickness or the difference of squared radii is constant.
    axes : (V, 2, 3) float array, optional
        Two points of each node axis: for edges cut by axes, and only for them.

    Returns
    -------
    panels : Panels
        The panels that can be made.
    rejected : tuple of RejectedPart
        All others, each with its reason.

    Raises
    ------
    InputError
        If an option is unknown, thickness or gap is negative or not finite, or axes are not
        what the edges need.
    """
    _check_choices(
        edges=(edges, EdgeMode), side=(side, ThicknessSide), layer=(layer, ThicknessRule)
    )
    _check_sizes(sphere_mesh.mesh.n_faces, thickness, joint_gap, labels)
    check_axes(sphere_mesh.mesh, edges, axes)
    cuts = _cut_edges(sphere_mesh, edges, axes, joint_gap)
    mesh, topology = cuts.sphere_mesh.mesh, cuts.sphere_mesh.mesh.topology
    rows = cuts.sphere_mesh.local_spheres
    sides = panel_faces(rows, thickness, side, layer)
    faces = topology.corner_faces
    planes = cuts.plane_normals, cuts.plane_offsets, mesh.offsets
    corners, exists = corner_points(sides.outer_spheres[faces], *planes, cuts.corners)
    inner_corners, inner_exists = corner_points(
        sides.inner_spheres[faces], *planes, cuts.corners
    )
    panels = Panels(
        ids=part_ids("P", mesh.n_faces),
        face_ids=np.arange(mesh.n_faces),
        labels=np.full(mesh.n_faces, -1) if labels is None else np.asarray(labels, np.int64),
        origins=face_centroids(mesh),
        spheres=sides.outer_spheres,
        inner_spheres=sides.inner_spheres,
        design_spheres=rows,
        offsets=mesh.offsets,
        plane_normals=cuts.plane_normals,
        plane_offsets=cuts.plane_offsets,
        corners=corners,
        inner_corners=inner_corners,
        neighbors=np.append(faces, -1)[topology.twins],
        edge_ids=_edge_ids(topology),
        is_crease=np.zeros(len(faces), bool),
        thicknesses=sides.thicknesses,
        thickness=float(thickness),
        joint_gap=float(joint_gap),
    )
    found = Found(local_corners(mesh), sides.exists, cuts.exists, exists, inner_exists)
    return reject_parts(panels, rejection_reasons(panels, found), NO_PANEL)


def thickness_report(panels: Panels) -> dict[str, float]:
    """``min``, ``mean`` and ``max`` of the thicknesses, in model units; 0 without panels."""
    found = panels.thicknesses if panels.n_panels else np.zeros(1)
    return {"min": float(found.min()), "mean": float(found.mean()), "max": float(found.max())}


def _edge_ids(topology: Topology) -> IntArray:
    """Interior edge of each half-edge (H,); -1 on the boundary."""
    ids = np.full(len(topology.corner_faces), -1)
    first = topology.edge_corners
    ids[first] = ids[topology.twins[first]] = np.arange(len(first))
    return ids


def _check_choices(**options: tuple[str, object]) -> None:
    for name, (value, allowed) in options.items():
        choices: tuple[str, ...] = get_args(allowed)
        if value not in choices:
            listed = f"{', '.join(choices[:-1])} or {choices[-1]}"
            raise InputError(f"{name} must be {listed}, not {value!r}")


def _check_sizes(
    n_faces: int, thickness: float, joint_gap: float, labels: IntArray | None
) -> None:
    for name, value in (("thickness", thickness), ("joint gap", joint_gap)):
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"{name} must be a length of at least 0, not {value}")
    if labels is not None and len(labels) != n_faces:
        raise InputError(f"labels must name a mould for each of the {n_faces} faces")
