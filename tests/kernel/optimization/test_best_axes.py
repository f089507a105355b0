"""Node axes follow the spheres: no others cost less."""

from dataclasses import replace

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.descent.axes import with_best_axes
from spheremesh.kernel.optimization.descent.freedom import Freedom, vertex_freedom
from spheremesh.kernel.optimization.descent.problem import (
    UPRIGHT,
    EnergyProblem,
    energies_of_terms,
    energy_problem,
)
from spheremesh.kernel.optimization.energies.setting import (
    Unknowns,
    energy_setting,
    first_unknowns,
)
from spheremesh.kernel.optimization.energies.table import EnergyWeights
from spheremesh.kernel.optimization.whole_energy import optimize_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.tolerances import AXIS_LEAN


def dome() -> Mesh:
    x, y = np.meshgrid(*2 * [np.arange(7.0) - 3], indexing="ij")
    ids = np.arange(49).reshape(7, 7)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    heights = -0.05 * x**2 - 0.04 * y**2 + 0.002 * x**3
    return Mesh(np.stack([x, y, heights], -1).reshape(-1, 3), faces.reshape(-1, 4))


MESH = dome()
SPHERES = optimize_spheres(minimize_angles(fit_spheres(MESH))[0], EnergyWeights(support=1.0))[0]


def problem(support: float) -> EnergyProblem:
    setting = energy_setting(MESH, np.ones(len(MESH.topology.edge_corners)))
    freedom = Freedom(0.0, vertex_freedom(MESH, "free", "free"), np.zeros(MESH.n_faces, bool))
    return energy_problem(setting, freedom, EnergyWeights(support=support))


PROBLEMS = {support: problem(support) for support in (1.0, 300.0)}


def state(seed: int, lean: float, noise: float = 0.0) -> Unknowns:
    """Spheres whose nodes have axes, up to noise, and other axes that lean at random."""
    rng = np.random.default_rng(seed)
    unknowns = first_unknowns(SPHERES)
    change = rng.normal(size=unknowns.spheres.shape) * np.array([noise, 0, 0, 0, 0])
    tilted = unknowns.normals + lean * rng.normal(size=unknowns.normals.shape)
    return replace(unknowns, spheres=unknowns.spheres + change, normals=unit(tilted))


def cost(of: EnergyProblem, unknowns: Unknowns) -> float:
    return float(energies_of_terms(of, unknowns).sum())


def with_multipliers(of: EnergyProblem, seed: int, size: float) -> EnergyProblem:
    count = len(of.setting.spoke_edges)
    values = size * np.random.default_rng(seed).normal(size=count)
    return replace(of, multipliers={"support": values})


def costs_of_nodes(of: EnergyProblem, unknowns: Unknowns) -> FloatArray:
    names = [term.name for term in of.terms]
    support = of.terms[names.index("support")]
    misses = support.residuals(of.setting, unknowns) + of.multipliers["support"]
    squares = (of.weights[names.index("support")] * misses) ** 2
    leans = unknowns.normals - of.upright
    counts = len(of.upright)
    return np.bincount(of.setting.spoke_nodes, squares, counts) + UPRIGHT**2 * dot(leans, leans)


@pytest.mark.parametrize("support", sorted(PROBLEMS))
@pytest.mark.parametrize("size", [0.0, 1e-4])
@pytest.mark.parametrize("seed", range(4))
def test_no_other_axes_cost_less(support: float, size: float, seed: int) -> None:
    of = with_multipliers(PROBLEMS[support], seed, size)
    before = state(seed, 0.1, noise=1e-6)
    found = with_best_axes(of, before)
    np.testing.assert_allclose(norm(found.normals), 1, atol=1e-14)
    # Axes that would lie down are left as they are.
    turned = (found.normals != before.normals).any(axis=1)
    assert turned.sum() >= 15
    least = costs_of_nodes(of, found)
    rng = np.random.default_rng(seed)
    for reach in (1e-4, 1e-2, 0.3, 3.0):
        others = unit(found.normals + reach * rng.normal(size=found.normals.shape))
        others = replace(found, normals=others)
        assert (costs_of_nodes(of, others)[turned] >= least[turned] * (1 - 1e-12)).all()
    again = with_best_axes(of, found)
    np.testing.assert_allclose(again.normals, found.normals, atol=1e-6)


@pytest.mark.parametrize("lean", [0.1, 3.0])
def test_axes_never_cost_more_and_do_not_lie_down(lean: float) -> None:
    of = with_multipliers(PROBLEMS[300.0], 1, 1e-3)
    before = state(2, lean, noise=0.02)
    found = with_best_axes(of, before)
    assert cost(of, found) <= cost(of, before)
    least = np.minimum(np.cos(AXIS_LEAN), heights(of, before.normals))
    assert (heights(of, found.normals) >= least - 1e-12).all()


def heights(of: EnergyProblem, normals: FloatArray) -> FloatArray:
    return dot(normals, of.upright)


def test_planes_have_upright_axes() -> None:
    """Nothing else tells their way."""
    planes = first_unknowns(face_planes(MESH))
    tilted = replace(planes, normals=state(3, 0.5).normals)
    found = with_best_axes(PROBLEMS[300.0], tilted)
    np.testing.assert_allclose(found.normals, PROBLEMS[300.0].upright, atol=1e-12)


def test_without_support_nothing_changes() -> None:
    before = state(4, 0.5)
    assert with_best_axes(problem(0.0), before) is before
