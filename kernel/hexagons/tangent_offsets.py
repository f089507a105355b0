"""Offsets of tangent spheres: on which side, how large they may be, how fast they may vary.

The spheres touch a triangulation at its vertices v, their centres ``v + λ n`` lie all on one
side. The offset λ must not pass the smallest curvature radius on that side, nor vary so fast
from vertex to vertex that the node axes tilt.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..errors import InputError
from ..meshes.curvature import principal_curvatures, vertex_normals
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..tolerances import OFFSET_STEP

CenterSide: TypeAlias = Literal["auto", "plus", "minus"]

CLOSEST = 0.95
"""Offsets aim at this share of the radius: at 1 neighbouring spheres would be the same."""
LEANING = 0.05
"""Mean curvature, relative to the curvatures, from which centres go to the minus side."""
STEEPEST = 0.85
"""Share of the slope allowed that first offsets use: triangles tilt more than their sides."""
SMALLEST = 0.6
"""Least aim after a retreat, relative to the longest edge: smaller spheres would not meet."""


@dataclass(frozen=True)
class TangentSurface:
    """A triangulation whose vertices carry tangent spheres, in units of its mean edge.

    Attributes
    ----------
    mesh : Mesh
        The triangulation, its centre at the origin.
    normals : (V, 3) float array
        Unit normals to the side of the centres.
    radii : (V,) float array
        Smallest curvature radii on this side, no larger than the mesh.
    side : int
        1 if the centres lie to the side of the face normals, -1 if beyond.
    """

    mesh: Mesh
    normals: FloatArray
    radii: FloatArray
    side: int


def tangent_surface(mesh: Mesh, side: CenterSide = "auto") -> tuple[TangentSurface, BoolArray]:
    """Normals and curvature radii of a triangulation on the side of the centres.

    In units of the mean edge. Also the vertices (V,) where the surface bends away from the
    centres in all directions.

    Raises
    ------
    InputError
        If the side is unknown or a vertex has no normal.
    """
    if side not in ("auto", "plus", "minus"):
        raise InputError(f"side must be 'auto', 'plus' or 'minus', not {side!r}")
    size = mean_edge_length(mesh)
    centered = (mesh.vertices - face_centroids(mesh).mean(axis=0)) / size
    near = Mesh(centered, mesh.corners.reshape(-1, 3))
    first, second, _ = principal_curvatures(near)
    largest = np.maximum(np.abs(first), np.abs(second))
    bends_away = float((first + second).mean()) < -LEANING * float(largest.mean())
    sign = -1 if side == "minus" or (side == "auto" and bends_away) else 1
    curvatures = first if sign == 1 else -second
    flattest = 1 / float(norm(np.ptp(centered, axis=0)))
    radii = 1 / np.maximum(curvatures, flattest)
    return TangentSurface(
        near, sign * vertex_normals(near), radii, sign
    ), curvatures < -flattest


def grow_offsets(surface: TangentSurface, aims: FloatArray, bound: float) -> FloatArray:
    """Largest offsets (V,) below an aim whose slopes between neighbours are bounded.

    The bound is the angle allowed between axis and normal, in radians. Offsets grow from the
    least aim until each reaches its own or is held by a neighbour.

    Notes
    -----
    The centres of neighbours may differ in height by a share of the tangent of the bound times
    their distance along the surface: a discrete eikonal equation, solved from below. Opposite
    corners of adjacent triangles count as neighbours, so that directions are dense enough.
    """
    starts, ends = _neighbor_pairs(surface.mesh)
    points, normals = surface.mesh.vertices, surface.normals
    upright = normals[starts] + normals[ends]
    upright = upright / norm(upright)[:, None]
    run, turn = points[ends] - points[starts], normals[ends] - normals[starts]
    run = run - dot(run, upright)[:, None] * upright
    turn = turn - dot(turn, upright)[:, None] * upright
    aims = np.minimum(aims, _focal_offsets(ends, run, turn, len(aims)))
    slope = STEEPEST * np.tan(bound)
    offsets = np.full(len(aims), float(aims.min()))
    for _ in range(len(aims)):
        reach = offsets[starts] + slope * norm(run + offsets[starts][:, None] * turn)
        grown = aims.copy()
        np.minimum.at(grown, ends, reach)
        if float(np.abs(grown - offsets).max()) <= OFFSET_STEP * float(offsets.min()):
            return grown
        offsets = grown
    return offsets


def _focal_offsets(ends: IntArray, run: FloatArray, turn: FloatArray, size: int) -> FloatArray:
    """Offsets short of the first one where centres of neighbours fall together."""
    curvature = -dot(run, turn) / dot(run, run)
    largest = np.zeros(size)
    np.maximum.at(largest, ends, curvature)
    unbounded = np.full(size, np.inf)
    return np.divide(CLOSEST, largest, out=unbounded, where=largest > 0)


def _neighbor_pairs(mesh: Mesh) -> tuple[IntArray, IntArray]:
    topology = mesh.topology
    following = topology.next_corners
    first, second = topology.edge_corners, topology.twins[topology.edge_corners]
    left, right = (mesh.corners[following[following[h]]] for h in (first, second))
    tails, heads = mesh_edges(mesh)
    return (
        np.concatenate([tails, heads, left, right]),
        np.concatenate([heads, tails, right, left]),
    )


def least_offsets(mesh: Mesh) -> FloatArray:
    """Offsets (V,) below which the spheres of a triangle may have no point in common.

    A share of the longest edge at each vertex.
    """
    starts, ends = mesh_edges(mesh)
    lengths = norm(mesh.vertices[ends] - mesh.vertices[starts])
    result = np.zeros(mesh.n_vertices)
    np.maximum.at(result, starts, lengths)
    np.maximum.at(result, ends, lengths)
    return SMALLEST * result


def mesh_edges(mesh: Mesh) -> tuple[IntArray, IntArray]:
    """Starts and ends of every edge, those on the boundary included, each edge once."""
    topology = mesh.topology
    once = np.flatnonzero(topology.twins < np.arange(len(topology.twins)))
    return mesh.corners[once], mesh.corners[topology.next_corners[once]]
