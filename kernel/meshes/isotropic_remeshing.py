"""Isotropic remeshing of triangle meshes.

Long edges are split, short ones merged, edges flipped towards six neighbours per vertex, and
vertices moved along the surface to the middle of their neighbours, again and again.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..errors import InputError
from ..tolerances import CREASE, LINE_CORNER
from .creases import edge_turns
from .mesh import Mesh, face_vector_areas
from .triangle_edges import (
    SLIVER,
    Triangles,
    exceeds,
    find_edges,
    thickness,
    to_be_edited,
    triangle_normals,
)
from .triangle_edits import collapse_short_edges, flip_edges, split_long_edges, strays
from .triangulation import triangulate

MAX_TRIANGLES = 2_000_000
EVEN_RANGE = (0.5, 1.6)


def remesh_triangles(
    mesh: Mesh, edge_length: float, iterations: int = 10, crease_angle: float = CREASE
) -> Mesh:
    """Triangles with edges of nearly one length, on the surface of a mesh.

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
        stay, no farther than a tenth of `edge_length` (`STRAY`) from their edges, which are
        shorter for it where lines bend; vertices at which lines turn sharply (`LINE_CORNER`),
        end or meet keep their place.

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
    vertices = (surface.vertices - origin) / edge_length
    lines = np.concatenate([_rim(surface), _creases(surface, crease_angle)])
    start = to_be_edited(
        vertices, surface.corners.reshape(-1, 3), _line_corners(vertices, lines), lines
    )
    triangles = start
    for _ in range(iterations):
        triangles = split_long_edges(triangles)
        triangles = collapse_short_edges(triangles)
        triangles = flip_edges(triangles)
        triangles = _smooth(triangles, start.vertices, start.faces)
    used, corners = np.unique(triangles.faces, return_inverse=True)
    points = origin + edge_length * triangles.vertices[used]
    return Mesh(points, corners.reshape(-1, 3).astype(np.int64))


def even_share(mesh: Mesh, edge_length: float) -> float:
    """Share of the edges that have nearly a given length.

    Parameters
    ----------
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


def _rim(surface: Mesh) -> IntArray:
    """Ends (n, 2) of the edges on the boundary."""
    halves = np.flatnonzero(surface.topology.twins < 0)
    return surface.corners[np.stack([halves, surface.topology.next_corners[halves]], 1)]


def _creases(surface: Mesh, crease_angle: float) -> IntArray:
    """Ends (n, 2) of the edges at which triangles, but no slivers, meet sharply."""
    turns = edge_turns(surface)
    is_thin = thickness(surface.vertices[surface.corners].reshape(-1, 3, 3)) < SLIVER
    has_sliver = is_thin[surface.topology.edge_faces].any(axis=1)
    return surface.topology.edge_vertices[exceeds(turns, crease_angle) & ~has_sliver]


def _line_corners(vertices: FloatArray, lines: IntArray) -> BoolArray:
    """Vertices at which lines turn sharply, end or meet."""
    pairs = np.concatenate([lines, lines[:, ::-1]])
    arms = unit(vertices[pairs[:, 1]] - vertices[pairs[:, 0]])
    # The sum of two unit vectors is twice the sine of half the turn.
    away = norm(sum_by(pairs[:, 0], arms, len(vertices)))
    count = np.bincount(pairs[:, 0], minlength=len(vertices))
    is_straight = (count == 2) & ~exceeds(away, 2 * np.sin(LINE_CORNER / 2))
    return (count > 0) & ~is_straight


def _smooth(triangles: Triangles, surface: FloatArray, faces: IntArray) -> Triangles:
    """Move vertices to the middle of their neighbours, on the surface or along its lines."""
    edges = find_edges(triangles)
    vertices, count = triangles.vertices, len(triangles.vertices)
    tails, heads = np.concatenate([edges.ends, edges.ends[:, ::-1]]).T
    valence = np.bincount(tails, minlength=count)
    shift = sum_by(tails, vertices[heads] - vertices[tails], count)
    shift /= np.maximum(valence, 1)[:, None]
    normals = triangle_normals(vertices[triangles.faces])
    vertex_normals = sum_by(triangles.faces.ravel(), np.repeat(normals, 3, axis=0), count)
    vertex_normals = unit(vertex_normals)
    shift -= dot(shift, vertex_normals)[:, None] * vertex_normals
    moves = (valence > 0) & ~edges.is_line_vertex
    slides = edges.is_line_vertex & ~triangles.is_fixed
    # Between fixed vertices, a vertex of a line has two neighbours on it.
    arcs = sum_by(triangles.lines.ravel(), triangles.arcs[:, ::-1].ravel(), count) / 2
    aims = vertices.copy()
    aims[moves] = _nearest((vertices + shift)[moves], surface, faces)
    aims[slides] = triangles.curves.at(arcs[slides])
    # What would fold or leave its line stays.
    while True:
        moved = replace(
            triangles,
            vertices=np.where((moves | slides)[:, None], aims, vertices),
            arcs=np.where(slides[triangles.lines], arcs[triangles.lines], triangles.arcs),
        )
        folds = dot(triangle_normals(moved.vertices[triangles.faces]), normals) <= 0
        stays = [triangles.faces[folds].ravel(), triangles.lines[strays(moved)].ravel()]
        stays = np.concatenate(stays)
        if not (moves | slides)[stays].any():
            return moved
        moves[stays] = slides[stays] = False


def _nearest(points: FloatArray, vertices: FloatArray, elements: IntArray) -> FloatArray:
    """Nearest points of triangles (n, 3)."""
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    if not len(points):
        return points
    nearest: Any = point_mesh_squared_distance
    return np.asarray(nearest(points, vertices, elements)[2], np.float64)
