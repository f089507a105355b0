"""A sphere for every face to start from."""

from typing import Annotated, NamedTuple

from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes import central_spheres as central
from ...kernel.sphere_meshes import fit
from ...kernel.sphere_meshes import smoothed_spheres as smoothing
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..graphs.node import node
from ..graphs.ports import Port


class PrincipalSpheres(NamedTuple):
    """Two sphere meshes, one per direction."""

    first: SphereMesh
    second: SphereMesh


@node
def face_planes(mesh: Mesh) -> SphereMesh:
    """
    The plane of every face: the start that any mesh allows, and the one to compare with.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    SphereMesh
        Planes through the centroids of the faces.
    """
    return fit.face_planes(mesh)


@node
def fit_spheres(mesh: Mesh, ring: Annotated[int, Port(min=0, max=10)] = 1) -> SphereMesh:
    """
    Spheres by least squares on each face and the faces around it.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    ring : int
        How many rings of faces around each face take part.

    Returns
    -------
    SphereMesh
        On circular faces spheres through the circle, else the best of all (Pratt's norm).
    """
    return fit.fit_spheres(mesh, ring)


@node
def central_spheres(mesh: Mesh) -> SphereMesh:
    """
    Spheres of the mean curvature at each face of a circular mesh, a start close to the optimum.

    Parameters
    ----------
    mesh : Mesh
        Every face needs a circumcircle; quads along curvature lines are best.

    Returns
    -------
    SphereMesh
        Discrete central spheres: a Möbius map of the mesh maps them along.
    """
    return central.central_spheres(mesh)


@node
def smoothed_spheres(mesh: Mesh) -> SphereMesh:
    """
    Spheres through the circle of each face and an apex above it, placed by smoothing.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree; those without a circumcircle take the best circle.

    Returns
    -------
    SphereMesh
        Spheres somewhat flatter than the central ones.
    """
    return smoothing.smoothed_spheres(mesh)


@node
def principal_spheres(mesh: Mesh) -> PrincipalSpheres:
    """
    Spheres that follow the curvature of a circular quad mesh in one direction each.

    Parameters
    ----------
    mesh : Mesh
        Quads, every one with a circumcircle.

    Returns
    -------
    first : SphereMesh
        Spheres of the curvature across two opposite sides of each quad, in the same direction
        along every strip of quads.
    second : SphereMesh
        Those across the other two sides.
    """
    return PrincipalSpheres(*central.principal_spheres(mesh))
