"""Möbius transforms: they keep spheres, circles and the angles between them."""

from typing import Annotated, TypeVar

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.errors import InputError, name_ids
from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes.mobius import map_mesh, map_sphere_mesh
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres import mobius_group, mobius_images
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.circles import Circles
from ..graphs.node import node
from ..graphs.ports import Port

Geometry = TypeVar("Geometry", SphereMesh, Mesh, Circles, Arcs, FloatArray)


@node
def inversion(center: FloatArray, radius: Annotated[float, Port(min=0)] = 1.0) -> FloatArray:
    """
    Inversion in a sphere: turns the model inside out about a point.

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
    """
    return mobius_group.inversion(center, radius)


@node
def similarity(
    scale: Annotated[float, Port(min=0)] = 1.0,
    rotation: FloatArray | None = None,
    translation: FloatArray | None = None,
) -> FloatArray:
    """
    Scaling, then rotation, both about the origin, then translation.

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
    """
    if rotation is not None and np.shape(rotation) == (3,):
        rotation = mobius_group.rotation_about(np.radians(rotation))
    return mobius_group.similarity(scale, rotation, translation)


@node
def reflection(mirror: FloatArray) -> FloatArray:
    """
    Reflection in a plane, or inversion in a sphere, given as a row.

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
    >>> ground = reflection(np.array([0.0, 0, 0, 1, 0]))
    >>> apply_mobius(np.array([[1.0, 2, 3]]), ground).tolist()
    [[1.0, 2.0, -3.0]]
    """
    return mobius_group.reflection(mirror)


@node
def inverse(transform: FloatArray) -> FloatArray:
    """
    The transform that undoes another.

    Parameters
    ----------
    transform : (5, 5) float array

    Returns
    -------
    (5, 5) float array
        The transform, for `apply_mobius` and `compose`.

    Examples
    --------
    >>> back = inverse(similarity(translation=[0, 0, 1]))
    >>> apply_mobius(np.array([[0.0, 0, 1]]), back).tolist()
    [[0.0, 0.0, 0.0]]
    """
    return mobius_group.inverse(transform)


@node
def sent_to_infinity(points: FloatArray, transform: FloatArray) -> BoolArray:
    """
    Which points a transform sends to infinity: `apply_mobius` refuses them.

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
    >>> sent_to_infinity(np.array([[1.0, 0, 0], [2, 0, 0]]), inversion([1, 0, 0])).tolist()
    [True, False]
    """
    return mobius_images.sent_to_infinity(points, transform)


@node
def compose(transforms: list[FloatArray]) -> FloatArray:
    """
    One transform that does what several do one after another.

    Parameters
    ----------
    transforms : list of (5, 5) float array
        Transforms, the first is applied first.

    Returns
    -------
    (5, 5) float array
        The transform.
    """
    return mobius_group.compose(transforms)


@node
def apply_mobius(geometry: Geometry, transform: FloatArray) -> Geometry:
    """
    Carry geometry through a transform; the angles between spheres stay as they are.

    Parameters
    ----------
    geometry : SphereMesh, Mesh, Circles, Arcs, (N, 3) or (N, 5) float array
        A sphere mesh, a mesh (its vertices are carried along), circles, arcs, points or rows of
        spheres.
    transform : (5, 5) float array
        The transform.

    Returns
    -------
    SphereMesh, Mesh, Circles, Arcs, (N, 3) or (N, 5) float array
        The same kind, elements in the same order. Where the transform turns right into left,
        as every inversion does, faces run the other way round: outside stays outside.
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
