"""The nodes of the model change, as functions and in a graph."""

import subprocess
import sys

CODE = """
import numpy as np
import pytest
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import *

net = torus_mesh(12, 6)
for geometry, kind in (("hyperbolic", "real"), ("elliptic", "imaginary")):
    for branch in ("inner", "outer"):
        image = model_change(net, geometry, 3.5, [0.1, 0.2, 0.3], branch)
        found = support_type(image)
        assert found.kind == kind and found.residual < 1e-14, found
        center = found.omega[1:4] / (2 * found.omega[0])
        np.testing.assert_allclose(center, [0.1, 0.2, 0.3], atol=1e-12)
        assert vertex_error(image).max() < 1e-12
found = support_type(sphere_bundle(net, [0, 0, 2], 1.5))
assert found.kind == "point"
np.testing.assert_allclose(found.omega, [1, 0, 0, 4, 4], atol=1e-12)
assert support_type(fit_spheres(net)).kind == "none"
default = model_change(net, radius=4)
np.testing.assert_array_equal(
    default.spheres, model_change(net, "hyperbolic", 4.0, (0, 0, 0), "inner").spheres
)
with pytest.raises(InputError, match="a radius of at least 3 about this centre"):
    model_change(net)

g = Graph()
mesh = g.add(torus_mesh, n_around=12, n_across=6)
image = g.add(model_change, mesh=mesh, geometry="elliptic", radius=2, center=[0, 0, 1])
found = g.add(support_type, sphere_mesh=image)
assert g.run(found.kind) == "imaginary"
bundle = g.add(sphere_bundle, mesh=mesh, center=[0, 0, 1], radius=2)
assert g.run(g.add(support_type, sphere_mesh=bundle).kind) == "point"
print("all well")
"""


def test_model_nodes() -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CODE], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "all well"
