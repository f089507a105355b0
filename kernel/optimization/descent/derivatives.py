"""First and second derivatives of energy (6), in the directions in which unknowns may move."""

from functools import cache
from typing import NamedTuple

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.block_patterns import PairKind, add_up, weighted
from ...solvers.block_systems import Blocks, factorize_system
from ...solvers.factorization import Solver
from ...solvers.minimization import Model
from ...spheres.minkowski import minkowski_gradient
from ..energies.second_derivatives import SecondDerivatives
from ..energies.setting import Group, Unknowns
from .freedom import Tangents, row_multipliers, tangents
from .problem import (
    UPRIGHT,
    EnergyProblem,
    WeightedResiduals,
    bound,
    weighted_residuals,
)


def energy_model(problem: EnergyProblem, unknowns: Unknowns, *, is_exact: bool) -> Model:
    """The energy near a state; second derivatives are made when something is factorised."""
    directions = tangents(problem.freedom, unknowns, problem.layout.counts)
    slopes = _slopes(problem, unknowns)

    @cache
    def _system(*, is_exact: bool) -> Blocks:
        blocks = _hessian(problem, unknowns, slopes, is_exact=is_exact)
        return _reduced(blocks, directions, problem)

    def _factorize(shift: float) -> Solver | None:
        return factorize_system(problem.patterns[1], _system(is_exact=is_exact), shift)

    def _factorize_convex(shift: float) -> Solver | None:
        return factorize_system(problem.patterns[1], _system(is_exact=False), shift)

    gradient = np.concatenate(
        [
            np.einsum("nij,ni->nj", basis, table).ravel()
            for basis, table in zip(directions, slopes.gradients, strict=True)
        ]
    )
    return Model(gradient, _factorize, _factorize_convex)


class _Slopes(NamedTuple):
    """Of each term its residuals and Jacobian, and half of the gradient of each group."""

    parts: list[WeightedResiduals]
    jacobians: list[tuple[FloatArray, ...]]
    gradients: list[FloatArray]


def _slopes(problem: EnergyProblem, unknowns: Unknowns) -> _Slopes:
    pattern = problem.patterns[0]
    parts = weighted_residuals(problem, unknowns)
    jacobians = [term.jacobian(problem.setting, unknowns) for term in problem.terms]
    gradients = [
        np.zeros((count, width))
        for count, width in zip(problem.layout.counts, problem.layout.widths, strict=True)
    ]
    for number, (values, slopes, _) in enumerate(parts):
        forces = slopes * values
        for block, sums, table in zip(
            pattern.blocks[number], pattern.gradients[number], jacobians[number], strict=True
        ):
            if sums is not None:
                gradients[block.group] += add_up(weighted(sums, forces), table)
    # Upright axes: |n - m|² is 2 - 2 n·m, as n stays unit.
    gradients[Group.NORMAL] -= UPRIGHT**2 * problem.upright
    _, slope, _ = bound(problem, unknowns)
    gradients[Group.VERTEX] += slope[:, None] * unknowns.displacements[: len(slope)]
    return _Slopes(parts, jacobians, gradients)


def _hessian(
    problem: EnergyProblem, unknowns: Unknowns, slopes: _Slopes, *, is_exact: bool
) -> Blocks:
    """Half of the Hessian by the unknowns as they stand, bent as moves are."""
    pattern, layout = problem.patterns[0], problem.layout
    diagonal = tuple(
        np.zeros((count, width, width))
        for count, width in zip(layout.counts, layout.widths, strict=True)
    )
    mixed: dict[PairKind, FloatArray] = {
        kind: np.zeros((len(pairs), layout.widths[kind[0]], layout.widths[kind[1]]))
        for kind, pairs in pattern.pairs.items()
    }
    for number, term in enumerate(problem.terms):
        tables = slopes.jacobians[number]
        values, firsts, seconds = slopes.parts[number]
        curvatures = firsts**2 + seconds * values
        bent: SecondDerivatives = {}
        if is_exact:
            bent = term.second_derivatives(problem.setting, unknowns, firsts * values)
        for (i, j), addition in pattern.additions[number].items():
            first = curvatures[:, None] * tables[i]
            table = first[:, :, None] * tables[j][:, None, :]
            if (i, j) in bent:
                table += bent[i, j]
            target = (
                diagonal[addition.kind[0]] if addition.is_diagonal else mixed[addition.kind]
            )
            target += add_up(addition.straight, table)
            if addition.turned is not None:
                target += add_up(addition.turned, table.transpose(0, 2, 1))
    blocks = Blocks(diagonal, mixed)
    _add_bound(problem, unknowns, blocks)
    _bend(problem, unknowns, slopes.gradients, blocks, is_exact=is_exact)
    return blocks


def _add_bound(problem: EnergyProblem, unknowns: Unknowns, blocks: Blocks) -> None:
    _, slope, bend = bound(problem, unknowns)
    moved = unknowns.displacements[: len(slope)]
    diagonal = blocks.diagonal[Group.VERTEX]
    diagonal += slope[:, None, None] * np.eye(3)
    diagonal += 2 * bend[:, None, None] * moved[:, :, None] * moved[:, None, :]


def _bend(
    problem: EnergyProblem,
    unknowns: Unknowns,
    gradients: list[FloatArray],
    blocks: Blocks,
    *,
    is_exact: bool,
) -> None:
    """Moves keep rows and dual normals unit: they bend, and the energy with them."""
    if is_exact:
        along = row_multipliers(problem.freedom, unknowns, gradients[Group.SPHERE])
        blocks.diagonal[Group.SPHERE][:] -= along[:, None, None] * minkowski_gradient(np.eye(5))
    normals = unknowns.normals[: len(gradients[Group.NORMAL])]
    along = dot(gradients[Group.NORMAL], normals)
    if not is_exact:
        along = np.full(len(normals), -(UPRIGHT**2))
    blocks.diagonal[Group.NORMAL][:] -= along[:, None, None] * np.eye(3)


def _reduced(blocks: Blocks, directions: Tangents, problem: EnergyProblem) -> Blocks:
    """The Hessian in the directions of moves; directions that do not exist get ones."""
    pairs = problem.patterns[0].pairs
    diagonal: list[FloatArray] = []
    for basis, table in zip(directions, blocks.diagonal, strict=True):
        turned = basis.transpose(0, 2, 1)
        rest = np.eye(basis.shape[2]) - turned @ basis
        diagonal.append(turned @ table @ basis + rest)
    mixed = {
        kind: directions[kind[0]][ids[:, 0]].transpose(0, 2, 1)
        @ blocks.mixed[kind]
        @ directions[kind[1]][ids[:, 1]]
        for kind, ids in pairs.items()
    }
    return Blocks(tuple(diagonal), mixed)
