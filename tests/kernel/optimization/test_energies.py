"""Terms of energy (6): derivatives against differences, and what each is zero on."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.energies.freedom import (
    Freedom,
    free_directions,
    moved,
    project_displacements,
    pushed_out,
    tangent_to_spheres,
    vertex_freedom,
)
from spheremesh.kernel.optimization.energies.minimize import (
    EnergyProblem,
    energy_problem,
    minimize_energy,
    weighted_entries,
    weighted_residuals,
)
from spheremesh.kernel.optimization.energies.setting import (
    Group,
    Setting,
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.energies.table import TERMS, EnergyWeights, Term
from spheremesh.kernel.solvers.blocks import jacobian_matrix
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.nodes import ellipsoid_mesh, torus_mesh, vase_mesh

STEP = 1e-6


def hexagons() -> Mesh:
    """Hexagons of a bent honeycomb."""
    points, faces, index = [], [], {}

    def _vertex(x: float, y: float) -> int:
        key = (round(x, 6), round(y, 6))
        if key not in index:
            index[key] = len(points)
            points.append([x, y, 0.1 * x**2 - 0.07 * y**2 + 0.05 * x * y])
        return index[key]

    turns = np.arange(6) * np.pi / 3
    for row in range(4):
        for column in range(4):
            center = np.array([1.5 * column, 3**0.5 * (row + column % 2 / 2)])
            ring = center + np.stack([np.cos(turns), np.sin(turns)], axis=1)
            faces.append([_vertex(x, y) for x, y in ring])
    return Mesh(points, faces)


def triangles() -> Mesh:
    """A torus of triangles."""
    net = torus_mesh(9, 6)
    quads = np.array(net.faces)
    return Mesh(net.vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


MESHES = {
    "triangles": triangles,
    "quads": lambda: vase_mesh(7, 5),
    "hexagons": hexagons,
}


def rough_unknowns(mesh: Mesh, *, planes: bool, seed: int) -> Unknowns:
    """Unknowns that fulfil nothing, every third face a plane if asked for."""
    random = np.random.default_rng(seed)
    start = first_unknowns(fit_spheres(mesh))
    rows = start.spheres + 0.1 * random.normal(size=start.spheres.shape)
    if planes:
        rows[::3, 0] = 0
    rows /= np.sqrt(minkowski(rows, rows))[:, None]
    normals = start.normals + 0.2 * random.normal(size=start.normals.shape)
    moves = 0.05 * random.normal(size=start.displacements.shape)
    return Unknowns(rows, moves, unit(normals))


def rough_setting(mesh: Mesh, allowance: float = 0.0) -> Setting:
    weights = np.random.default_rng(5).uniform(0.2, 2, len(mesh.topology.edge_corners))
    return energy_setting(mesh, weights, 0.6, allowance)


def shifted(
    unknowns: Unknowns, group: int, ids: FloatArray, column: int, step: float
) -> Unknowns:
    name = ("spheres", "displacements", "normals")[group]
    table = getattr(unknowns, name).copy()
    table[ids, column] += step
    return replace(unknowns, **{name: table})


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("planes", [False, True], ids=["spheres", "some planes"])
@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.name)
def test_law_d8_d9_jacobians(term: Term, mesh: str, planes: bool) -> None:  # noqa: FBT001
    net = MESHES[mesh]()
    setting = rough_setting(net)
    unknowns = rough_unknowns(net, planes=planes, seed=3)
    blocks = term.blocks(setting)
    tables = term.jacobian(setting, unknowns)
    counts = (net.n_faces, net.n_vertices, len(setting.node_vertices))
    found = np.zeros((len(term.residuals(setting, unknowns)), sum(5 * c for c in counts)))
    expected = np.zeros_like(found)
    start = 0
    for group, (count, width) in enumerate(zip(counts, (5, 3, 3), strict=True)):
        for block, table in zip(blocks, tables, strict=True):
            if block.group == group:
                columns = start + width * block.ids[:, None] + np.arange(width)
                np.add.at(found, (np.arange(len(found))[:, None], columns), table)
        for element in range(count):
            for number in range(width):
                plus = shifted(unknowns, group, element, number, STEP)
                minus = shifted(unknowns, group, element, number, -STEP)
                change = term.residuals(setting, plus) - term.residuals(setting, minus)
                expected[:, start + width * element + number] = change / (2 * STEP)
        start += count * width
    assert np.abs(found - expected).max() <= 1e-7 * max(np.abs(expected).max(), 1)


def test_law_d8_jacobian_of_sphericity_beyond_an_allowance() -> None:
    net = vase_mesh(7, 5)
    setting = rough_setting(net, allowance=0.05)
    term = TERMS[0]
    unknowns = rough_unknowns(net, planes=True, seed=4)
    table = term.jacobian(setting, unknowns)[0]
    residuals = term.residuals(setting, unknowns)
    assert 0 < (residuals == 0).sum() < len(residuals)
    assert not table[residuals == 0].any()
    for number in range(5):
        plus = shifted(unknowns, Group.SPHERE, slice(None), number, STEP)
        minus = shifted(unknowns, Group.SPHERE, slice(None), number, -STEP)
        change = term.residuals(setting, plus) - term.residuals(setting, minus)
        np.testing.assert_allclose(table[:, number], change / (2 * STEP), atol=1e-7)


def test_an_allowance_is_a_distance() -> None:
    """Spheres grown by the allowance cost nothing, and by a little more do."""
    net = ellipsoid_mesh(10, 6)
    start = first_unknowns(minimize_angles(face_planes(net))[0])
    rows = start.spheres
    for sign in (1, -1):
        for excess, costs in ((1 - 1e-6, False), (1 + 1e-3, True)):
            distance = sign * 0.1 * excess
            grown = rows.copy()
            grown[:, 4] += distance - rows[:, 0] * distance**2
            grown[:, 0] = rows[:, 0]
            grown /= (1 - 2 * rows[:, 0] * distance)[:, None]
            unknowns = replace(start, spheres=grown)
            residuals = TERMS[0].residuals(rough_setting(net, allowance=0.1), unknowns)
            assert residuals.any() == costs


def assert_zero(name: str, sphere_mesh: SphereMesh, limit: float = 1e-12) -> None:
    setting = energy_setting(
        sphere_mesh.mesh, np.ones(len(sphere_mesh.mesh.topology.edge_corners))
    )
    term = next(term for term in TERMS if term.name == name)
    assert np.abs(term.residuals(setting, first_unknowns(sphere_mesh))).max() < limit


@given(scale=st.sampled_from([1e-3, 1.0, 1e3]))
def test_terms_vanish_where_they_should(scale: float) -> None:
    net = ellipsoid_mesh(12, 7)
    net = Mesh(net.vertices * scale + 100 * scale, net.faces)
    smooth, _ = minimize_angles(face_planes(net))
    for name in ("sphericity", "unit_norm", "dual_norm", "closeness"):
        assert_zero(name, smooth)
    planes = face_planes(net)
    for name in ("regularity", "support"):
        assert_zero(name, planes, 1e-30)
    ball = ellipsoid_mesh(12, 7, radius=2, height=2)
    rows = np.tile([-0.25, 0, 0, 0, 1.0], (ball.n_faces, 1))
    for name in ("sphericity", "angle", "regularity", "support"):
        assert_zero(name, SphereMesh(ball, rows), 1e-10)


def test_a_spike_costs_more_than_a_right_angle() -> None:
    net = ellipsoid_mesh(12, 7, radius=2, height=2)
    rows = np.tile([-0.25, 0, 0, 0, 1.0], (net.n_faces, 1))
    start = first_unknowns(SphereMesh(net, rows))
    setting = energy_setting(net, np.ones(len(net.topology.edge_corners)))
    term = next(term for term in TERMS if term.name == "angle")
    turned = start.spheres.copy()
    turned[0] *= -1
    residuals = term.residuals(setting, replace(start, spheres=turned))
    np.testing.assert_allclose(np.sort(residuals)[: 1 + 2], -2, atol=1e-10)


# Freedom


def problem_of(mesh: Mesh, weights: EnergyWeights, freedom: Freedom) -> EnergyProblem:
    setting = energy_setting(mesh, np.ones(len(mesh.topology.edge_corners)))
    return energy_problem(setting, freedom, weights)


def test_rows_stay_unit_and_radii_fixed() -> None:
    net = vase_mesh(8, 6)
    unknowns = rough_unknowns(net, planes=True, seed=1)
    fixed = np.arange(net.n_faces) % 2 == 0
    freedom = Freedom(0.1, vertex_freedom(net, "free", "free"), fixed)
    random = np.random.default_rng(0)
    steps = tuple(
        0.1 * random.normal(size=table.shape)
        for table in (unknowns.spheres, unknowns.displacements, unknowns.normals)
    )
    found = moved(freedom, unknowns, steps)
    np.testing.assert_allclose(minkowski(found.spheres, found.spheres), 1, atol=1e-14)
    np.testing.assert_array_equal(found.spheres[fixed, 0], unknowns.spheres[fixed, 0])
    np.testing.assert_allclose(norm(found.normals), 1, atol=1e-15)
    assert norm(found.displacements).max() <= 0.1 * (1 + 1e-15)


@pytest.mark.parametrize("is_fixed", [False, True], ids=["free", "fixed radii"])
def test_tangents_are_the_derivatives_of_a_move(is_fixed: bool) -> None:  # noqa: FBT001
    net = vase_mesh(6, 4)
    unknowns = rough_unknowns(net, planes=True, seed=2)
    freedom = Freedom(0.0, vertex_freedom(net, "free", "free"), np.full(net.n_faces, is_fixed))
    none = np.zeros((0, 3))
    faces = np.arange(net.n_faces)
    for number in range(5):
        derivatives = np.zeros((net.n_faces, 5))
        derivatives[:, number] = 1
        found = tangent_to_spheres(freedom, unknowns, faces, derivatives)
        for change in range(5):
            step = np.zeros_like(unknowns.spheres)
            step[:, change] = STEP
            plus = moved(freedom, unknowns, (step, none, none)).spheres
            minus = moved(freedom, unknowns, (-step, none, none)).spheres
            expected = (plus - minus)[:, number] / (2 * STEP)
            np.testing.assert_allclose(found[:, change], expected, atol=1e-7)


def test_vertices_glide_where_they_are_told() -> None:
    net = vase_mesh(8, 6)
    on_boundary = net.topology.is_boundary_vertex
    fixed = vertex_freedom(net, "free", "fixed")
    assert not fixed[on_boundary].any()
    np.testing.assert_array_equal(fixed[~on_boundary], np.tile(np.eye(3), (8 * 5, 1, 1)))
    gliding = vertex_freedom(net, "glide", "glide")
    np.testing.assert_allclose(gliding @ gliding, gliding, atol=1e-14)
    ranks = np.trace(gliding, axis1=1, axis2=2)
    np.testing.assert_allclose(ranks, np.where(on_boundary, 1, 2), atol=1e-14)
    # The boundary of a vase is two level circles: nothing there glides up or down.
    np.testing.assert_allclose(gliding[on_boundary][:, 2], 0, atol=1e-14)


def test_a_vertex_at_its_bound_is_not_pushed_out() -> None:
    net = vase_mesh(5, 3)
    freedom = Freedom(0.1, vertex_freedom(net, "free", "free"), np.zeros(net.n_faces, bool))
    at_bound = np.tile([0.1, 0, 0], (net.n_vertices, 1))
    inward = np.tile([-1.0, 1, 0], (net.n_vertices, 1))
    assert not pushed_out(freedom, at_bound, inward).any()
    held = pushed_out(freedom, at_bound, -inward)
    assert held.all()
    assert not pushed_out(freedom, 0.9 * at_bound, -inward).any()
    along = free_directions(freedom, at_bound, held)
    np.testing.assert_allclose(along, np.tile(np.diag([0, 1, 1]), (net.n_vertices, 1, 1)))
    np.testing.assert_array_equal(free_directions(freedom, at_bound, ~held), freedom.vertices)
    np.testing.assert_allclose(project_displacements(freedom, 3 * at_bound), at_bound)


# The sum


def test_unknowns_that_no_term_needs_take_no_part() -> None:
    net = vase_mesh(6, 4)
    free = vertex_freedom(net, "free", "free")
    none = np.zeros(net.n_faces, bool)
    plain = problem_of(net, EnergyWeights(), Freedom(0.0, free, none))
    assert plain.pattern.layout.counts == (24, 0, 0)
    assert [term.name for term in plain.terms] == ["sphericity", "unit_norm", "angle"]
    full = problem_of(
        net, EnergyWeights(support=1, closeness=1, fairness=1), Freedom(0.1, free, none)
    )
    assert full.pattern.layout.counts == (24, 30, 18)
    assert len(full.terms) == 7


def test_the_matrix_is_the_jacobian_of_the_sum() -> None:
    net = vase_mesh(6, 4)
    unknowns = rough_unknowns(net, planes=True, seed=8)
    weights = EnergyWeights(regularity=3.5, support=1, fairness=0.3, closeness=0.2)
    freedom = Freedom(0.1, vertex_freedom(net, "free", "free"), np.zeros(net.n_faces, bool))
    problem = problem_of(net, weights, freedom)
    matrix = jacobian_matrix(problem.pattern, weighted_entries(problem, unknowns)).toarray()
    direction = np.random.default_rng(1).normal(size=matrix.shape[1])
    rows, moves, normals = problem.pattern.layout.split(direction)

    def _at(step: float) -> FloatArray:
        moved_on = Unknowns(
            unknowns.spheres + step * rows,
            unknowns.displacements + step * moves,
            unknowns.normals + step * normals,
        )
        return np.concatenate(weighted_residuals(problem, moved_on))

    expected = (_at(STEP) - _at(-STEP)) / (2 * STEP)
    np.testing.assert_allclose(matrix @ direction, expected, atol=1e-6)


def test_law_d10_the_energy_never_rises_and_does_not_depend_on_units() -> None:
    results = []
    for scale, shift in ((1.0, 0.0), (1e-3, 5.0), (1e3, -1e6)):
        net = vase_mesh(9, 7)
        net = Mesh(scale * net.vertices + shift, net.faces)
        start, _ = minimize_angles(face_planes(net))
        freedom = Freedom(0.0, vertex_freedom(net, "free", "free"), np.zeros(net.n_faces, bool))
        problem = problem_of(net, EnergyWeights(regularity=3.5, support=1), freedom)
        descent = minimize_energy(problem, first_unknowns(start), 60, 1e-8)
        total = descent.history.sum(axis=1)
        assert descent.status == "converged"
        assert (np.diff(total) < 0).all()
        results.append(total[-1])
    np.testing.assert_allclose(results, results[0], rtol=1e-5)


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_weights_out_of_range_are_named(value: float) -> None:
    with pytest.raises(InputError, match=r"weight support must be finite and at least 0"):
        EnergyWeights(support=value)
