"""
Isotropic remeshing of triangle meshes.

Long edges are split, short ones merged, edges flipped towards six neighbours per vertex, and
vertices moved along the surface to the middle of their neighbours, again and again.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..errors import InputError
from ..tolerances import CREASE, LINE_CORNER
from .mesh import Mesh, face_normals, face_vector_areas
from .triangle_edges import SLIVER, Triangles, find_edges, thickness, triangle_normals
from .triangle_edits import collapse_short_edges, flip_edges, split_long_edges
from .triangulation import triangulate

MAX_TRIANGLES = 2_000_000
EVEN_RANGE = (0.5, 1.6)


def remesh_triangles(
    mesh: Mesh, edge_length: float, iterations: int = 10, crease_angle: float = CREASE
) -> Mesh:
    """
    Triangles with edges of nearly one length, on the surface of a mesh.

    Parameters
    ----------
    mesh : Mesh
        The surface; polygons count as the triangles of `triangulate`.
    edge_length : float
        Length that edges shall have, in model units.
    iterations : int
        How often all edges are gone over.
    crease_angle : float
        Edges whose triangles meet at a larger angle, in radians, are creases; but not those of
        slivers, whose normals say nothing.

    Returns
    -------
    Mesh
        Triangles with vertices on the surface, and the same topology. Boundary and creases
        stay; vertices at which they turn sharply (`LINE_CORNER`), end or meet keep their place.

    Raises
    ------
    InputError
        If the edge length is not positive, or so short that more than `MAX_TRIANGLES` would be
        made.

    References
    ----------
    Botsch and Kobbelt, A remeshing approach to multiresolution modeling, 2004.
    """
    surface = triangulate(mesh)
    _check_length(surface, edge_length)
    origin = surface.vertices[surface.corners[0]]
    start = Triangles(
        (surface.vertices - origin) / edge_length,
        surface.corners.reshape(-1, 3),
        np.zeros(surface.n_vertices, bool),
        _creases(surface, crease_angle),
    )
    edges = find_edges(start)
    lines = edges.ends[edges.is_line]
    start = replace(start, is_fixed=_line_corners(start.vertices, lines))
    triangles = start
    for _ in range(iterations):
        triangles = split_long_edges(triangles)
        triangles = collapse_short_edges(triangles)
        triangles = flip_edges(triangles)
        triangles = _smooth(triangles, start.vertices, start.faces, lines)
    used, corners = np.unique(triangles.faces, return_inverse=True)
    points = origin + edge_length * triangles.vertices[used]
    return Mesh(points, corners.reshape(-1, 3).astype(np.int64))


def even_share(mesh: Mesh, edge_length: float) -> float:
    """
    Share of the edges that have nearly a given length.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    edge_length : float
        The length, in model units.

    Returns
    -------
    float
        Share of the half-edges between 0.5 and 1.6 (`EVEN_RANGE`) times as long.
    """
    ends = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    ratios = norm(ends - mesh.vertices[mesh.corners]) / edge_length
    return float(((ratios >= EVEN_RANGE[0]) & (ratios <= EVEN_RANGE[1])).mean())


def _check_length(mesh: Mesh, edge_length: float) -> None:
    if not (np.isfinite(edge_length) and edge_length > 0):
        raise InputError(f"the edge length must be positive and finite, not {edge_length}")
    area = float(norm(face_vector_areas(mesh)).sum())
    count = 4 * area / (np.sqrt(3) * edge_length**2)
    if count > MAX_TRIANGLES:
        raise InputError(
            f"edges of {edge_length:g} would make about {count:.2g} triangles, more than "
            f"{MAX_TRIANGLES}: choose longer ones"
        )


def _creases(surface: Mesh, crease_angle: float) -> IntArray:
    """Ends (n, 2) of the edges at which triangles, but no slivers, meet sharply."""
    sides = face_normals(surface)[surface.topology.edge_faces]
    left, right = sides[:, 0], sides[:, 1]
    turns = np.arctan2(norm(np.cross(left, right)), dot(left, right))
    is_thin = thickness(surface.vertices[surface.corners].reshape(-1, 3, 3)) < SLIVER
    has_sliver = is_thin[surface.topology.edge_faces].any(axis=1)
    return surface.topology.edge_vertices[(turns > crease_angle) & ~has_sliver]


def _line_corners(vertices: FloatArray, lines: IntArray) -> BoolArray:
    """Vertices at which lines turn sharply, end or meet."""
    pairs = np.concatenate([lines, lines[:, ::-1]])
    arms = unit(vertices[pairs[:, 1]] - vertices[pairs[:, 0]])
    # The sum of two unit vectors is twice the sine of half the turn.
    away = norm(sum_by(pairs[:, 0], arms, len(vertices)))
    count = np.bincount(pairs[:, 0], minlength=len(vertices))
    is_straight = (count == 2) & (away <= 2 * np.sin(LINE_CORNER / 2))
    return (count > 0) & ~is_straight


def _smooth(
    triangles: Triangles, surface: FloatArray, faces: IntArray, lines: IntArray
) -> Triangles:
    """Move vertices to the middle of their neighbours, then onto the surface or its lines."""
    edges = find_edges(triangles)
    vertices, count = triangles.vertices, len(triangles.vertices)
    on_line = edges.is_line_vertex
    # A vertex on a line has its neighbours on the line only.
    pairs = np.concatenate([edges.ends, edges.ends[:, ::-1]])
    is_line = np.concatenate([edges.is_line, edges.is_line])
    tails, heads = pairs[is_line | ~on_line[pairs[:, 0]]].T
    valence = np.bincount(tails, minlength=count)
    shift = sum_by(tails, vertices[heads] - vertices[tails], count)
    shift /= np.maximum(valence, 1)[:, None]
    normals = triangle_normals(vertices[triangles.faces])
    vertex_normals = sum_by(triangles.faces.ravel(), np.repeat(normals, 3, axis=0), count)
    vertex_normals = unit(vertex_normals)
    inner = (valence > 0) & ~on_line
    shift -= np.where(inner, dot(shift, vertex_normals), 0.0)[:, None] * vertex_normals
    moved = vertices + shift
    moved[inner] = _nearest(moved[inner], surface, faces)
    movable = on_line & ~triangles.is_fixed
    moved[movable] = _nearest(moved[movable], surface, lines)
    moved[triangles.is_fixed] = vertices[triangles.is_fixed]
    # What would fold stays.
    for _ in range(4):
        folds = dot(triangle_normals(moved[triangles.faces]), normals) <= 0
        if not folds.any():
            break
        stays = triangles.faces[folds]
        moved[stays] = vertices[stays]
    return replace(triangles, vertices=moved)


def _nearest(points: FloatArray, vertices: FloatArray, elements: IntArray) -> FloatArray:
    """Nearest points of triangles (n, 3) or segments (n, 2)."""
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    if not len(points):
        return points
    nearest: Any = point_mesh_squared_distance
    return np.asarray(nearest(points, vertices, elements)[2], np.float64)
