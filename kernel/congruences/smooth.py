"""
Sphere congruences: two-parameter families of spheres, smooth and at the vertices of a mesh.

A smooth congruence is known by its centres, radii and their first derivatives. The spheres that
touch a surface at a point p with normal n are the rows of curvature κ with respect to n, planes
included: ``(κ / 2, n, 0)`` seen from p.

The formulas are those of Section 2.2 of the paper "Meshes with Spherical Faces".
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, dot, norm
from ..errors import InputError, name_ids
from ..meshes.curvature import principal_curvatures, vertex_normals
from ..meshes.mesh import Mesh
from ..spheres.rows import recenter
from ..tolerances import EPSILON

CongruenceKind: TypeAlias = Literal["central", "tangent", "principal"]


@dataclass(frozen=True)
class SphereJet:
    """
    A smooth sphere congruence to first order, at any number of parameters (u, v).

    Attributes
    ----------
    centers : (..., 3) float array
        Centres c.
    radii : (...) float array
        Radii r.
    centers_u, centers_v : (..., 3) float array
        Derivatives of the centres; independent where the congruence is regular.
    radii_u, radii_v : (...) float array
        Derivatives of the radii.
    """

    centers: FloatArray
    radii: FloatArray
    centers_u: FloatArray
    centers_v: FloatArray
    radii_u: FloatArray
    radii_v: FloatArray


def has_real_envelopes(jet: SphereJet) -> BoolArray:
    """
    Whether a congruence has two real envelopes.

    Parameters
    ----------
    jet : SphereJet
        The congruence.

    Returns
    -------
    (...) bool array
        ``|c_u|² |c_v|² - <c_u, c_v>² > |r_u c_v - r_v c_u|²``: the gradient of r on the surface
        of the centres is shorter than 1. False where the congruence is not regular.

    References
    ----------
    Meshes with Spherical Faces, Lemma 2.1.
    """
    area, change = _area_and_change(jet)
    return dot(area, area) > dot(change, change)


def envelope_points(jet: SphereJet) -> tuple[FloatArray, FloatArray]:
    """
    Points in which the spheres of a congruence touch its two envelopes.

    Parameters
    ----------
    jet : SphereJet
        The congruence.

    Returns
    -------
    plus, minus : (..., 3) float array
        ``f± = c - r grad r ± r sqrt(1 - |grad r|²) N`` with N along ``c_u × c_v``: mirror
        images in the tangent plane of the surface of the centres. NaN where they are not real
        or the congruence is not regular; equal where ``|grad r| = 1`` up to rounding.

    Notes
    -----
    The common points of the sphere and the planes ``<x - c, c_u> + r r_u = 0`` and
    ``<x - c, c_v> + r r_v = 0``.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.2.1.
    """
    area, change = _area_and_change(jet)
    square, slope = dot(area, area), dot(change, change)
    slack = square - slope
    slack = np.where(np.abs(slack) <= 16 * EPSILON * (square + slope), 0.0, slack)
    with np.errstate(divide="ignore", invalid="ignore"):
        gradient = np.cross(change, area) / square[..., None]
        height = (np.sqrt(slack) / square)[..., None] * area
    radii = jet.radii[..., None]
    foot = jet.centers - radii * gradient
    return foot + radii * height, foot - radii * height


def _area_and_change(jet: SphereJet) -> tuple[FloatArray, FloatArray]:
    """``c_u × c_v`` and ``r_u c_v - r_v c_u``; the square of their ratio is that of grad r."""
    area = np.cross(jet.centers_u, jet.centers_v)
    change = jet.radii_u[..., None] * jet.centers_v - jet.radii_v[..., None] * jet.centers_u
    return area, change


def conjugacy_residuals(
    along_u: FloatArray, along_v: FloatArray, mixed: FloatArray, lift: FloatArray | None = None
) -> FloatArray:
    """
    How far a parametrisation or a net is from conjugate: distance of f_uv from a span.

    Parameters
    ----------
    along_u, along_v : (..., n) float array
        First derivatives; of a net the differences along the two sides of a face.
    mixed : (..., n) float array
        Derivative f_uv; of a net the difference of the differences.
    lift : (..., n) float array, optional
        The map itself where it is projective, for example rows of spheres, of any scale.

    Returns
    -------
    (...) float array
        Distance of f_uv from ``[f_u, f_v]``, or from ``[f, f_u, f_v]`` with a lift; in the
        unit of f_uv. Zero means conjugate, in every coordinate system; other values depend on
        the parametrisation, and with a lift on its scale and coordinates.

    References
    ----------
    Meshes with Spherical Faces, Def. 2.2 and below.
    """
    vectors = [along_u, along_v] if lift is None else [lift, along_u, along_v]
    lengths = [norm(vector)[..., None] for vector in vectors]
    scaled = [
        v / np.where(size > 0, size, 1.0) for v, size in zip(vectors, lengths, strict=True)
    ]
    frames, values, _ = np.linalg.svd(np.stack(scaled, -1), full_matrices=False)
    used = values > 8 * EPSILON * values[..., :1]
    shares = np.where(used, np.einsum("...ij,...i->...j", frames, mixed), 0.0)
    return norm(mixed - np.einsum("...ij,...j->...i", frames, shares))


def touching_spheres(
    points: FloatArray, normals: FloatArray, curvatures: ArrayLike
) -> FloatArray:
    """
    Spheres through points with given normals and curvatures: a parabolic pencil at each point.

    Parameters
    ----------
    points : (..., 3) float array
        Points.
    normals : (..., 3) float array
        Unit normals.
    curvatures : (...) array_like of float
        Curvatures with respect to the normals: ``1 / κ`` is the signed distance of the centre
        along the normal; 0 for the tangent plane.

    Returns
    -------
    (..., 5) float array
        Unit rows; N agrees with the normals.
    """
    half = np.broadcast_to(np.asarray(curvatures, float) / 2, points.shape[:-1])[..., None]
    return recenter(np.concatenate([half, normals, np.zeros_like(half)], -1), -points)


def principal_curvature_spheres(
    points: FloatArray, normals: FloatArray, first: FloatArray, second: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """
    The two principal curvature spheres of a surface.

    Parameters
    ----------
    points, normals : (..., 3) float array
        Points of the surface and its unit normals.
    first, second : (...) float array
        Principal curvatures with respect to the normals; 0 gives the tangent plane.

    Returns
    -------
    first, second : (..., 5) float array
        Unit rows that touch the surface; N agrees with its normals.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.2.4.
    """
    return touching_spheres(points, normals, first), touching_spheres(points, normals, second)


def mean_curvature_spheres(
    points: FloatArray, normals: FloatArray, first: FloatArray, second: FloatArray
) -> FloatArray:
    """
    The central spheres of a surface: of its mean curvature, touching it.

    Parameters
    ----------
    points, normals : (..., 3) float array
        Points of the surface and its unit normals.
    first, second : (...) float array
        Principal curvatures with respect to the normals.

    Returns
    -------
    (..., 5) float array
        Unit rows of curvature ``H = (k1 + k2) / 2``, planes where it vanishes. They commute
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
    """
    A sphere at every vertex of a surface mesh, touching the surface there.

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
