"""What leads a net onto its surface: slack, upright axes, curved facets, trimmed corners."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import norm, unit
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.patterns.curved_refinement import refined
from spheremesh.kernel.patterns.held_nets import (
    FARTHEST_NODE,
    held_nets,
    without_loose_corners,
)
from spheremesh.kernel.patterns.net_flaws import judge_net
from spheremesh.kernel.remesh.pipeline import remesh
from spheremesh.kernel.remesh.planar.conditions import (
    NetState,
    anywhere,
    on_surface,
    planar_system,
    upright,
)
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net
from spheremesh.kernel.surfaces.triangulated import triangulated_surface


def test_law_coarse_facets_of_a_sphere_become_the_sphere() -> None:
    coarse = ellipsoid_net(12, 6, 2.0, 2.0, 1.2)
    fine = refined(coarse, 0.2)
    assert mean_edge_length(fine) <= 0.2
    assert norm(fine.vertices) == pytest.approx(np.full(fine.n_vertices, 2.0), rel=0.01)
    assert fine.vertices[: coarse.n_vertices] == pytest.approx(coarse.vertices)
    assert refined(fine, 0.2) is fine
    bent = refined(torus_net(24, 12, 3.0, 1.0), 0.2)
    off = np.hypot(np.hypot(*bent.vertices[:, :2].T) - 3.0, bent.vertices[:, 2])
    assert off == pytest.approx(np.ones(len(off)), abs=0.01)


def test_flat_facets_and_creases_stay_as_they_are() -> None:
    roof = Mesh(
        np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 1], [0, 1, 1], [2, 2, 0], [0, 2, 0]]),
        [[0, 1, 2, 3], [3, 2, 4, 5]],
    )
    fine = refined(roof, 0.4)
    x, y, z = fine.vertices.T
    assert z == pytest.approx(1 - np.abs(y - 1))
    assert (x.min(), x.max()) == (0, 2)


@settings(max_examples=20)
@given(st.integers(0, 99), st.floats(0.05, 1.0))
def test_law_gradients_of_upright_axes(seed: int, largest: float) -> None:
    rng = np.random.default_rng(seed)
    count = 6
    up = unit(rng.normal(size=(count, 3)))
    site = upright(anywhere, up, largest)
    net = NetState(np.zeros((1, 5)), rng.normal(size=(count, 3)), rng.normal(size=(count, 4)))
    there, step = site(net), 1e-6 * rng.normal(size=(count, 4))
    moved = site(NetState(net.rows, net.shifts, net.normals + step))
    ahead = np.einsum("vki,vi->vk", there.slopes[..., 3:], step)
    assert moved.lengths - there.lengths == pytest.approx(ahead, abs=1e-9)
    assert not there.slopes[..., :3].any()
    slim = NetState(net.rows, net.shifts, np.concatenate([np.ones((count, 1)), up], 1))
    assert not site(slim).lengths.any()


def test_law_slack_is_how_far_nodes_may_be_off() -> None:
    mesh, _ = triangulated_surface("annulus", 0.15)
    found = remesh(mesh, sphere_congruence(mesh, "tangent", 2.0)[0], 0.5)
    net = found.sphere_mesh.mesh
    start = planar_system(found.sphere_mesh).start
    weights = np.ones(net.n_vertices)
    rng = np.random.default_rng(1)
    moved = NetState(start.rows, 0.05 * rng.normal(size=start.shifts.shape), start.normals)
    strict = on_surface(found.surface, net, weights)(moved)
    eased = on_surface(found.surface, net, weights, 0.02)(moved)
    assert np.abs(eased.lengths[:, 0]) == pytest.approx(
        np.maximum(np.abs(strict.lengths[:, 0]) - 0.02, 0)
    )
    assert eased.lengths[:, 1:] == pytest.approx(strict.lengths[:, 1:])
    assert not eased.slopes[np.abs(strict.lengths[:, 0]) < 0.02, 0].any()


def test_law_held_nets_are_planar_and_near_their_surface() -> None:
    mesh, _ = triangulated_surface("bump", 0.16)
    # A curvature between those of the surface, where nets are worst.
    found = remesh(mesh, sphere_congruence(mesh, "tangent", -4.0)[0], 0.4)
    held = next(held_nets(found.sphere_mesh, found.surface))
    assert measure_nodes(held.net).planarity.max() < 1e-9
    assert held.distance <= FARTHEST_NODE
    assert held.iterations > 0
    assert not [flaw for flaw in judge_net(held.net).flaws if "crosses" in flaw.cause]


def test_law_trimming_takes_corners_of_single_faces_alone() -> None:
    square = np.array([[x, y, 0.0] for x in range(3) for y in range(3)])
    mesh = Mesh(square, [[0, 3, 4, 1], [1, 4, 5, 2], [3, 6, 7, 4], [4, 7, 8, 5]])
    net = face_planes(mesh)
    cut = without_loose_corners(net, np.array([0]))
    assert cut.mesh.degrees.tolist() == [3, 4, 4, 4]
    assert cut.mesh.n_vertices == 8
    assert (cut.spheres == net.spheres).all()
    assert without_loose_corners(cut, np.array([0])) is cut
    assert without_loose_corners(net, np.array([], np.int64)) is net
