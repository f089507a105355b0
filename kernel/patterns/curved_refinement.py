"""Coarse meshes as the smooth surfaces that they stand for.

Facets larger than the triangles under a pattern would show through: all of the turn would sit
at their edges. They are split into four until they are small enough; the middle of an edge
bulges as the arc does that meets the normals at its ends.
"""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, unit
from ..meshes.creases import edge_turns
from ..meshes.curvature import vertex_normals
from ..meshes.mesh import Mesh, mean_edge_length
from ..meshes.triangulation import triangulate
from ..tolerances import CREASE

MOST_SPLITS = 5
"""Splits at most: edges become 32 times shorter."""


def refined(mesh: Mesh, edge: float) -> Mesh:
    """A mesh whose mean edge is no longer than asked for, curved as its normals tell.

    Meshes that are fine enough stay as they are. Vertices keep their places; edges on creases
    stay straight, and the normals beside a crease tell nothing.
    """
    if mean_edge_length(mesh) <= edge:
        return mesh
    fine = triangulate(mesh)
    for _ in range(MOST_SPLITS):
        if mean_edge_length(fine) <= edge:
            break
        fine = _split(fine)
    return fine


def _split(mesh: Mesh) -> Mesh:
    """Triangles, each split into four at the bulging middles of its edges."""
    topology, corners = mesh.topology, mesh.corners
    twins = topology.twins
    halves: IntArray = np.arange(len(corners))
    first = np.where((twins < 0) | (twins > halves), halves, twins)
    own = np.flatnonzero(first == halves)
    ids = np.zeros(len(corners), np.int64)
    ids[own] = mesh.n_vertices + np.arange(len(own))
    ids = ids[first]
    ends = np.stack([corners[own], corners[topology.next_corners[own]]], 1)
    on_crease = np.zeros(mesh.n_vertices, bool)
    on_crease[topology.edge_vertices[edge_turns(mesh) > CREASE]] = True
    near = np.zeros(mesh.n_vertices, bool)
    near[corners.reshape(-1, 3)[on_crease[corners.reshape(-1, 3)].any(axis=1)]] = True
    middles = _middles(mesh.vertices, vertex_normals(mesh), ends, ~near)
    a, b, c = corners.reshape(-1, 3).T
    m, n, p = ids.reshape(-1, 3).T
    faces = np.concatenate(
        [np.stack(each, 1) for each in ((a, m, p), (m, b, n), (p, n, c), (m, n, p))]
    )
    return Mesh(np.concatenate([mesh.vertices, middles]), faces)


def _middles(
    vertices: FloatArray, normals: FloatArray, ends: IntArray, is_known: BoolArray
) -> FloatArray:
    """Middles (n, 3) of arcs over edges, by the normals that are known at their ends.

    Notes
    -----
    The normal at an end of a chord c of a circle has the part ``k |c|² / 2`` along it, and the
    arc stands ``k |c|² / 8`` above the middle.
    """
    chords = vertices[ends[:, 1]] - vertices[ends[:, 0]]
    known = is_known[ends]
    along = np.stack([-dot(normals[ends[:, 0]], chords), dot(normals[ends[:, 1]], chords)], 1)
    count = np.maximum(known.sum(axis=1), 1)
    rise = (along * known).sum(axis=1) / count / 4
    up = unit((normals[ends] * known[..., None]).sum(axis=1))
    return vertices[ends].mean(axis=1) + rise[:, None] * up
