"""Möbius transforms, and the coordinates on which they act."""

from typing import Annotated, NamedTuple, TypeVar

import numpy as np

from ...kernel.errors import InputError, name_ids
from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes.mobius import map_mesh, map_sphere_mesh
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres import minkowski, mobius_group, mobius_images, pentaspherical
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.circles import Circles
from ..graphs.node import node
from ..graphs.ports import Port
from .arrays import (
    Coordinates,
    Marks,
    Matrix,
    Points,
    Sphere,
    SpherePoints,
    Spheres,
    Transform,
    Vector,
)

Geometry = TypeVar("Geometry", SphereMesh, Mesh, Circles, Arcs, Points | Spheres)


@node
def inversion(center: Vector, radius: Annotated[float, Port(min=0)] = 1.0) -> Transform:
    """Inversion in a sphere: turns the model inside out about a point.

    Parameters
    ----------
    center : (3,) float array
        The point that is sent to infinity; spheres through it become planes.
    radius : float
        Radius of the sphere that stays in place.

    Returns
    -------
    (5, 5) float array
        The transform, for `apply_mobius` and `compose`.

    Examples
    --------
    >>> from spheremesh.nodes import apply_mobius, inversion
    >>> apply_mobius([[2.0, 0.0, 0.0]], inversion([0.0, 0.0, 0.0], radius=2.0))
    array([[2., 0., 0.]])
    >>> apply_mobius([[4.0, 0.0, 0.0]], inversion([0.0, 0.0, 0.0], radius=2.0))
    array([[1., 0., 0.]])
    """
    return mobius_group.inversion(center, radius)


@node
def similarity(
    scale: Annotated[float, Port(min=0)] = 1.0,
    rotation: Vector | Matrix | None = None,
    translation: Vector | None = None,
) -> Transform:
    """Scaling, then rotation, both about the origin, then translation.

    Parameters
    ----------
    scale : float
        Factor, more than 0.
    rotation : (3,) or (3, 3) float array, optional
        An axis whose length is the angle in degrees: (0, 0, 90) is a quarter turn about z,
        counter-clockwise seen from above. Or an orthogonal matrix. No rotation by default.
    translation : (3,) float array, optional
        Shift; none by default.

    Returns
    -------
    (5, 5) float array
        The transform, for `apply_mobius` and `compose`.

    Examples
    --------
    >>> from spheremesh.nodes import apply_mobius, similarity
    >>> apply_mobius([[1.0, 0.0, 0.0]], similarity(2.0, rotation=[0.0, 0.0, 90.0])).round(9)
    array([[0., 2., 0.]])
    """
    if rotation is not None and np.shape(rotation) == (3,):
        rotation = mobius_group.rotation_about(np.radians(rotation))
    return mobius_group.similarity(scale, rotation, translation)


@node
def reflection(mirror: Sphere) -> Transform:
    """Reflection in a plane, or inversion in a sphere, given as a row.

    Parameters
    ----------
    mirror : (5,) float array
        Row (A, Bx, By, Bz, C) of a real sphere or plane.

    Returns
    -------
    (5, 5) float array
        The transform, its own inverse.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import apply_mobius, reflection
    >>> ground = reflection(np.array([0.0, 0, 0, 1, 0]))
    >>> apply_mobius(np.array([[1.0, 2, 3]]), ground).tolist()
    [[1.0, 2.0, -3.0]]
    """
    return mobius_group.reflection(mirror)


@node
def inverse(transform: Transform) -> Transform:
    """The transform that undoes another.

    Parameters
    ----------
    transform : (5, 5) float array

    Returns
    -------
    (5, 5) float array
        The transform, for `apply_mobius` and `compose`.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import apply_mobius, inverse, similarity
    >>> back = inverse(similarity(translation=[0, 0, 1]))
    >>> apply_mobius(np.array([[0.0, 0, 1]]), back).tolist()
    [[0.0, 0.0, 0.0]]
    """
    return mobius_group.inverse(transform)


@node
def sent_to_infinity(points: Points, transform: Transform) -> Marks:
    """Which points a transform sends to infinity: `apply_mobius` refuses them.

    Parameters
    ----------
    points : (N, 3) float array
    transform : (5, 5) float array

    Returns
    -------
    (N,) bool array
        True for the centre of an inversion, up to rounding.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import inversion, sent_to_infinity
    >>> sent_to_infinity(np.array([[1.0, 0, 0], [2, 0, 0]]), inversion([1, 0, 0])).tolist()
    [True, False]
    """
    return mobius_images.sent_to_infinity(points, transform)


