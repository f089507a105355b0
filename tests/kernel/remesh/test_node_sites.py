"""Laws of nodes that are kept on the surface of a congruence (F8)."""

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.remesh.field.congruence_mesh import congruence_mesh
from spheremesh.kernel.remesh.field.jets import fit_jets
from spheremesh.kernel.remesh.field.smooth_surface import SmoothSurface, surface_heights
from spheremesh.kernel.remesh.pipeline import Remeshing, remesh
from spheremesh.kernel.remesh.planar.conditions import (
    NetState,
    anywhere,
    node_distances,
    on_surface,
)
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes
from spheremesh.kernel.remesh.planar.planarize import planarize, planarize_held
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.surfaces.triangulated import SampleShape, triangulated_surface
from spheremesh.kernel.tolerances import TORSION_FREE


def remeshed(shape: SampleShape, edge: float, offset: float) -> Remeshing:
    mesh, normals = triangulated_surface(shape, edge / 2, seed=1)
    spheres = touching_spheres(mesh.vertices, normals, np.full(len(normals), 1 / offset))
    return remesh(mesh, spheres, edge)


def test_law_f8_nodes_lie_on_the_smooth_surface() -> None:
    done = remeshed("hypar", 0.2, 1.0)
    free = planarize(done.sphere_mesh).sphere_mesh
    held = planarize(done.sphere_mesh, surface=done.surface)
    assert held.status == "converged"
    assert measure_nodes(held.sphere_mesh).planarity.max() < TORSION_FREE
    assert vertex_error(held.sphere_mesh).max() < 1e-6 * mean_edge_length(held.sphere_mesh.mesh)
    x, y, z = held.sphere_mesh.mesh.vertices.T
    slope = np.hypot(0.7 * x + 0.1 * y, 0.1 * x - 0.5 * y)
    away = np.abs(z - (0.35 * x**2 - 0.25 * y**2 + 0.1 * x * y)) / np.sqrt(1 + slope**2)
    inner = ~held.sphere_mesh.mesh.topology.is_boundary_vertex
    mean = mean_edge_length(held.sphere_mesh.mesh)
    assert away[inner].max() < 1e-3 * mean
    assert away.max() < 0.03 * mean
    x, y, z = free.mesh.vertices.T
    loose = np.abs(z - (0.35 * x**2 - 0.25 * y**2 + 0.1 * x * y))
    assert loose[inner].max() > 0.01 * mean


def test_nodes_of_the_boundary_stay_above_it() -> None:
    done = remeshed("hypar", 0.2, 1.0)
    held = planarize(done.sphere_mesh, surface=done.surface).sphere_mesh.mesh
    rim = np.abs(held.vertices[held.topology.is_boundary_vertex, :2])
    assert np.abs(rim.max(axis=1) - 1).max() < 0.02 * mean_edge_length(held)
    corners = np.argsort(-rim.min(axis=1))[:4]
    np.testing.assert_allclose(rim[corners], 1, atol=0.02 * mean_edge_length(held))


def test_heights_of_a_smooth_surface_are_distances() -> None:
    mesh, normals = triangulated_surface("torus", 0.1, seed=1)
    spheres = touching_spheres(mesh.vertices, normals, np.full(len(normals), -2.0))
    congruence = congruence_mesh(mesh, spheres)
    surface = SmoothSurface(congruence, fit_jets(congruence, 5).heights)
    rng = np.random.default_rng(2)
    u, v = rng.uniform(0, 2 * np.pi, (2, 200))
    away = rng.uniform(-0.05, 0.05, 200)
    reach = 2 + (0.7 + away) * np.cos(v)
    points = np.stack([reach * np.cos(u), reach * np.sin(u), (0.7 + away) * np.sin(v)], 1)
    upward = np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], 1)
    local = (points - congruence.origin) / congruence.size
    heights, gradients = surface_heights(surface, local)
    # The triangles themselves are up to 2 % of an edge below the surface.
    np.testing.assert_allclose(heights, away / congruence.size, atol=1.5e-3)
    np.testing.assert_allclose(gradients, upward, atol=0.02)


def test_nets_are_held_where_they_stay_nets() -> None:
    done = remeshed("hypar", 0.2, 1.0)
    held, is_held = planarize_held(done.sphere_mesh, done.surface)
    assert is_held
    assert measure_nodes(held.sphere_mesh).planarity.max() < TORSION_FREE
    inner = ~held.sphere_mesh.mesh.topology.is_boundary_vertex
    assert node_distances(done.surface, held.sphere_mesh.mesh)[inner].max() < 1e-3
    # Two edges away: a net would have to move farther than it may.
    far = 2 * mean_edge_length(done.sphere_mesh.mesh) / done.surface.mesh.size
    other = SmoothSurface(done.surface.mesh, done.surface.heights + far * np.eye(6)[0])
    free, is_held = planarize_held(done.sphere_mesh, other)
    assert not is_held
    np.testing.assert_array_equal(
        free.sphere_mesh.mesh.vertices, planarize(done.sphere_mesh).sphere_mesh.mesh.vertices
    )


def test_misses_have_the_slopes_they_say() -> None:
    done = remeshed("hypar", 0.25, 1.0)
    mesh = done.sphere_mesh.mesh
    is_held = ~mesh.topology.is_boundary_vertex
    site = on_surface(done.surface, mesh, is_held.astype(float))
    rng = np.random.default_rng(1)
    shifts, step = 0.02 * rng.normal(size=(2, mesh.n_vertices, 3))
    no_spheres, no_normals = np.zeros((0, 5)), np.zeros((mesh.n_vertices, 4))
    found, ahead, free = (
        each(NetState(no_spheres, moved, no_normals))
        for each, moved in ((site, shifts), (site, shifts + 0.1 * step), (anywhere, shifts))
    )
    expected = found.lengths + 0.1 * np.einsum("vki,vi->vk", found.slopes[..., :3], step)
    np.testing.assert_allclose(ahead.lengths, expected, atol=2e-4)
    assert (found.lengths[~is_held, 0] == 0).all()
    assert (norm(found.slopes[is_held, 1:]) == 0).all()
    assert free.lengths.shape == (mesh.n_vertices, 0)


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e5)])
def test_law_f8_nodes_on_a_surface_do_not_depend_on_units_and_place(
    scale: float, shift: float
) -> None:
    mesh, normals = triangulated_surface("hypar", 0.15, seed=1)
    move = np.array([shift, -shift, 0.5 * shift])
    nets: list[FloatArray] = []
    for points, size in ((mesh.vertices, 1.0), (scale * mesh.vertices + move, scale)):
        spheres = touching_spheres(points, normals, np.full(len(normals), 1 / size))
        done = remesh(Mesh(points, mesh.faces), spheres, 0.3 * size)
        held = planarize(done.sphere_mesh, surface=done.surface)
        nets.append(held.sphere_mesh.mesh.vertices)
    np.testing.assert_allclose((nets[1] - move) / scale, nets[0], atol=1e-4)
