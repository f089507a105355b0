"""A pattern with four times the faces, or a quarter: finer and coarser nets of one surface.

Finer nets split edges in the middle; new vertices lie on the spheres of the faces that they
split. Coarser ones merge the faces around every second vertex of every second line: lines that
are left stay where they are. Around singular points lines do not alternate, and some faces stay
as they are.
"""

from collections import deque
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, unit
from ..errors import InputError
from ..meshes.mesh import Mesh, corner_edges, face_centroids, mean_edge_length
from ..meshes.subdivision import subdivide_midpoint
from ..meshes.vertex_fans import VertexFans, vertex_fans
from ..optimization.angle_minimization import minimize_angles
from ..sphere_meshes.fit import fit_spheres
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import project
from ..tolerances import CREASE, OPENING
from .panel_scale import even_triangles

LANDINGS = 4
"""Rounds that bring the middle of an edge onto the spheres of both its faces."""

STRAIGHT = np.cos(np.radians(20))
"""Vertices of the boundary that only one coarse face has are left out where it turns less."""


class Coarsening(NamedTuple):
    """A coarser pattern.

    Attributes
    ----------
    net : SphereMesh
    n_single : int
        Faces that could not be merged with others.
    """

    net: SphereMesh
    n_single: int


def refine_pattern(net: SphereMesh) -> SphereMesh:
    """Split faces: triangles into four, others into a quadrilateral at each corner.

    Vertices stay, new ones lie on the spheres of their faces; spheres of smallest angles.
    """
    mesh = net.mesh
    fine = subdivide_midpoint(mesh)
    edges = corner_edges(mesh)
    points = fine.vertices.copy()
    first, last = mesh.n_vertices, mesh.n_vertices + int(edges.max()) + 1
    middles = points[first:last]
    faces = mesh.topology.corner_faces
    count = np.bincount(edges, minlength=len(middles))[:, None]
    for _ in range(LANDINGS):
        landed = _landed(net, middles[edges], faces)
        sums = np.stack(
            [np.bincount(edges, landed[:, axis], len(middles)) for axis in range(3)], axis=1
        )
        middles = sums / count
    points[first:last] = middles
    split = np.flatnonzero(mesh.degrees > 3)
    points[last:] = _landed(net, points[last:], split)
    return _smooth(Mesh(points, fine.faces))


def coarsen_pattern(net: SphereMesh) -> Coarsening:
    """Merge faces four by four; triangles become even ones of twice the edge.

    Raises
    ------
    InputError
        If the pattern is too small to become coarser.
    """
    mesh = net.mesh
    if (mesh.degrees == 3).all():
        return Coarsening(_smooth(even_triangles(mesh, 2 * mean_edge_length(mesh))), 0)
    owners = min((_owners(mesh, seed) for seed in _seeds(mesh)), key=_count)
    if _count(owners) == mesh.n_faces:
        raise InputError("the pattern is too small to become coarser: no faces can be merged")
    rings = _rings(mesh, owners)
    coarse = _without_middles(mesh, rings)
    sizes = np.bincount(owners)
    return Coarsening(_smooth(coarse), int((sizes == 1).sum()))


def _smooth(mesh: Mesh) -> SphereMesh:
    return minimize_angles(fit_spheres(mesh), crease=CREASE, max_opening=OPENING)[0]


def _landed(net: SphereMesh, points: FloatArray, faces: IntArray) -> FloatArray:
    """Nearest points on the spheres of faces, one face for each point."""
    centers = face_centroids(net.mesh)[faces]
    return centers + project(net.local_spheres[faces], points - centers)


def _count(owners: IntArray) -> int:
    return int(owners.max()) + 1


def _seeds(mesh: Mesh) -> list[int]:
    """A vertex in the middle, and those of the faces around it: one of each parity."""
    inner = np.flatnonzero(~mesh.topology.is_boundary_vertex)
    if len(inner) == 0:
        return [int(mesh.corners[0])]
    off = mesh.vertices[inner] - mesh.vertices.mean(axis=0)
    middle = int(inner[np.argmin(dot(off, off))])
    around = np.isin(
        mesh.topology.corner_faces, mesh.topology.corner_faces[mesh.corners == middle]
    )
    near = np.unique(mesh.corners[around])
    return [middle, *(int(each) for each in near if each != middle)]


