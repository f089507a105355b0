"""Edge flips that make the faces of a dual sphere mesh convex.

With spheres of offset λ that touch a surface, the face of a vertex is convex if and only if
the edges around it are Delaunay in the metric ``I / λ - II``: then, and only then, every edge
of the dual mesh runs in the right direction. That direction is what decides here; it needs
neither curvatures nor a mean of metrics.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..meshes.mesh import Mesh, face_centroids
from ..tolerances import DUAL_EDGE
from .vertex_rule import triangle_points

MAX_SWEEPS = 60
UPRIGHT_TILT = 0.5
"""Cosine of the largest angle (60 degrees) of a new triangle with the normals around it."""


@dataclass(frozen=True)
class Flips:
    """A triangulation with flipped edges.

    Attributes
    ----------
    mesh : Mesh
        The vertices of before, with new triangles.
    n_flips : int
        Edges flipped.
    sweeps : int
        Rounds of independent flips.
    """

    mesh: Mesh
    n_flips: int
    sweeps: int


def dual_edge_lengths(mesh: Mesh, rows: FloatArray) -> FloatArray:
    """Signed lengths of the edges of the dual mesh, relative to the edges that they cross.

    (E,) over the interior edges, from rows of `vertex_rows`: positive where the dual edge runs
    from the right to the left face, as it must on a convex face; negative where it runs
    backwards and faces cross.
    """
    points = face_centroids(mesh) + triangle_points(mesh, rows)[0]
    return _signed_lengths(mesh, rows, points)


def _signed_lengths(mesh: Mesh, rows: FloatArray, points: FloatArray) -> FloatArray:
    left, right = mesh.topology.edge_faces.T
    tails, heads = mesh.topology.edge_vertices.T
    return _across(mesh.vertices, rows, tails, heads, points[left] - points[right])


def _across(
    vertices: FloatArray, rows: FloatArray, tails: IntArray, heads: IntArray, run: FloatArray
) -> FloatArray:
    sides = vertices[heads] - vertices[tails]
    upright = unit(rows[tails, 1:4] + rows[heads, 1:4])
    return dot(run, np.cross(upright, sides)) / dot(sides, sides)


def flip_to_convex(mesh: Mesh, rows: FloatArray, max_sweeps: int = MAX_SWEEPS) -> Flips:
    """Flip edges until no edge of the dual mesh runs backwards, or no flip helps.

    The rows are those of `vertex_rows`. Edges stay where the flipped one would fold a triangle,
    exist twice, or run backwards even farther, or after `max_sweeps` rounds.

    Notes
    -----
    In a round every triangle takes part in one flip at most: that of the worst of its edges.
    """
    faces = mesh.corners.reshape(-1, 3).copy()
    points = face_centroids(mesh) + triangle_points(mesh, rows)[0]
    n_flips = 0
    for sweep in range(max_sweeps):
        lengths = _signed_lengths(mesh, rows, points)
        edges = _independent(mesh, lengths, np.flatnonzero(lengths < -DUAL_EDGE))
        edges, quads = _sound_flips(mesh, rows, lengths, edges)
        if len(edges) == 0:
            return Flips(mesh, n_flips, sweep)
        left, right = mesh.topology.edge_faces[edges].T
        faces[left], faces[right] = quads[:, [0, 1, 3]], quads[:, [1, 2, 3]]
        mesh = Mesh(mesh.vertices, faces)
        changed = np.concatenate([left, right])
        origins = mesh.vertices[faces[changed]].mean(axis=1)
        points[changed] = origins + triangle_points(mesh, rows, changed)[0]
        n_flips += len(edges)
    return Flips(mesh, n_flips, max_sweeps)


def _independent(mesh: Mesh, lengths: FloatArray, edges: IntArray) -> IntArray:
    """Of some edges those that are the worst of both their triangles."""
    ranked = edges[np.argsort(lengths[edges], kind="stable")]
    best = np.full(mesh.n_faces, len(lengths))
    rank = np.arange(len(ranked))
    left, right = mesh.topology.edge_faces[ranked].T
    np.minimum.at(best, left, rank)
    np.minimum.at(best, right, rank)
    return ranked[(best[left] == rank) & (best[right] == rank)]


def _sound_flips(
    mesh: Mesh, rows: FloatArray, lengths: FloatArray, edges: IntArray
) -> tuple[IntArray, IntArray]:
    """Edges whose flip is sound, and the quadrilaterals (a, d, b, c) around them."""
    topology = mesh.topology
    first = topology.edge_corners[edges]
    second = topology.twins[first]
    following = topology.next_corners
    c = mesh.corners[following[following[first]]]
    d = mesh.corners[following[following[second]]]
    a, b = topology.edge_vertices[edges].T
    quads = np.stack([a, d, b, c], 1)
    sound = _is_new_edge(mesh, c, d) & _stays_unfolded(mesh.vertices, rows, quads)
    edges, quads = edges[sound], quads[sound]
    if len(edges) == 0:
        return edges, quads
    pair = Mesh(mesh.vertices[quads].reshape(-1, 3), _split(len(quads)))
    local = rows[quads].reshape(-1, 5)
    points = face_centroids(pair) + triangle_points(pair, local)[0]
    run = points[0::2] - points[1::2]
    after = _across(mesh.vertices, rows, quads[:, 1], quads[:, 3], run)
    better = after > lengths[edges]
    return edges[better], quads[better]


def _split(count: int) -> IntArray:
    """Triangles (a, d, c) and (d, b, c) of separate quadrilaterals."""
    corners = np.array([[0, 1, 3], [1, 2, 3]])
    return (4 * np.arange(count)[:, None, None] + corners).reshape(-1, 3)


def _is_new_edge(mesh: Mesh, c: IntArray, d: IntArray) -> BoolArray:
    """Whether edges are not in the mesh, and asked for once."""
    heads = mesh.corners[mesh.topology.next_corners]
    low, high = np.minimum(mesh.corners, heads), np.maximum(mesh.corners, heads)
    asked = np.minimum(c, d) * mesh.n_vertices + np.maximum(c, d)
    _, place, counts = np.unique(asked, return_inverse=True, return_counts=True)
    return ~np.isin(asked, low * mesh.n_vertices + high) & (counts[place] == 1)


def _stays_unfolded(vertices: FloatArray, rows: FloatArray, quads: IntArray) -> BoolArray:
    a, d, b, c = vertices[quads].transpose(1, 0, 2)
    upright = unit(rows[quads, 1:4].sum(axis=1))
    diagonal = dot(c - d, c - d)
    areas = np.stack([np.cross(d - a, c - a), np.cross(b - d, c - d)])
    heights = dot(areas, upright) / np.where(diagonal > 0, diagonal, 1.0)
    tilts = dot(areas, upright) / np.where(norm(areas) > 0, norm(areas), 1.0)
    is_sound = (heights > DUAL_EDGE) & (tilts > UPRIGHT_TILT)
    return is_sound[0] & is_sound[1]
