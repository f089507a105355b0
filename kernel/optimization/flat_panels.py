"""Panels that bulge less than an eye can tell, as planes."""

import numpy as np

from ..arrays import BoolArray
from ..errors import InputError
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.circles import circle_pencils, face_circles, pencil_spheres
from .angle_minimization import pencil_angles


def flatten_shallow(sphere_mesh: SphereMesh, sagitta: float) -> tuple[SphereMesh, BoolArray]:
    """Replace spheres that rise less than a sagitta over the circles of their faces by planes.

    Parameters
    ----------
    sagitta : float
        In the unit of the mesh; 0 changes nothing.

    Returns
    -------
    sphere_mesh : SphereMesh
        The same mesh and other spheres.
    is_flattened : (F,) bool array
        Faces whose spheres became planes; those that were planes before are none.

    Raises
    ------
    InputError
        If the sagitta is negative or not finite.

    Notes
    -----
    Over a circle of radius ρ the member t of its pencil rises by ``ρ tan(|t| / 2)``.
    """
    if not 0 <= sagitta < np.inf:
        raise InputError(f"a sagitta is a length of 0 or more, not {sagitta}")
    circles, _ = face_circles(sphere_mesh.mesh)
    angles = pencil_angles(sphere_mesh, circles)
    rises = np.sqrt(circles.radii_squared) * np.tan(np.abs(angles) / 2)
    is_flattened = (rises < sagitta) & (sphere_mesh.local_spheres[:, 0] != 0)
    rows = sphere_mesh.local_spheres.copy()
    planes, great_spheres = circle_pencils(circles)
    flat = pencil_spheres(planes, great_spheres, np.zeros_like(angles))
    rows[is_flattened] = flat[is_flattened]
    return SphereMesh.from_local(sphere_mesh.mesh, rows), is_flattened
