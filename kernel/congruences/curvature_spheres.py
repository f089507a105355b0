"""Spheres that touch a surface: tangent, principal and central ones (Sec. 2.2.4, 2.2.5).

Touching at a point p with normal n are the rows of curvature κ with respect to n, planes
included: ``(κ / 2, n, 0)`` seen from p.
"""

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray
from ..errors import InputError, name_ids
from ..meshes.curvature import principal_curvatures, vertex_normals
from ..meshes.mesh import Mesh
from ..spheres.rows import recenter

CongruenceKind: TypeAlias = Literal["central", "tangent", "principal"]


def touching_spheres(
    points: FloatArray, normals: FloatArray, curvatures: ArrayLike
) -> FloatArray:
    """Spheres through points with given normals and curvatures: a parabolic pencil at each.

    Unit normals (..., 3) and curvatures (...) with respect to them: ``1 / κ`` is the signed
    distance of the centre along the normal; 0 for the tangent plane. Unit rows (..., 5); N
    agrees with the normals.
    """
    half = np.broadcast_to(np.asarray(curvatures, float) / 2, points.shape[:-1])[..., None]
    return recenter(np.concatenate([half, normals, np.zeros_like(half)], -1), -points)


def mean_curvature_spheres(
    points: FloatArray, normals: FloatArray, first: FloatArray, second: FloatArray
) -> FloatArray:
    """The central spheres of a surface: of its mean curvature, touching it.

    Points and unit normals are (..., 3), principal curvatures with respect to these (...). Unit
    rows (..., 5) of curvature ``H = (k1 + k2) / 2``, planes where it vanishes. They commute
    with Möbius maps: with the principal spheres and the point the cross-ratio is -1.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.2.5.
    """
    return touching_spheres(points, normals, (first + second) / 2)


def sphere_congruence(
    mesh: Mesh,
    kind: CongruenceKind = "central",
    offset: ArrayLike | None = None,
    which: Literal["first", "second"] = "first",
) -> tuple[FloatArray, BoolArray]:
    """A sphere at every vertex of a surface mesh, touching the surface there.

    Parameters
    ----------
    mesh : Mesh
        The mesh; its faces need be neither triangles nor planar.
    kind : {"central", "tangent", "principal"}
        Of the mean curvature, with the centre at a given offset, or of a principal curvature.
    offset : (V,) array_like of float or float, optional
        For tangent spheres: signed distance of the centres along the normals, not zero;
        infinite for tangent planes. The other kinds do not use it.
    which : {"first", "second"}
        For principal spheres: the larger or the smaller curvature with respect to the normal.
        Either is a continuous family, which the sharper and the flatter are not.

    Returns
    -------
    spheres : (V, 5) float array
        Unit rows in model coordinates; N agrees with the normals of the faces.
    is_fitted : (V,) bool array
        False where too few vertices lie around to tell the curvature: there the tangent plane
        is given. True for tangent spheres.

    Raises
    ------
    InputError
        If the kind is unknown, the offset is missing, zero or of the wrong shape, or a vertex
        has no normal.

    Notes
    -----
    Accuracy: see `principal_curvatures` and `vertex_normals`; both are of second order in the
    edge length inside, the normals of first order on boundaries across which the surface
    twists. Seen from its vertex a row is ``(κ / 2, n, 0)``, whatever rounding far from the
    origin has left of the last coefficient.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.2.4, 2.2.5 and 7.
    """
    points, is_fitted = mesh.vertices, np.ones(mesh.n_vertices, bool)
    if kind == "tangent":
        curvatures = 1 / _checked_offset(offset, mesh.n_vertices)
        return touching_spheres(points, vertex_normals(mesh), curvatures), is_fitted
    if kind not in ("central", "principal"):
        raise InputError(f"kind must be 'central', 'tangent' or 'principal', not {kind!r}")
    if which not in ("first", "second"):
        raise InputError(f"which must be 'first' or 'second', not {which!r}")
    first, second, is_fitted = principal_curvatures(mesh)
    normals = vertex_normals(mesh)
    if kind == "central":
        return mean_curvature_spheres(points, normals, first, second), is_fitted
    curvatures = first if which == "first" else second
    return touching_spheres(points, normals, curvatures), is_fitted


def _checked_offset(offset: ArrayLike | None, n_vertices: int) -> FloatArray:
    if offset is None:
        raise InputError("tangent spheres need an offset: the distance of their centres")
    distances = np.asarray(offset, float)
    if distances.shape not in ((), (n_vertices,)):
        raise InputError(
            f"offset must be a number or have shape ({n_vertices},), not {distances.shape}"
        )
    distances = np.broadcast_to(distances, n_vertices)
    bad = np.flatnonzero(~(np.abs(distances) > 0))
    if len(bad):
        raise InputError(
            f"the offset is zero or no number at vertices {name_ids(bad.tolist())}"
        )
    return distances
