"""Flips: a face is convex if and only if its star is Delaunay in the metric I / λ - II."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, unit
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.hexagons.delaunay_flips import (
    _is_new_edge,
    dual_edge_lengths,
    flip_to_convex,
)
from spheremesh.kernel.hexagons.dual_sphere_mesh import dual_sphere_mesh
from spheremesh.kernel.hexagons.face_shapes import face_shapes
from spheremesh.kernel.hexagons.vertex_rule import vertex_rows

Grids = dict[str, Any]
NAMES = ["catenoid", "ellipsoid", "torus"]


def rows_of(mesh: Mesh, upwards: FloatArray, offset: float) -> FloatArray:
    return touching_spheres(mesh.vertices, upwards, np.full(len(upwards), 1 / offset))


def least_radius(around: FloatArray, across: FloatArray) -> float:
    return float((1 / np.maximum(around, across)).min())


def cotangent_sums(mesh: Mesh, metric: FloatArray) -> FloatArray:
    """Of the two angles opposite each edge, in the mean metric of its four vertices."""
    topology = mesh.topology
    following = topology.next_corners
    a, b = topology.edge_vertices.T
    h = topology.edge_corners
    c, d = (mesh.corners[following[following[g]]] for g in (h, topology.twins[h]))
    mean = (metric[a] + metric[b] + metric[c] + metric[d]) / 4
    result = np.zeros(len(a))
    for z in (c, d):
        u, w = mesh.vertices[a] - mesh.vertices[z], mesh.vertices[b] - mesh.vertices[z]
        uu, uw, ww = (
            np.einsum("ni,nij,nj->n", p, mean, q) for p, q in ((u, u), (u, w), (w, w))
        )
        result += uw / np.sqrt(uu * ww - uw**2)
    return result


@pytest.mark.parametrize("name", NAMES)
def test_law_f6_convex_if_and_only_if_delaunay(name: str, curved_grids: Grids) -> None:
    """The mean of four metrics decides nothing where an edge is very nearly cocircular."""
    mesh, upwards, around, across = curved_grids[name]
    parallel = unit(np.cross([0.0, 0, 1], mesh.vertices))
    meridian = np.cross(upwards, parallel)
    shapes_seen: set[str] = set()
    for share in (0.2, 0.4, 0.6, 0.8, 0.9):
        offset = share * least_radius(around, across)
        metric = sum(
            (1 / offset - curvature)[:, None, None] * way[:, :, None] * way[:, None, :]
            for curvature, way in ((around, parallel), (across, meridian))
        )
        sums = cotangent_sums(mesh, np.asarray(metric))
        dual = dual_sphere_mesh(mesh, rows_of(mesh, upwards, offset))
        shapes = face_shapes(dual.sphere_mesh)
        least = np.full(mesh.n_vertices, np.inf)
        np.minimum.at(least, mesh.topology.edge_vertices.ravel(), np.repeat(sums, 2))
        decided = np.abs(least[dual.vertex_ids]) > 0.07
        predicted = least[dual.vertex_ids] > 0
        assert decided.mean() > 0.7
        np.testing.assert_array_equal(predicted[decided], (shapes == "convex")[decided])
        shapes_seen |= set(shapes.tolist())
    assert "convex" in shapes_seen
    assert name == "ellipsoid" or "crossing" in shapes_seen


@pytest.mark.parametrize("name", NAMES)
def test_law_f6_dual_edges_run_forwards_on_convex_faces(name: str, curved_grids: Grids) -> None:
    mesh, upwards, around, across = curved_grids[name]
    for share in (0.3, 0.6, 0.9):
        rows = rows_of(mesh, upwards, share * least_radius(around, across))
        dual = dual_sphere_mesh(mesh, rows)
        backwards = dual_edge_lengths(mesh, vertex_rows(mesh, rows)) < 0
        touched = np.unique(mesh.topology.edge_vertices[backwards])
        found = face_shapes(dual.sphere_mesh) != "convex"
        np.testing.assert_array_equal(found, np.isin(dual.vertex_ids, touched))


@pytest.mark.parametrize("name", NAMES)
def test_law_f6_flips_make_all_faces_convex(name: str, curved_grids: Grids) -> None:
    mesh, upwards, around, across = curved_grids[name]
    for share in (0.3, 0.8):
        spheres = rows_of(mesh, upwards, share * least_radius(around, across))
        flips = flip_to_convex(mesh, vertex_rows(mesh, spheres))
        assert (dual_edge_lengths(flips.mesh, vertex_rows(mesh, spheres)) > -1e-9).all()
        dual = dual_sphere_mesh(flips.mesh, spheres)
        assert (face_shapes(dual.sphere_mesh) == "convex").all()
        np.testing.assert_array_equal(flips.mesh.vertices, mesh.vertices)
        assert flips.mesh.n_faces == mesh.n_faces
        rims = [m.topology.is_boundary_vertex for m in (mesh, flips.mesh)]
        np.testing.assert_array_equal(*rims)
    assert name == "ellipsoid" or flips.n_flips > 0


def test_nothing_is_flipped_where_all_is_well(curved_grids: Grids) -> None:
    mesh, upwards, _, _ = curved_grids["torus"]
    flips = flip_to_convex(mesh, vertex_rows(mesh, rows_of(mesh, upwards, 0.3)))
    assert flips.n_flips == 0
    np.testing.assert_array_equal(flips.mesh.corners, mesh.corners)


def test_no_sweeps_no_flips(curved_grids: Grids) -> None:
    mesh, upwards, _, _ = curved_grids["torus"]
    rows = vertex_rows(mesh, rows_of(mesh, upwards, 0.6))
    assert flip_to_convex(mesh, rows, max_sweeps=0).n_flips == 0
    assert flip_to_convex(mesh, rows).n_flips > 0


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e5)])
def test_law_flips_do_not_depend_on_units_place_and_turning_over(
    scale: float, shift: float, curved_grids: Grids, rotation: FloatArray
) -> None:
    mesh, upwards, _, _ = curved_grids["torus"]

    def _edges(mesh: Mesh) -> set[tuple[int, int]]:
        ends = np.sort(mesh.topology.edge_vertices, axis=1)
        return set(map(tuple, ends.tolist()))

    expected = flip_to_convex(mesh, vertex_rows(mesh, rows_of(mesh, upwards, 0.6))).mesh
    assert _edges(expected) != _edges(mesh)
    moved = Mesh(scale * mesh.vertices @ rotation.T + shift, mesh.faces)
    rows = rows_of(moved, upwards @ rotation.T, 0.6 * scale)
    assert _edges(flip_to_convex(moved, vertex_rows(moved, rows)).mesh) == _edges(expected)
    turned = Mesh(mesh.vertices, [face[::-1] for face in mesh.faces])
    rows = -rows_of(mesh, upwards, 0.6)
    assert _edges(flip_to_convex(turned, vertex_rows(turned, rows)).mesh) == _edges(expected)


def test_law_flips_do_not_depend_on_the_numbering(
    curved_grids: Grids, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    mesh, upwards, _, _ = curved_grids["catenoid"]
    shuffled, _ = renumber(mesh)
    order = np.lexsort(mesh.vertices.T), np.lexsort(shuffled.vertices.T)
    moved = np.empty_like(upwards)
    moved[order[1]] = upwards[order[0]]
    counts = [
        flip_to_convex(m, vertex_rows(m, rows_of(m, n, 0.8))).n_flips
        for m, n in ((mesh, upwards), (shuffled, moved))
    ]
    assert counts[0] == counts[1] > 0


def test_a_flip_that_would_fold_or_double_an_edge_is_not_made() -> None:
    """A vertex of valence 3 in a large triangle: its edges exist already when flipped."""
    vertices = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0.2, 0.2, 0.0]]
    mesh = Mesh(vertices, [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    rows = touching_spheres(mesh.vertices, np.tile([0.0, 0, 1], (4, 1)), np.full(4, 0.1))
    flips = flip_to_convex(mesh, vertex_rows(mesh, rows))
    assert flips.n_flips == 0


def test_flips_come_to_an_end_where_none_helps(curved_grids: Grids) -> None:
    """Spheres that vary wildly: some dual edges run backwards whatever is flipped."""
    mesh, upwards, _, _ = curved_grids["torus"]
    offsets = 0.35 * (1 + 0.9 * np.random.default_rng(2).uniform(-1, 1, mesh.n_vertices))
    rows = vertex_rows(mesh, touching_spheres(mesh.vertices, upwards, 1 / offsets))
    flips = flip_to_convex(mesh, rows)
    assert (dual_edge_lengths(flips.mesh, rows) < 0).any()
    assert 0 < flips.sweeps < 15


def test_an_edge_is_new_if_no_face_has_it_and_asked_for_once(octahedron: Mesh) -> None:
    first, second = np.array([0, 0, 1, 3]), np.array([2, 1, 3, 1])
    assert _is_new_edge(octahedron, first, second).tolist() == [True, False, False, False]
