"""Sphere meshes with a support structure by construction, and how to recognise them."""

from typing import Literal, NamedTuple

import numpy as np

from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes import model_change as models
from ...kernel.sphere_meshes import support_type as support
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..graphs.node import node
from ..graphs.ports import Length
from .arrays import Sphere, Vector


class SupportType(NamedTuple):
    """The sphere to which all spheres of a mesh are orthogonal."""

    kind: str
    omega: Sphere
    residual: float


@node
def model_change(
    mesh: Mesh,
    geometry: Literal["hyperbolic", "elliptic"] = "hyperbolic",
    radius: Length = 1.0,
    center: Vector | None = None,
    branch: Literal["inner", "outer"] = "inner",
) -> SphereMesh:
    """Turn planar faces into spheres that meet a fixed one at right angles or in great circles.

    Parameters
    ----------
    mesh : Mesh
        Planar faces of any degree: triangles, planar quads or hexagons.
    geometry : {"hyperbolic", "elliptic"}
        Spheres at a right angle to the fixed sphere (the mesh must lie inside it), or spheres
        that meet it in great circles.
    radius : float
        Radius of the fixed sphere; the larger, the less changes.
    center : (3,) float array, optional
        Centre of the fixed sphere, through which all support beams point; the origin by
        default.
    branch : {"inner", "outer"}
        The result inside or outside the fixed sphere.

    Returns
    -------
    SphereMesh
        Vertices and faces keep their ids; the mesh has a support structure without torsion.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, model_change, support_type
    >>> sphere_mesh = model_change(ellipsoid_mesh(12, 6), radius=4.0)
    >>> support_type(sphere_mesh).kind
    'real'
    """
    origin = np.zeros(3) if center is None else center
    return models.change_model(mesh, geometry, radius, origin, branch)


@node
def sphere_bundle(mesh: Mesh, center: Vector, radius: Length = 1.0) -> SphereMesh:
    """Turn planar faces into spheres through one point, by an inversion.

    Parameters
    ----------
    mesh : Mesh
        Planar faces of any degree.
    center : (3,) float array
        The point; not on a face.
    radius : float
        Radius of the sphere that stays in place.

    Returns
    -------
    SphereMesh
        Vertices and faces keep their ids; the mesh has a support structure without torsion.

    Examples
    --------
    >>> from spheremesh.nodes import sphere_bundle, support_type, vase_mesh
    >>> support_type(sphere_bundle(vase_mesh(12, 6), center=[0.0, 0.0, 5.0])).kind
    'point'
    """
    return models.sphere_bundle(mesh, center, radius)


@node
def support_type(sphere_mesh: SphereMesh) -> SupportType:
    """Find the sphere or point that all spheres of a mesh are orthogonal to.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    kind : str
        "real" (all spheres meet it at right angles), "imaginary" (all meet it in great
        circles), "point" (all pass through it), "plane" (all are centred on it), "infinity"
        (all are planes) or "none".
    omega : (5,) float array
        Row (A, Bx, By, Bz, C) of the sphere, plane or point; of none the one that comes
        nearest. The planes and axes of the support structure pass through its centre.
    residual : float
        How far the spheres miss it: 0 exact, above 0.0003 none.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, sphere_bundle, support_type, vase_mesh
    >>> support_type(fit_spheres(vase_mesh(12, 6))).kind
    'none'
    >>> support_type(sphere_bundle(vase_mesh(12, 6), center=[0.0, 0.0, 5.0])).kind
    'point'
    """
    found = support.support_type(sphere_mesh)
    return SupportType(found.kind, found.omega, found.residual)
