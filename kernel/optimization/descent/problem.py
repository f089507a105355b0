"""Energy (6) as a problem: its terms, what has to hold exactly, and its value.

What has to hold exactly, ``c = 0``, costs ``λ² |c + y|²``: the multipliers y take up what is
left, round by round, until c itself holds. What has a limit, ``|c| < a`` or ``|d| < a`` for the
displacements d, costs ``ε² |c|² / (1 - |c|² / a²)``: little inside, and beyond all bounds
towards the limit. As ε falls from round to round, of all that costs nothing else the least
remains.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.block_patterns import HessianPattern, hessian_pattern
from ...solvers.block_systems import SystemPattern, system_pattern
from ...solvers.blocks import Block, Layout
from ..energies.setting import WIDTHS, Group, Setting, Unknowns
from ..energies.table import TERMS, EnergyWeights, Term
from .freedom import Freedom

STEP_WIDTHS = (4, 3, 2)
"""Directions of a unit row, of a vertex, of a dual normal."""
UPRIGHT = 1e-3
"""Weight of the lean of node axes: where spheres are planes nothing else tells their way."""


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
    hard : frozenset of str
        Terms that have to hold exactly.
    multipliers : mapping of str to (m,) float arrays
        Multipliers y of those terms; 0 where there are none yet.
    limits : mapping of str to (m,) float arrays
        Limits a of the residuals of terms that have some.
    bound_weight : float
        Weight ε of the displacements and of what has limits.
    upright : (N or 0, 3) float array
        Dual normals from which those of nodes lean no more than they have to.
    patterns : (HessianPattern, SystemPattern)
        Where derivatives go.
    """

    setting: Setting
    freedom: Freedom
    terms: tuple[Term, ...]
    weights: tuple[float, ...]
    hard: frozenset[str]
    multipliers: Mapping[str, FloatArray]
    limits: Mapping[str, FloatArray]
    bound_weight: float
    upright: FloatArray
    patterns: tuple[HessianPattern, SystemPattern]

    @property
    def layout(self) -> Layout:
        """Groups of unknowns, as derivatives come."""
        return self.patterns[0].layout


def energy_problem(
    setting: Setting,
    freedom: Freedom,
    weights: EnergyWeights,
    bound_weight: float = 0.0,
    known: EnergyProblem | None = None,
) -> EnergyProblem:
    """Collect the terms that have a weight and the unknowns that they need.

    Vertices are unknown if they may move at all, dual normals if there is a weight on the
    support. Gauges are kept by the moves and take no part. The patterns of a known problem of
    the same mesh serve again if its terms and unknowns are the same.
    """
    n_vertices = setting.n_vertices if freedom.tolerance > 0 else 0
    n_nodes = len(setting.node_vertices) if weights.support > 0 else 0
    layout = Layout((setting.n_faces, n_vertices, n_nodes), WIDTHS)
    chosen = [
        (term, getattr(weights, term.name), term.blocks(setting))
        for term in TERMS
        if getattr(weights, term.name) > 0 and not term.is_gauge
    ]
    # A term whose unknowns all stay as they are is a constant.
    chosen = [
        (term, weight, blocks)
        for term, weight, blocks in chosen
        if any(layout.counts[block.group] and len(block.ids) for block in blocks)
    ]
    terms, values, blocks = zip(*chosen, strict=True) if chosen else ((), (), ())
    is_known = known is not None and (known.terms, known.layout) == (terms, layout)
    patterns = known.patterns if known and is_known else _patterns(setting, layout, blocks)
    return EnergyProblem(
        setting, freedom, terms, values, frozenset(), {}, {}, bound_weight,
        setting.node_normals[:n_nodes], patterns,
    )  # fmt: skip


def _patterns(
    setting: Setting, layout: Layout, blocks: Sequence[Sequence[Block]]
) -> tuple[HessianPattern, SystemPattern]:
    pattern = hessian_pattern(layout, blocks)
    points = setting.face_points, setting.vertex_points, setting.node_points
    places = tuple(table[:count] for table, count in zip(points, layout.counts, strict=True))
    return pattern, system_pattern(pattern.pairs, STEP_WIDTHS, places)


class WeightedResiduals(NamedTuple):
    """Weighted residuals of a term, and their derivatives by what the term gives, each (m,)."""

    values: FloatArray
    slopes: FloatArray
    bends: FloatArray


def weighted_residuals(problem: EnergyProblem, unknowns: Unknowns) -> list[WeightedResiduals]:
    """WeightedResiduals of each term with its weight, its multipliers, its limits."""
    result: list[WeightedResiduals] = []
    for term, weight in zip(problem.terms, problem.weights, strict=True):
        values = term.residuals(problem.setting, unknowns)
        if term.name in problem.limits:
            result.append(_limited(values, problem.limits[term.name], problem.bound_weight))
            continue
        shifted = values + problem.multipliers.get(term.name, 0.0)
        none = np.zeros(len(values))
        result.append(WeightedResiduals(weight * shifted, none + weight, none))
    return result


def _limited(values: FloatArray, limits: FloatArray, weight: float) -> WeightedResiduals:
    """``ε c / √(1 - c² / a²)``: not finite at the limit and beyond."""
    left = 1 - (values / limits) ** 2
    left[left <= 0] = np.nan
    return WeightedResiduals(
        weight * values / np.sqrt(left),
        weight / left**1.5,
        3 * weight * values / limits**2 / left**2.5,
    )


def energies_of_terms(problem: EnergyProblem, unknowns: Unknowns) -> FloatArray:
    """Energy of each term, and last what moves and leans cost; not finite out of bounds."""
    parts = [
        float(dot(part.values, part.values)) for part in weighted_residuals(problem, unknowns)
    ]
    leans = unknowns.normals[: len(problem.upright)] - problem.upright
    lean = UPRIGHT**2 * float((leans**2).sum())
    return np.array([*parts, float(bound(problem, unknowns)[0].sum()), lean])


def names(problem: EnergyProblem) -> tuple[str, ...]:
    """What the energies are of."""
    return (*(term.name for term in problem.terms), "displacement", "lean")


def hard_misses(problem: EnergyProblem, unknowns: Unknowns) -> dict[str, FloatArray]:
    """Of each term that has to hold exactly, the residuals c, (m,)."""
    return {
        term.name: term.residuals(problem.setting, unknowns)
        for term in problem.terms
        if term.name in problem.hard
    }


def bound(
    problem: EnergyProblem, unknowns: Unknowns
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Energy of each displacement d, and its derivatives by ``|d|²``, each (V or 0,).

    ``ε² |d|² / (1 - |d|² / tolerance²)``, infinite at the tolerance and beyond.
    """
    moved = unknowns.displacements[: problem.layout.counts[Group.VERTEX]]
    weight = problem.bound_weight**2
    squares = dot(moved, moved)
    if weight == 0 or not len(moved):
        none = np.zeros(len(moved))
        return none, none, none
    limit = problem.freedom.tolerance**2
    left = 1 - squares / limit
    is_out = left <= 0
    left = np.where(is_out, 1.0, left)
    value = np.where(is_out, np.inf, weight * squares / left)
    return value, weight / left**2, 2 * weight / limit / left**3
