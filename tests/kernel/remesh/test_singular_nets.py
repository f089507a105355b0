"""Nets around singular directions whose nodes have become planar (F8)."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.hexagons.evolution import evolve_spheres
from spheremesh.kernel.meshes.mesh import face_centroids
from spheremesh.kernel.remesh.net.extraction import Net
from spheremesh.kernel.remesh.net.net_mesh import net_mesh
from spheremesh.kernel.remesh.pipeline import remesh
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes
from spheremesh.kernel.remesh.planar.planarize import Planarization, planarize
from spheremesh.kernel.remesh.reports import planarization_report
from spheremesh.kernel.spheres.rows import recenter
from spheremesh.kernel.surfaces.triangulated import SampleShape, triangulated_surface


class Case(NamedTuple):
    """A surface, the offset of its spheres or the side that they grow on, the net's edges."""

    shape: SampleShape
    edge: float
    spheres: float | str
    net_edge: float


CASES = {
    "ellipsoid": Case("ellipsoid", 0.1, -0.5, 0.25),
    "grown on an ellipsoid": Case("ellipsoid", 0.1, "minus", 0.25),
    "waves": Case("waves", 0.1, 0.5, 0.25),
    "grown on a bump": Case("bump", 0.1, "minus", 0.22),
}


def planarized(case: Case) -> tuple[SphereMesh, Planarization]:
    mesh, normals = triangulated_surface(case.shape, case.edge, seed=1)
    if isinstance(case.spheres, str):
        grown = evolve_spheres(mesh, np.radians(15), "minus")
        mesh, rows = grown.mesh, grown.spheres
    else:
        rows = touching_spheres(mesh.vertices, normals, 1 / case.spheres)
    start = remesh(mesh, rows, case.net_edge)
    assert start.n_flipped == 0
    return start.sphere_mesh, planarize(start.sphere_mesh)


def differences(sphere_mesh: SphereMesh) -> FloatArray:
    """How much the normals of neighbouring spheres differ half-way between their faces."""
    centers = face_centroids(sphere_mesh.mesh)
    first, second = sphere_mesh.mesh.topology.edge_faces.T
    middles = (centers[first] + centers[second]) / 2
    rows = [
        recenter(sphere_mesh.local_spheres[f], middles - centers[f]) for f in (first, second)
    ]
    return norm((rows[0] - rows[1])[:, 1:4])


@pytest.mark.parametrize("name", list(CASES))
def test_law_f8_singular_nets_stay_nets(name: str) -> None:
    start, result = planarized(CASES[name])
    report = planarization_report(start, result)
    assert report["status"] == "converged"
    assert report["planarity"]["after"] < 1e-9
    assert report["corner_gap"]["after"] < 1e-8
    assert report["shortest_edge"]["after"] > max(0.2, 0.7 * report["shortest_edge"]["before"])
    assert report["turned_faces"] == report["nodes_without_axis"] == []
    assert report["real_nodes"]["after"] == 1
    # Neighbours stay two spheres.
    kept = differences(result.sphere_mesh) / differences(start)
    assert kept.min() > 0.02


def test_a_report_names_faces_that_turned_over() -> None:
    start, result = planarized(CASES["waves"])
    mesh = result.sphere_mesh.mesh
    over = Mesh(mesh.vertices * [1, 1, -1], [face[::-1] for face in mesh.faces])
    turned = replace(result, sphere_mesh=SphereMesh(over, result.sphere_mesh.spheres))
    found = planarization_report(start, turned)
    assert len(found["turned_faces"]) > 0.9 * mesh.n_faces


def test_nodes_beside_lost_slivers_leave_no_bend() -> None:
    """Two cells whose common edge passes a node beside a sliver."""
    places = [(0, 1), (1, 0), (1, 2), (-1, 0), (-1, 2), (0, 0), (0, 2), (0, 2)]
    points = np.array([(*place, 0.0) for place in places])
    # Points 6 and 7 of the boundary become one, and the sliver between them is lost.
    cells = [[5, 1, 2, 7, 0], [5, 0, 6, 4, 3], [0, 7, 6]]
    corners = np.concatenate([np.array(cell) for cell in cells])
    offsets = np.concatenate([[0], np.cumsum([len(cell) for cell in cells])])
    built = net_mesh(Net(points, 1, corners, offsets, np.zeros(7, bool)), 1.0)
    assert built.n_slivers == 1
    assert built.mesh.degrees.tolist() == [4, 4]
    assert built.mesh.n_vertices == 6
    assert not built.is_node.any()
    # A triangle has no corner to spare: there the bend stays.
    short = [[5, 1, 7, 0], [5, 0, 6]]
    corners = np.concatenate([np.array(cell) for cell in short])
    built = net_mesh(Net(points, 1, corners, np.array([0, 4, 7]), np.zeros(7, bool)), 1.0)
    assert built.mesh.degrees.tolist() == [4, 3]


def test_crowded_nodes_are_moved_apart() -> None:
    """A grid whose first two nodes inside are a tenth of a step from each other."""
    x, y = (g.ravel() for g in np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij"))
    inside = (x % 3 != 0) & (y % 3 != 0)
    order = np.concatenate([np.flatnonzero(inside), np.flatnonzero(~inside)])
    points = np.stack([x, y, 0 * x], 1)[order]
    rank = np.argsort(order).reshape(4, 4)
    a, b, c, d = rank[:-1, :-1], rank[1:, :-1], rank[1:, 1:], rank[:-1, 1:]
    corners = np.stack([a, b, c, d], -1).ravel()
    points[0, 1], points[1, 1] = 1.45, 1.55
    built = net_mesh(Net(points, 4, corners, np.arange(0, 37, 4), np.zeros(12, bool)), 1.0)
    moved = built.mesh.vertices
    assert norm(moved[0] - moved[1]) == pytest.approx(0.35)
    np.testing.assert_allclose(moved[0] + moved[1], points[0] + points[1])
    np.testing.assert_array_equal(moved[2:], points[2:])


def test_planarity_of_the_rim_is_measured() -> None:
    start, result = planarized(CASES["waves"])
    mesh = start.mesh
    many = np.bincount(mesh.corners, minlength=mesh.n_vertices) > 3
    rim = mesh.topology.is_boundary_vertex & many
    assert rim.any()
    assert measure_nodes(start).planarity[rim].max() > 1e-4
    assert measure_nodes(result.sphere_mesh).planarity[rim].max() < 1e-9


def test_a_cell_cut_off_by_a_grazing_line_is_lost_and_no_digon() -> None:
    """A square with a cell of two corners beside it, both on the boundary."""
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    corners, offsets = np.array([0, 1, 2, 3, 1, 0]), np.array([0, 4, 6])
    built = net_mesh(Net(points, 0, corners, offsets, np.zeros(4, bool)), 1.0)
    assert (built.n_digons, built.n_slivers) == (0, 1)
    built = net_mesh(Net(points, 4, corners, offsets, np.zeros(0, bool)), 1.0)
    assert (built.n_digons, built.n_slivers) == (1, 0)