def _owners(mesh: Mesh, seed: int) -> IntArray:
    """Number of the coarse face of each face, from every second vertex on every second line."""
    fans = vertex_fans(mesh.topology, mesh.corners, np.arange(mesh.n_vertices))
    faces = mesh.topology.corner_faces
    owners = np.full(mesh.n_faces, -1)
    number = 0
    waiting = deque([seed])
    valences = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    others = np.argsort(-valences, kind="stable")
    is_left = np.ones(mesh.n_vertices, bool)
    while True:
        while waiting:
            vertex = waiting.popleft()
            own = faces[fans.corners[fans.offsets[vertex] : fans.offsets[vertex + 1]]]
            if (owners[own] >= 0).any() or not _is_disk(mesh, own, fans.is_closed[vertex]):
                continue
            owners[own] = number
            number += 1
            waiting.extend(_two_steps(mesh, fans, vertex))
        n_free = np.bincount(mesh.corners, owners[faces] < 0, mesh.n_vertices)
        free = others[(n_free == valences)[others] & (n_free > 1)[others] & is_left[others]]
        if len(free) == 0:
            break
        waiting.append(int(free[0]))
        is_left[free[0]] = False
    left = np.flatnonzero(owners < 0)
    owners[left] = number + np.arange(len(left))
    return owners


def _is_disk(mesh: Mesh, faces: IntArray, is_closed: bool) -> bool:  # noqa: FBT001
    """Whether the faces around a vertex share no other one but those of their common edges."""
    corners = mesh.corners[np.isin(mesh.topology.corner_faces, faces)]
    ring = int((mesh.degrees[faces] - 2).sum())
    return len(np.unique(corners)) == ring + (1 if is_closed else 2)


def _two_steps(mesh: Mesh, fans: VertexFans, vertex: int) -> list[int]:
    """Vertices two edges away, straight on, from a vertex."""
    topology, found = mesh.topology, list[int]()
    for corner in fans.corners[fans.offsets[vertex] : fans.offsets[vertex + 1]].tolist():
        middle = int(mesh.corners[topology.next_corners[corner]])
        around = fans.corners[fans.offsets[middle] : fans.offsets[middle + 1]]
        back = int(topology.twins[corner])
        if back < 0 or len(around) != 4 or not fans.is_closed[middle]:
            continue
        ahead = int(around[(int(np.flatnonzero(around == back)[0]) + 2) % 4])
        found.append(int(mesh.corners[topology.next_corners[ahead]]))
    return found


def _rings(mesh: Mesh, owners: IntArray) -> list[list[int]]:
    """Boundary of each group of faces, as vertices."""
    topology = mesh.topology
    groups = owners[topology.corner_faces]
    beyond = np.where(topology.twins >= 0, groups[topology.twins], -1)
    rim = np.flatnonzero(groups != beyond)
    following: list[dict[int, int]] = [{} for _ in range(int(owners.max()) + 1)]
    heads = mesh.corners[topology.next_corners]
    for group, tail, head in zip(
        groups[rim].tolist(), mesh.corners[rim].tolist(), heads[rim].tolist(), strict=True
    ):
        following[group][tail] = head
    rings: list[list[int]] = []
    for steps in following:
        start = min(steps)
        ring, current = [start], steps[start]
        while current != start:
            ring.append(current)
            current = steps[current]
        rings.append(ring)
    return rings


def _without_middles(mesh: Mesh, rings: list[list[int]]) -> Mesh:
    """Faces without vertices at which only two of them meet, or one on a smooth boundary."""
    uses = np.bincount(
        np.concatenate([np.array(ring) for ring in rings]), minlength=mesh.n_vertices
    )
    is_rim = mesh.topology.is_boundary_vertex
    is_needed = np.where(is_rim, (uses > 1) | _is_bent(mesh), uses > 2)
    faces: list[list[int]] = []
    for ring in rings:
        kept = [vertex for vertex in ring if is_needed[vertex]]
        faces.append(kept if len(kept) > 2 else ring)
    # A face that keeps all of its vertices keeps them in its neighbours too.
    forced = np.zeros(mesh.n_vertices, bool)
    for face in faces:
        forced[face] = True
    faces = [[v for v in ring if is_needed[v] or forced[v]] for ring in rings]
    every = np.concatenate([np.array(face) for face in faces])
    used, corners = np.unique(every, return_inverse=True)
    sizes = np.array([len(face) for face in faces])
    return Mesh(mesh.vertices[used], np.split(corners, np.cumsum(sizes)[:-1]))


def _is_bent(mesh: Mesh) -> BoolArray:
    """Vertices (V,) at which the boundary turns."""
    rim = np.flatnonzero(mesh.topology.twins < 0)
    tails, heads = mesh.corners[rim], mesh.corners[mesh.topology.next_corners[rim]]
    runs = unit(mesh.vertices[heads] - mesh.vertices[tails])
    ahead = np.zeros((mesh.n_vertices, 3))
    ahead[tails] = runs
    result = np.zeros(mesh.n_vertices, bool)
    result[heads] = dot(runs, ahead[heads]) < STRAIGHT
    return result
