"""Spheres, planes and circles one by one: rows, angles, pencils, stereographic images."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.sphere_meshes import central_spheres
from ...kernel.spheres import circles, incidence, minkowski, pentaspherical, rows
from ..graphs.node import node


class SphereFacts(NamedTuple):
    """What rows stand for."""

    centers: FloatArray
    radii_squared: FloatArray
    kinds: NDArray[np.str_]


class SpherePairs(NamedTuple):
    """How spheres meet."""

    angles: FloatArray
    pencils: NDArray[np.str_]
    is_orthogonal: BoolArray
    is_tangent: BoolArray


class Bisectors(NamedTuple):
    """Both bisectors of pairs of spheres."""

    acute: FloatArray
    obtuse: FloatArray


class Poles(NamedTuple):
    """Poles of spheres with respect to the unit 3-sphere."""

    poles: FloatArray
    is_infinite: BoolArray


@node
def sphere_rows(centers: FloatArray, radii: float | FloatArray) -> FloatArray:
    """
    Rows (A, Bx, By, Bz, C) of spheres: the points x with A x·x - B·x + C = 0.

    Parameters
    ----------
    centers : (N, 3) float array
    radii : float or (N,) float array
        Not zero.

    Returns
    -------
    (N, 5) float array
        Rows with B·B - 4 A C = 1, whose normals point to the centres; minus the row is the
        sphere with normals outwards.

    Examples
    --------
    >>> sphere_rows(np.zeros((1, 3)), 2.0).tolist()
    [[0.25, 0.0, 0.0, 0.0, -1.0]]
    """
    radii = np.broadcast_to(np.asarray(radii, float), np.shape(centers)[:-1])
    return rows.normalize(rows.from_center_radius(centers, radii**2))


@node
def plane_rows(normals: FloatArray, distances: float | FloatArray) -> FloatArray:
    """
    Rows (0, n, d) of the planes n·x = d.

    Parameters
    ----------
    normals : (N, 3) float array
        Unit normals.
    distances : float or (N,) float array
        Signed distances of the origin, along the normals.

    Returns
    -------
    (N, 5) float array
        Rows with A = 0.

    Examples
    --------
    >>> plane_rows(np.array([[0.0, 0.0, 1.0]]), 3.0).tolist()
    [[0.0, 0.0, 0.0, 1.0, 3.0]]
    """
    return rows.from_plane(normals, np.asarray(distances, float))


@node
def sphere_facts(spheres: FloatArray) -> SphereFacts:
    """
    Centres, squared radii and kinds of rows.

    Parameters
    ----------
    spheres : (N, 5) float array
        Rows of any scale.

    Returns
    -------
    centers : (N, 3) float array
        Infinite for planes.
    radii_squared : (N,) float array
        Infinite for planes, negative for imaginary spheres.
    kinds : (N,) str array
        "sphere", "plane", "point" or "imaginary".

    Examples
    --------
    >>> sphere_facts(plane_rows(np.array([[0.0, 0.0, 1.0]]), 3.0)).kinds.tolist()
    ['plane']
    """
    names = np.array([kind.name.lower() for kind in rows.Kind])
    return SphereFacts(*rows.center_radius(spheres), names[rows.kind(spheres)])


@node
def signed_distance(spheres: FloatArray, points: FloatArray) -> FloatArray:
    """
    Distances of points from spheres and planes.

    Parameters
    ----------
    spheres : (N, 5) float array
        Unit rows.
    points : (N, 3) float array
        One for each sphere.

    Returns
    -------
    (N,) float array
        Positive on the side to which the normal of the sphere points.

    Examples
    --------
    >>> ball = sphere_rows(np.zeros((1, 3)), 2.0)
    >>> signed_distance(ball, np.array([[0.0, 0.0, 5.0]])).tolist()
    [-3.0]
    """
    return incidence.signed_distance(spheres, points)


@node
def sphere_pairs(first: FloatArray, second: FloatArray) -> SpherePairs:
    """
    Angles at which spheres or planes meet, and the pencils that they span.

    Parameters
    ----------
    first, second : (N, 5) float array
        Unit rows of real spheres or planes.

    Returns
    -------
    angles : (N,) float array in deg
        Between the normals, from 0 to 180; 0 or 180 also where they do not meet.
    pencils : (N,) str array
        "elliptic" (they meet in a circle), "parabolic" (in a point) or "hyperbolic" (not).
    is_orthogonal, is_tangent : (N,) bool array
        Up to rounding.

    Examples
    --------
    >>> sphere_pairs(*sphere_rows(np.array([[0.0, 0, 0], [0, 0, 4]]), 2.0)[:, None]).pencils
    array(['parabolic'], dtype='<U10')
    """
    kinds = circles.pencil_kind(first, second)
    names = np.array([kind.name.lower() for kind in circles.PencilKind])
    return SpherePairs(
        np.degrees(minkowski.angle(first, second)),
        names[kinds],
        minkowski.is_orthogonal(first, second),
        kinds == circles.PencilKind.PARABOLIC,
    )


@node
def bisectors(first: FloatArray, second: FloatArray) -> Bisectors:
    """
    Both spheres that bisect the angles of two spheres or planes.

    Parameters
    ----------
    first, second : (N, 5) float array
        Unit rows of spheres or planes that meet.

    Returns
    -------
    acute, obtuse : (N, 5) float array
        Unit rows of the bisectors of the smaller and of the larger angle, orthogonal to each
        other; NaN where nothing is bisected.

    Examples
    --------
    >>> bisectors(*plane_rows(np.eye(3)[:2], 0.0)[:, None]).acute.round(3).tolist()
    [[0.0, 0.707, 0.707, 0.0, 0.0]]
    """
    return Bisectors(*central_spheres.bisectors(first, second))


@node
def intersection_circles(first: FloatArray, second: FloatArray) -> circles.Circles:
    """
    Circles in which spheres meet.

    Parameters
    ----------
    first, second : (N, 5) float array
        Unit rows; at most one of two is a plane.

    Returns
    -------
    Circles
        Centres, normals from the first centre to the second, and squared radii; negative where
        the spheres do not meet.

    Examples
    --------
    >>> balls = sphere_rows(np.array([[0.0, 0, 0], [0, 0, 2]]), np.sqrt(2))
    >>> intersection_circles(*balls[:, None]).radii_squared.round(9).tolist()
    [1.0]
    """
    return circles.intersection_circles(first, second)


@node
def sphere_through_points(points: FloatArray) -> FloatArray:
    """
    Spheres or planes through four points.

    Parameters
    ----------
    points : (N, 4, 3) float array
        Points, no four on a circle.

    Returns
    -------
    (N, 5) float array
        Unit rows of either orientation.

    Examples
    --------
    >>> corners = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0]])
    >>> sphere_facts(sphere_through_points(corners[None])).radii_squared.round(9).tolist()
    [1.0]
    """
    return circles.sphere_through_points(points)


@node
def stereographic(points: FloatArray) -> FloatArray:
    """
    Stereographic image of points on the unit 3-sphere, from its north pole.

    Parameters
    ----------
    points : (N, 3) float array

    Returns
    -------
    (N, 4) float array
        Points of norm 1.

    Examples
    --------
    >>> stereographic(np.array([[1.0, 0, 0], [0, 0, 0]])).tolist()
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, -1.0]]
    """
    return pentaspherical.stereographic(points)


@node
def inverse_stereographic(points: FloatArray) -> FloatArray:
    """
    Central projection from the north pole of the unit 3-sphere back to space.

    Parameters
    ----------
    points : (N, 4) float array
        Points of the 3-sphere, or poles of spheres, whose centres come out.

    Returns
    -------
    (N, 3) float array
        Points; infinite for the north pole.

    Examples
    --------
    >>> inverse_stereographic(stereographic(np.array([[1.0, 2, 2]]))).round(9).tolist()
    [[1.0, 2.0, 2.0]]
    """
    return pentaspherical.inverse_stereographic(points)


@node
def poles(spheres: FloatArray) -> Poles:
    """
    Poles of the stereographic images of spheres: the points of projective four-space.

    Parameters
    ----------
    spheres : (N, 5) float array
        Rows of any scale.

    Returns
    -------
    poles : (N, 4) float array
        Points; directions of those at infinity.
    is_infinite : (N,) bool array
        Where the image is a great sphere.

    Examples
    --------
    >>> found = poles(sphere_rows(np.array([[1.0, 2, 3]]), 2.0)).poles
    >>> inverse_stereographic(found).round(9).tolist()
    [[1.0, 2.0, 3.0]]
    """
    return Poles(*pentaspherical.pole(spheres))


@node
def pentaspherical_coordinates(spheres: FloatArray) -> FloatArray:
    """
    Coordinates (B, C - A, C + A) of spheres, on which Möbius transforms act as matrices.

    Parameters
    ----------
    spheres : (N, 5) float array
        Rows (A, B, C).

    Returns
    -------
    (N, 5) float array
        Of the same Minkowski product.

    Examples
    --------
    >>> pentaspherical_coordinates(plane_rows(np.array([[0.0, 0.0, 1.0]]), 3.0)).tolist()
    [[0.0, 0.0, 1.0, 3.0, 3.0]]
    """
    return pentaspherical.pentaspherical(spheres)


@node
def polar_hyperplanes(spheres: FloatArray) -> FloatArray:
    """
    Coefficients of the rows that are orthogonal to spheres.

    Parameters
    ----------
    spheres : (N, 5) float array
        Rows of spheres, planes or points.

    Returns
    -------
    (N, 5) float array
        Numbers h with h·s = 0 for the rows s of all spheres orthogonal to the given one; for a
        point those through it.

    Examples
    --------
    >>> polar_hyperplanes(plane_rows(np.array([[0.0, 0.0, 1.0]]), 3.0)).tolist()
    [[-6.0, 0.0, 0.0, 1.0, -0.0]]
    """
    return minkowski.minkowski_gradient(spheres)
