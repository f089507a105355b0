"""Laws of seamless maps along conjugate directions and of the nets that they give (F8)."""

import dataclasses
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.polynomial import Polynomial

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import (
    face_centroids,
    face_normals,
    face_vector_areas,
    mean_edge_length,
)
from spheremesh.kernel.meshes.vertex_fans import VertexFans, vertex_fans
from spheremesh.kernel.remesh.field.congruence_mesh import CongruenceMesh, congruence_mesh
from spheremesh.kernel.remesh.field.conjugate_form import conjugate_field
from spheremesh.kernel.remesh.field.frames import CombedFrames, comb_frames
from spheremesh.kernel.remesh.field.jets import fit_jets
from spheremesh.kernel.remesh.field.smoothing import smooth_forms
from spheremesh.kernel.remesh.map.injectivity import distortion
from spheremesh.kernel.remesh.map.integer_rounding import (
    ContradictionError,
    Quadratic,
    integer_solutions,
    relaxed_minimum,
    round_minimum,
)
from spheremesh.kernel.remesh.map.parametrization import parametrize
from spheremesh.kernel.remesh.map.seams import find_seams
from spheremesh.kernel.remesh.pipeline import Remeshing, remesh
from spheremesh.kernel.spheres.incidence import normals
from spheremesh.kernel.spheres.pentaspherical import pentaspherical
from spheremesh.kernel.spheres.rows import recenter
from spheremesh.kernel.surfaces.triangulated import SampleShape, triangulated_surface

Congruence = tuple[Mesh, FloatArray]


def constant_radius(shape: SampleShape, edge: float, offset: float = 0.5) -> Congruence:
    mesh, vertex_normals = triangulated_surface(shape, edge, seed=1)
    return mesh, touching_spheres(mesh.vertices, vertex_normals, 1 / offset)


def harmonic_graph(n: int, terms: Polynomial, dome: float = 0.0) -> Congruence:
    """Heights that are real parts of a polynomial: umbilics where its curvature is zero."""
    line = np.linspace(-1, 1, n + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(line, line, indexing="ij"))
    ids = np.arange(len(u)).reshape(n + 1, n + 1)
    a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
    faces = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    w = u + 1j * v
    slope = terms.deriv()(w)
    upward = np.stack([2 * dome * u - slope.real, 2 * dome * v + slope.imag, 0 * u + 1], 1)
    upward /= norm(upward)[:, None]
    points = np.stack([u, v, terms(w).real - dome * (u * u + v * v)], 1)
    return Mesh(points, faces), touching_spheres(points, upward, 1.0)


def monkey_saddle(n: int) -> Congruence:
    """One singular point, around which the directions make half a turn backwards."""
    return harmonic_graph(n, Polynomial([0, 0, 0, 0.2]), 0.1)


