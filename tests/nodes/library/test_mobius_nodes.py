"""The nodes of the Möbius group, as functions and in a graph."""

import subprocess
import sys

CODE = """
import numpy as np
import pytest
import spheremesh as sm
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import *

quarter = similarity(rotation=np.array([0, 0, 90.0]), scale=2, translation=[0, 0, 1])
points = np.array([[1.0, 0, 0], [0, 1, 0]])
np.testing.assert_allclose(apply_mobius(points, quarter), [[0, 2, 1], [-2, 0, 1]], atol=1e-15)
turn = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
np.testing.assert_allclose(similarity(2, turn, [0, 0, 1]), quarter, atol=1e-15)
turned = inversion([3, 0, 0], 2)
both = compose([turned, quarter])
np.testing.assert_allclose(
    apply_mobius(points, both), apply_mobius(apply_mobius(points, turned), quarter), atol=1e-14
)
rows = apply_mobius(np.array([[0.5, 0, 0, 0, -0.5], [0, 1, 0, 0, 3]]), turned)
np.testing.assert_allclose(rows[1], [0, 1, 0, 0, 3], atol=1e-15)
assert rows.shape == (2, 5)

net = torus_mesh(12, 6, major_radius=3.0)
assert isinstance(apply_mobius(net, both), sm.Mesh)
carried = apply_mobius(face_planes(net), similarity())
assert isinstance(carried, sm.SphereMesh)
np.testing.assert_allclose(carried.mesh.vertices, net.vertices, atol=1e-15)

for geometry, transform, message in [
    (np.array([[3.0, 0, 0]]), turned, r"points \\[0\\] are sent to infinity"),
    (np.array([3.0, 0, 0]), turned, r"points \\(N, 3\\) or spheres \\(N, 5\\)"),
    (np.ones((2, 4)), turned, r"of shape \\(2, 4\\)"),
    (np.array([[0, np.nan, 0]]), turned, r"rows \\[0\\] of the geometry are not finite"),
    (points, 2 * turned, "no Möbius map"),
    (net, inversion(net.vertices[7], 1), r"vertices \\[7\\] are sent to infinity"),
]:
    with pytest.raises(InputError, match=message):
        apply_mobius(geometry, transform)

g = Graph()
mesh = g.add(torus_mesh, n_around=12, n_across=6)
start = g.add(fit_spheres, mesh=mesh)
move = g.add(similarity, rotation=[0, 0, 90], translation=[0, 0, 1])
turn = g.add(inversion, center=[5, 0, 0], radius=2)
whole = g.add(compose, transforms=[move, turn])
image = g.add(apply_mobius, geometry=start, transform=whole)
angles = [g.run(g.add(intersection_angles, sphere_mesh=s)).mean() for s in (start, image)]
assert abs(angles[0] - angles[1]) < 1e-9, angles
print("all well")
"""


def test_mobius_nodes() -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CODE], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "all well"
