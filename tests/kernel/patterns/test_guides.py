"""Lines that follow a direction, curves or the boundary; edges as the curvature asks."""

from dataclasses import replace

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.patterns.density import even_spacing
from spheremesh.kernel.patterns.panel_scale import even_triangles
from spheremesh.kernel.patterns.surface_curvatures import vertex_areas
from spheremesh.kernel.remesh.field.guides import NetWishes
from spheremesh.kernel.remesh.pipeline import Remeshing, remesh
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net

EDGE = 0.45


def cap(n: int = 20) -> Mesh:
    """A part of a sphere over a rectangle: its curvature tells no directions."""
    u, v = np.meshgrid(np.linspace(-1.6, 1.6, n), np.linspace(-1.2, 1.2, n), indexing="ij")
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a = (i * n + j).ravel()
    points = np.stack([u, v, np.sqrt(16 - u**2 - v**2) - 4], -1).reshape(-1, 3)
    faces = np.concatenate(
        [np.stack([a, a + n, a + n + 1], 1), np.stack([a, a + n + 1, a + 1], 1)]
    )
    return Mesh(points, faces)


def covered(surface: Mesh, wishes: NetWishes, edge: float = EDGE) -> Remeshing:
    radius = 3.0 * float(np.ptp(surface.vertices, axis=0).max())
    spheres = sphere_congruence(surface, "tangent", -radius)[0]
    return remesh(surface, spheres, edge, wishes=wishes)


def misses(found: Remeshing, directions: FloatArray) -> FloatArray:
    """Degrees between the edges inside, seen from above, and the nearest of two directions."""
    mesh = found.sphere_mesh.mesh
    ends = mesh.vertices[mesh.topology.edge_vertices]
    runs = (ends[:, 1] - ends[:, 0])[:, :2]
    cosines = np.abs(runs @ directions[:2]) / norm(runs) / norm(directions[:2])
    angles = np.degrees(np.arccos(np.clip(cosines, 0, 1)))
    return np.minimum(angles, 90 - angles)


def test_law_lines_run_along_a_direction_however_the_surface_is_spelled() -> None:
    surface, wanted = cap(), np.array([1.0, 0.6, 0.0])
    found = covered(surface, NetWishes(wanted, boundary="free"))
    assert np.percentile(misses(found, wanted), 90) < 8
    assert len(found.indices) == 0
    rng = np.random.default_rng(3)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    order = rng.permutation(surface.n_vertices)
    place = np.argsort(order)
    moved = Mesh(
        (8 * surface.vertices @ turn.T + [3.0, -2.0, 5.0])[order],
        place[surface.corners.reshape(-1, 3)][rng.permutation(surface.n_faces)],
    )
    again = covered(moved, NetWishes(-3 * turn @ wanted, boundary="free"), 8 * EDGE)
    one, other = found.sphere_mesh.mesh, again.sphere_mesh.mesh
    assert abs(other.n_faces - one.n_faces) <= 0.05 * one.n_faces
    flat = replace(again, sphere_mesh=_turned_back(again, turn))
    assert np.percentile(misses(flat, wanted), 90) < 8


def _turned_back(found: Remeshing, turn: FloatArray) -> SphereMesh:
    mesh = found.sphere_mesh.mesh
    back = Mesh(mesh.vertices @ turn, mesh.faces)
    return SphereMesh(back, found.sphere_mesh.spheres)


def test_law_lines_run_along_curves_and_the_order_of_segments_is_free() -> None:
    t = np.linspace(-1.6, 1.6, 30)
    curve = np.stack([t, 0.25 * t, np.sqrt(16 - t**2 * 1.0625) - 4], 1)
    segments = np.stack([curve[:-1], curve[1:]], 1)
    found = covered(cap(), NetWishes(guides=segments, boundary="free"))
    mesh = found.sphere_mesh.mesh
    middles = mesh.vertices[mesh.topology.edge_vertices].mean(axis=1)
    is_near = np.abs(middles[:, 1] - 0.25 * middles[:, 0]) < 0.8 * EDGE
    assert misses(found, np.array([1.0, 0.25, 0]))[is_near].max() < 12
    rng = np.random.default_rng(0)
    shuffled = segments[rng.permutation(len(segments))]
    flip = rng.random(len(shuffled)) < 0.5
    shuffled[flip] = shuffled[flip][:, ::-1]
    again = covered(cap(), NetWishes(guides=shuffled, boundary="free"))
    assert again.sphere_mesh.mesh.vertices == pytest.approx(mesh.vertices, abs=1e-9)


def test_the_boundary_guides_or_is_left_alone() -> None:
    """On a cap over a rhombus lines follow the sides, or end at them as they come."""
    surface = cap()
    lean = np.array([[1.0, 0, 0], [0.45, 1, 0], [0, 0, 1]])
    flat = surface.vertices @ lean
    flat[:, 2] = np.sqrt(25 - flat[:, 0] ** 2 - flat[:, 1] ** 2) - 5
    rhombus = Mesh(flat, surface.faces)
    found = covered(rhombus, NetWishes(boundary="follow"))
    mesh = found.sphere_mesh.mesh
    ends = mesh.vertices[mesh.topology.edge_vertices]
    near = np.abs(ends[..., 0] - 0.45 * ends[..., 1]).min(axis=1) > 1.1
    assert near.any()
    side = np.array([0.45, 1.0, 0])
    assert np.median(misses(found, side)[near]) < 8
    x, y, _ = surface.vertices.T
    bowl = Mesh(np.stack([x, y, -0.16 * x**2 - 0.04 * y**2], 1), surface.faces)
    assert covered(bowl, NetWishes()).n_aligned == 4
    assert covered(bowl, NetWishes(boundary="free")).n_aligned == 0


def test_guides_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match="no length"):
        covered(cap(), NetWishes(np.zeros(3)))
    far = np.array([[[0.0, 0, 9], [1, 0, 9]]])
    with pytest.raises(InputError, match="farther than an edge"):
        covered(cap(), NetWishes(guides=far))


def test_law_edges_are_short_where_the_surface_bends_and_panels_as_many() -> None:
    surface = even_triangles(ellipsoid_net(32, 16, 1.0, 2.5, 1.0), 0.2)
    spacing = even_spacing(surface, surface, 1.0)
    assert spacing is not None
    areas = vertex_areas(surface)
    assert areas @ spacing**-2 / areas.sum() == pytest.approx(1, abs=0.05)
    tip, belly = (np.abs(surface.vertices[:, 2]) > 2, np.abs(surface.vertices[:, 2]) < 1)
    assert spacing[tip].mean() < 0.8 * spacing[belly].mean()
    larger = Mesh(16 * surface.vertices, surface.faces)
    assert even_spacing(larger, larger, 1.0) == pytest.approx(spacing, rel=1e-9)
    assert even_spacing(surface, surface, 0.0) is None
    with pytest.raises(InputError, match="between 0 and 1"):
        even_spacing(surface, surface, 1.5)
    half = even_spacing(surface, surface, 0.5)
    assert half is not None
    assert np.ptp(half) < np.ptp(spacing)
