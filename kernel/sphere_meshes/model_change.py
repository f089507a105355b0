"""Sphere meshes from planar ones, by changing the model of a geometry.

Hyperbolic space inside a ball, and elliptic space about a point, have a model in which planes
are planes and a conformal one in which they are spheres. The map δ from the one to the other
takes the vertices along; the planes of the faces become spheres in closed form. With q seen
from the centre of the absolute sphere of radius r, the upper sign in hyperbolic and the lower
one in elliptic geometry:

    inner branch:  δ(q) = r q / (r + sqrt(r² ∓ |q|²)),
    outer branch:  ±r² δ(q) / |δ(q)|², its reflection in the absolute sphere,
    both branches:  n·q = d  becomes  (A, B, C) = (±d, 2 r² n, d r²).

All face spheres are orthogonal to the absolute sphere (hyperbolic) or meet it in great circles
(elliptic), or pass through one point (`sphere_bundle`). Every such mesh has a support
structure, whose axes and planes pass through the centre.

The formulas are those of Section 5 of the paper "Meshes with Spherical Faces".
"""

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, dot, norm
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, face_normals, mean_edge_length, reversed_corners
from ..spheres.mobius_group import inversion
from ..tolerances import AT_INFINITY, EPSILON, PLANAR
from .fit import face_planes
from .mobius import map_sphere_mesh
from .planarity_circularity import planarity
from .sphere_mesh import SphereMesh

Geometry = Literal["hyperbolic", "elliptic"]
Branch = Literal["inner", "outer"]

SIGNS: dict[str, float] = {"hyperbolic": 1.0, "elliptic": -1.0}


def model_points(
    points: FloatArray, geometry: Geometry, radius: float, branch: Branch = "inner"
) -> FloatArray:
    """Images δ of points, the absolute sphere being centred at the origin.

    Parameters
    ----------
    points : (..., 3) float array
        Points; in hyperbolic geometry at most a rounding error outside the absolute sphere, and
        on the outer branch not the origin.
    geometry : {"hyperbolic", "elliptic"}
        Geometry.
    radius : float
        Radius r of the absolute sphere.
    branch : {"inner", "outer"}
        Image inside or outside the absolute sphere.

    Returns
    -------
    (..., 3) float array
        Points; those of the two branches have the product ``±r²``.

    References
    ----------
    Meshes with Spherical Faces, eq. (10) and (11), in a form without cancellation.

    Examples
    --------
    >>> model_points(np.array([[0.6, 0, 0]]), "hyperbolic", 1.0).round(12).tolist()
    [[0.333333333333, 0.0, 0.0]]
    """
    sign = SIGNS[geometry]
    relative = points / radius
    square = dot(relative, relative)
    divisor = 1 + np.sqrt(np.maximum(1 - sign * square, 0))
    if branch == "inner":
        return points / divisor[..., None]
    return sign * points * (divisor / square)[..., None]


def model_spheres(
    normals: FloatArray, distances: FloatArray, geometry: Geometry, radius: float
) -> FloatArray:
    """Spheres that planes become, the absolute sphere being centred at the origin.

    Parameters
    ----------
    normals : (..., 3) float array
        Unit normals n of the planes.
    distances : (...) float array
        Signed distances d of the origin; below r in hyperbolic geometry.
    geometry : {"hyperbolic", "elliptic"}
        Geometry.
    radius : float
        Radius r of the absolute sphere.

    Returns
    -------
    (..., 5) float array
        Rows ``(±d / 2r², n, d / 2)`` of norm ``1 ∓ d² / r²``, oriented as the planes on the
        inner branch.

    References
    ----------
    Meshes with Spherical Faces, Sec. 5.1 and 5.2.
    """
    leading = SIGNS[geometry] * distances / (2 * radius**2)
    return np.concatenate([leading[..., None], normals, distances[..., None] / 2], -1)


