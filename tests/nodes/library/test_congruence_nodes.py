"""The nodes of sphere congruences: what they return, and when they warn."""

import numpy as np
import pytest

from spheremesh import Graph, Mesh
from spheremesh.kernel.arrays import norm
from spheremesh.nodes import NodeWarning, envelope, sphere_congruence, torus_mesh


def test_a_congruence_in_a_graph() -> None:
    graph = Graph()
    mesh = graph.add(torus_mesh, n_around=64, n_across=32, major_radius=3.0)
    spheres = graph.add(sphere_congruence, mesh=mesh, kind="tangent", offset=0.8)
    surfaces = graph.add(envelope, mesh=mesh, spheres=spheres)
    plus, is_real = graph.run(surfaces.points_plus, surfaces.is_real)
    assert plus.shape == (2048, 3)
    assert np.abs(np.hypot(norm(plus[:, :2]) - 3, plus[:, 2]) - 1).max() < 0.05
    assert is_real.all()


def test_kinds_and_offsets_per_vertex() -> None:
    mesh = torus_mesh(12, 6, major_radius=3.0)
    assert sphere_congruence(mesh).shape == (72, 5)
    assert not np.allclose(
        sphere_congruence(mesh, "principal"),
        sphere_congruence(mesh, "principal", which="second"),
    )
    rows = sphere_congruence(mesh, "tangent", np.linspace(1, 2, 72))
    np.testing.assert_allclose(rows[:, 0], 0.5 / np.linspace(1, 2, 72))


def test_spheres_that_do_not_meet_are_counted() -> None:
    mesh = torus_mesh(24, 12, major_radius=3.0)
    with pytest.warns(NodeWarning, match=r"% of the faces have no real envelope"):
        result = envelope(mesh, sphere_congruence(mesh, "tangent", 0.2))
    assert not result.is_real.any()
    assert np.isnan(result.points_minus).all()


def test_four_spheres_without_common_points_are_counted() -> None:
    mesh = torus_mesh(24, 12, major_radius=3.0)
    rows = sphere_congruence(mesh, "tangent", 2.0)
    rows[0] *= np.array([0.5, 1, 1, 1, 0])
    rows[0, 4] = rows[0, 1:4] @ mesh.vertices[0] - 2.0
    with pytest.warns(
        NodeWarning, match=r"on .* % of the faces the spheres have no two points"
    ):
        envelope(mesh, rows)


def test_a_mesh_too_small_for_curvatures_says_so() -> None:
    square = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    with pytest.warns(NodeWarning, match="100 % of the vertices have too few neighbours"):
        sphere_congruence(square)
