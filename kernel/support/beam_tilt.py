"""Tilt of the beams that lie in the planes where neighbouring spheres meet."""

import numpy as np

from ..arrays import FloatArray, norm
from ..panels.cutting import cutting_planes, flatten_nearly_plane
from ..sphere_meshes.sphere_mesh import SphereMesh


def beam_tilt(sphere_mesh: SphereMesh) -> FloatArray:
    """Angle between the plane in which two spheres meet and the plane that bisects them.

    (E,) radians over the interior edges, from 0 (upright) to π/2 (tangential). Where spheres
    share no circle, because they are the same or one is a plane, the beam is upright.

    References
    ----------
    Meshes with Spherical Faces, Fig. 26 and 28.
    """
    flat = flatten_nearly_plane(sphere_mesh)
    upright, _ = cutting_planes(flat, "bisector")
    circle, _ = cutting_planes(flat, "intersection")
    first = sphere_mesh.mesh.topology.edge_corners
    n, m = upright[first], circle[first]
    angles = 2 * np.arctan2(norm(n - m), norm(n + m))
    return np.minimum(angles, np.pi - angles)
