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
from spheremesh.kernel.optimization.descent.derivatives import energy_model
from spheremesh.kernel.optimization.descent.freedom import (
    Freedom,
    largest_part,
    moved,
    tangents,
    vertex_freedom,
)
from spheremesh.kernel.optimization.descent.multipliers import descend_energy, hold
from spheremesh.kernel.optimization.descent.problem import (
    EnergyProblem,
    energies_of_terms,
    energy_problem,
    hard_misses,
)
from spheremesh.kernel.optimization.energies.setting import (
    Setting,
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.energies.table import TERMS, EnergyWeights, Term
from spheremesh.kernel.solvers.minimization import Model
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.nodes import ellipsoid_mesh, torus_mesh, vase_mesh

STEP = 1e-6
TERMS_BY_NAME = {term.name: term for term in TERMS}


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


@pytest.mark.parametrize("allowance", [0.0, 0.05])
@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.name)
def test_law_d8_d9_second_derivatives(term: Term, mesh: str, allowance: float) -> None:
    """Differences of the Jacobian, times multipliers, block by block."""
    net = MESHES[mesh]()
    setting = rough_setting(net, allowance)
    unknowns = rough_unknowns(net, planes=True, seed=3)
    blocks = term.blocks(setting)
    multipliers = np.random.default_rng(8).normal(size=len(term.residuals(setting, unknowns)))
    found = term.second_derivatives(setting, unknowns, multipliers)
    counts = (net.n_faces, net.n_vertices, len(setting.node_vertices))
    assert all(i <= j < len(blocks) for i, j in found)

    def _gradients(values: Unknowns) -> list[FloatArray]:
        sums = [
            np.zeros((count, width)) for count, width in zip(counts, (5, 3, 3), strict=True)
        ]
        for block, table in zip(blocks, term.jacobian(setting, values), strict=True):
            np.add.at(sums[block.group], block.ids, multipliers[:, None] * table)
        return sums

    whole = [
        [np.zeros((counts[g], width, counts[h], wide)) for h, wide in enumerate((5, 3, 3))]
        for g, width in enumerate((5, 3, 3))
    ]
    for (i, j), tables in found.items():
        first, second = blocks[i], blocks[j]
        for row, table in enumerate(tables):
            a, b = first.ids[row], second.ids[row]
            whole[first.group][second.group][a, :, b] += table
            if i != j:
                whole[second.group][first.group][b, :, a] += table.T
    for group, (count, width) in enumerate(zip(counts, (5, 3, 3), strict=True)):
        for element in range(0, count, 3):
            for number in range(width):
                plus = _gradients(shifted(unknowns, group, element, number, STEP))
                minus = _gradients(shifted(unknowns, group, element, number, -STEP))
                for other in range(3):
                    expected = (plus[other] - minus[other]) / (2 * STEP)
                    actual = whole[group][other][element, number]
                    np.testing.assert_allclose(actual, expected, atol=1e-6)


def test_an_allowance_is_a_distance() -> None:
    """Spheres grown by the allowance miss by as much, whatever their curvature."""
    net = ellipsoid_mesh(10, 6)
    start = first_unknowns(minimize_angles(face_planes(net))[0])
    rows = start.spheres
    for distance in (0.1, -0.1):
        grown = rows.copy()
        grown[:, 4] += distance - rows[:, 0] * distance**2
        grown /= (1 - 2 * rows[:, 0] * distance)[:, None]
        unknowns = replace(start, spheres=grown)
        residuals = TERMS[0].residuals(rough_setting(net, allowance=0.1), unknowns)
        np.testing.assert_allclose(np.abs(residuals), 0.1, rtol=1e-9)


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


