"""Where to start when neighbours shall meet at an angle: near optima of structure.

At smooth contact the energy of another target is stationary. Half of the angle is given to
either neighbour, with signs that differ across as many edges as can be (two colours of the
faces), about smooth contact and about the planes; or the target is raised step by step, all
faces bulging more, or less. Where a single face does better elsewhere, it is put there. Random
starts almost never reach as low.
"""

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray, IntArray, sum_by
from ..solvers.definite_systems import irregular
from ..solvers.weighted_graphs import piece_labels
from ..tolerances import SAME_ENERGY
from .pencil_energy import angle_density
from .pencil_newton import PencilDescent, PencilProblem, minimize_in_pencils

CONTINUATION_STEPS = 6
PLACES = 48
"""Spheres of a pencil, evenly around it, that are tried for a single face."""
MAX_ROUNDS = 40
WORTH_A_ROUND = 1e-3
"""Share of its part of the energy that a face must gain to be put elsewhere."""


def two_colors(faces: IntArray, count: int) -> FloatArray:
    """Signs (count,) that differ across as many of the pairs (m, 2) as can be.

    Exact where every ring of the graph is even; elsewhere the signs of the eigenvector of its
    most negative eigenvalue. The sign of each piece of the graph is arbitrary.
    """
    a, b = faces.T
    # Each node twice, once per colour: a piece whose two copies hang together has an odd ring.
    double = piece_labels(
        np.concatenate([a, a + count]), np.concatenate([b + count, b]), 2 * count
    )
    first, second = double[:count], double[count:]
    signs = np.where(first <= second, 1.0, -1.0)
    odd = np.flatnonzero(first == second)
    if len(odd):
        piece = np.unique(first[odd], return_inverse=True)[1]
        place = np.full(count, -1)
        place[odd] = np.arange(len(odd))
        inside = place[faces[place[a] >= 0]]
        for number in range(int(piece.max()) + 1):
            members = np.flatnonzero(piece == number)
            local = np.full(len(odd), -1)
            local[members] = np.arange(len(members))
            pairs = local[inside[local[inside[:, 0]] >= 0]]
            signs[odd[members]] = _spectral_signs(pairs, len(members))
    return signs


def _spectral_signs(pairs: IntArray, count: int) -> FloatArray:
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import ArpackNoConvergence, eigsh

    a, b = pairs.T
    both = np.concatenate([a, b]), np.concatenate([b, a])
    adjacency = coo_array((np.ones(2 * len(a)), both), shape=(count, count)).tocsr()
    if count <= 200:
        mode = np.linalg.eigh(adjacency.toarray())[1][:, 0]
    else:
        start = irregular(count)
        try:
            mode = eigsh(adjacency, k=1, which="SA", v0=start, tol=1e-8, maxiter=2000)[1][:, 0]
        except ArpackNoConvergence:
            mode = start
    return np.where(mode >= 0, 1.0, -1.0)


def target_descents(
    problem: PencilProblem, smooth: FloatArray, target: float
) -> list[PencilDescent]:
    """Descents to optima of a target angle in radians, from the smoothest unknowns (F,)."""
    used = problem.coupling.weights > 0
    colors = two_colors(problem.coupling.faces[used], len(smooth))
    descents = [
        minimize_in_pencils(problem, middle + side * colors * target / 2)
        for middle in (smooth, np.zeros_like(smooth))
        for side in (1, -1)
    ]
    descents += [_continued(problem, smooth, target, side) for side in (1, -1)]
    return [_better_places(problem, descent) for descent in descents]


def one_sided_descents(
    problem: PencilProblem, smooth: FloatArray, target: float
) -> list[PencilDescent]:
    """Descents with all spheres curved to one side, from even bulges about the smoothest.

    Those that press no sphere against its plane, if there are any: all panels bulge alike, and
    the planes of their arcs stand between them.
    """
    reach = problem.bounds[1]
    descents = [
        minimize_in_pencils(replace(problem, bounds=bounds), middle + side * target / 2)
        for side, bounds in ((1, (0.0, reach)), (-1, (-reach, 0.0)))
        for middle in (smooth, np.zeros_like(smooth))
    ]
    even = [each for each in descents if each.angles.all()]
    return even or descents


def _continued(
    problem: PencilProblem, smooth: FloatArray, target: float, side: int
) -> PencilDescent:
    """Raise the target step by step, all spheres turned to one side before each."""
    share = target / CONTINUATION_STEPS
    angles = smooth
    for step in range(1, CONTINUATION_STEPS):
        on_the_way = PencilProblem(
            problem.coupling, angle_density(step * share), problem.bounds, problem.curvatures
        )
        angles = minimize_in_pencils(on_the_way, angles + side * share / 2).angles
    return minimize_in_pencils(problem, angles + side * share / 2)


def _better_places(problem: PencilProblem, descent: PencilDescent) -> PencilDescent:
    """Put faces where each does better by itself, and descend from there, while that helps.

    Of neighbours the one that gains more is moved: the energy falls by all gains together.
    """
    a, b = problem.coupling.faces.T
    count = len(descent.angles)
    for _ in range(MAX_ROUNDS):
        now = _energies_alone(problem, descent.angles, descent.angles)
        lowest, places = now.copy(), descent.angles.copy()
        least, largest = max(problem.bounds[0], -np.pi), min(problem.bounds[1], np.pi)
        for place in np.linspace(least, largest, PLACES + 1)[1:]:
            found = _energies_alone(problem, descent.angles, np.full(count, place))
            is_lower = found < lowest
            lowest, places = (
                np.where(is_lower, found, lowest),
                np.where(is_lower, place, places),
            )
        gains = now - lowest
        rival = np.zeros(count)
        np.maximum.at(rival, a, gains[b])
        np.maximum.at(rival, b, gains[a])
        energy = descent.energies[-1]
        moves = (gains > WORTH_A_ROUND * energy / count) & (gains > rival * (1 + SAME_ENERGY))
        if not moves.any():
            break
        further = minimize_in_pencils(problem, np.where(moves, places, descent.angles))
        if further.energies[-1] >= energy * (1 - SAME_ENERGY):
            break
        descent = further
    return descent


def _energies_alone(
    problem: PencilProblem, angles: FloatArray, places: FloatArray
) -> FloatArray:
    """Energy (F,) of the edges of each face, itself at a place, its neighbours as they are."""
    pp, pq, qp, qq = problem.coupling.products
    a, b = problem.coupling.faces.T
    cosine, sine, p, q = np.cos(angles), np.sin(angles), np.cos(places), np.sin(places)
    first = p[a] * (pp * cosine[b] + pq * sine[b]) + q[a] * (qp * cosine[b] + qq * sine[b])
    second = p[b] * (pp * cosine[a] + qp * sine[a]) + q[b] * (pq * cosine[a] + qq * sine[a])
    weights, count = problem.coupling.weights, len(angles)
    return sum_by(a, weights * problem.density(first)[0], count) + sum_by(
        b, weights * problem.density(second)[0], count
    )
