"""Spheres at the vertices of a surface, and the surfaces that such spheres envelop."""

from typing import Literal, NamedTuple

import numpy as np

from ...kernel.arrays import BoolArray
from ...kernel.congruences import curvature_spheres as congruence
from ...kernel.congruences import discrete_envelopes
from ...kernel.congruences.conjugacy import conjugacy_residuals
from ...kernel.congruences.smooth_envelopes import (
    SphereJet,
    envelope_points,
    has_real_envelopes,
)
from ...kernel.meshes.mesh import Mesh, mean_edge_length
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.tolerances import VERTEX_MISS
from ..graphs.node import node, warn
from .arrays import (
    FaceDistances,
    FaceMarks,
    FacePoints,
    Marks,
    Numbers,
    Points,
    Vectors,
    VertexDistances,
    VertexMarks,
    VertexPoints,
    VertexSpheres,
)


class Envelope(NamedTuple):
    """The two surfaces that a sphere congruence envelops, a point of each per face."""

    points_plus: FacePoints
    points_minus: FacePoints
    is_real: FaceMarks


class MirrorPoints(NamedTuple):
    """The second envelope of a sphere mesh."""

    points: VertexPoints
    residuals: VertexDistances
    is_valid: VertexMarks


class ContactPoints(NamedTuple):
    """The points nearest to the spheres around each vertex."""

    points: VertexPoints
    residuals: VertexDistances


class CircularEnvelopes(NamedTuple):
    """How far the two envelopes of a sphere mesh are from circular nets."""

    plus: FaceDistances
    minus: FaceDistances


class SmoothEnvelope(NamedTuple):
    """The two surfaces that a smooth congruence envelops."""

    points_plus: Points
    points_minus: Points
    is_real: Marks


@node
def sphere_congruence(
    mesh: Mesh,
    kind: Literal["central", "tangent", "principal"] = "central",
    offset: float | VertexDistances | None = None,
    which: Literal["first", "second"] = "first",
) -> VertexSpheres:
    """A sphere at every vertex of a surface mesh, touching the surface there.

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

    Examples
    --------
    >>> from spheremesh.nodes import sphere_congruence, torus_mesh
    >>> sphere_congruence(torus_mesh(12, 6), "principal").shape
    (72, 5)
    """
    spheres, is_fitted = congruence.sphere_congruence(mesh, kind, offset, which)
    if not is_fitted.all():
        warn(
            f"{_share(~is_fitted)} of the vertices have too few neighbours to estimate the "
            "curvature, and get their tangent plane: refine the mesh there"
        )
    return spheres


