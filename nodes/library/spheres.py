"""A sphere for every face to start from."""

from typing import Annotated

from ...kernel import fit
from ...kernel.mesh import Mesh
from ...kernel.sphere_mesh import SphereMesh
from ..node import node
from ..ports import Port


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
