"""Numbers that tell how good a sphere mesh is."""

from typing import Literal

import numpy as np

from ...kernel import sphere_mesh as measures
from ...kernel.arrays import FloatArray
from ...kernel.fit import face_planes
from ...kernel.sphere_mesh import SphereMesh
from ..node import node


@node
def intersection_angles(
    sphere_mesh: SphereMesh, reference: Literal["spheres", "planes"] = "spheres"
) -> FloatArray:
    """
    Angle at which neighbouring faces meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    reference : {"spheres", "planes"}
        Measure between the spheres, or between the planes of the faces, to compare.

    Returns
    -------
    (E,) float array
        Degrees over the interior edges: 0 smooth, 180 a spike.
    """
    subject = sphere_mesh if reference == "spheres" else face_planes(sphere_mesh.mesh)
    return np.degrees(measures.intersection_angles(subject))


@node
def vertex_error(sphere_mesh: SphereMesh) -> FloatArray:
    """
    Distance of each vertex from the spheres of its faces.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    (V,) float array
        The largest distance of each vertex, in model units.
    """
    return measures.vertex_error(sphere_mesh)
