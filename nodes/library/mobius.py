"""Möbius transforms: they keep spheres, circles and the angles between them."""

from typing import Annotated, TypeVar

import numpy as np

from ...kernel.errors import InputError, name_ids
from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes.mobius import map_mesh, map_sphere_mesh
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres import mobius_group
from ...kernel.spheres.mobius_images import map_points, map_spheres
from ..graphs.node import node
from ..graphs.ports import Port
from .arrays import Matrix, Points, Spheres, Transform, Vector

Geometry = TypeVar("Geometry", SphereMesh, Mesh, Points | Spheres)


@node
def inversion(center: Vector, radius: Annotated[float, Port(min=0)] = 1.0) -> Transform:
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
    rotation: Vector | Matrix | None = None,
    translation: Vector | None = None,
) -> Transform:
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
def compose(transforms: list[Transform]) -> Transform:
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
def apply_mobius(geometry: Geometry, transform: Transform) -> Geometry:
    """
    Carry geometry through a transform; the angles between spheres stay as they are.

    Parameters
    ----------
    geometry : SphereMesh, Mesh, (N, 3) or (N, 5) float array
        A sphere mesh, a mesh (its vertices are carried along), points or rows of spheres.
    transform : (5, 5) float array
        The transform.

    Returns
    -------
    SphereMesh, Mesh, (N, 3) or (N, 5) float array
        The same kind, elements in the same order. Where the transform turns right into left,
        as every inversion does, faces run the other way round: outside stays outside.
    """
    if isinstance(geometry, SphereMesh):
        return map_sphere_mesh(geometry, transform)
    if isinstance(geometry, Mesh):
        return map_mesh(geometry, transform)
    rows = np.asarray(geometry, float)
    if rows.ndim != 2 or rows.shape[1] not in {3, 5}:
        raise InputError(
            f"geometry must be points (N, 3) or rows of spheres (N, 5), not {rows.shape}"
        )
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise InputError(f"rows {name_ids(bad.tolist())} of the geometry are not finite")
    if rows.shape[1] == 3:
        return map_points(rows, transform)
    return map_spheres(rows, transform)
