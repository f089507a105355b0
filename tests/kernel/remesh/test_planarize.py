"""Laws of planar nodes (E1 to E3, F8): what has them stays, what nearly has them gets them."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm, unit
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.congruences.discrete_envelopes import envelope, mirror_points
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.remesh.planar.conditions import (
    NetState,
    PlanarSystem,
    energies,
    move,
    planar_residuals,
    planar_system,
)
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes, node_axis_angles
from spheremesh.kernel.remesh.planar.planarize import planarize
from spheremesh.kernel.remesh.planar.steps import linearize, step_norm
from spheremesh.kernel.remesh.reports import planarization_report
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.mobius import map_sphere_mesh
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.spheres.mobius_group import inversion
from spheremesh.kernel.spheres.rows import (
    center_radius,
    from_center_radius,
    lift_points,
    normalize,
    recenter,
    rescale,
)
from spheremesh.kernel.support.node_axes import support_structure
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net, vase_net

PRODUCT = np.zeros((5, 5))
PRODUCT[1:4, 1:4] = np.eye(3)
PRODUCT[0, 4] = PRODUCT[4, 0] = -2.0


def constant_radius_torus(n: int = 24, m: int = 12) -> SphereMesh:
    """Spheres of radius 1.2 that touch a torus in a net of its curvature lines."""
    u, v = np.meshgrid(np.arange(n) / n, np.arange(m) / m, indexing="ij")
    u, v = 2 * np.pi * u, 2 * np.pi * v
    around = np.stack([np.cos(u), np.sin(u), 0 * u], -1)
    normals = np.cos(v)[..., None] * around + np.sin(v)[..., None] * [0, 0, 1.0]
    points, normals = (3 * around + normals).reshape(-1, 3), normals.reshape(-1, 3)
    ids = np.arange(n * m).reshape(n, m)
    after, above = np.roll(ids, -1, 0), np.roll(ids, -1, 1)
    contacts = Mesh(
        points, np.stack([ids, after, np.roll(after, -1, 1), above], -1).reshape(-1, 4)
    )
    rows = touching_spheres(points, normals, 1 / 1.2)
    before, below = np.roll(ids, 1, 0), np.roll(ids, 1, 1)
    faces = np.stack([np.roll(before, 1, 1), below, ids, before], -1).reshape(-1, 4)
    return SphereMesh(Mesh(envelope(contacts, rows).points_plus, faces), rows)


def exact_nets() -> dict[str, SphereMesh]:
    return {
        "vase": central_spheres(vase_net(20, 12, 1.0, 3.0, 0.3)),
        "torus": central_spheres(torus_net(24, 12, 3.0, 1.0)),
        "constant radius": constant_radius_torus(),
        "planes": face_planes(torus_net(24, 12, 3.0, 1.0)),
    }


def perturbed(exact: SphereMesh, size: float = 0.003, seed: int = 1) -> SphereMesh:
    """Nodes and spheres moved by shares of the mean edge and of the curvature."""
    rng = np.random.default_rng(seed)
    mesh, edge = exact.mesh, mean_edge_length(exact.mesh)
    rows = rescale(exact.local_spheres, 1 / edge)
    curvature = max(np.abs(rows[:, 0]).max(), 0.01)
    noise = rng.normal(size=rows.shape) * [curvature, 1, 1, 1, 1]
    points = mesh.vertices + size * edge * rng.normal(size=mesh.vertices.shape)
    rows = rescale(rows + size * noise, edge)
    return SphereMesh.from_local(Mesh(points, mesh.faces), rows)


def assert_torsion_free(result: SphereMesh) -> None:
    assert measure_nodes(result).planarity.max() < 1e-9
    assert vertex_error(result).max() < 1e-6 * mean_edge_length(result.mesh)


@pytest.mark.parametrize("name", ["vase", "torus", "constant radius", "planes"])
def test_law_f8_exact_nets_stay(name: str) -> None:
    exact = exact_nets()[name]
    assert_torsion_free(exact)
    result = planarize(exact)
    assert result.status == "converged"
    np.testing.assert_array_equal(result.sphere_mesh.mesh.vertices, exact.mesh.vertices)
    np.testing.assert_allclose(result.sphere_mesh.spheres, exact.spheres, atol=1e-14)


@pytest.mark.parametrize("name", ["vase", "torus", "constant radius", "planes"])
def test_law_f8_perturbed_nets_become_torsion_free_again(name: str) -> None:
    start = perturbed(exact_nets()[name])
    assert measure_nodes(start).planarity.max() > 1e-3
    result = planarize(start)
    assert result.status == "converged"
    assert_torsion_free(result.sphere_mesh)
    assert result.shifts.max() < 0.5
    assert result.shifts.mean() < 0.1
    moved = norm(result.sphere_mesh.mesh.vertices - start.mesh.vertices)
    np.testing.assert_allclose(moved / mean_edge_length(start.mesh), result.shifts, atol=1e-12)


def test_law_f8_a_smooth_net_moves_by_its_gap() -> None:
    """Nodes beside their spheres and the spheres meet half-way; radii hardly change."""
    exact = constant_radius_torus(48, 24)
    mesh = exact.mesh
    inwards = unit(mesh.vertices - 3 * unit(mesh.vertices * [1, 1, 0]))
    start = SphereMesh(Mesh(mesh.vertices - 0.01 * inwards, mesh.faces), exact.spheres)
    result = planarize(start)
    assert_torsion_free(result.sphere_mesh)
    assert norm(result.sphere_mesh.mesh.vertices - mesh.vertices).max() < 0.007
    _, square = center_radius(result.sphere_mesh.spheres)
    assert np.abs(np.sqrt(square) - 1.2).max() < 0.02


def test_law_e1_spheres_of_a_planarized_node_meet_in_a_second_point() -> None:
    start = perturbed(exact_nets()["torus"])
    result = planarize(start).sphere_mesh
    edge = mean_edge_length(result.mesh)
    before, after = mirror_points(start), mirror_points(result)
    assert np.nanmax(before.residuals) > 1e-3 * edge
    assert after.is_valid.all()
    assert after.residuals.max() < 1e-8 * edge
    nodes = measure_nodes(result)
    assert nodes.is_real.all()
    chords = unit(after.points - result.mesh.vertices)
    assert norm(np.cross(chords, nodes.axes)).max() < 1e-8


def test_law_e2_planarity_is_invariant_under_inversions() -> None:
    result = planarize(perturbed(exact_nets()["vase"])).sphere_mesh
    image = map_sphere_mesh(result, inversion([4.0, 1.0, -2.0], 3.0))
    assert measure_nodes(image).planarity.max() < 1e-9
    nodes = measure_nodes(image)
    assert nodes.is_real[nodes.is_inner].all()


def test_law_e3_arc_planes_contain_the_axis_of_their_node() -> None:
    result = planarize(perturbed(exact_nets()["constant radius"])).sphere_mesh
    nodes, topology = measure_nodes(result), result.mesh.topology
    for end in (0, 1):
        vertices = topology.edge_vertices[:, end]
        left, right = (
            recenter(result.spheres[faces], result.mesh.vertices[vertices])
            for faces in topology.edge_faces.T
        )
        planes = right[:, :1] * left - left[:, :1] * right
        sizes = norm(planes[:, 1:4])
        assert (np.abs(planes[:, 4]) / sizes).max() < 1e-9
        assert (np.abs(dot(planes[:, 1:4], nodes.axes[vertices])) / sizes).max() < 1e-9


def test_law_e3_axes_are_normal_to_the_faces_of_the_centers() -> None:
    exact = constant_radius_torus()
    centers, _ = center_radius(exact.spheres)
    nodes = measure_nodes(exact)
    for vertex in range(0, exact.mesh.n_vertices, 7):
        around = centers[[vertex in face for face in exact.mesh.faces]]
        normal = np.linalg.svd(around - around.mean(0))[2][2]
        assert norm(np.cross(normal, nodes.axes[vertex])) < 1e-10
    # Centres lie on a parallel surface: what is left is of the second order.
    fine = constant_radius_torus(48, 24)
    errors = (
        node_axis_angles(exact, nodes).max(),
        node_axis_angles(fine, measure_nodes(fine)).max(),
    )
    assert np.degrees(errors[0]) < 4
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.parametrize(("radius", "is_real"), [(0.5, False), (0.7, False), (0.72, True)])
def test_nodes_are_real_if_the_radii_reach_the_node(radius: float, *, is_real: bool) -> None:
    """Four unit squares and spheres about their centres, at 1 / sqrt 2 from the axis."""
    grid = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], [0.0]), -1).reshape(-1, 3)
    grid[4, 2] = 0.3
    mesh = Mesh(grid, [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])
    centers = np.array([[-1, -1, 0], [1, -1, 0], [-1, 1, 0], [1, 1, 0]]) / 2
    spheres = from_center_radius(centers, np.full(4, radius**2))
    nodes = measure_nodes(SphereMesh(mesh, spheres))
    assert nodes.is_inner.tolist() == [v == 4 for v in range(9)]
    assert nodes.is_real.tolist() == [is_real and v == 4 for v in range(9)]
    np.testing.assert_allclose(np.abs(nodes.axes[4]), [0, 0, 1], atol=1e-12)


def test_boundary_nodes_lie_on_their_spheres_and_nothing_more() -> None:
    start = perturbed(central_spheres(vase_net(16, 2, 1.0, 3.0, 0.3)), 0.002)
    result = planarize(start)
    assert_torsion_free(result.sphere_mesh)
    strip = perturbed(central_spheres(ellipsoid_net(12, 1, 1.0, 1.4, 0.4)), 0.01)
    assert not measure_nodes(strip).is_inner.any()
    assert vertex_error(strip).max() > 1e-3
    assert planarize(strip).status == "converged"
    assert_torsion_free(planarize(strip).sphere_mesh)


@pytest.mark.parametrize("count", [3, 4])
def test_boundary_nodes_need_an_axis_if_three_beams_meet_there(count: int) -> None:
    """Some of the five quads around a vertex, each with the sphere through its corners."""
    rng = np.random.default_rng(2)
    turn = 2 * np.pi * np.arange(10) / 10
    ring = np.stack([np.cos(turn), np.sin(turn), 0.3 * rng.normal(size=10)], 1)
    points = np.vstack([[[0, 0, 0]], ring])
    quads = np.array([[0, 1 + 2 * i, 2 + 2 * i, 3 + 2 * i] for i in range(count)])
    rows = np.linalg.svd(lift_points(points)[quads] @ PRODUCT)[2][:, 4]
    normals_up = rows[:, 3] > 0
    spheres = normalize(np.where(normals_up, 1.0, -1.0)[:, None] * rows)
    start = SphereMesh(Mesh(points, quads), spheres)
    assert vertex_error(start).max() < 1e-12
    before = measure_nodes(start)
    assert not before.is_inner.any()
    result = planarize(start)
    assert_torsion_free(result.sphere_mesh)
    if count == 3:
        assert before.planarity.max() == result.shifts.max() == 0
    else:
        assert before.planarity.max() > 0.01
        assert result.shifts.max() > 0
        assert support_structure(result.sphere_mesh).torsion.max() < 1e-6
        assert support_structure(start).torsion.max() > 1e-3


def test_faces_of_mixed_degree() -> None:
    """A net with quads cut into triangles, and with pairs of quads joined to hexagons."""
    exact = constant_radius_torus()
    faces = [face.tolist() for face in exact.mesh.faces]
    rows = exact.spheres
    cut = [0, 40, 100]
    joined = [(5, 17), (150, 162)]
    faces += [[faces[i][2], faces[i][3], faces[i][0]] for i in cut]
    rows = np.concatenate([rows, rows[cut]])
    for i in cut:
        faces[i] = faces[i][:3]
    for i, j in joined:
        first, second = faces[i], faces[j]
        start = next(k for k in range(4) if first[k] in second and first[k - 1] not in second)
        turn = second.index(first[start])
        tail = [second[(turn + k) % 4] for k in range(1, 4)]
        faces[i] = [first[start], *tail, *[first[(start + k) % 4] for k in (2, 3)]]
    keep = [f for f in range(len(faces)) if f not in {j for _, j in joined}]
    mixed = SphereMesh(Mesh(exact.mesh.vertices, [faces[f] for f in keep]), rows[keep])
    assert sorted(set(mixed.mesh.degrees.tolist())) == [3, 4, 6]
    result = planarize(perturbed(mixed))
    assert result.status == "converged"
    assert_torsion_free(result.sphere_mesh)


@settings(max_examples=8)
@given(
    scale=st.floats(1e-3, 1e3), seed=st.integers(0, 99), distance=st.sampled_from([0.0, 1e3])
)
def test_law_f8_similarities_commute(scale: float, seed: int, distance: float) -> None:
    rng = np.random.default_rng(seed)
    turn, shift = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3) * distance
    turn *= np.sign(np.linalg.det(turn))
    start = perturbed(central_spheres(torus_net(8, 6, 3.0, 1.0)))
    rows = start.local_spheres.copy()
    rows[:, 1:4] = rows[:, 1:4] @ turn.T
    points = scale * (start.mesh.vertices @ turn.T + shift)
    image = SphereMesh.from_local(Mesh(points, start.mesh.faces), rescale(rows, scale))
    expected, found = planarize(start).sphere_mesh, planarize(image).sphere_mesh
    moved = expected.mesh.vertices @ turn.T + shift
    np.testing.assert_allclose(found.mesh.vertices / scale, moved, atol=1e-7)
    local = expected.local_spheres.copy()
    local[:, 1:4] = local[:, 1:4] @ turn.T
    np.testing.assert_allclose(rescale(found.local_spheres, 1 / scale), local, atol=1e-7)


def test_law_f8_a_million_edges_from_the_origin() -> None:
    start = perturbed(constant_radius_torus())
    shift = np.array([1e6, -7e5, 4e5]) * mean_edge_length(start.mesh)
    mesh = Mesh(start.mesh.vertices + shift, start.mesh.faces)
    found = planarize(SphereMesh.from_local(mesh, start.local_spheres)).sphere_mesh
    expected = planarize(start).sphere_mesh
    assert_torsion_free(found)
    # The coordinates of the vertices are rounded by 1e-10 edges.
    np.testing.assert_allclose(found.mesh.vertices - shift, expected.mesh.vertices, atol=1e-6)
    np.testing.assert_allclose(found.local_spheres, expected.local_spheres, atol=1e-6)


def test_law_f8_numbering_does_not_matter(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
) -> None:
    start = perturbed(constant_radius_torus())
    mesh, new = renumber(start.mesh)
    rows = np.empty_like(start.spheres)
    rows[new] = start.spheres
    found, expected = planarize(SphereMesh(mesh, rows)), planarize(start)
    np.testing.assert_allclose(
        found.sphere_mesh.spheres[new], expected.sphere_mesh.spheres, atol=1e-8
    )
    np.testing.assert_allclose(np.sort(found.shifts), np.sort(expected.shifts), atol=1e-8)


def small_problem() -> tuple[PlanarSystem, NetState]:
    """A net with a boundary, spheres of mixed degree, and a net away from its start."""
    system = planar_system(perturbed(central_spheres(vase_net(5, 3, 1.0, 3.0, 0.3)), 0.02))
    rng = np.random.default_rng(3)
    size = 5 * len(system.start.rows) + 7 * len(system.start.shifts)
    net = move(system.start, 0.05 * rng.normal(size=size))
    return system, NetState(net.rows, net.shifts, net.normals * system.is_planar[:, None])


def stacked(system: PlanarSystem, net: NetState) -> FloatArray:
    return np.concatenate([r.ravel() for r in planar_residuals(system, net)])


def differences(system: PlanarSystem, net: NetState) -> FloatArray:
    """Jacobian of all residuals by central differences; boundary normals are left out."""
    size = 5 * len(net.rows) + 7 * len(net.shifts)
    columns: list[FloatArray] = []
    for i in range(size):
        step = np.zeros(size)
        step[i] = 1e-5
        ahead, behind = stacked(system, move(net, step)), stacked(system, move(net, -step))
        columns.append((ahead - behind) / 2e-5)
    jacobian = np.stack(columns, 1)
    nodes = np.arange(len(net.shifts))[~system.is_planar]
    frozen = 5 * len(net.rows) + 7 * nodes[:, None] + np.arange(3, 7)
    jacobian[:, frozen.ravel()] = 0
    return jacobian


def dense_metric(system: PlanarSystem, net: NetState, fairness: float) -> FloatArray:
    """Squared norm of steps: spheres, shares of their differences, nodes by their edges."""
    mesh, n_faces, n_nodes = system.mesh, len(net.rows), len(net.shifts)
    size = mean_edge_length(mesh)
    result = np.eye(5 * n_faces + 7 * n_nodes)
    result[: 5 * n_faces, : 5 * n_faces] = np.kron(np.eye(n_faces), np.diag(system.scales**2))
    jumps: list[FloatArray] = []
    for first, left, right in zip(
        mesh.topology.edge_corners, *mesh.topology.edge_faces.T, strict=True
    ):
        ends = mesh.vertices[mesh.corners[[first, mesh.topology.next_corners[first]]]] / size
        jump = np.zeros((5, n_faces, 5))
        for sign, face in ((1, left), (-1, right)):
            center = mesh.vertices[mesh.faces[face]].mean(0) / size
            shifted = recenter(np.eye(5), ends.mean(0) - center).T
            jump[:, face] = sign * system.scales[:, None] * shifted
        jumps.append(jump.reshape(5, -1))
    apart = np.array([jump @ net.rows.ravel() for jump in jumps])
    squares = (apart**2).sum(1)
    for square, jump in zip(squares, jumps, strict=True):
        weight = fairness**2 * squares.mean() / (square + 1e-3 * squares.mean())
        result[: 5 * n_faces, : 5 * n_faces] += weight * jump.T @ jump
    points = mesh.vertices / size + net.shifts
    for node in range(n_nodes):
        around = [
            norm(points[tail] - points[head])
            for face in mesh.faces
            for tail, head in zip(face, np.roll(face, -1), strict=True)
            if node in (tail, head)
        ]
        place = 5 * n_faces + 7 * node + np.arange(7)
        result[place, place] = min(1.0, *around) ** -2
    return result


@pytest.mark.parametrize("fairness", [0.0, 1.5])
def test_steps_are_those_of_the_dense_system(fairness: float) -> None:
    system, net = small_problem()
    jacobian, residual = differences(system, net), stacked(system, net)
    metric = dense_metric(system, net, fairness)
    solve = linearize(system, net, step_norm(system, fairness))
    for damping in (1e-1, 1e-4):
        dense = np.linalg.solve(
            jacobian.T @ jacobian + damping * metric, -jacobian.T @ residual
        )
        found = solve(damping)
        np.testing.assert_allclose(found.step, dense, atol=1e-6)
        predicted = ((residual + jacobian @ found.step) ** 2).sum()
        assert found.predicted == pytest.approx(predicted, rel=1e-8)
        assert predicted < energies(system, net).sum()


def test_bad_fairness_is_refused() -> None:
    start = constant_radius_torus()
    for fairness in (-1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="fairness must be a number from 0 on"):
            planarize(start, fairness)


def test_fairness_keeps_neighbours_alike() -> None:
    start = perturbed(constant_radius_torus(), 0.003)
    roughness: list[float] = []
    for fairness in (0.0, 5.0):
        rows = planarize(start, fairness).sphere_mesh.local_spheres
        left, right = start.mesh.topology.edge_faces.T
        change = rows - start.local_spheres
        roughness.append(float(norm(change[left] - change[right]).mean()))
    assert roughness[1] < 0.9 * roughness[0]


def test_nodes_whose_spheres_share_a_circle_have_no_axis() -> None:
    same = SphereMesh(
        ellipsoid_net(12, 4, 1.0, 1.0, 1.0),
        np.tile(normalize(from_center_radius(np.zeros(3), np.array(1.0))), (48, 1)) * -1,
    )
    nodes = measure_nodes(same)
    assert np.isnan(nodes.axes).all()
    assert not nodes.is_real.any()
    assert planarize(same).shifts.max() == 0


def test_folded_nets_are_measured_all_the_same() -> None:
    """Faces back to back have no normals at their common vertices."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    rows = np.tile([0.0, 0, 0, 1, 0], (3, 1)) * [[1], [-1], [-1]]
    folded = SphereMesh(Mesh(square, [[0, 1, 2, 3], [3, 2, 1], [3, 1, 0]]), rows)
    nodes = measure_nodes(folded)
    assert nodes.is_inner.all()
    assert np.isnan(node_axis_angles(folded, nodes)).all()
    assert planarization_report(folded, planarize(folded))["turned_faces"] == []
