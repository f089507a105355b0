"""The nodes of the spheres category hand out what the kernel finds."""

import numpy as np

from spheremesh.kernel.sphere_meshes import central_spheres, smoothed_spheres
from spheremesh.kernel.surfaces.circular_nets import vase_net
from spheremesh.nodes.library import spheres


def test_principal_spheres_are_two_outputs() -> None:
    mesh = vase_net(12, 8, 1.0, 3.0, 0.3)
    found, expected = spheres.principal_spheres(mesh), central_spheres.principal_spheres(mesh)
    np.testing.assert_array_equal(found.first.spheres, expected[0].spheres)
    np.testing.assert_array_equal(found.second.spheres, expected[1].spheres)
    assert np.abs(found.first.spheres - found.second.spheres).max() > 0.1


def test_central_and_smoothed_spheres_are_those_of_the_kernel() -> None:
    mesh = vase_net(12, 8, 1.0, 3.0, 0.3)
    for node, rule in (
        (spheres.central_spheres, central_spheres.central_spheres),
        (spheres.smoothed_spheres, smoothed_spheres.smoothed_spheres),
    ):
        np.testing.assert_array_equal(node(mesh).spheres, rule(mesh).spheres)