def closed_ellipsoid(n: int) -> Congruence:
    """A whole triaxial ellipsoid, made of six grids."""
    line = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))
    u, v = np.meshgrid(line, line, indexing="ij")
    points, faces = [], []
    for axis in range(3):
        for side in (1.0, -1.0):
            ids = len(points) * (n + 1) ** 2 + np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
            a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
            faces += [np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
            patch = np.stack([np.full_like(u, side), side * u, v], -1)
            points.append(np.roll(patch, axis, -1).reshape(-1, 3))
    joined = np.concatenate(points)
    joined /= norm(joined)[:, None]
    keys = np.rint(1e6 * joined).astype(np.int64)
    _, first, ids = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    axes = np.array([1.6, 1.2, 0.9])
    outward = joined[first] / axes
    outward /= norm(outward)[:, None]
    mesh = Mesh(joined[first] * axes, ids.ravel()[np.concatenate(faces)])
    return mesh, touching_spheres(mesh.vertices, outward, -2.0)


def dome() -> Congruence:
    """A piece of a sphere, all of whose directions are conjugate, with one side to align to."""
    line = np.linspace(-0.8, 0.8, 21)
    u, v = (grid.ravel() for grid in np.meshgrid(line, line, indexing="ij"))
    ids = np.arange(len(u)).reshape(21, 21)
    a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
    faces = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    points = np.stack([u, v, np.sqrt(4 - u * u - v * v)], 1)
    return Mesh(points, faces), touching_spheres(points, points / 2, -2.0)


def prepared(
    congruence: Congruence, smoothing: float = 1.0
) -> tuple[CongruenceMesh, VertexFans, CombedFrames]:
    surface = congruence_mesh(*congruence)
    form = smooth_forms(surface, *conjugate_field(fit_jets(surface)[0]), length=smoothing)
    fans = vertex_fans(
        surface.topology, surface.triangles.ravel(), np.arange(len(surface.points))
    )
    return surface, fans, comb_frames(surface, fans, *form, 0.3)


def characteristic(mesh: Mesh) -> int:
    topology = mesh.topology
    n_edges = len(topology.edge_corners) + int((topology.twins < 0).sum())
    return mesh.n_vertices - n_edges + mesh.n_faces


def edge_lengths(mesh: Mesh) -> FloatArray:
    return norm(
        mesh.vertices[mesh.corners[mesh.topology.next_corners]] - mesh.vertices[mesh.corners]
    )


# Integers


@settings(max_examples=40, deadline=None)
@given(arrays(np.int64, (3, 5), elements=st.integers(-4, 4)), st.integers(0, 5))
def test_whole_number_solutions_are_all_there_is(relations: FloatArray, seed: int) -> None:
    rng = np.random.default_rng(seed)
    wanted = rng.integers(-3, 4, 5)
    found = integer_solutions(relations.astype(float), (relations @ wanted).astype(float))
    np.testing.assert_array_equal(relations @ found.offset, relations @ wanted)
    np.testing.assert_array_equal(relations @ found.basis, 0)
    assert found.basis.shape[1] == 5 - np.linalg.matrix_rank(relations)
    # The solution that was known is among them, with whole numbers.
    share = np.linalg.lstsq(found.basis, wanted - found.offset, rcond=None)[0]
    np.testing.assert_allclose(share, np.rint(share), atol=1e-8)
    np.testing.assert_allclose(found.basis @ share, wanted - found.offset, atol=1e-8)


def test_whole_numbers_that_contradict_each_other_are_refused() -> None:
    for relations, constants in (([[2.0, 4.0]], [3.0]), ([[1.0, 1.0], [1.0, 1.0]], [0.0, 1.0])):
        with pytest.raises(ContradictionError):
            integer_solutions(np.array(relations), np.array(constants))


def test_rounding_satisfies_the_equations_and_stays_near_the_minimum() -> None:
    rng = np.random.default_rng(0)
    root = rng.normal(size=(12, 8))
    hessian, gradient = root.T @ root, 5 * rng.normal(size=8)
    relations = rng.integers(-2, 3, (2, 8)).astype(float)
    solutions = integer_solutions(relations, np.zeros(2))
    function = Quadratic(hessian, gradient, float(np.diag(hessian).max()))
    numbers = round_minimum(function, solutions, 3)
    assert (numbers == np.rint(numbers)).all()
    assert (relations @ numbers == 0).all()

    def _value(n: FloatArray) -> float:
        return float(n @ hessian @ n / 2 - gradient @ n)

    relaxed = relaxed_minimum(function, solutions)
    np.testing.assert_allclose(relations @ relaxed, 0, atol=1e-9)
    assert _value(relaxed) <= _value(numbers)
    for step in np.eye(solutions.basis.shape[1]):
        for sign in (-1, 1):
            moved = numbers + sign * solutions.basis @ step
            assert _value(moved) >= _value(numbers) - 1e-9


# Fields and seams


@pytest.mark.parametrize(
    ("shape", "edge", "total"), [("torus", 0.3, 0), ("ellipsoid", 0.12, 4), ("bump", 0.15, 0)]
)
def test_indices_add_up(shape: SampleShape, edge: float, total: int) -> None:
    # Four umbilics of half a turn on an ellipsoid, none on the others.
    frames = prepared(constant_radius(shape, edge))[2]
    assert frames.indices.sum() == total
    assert np.abs(frames.indices).sum() == abs(total)


def test_a_monkey_saddle_has_one_singular_vertex_in_the_middle() -> None:
    mesh, spheres = monkey_saddle(20)
    frames = prepared((mesh, spheres))[2]
    assert frames.indices.sum() == -1
    assert norm(mesh.vertices[np.flatnonzero(frames.indices)]).max() < 0.2


def test_the_field_is_the_same_in_other_frames_and_smoothing_keeps_constants() -> None:
    congruence = constant_radius("hypar", 0.2)
    surface = congruence_mesh(*congruence)
    trace, deviator = conjugate_field(fit_jets(surface)[0])
    angles = np.random.default_rng(3).uniform(0, 6, len(trace))
    cosine, sine = np.cos(angles)[:, None], np.sin(angles)[:, None]
    first, second, upward = surface.vertex_frames.transpose(1, 0, 2)
    turned = np.stack(
        [cosine * first + sine * second, cosine * second - sine * first, upward], 1
    )
    other = dataclasses.replace(surface, vertex_frames=turned)
    factor = np.exp(-2j * angles)
    one = smooth_forms(surface, trace, deviator, 2.0)
    two = smooth_forms(other, trace, deviator * factor, 2.0)
    np.testing.assert_allclose(two[0], one[0], atol=1e-10)
    np.testing.assert_allclose(two[1], one[1] * factor, atol=1e-10)
    constant = smooth_forms(surface, np.ones(len(trace)), 0j * deviator, 3.0)
    np.testing.assert_allclose(constant[0], 1, atol=1e-10)


@pytest.mark.parametrize("shape", ["torus", "annulus", "ellipsoid", "closed"])
def test_shifts_close_around_every_vertex(shape: SampleShape | Literal["closed"]) -> None:
    if shape == "closed":
        congruence = closed_ellipsoid(12)
    else:
        congruence = constant_radius(shape, 0.3 if shape == "torus" else 0.15)
    surface, fans, frames = prepared(congruence)
    seams = find_seams(surface, fans, frames)
    rng = np.random.default_rng(1)
    # Any integers that satisfy the relations, and any values, fit together on all edges.
    allowed = integer_solutions(seams.relations, np.zeros(len(seams.relations)))
    integers = allowed.basis @ rng.integers(-5, 6, allowed.basis.shape[1])
    values = rng.normal(size=len(surface.points))
    values[seams.singular] = integers[: len(seams.singular)]
    corners = seams.signs * values[surface.triangles.ravel()] + seams.shifts @ integers
    topology = surface.topology
    here, there = topology.edge_corners, topology.twins[topology.edge_corners]
    signs = frames.signs[here]
    start = corners[topology.next_corners[there]] - signs * corners[here]
    end = corners[there] - signs * corners[topology.next_corners[here]]
    np.testing.assert_allclose(start, end, atol=1e-9)
    np.testing.assert_allclose(start, np.rint(start), atol=1e-9)
    np.testing.assert_allclose(start[~frames.is_seam[here]], 0, atol=1e-9)


# Maps


def test_derivatives_of_the_distortion() -> None:
    rng = np.random.default_rng(2)
    jacobians = rng.normal(size=(30, 2, 2))
    for softness in (1.0, 0.1):
        value, slopes, curvatures = distortion(jacobians, softness)
        assert (
            np.linalg.eigvalsh(curvatures) > -1e-9 * np.abs(curvatures).max((1, 2))[:, None]
        ).all()
        for entry in range(4):
            step = np.zeros(4)
            step[entry] = 1e-6
            ahead = distortion(jacobians + step.reshape(2, 2), softness)[0]
            behind = distortion(jacobians - step.reshape(2, 2), softness)[0]
            np.testing.assert_allclose(
                (ahead - behind) / 2e-6,
                slopes[:, entry],
                rtol=1e-5,
                atol=1e-5 * np.abs(value).max(),
            )


def test_maps_follow_the_directions_with_the_length_asked_for() -> None:
    surface, fans, frames = prepared(constant_radius("hypar", 0.1))
    mapped = parametrize(surface, fans, frames, find_seams(surface, fans, frames), 2.0)
    jacobians = mapped.charts.jacobians(mapped.values)
    # Rows u and v along the first and second direction: nearly diagonal, about 1.
    assert np.quantile(np.abs(jacobians[:, [0, 1], [1, 0]]), 0.95) < 0.25
    weights = surface.face_areas / surface.face_areas.sum()
    np.testing.assert_allclose(weights @ jacobians[:, [0, 1], [0, 1]], 1, atol=0.08)
    assert mapped.n_folded == 0


def test_folds_are_unfolded() -> None:
    surface, fans, frames = prepared(constant_radius("waves", 0.12))
    mapped = parametrize(surface, fans, frames, find_seams(surface, fans, frames), 1.5)
    assert mapped.n_folded > 0
    assert not mapped.is_flipped.any()


# Nets


@pytest.mark.parametrize(
    ("shape", "edge", "length", "euler", "sides"),
    [
        ("torus", 0.2, 0.35, 0, 0), ("annulus", 0.12, 0.2, 0, 2),
        ("hypar", 0.12, 0.2, 1, 4), ("bump", 0.12, 0.2, 1, 0),
    ],
)  # fmt: skip
def test_nets_of_simple_surfaces_are_regular(
    shape: SampleShape, edge: float, length: float, euler: int, sides: int
) -> None:
    mesh, spheres = constant_radius(shape, edge)
    done = remesh(mesh, spheres, length)
    net = done.sphere_mesh.mesh
    assert done.n_irregular == 0
    assert done.n_flipped == 0
    assert done.n_aligned == sides
    assert characteristic(net) == euler
    assert len(done.indices) == 0
    inner = ~net.topology.is_boundary_vertex
    whole = (
        np.bincount(net.topology.corner_faces, inner[net.corners], net.n_faces) == net.degrees
    )
    assert (net.degrees[whole] == 4).all()
    if shape != "bump":
        assert (net.degrees == 4).all()
    lengths = edge_lengths(net)
    assert lengths.mean() == pytest.approx(length, rel=0.12)
    assert lengths.min() > 0.3 * lengths.mean()
    # The net covers the surface, and its normals and spheres agree.
    area = (
        norm(
            np.cross(
                *np.diff(mesh.vertices[mesh.corners.reshape(-1, 3)], axis=1).transpose(1, 0, 2)
            )
        ).sum()
        / 2
    )
    assert norm(face_normals(net)).min() > 0.99
    parts = [
        np.cross(
            net.vertices[f[1]] - net.vertices[f[0]], net.vertices[f[2]] - net.vertices[f[0]]
        )
        for f in net.faces
    ]
    parts += [
        np.cross(
            net.vertices[f[2]] - net.vertices[f[0]], net.vertices[f[3]] - net.vertices[f[0]]
        )
        for f in net.faces
        if len(f) > 3
    ]
    assert norm(np.array(parts)).sum() / 2 == pytest.approx(area, rel=0.06)
    upward = normals(done.sphere_mesh.local_spheres, np.zeros((net.n_faces, 3)))
    assert (dot(upward, face_normals(net)) > 0).all()


def test_law_f8_spheres_around_a_node_nearly_share_two_points() -> None:
    mesh, spheres = constant_radius("hypar", 0.05)
    ratios = []
    for length in (0.4, 0.2):
        done = remesh(mesh, spheres, length)
        net = done.sphere_mesh.mesh
        order = np.argsort(net.corners, kind="stable")
        counts = np.bincount(net.corners, minlength=net.n_vertices)
        starts = np.cumsum(counts) - counts
        nodes = np.flatnonzero(~net.topology.is_boundary_vertex)
        faces = net.topology.corner_faces[order[starts[nodes, None] + np.arange(4)]]
        rows = recenter(
            done.sphere_mesh.local_spheres[faces],
            net.vertices[nodes, None] - face_centroids(net)[faces],
        )
        values = np.linalg.svd(pentaspherical(rows), compute_uv=False)
        ratios.append(float(np.median(values[:, 3] / values[:, 2])))
    # For other nets the ratio falls with the edge length, for conjugate ones with its square.
    assert ratios[0] < 0.1
    assert ratios[1] < 0.5 * ratios[0]


def test_singular_points_keep_their_degree() -> None:
    done = remesh(*monkey_saddle(24), edge_length=0.2)
    net = done.sphere_mesh.mesh
    assert done.indices.tolist() == [-1]
    assert done.n_flipped == 0
    nearest = np.argmin(norm(face_centroids(net) - done.singular_points[0]))
    assert net.degrees[nearest] == 6
    assert done.n_irregular == 0
    lemons = remesh(*constant_radius("ellipsoid", 0.1, -0.5), edge_length=0.25)
    assert lemons.indices.tolist() == [1, 1, 1, 1]
    assert lemons.n_irregular == 8
    assert lemons.n_digons == 4
    assert lemons.n_flipped == 0
    assert lemons.shortest_edge > 0.2 * mean_edge_length(lemons.sphere_mesh.mesh)


def test_singular_points_within_a_step_are_kept_apart() -> None:
    # Umbilics at ±0.08, with steps of 0.3.
    mesh, spheres = harmonic_graph(40, Polynomial([0, 0, -6 * 0.1 * 0.08**2, 0, 0.1]))
    done = remesh(mesh, spheres, 0.3, smoothing=0.1)
    assert done.indices.tolist() == [-1, -1]
    degrees = done.sphere_mesh.mesh.degrees
    assert (degrees == 6).sum() == 2
    assert degrees.max() == 6
    assert done.n_flipped == 0


@pytest.mark.parametrize("offset", [-5.0, 2.0])
def test_spheres_that_pass_principal_spheres_give_regular_nets(offset: float) -> None:
    done = remesh(*constant_radius("torus", 0.2, offset), edge_length=0.35)
    assert done.complex_share < 0.01
    assert (done.n_irregular, done.n_flipped, len(done.indices)) == (0, 0, 0)
    assert (done.sphere_mesh.mesh.degrees == 4).all()


def test_a_closed_net_with_four_lemons() -> None:
    mesh, spheres = closed_ellipsoid(16)
    done = remesh(mesh, spheres, 0.25)
    net = done.sphere_mesh.mesh
    assert done.indices.tolist() == [1, 1, 1, 1]
    assert done.n_flipped == 0
    assert done.n_irregular == 8
    assert characteristic(net) == 2
    assert (net.degrees == 4).all()
    assert done.shortest_edge > 0.2 * mean_edge_length(net)


def test_a_piece_of_a_sphere_gets_some_net() -> None:
    # All directions are conjugate: rounding chooses, and every choice must give a whole net.
    mesh, spheres = dome()
    done = remesh(mesh, spheres, 0.3)
    net = done.sphere_mesh.mesh
    assert done.n_flipped == 0
    assert characteristic(net) == 1
    areas, covered = (norm(face_vector_areas(m)).sum() for m in (mesh, net))
    assert covered == pytest.approx(areas, rel=0.005)
    # Nodes lie on the triangles: none is nearer to the centre than the longest edge's middle.
    nodes = norm(net.vertices[~net.topology.is_boundary_vertex])
    assert np.sqrt(4 - (edge_lengths(mesh).max() / 2) ** 2) - 1e-12 <= nodes.min()
    assert nodes.max() <= 2 + 1e-12
    assert mean_edge_length(net) == pytest.approx(0.3, rel=0.08)


def matched(one: Remeshing, two: Remeshing, points: FloatArray) -> float:
    """Largest distance of the given images of the vertices of one net to those of the other."""
    from scipy.spatial import cKDTree

    assert one.sphere_mesh.mesh.n_vertices == two.sphere_mesh.mesh.n_vertices
    assert one.sphere_mesh.mesh.n_faces == two.sphere_mesh.mesh.n_faces
    return float(cKDTree(two.sphere_mesh.mesh.vertices).query(points)[0].max())


@settings(max_examples=5, deadline=None)
@given(st.sampled_from([1e-3, 1.0, 1e3]), st.sampled_from([0.0, 1e5]))
def test_nets_do_not_depend_on_units_and_place(scale: float, distance: float) -> None:
    mesh, upward = triangulated_surface("hypar", 0.2, seed=1)
    done = remesh(mesh, touching_spheres(mesh.vertices, upward, 2.0), 0.3)
    shift = distance * np.array([1.0, -0.4, 0.3])
    points = scale * (mesh.vertices + shift)
    moved = remesh(
        Mesh(points, mesh.faces), touching_spheres(points, upward, 2.0 / scale), 0.3 * scale
    )
    expected = scale * (done.sphere_mesh.mesh.vertices + shift)
    assert matched(done, moved, expected) < scale * (1e-5 + 1e-9 * distance)


@pytest.mark.parametrize("shape", ["bump", "hypar", "annulus"])
def test_nets_do_not_depend_on_numbers(shape: SampleShape) -> None:
    mesh, spheres = constant_radius(shape, 0.15)
    done = remesh(mesh, spheres, 0.25)
    rng = np.random.default_rng(6)
    order = rng.permutation(mesh.n_vertices)
    faces = np.argsort(order)[mesh.corners.reshape(-1, 3)][rng.permutation(mesh.n_faces)]
    faces = np.stack(
        [np.roll(f, k) for f, k in zip(faces, rng.integers(0, 3, len(faces)), strict=True)]
    )
    again = remesh(Mesh(mesh.vertices[order], faces), spheres[order], 0.25)
    if shape == "annulus":
        # Around a ring the phase is free.
        assert again.sphere_mesh.mesh.n_faces == done.sphere_mesh.mesh.n_faces
    else:
        assert matched(done, again, done.sphere_mesh.mesh.vertices) < 1e-6


def test_turning_the_mesh_over_turns_the_net_over() -> None:
    mesh, spheres = constant_radius("hypar", 0.15)
    done = remesh(mesh, spheres, 0.25)
    over = remesh(Mesh(mesh.vertices, mesh.corners.reshape(-1, 3)[:, ::-1]), -spheres, 0.25)
    assert matched(done, over, done.sphere_mesh.mesh.vertices) < 1e-6
    one, two = (face_normals(net.sphere_mesh.mesh).mean(axis=0) for net in (done, over))
    np.testing.assert_allclose(one, -two, atol=1e-6)


def test_bad_edge_lengths_are_refused() -> None:
    mesh, spheres = constant_radius("hypar", 0.2)
    for length, words in (
        (0.0, "must be positive"), (np.nan, "must be positive"), (3.0, "too large"),
        (0.01, "finer than the mesh"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            remesh(mesh, spheres, length)
    torus, around = constant_radius("torus", 0.3, -0.5)
    with pytest.raises(InputError, match="too large"):
        remesh(torus, around, 3.5)


@pytest.mark.parametrize(("length", "n_covered"), [(0.4, 1), (0.1, 0)])
def test_holes_within_a_face_are_covered_and_counted(length: float, n_covered: int) -> None:
    mesh, spheres = constant_radius("hypar", 0.2, 0.9)
    triangles = mesh.corners.reshape(-1, 3)
    centers = mesh.vertices[triangles].mean(axis=1)
    # A hole as wide as half an edge of the net, in the middle of one of its faces.
    hole = int(norm(centers[:, :2] - [0.03, 0.28]).argmin())
    done = remesh(Mesh(mesh.vertices, np.delete(triangles, hole, axis=0)), spheres, length)
    net = done.sphere_mesh.mesh
    assert done.n_covered == n_covered
    assert characteristic(net) == n_covered
    assert np.unique(net.topology.edge_faces).size == net.n_faces


def test_narrow_holes_where_lines_crowd_stay_open() -> None:
    # A bell around a hole one edge wide: lines leave it a quarter of an edge apart.
    turns, radii = 2 * np.pi * np.arange(60) / 60, np.linspace(0.3, 2.2, 25)
    u, r = (grid.ravel() for grid in np.meshgrid(turns, radii, indexing="ij"))
    points = np.stack([r * np.cos(u), r * np.sin(u), np.exp(-r * r)], 1)
    ids = np.arange(60 * 25).reshape(60, 25)
    ahead = np.roll(ids, -1, axis=0)
    a, b, c, d = ids[:, :-1], ids[:, 1:], ahead[:, 1:], ahead[:, :-1]
    mesh = Mesh(
        points, np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    )
    upward = np.stack([2 * r * np.cos(u), 2 * r * np.sin(u), np.exp(r * r)], 1)
    upward /= norm(upward)[:, None]
    done = remesh(mesh, touching_spheres(points, upward, -2.5), 0.3)
    assert done.n_covered == done.n_irregular == 0
    assert characteristic(done.sphere_mesh.mesh) == 0
