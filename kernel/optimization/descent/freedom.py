"""Which way the unknowns may move.

Vertices may be bound to a ball about their old place, to a plane or to a line; the radius of a
sphere may be given. Rows and dual normals are unit. Steps are taken in the directions that are
left, and moves end on what is kept exactly.
"""

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from ...arrays import BoolArray, FloatArray, dot, norm, sum_by, unit
from ...meshes.mesh import Mesh, face_normals
from ...spheres.minkowski import minkowski, minkowski_gradient
from ..energies.setting import Group, Unknowns

Boundary = Literal["free", "glide", "fixed"]
Interior = Literal["free", "glide"]


@dataclass(frozen=True)
class Freedom:
    """What the unknowns may do.

    Attributes
    ----------
    tolerance : float
        Largest displacement of a vertex, in mean edges.
    vertices : (V, 3, 3) float array
        Orthogonal projection onto the directions in which each vertex may move.
    has_fixed_radius : (F,) bool array
        Faces whose coefficient A stays.
    """

    tolerance: float
    vertices: FloatArray
    has_fixed_radius: BoolArray


def vertex_freedom(mesh: Mesh, interior: Interior, boundary: Boundary) -> FloatArray:
    """Directions in which vertices may move.

    Parameters
    ----------
    mesh : Mesh
        The mesh, before any vertex moves.
    interior : {"free", "glide"}
        ``glide``: in the tangent plane across the mean of the normals of the faces around.
    boundary : {"free", "glide", "fixed"}
        ``free``: as interior vertices; ``glide``: along the line between the two neighbours on
        the boundary.

    Returns
    -------
    (V, 3, 3) float array
        Orthogonal projections.
    """
    result = np.tile(np.eye(3), (mesh.n_vertices, 1, 1))
    topology = mesh.topology
    if interior == "glide":
        corner_normals = face_normals(mesh)[topology.corner_faces]
        normals = unit(sum_by(mesh.corners, corner_normals, mesh.n_vertices))
        result -= normals[:, :, None] * normals[:, None, :]
    outer = np.flatnonzero(topology.twins < 0)
    if boundary != "free":
        result[topology.is_boundary_vertex] = 0
    if boundary == "glide":
        tails, heads = mesh.corners[outer], mesh.corners[topology.next_corners[outer]]
        along = np.zeros((mesh.n_vertices, 3))
        along[tails] += mesh.vertices[heads]
        along[heads] -= mesh.vertices[tails]
        along = unit(along)
        result += along[:, :, None] * along[:, None, :]
    return result


class Tangents(NamedTuple):
    """Directions in which the unknowns may move, and how moves bend.

    Attributes
    ----------
    spheres : (F, 5, 4) float array
        Orthonormal directions of each row that keep it a unit row; a column of zeros where a
        fixed radius leaves three.
    vertices : (V or 0, 3, 3) float array
        Orthogonal projections onto the directions of each vertex.
    normals : (N or 0, 3, 2) float array
        Orthonormal directions across each dual normal.
    """

    spheres: FloatArray
    vertices: FloatArray
    normals: FloatArray


def tangents(freedom: Freedom, unknowns: Unknowns, counts: tuple[int, ...]) -> Tangents:
    """Directions of the unknowns of those groups that take part, by their counts."""
    rows = unknowns.spheres
    spheres = _across(minkowski_gradient(rows))
    fixed = freedom.has_fixed_radius
    if fixed.any():
        spheres[fixed] = _with_radius(rows[fixed])
    normals = unknowns.normals[: counts[Group.NORMAL]]
    return Tangents(spheres, freedom.vertices[: counts[Group.VERTEX]], _across(normals))


def _across(vectors: FloatArray) -> FloatArray:
    """Orthonormal bases (n, d, d - 1) of the directions across vectors (n, d), none of them 0.

    The columns but the first of the reflection that takes the vector to the first axis.
    """
    count, size = vectors.shape
    mirror = unit(vectors)
    mirror[:, 0] += np.where(mirror[:, 0] < 0, -1.0, 1.0)
    factor = 2 / np.maximum(dot(mirror, mirror), 1.0)
    result = np.tile(np.eye(size)[:, 1:], (count, 1, 1))
    result -= (factor[:, None] * mirror)[:, :, None] * mirror[:, None, 1:]
    return result


def _with_radius(rows: FloatArray) -> FloatArray:
    """Directions (n, 5, 4) of unit rows that keep A: two of B across itself, and C with |B|."""
    result = np.zeros((len(rows), 5, 4))
    result[:, 1:4, :2] = _across(rows[:, 1:4])
    result[:, 1:4, 2] = (2 * rows[:, 0] / norm(rows[:, 1:4]))[:, None] * unit(rows[:, 1:4])
    result[:, 4, 2] = 1
    result[:, :, 2] = unit(result[:, :, 2])
    return result


def row_multipliers(freedom: Freedom, unknowns: Unknowns, gradient: FloatArray) -> FloatArray:
    """Multipliers (F,) of the norms of the rows, from the gradient (F, 5) of an energy.

    A move along a direction ξ bends by ``-<<ξ, ξ>>`` times the row, or where A stays times the
    part ``B / |B|²`` of it; the energy changes by as much times its gradient.
    """
    rows = unknowns.spheres
    result = dot(gradient, rows)
    fixed = freedom.has_fixed_radius
    if fixed.any():
        b = rows[fixed, 1:4]
        result[fixed] = dot(gradient[fixed, 1:4], b) / dot(b, b)
    return result


def largest_part(
    freedom: Freedom, displacements: FloatArray, steps: FloatArray, margin: float
) -> float:
    """Largest part of steps (V or 0, 3), up to 1, that stays within the bound.

    Where the bound is in the way, a margin of the way to it is taken.
    """
    if not len(steps):
        return 1.0
    squares = np.maximum(dot(steps, steps), np.finfo(np.float64).tiny)
    along = dot(displacements, steps)
    room = np.maximum(freedom.tolerance**2 - dot(displacements, displacements), 0)
    ways = room / (along + np.sqrt(along**2 + squares * room))
    return float(min(1.0, margin * ways.min()))


def moved(
    freedom: Freedom, unknowns: Unknowns, steps: tuple[FloatArray, FloatArray, FloatArray]
) -> Unknowns:
    """Unknowns after a step: unit rows, unit dual normals.

    The steps are (F, 5), (V or 0, 3) and (N or 0, 3); empty where a group does not take part.
    Rows that became imaginary are not finite, so no energy accepts them.
    """
    spheres, displacements, normals = steps
    keeps_radius = freedom.has_fixed_radius
    rows = unknowns.spheres + spheres
    rows[keeps_radius, 0] = unknowns.spheres[keeps_radius, 0]
    result = replace(unknowns, spheres=_normalized(rows, keeps_radius))
    if len(displacements):
        result = replace(result, displacements=unknowns.displacements + displacements)
    if len(normals):
        result = replace(result, normals=unit(unknowns.normals + normals))
    return result


def _normalized(rows: FloatArray, has_fixed_radius: BoolArray) -> FloatArray:
    with np.errstate(invalid="ignore", divide="ignore"):
        result = rows / np.sqrt(minkowski(rows, rows))[:, None]
        fixed = rows[has_fixed_radius]
        # |B|² = 1 + 4 A C keeps A, and divides by nothing that a plane makes small.
        length = np.sqrt(1 + 4 * fixed[:, 0] * fixed[:, 4])
        fixed[:, 1:4] = unit(fixed[:, 1:4]) * length[:, None]
    result[has_fixed_radius] = fixed
    return result
