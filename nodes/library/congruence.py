"""Spheres at the vertices of a surface, and the surfaces that such spheres envelop."""

from typing import Literal, NamedTuple

import numpy as np

from ...kernel.arrays import BoolArray
from ...kernel.congruences import curvature_spheres as congruence
from ...kernel.congruences import discrete_envelopes
from ...kernel.meshes.mesh import Mesh, mean_edge_length
from ...kernel.tolerances import VERTEX_MISS
from ..graphs.node import node, warn
from .arrays import FaceMarks, FacePoints, VertexDistances, VertexSpheres


class Envelope(NamedTuple):
    """The two surfaces that a sphere congruence envelops, a point of each per face."""

    points_plus: FacePoints
    points_minus: FacePoints
    is_real: FaceMarks


@node
def sphere_congruence(
    mesh: Mesh,
    kind: Literal["central", "tangent", "principal"] = "central",
    offset: float | VertexDistances | None = None,
    which: Literal["first", "second"] = "first",
) -> VertexSpheres:
    """
    A sphere at every vertex of a surface mesh, touching the surface there.

    Parameters
    ----------
    mesh : Mesh
        The mesh; its faces need be neither triangles nor planar.
    kind : {"central", "tangent", "principal"}
        Spheres of the mean curvature, with their centre at a given offset, or of a principal
        curvature.
    offset : float or (V,) float array, optional
        Signed distance of the centres along the vertex normals, not zero; for tangent spheres.
    which : {"first", "second"}
        The larger or the smaller principal curvature, positive where the surface bends to its
        normal; for principal spheres.

    Returns
    -------
    (V, 5) float array
        Rows (A, Bx, By, Bz, C), planes included. The curvatures are estimates: where 48 faces
        make a full turn they are off by about 2 %, with 96 by a quarter of that.
    """
    spheres, is_fitted = congruence.sphere_congruence(mesh, kind, offset, which)
    if not is_fitted.all():
        warn(
            f"{_share(~is_fitted)} of the vertices have too few neighbours to tell the "
            "curvature and get their tangent plane: refine the mesh there"
        )
    return spheres


@node
def envelope(
    mesh: Mesh, spheres: VertexSpheres, order: Literal["nearest", "oriented"] = "nearest"
) -> Envelope:
    """
    Points in which the spheres at the corners of each face meet: the two enveloped surfaces.

    Parameters
    ----------
    mesh : Mesh
        The mesh at whose vertices the spheres sit.
    spheres : (V, 5) float array
        Rows of the spheres.
    order : {"nearest", "oriented"}
        Plus is the point nearer to the face; or the one to the side of the normal of the
        centres, if N points to the centres.

    Returns
    -------
    points_plus, points_minus : (F, 3) float array
        The vertices of the two surfaces, on the dual of the mesh; NaN where they are not real,
        infinite where one is at infinity, as for planes.
    is_real : (F,) bool array
        Whether the spheres of the face meet in two real points.
    """
    result = discrete_envelopes.envelope(mesh, spheres, order)
    if not result.is_real.all():
        warn(
            f"{_share(~result.is_real)} of the faces have no real envelope: their spheres meet "
            "in no two points of space"
        )
    miss = float(np.nanmax(result.residuals)) if result.is_real.any() else 0.0
    relative = miss / mean_edge_length(mesh)
    if relative > VERTEX_MISS:
        missing = np.nan_to_num(result.residuals) > VERTEX_MISS * mean_edge_length(mesh)
        warn(
            f"on {_share(missing)} of the faces the spheres have no two points in common; the "
            f"nearest ones miss them by up to {relative:.3g} mean edges"
        )
    return Envelope(result.points_plus, result.points_minus, result.is_real)


def _share(mask: BoolArray) -> str:
    return f"{100 * float(mask.mean()):.3g} %"