def change_model(
    mesh: Mesh, geometry: Geometry, radius: float, center: ArrayLike, branch: Branch = "inner"
) -> SphereMesh:
    """Sphere mesh with a support structure, from a mesh with planar faces.

    Parameters
    ----------
    mesh : Mesh
        Planar faces of any degree.
    geometry : {"hyperbolic", "elliptic"}
        Face spheres orthogonal to the absolute sphere, or meeting it in great circles.
    radius : float
        Radius of the absolute sphere; in hyperbolic geometry all vertices lie inside or on it.
    center : (3,) array_like of float
    branch : {"inner", "outer"}
        Image inside or outside the absolute sphere.

    Returns
    -------
    SphereMesh
        Vertices and faces keep their ids. On the outer hyperbolic branch, a reflection of the
        inner one, faces run the other way round, so that outside stays outside.

    Raises
    ------
    InputError
        If a face is not planar, a vertex lies outside the hyperbolic ball, or a vertex or face
        reaches the centre, which the outer branch sends to infinity; the message names them.

    References
    ----------
    Meshes with Spherical Faces, Prop. 5.3, Remark 5.5 and Prop. 5.6.
    """
    _check_choice("geometry", geometry, get_args(Geometry))
    _check_choice("branch", branch, get_args(Branch))
    origin = _check_ball(center, radius)
    _refuse_not_planar(mesh)
    points = mesh.vertices - origin
    rounding = 4 * EPSILON * (np.abs(mesh.vertices).max() + np.abs(origin).max() + radius)
    _check_distances(mesh, norm(points), geometry, radius, branch, float(rounding))

    corners = mesh.corners
    unit_normals = face_normals(mesh)
    distances = dot(unit_normals, face_centroids(mesh) - origin)
    rows = model_spheres(unit_normals, distances, geometry, radius)
    if branch == "outer" and geometry == "hyperbolic":
        corners = reversed_corners(mesh)
    elif branch == "outer":
        # The outer elliptic branch turns by two reflections; the second takes N to the other
        # side of spheres that both leave in place.
        rows = -rows
    images = model_points(points, geometry, radius, branch)
    faces = np.split(corners, mesh.offsets[1:-1])
    near = SphereMesh(Mesh(images, faces), rows)
    backwards = dot(face_normals(near.mesh), near.local_spheres[:, 1:4]) <= 0
    _refuse(backwards, "faces {} are too near the centre for the outer branch; move it away")
    return SphereMesh.from_local(Mesh(images + origin, faces), near.local_spheres)


def sphere_bundle(mesh: Mesh, center: ArrayLike, radius: float) -> SphereMesh:
    """Sphere mesh whose spheres all pass through one point: an inversion of planar faces.

    The centre lies on no face; the sphere of the given radius about it stays in place. Vertices
    and faces keep their ids; faces run the other way round, so that outside stays outside.

    Raises
    ------
    InputError
        If a face is not planar, or a vertex or face reaches the centre; the message names them.

    References
    ----------
    Meshes with Spherical Faces, Prop. 5.7.
    """
    _refuse_not_planar(mesh)
    return map_sphere_mesh(face_planes(mesh), inversion(center, radius))


def _check_choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InputError(f"{name} must be {' or '.join(choices)}, not {value!r}")


def _check_ball(center: ArrayLike, radius: float) -> FloatArray:
    point = np.asarray(center, float)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InputError("the centre must be 3 finite numbers")
    if not (np.isfinite(radius) and radius > 0):
        raise InputError(f"the radius must be positive and finite, not {radius}")
    return point


def _refuse_not_planar(mesh: Mesh) -> None:
    miss = planarity(mesh) / mean_edge_length(mesh)
    _refuse(
        miss > PLANAR,
        f"faces {{}} are not planar: corners lie up to {miss.max():.2g} mean edges off their "
        f"plane (at most {PLANAR:g}); triangulate the mesh, or make its faces planar",
    )


def _check_distances(
    mesh: Mesh,
    distances: FloatArray,
    geometry: Geometry,
    radius: float,
    branch: Branch,
    rounding: float,
) -> None:
    if geometry == "hyperbolic":
        _refuse(
            distances > radius + rounding,
            f"vertices {{}} lie outside the absolute sphere of radius {radius:g}: hyperbolic "
            f"geometry needs a radius of at least {distances.max():g} about this centre",
        )
    if branch == "outer":
        reach = max(rounding, AT_INFINITY * mean_edge_length(mesh))
        _refuse(
            distances <= reach,
            "vertices {} lie at the centre, which the outer branch sends to infinity; move the "
            "centre away",
        )


def _refuse(is_bad: BoolArray, message: str) -> None:
    if is_bad.any():
        raise InputError(message.format(name_ids(np.flatnonzero(is_bad).tolist())))
