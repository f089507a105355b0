"""Finer and coarser patterns of one surface."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.subdivision import subdivide_midpoint
from spheremesh.kernel.meshes.triangulation import triangulate
from spheremesh.kernel.patterns.scales import coarsen_pattern, refine_pattern
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net


def sites(mesh: Mesh) -> set[tuple[float, ...]]:
    return {tuple(place) for place in np.round(mesh.vertices, 9).tolist()}


def square(n: int) -> Mesh:
    """A bent sheet of n by n quads."""
    u, v = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a = (i * (n + 1) + j).ravel()
    points = np.stack([u, v, -0.02 * u**2 - 0.01 * v**2], -1).reshape(-1, 3)
    return Mesh(points, np.stack([a, a + n + 1, a + n + 2, a + 1], 1))


@pytest.mark.parametrize("mesh", [torus_net(10, 6, 3.0, 1.0), square(4), square(3)])
def test_law_coarsening_takes_refining_back(mesh: Mesh) -> None:
    fine = refine_pattern(fit_spheres(mesh))
    assert fine.mesh.n_faces == 4 * mesh.n_faces
    assert sites(mesh) <= sites(fine.mesh)
    back = coarsen_pattern(fine)
    assert back.n_single == 0
    assert back.net.mesh.n_faces == mesh.n_faces
    if mesh.topology.is_boundary_vertex.any():  # on a closed net others are as good
        assert sites(back.net.mesh) == sites(mesh)


def test_law_finer_vertices_lie_on_the_spheres() -> None:
    coarse = ellipsoid_net(12, 6, 2.0, 2.0, 1.2)
    ball = fit_spheres(coarse)
    fine = refine_pattern(ball)
    assert norm(fine.mesh.vertices) == pytest.approx(np.full(fine.mesh.n_vertices, 2.0))
    triangles = refine_pattern(fit_spheres(triangulate(coarse)))
    assert set(triangles.mesh.degrees.tolist()) == {3}
    assert norm(triangles.mesh.vertices) == pytest.approx(
        np.full(triangles.mesh.n_vertices, 2.0)
    )


def test_scales_change_smoothness_as_the_edge_does() -> None:
    net = central_spheres(torus_net(16, 8, 3.0, 1.0))
    angle = intersection_angles(net).mean()
    fine, coarse = refine_pattern(net), coarsen_pattern(net).net
    assert intersection_angles(fine).mean() < 0.65 * angle
    assert 1.6 * angle < intersection_angles(coarse).mean() < 2.4 * angle
    assert sites(coarse.mesh) <= sites(net.mesh)
    x, y, z = fine.mesh.vertices.T
    off = np.abs(np.hypot(np.hypot(x, y) - 3.0, z) - 1.0)
    flat = subdivide_midpoint(net.mesh).vertices
    lost = np.abs(np.hypot(np.hypot(flat[:, 0], flat[:, 1]) - 3.0, flat[:, 2]) - 1.0)
    assert off.max() < 0.85 * lost.max()


@settings(max_examples=3)
@given(st.integers(0, 99), st.floats(-2, 2))
def test_law_nothing_depends_on_units_place_and_numbers(seed: int, exponent: float) -> None:
    rng, mesh, scale = np.random.default_rng(seed), square(4), 10.0**exponent
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    order = rng.permutation(mesh.n_vertices)
    place = np.argsort(order)
    faces = place[mesh.corners.reshape(-1, 4)][rng.permutation(mesh.n_faces)]
    moved = Mesh((scale * mesh.vertices @ turn.T + rng.normal(size=3))[order], faces)
    before, after = (coarsen_pattern(fit_spheres(each)).net for each in (mesh, moved))
    assert after.mesh.n_faces == before.mesh.n_faces
    mean = [float(intersection_angles(each).mean()) for each in (before, after)]
    assert mean[1] == pytest.approx(mean[0], rel=0.05)
    fine = [refine_pattern(fit_spheres(each)) for each in (mesh, moved)]
    mean = [float(intersection_angles(each).mean()) for each in fine]
    assert mean[1] == pytest.approx(mean[0], rel=1e-5)


def test_patterns_with_singular_points_keep_a_few_faces() -> None:
    net = fit_spheres(refine_pattern(fit_spheres(ellipsoid_net(8, 4, 1.0, 1.4, 1.0))).mesh)
    coarse = coarsen_pattern(net)
    assert coarse.net.mesh.n_faces < 0.45 * net.mesh.n_faces
    assert coarse.net.mesh.topology.is_boundary_vertex.any() == (
        net.mesh.topology.is_boundary_vertex.any()
    )


def test_patterns_without_room_are_refused() -> None:
    one = SphereMesh(square(1), fit_spheres(square(1)).spheres)
    with pytest.raises(InputError, match="too small"):
        coarsen_pattern(one)
