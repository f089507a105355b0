"""Laws of node axes, torsion and mirror points (E1 to E4)."""

import json
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm, unit
from spheremesh.kernel.congruences.discrete_envelopes import mirror_points
from spheremesh.kernel.meshes.mesh import face_centroids, mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import evaluate, signed_distance
from spheremesh.kernel.spheres.rows import from_center_radius, from_plane, normalize, rescale
from spheremesh.kernel.support.node_axes import (
    SupportStructure,
    arc_planes,
    axis_lean,
    node_reasons,
    support_report,
    support_structure,
)


def fan(n_faces: int) -> Mesh:
    """Triangles around the origin; vertex 0 is the only one inside."""
    turns = 2 * np.pi * np.arange(n_faces) / n_faces
    rim = np.stack([np.cos(turns), np.sin(turns), -0.2 + 0 * turns], 1)
    steps = np.arange(n_faces)
    faces = np.stack([0 * steps, 1 + steps, 1 + (steps + 1) % n_faces], 1)
    return Mesh(np.concatenate([np.zeros((1, 3)), rim]), faces)


def around_the_origin(centers: FloatArray, radii: FloatArray | None = None) -> SphereMesh:
    """The fan with spheres of given centres below it, through the origin by default."""
    squares = dot(centers, centers) if radii is None else radii**2
    return SphereMesh(fan(len(centers)), -normalize(from_center_radius(centers, squares)))


def centers_in_a_plane(n_faces: int, height: float) -> FloatArray:
    rng = np.random.default_rng(n_faces)
    turns = 2 * np.pi * (np.arange(n_faces) + 0.5) / n_faces
    reach = rng.uniform(0.5, 1.5, n_faces)
    return (
        np.stack([reach * np.cos(turns), reach * np.sin(turns), height + 0 * turns], 1)
        @ np.linalg.qr(np.eye(3) + 0.1 * rng.normal(size=(3, 3)))[0]
    )


# E1, E3


@pytest.mark.parametrize("n_faces", [3, 4, 5, 8])
def test_law_e1_with_centers_in_a_plane_the_mirror_point_lies_on_all_spheres(
    n_faces: int,
) -> None:
    centers = centers_in_a_plane(n_faces, -3.0)
    sphere_mesh = around_the_origin(centers)
    found = support_structure(sphere_mesh)
    normal = np.cross(centers[1] - centers[0], centers[2] - centers[0])
    mirror = 2 * dot(centers[0], normal) * normal / dot(normal, normal)
    assert found.coplanarity[0] < 1e-14
    assert norm(found.axes[0, 1] - mirror) < 1e-13
    assert np.abs(signed_distance(sphere_mesh.spheres, found.axes[0, 1])).max() < 1e-13
    assert found.mirror_miss[0] < 1e-13
    assert found.torsion[0] < 1e-14


def test_law_e1_planes_are_spheres_whose_centers_are_directions() -> None:
    turns = 2 * np.pi * (np.arange(5) + 0.5) / 5
    across = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    centers = 0.7 * across + [0, 0, -2.0]
    rows = -normalize(from_center_radius(centers, dot(centers, centers)))
    rows[[0, 1]] = from_plane(across[[0, 1]], np.zeros(2))
    found = support_structure(SphereMesh(fan(5), rows))
    assert norm(found.axes[0, 1] - [0, 0, -4.0]) < 1e-13
    assert found.torsion[0] < 1e-13
    assert found.coplanarity[0] < 1e-14
    assert found.mirror_miss[0] < 1e-13


def test_law_e1_agrees_with_the_second_envelope(nets: dict[str, Mesh]) -> None:
    sphere_mesh = minimize_angles(fit_spheres(nets["torus"]), 0.0, None)[0]
    found, mirrored = support_structure(sphere_mesh), mirror_points(sphere_mesh)
    assert mirrored.is_valid.all()
    assert norm(found.axes[:, 1] - mirrored.points).max() < 1e-10
    assert np.abs(found.axes[:, 0] - nets["torus"].vertices).max() == 0


