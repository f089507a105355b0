"""Sphere meshes dual to triangulations: a face for every vertex, a corner where three meet.

A triangle mesh with a sphere at every vertex gives a sphere mesh with the dual connectivity:
the spheres of a triangle meet in two points, mirror images in the plane of the three centres,
and the one nearest the triangle is a vertex. Regular triangulations give hexagons.

The formulas are those of Section 7 of the paper "Meshes with Spherical Faces".
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, face_vector_areas, mean_edge_length
from ..meshes.topology import previous_corners
from ..meshes.triangulation import check_triangles
from ..meshes.vertex_fans import VertexFans, vertex_fans
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.rows import from_plane, recenter
from ..tolerances import FAR_CORNER, SAME_PLANE
from .face_shapes import CONVEX, face_shapes
from .vertex_rule import corner_reach, meet_near, triangle_points, vertex_rows

BoundaryRule: TypeAlias = Literal["drop", "clip"]

IMAGINARY = "the spheres of triangles {} have no real point in common"
UNCLIPPED = "neighbouring spheres do not meet on the boundary"


@dataclass(frozen=True)
class DualSpheres:
    """A sphere mesh dual to a triangulation, and what could not be made.

    Attributes
    ----------
    sphere_mesh : SphereMesh
        One face for every vertex of the triangulation whose corners are all real.
    vertex_ids : (F,) int array
        Vertex of the triangulation of each face.
    left_out : tuple of (int, str)
        Vertices without a face, and the reason of each; boundary vertices that are dropped
        by rule are not among them.
    has_far_corner : (F,) bool array
        Faces with a corner far from its triangle: beyond the boundary, where triangles on it
        are obtuse.
    n_imaginary : int
        Triangles whose spheres have no real point in common.
    """

    sphere_mesh: SphereMesh
    vertex_ids: IntArray
    left_out: tuple[tuple[int, str], ...]
    has_far_corner: BoolArray
    n_imaginary: int


def dual_sphere_mesh(
    mesh: Mesh, spheres: ArrayLike, boundary: BoundaryRule = "drop"
) -> DualSpheres:
    """Sphere mesh with a face for every vertex of a triangulation.

    Parameters
    ----------
    mesh : Mesh
        A triangulation.
    spheres : (V, 5) array_like of float
        Real rows of any scale and orientation, planes included, in model coordinates.
    boundary : {"drop", "clip"}
        Faces only for inner vertices; or also for those of the boundary, cut off by the planes
        that stand on the boundary edges.

    Returns
    -------
    DualSpheres
        The sphere mesh and the vertices that have no face, with reasons.

    Raises
    ------
    InputError
        If faces are no triangles, a row is unusable, the rule is unknown, or no face remains.

    References
    ----------
    Meshes with Spherical Faces, Sec. 7.
    """
    check_triangles(mesh)
    if boundary not in ("drop", "clip"):
        raise InputError(f"boundary must be 'drop' or 'clip', not {boundary!r}")
    rows = _orient(mesh, vertex_rows(mesh, spheres))
    plan = _plan_faces(mesh, rows, boundary)
    if not plan.is_sound.any():
        raise InputError(
            "no vertex of the triangulation gets a face: there is no vertex with a closed ring "
            "of triangles whose spheres meet; use larger spheres or a finer mesh"
        )
    return _build_faces(mesh, rows, plan)


def bad_faces(mesh: Mesh, spheres: ArrayLike) -> tuple[tuple[int, str], ...]:
    """Inner vertices whose face cannot be made or is not convex, and why.

    Rows as for `dual_sphere_mesh`. Vertices in ascending order; the reason, or the shape of the
    face.
    """
    check_triangles(mesh)
    rows = _orient(mesh, vertex_rows(mesh, spheres))
    plan = _plan_faces(mesh, rows, "drop")
    if not plan.is_sound.any():
        return plan.left_out
    dual = _build_faces(mesh, rows, plan)
    shapes = face_shapes(dual.sphere_mesh)
    bad = np.flatnonzero(shapes != CONVEX)
    found = zip(dual.vertex_ids[bad].tolist(), shapes[bad].tolist(), strict=True)
    return tuple(sorted([*plan.left_out, *found]))


class _Plan(NamedTuple):
    """Which points make which face: owners and corners, one row per corner of a face."""

    vertices: IntArray
    owners: IntArray
    corners: IntArray
    points: FloatArray
    is_far: BoolArray
    is_sound: BoolArray
    left_out: tuple[tuple[int, str], ...]
    n_imaginary: int


def _plan_faces(mesh: Mesh, rows: FloatArray, boundary: BoundaryRule) -> _Plan:
    is_used = np.zeros(mesh.n_vertices, bool)
    is_used[mesh.corners] = True
    is_wanted = is_used if boundary == "clip" else ~mesh.topology.is_boundary_vertex
    fans = vertex_fans(mesh.topology, mesh.corners, np.flatnonzero(is_wanted), "last")
    points, is_real = triangle_points(mesh, rows)
    is_far = corner_reach(mesh, points) > FAR_CORNER
    points = points + face_centroids(mesh)
    owners = np.repeat(np.arange(len(fans.vertices)), np.diff(fans.offsets))
    corners = mesh.topology.corner_faces[fans.corners]
    n_imaginary = int((~is_real).sum())
    if boundary == "clip":
        rim, rim_real, turns = _rim_points(mesh, rows)
        points, is_real = np.concatenate([points, rim]), np.concatenate([is_real, rim_real])
        is_far = np.concatenate([is_far, np.zeros(len(rim), bool)])
        owners, corners = _close_fans(mesh, fans, owners, corners, turns)
    is_sound = np.ones(len(fans.vertices), bool)
    is_sound[owners[~is_real[corners]]] = False
    left_out = _reasons(fans.vertices, owners, corners, is_real, mesh.n_faces)
    return _Plan(
        fans.vertices, owners, corners, points, is_far, is_sound, left_out, n_imaginary
    )


def _build_faces(mesh: Mesh, rows: FloatArray, plan: _Plan) -> DualSpheres:
    keep = plan.is_sound[plan.owners]
    owners, corners = plan.owners[keep], plan.corners[keep]
    vertex_ids = plan.vertices[plan.is_sound]
    used, numbers = np.unique(corners, return_inverse=True)
    sizes = np.unique(owners, return_counts=True)[1]
    dual = Mesh(plan.points[used], np.split(numbers, np.cumsum(sizes)[:-1]))
    shifts = face_centroids(dual) - mesh.vertices[vertex_ids]
    sphere_mesh = SphereMesh.from_local(dual, recenter(rows[vertex_ids], shifts))
    has_far_corner = np.zeros(len(plan.vertices), bool)
    has_far_corner[owners[plan.is_far[corners]]] = True
    return DualSpheres(
        sphere_mesh, vertex_ids, plan.left_out, has_far_corner[plan.is_sound], plan.n_imaginary
    )


def _rim_points(mesh: Mesh, rows: FloatArray) -> tuple[FloatArray, BoolArray, BoolArray]:
    """Points of the boundary: where two spheres meet its edges' upright planes, then corners.

    Of b boundary half-edges: points (2 b, 3), whether they are real, and whether the boundary
    turns at their tails (b,). Where it does not, there is no corner.
    """
    topology, size = mesh.topology, mean_edge_length(mesh)
    leaving = np.flatnonzero(topology.twins < 0)
    tails, heads = mesh.corners[leaving], mesh.corners[topology.next_corners[leaving]]
    sides = mesh.vertices[heads] - mesh.vertices[tails]
    upright = unit(rows[tails, 1:4] + rows[heads, 1:4])
    walls = from_plane(unit(np.cross(upright, sides)), np.zeros(len(leaving)))
    # Seen from its middle, an edge plane passes through the origin; seen from its ends as well.
    middle = np.stack([sides / 2, -sides / 2, np.zeros_like(sides)], 1)
    edges = np.stack([rows[tails], rows[heads], walls], 1)
    edge_points, edge_real = meet_near(edges, middle, size)
    entering = np.empty(mesh.n_vertices, np.int64)
    entering[heads] = np.arange(len(leaving))
    before = walls[entering[tails]]
    turns = norm(np.cross(walls[:, 1:4], before[:, 1:4])) > SAME_PLANE
    corners = np.stack([rows[tails], walls, before], 1)
    corner_points, corner_real = meet_near(corners, np.zeros((len(leaving), 3, 3)), size)
    points = [
        mesh.vertices[tails] + sides / 2 + edge_points,
        mesh.vertices[tails] + corner_points,
    ]
    return np.concatenate(points), np.concatenate([edge_real, corner_real]), turns


def _close_fans(
    mesh: Mesh, fans: VertexFans, owners: IntArray, corners: IntArray, turns: BoolArray
) -> tuple[IntArray, IntArray]:
    """Faces of open fans closed by points of the boundary, numbered after the triangles."""
    topology = mesh.topology
    leaving = np.flatnonzero(topology.twins < 0)
    rank = np.full(len(mesh.corners), -1)
    rank[leaving] = np.arange(len(leaving))
    previous = previous_corners(topology)
    first = rank[fans.corners[fans.offsets[:-1]]]
    last = rank[previous[fans.corners[fans.offsets[1:] - 1]]]
    is_open = np.flatnonzero(first >= 0)
    first, last = first[is_open], last[is_open]
    bent = turns[first]
    groups = [
        (is_open, mesh.n_faces + first, 0),
        (owners, corners, 1),
        (is_open, mesh.n_faces + last, 2),
        (is_open[bent], mesh.n_faces + len(leaving) + first[bent], 3),
    ]
    all_owners = np.concatenate([group[0] for group in groups])
    places = np.concatenate([np.full(len(group[0]), group[2]) for group in groups])
    order = np.lexsort((places, all_owners))
    return all_owners[order], np.concatenate([group[1] for group in groups])[order]


def _orient(mesh: Mesh, rows: FloatArray) -> FloatArray:
    """Rows seen from the vertices, turned so that N agrees with the normals of the mesh."""
    areas = face_vector_areas(mesh)[mesh.topology.corner_faces]
    upwards = sum_by(mesh.corners, areas, mesh.n_vertices)
    return np.where(dot(rows[:, 1:4], upwards)[:, None] < 0, -rows, rows)


def _reasons(
    vertices: IntArray,
    owners: IntArray,
    corners: IntArray,
    is_real: BoolArray,
    n_triangles: int,
) -> tuple[tuple[int, str], ...]:
    missing = np.flatnonzero(~is_real[corners])
    result: dict[int, list[int]] = {}
    for place in missing.tolist():
        result.setdefault(int(vertices[owners[place]]), []).append(int(corners[place]))
    reasons: list[tuple[int, str]] = []
    for vertex, ids in sorted(result.items()):
        triangles = [point for point in ids if point < n_triangles]
        reason = IMAGINARY.format(name_ids(triangles)) if triangles else UNCLIPPED
        reasons.append((vertex, reason))
    return tuple(reasons)