@node
def envelope(
    mesh: Mesh, spheres: VertexSpheres, order: Literal["nearest", "oriented"] = "nearest"
) -> Envelope:
    """Points in which the spheres at the corners of each face meet: the two enveloped surfaces.

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

    Examples
    --------
    >>> from spheremesh.nodes import envelope, tangent_spheres, torus_mesh, triangulate
    >>> mesh = triangulate(torus_mesh(24, 12))
    >>> found = envelope(mesh, tangent_spheres(mesh, 0.9))
    >>> found.points_plus.shape, bool(found.is_real.all())
    ((576, 3), True)
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


@node
def smooth_envelope(
    centers: Points,
    radii: Numbers,
    centers_u: Points,
    centers_v: Points,
    radii_u: Numbers,
    radii_v: Numbers,
) -> SmoothEnvelope:
    """Points in which the spheres of a smooth congruence touch the two surfaces they envelop.

    Parameters
    ----------
    centers : (N, 3) float array
    radii : (N,) float array
    centers_u, centers_v : (N, 3) float array
        Derivatives of the centres by the two parameters.
    radii_u, radii_v : (N,) float array
        Derivatives of the radii.

    Returns
    -------
    points_plus, points_minus : (N, 3) float array
        Mirror images in the tangent plane of the surface of the centres; NaN where not real.
    is_real : (N,) bool array
        Whether there are two real points: the radius changes more slowly than the centre.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import smooth_envelope
    >>> flat = np.zeros((1, 3)), np.ones(1), np.eye(3)[:1], np.eye(3)[1:2]
    >>> smooth_envelope(*flat, np.zeros(1), np.zeros(1)).points_plus.tolist()
    [[0.0, 0.0, 1.0]]
    """
    jet = SphereJet(centers, radii, centers_u, centers_v, radii_u, radii_v)
    return SmoothEnvelope(*envelope_points(jet), has_real_envelopes(jet))


@node
def conjugacy(
    along_u: Vectors, along_v: Vectors, mixed: Vectors, lift: Vectors | None = None
) -> Numbers:
    """How far a parametrisation or a net is from conjugate: distance of f_uv from a span.

    Parameters
    ----------
    along_u, along_v : (N, n) float array
        First derivatives; of a net the differences along two sides of each face.
    mixed : (N, n) float array
        Derivative f_uv; of a net the difference of the differences.
    lift : (N, n) float array, optional
        The map itself where it is projective, such as rows of spheres; none by default.

    Returns
    -------
    (N,) float array
        Distance of f_uv from the span of f_u and f_v (and f with a lift); zero is conjugate,
        NaN where a number is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import conjugacy
    >>> conjugacy(np.eye(3)[:1], np.eye(3)[1:2], np.array([[0.0, 1.0, 2.0]])).tolist()
    [2.0]
    """
    return conjugacy_residuals(along_u, along_v, mixed, lift)


@node
def mirror_points(sphere_mesh: SphereMesh) -> MirrorPoints:
    """Points in which the spheres around each vertex meet once more: the second envelope.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Its spheres pass through the vertices.

    Returns
    -------
    points : (V, 3) float array
        NaN on the boundary; by least squares around vertices of more than three faces.
    residuals : (V,) float array
        Distance from the farthest sphere of the vertex, in model units: zero for a
        Q-congruence.
    is_valid : (V,) bool array
        Whether the point is one of space.

    Examples
    --------
    >>> from spheremesh.nodes import central_spheres, mirror_points, torus_mesh
    >>> found = mirror_points(central_spheres(torus_mesh(12, 6, major_radius=3.0)))
    >>> int(found.is_valid.sum()), round(float(found.residuals.max()), 9)
    (72, 0.0)
    """
    found = discrete_envelopes.mirror_points(sphere_mesh)
    return MirrorPoints(found.points, found.residuals, found.is_valid)


@node
def contact_points(sphere_mesh: SphereMesh) -> ContactPoints:
    """Points nearest to all spheres around each vertex: the vertices that spheres ask for.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    points : (V, 3) float array
        By least squares of the distances; vertices on fewer than three spheres move no farther
        than they must.
    residuals : (V,) float array
        Distance from the farthest sphere of the vertex, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import contact_points, face_planes, torus_mesh
    >>> round(float(contact_points(face_planes(torus_mesh(12, 6))).residuals.max()), 9)
    0.0
    """
    return ContactPoints(*discrete_envelopes.contact_points(sphere_mesh))


@node
def circular_envelopes(sphere_mesh: SphereMesh) -> CircularEnvelopes:
    """Test for a discrete Ribaucour congruence: both envelopes of a sphere mesh are circular.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A Q-congruence, whose `mirror_points` have no residuals.

    Returns
    -------
    plus, minus : (F,) float array
        How far the corners of each face, and their mirror points, are from one circle, relative
        to the size of the face; NaN where a corner has no mirror point.

    Examples
    --------
    >>> from spheremesh.nodes import central_spheres, circular_envelopes, torus_mesh
    >>> found = circular_envelopes(central_spheres(torus_mesh(12, 6, major_radius=3.0)))
    >>> round(float(found.plus.max()), 9), round(float(found.minus.max()), 9)
    (0.0, 0.0)
    """
    return CircularEnvelopes(*discrete_envelopes.ribaucour_residuals(sphere_mesh))


def _share(mask: BoolArray) -> str:
    return f"{100 * float(mask.mean()):.3g} %"
