"""Cells at the boundary that cross themselves lose the corner that no other cell needs."""

import numpy as np

from ..arrays import IntArray
from ..meshes.mesh import Mesh
from ..sphere_meshes.sphere_mesh import SphereMesh

FEWEST_CORNERS = 3
"""Corners that a cell keeps."""


def without_loose_corners(net: SphereMesh, faces: IntArray) -> SphereMesh:
    """A net whose given faces have no corners that belong to them alone.

    Spheres and all other nodes stay as they are, so that planar nodes stay planar; triangles
    keep their corners.
    """
    mesh = net.mesh
    is_chosen = np.zeros(mesh.n_faces, bool)
    is_chosen[faces] = True
    of_corners = mesh.topology.corner_faces
    valence = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    is_loose = (valence[mesh.corners] == 1) & is_chosen[of_corners]
    left = mesh.degrees - np.bincount(of_corners[is_loose], minlength=mesh.n_faces)
    is_loose &= (left >= FEWEST_CORNERS)[of_corners]
    if not is_loose.any():
        return net
    kept = ~is_loose
    degrees = np.bincount(of_corners[kept], minlength=mesh.n_faces)
    used, corners = np.unique(mesh.corners[kept], return_inverse=True)
    pieces = np.split(corners.ravel(), np.cumsum(degrees)[:-1])
    return SphereMesh(Mesh(mesh.vertices[used], pieces), net.spheres)
