"""Hexagons without slivers: vertices of the triangulation slide until no dual edge is short.

The spheres keep their offsets. A dual edge depends on the four vertices of two triangles; the
least tangential move that lengthens it is the gradient of its length, scaled. Moves of several
edges add up at a vertex, over the root of their number; between moves edges are flipped.
"""

from typing import Any, NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, unit
from ..congruences.curvature_spheres import touching_spheres
from ..hexagons.delaunay_flips import dual_edge_lengths, flip_to_convex
from ..hexagons.evolution import Evolution
from ..hexagons.ortho_energy import axis_deviations
from ..meshes.curvature import vertex_normals
from ..meshes.mesh import Mesh, mean_edge_length
from ..meshes.triangulation import triangulate

SHORT_DUAL, AIM = 0.1, 1.2
"""Dual edges below this share of the edge they cross are lengthened to so many times it."""

LONGEST_MOVE, MOVES = 0.04, 60
"""Farthest move of a vertex in a round, in mean edges, and most rounds."""

CALM = 25
"""Rounds after which moves are half as long: some edges that were flipped come to rest."""

DIFFERENCE = 1e-5
"""Step of the differences that gradients are made of, in mean edges."""

_TRIANGLES = np.array([[0, 1, 2], [1, 0, 3]])


class _Sites(NamedTuple):
    """Vertices with their normals to the centres and the offsets of these, and triangles."""

    points: FloatArray
    normals: FloatArray
    offsets: FloatArray
    triangles: IntArray


class _Ground(NamedTuple):
    """The surface that vertices slide on: fine triangles and normals at their corners."""

    vertices: FloatArray
    triangles: IntArray
    normals: FloatArray


class Polished(NamedTuple):
    """Triangles without short dual edges, and their spheres.

    Attributes
    ----------
    mesh : Mesh
        Triangles, some flipped.
    spheres : (V, 5) float array
        The spheres at their vertices.
    axis_angles : (n,) float array
        Angles of the node axes of faces with the surface normals, in radians.
    """

    mesh: Mesh
    spheres: FloatArray
    axis_angles: FloatArray


def polish(found: Evolution, surface: Mesh) -> Polished:
    """Slide the vertices of a triangulation with grown spheres until hexagons have no slivers.

    Parameters
    ----------
    found : Evolution
        Spheres at the vertices of triangles.
    surface : Mesh
        The surface, finer than the triangles.

    Returns
    -------
    Polished
        Triangles, spheres, and what the slides did to the node axes.
    """
    size, origin = mean_edge_length(found.mesh), found.mesh.vertices.mean(axis=0)
    fine = triangulate(surface)
    ground = _Ground(
        (fine.vertices - origin) / size,
        fine.corners.reshape(-1, 3),
        found.side * vertex_normals(fine),
    )
    corners = found.mesh.corners.reshape(-1, 3)[:, :: found.side]
    # Normals of the spheres, which are those of the coarse triangles before flips.
    upwards = unit(_upwards(found))
    sites = _Sites(
        (found.mesh.vertices - origin) / size, upwards, found.offsets / size, corners
    )
    is_inner = ~found.mesh.topology.is_boundary_vertex
    for i in range(MOVES):
        moves = _moves(sites, is_inner) * (0.5 if i >= CALM else 1.0)
        if not moves.any():
            break
        sites = _flipped(_slid(sites, moves, ground))
    mesh = Mesh(origin + size * sites.points, sites.triangles[:, :: found.side])
    curvatures = found.side / (size * sites.offsets)
    spheres = touching_spheres(mesh.vertices, found.side * sites.normals, curvatures)
    angles = axis_deviations(sites.points, sites.normals, sites.triangles, sites.offsets)
    # Triangles with all corners on the boundary are corners of no face.
    counts = is_inner[sites.triangles].any(axis=1)
    return Polished(mesh, spheres, angles[counts])


def _upwards(found: Evolution) -> FloatArray:
    """Vectors from the vertices to the centres of their spheres."""
    half = found.spheres[:, :1]
    return found.side * (found.spheres[:, 1:4] - 2 * half * found.mesh.vertices)


def _rows(normals: FloatArray, offsets: FloatArray) -> FloatArray:
    half = (1 / (2 * offsets))[:, None]
    return np.concatenate([half, normals, np.zeros_like(half)], axis=1)


def _flipped(sites: _Sites) -> _Sites:
    mesh = Mesh(sites.points, sites.triangles)
    result = flip_to_convex(mesh, _rows(sites.normals, sites.offsets)).mesh
    return sites._replace(triangles=result.corners.reshape(-1, 3))


