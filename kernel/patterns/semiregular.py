"""Semi-regular patterns: even triangles or quads with corners cut, or faces drawn apart.

Named by the degrees of the faces around a vertex. 3.6.3.6 joins the middles of the edges of
triangles, 3.4.6.4 draws triangles apart, and 4.8.8 cuts the corners of quads; where the
triangles or quads are regular all edges have one length. Cells end at the boundary.
"""

from typing import Any, Final, Literal

import numpy as np

from ..arrays import FloatArray, IntArray
from ..congruences.curvature_spheres import sphere_congruence
from ..errors import InputError
from ..meshes.mesh import Mesh, face_centroids
from ..meshes.topology import previous_corners
from ..meshes.vertex_fans import vertex_fans
from ..optimization.angle_minimization import minimize_angles
from ..remesh import pipeline
from ..sphere_meshes.fit import fit_spheres
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..surfaces.surface import Surface
from ..tolerances import CREASE, OPENING
from .gain_report import check_edge
from .net_flaws import PatternJudgement, judge_faces
from .panel_scale import FINENESS, even_triangles

SemiregularKind = Literal["3.6.3.6", "3.4.6.4", "4.8.8"]

COARSER: Final = {"3.6.3.6": 2.0, "3.4.6.4": 1 + np.sqrt(3), "4.8.8": 1 + np.sqrt(2)}
"""Edges of the triangles or quads below, in edges of the pattern."""

NEARLY_FLAT_RADIUS = 3.0
"""Radius of the spheres that quads are made for, in diagonals of the surface."""


def semiregular_pattern(
    source: Mesh | Surface, edge: float, kind: SemiregularKind
) -> tuple[SphereMesh, PatternJudgement]:
    """A semi-regular pattern on a surface, with the spheres that meet most smoothly.

    Raises
    ------
    InputError
        If the kind is unknown, the length is not positive, or too large for the surface.
    """
    check_edge(edge)
    if kind not in COARSER:
        raise InputError(f"a kind is one of {', '.join(COARSER)}, not {kind}")
    mesh = source.mesh if isinstance(source, Surface) else source
    coarse = COARSER[kind] * edge
    ground = even_triangles(mesh, coarse / FINENESS)
    if kind == "4.8.8":
        pattern = truncated(_quads(ground, coarse), edge / coarse)
    else:
        triangles = even_triangles(mesh, coarse)
        pattern = medial(triangles) if kind == "3.6.3.6" else expanded(triangles)
    laid = Mesh(_feet(pattern.vertices, ground), pattern.faces)
    net, _ = minimize_angles(fit_spheres(laid), crease=CREASE, max_opening=OPENING)
    return net, judge_faces(net, "bisector", convex=False)


def _quads(ground: Mesh, edge: float) -> Mesh:
    """Quads along the lines of curvature; their nodes lie on the ground."""
    radius = NEARLY_FLAT_RADIUS * float(np.linalg.norm(np.ptp(ground.vertices, axis=0)))
    spheres = sphere_congruence(ground, "tangent", radius)[0]
    return pipeline.remesh(ground, spheres, edge).sphere_mesh.mesh


def medial(mesh: Mesh) -> Mesh:
    """The middles of the edges as vertices, a face for each face and each vertex before."""
    half_edges = np.arange(len(mesh.corners))
    twins, following = mesh.topology.twins, mesh.topology.next_corners
    own = (twins < 0) | (twins > half_edges)
    ids = np.zeros(len(half_edges), np.int64)
    ids[own] = np.arange(own.sum())
    ids[~own] = ids[twins[~own]]
    middles = (mesh.vertices[mesh.corners] + mesh.vertices[mesh.corners[following]]) / 2
    inside = np.split(ids, mesh.offsets[1:-1])
    return _closed_up(mesh, middles[own], inside, (ids, ids))


def truncated(mesh: Mesh, share: float) -> Mesh:
    """Corners cut off, so that a share of each edge is left in its middle."""
    count = len(mesh.corners)
    half_edges = np.arange(count)
    twins, following = mesh.topology.twins, mesh.topology.next_corners
    tails, heads = mesh.vertices[mesh.corners], mesh.vertices[mesh.corners[following]]
    cut = (1 - share) / 2
    points = np.concatenate([tails + cut * (heads - tails), heads + cut * (tails - heads)])
    arriving = np.where(twins >= 0, twins, count + half_edges)
    pairs = np.stack([half_edges, arriving], axis=1)
    inside = [part.ravel() for part in np.split(pairs, mesh.offsets[1:-1])]
    return _closed_up(mesh, points, inside, (half_edges, arriving))


def expanded(mesh: Mesh) -> Mesh:
    """Faces drawn apart, a quad for each edge and a face for each vertex before."""
    topology = mesh.topology
    half_edges, following = np.arange(len(mesh.corners)), topology.next_corners
    centers = face_centroids(mesh)[topology.corner_faces]
    shrunk = centers + (mesh.vertices[mesh.corners] - centers) / COARSER["3.4.6.4"]
    inside = np.split(half_edges, mesh.offsets[1:-1])
    first, second = topology.edge_corners, topology.twins[topology.edge_corners]
    quads = np.stack([following[second], second, following[first], first], axis=1)
    rim = np.flatnonzero(topology.twins < 0)
    ends = len(half_edges) + mesh.corners[np.stack([rim, following[rim]], axis=1)]
    strips = np.concatenate([ends, following[rim][:, None], rim[:, None]], axis=1)
    faces: list[IntArray] = [*inside, *quads, *strips]
    return _closed_up(mesh, shrunk, faces, (half_edges, None))


def _closed_up(
    mesh: Mesh,
    points: FloatArray,
    faces: list[IntArray],
    ends: tuple[IntArray, IntArray | None],
) -> Mesh:
    """A pattern of given points and faces, with a face for each vertex of the mesh before.

    The ends are the points on each half-edge near its tail and near its head; without the
    latter, faces of the boundary have no point on the edge that arrives there. Faces may hold
    vertices of the mesh, numbered after the points.
    """
    leaving, arriving = ends
    shift = len(points)
    fans = vertex_fans(mesh.topology, mesh.corners, np.unique(mesh.corners))
    before = previous_corners(mesh.topology)
    rings: list[IntArray] = []
    for i, vertex in enumerate(fans.vertices.tolist()):
        around = fans.corners[fans.offsets[i] : fans.offsets[i + 1]]
        ring = leaving[around].tolist()
        if not fans.is_closed[i]:
            last = [] if arriving is None else [int(arriving[before[around[-1]]])]
            ring = [shift + vertex, *ring, *last]
        if len(ring) > 2:
            rings.append(np.array(ring))
    faces = [*faces, *rings]
    used, corners = np.unique(np.concatenate(faces), return_inverse=True)
    places = np.concatenate([points, mesh.vertices])[used]
    sizes = np.array([len(face) for face in faces])
    return Mesh(places, np.split(corners.ravel(), np.cumsum(sizes)[:-1]))


def _feet(points: FloatArray, ground: Mesh) -> FloatArray:
    """Nearest points of triangles."""
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    origin = ground.vertices.mean(axis=0)
    nearest: Any = point_mesh_squared_distance
    _, _, feet = nearest(
        points - origin, ground.vertices - origin, ground.corners.reshape(-1, 3)
    )
    return origin + np.asarray(feet, np.float64)