@pytest.mark.parametrize("name", ["torus", "egg", "vase", "catenoid"])
def test_law_e3_every_arc_plane_contains_the_axis(nets: dict[str, Mesh], name: str) -> None:
    sphere_mesh = central_spheres(nets[name])
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    found, planes = support_structure(sphere_mesh), arc_planes(sphere_mesh)
    assert planes.exists.all()
    middles = mesh.vertices[topology.edge_vertices].mean(axis=1)
    size = mean_edge_length(mesh)
    for end in topology.edge_vertices.T:
        assert np.abs(dot(planes.normals, found.directions[end])).max() < 1e-11
        miss = dot(planes.normals, mesh.vertices[end] - middles) - planes.offsets
        assert np.abs(miss).max() < 1e-11 * size


# E2


def test_law_e2_a_common_point_makes_the_rank_three() -> None:
    found = support_structure(around_the_origin(centers_in_a_plane(6, -3.0)))
    assert found.rank[0] < 1e-14


def test_law_e2_centers_in_a_plane_alone_do_not() -> None:
    centers = centers_in_a_plane(6, -3.0)
    radii = norm(centers) * np.random.default_rng(1).uniform(0.8, 1.2, 6)
    found = support_structure(around_the_origin(centers, radii))
    assert found.coplanarity[0] < 1e-14
    assert found.torsion[0] < 1e-13
    assert found.rank[0] > 0.01
    assert found.mirror_miss[0] > 0.01


@pytest.mark.parametrize("size", [1.0, 1e3])
def test_arc_planes_that_miss_a_common_line_make_no_node(size: float) -> None:
    """Their normals are orthogonal to the axis; whether they share a line is in the offsets."""
    centers, around = size * centers_in_a_plane(5, -3.0), np.arange(5)
    radii = norm(centers) * np.array([1.05, 0.95, 1.05, 0.95, 1.0])
    found = support_structure(scaled(around_the_origin(centers / size, radii / size), size))
    planes = np.diff(centers[[*around, 0]], axis=0)
    powers = np.sum(centers**2, 1) - radii**2
    offsets = np.diff(powers[[*around, 0]]) / 2 / norm(planes)
    normals = unit(planes)
    best = np.linalg.lstsq(normals, offsets, rcond=1e-9)[0]
    miss = float(np.abs(normals @ best - offsets).max())
    assert found.torsion[0] < 1e-12
    np.testing.assert_allclose(found.line_miss[0], miss, rtol=1e-9)
    assert "miss a common line" in node_reasons(found, size)[0]
    through = support_structure(scaled(around_the_origin(centers / size), size))
    assert through.line_miss[0] < 1e-12 * size


def scaled(sphere_mesh: SphereMesh, factor: float) -> SphereMesh:
    mesh = sphere_mesh.mesh
    large = Mesh(mesh.vertices * factor, mesh.faces)
    return SphereMesh.from_local(large, rescale(sphere_mesh.local_spheres, factor))


# E4


@pytest.mark.parametrize("height", [0.0, 1e-6, 0.01, 0.3])
def test_law_e4_torsion_of_four_centers_in_closed_form(height: float) -> None:
    turns = np.pi / 2 * (np.arange(4) + 0.5)
    centers = np.stack([np.cos(turns), np.sin(turns), -5 + height * (-1.0) ** np.arange(4)], 1)
    found = support_structure(around_the_origin(centers))
    expected = np.arcsin(2 * height / np.sqrt(2 + 4 * height**2))
    assert abs(found.torsion[0] - expected) < 1e-14
    assert norm(np.cross(found.directions[0], [0, 0, -1])) < 1e-13
    assert (0 in node_reasons(found, 1.0)) == (np.degrees(expected) > 0.1)