def _moves(sites: _Sites, is_inner: np.ndarray) -> FloatArray:
    """Tangential moves (V, 3) that lengthen short dual edges; 0 where there are none."""
    mesh = Mesh(sites.points, sites.triangles)
    topology = mesh.topology
    lengths = dual_edge_lengths(mesh, _rows(sites.normals, sites.offsets))
    matters = is_inner[sites.triangles[topology.edge_faces]].any(axis=(1, 2))
    short = np.flatnonzero((lengths < SHORT_DUAL) & matters)
    result = np.zeros_like(sites.points)
    if len(short) == 0:
        return result
    first = topology.edge_corners[short]
    across = [
        mesh.corners[topology.next_corners[topology.next_corners[each]]]
        for each in (first, topology.twins[first])
    ]
    quads = np.concatenate([topology.edge_vertices[short], np.stack(across, 1)], axis=1)
    start, gradients = _gradients(sites, quads)
    gradients *= is_inner[quads][..., None]
    squares = (gradients**2).sum(axis=(1, 2))
    divisors = np.where(squares > 0, squares, 1.0)
    wanted = np.where(squares > 0, (AIM * SHORT_DUAL - start) / divisors, 0.0)
    count = np.bincount(quads.ravel(), minlength=len(result))
    np.add.at(result, quads, wanted[:, None, None] * gradients)
    result /= np.sqrt(np.maximum(count, 1))[:, None]
    reach = norm(result)
    return result * np.minimum(1, LONGEST_MOVE / np.maximum(reach, LONGEST_MOVE))[:, None]


def _gradients(sites: _Sites, quads: IntArray) -> tuple[FloatArray, FloatArray]:
    """Dual edges (k,) between the two triangles of quads, and how they grow (k, 4, 3)."""
    points, normals = sites.points[quads], sites.normals[quads]
    start = _runs(points, normals, sites.offsets[quads])
    result = np.zeros((len(quads), 4, 3))
    frames = np.linalg.svd(sites.normals[:, None, :])[2][:, 1:]
    for corner in range(4):
        for axis in range(2):
            along = frames[quads[:, corner], axis]
            moved = points.copy()
            moved[:, corner] += DIFFERENCE * along
            change = _runs(moved, normals, sites.offsets[quads]) - start
            result[:, corner] += (change / DIFFERENCE)[:, None] * along
    return start, result


def _runs(points: FloatArray, normals: FloatArray, offsets: FloatArray) -> FloatArray:
    """Signed dual edges (k,) of pairs of triangles, each pair a mesh of its own."""
    base = 4 * np.arange(len(points))[:, None, None]
    mesh = Mesh(points.reshape(-1, 3), (base + _TRIANGLES).reshape(-1, 3))
    lengths = dual_edge_lengths(mesh, _rows(normals.reshape(-1, 3), offsets.ravel()))
    return lengths[np.argsort(mesh.topology.edge_faces.min(axis=1), kind="stable")]


def _slid(sites: _Sites, moves: FloatArray, ground: _Ground) -> _Sites:
    """Sites moved and back on the surface; normals turn as those of the surface do."""
    ids = np.flatnonzero(norm(moves) > 0)
    _, before = _feet(sites.points[ids], ground)
    feet, after = _feet(sites.points[ids] + moves[ids], ground)
    points, normals = sites.points.copy(), sites.normals.copy()
    points[ids] = feet
    normals[ids] = unit(normals[ids] + after - before)
    return sites._replace(points=points, normals=normals)


def _feet(points: FloatArray, ground: _Ground) -> tuple[FloatArray, FloatArray]:
    """Nearest points on the surface, and its normals there."""
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    nearest: Any = point_mesh_squared_distance
    _, faces, found = nearest(points, ground.vertices, ground.triangles)
    feet: FloatArray = np.asarray(found, np.float64)
    hit: IntArray = np.asarray(faces, np.int64)
    corners = ground.triangles[hit]
    places: FloatArray = ground.vertices[corners]
    after = np.roll(places, -1, axis=1)
    normal: FloatArray = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    total = dot(normal, normal)
    # The share of a corner is that of the triangle of the foot and the opposite side.
    sides: FloatArray = np.cross(after - places, feet[:, None] - places)
    shares = [dot(sides[:, (i + 1) % 3], normal) / total for i in range(3)]
    mixed = sum(
        (share[:, None] * ground.normals[corners[:, i]] for i, share in enumerate(shares)),
        np.zeros_like(points),
    )
    return feet, unit(mixed)
