"""Which way the unknowns may move.

Vertices may be bound to a ball about their old place, to a plane or to a line; the radius of a
sphere may be given. Steps are projected onto what is free, and moves end inside the bounds.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ...meshes.mesh import Mesh, face_normals
from ...spheres.minkowski import minkowski, minkowski_gradient
from ...tolerances import AT_BOUND
from .setting import Unknowns

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


def project_displacements(freedom: Freedom, displacements: FloatArray) -> FloatArray:
    """Nearest displacements (V, 3), in free directions, within the bound."""
    length = norm(displacements)
    too_long = length > freedom.tolerance
    factor = np.ones_like(length)
    # A hair inside, so that rounding does not carry a vertex out again.
    factor[too_long] = (1 - AT_BOUND / 2) * freedom.tolerance / length[too_long]
    return displacements * factor[:, None]


def pushed_out(freedom: Freedom, displacements: FloatArray, push: FloatArray) -> BoolArray:
    """Vertices at their bound that a push carries out of it, (V or 0,).

    There is a push for each, (V or 0, 3), and none where vertices take no part.
    """
    where = displacements[: len(push)]
    return (norm(where) >= freedom.tolerance * (1 - AT_BOUND)) & (dot(push, where) > 0)


def free_directions(freedom: Freedom, displacements: FloatArray, held: BoolArray) -> FloatArray:
    """Free directions of a step: vertices that are held at their bound only move along it.

    Orthogonal projections (V or 0, 3, 3); (V or 0,) vertices are held, empty where they take no
    part.
    """
    outward = np.where(held[:, None], unit(displacements[: len(held)]), 0.0)
    return freedom.vertices[: len(held)] - outward[:, :, None] * outward[:, None, :]


def tangent_to_spheres(
    freedom: Freedom, unknowns: Unknowns, faces: IntArray, derivatives: FloatArray
) -> FloatArray:
    """Derivatives by what is left of a change of a row when the row is made unit again.

    From derivatives (m, 5) by the rows of faces (m,) to those of the composition with `moved`.
    """
    rows = unknowns.spheres[faces]
    along = dot(derivatives, rows)[:, None]
    result = derivatives - along * minkowski_gradient(rows)
    fixed = freedom.has_fixed_radius[faces]
    if fixed.any():
        b = unit(rows[fixed, 1:4])
        by_b, by_c = derivatives[fixed, 1:4], derivatives[fixed, 4]
        radial = dot(by_b, b)
        length = norm(rows[fixed, 1:4])
        result[fixed, 0] = 0
        result[fixed, 1:4] = by_b - radial[:, None] * b
        result[fixed, 4] = by_c + radial * 2 * rows[fixed, 0] / length
    return result


def moved(
    freedom: Freedom, unknowns: Unknowns, steps: tuple[FloatArray, FloatArray, FloatArray]
) -> Unknowns:
    """Unknowns after a step: unit rows, unit dual normals, vertices within their bound.

    The steps are (F, 5), (V or 0, 3) and (N or 0, 3); empty where a group does not take part.
    Rows that became imaginary are not finite, so no energy accepts them.
    """
    spheres, displacements, normals = steps
    keeps_radius = freedom.has_fixed_radius
    rows = unknowns.spheres + spheres
    rows[keeps_radius, 0] = unknowns.spheres[keeps_radius, 0]
    result = replace(unknowns, spheres=_normalized(rows, keeps_radius))
    if len(displacements):
        free = project_displacements(freedom, unknowns.displacements + displacements)
        result = replace(result, displacements=free)
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