@node
def compose(transforms: list[Transform]) -> Transform:
    """One transform that does what several do one after another.

    Parameters
    ----------
    transforms : list of (5, 5) float array
        Transforms, the first is applied first.

    Returns
    -------
    (5, 5) float array
        The transform.

    Examples
    --------
    >>> from spheremesh.nodes import apply_mobius, compose, similarity
    >>> twice = compose([similarity(scale=2.0), similarity(translation=[1.0, 0.0, 0.0])])
    >>> apply_mobius([[1.0, 0.0, 0.0]], twice)
    array([[3., 0., 0.]])
    """
    return mobius_group.compose(transforms)


@node
def apply_mobius(geometry: Geometry, transform: Transform) -> Geometry:
    """Carry geometry through a transform; the angles between spheres stay as they are.

    Parameters
    ----------
    geometry : SphereMesh, Mesh, Circles, Arcs, (N, 3) or (N, 5) float array
        A sphere mesh, a mesh (its vertices are carried along), circles, arcs, points or rows of
        spheres.
    transform : (5, 5) float array

    Returns
    -------
    SphereMesh, Mesh, Circles, Arcs, (N, 3) or (N, 5) float array
        The same kind, elements in the same order. Where the transform turns right into left,
        as every inversion does, faces run the other way round: outside stays outside.

    Examples
    --------
    >>> from spheremesh.nodes import apply_mobius, inversion
    >>> apply_mobius([[2.0, 0.0, 0.0]], inversion([0.0, 0.0, 0.0]))
    array([[0.5, 0. , 0. ]])
    """
    if isinstance(geometry, SphereMesh):
        return map_sphere_mesh(geometry, transform)
    if isinstance(geometry, Mesh):
        return map_mesh(geometry, transform)
    if isinstance(geometry, Circles):
        return mobius_images.map_circles(geometry, transform)
    if isinstance(geometry, Arcs):
        return mobius_images.map_arcs(geometry, transform)
    rows = np.asarray(geometry, float)
    if rows.ndim != 2 or rows.shape[1] not in {3, 5}:
        raise InputError(
            f"geometry must be points (N, 3) or rows of spheres (N, 5), not {rows.shape}"
        )
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise InputError(f"rows {name_ids(bad.tolist())} of the geometry are not finite")
    if rows.shape[1] == 3:
        return mobius_images.map_points(rows, transform)
    return mobius_images.map_spheres(rows, transform)


class Poles(NamedTuple):
    """Poles of spheres with respect to the unit 3-sphere."""

    poles: SpherePoints
    is_infinite: Marks


@node
def stereographic(points: Points) -> SpherePoints:
    """Stereographic image of points on the unit 3-sphere, from its north pole.

    Parameters
    ----------
    points : (N, 3) float array

    Returns
    -------
    (N, 4) float array
        Points of norm 1.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import stereographic
    >>> stereographic(np.array([[1.0, 0, 0], [0, 0, 0]])).tolist()
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, -1.0]]
    """
    return pentaspherical.stereographic(points)


@node
def inverse_stereographic(points: SpherePoints) -> Points:
    """Central projection from the north pole of the unit 3-sphere back to space.

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
    >>> import numpy as np
    >>> from spheremesh.nodes import inverse_stereographic, stereographic
    >>> inverse_stereographic(stereographic(np.array([[1.0, 2, 2]]))).round(9).tolist()
    [[1.0, 2.0, 2.0]]
    """
    return pentaspherical.inverse_stereographic(points)


@node
def poles(spheres: Spheres) -> Poles:
    """Poles of the stereographic images of spheres: the points of projective four-space.

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
    >>> import numpy as np
    >>> from spheremesh.nodes import inverse_stereographic, poles, sphere_rows
    >>> found = poles(sphere_rows(np.array([[1.0, 2, 3]]), 2.0)).poles
    >>> inverse_stereographic(found).round(9).tolist()
    [[1.0, 2.0, 3.0]]
    """
    return Poles(*pentaspherical.pole(spheres))


@node
def pentaspherical_coordinates(spheres: Spheres) -> Coordinates:
    """Coordinates (B, C - A, C + A) of spheres, on which Möbius transforms act as matrices.

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
    >>> import numpy as np
    >>> from spheremesh.nodes import pentaspherical_coordinates
    >>> pentaspherical_coordinates(np.array([[0.0, 0, 0, 1, 3]])).tolist()
    [[0.0, 0.0, 1.0, 3.0, 3.0]]
    """
    return pentaspherical.pentaspherical(spheres)


@node
def polar_hyperplanes(spheres: Spheres) -> Coordinates:
    """Coefficients of the rows that are orthogonal to spheres.

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
    >>> import numpy as np
    >>> from spheremesh.nodes import polar_hyperplanes
    >>> polar_hyperplanes(np.array([[0.0, 0, 0, 1, 3]])).tolist()
    [[-6.0, 0.0, 0.0, 1.0, -0.0]]
    """
    return minkowski.minkowski_gradient(spheres)