@pytest.mark.parametrize("is_fixed", [False, True], ids=["free", "fixed radii"])
def test_tangents_are_the_directions_of_moves(is_fixed: bool) -> None:  # noqa: FBT001
    net = vase_mesh(6, 4)
    unknowns = rough_unknowns(net, planes=True, seed=2)
    freedom = Freedom(0.1, vertex_freedom(net, "free", "free"), np.full(net.n_faces, is_fixed))
    counts = (net.n_faces, net.n_vertices, len(unknowns.normals))
    found = tangents(freedom, unknowns, counts)
    for basis, rank in zip(found, (3 if is_fixed else 4, 3, 2), strict=True):
        gram = np.einsum("nij,nik->njk", basis, basis)
        np.testing.assert_allclose(np.trace(gram, axis1=1, axis2=2), rank, atol=1e-12)
        np.testing.assert_allclose(gram @ gram, gram, atol=1e-12)
    none = np.zeros((0, 3))
    for number in range(4):
        step = STEP * found.spheres[:, :, number]
        plus = moved(freedom, unknowns, (step, none, none)).spheres
        minus = moved(freedom, unknowns, (-step, none, none)).spheres
        np.testing.assert_allclose((plus - minus) / 2, step, atol=1e-6 * STEP)


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


def test_steps_end_before_the_bound() -> None:
    net = vase_mesh(5, 3)
    freedom = Freedom(0.1, vertex_freedom(net, "free", "free"), np.zeros(net.n_faces, bool))
    start = np.tile([0.05, 0, 0], (net.n_vertices, 1))
    steps = np.zeros_like(start)
    steps[3, 0] = 0.1
    assert largest_part(freedom, start, steps, 1.0) == pytest.approx(0.5)
    assert largest_part(freedom, start, -steps, 1.0) == 1.0
    assert largest_part(freedom, start[:0], steps[:0], 1.0) == 1.0
    steps[5] = [0, 0.2, 0]
    part = largest_part(freedom, start, steps, 0.95)
    reached = norm(start + part / 0.95 * steps).max()
    assert reached == pytest.approx(0.1)


# The sum


def test_unknowns_that_no_term_needs_take_no_part() -> None:
    net = vase_mesh(6, 4)
    free = vertex_freedom(net, "free", "free")
    none = np.zeros(net.n_faces, bool)
    plain = problem_of(net, EnergyWeights(), Freedom(0.0, free, none))
    assert plain.layout.counts == (24, 0, 0)
    assert [term.name for term in plain.terms] == ["sphericity", "angle"]
    full = problem_of(
        net, EnergyWeights(support=1, closeness=1, fairness=1), Freedom(0.1, free, none)
    )
    assert full.layout.counts == (24, 30, 18)
    assert len(full.terms) == 5


def full_problem(net: Mesh, start: Unknowns, *, has_fairness: bool) -> EnergyProblem:
    """Every term, multipliers, limits, some fixed radii, gliding vertices."""
    weights = EnergyWeights(
        regularity=3.5, support=1, fairness=0.3 * has_fairness, closeness=0.2
    )
    fixed = np.arange(net.n_faces) % 3 == 0
    freedom = Freedom(0.3, vertex_freedom(net, "glide", "glide"), fixed)
    problem = replace(problem_of(net, weights, freedom), bound_weight=0.1)
    problem = replace(problem, hard=frozenset({"sphericity", "support"}))
    found = hard_misses(problem, start)
    random = np.random.default_rng(4)
    return replace(
        problem,
        hard=frozenset({"support"}),
        multipliers={"support": 0.1 * random.normal(size=len(found["support"]))},
        limits={"sphericity": 1.3 * np.abs(found["sphericity"]) + 0.2},
    )


