"""The nodes that triangulate and refine, as functions and in a graph."""

import subprocess
import sys

CODE = """
import numpy as np
import pytest
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import *

net = torus_mesh(12, 6)
triangles = triangulate(net)
assert triangles.n_faces == 144 and (triangles.degrees == 3).all()
assert (subdivide(triangles).degrees == 3).all()
assert (subdivide(net).degrees == 4).all()
assert subdivide(net, iterations=0).n_faces == 72
assert subdivide(net, "midpoint", 2).n_faces == 72 * 16
assert subdivide(triangles, "midpoint").n_faces == 144 * 4
assert subdivide(triangles, "catmull-clark").n_faces == 144 * 3
with pytest.raises(InputError, match="are no triangles"):
    subdivide(net, "loop")

even = remesh_triangles(net, 0.5)
assert (even.degrees == 3).all()
with pytest.warns(UserWarning, match="of the edges are between 0.5 and 1.6 times"):
    remesh_triangles(net, 3.0, crease_angle=0)
with pytest.raises(InputError, match="choose longer ones"):
    remesh_triangles(net, 1e-6)


g = Graph()
mesh = g.add(torus_mesh, n_around=12, n_across=6)
finer = g.add(subdivide, mesh=g.add(triangulate, mesh=mesh), scheme="loop", iterations=2)
assert g.run(finer).n_faces == 144 * 16
even = g.add(remesh_triangles, mesh=mesh, edge_length=0.5)
assert g.run(even).n_faces > 200
print("all well")
"""


def test_meshing_nodes() -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CODE], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "all well"