def test_law_e4_valence_three_has_no_torsion(
    octahedron: Mesh, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    corners = np.array([[x, y, z] for x in (0, 2.0) for y in (0, 3.0) for z in (0, 1.0)])
    box = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    mesh, _ = renumber(Mesh(corners, box))
    turn = np.random.default_rng(2).uniform(-0.6, -0.2, 6)
    circles, _ = face_circles(mesh)
    local = pencil_spheres(*circle_pencils(circles), turn)
    found = support_structure(SphereMesh.from_local(mesh, local))
    assert found.torsion.max() < 1e-13
    assert np.nanmax(found.mirror_miss) < 1e-12
    assert found.has_mirror.all()
    # valence four is not free by itself
    circles, _ = face_circles(octahedron)
    turn = np.random.default_rng(2).uniform(-0.6, -0.2, 8)
    local = pencil_spheres(*circle_pencils(circles), turn)
    assert support_structure(SphereMesh.from_local(octahedron, local)).torsion.min() > 1e-3


@pytest.mark.parametrize("name", ["torus", "egg", "catenoid"])
def test_law_e4_planes_of_a_conical_mesh_have_no_torsion(
    nets: dict[str, Mesh], name: str
) -> None:
    found = support_structure(face_planes(nets[name]))
    assert found.torsion.max() < 1e-12
    assert not found.has_mirror.any()
    steps = norm(found.axes[:, 1] - found.axes[:, 0])
    assert np.abs(steps / mean_edge_length(nets[name]) - 1).max() < 1e-12


# invariance


def assert_alike(
    actual: SupportStructure, expected: SupportStructure, scale: float, order: IntArray
) -> None:
    for name in ("torsion", "coplanarity", "rank"):
        difference = getattr(actual, name)[order] - getattr(expected, name)
        assert np.abs(difference).max() < 1e-9, name
    assert (actual.has_mirror[order] == expected.has_mirror).all()
    assert np.abs(axis_lean(actual)[order] - axis_lean(expected)).max() < 1e-8
    reach = norm(expected.axes[:, 1] - expected.axes[:, 0])
    actual_reach = norm(actual.axes[:, 1] - actual.axes[:, 0])[order] / scale
    assert np.abs(actual_reach / reach - 1).max() < 1e-6


@given(st.floats(-3, 3), st.integers(0, 5))
def test_law_e4_nothing_depends_on_scale_and_turn(exponent: float, seed: int) -> None:
    scale = 10**exponent
    centers = centers_in_a_plane(5, -3.0)
    centers[0] *= 1.1
    sphere_mesh = around_the_origin(centers)
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    rows = rescale(sphere_mesh.spheres, scale)
    rows[:, 1:4] = rows[:, 1:4] @ turn.T
    mesh = Mesh(scale * sphere_mesh.mesh.vertices @ turn.T, sphere_mesh.mesh.faces)
    expected = support_structure(sphere_mesh)
    actual = support_structure(SphereMesh(mesh, rows))
    assert_alike(actual, expected, scale, np.arange(6))
    assert np.abs(actual.directions - expected.directions @ turn.T).max() < 1e-10


@pytest.mark.parametrize("name", ["vase", "roof"])
def test_law_e4_nothing_depends_on_the_site(nets: dict[str, Mesh], name: str) -> None:
    sphere_mesh = minimize_angles(fit_spheres(nets[name]), 0.0, None)[0]
    mesh = sphere_mesh.mesh
    shift = 1e6 * mean_edge_length(mesh) * np.array([0.6, -0.64, 0.48])
    moved = Mesh(mesh.vertices + shift, mesh.faces)
    offset = face_centroids(moved) - face_centroids(mesh) - shift
    # the vertices themselves are rounded by 1e-10 edges there
    assert np.abs(offset).max() < 1e-9 * mean_edge_length(mesh)
    far = support_structure(SphereMesh.from_local(moved, sphere_mesh.local_spheres))
    near = support_structure(sphere_mesh)
    assert np.abs(far.torsion - near.torsion).max() < 1e-6
    assert np.abs(far.directions - near.directions).max() < 1e-6


def test_law_e4_nothing_depends_on_the_numbering(
    nets: dict[str, Mesh], renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    sphere_mesh = minimize_angles(fit_spheres(nets["roof"]), 0.0, None)[0]
    mesh = sphere_mesh.mesh
    shuffled, new = renumber(mesh)
    local = np.empty_like(sphere_mesh.local_spheres)
    local[new] = sphere_mesh.local_spheres
    order = np.array(
        [int(norm(shuffled.vertices - vertex).argmin()) for vertex in mesh.vertices]
    )
    actual = support_structure(SphereMesh.from_local(shuffled, local))
    assert_alike(actual, support_structure(sphere_mesh), 1.0, order)


# limits


def test_on_one_sphere_all_axes_point_to_its_center(ball: Mesh) -> None:
    sphere_mesh = fit_spheres(ball)
    found = support_structure(sphere_mesh)
    assert not arc_planes(sphere_mesh).exists.any()
    assert norm(found.directions + unit(ball.vertices)).max() < 1e-12
    assert found.torsion.max() == 0
    assert norm(found.axes[:, 1] + ball.vertices).max() < 1e-12
    report = support_report(sphere_mesh, found)
    assert report["edges_without_circle"] == len(ball.topology.edge_faces)


def test_a_vertex_in_the_plane_of_the_centers_is_its_own_mirror_image() -> None:
    turns = 2 * np.pi * np.arange(5) / 5
    centers = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    found = support_structure(around_the_origin(centers))
    assert not found.has_mirror[0]
    assert norm(found.axes[0, 1] - found.axes[0, 0]) > 0.1
    assert norm(np.cross(found.directions[0], [0, 0, 1])) < 1e-13


def test_boundary_axes_lie_in_the_planes_that_are_there(nets: dict[str, Mesh]) -> None:
    sphere_mesh = central_spheres(nets["egg"])
    found, planes = support_structure(sphere_mesh), arc_planes(sphere_mesh)
    topology = sphere_mesh.mesh.topology
    rim = topology.is_boundary_vertex
    assert rim.any()
    for end in topology.edge_vertices.T:
        at_rim = rim[end]
        sines = dot(planes.normals[at_rim], found.directions[end[at_rim]])
        assert np.abs(sines).max() < 1e-13
    # rotational: they meet the axis of the egg
    axis = np.array([0, 0, 1.0])
    normal = np.cross(sphere_mesh.mesh.vertices, axis)
    assert np.abs(dot(normal, found.directions))[rim].max() < 1e-12


def test_unused_vertices_are_listed() -> None:
    mesh = fan(4)
    mesh = Mesh(np.concatenate([mesh.vertices, [[9, 9, 9]]]), mesh.faces)
    sphere_mesh = face_planes(mesh)
    found = support_structure(sphere_mesh)
    assert node_reasons(found, 1.0)[5] == "the vertex belongs to no face"
    assert (found.axes[5, 1] == found.axes[5, 0]).all()


def test_the_report_is_plain_and_names_the_invalid(nets: dict[str, Mesh]) -> None:
    sphere_mesh = minimize_angles(fit_spheres(nets["roof"]), 0.0, None)[0]
    found = support_structure(sphere_mesh)
    report = support_report(sphere_mesh, found)
    assert json.loads(json.dumps(dict(report), allow_nan=False)) == report
    inside = ~sphere_mesh.mesh.topology.is_boundary_vertex
    assert report["torsion_deg"]["max"] == np.degrees(found.torsion[inside].max())
    assert report["valid"] + len(report["invalid"]) == sphere_mesh.mesh.n_vertices
    reasons = [entry["reason"] for entry in report["invalid"]]
    assert any("miss the axis" in reason for reason in reasons)
    assert any("leans" in reason for reason in reasons)


def test_mirror_miss_is_a_distance() -> None:
    centers = centers_in_a_plane(4, -3.0)
    centers[0] *= 1.05
    sphere_mesh = around_the_origin(centers)
    found = support_structure(sphere_mesh)
    distances = np.abs(signed_distance(sphere_mesh.spheres, found.axes[0, 1]))
    assert abs(found.mirror_miss[0] - distances.max()) < 1e-12
    assert np.abs(evaluate(sphere_mesh.spheres, found.axes[0, 0])).max() < 1e-13
