"""Shapes of the faces of a sphere mesh: visually convex, bow-tie, or crossing themselves."""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..meshes.mesh import face_normals, local_corners
from ..panels.cutting import cutting_planes, flatten_nearly_plane
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.arc_crossings import crossing_boundaries
from ..spheres.arcs import sphere_arcs
from ..tolerances import SAME_CURVATURE, STRAIGHT_CORNER

CONVEX, BOW_TIE, CROSSING_FACE = "convex", "bow-tie", "crossing"


class PencilPosition(IntEnum):
    """Where a tangent sphere lies among all spheres that touch a surface in a point."""

    EMPTY = 0
    """It does not meet the surface around the point: neighbours cut out a convex face."""
    PRINCIPAL = 1
    """It is one of the two curvature spheres, up to rounding."""
    CENTRAL = 2
    """Between the curvature spheres, as the central sphere: neighbours cut out a bow-tie."""


def face_shapes(sphere_mesh: SphereMesh) -> NDArray[Any]:
    """Tell visually convex faces from bow-ties and from those whose boundary crosses itself.

    For each face ``"convex"``: seen along the direction of its largest shadow, no corner is
    reflex; ``"bow-tie"``: some are (two, in the typical case); ``"crossing"``: two of its arcs
    meet, or the face is folded over and runs clockwise about N.

    Notes
    -----
    The largest shadow of a closed polygon is thrown along its vector area. Arcs are those in
    which the spheres meet; edges on the boundary are cut upright.

    References
    ----------
    Meshes with Spherical Faces, Sec. 7, Fig. 30.
    """
    shadow = face_normals(sphere_mesh.mesh)
    result = np.full(len(shadow), CONVEX, f"<U{len(CROSSING_FACE)}")
    result[_has_reflex_corner(sphere_mesh, shadow)] = BOW_TIE
    is_folded = dot(shadow, sphere_mesh.local_spheres[:, 1:4]) <= 0
    result[is_folded | boundary_crosses(sphere_mesh)] = CROSSING_FACE
    return result


def _has_reflex_corner(sphere_mesh: SphereMesh, shadow: FloatArray) -> BoolArray:
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    points = local_corners(mesh)
    sides = points[topology.next_corners] - points
    after = sides[topology.next_corners]
    turns = dot(np.cross(sides, after), shadow[topology.corner_faces])
    is_reflex = turns < -STRAIGHT_CORNER * norm(sides) * norm(after)
    return np.logical_or.reduceat(is_reflex, mesh.offsets[:-1])


def boundary_crosses(sphere_mesh: SphereMesh) -> BoolArray:
    """Faces (F,) whose boundary, of the arcs in which spheres meet, crosses itself.

    Two arcs meet elsewhere than in their common corner. The vertices lie on the spheres.
    """
    flat = flatten_nearly_plane(sphere_mesh)
    mesh, rows = flat.mesh, flat.local_spheres
    plane_normals, plane_offsets = cutting_planes(flat, "intersection")
    starts = local_corners(mesh)
    ends = starts[mesh.topology.next_corners]
    arcs = sphere_arcs(rows[mesh.topology.corner_faces], plane_normals, starts, ends)
    return crossing_boundaries(rows, mesh.offsets, plane_normals, plane_offsets, arcs)


def pencil_positions(curvatures: FloatArray, first: FloatArray, second: FloatArray) -> IntArray:
    """Position of tangent spheres in the parabolic pencils of a surface: `PencilPosition`.

    By the signed curvatures 2A of the spheres and the principal curvatures,
    ``first >= second``, all with respect to the surface normals.

    References
    ----------
    Meshes with Spherical Faces, Sec. 7, Fig. 31.
    """
    scale = np.maximum(np.abs(curvatures), np.maximum(np.abs(first), np.abs(second)))
    inside = np.minimum(first - curvatures, curvatures - second)
    result = np.where(inside > 0, int(PencilPosition.CENTRAL), int(PencilPosition.EMPTY))
    result[np.abs(inside) <= SAME_CURVATURE * scale] = int(PencilPosition.PRINCIPAL)
    return result
