"""Subdivision: finer meshes, by midpoints or smooth in the limit.

All schemes keep the ids of the vertices; new vertices on edges follow, then those in faces.
The parts of a face follow each other, in the order of the faces.
Boundary vertices depend on the boundary alone, which tends to a cubic spline: meshes that
share a boundary keep sharing it.
"""

from typing import Any

import numpy as np

from ..arrays import BoolArray, IntArray, sum_by
from ..errors import InputError, name_ids
from .mesh import Mesh, corner_edges, edge_ends, face_centroids
from .topology import previous_corners


def subdivide_midpoint(mesh: Mesh) -> Mesh:
    """Split edges in the middle; the shape stays.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree.

    Returns
    -------
    Mesh
        Four triangles for each triangle, and for any other face a quadrilateral at each of its
        corners, about its centroid. Planar faces stay planar.
    """
    edges = corner_edges(mesh)
    ends = mesh.vertices[edge_ends(mesh, edges)]
    middles = ends[:, 0] + (ends[:, 1] - ends[:, 0]) / 2
    is_triangle = mesh.degrees == 3
    return Mesh(
        np.concatenate([mesh.vertices, middles, face_centroids(mesh)[~is_triangle]]),
        _split_faces(mesh, edges, is_triangle),
    )


def subdivide_catmull_clark(mesh: Mesh) -> Mesh:
    """One step towards the smooth surface of Catmull and Clark.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree.

    Returns
    -------
    Mesh
        A quadrilateral at each corner of each face.

    References
    ----------
    Catmull and Clark, Recursively generated B-spline surfaces on arbitrary topological meshes,
    1978; boundary as cubic B-spline curve.
    """
    topology, corners, count = mesh.topology, mesh.corners, mesh.n_vertices
    origin = mesh.vertices[corners[0]]
    vertices = mesh.vertices - origin
    centers = face_centroids(mesh) - origin
    edges = corner_edges(mesh)
    ends = edge_ends(mesh, edges)
    middles = vertices[ends].mean(axis=1)
    first, second = topology.edge_faces.T
    edge_points = middles.copy()
    inner = edges[topology.edge_corners]
    edge_points[inner] = (middles[inner] + (centers[first] + centers[second]) / 2) / 2

    is_used = np.zeros(count, bool)
    is_used[corners] = True
    valence = np.maximum(np.bincount(corners, minlength=count), 1)[:, None]
    face_mean = sum_by(corners, centers[topology.corner_faces], count) / valence
    # Every edge of an inner vertex leaves it once.
    edge_mean = sum_by(corners, middles[edges], count) / valence
    points = (face_mean + 2 * edge_mean + (valence - 3) * vertices) / valence
    rim = np.flatnonzero(topology.twins < 0)
    rim_middles = np.concatenate([middles[edges[rim]]] * 2)
    tails, heads = corners[rim], corners[topology.next_corners[rim]]
    rim_mean = sum_by(np.concatenate([tails, heads]), rim_middles, count) / 2
    on_rim = topology.is_boundary_vertex & is_used
    points[on_rim] = (vertices[on_rim] + rim_mean[on_rim]) / 2
    points[~is_used] = vertices[~is_used]
    return Mesh(
        np.concatenate([points, edge_points, centers]) + origin,
        _split_faces(mesh, edges, np.zeros(mesh.n_faces, bool)),
    )


def subdivide_loop(mesh: Mesh) -> Mesh:
    """One step towards the smooth surface of Loop.

    Returns
    -------
    Mesh
        Four triangles for each; vertices without a face are left out.

    Raises
    ------
    InputError
        If a face is no triangle; the message names it.

    References
    ----------
    Loop, Smooth subdivision surfaces based on triangles, 1987; by libigl.
    """
    import igl  # pyright: ignore[reportMissingTypeStubs]

    bad = np.flatnonzero(mesh.degrees != 3)
    if len(bad):
        raise InputError(
            f"faces {name_ids(bad.tolist())} are no triangles: triangulate the mesh first, or "
            "subdivide it by catmull-clark"
        )
    # libigl crashes on vertices without a face.
    used, corners = np.unique(mesh.corners, return_inverse=True)
    origin = mesh.vertices[mesh.corners[0]]
    step: Any = igl.loop  # pyright: ignore[reportUnknownMemberType]
    vertices, faces = step(mesh.vertices[used] - origin, corners.reshape(-1, 3), 1)
    return Mesh(np.asarray(vertices, np.float64) + origin, np.asarray(faces, np.int64))


def _split_faces(mesh: Mesh, edges: IntArray, is_triangle: BoolArray) -> list[IntArray]:
    """Quads at all corners of faces, but four triangles for those so marked; face by face."""
    topology = mesh.topology
    after = mesh.n_vertices + edges
    before = after[previous_corners(topology)]
    center_ids = mesh.n_vertices + int(edges.max()) + np.cumsum(~is_triangle)
    faces = topology.corner_faces
    in_triangle = is_triangle[faces]
    quads = np.stack([mesh.corners, after, center_ids[faces], before], 1)[~in_triangle]
    outer = np.stack([mesh.corners, after, before], 1)[in_triangle]
    inner = after[mesh.offsets[:-1][is_triangle][:, None] + np.arange(3)]
    parents = [faces[in_triangle], np.flatnonzero(is_triangle), faces[~in_triangle]]
    children = [*outer, *inner, *quads]
    return [children[i] for i in np.argsort(np.concatenate(parents), kind="stable")]
