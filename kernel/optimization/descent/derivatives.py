"""First and second derivatives of energy (6), in the directions in which unknowns may move."""

from functools import cache, partial

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.block_patterns import PairKind, add_up
from ...solvers.block_systems import Blocks, factorize_system
from ...solvers.newton import Factorize, Model
from ...spheres.minkowski import minkowski_gradient
from ..energies.second_derivatives import SecondDerivatives
from ..energies.setting import Group, Unknowns
from .freedom import Tangents, row_multipliers, tangents
from .problem import UPRIGHT, EnergyProblem, bound, weighted_residuals


def energy_model(problem: EnergyProblem, unknowns: Unknowns, *, is_exact: bool) -> Model:
    """The energy near a state; the second derivatives only if asked for."""
    directions = tangents(problem.freedom, unknowns, problem.layout.counts)

    def _hessian(*, is_exact: bool) -> tuple[FloatArray, Factorize]:
        gradients, blocks = _derivatives(problem, unknowns, is_exact=is_exact)
        _bend(problem, unknowns, gradients, blocks, is_exact=is_exact)
        reduced = _reduced(blocks, directions, problem)
        gradient = np.concatenate(
            [
                np.einsum("nij,ni->nj", basis, table).ravel()
                for basis, table in zip(directions, gradients, strict=True)
            ]
        )
        return gradient, partial(factorize_system, problem.patterns[1], reduced)

    gradient, factorize = _hessian(is_exact=is_exact)

    @cache
    def _convex() -> Factorize:
        return _hessian(is_exact=False)[1] if is_exact else factorize

    return Model(gradient, factorize, _convex)


def _derivatives(
    problem: EnergyProblem, unknowns: Unknowns, *, is_exact: bool
) -> tuple[list[FloatArray], Blocks]:
    """Half of the gradient and of the Hessian by the unknowns as they stand."""
    pattern, setting = problem.patterns[0], problem.setting
    layout = problem.layout
    gradients = [
        np.zeros((count, width))
        for count, width in zip(layout.counts, layout.widths, strict=True)
    ]
    diagonal = tuple(
        np.zeros((count, width, width))
        for count, width in zip(layout.counts, layout.widths, strict=True)
    )
    mixed: dict[PairKind, FloatArray] = {
        kind: np.zeros((len(pairs), layout.widths[kind[0]], layout.widths[kind[1]]))
        for kind, pairs in pattern.pairs.items()
    }
    parts = weighted_residuals(problem, unknowns)
    for number, term in enumerate(problem.terms):
        tables = term.jacobian(setting, unknowns)
        values, slopes, bends = parts[number]
        forces = slopes * values
        curvatures = slopes**2 + bends * values
        for block, sums, table in zip(
            pattern.blocks[number], pattern.gradients[number], tables, strict=True
        ):
            if sums is not None:
                gradients[block.group] += add_up(sums, forces[:, None] * table)
        bent: SecondDerivatives = {}
        if is_exact:
            bent = term.second_derivatives(setting, unknowns, forces)
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
    _add_bound(problem, unknowns, gradients, diagonal)
    return gradients, Blocks(diagonal, mixed)


def _add_bound(
    problem: EnergyProblem,
    unknowns: Unknowns,
    gradients: list[FloatArray],
    diagonal: tuple[FloatArray, ...],
) -> None:
    # Upright axes: |n - m|² is 2 - 2 n·m, as n stays unit.
    gradients[Group.NORMAL] -= UPRIGHT**2 * problem.upright
    _, slope, bend = bound(problem, unknowns)
    moved = unknowns.displacements[: len(slope)]
    gradients[Group.VERTEX] += slope[:, None] * moved
    diagonal[Group.VERTEX][:] += slope[:, None, None] * np.eye(3)
    diagonal[Group.VERTEX][:] += 2 * bend[:, None, None] * moved[:, :, None] * moved[:, None, :]


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
