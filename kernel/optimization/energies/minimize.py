"""Minimising energy (6): from a setting and weights to the best unknowns."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ...arrays import BoolArray, FloatArray, dot, norm, sum_by
from ...solvers.blocks import Block, JacobianPattern, Layout, jacobian_pattern
from ...solvers.levenberg_marquardt import DampedStep, Descent, levenberg_marquardt
from ...solvers.normal_equations import Linearization, damped_step, linearization
from ...tolerances import LEAST_ENERGY, STEP_MODEL
from .freedom import (
    Freedom,
    free_directions,
    moved,
    project_displacements,
    pushed_out,
    tangent_to_spheres,
)
from .setting import WIDTHS, Group, Setting, Unknowns
from .table import TERMS, EnergyWeights, Term


@dataclass(frozen=True)
class EnergyProblem:
    """A weighted sum of terms over a setting.

    Attributes
    ----------
    freedom : Freedom
        Which way the unknowns may move.
    terms : tuple of Term
        Terms of positive weight.
    weights : tuple of float
        Their λ.
    pattern : JacobianPattern
        Where derivatives go.
    """

    setting: Setting
    freedom: Freedom
    terms: tuple[Term, ...]
    weights: tuple[float, ...]
    pattern: JacobianPattern


def energy_problem(setting: Setting, freedom: Freedom, weights: EnergyWeights) -> EnergyProblem:
    """Collect the terms that have a weight and the unknowns that they need.

    Vertices are unknown if they may move at all, dual normals if there is a weight on the
    support.
    """
    n_vertices = setting.n_vertices if freedom.tolerance > 0 else 0
    n_nodes = len(setting.node_vertices) if weights.support > 0 else 0
    layout = Layout((setting.n_faces, n_vertices, n_nodes), WIDTHS)
    chosen = [
        (term, getattr(weights, term.name), term.blocks(setting))
        for term in TERMS
        if getattr(weights, term.name) > 0
    ]
    # A term whose unknowns all stay as they are is a constant.
    chosen = [
        (term, weight, blocks)
        for term, weight, blocks in chosen
        if any(layout.counts[block.group] for block in blocks)
    ]
    terms, values, blocks = zip(*chosen, strict=True) if chosen else ((), (), ())
    return EnergyProblem(setting, freedom, terms, values, jacobian_pattern(layout, blocks))


def weighted_residuals(problem: EnergyProblem, unknowns: Unknowns) -> list[FloatArray]:
    """Residuals of each term, (m,), times its weight."""
    return [
        weight * term.residuals(problem.setting, unknowns)
        for term, weight in zip(problem.terms, problem.weights, strict=True)
    ]


def weighted_entries(
    problem: EnergyProblem, unknowns: Unknowns
) -> list[tuple[FloatArray, ...]]:
    """Derivatives of the weighted residuals, (m, width), block by block.

    As in `JacobianPattern.blocks`: groups that do not take part are left out.
    """
    counts = problem.pattern.layout.counts
    result: list[tuple[FloatArray, ...]] = []
    for term, weight in zip(problem.terms, problem.weights, strict=True):
        tables = zip(
            term.blocks(problem.setting), term.jacobian(problem.setting, unknowns), strict=True
        )
        result.append(tuple(weight * table for block, table in tables if counts[block.group]))
    return result


def minimize_energy(
    problem: EnergyProblem,
    start: Unknowns,
    max_iterations: int,
    change: float,
    share: float = STEP_MODEL,
) -> Descent[Unknowns]:
    """Minimise the energy by Levenberg-Marquardt; the history has a column per term.

    At most `max_iterations` linear systems. `change` is the relative fall of the energy at
    which the descent ends, `share` the gain of the model that a step may leave out.
    """
    # A state is linearised right after its energy was asked for.
    known: tuple[Unknowns, list[FloatArray]] = (start, weighted_residuals(problem, start))

    def _residuals(unknowns: Unknowns) -> list[FloatArray]:
        nonlocal known
        if unknowns is not known[0]:
            known = (unknowns, weighted_residuals(problem, unknowns))
        return known[1]

    def _energies(unknowns: Unknowns) -> FloatArray:
        return np.array([float(dot(part, part)) for part in _residuals(unknowns)])

    def _linearize(unknowns: Unknowns) -> Callable[[float], DampedStep]:
        return _bounded_steps(problem, unknowns, np.concatenate(_residuals(unknowns)), share)

    def _move(unknowns: Unknowns, step: FloatArray) -> Unknowns:
        spheres, displacements, normals = problem.pattern.layout.split(step)
        return moved(problem.freedom, unknowns, (spheres, displacements, normals))

    return levenberg_marquardt(
        start, _energies, _linearize, _move, change, max_iterations, LEAST_ENERGY
    )


def _bounded_steps(
    problem: EnergyProblem, unknowns: Unknowns, residuals: FloatArray, share: float
) -> Callable[[float], DampedStep]:
    """Steps at a state, by damping, that leave vertices within their bound.

    A vertex that a step would carry out goes to the bound and along it, and the others make up
    for what it cannot do: the step is found again. Shortening the vertex alone would tear it
    from the spheres that were to go with it.
    """
    pattern, freedom = problem.pattern, problem.freedom
    entries, energy = weighted_entries(problem, unknowns), float(dot(residuals, residuals))
    start = unknowns.displacements[: pattern.layout.counts[Group.VERTEX]]
    pushed = pushed_out(freedom, start, _vertex_descent(pattern, entries, residuals))

    def _linear(held: BoolArray, ends: FloatArray) -> Linearization:
        free = _free_entries(problem, unknowns, entries, free_directions(freedom, ends, held))
        known = residuals + _vertex_changes(pattern, entries, ends - start)
        return linearization(pattern, known, free)

    first = _linear(pushed, start)
    if not len(start):
        # Nothing has a bound, and the unprojected entries need not be kept.
        return partial(damped_step, first, share=share)

    def _step(damping: float) -> DampedStep:
        held, ends = pushed, start
        found = damped_step(first, damping, share)
        while True:
            reached = ends + pattern.layout.split(found.step)[Group.VERTEX]
            leaving = ~held & (norm(reached) > freedom.tolerance)
            if not leaving.any():
                break
            bound = np.where(leaving[:, None], project_displacements(freedom, reached), ends)
            trial = damped_step(_linear(held | leaving, bound), damping, share)
            if not trial.predicted < energy:
                # Too many would have to stop at once: a shorter step comes next.
                break
            held, ends, found = held | leaving, bound, trial
        step = found.step.copy()
        pattern.layout.split(step)[Group.VERTEX][:] += ends - start
        return DampedStep(step, found.predicted)

    return _step


def _vertex_changes(
    pattern: JacobianPattern, entries: list[tuple[FloatArray, ...]], moves: FloatArray
) -> FloatArray:
    """Change of the residuals if vertices move and nothing else does, to first order."""
    changes: list[FloatArray] = []
    for blocks, tables in zip(pattern.blocks, entries, strict=True):
        change = np.zeros(len(tables[0]))
        for block, table in zip(blocks, tables, strict=True):
            if block.group == Group.VERTEX:
                change += dot(table, moves[block.ids])
        changes.append(change)
    return np.concatenate(changes)


def _vertex_descent(
    pattern: JacobianPattern, entries: list[tuple[FloatArray, ...]], residuals: FloatArray
) -> FloatArray:
    """Direction (V, 3) in which moving each vertex lowers the energy; empty if none may."""
    count = pattern.layout.counts[Group.VERTEX]
    descent, row = np.zeros((count, 3)), 0
    for blocks, tables in zip(pattern.blocks, entries, strict=True):
        part = residuals[row : row + len(tables[0])]
        row += len(part)
        for block, table in zip(blocks, tables, strict=True):
            if block.group == Group.VERTEX:
                descent -= sum_by(block.ids, part[:, None] * table, count)
    return descent


def _free_entries(
    problem: EnergyProblem,
    unknowns: Unknowns,
    entries: list[tuple[FloatArray, ...]],
    vertices: FloatArray,
) -> list[tuple[FloatArray, ...]]:
    """Derivatives by what may move, vertices as their projections (V, 3, 3) say."""
    freedom = problem.freedom

    def _project(block: Block, table: FloatArray) -> FloatArray:
        if block.group == Group.VERTEX:
            return np.einsum("mi,mij->mj", table, vertices[block.ids])
        if block.group == Group.SPHERE:
            return tangent_to_spheres(freedom, unknowns, block.ids, table)
        normals = unknowns.normals[block.ids]
        return table - dot(table, normals)[:, None] * normals

    def _keep(block: Block, table: FloatArray) -> FloatArray:
        """A gauge term acts across the tangents; a fixed A is no unknown all the same."""
        if block.group == Group.SPHERE:
            table = table.copy()
            table[freedom.has_fixed_radius[block.ids], 0] = 0
        return table

    return [
        tuple(
            _keep(block, table) if term.is_gauge else _project(block, table)
            for block, table in zip(blocks, tables, strict=True)
        )
        for term, blocks, tables in zip(
            problem.terms, problem.pattern.blocks, entries, strict=True
        )
    ]
