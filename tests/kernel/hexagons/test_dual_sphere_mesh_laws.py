"""Sphere meshes dual to triangulations: which faces there are, and where their corners lie."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, norm
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence, touching_spheres
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.hexagons.dual_sphere_mesh import DualSpheres, dual_sphere_mesh
from spheremesh.kernel.hexagons.face_shapes import face_shapes
from spheremesh.kernel.meshes.mesh import face_centroids, face_vector_areas, mean_edge_length
from spheremesh.kernel.meshes.vertex_fans import vertex_fans
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.spheres.incidence import evaluate, normals

Grids = dict[str, Any]


def constant(mesh: Mesh, upwards: FloatArray, offset: float = 0.3) -> FloatArray:
    return touching_spheres(mesh.vertices, upwards, np.full(len(upwards), 1 / offset))


@pytest.mark.parametrize("name", ["catenoid", "ellipsoid", "torus"])
def test_law_f2_closed_stars_become_faces(name: str, curved_grids: Grids) -> None:
    grid = curved_grids[name]
    rows = constant(grid.mesh, grid.normals)
    dual = dual_sphere_mesh(grid.mesh, rows)
    inner = np.flatnonzero(~grid.mesh.topology.is_boundary_vertex)
    np.testing.assert_array_equal(dual.vertex_ids, inner)
    assert dual.left_out == ()
    assert dual.n_imaginary == 0
    valences = np.bincount(grid.mesh.corners)[inner]
    np.testing.assert_array_equal(dual.sphere_mesh.mesh.degrees, valences)
    assert vertex_error(dual.sphere_mesh).max() < 1e-12
    np.testing.assert_allclose(dual.sphere_mesh.spheres, rows[inner], atol=1e-12)
    # every face lies about its vertex and is seen from the side of N
    size = mean_edge_length(grid.mesh)
    assert norm(face_centroids(dual.sphere_mesh.mesh) - grid.mesh.vertices[inner]).max() < size
    assert (face_shapes(dual.sphere_mesh) == "convex").all()


def test_law_faces_do_not_depend_on_numbering(
    curved_grids: Grids, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    grid = curved_grids["torus"]
    shuffled, _ = renumber(grid.mesh)
    first = dual_sphere_mesh(grid.mesh, constant(grid.mesh, grid.normals))
    order = np.lexsort(grid.mesh.vertices.T), np.lexsort(shuffled.vertices.T)
    rows = np.empty((len(grid.normals), 5))
    rows[order[1]] = constant(grid.mesh, grid.normals)[order[0]]
    second = dual_sphere_mesh(shuffled, rows)

    def _angles(dual: DualSpheres) -> FloatArray:
        return np.sort(intersection_angles(dual.sphere_mesh))

    np.testing.assert_allclose(_angles(first), _angles(second), atol=1e-10)
    points = [np.sort(dual.sphere_mesh.mesh.vertices, axis=0) for dual in (first, second)]
    np.testing.assert_allclose(*points, atol=1e-12)


def test_law_orientation_and_scale_of_rows_play_no_part(curved_grids: Grids) -> None:
    grid = curved_grids["catenoid"]
    rows = constant(grid.mesh, grid.normals)
    factors = np.random.default_rng(0).choice([-2.0, 1.0, 3.0], len(rows))
    first = dual_sphere_mesh(grid.mesh, rows).sphere_mesh
    second = dual_sphere_mesh(grid.mesh, factors[:, None] * rows).sphere_mesh
    np.testing.assert_allclose(first.spheres, second.spheres, atol=1e-12)
    np.testing.assert_allclose(first.mesh.vertices, second.mesh.vertices, atol=1e-12)


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e5)])
def test_law_faces_do_not_depend_on_units_and_place(
    scale: float, shift: float, curved_grids: Grids, rotation: FloatArray
) -> None:
    grid = curved_grids["ellipsoid"]
    points = scale * grid.mesh.vertices @ rotation.T + shift
    rows = touching_spheres(points, grid.normals @ rotation.T, np.full(408, 1 / (0.35 * scale)))
    moved = dual_sphere_mesh(Mesh(points, grid.mesh.faces), rows).sphere_mesh
    here = dual_sphere_mesh(grid.mesh, constant(grid.mesh, grid.normals, 0.35)).sphere_mesh
    found = (moved.mesh.vertices - shift) @ rotation / scale
    np.testing.assert_allclose(found, here.mesh.vertices, atol=1e-8 if shift else 1e-12)
    assert vertex_error(moved).max() < 1e-9 * scale


def test_vertices_that_are_not_real_are_left_out_with_reasons(curved_grids: Grids) -> None:
    grid = curved_grids["catenoid"]
    offsets = np.full(408, 0.35)
    small = [200, 201]
    offsets[small] = 1e-3
    rows = touching_spheres(grid.mesh.vertices, grid.normals, 1 / offsets)
    dual = dual_sphere_mesh(grid.mesh, rows)
    lost = {vertex for vertex, _ in dual.left_out}
    around = {
        int(v) for face in grid.mesh.faces if set(small) & set(face.tolist()) for v in face
    }
    assert lost == {v for v in around if not grid.mesh.topology.is_boundary_vertex[v]}
    assert dual.n_imaginary == len([f for f in grid.mesh.faces if set(small) & set(f.tolist())])
    assert set(dual.vertex_ids.tolist()) | lost == set(
        np.flatnonzero(~grid.mesh.topology.is_boundary_vertex).tolist()
    )
    assert all("no real point" in reason for _, reason in dual.left_out)


def test_clipped_faces_reach_the_boundary_and_stay_on_their_spheres(
    curved_grids: Grids,
) -> None:
    grid = curved_grids["ellipsoid"]
    rows = constant(grid.mesh, grid.normals)
    dual = dual_sphere_mesh(grid.mesh, rows, "clip")
    assert dual.sphere_mesh.mesh.n_faces + len(dual.left_out) == grid.mesh.n_vertices
    assert vertex_error(dual.sphere_mesh).max() < 1e-12
    # corners of the boundary are vertices of the triangulation, on their own sphere
    corners = dual.sphere_mesh.mesh.vertices
    rim = np.flatnonzero(grid.mesh.topology.is_boundary_vertex)
    distance = norm(corners[:, None] - grid.mesh.vertices[rim]).min(axis=0)
    assert (distance < 1e-9).mean() > 0.9


def test_a_flat_sheet_is_clipped_to_its_outline() -> None:
    i, j = np.meshgrid(np.arange(6), np.arange(5), indexing="ij")
    points = np.stack([i + 0.5 * (j % 2), j * 0.9, 0 * i], -1).reshape(-1, 3).astype(float)
    a = (i * 5 + j)[:-1, :-1]
    odd = (j % 2)[:-1, :-1, None]
    triangles = np.where(
        odd == 0,
        np.stack([a, a + 5, a + 1, a + 5, a + 6, a + 1], -1),
        np.stack([a, a + 5, a + 6, a, a + 6, a + 1], -1),
    ).reshape(-1, 3)
    mesh = Mesh(points, triangles)
    rows = touching_spheres(points, np.tile([0.0, 0, 1], (30, 1)), np.full(30, 1 / 50.0))
    faces = dual_sphere_mesh(mesh, rows, "clip").sphere_mesh.mesh
    area = float(face_vector_areas(faces)[:, 2].sum())
    assert area == pytest.approx(len(triangles) * 0.45, rel=1e-3)


def test_law_fans_run_counter_clockwise_around_every_vertex(curved_grids: Grids) -> None:
    mesh = curved_grids["catenoid"].mesh
    fans = vertex_fans(mesh.topology, mesh.corners, np.arange(mesh.n_vertices), "last")
    owners = np.repeat(fans.vertices, np.diff(fans.offsets))
    np.testing.assert_array_equal(mesh.corners[fans.corners], owners)
    np.testing.assert_array_equal(np.sort(fans.corners), np.arange(len(mesh.corners)))
    following = mesh.topology.next_corners
    for start, end in zip(fans.offsets[:-1], fans.offsets[1:], strict=True):
        for h, g in zip(
            fans.corners[start : end - 1], fans.corners[start + 1 : end], strict=True
        ):
            previous = following[following[h]]
            assert mesh.topology.twins[previous] == g


def test_envelope_corners_touch_at_the_vertices(curved_grids: Grids) -> None:
    grid = curved_grids["catenoid"]
    rows, _ = sphere_congruence(grid.mesh, "tangent", 0.35)
    dual = dual_sphere_mesh(grid.mesh, rows).sphere_mesh
    ids = dual_sphere_mesh(grid.mesh, rows).vertex_ids
    assert np.abs(evaluate(dual.spheres, grid.mesh.vertices[ids])).max() < 1e-12
    upwards = normals(dual.spheres, grid.mesh.vertices[ids])
    assert (upwards * grid.normals[ids]).sum(1).min() > 0.99


def test_bad_input_is_named(ball: Mesh, octahedron: Mesh) -> None:
    with pytest.raises(InputError, match=r"faces \[0, 1.*are no triangles: triangulate"):
        dual_sphere_mesh(ball, np.ones((ball.n_vertices, 5)))
    with pytest.raises(InputError, match="boundary must be"):
        dual_sphere_mesh(octahedron, np.ones((6, 5)), "cut")  # type: ignore[arg-type]
    triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    rows = touching_spheres(triangle.vertices, np.tile([0.0, 0, 1], (3, 1)), np.full(3, 0.1))
    with pytest.raises(InputError, match="no vertex of the triangulation gets a face"):
        dual_sphere_mesh(triangle, rows)
    assert dual_sphere_mesh(triangle, rows, "clip").sphere_mesh.mesh.n_faces == 3
