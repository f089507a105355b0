"""Arcs that do not exist are no reason to divide by zero."""

import numpy as np

from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.arcs import sphere_arcs
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.surfaces.circular_nets import vase_net


def test_plane_cut_by_itself() -> None:
    row = np.array([[0.0, 0.0, 0.0, 1.0, 0.0]])
    start, end = np.array([[0.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
    assert sphere_arcs(row, np.array([[0.0, 0.0, 1.0]]), start, end).sagittas == 0
    assert sphere_arcs(row, np.array([[0.0, 1.0, 0.0]]), start, start).sagittas == 0


def test_planes_among_spheres_that_meet_them_in_circles() -> None:
    """A plane panel cannot be cut by its own plane: it is cut upright, without a warning."""
    mesh = vase_net(12, 6, 2.0, 6.0, 0.3)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.full(mesh.n_faces, -0.3)
    angles[20] = 0.0
    sphere_mesh = SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))
    panels, rejected = cut_panels(sphere_mesh, edges="intersection")
    assert panels.n_panels + len(rejected) == mesh.n_faces
    assert 20 in panels.face_ids