@pytest.mark.parametrize("has_fairness", [False, True])
@pytest.mark.parametrize("mesh", MESHES)
def test_the_model_is_the_energy_to_second_order(mesh: str, has_fairness: bool) -> None:  # noqa: FBT001
    """Along moves, which bend: gradient, and solutions with the Hessian."""
    net = MESHES[mesh]()
    start = rough_unknowns(net, planes=True, seed=8)
    on_lines = np.einsum(
        "vij,vj->vi", vertex_freedom(net, "glide", "glide"), start.displacements
    )
    start = replace(start, displacements=on_lines)
    problem = full_problem(net, start, has_fairness=has_fairness)
    model = energy_model(problem, start, is_exact=True)
    directions = tangents(problem.freedom, start, problem.layout.counts)
    random = np.random.default_rng(1)
    solve = model.factorize(50.0)
    assert solve is not None
    assert model.factorize(0.0) is None
    for _ in range(3):
        step = solve(random.normal(size=len(model.gradient)))
        step /= np.abs(step).max()
        # Only steps in free directions are moves.
        parts = np.split(step, np.cumsum([b.shape[0] * b.shape[2] for b in directions])[:-1])
        parts = [part.reshape(len(b), -1) for part, b in zip(parts, directions, strict=True)]
        parts = [
            np.einsum("nij,nik,nk->nj", b, b, part)
            for part, b in zip(parts, directions, strict=True)
        ]
        steps = tuple(
            np.einsum("nij,nj->ni", b, part) for part, b in zip(parts, directions, strict=True)
        )
        flat = np.concatenate([part.ravel() for part in parts])

        def _energy(size: float, steps: tuple[FloatArray, ...] = steps) -> float:
            ends = moved(problem.freedom, start, tuple(size * part for part in steps))
            return float(energies_of_terms(problem, ends).sum())

        h = 1e-4
        slope = (_energy(h) - _energy(-h)) / (2 * h)
        assert 2 * model.gradient @ flat == pytest.approx(slope, rel=1e-5, abs=1e-6)
        bend = (_energy(h) - 2 * _energy(0) + _energy(-h)) / h**2
        # (H + 50 I)⁻¹ of (H + 50 I) x is x: so the Hessian is found from solutions alone.
        image = hessian_image(model, flat)
        assert 2 * flat @ image == pytest.approx(bend, rel=1e-4, abs=1e-3)


def hessian_image(model: Model, vector: FloatArray) -> FloatArray:
    """H times a vector, by conjugate gradients on the solutions."""
    from scipy.sparse.linalg import LinearOperator, cg

    solve = model.factorize(50.0)
    assert solve is not None
    size = len(vector)
    operator = LinearOperator((size, size), matvec=solve, dtype=np.float64)
    image, failed = cg(operator, vector, rtol=1e-12, maxiter=5000)
    assert not failed
    return image - 50.0 * vector


def test_law_d10_the_energy_never_rises_and_does_not_depend_on_units() -> None:
    results = []
    for scale, shift in ((1.0, 0.0), (1e-3, 5.0), (1e3, -1e6)):
        net = vase_mesh(9, 7)
        net = Mesh(scale * net.vertices + shift, net.faces)
        start, _ = minimize_angles(face_planes(net))
        freedom = Freedom(0.0, vertex_freedom(net, "free", "free"), np.zeros(net.n_faces, bool))
        problem = problem_of(net, EnergyWeights(regularity=3.5, support=1), freedom)
        descent = descend_energy(problem, first_unknowns(start), 60, 1e-12, leaves_saddles=True)
        total = descent.history.sum(axis=1)
        assert descent.status == "converged"
        assert descent.lowest >= -1e-8
        assert (np.diff(total) < 0).all()
        results.append(total[-1])
    np.testing.assert_allclose(results, results[0], rtol=1e-9)


def test_what_has_to_hold_holds_or_is_said_not_to() -> None:
    net = vase_mesh(8, 6)
    start = first_unknowns(minimize_angles(face_planes(net))[0])
    freedom = Freedom(0.0, vertex_freedom(net, "free", "free"), np.zeros(net.n_faces, bool))
    weights = EnergyWeights(sphericity=10, support=10)
    problem = problem_of(net, weights, freedom)
    held = hold(replace(problem, hard=frozenset({"support"})), start, 100, (0.0,))
    assert held.is_held
    assert held.lowest >= -1e-8
    assert (
        np.abs(TERMS_BY_NAME["support"].residuals(problem.setting, held.unknowns)).max() < 1e-8
    )
    # The vertices stay, and nodes with axes want others.
    random = np.random.default_rng(0)
    rough = Mesh(net.vertices + 0.05 * random.normal(size=net.vertices.shape), net.faces)
    problem = problem_of(rough, weights, freedom)
    problem = replace(problem, hard=frozenset({"sphericity"}))
    held = hold(problem, first_unknowns(fit_spheres(rough)), 100, (0.0,))
    assert not held.is_held
    assert len(held.stages) <= 6


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_weights_out_of_range_are_named(value: float) -> None:
    with pytest.raises(InputError, match=r"weight support must be finite and at least 0"):
        EnergyWeights(support=value)
