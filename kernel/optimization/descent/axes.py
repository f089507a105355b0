"""Node axes follow the spheres: in every state they are the best for its spheres.

A step that changes spheres and turns axes at once misses by the product of both: so much that
only small parts of it would be taken. For given spheres the axis of least energy is, but for
what is linear, the lowest eigenvector of a small matrix, and costs next to nothing.
"""

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, dot, gather, norm, unit
from ...solvers.block_patterns import add_up, add_up_products, weighted
from ...tolerances import AXIS_LEAN, AXIS_STEP
from ..energies.centers import center_lines
from ..energies.setting import Unknowns
from .problem import UPRIGHT, EnergyProblem

MOST_STEPS = 20
"""Newton steps towards a multiplier; five or six are usual."""


def with_best_axes(problem: EnergyProblem, unknowns: Unknowns) -> Unknowns:
    """The unknowns with the dual normals of least energy, where these take part.

    With the vectors D across the edges at a node, their multipliers y and the upright m it is
    the least of ``λ² Σ (D·n + y)² + ε² |n - m|²`` over unit vectors n. Far from an optimum
    it may lie down, and would not get up again: axes that lean too much only get up. Normals
    that do not gain stay as they are.
    """
    names = [term.name for term in problem.terms]
    if "support" not in names or not len(problem.upright):
        return unknowns
    number = names.index("support")
    setting, weight = problem.setting, problem.weights[number]
    *_, sums = problem.patterns[0].gradients[number]
    lines = weight * gather(center_lines(setting, unknowns), setting.spoke_edges)
    tables = add_up_products(sums, lines, lines)
    forces = UPRIGHT**2 * problem.upright
    if "support" in problem.multipliers:
        rest = weight * problem.multipliers["support"]
        forces = forces - add_up(weighted(sums, rest), lines)

    found = _least_on_sphere(tables, forces)
    normals = unknowns.normals
    gains = _energies(tables, forces, found) < _energies(tables, forces, normals)
    heights = dot(found, problem.upright)
    gains &= (heights >= np.cos(AXIS_LEAN)) | (heights >= dot(normals, problem.upright))
    return replace(unknowns, normals=np.where(gains[:, None], found, normals))


def _energies(tables: FloatArray, forces: FloatArray, vectors: FloatArray) -> FloatArray:
    """``n·M n - 2 b·n``; not finite where no spheres are."""
    return dot(np.einsum("nij,nj->ni", tables, vectors) - 2 * forces, vectors)


def _least_on_sphere(tables: FloatArray, forces: FloatArray) -> FloatArray:
    """Unit vectors (n, 3) of least ``n·M n - 2 b·n``: ``(M + λ) n = b``, M + λ semidefinite.

    References
    ----------
    Conn, Gould, Toint 2000, Trust-region methods, Sec. 7.3.
    """
    values, bases = np.linalg.eigh(np.where(np.isfinite(tables), tables, 0.0))
    along = np.einsum("nij,ni->nj", bases, forces)
    gaps = values - values[:, :1]
    # λ is t minus the least eigenvalue; the length falls to 1 between these.
    least = np.maximum((np.abs(along) - gaps).max(axis=1), np.finfo(np.float64).tiny)
    t, largest = least, norm(along)
    for _ in range(MOST_STEPS):
        parts = along / (gaps + t[:, None])
        lengths = norm(parts)
        if (np.abs(lengths - 1) <= AXIS_STEP).all():
            break
        slopes = dot(parts**2, 1 / (gaps + t[:, None]))
        t = np.clip(t + (lengths - 1) * lengths**2 / slopes, least, largest)
    return unit(np.einsum("nij,nj->ni", bases, along / (gaps + t[:, None])))
