"""
Seamless maps to the plane whose coordinate lines follow two given directions.

The coordinates u and v are two scalar problems: u grows by 1 per edge length along the first
direction and not along the second, v the other way round. Only signs and whole-number shifts
tie the faces across the seams, and they are the same for both.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import InputError
from .boundary_alignment import Alignment, align_boundary, no_alignment
from .congruence_mesh import CongruenceMesh
from .frames import CombedFrames, Fans
from .injectivity import ChartGradients, untangle
from .integers import IntegerSolutions, integer_solutions, round_minimum
from .seams import Seams

ACROSS = 30.0
"""Weight of the direction in which a coordinate shall not change."""

FOLDED = 0.3
"""A map with more of its faces folded has no room for the steps asked for."""


@dataclass(frozen=True)
class Parametrization:
    """
    Coordinates at the corners, continuous across all edges up to signs and whole numbers.

    Attributes
    ----------
    charts : ChartGradients
        Coordinates of the corners from those of the vertices.
    values : (V, 2) float array
        Coordinates u and v of every vertex in the chart of its first corner.
    is_flipped : (F,) bool array
        Faces whose image is turned over or has no area.
    n_aligned : int
        Sides of the boundary that are lines of the map.
    n_folded : int
        Faces that were flipped before they were unfolded.
    """

    charts: ChartGradients
    values: FloatArray
    is_flipped: BoolArray
    n_aligned: int
    n_folded: int


@dataclass(frozen=True)
class _Coordinate:
    """
    One scalar problem: minimise ``|J w - b|²`` over vertices and integers.

    A coordinate of the corners is ``map @ [w, n]``.
    """

    map: Any
    jacobian: Any
    target: FloatArray
    alignment: Alignment
    solutions: IntegerSolutions
    pinned: IntArray


def parametrize(
    surface: CongruenceMesh, fans: Fans, frames: CombedFrames, seams: Seams, edge_length: float
) -> Parametrization:
    """
    Map the cut mesh so that unit steps follow the directions with a given length.

    Parameters
    ----------
    surface : CongruenceMesh
        The mesh.
    fans : Fans
        Corners around its vertices.
    frames : CombedFrames
        The directions.
    seams : Seams
        How the faces are tied.
    edge_length : float
        Length of a unit step, in mean edges.

    Returns
    -------
    Parametrization
        Singular vertices lie at whole numbers, aligned boundaries half-way between.

    Raises
    ------
    InputError
        If the steps are too long for the surface.

    Notes
    -----
    Least squares of ``|grad u · t1 h - 1|² + 30 |grad u · t2 h|²``, the same for v. The real
    unknowns are eliminated once; what is left is a small quadratic function of the integers.

    References
    ----------
    Bommes, Zimmer, Kobbelt, Mixed-integer quadrangulation, 2009, for the greedy rounding.
    """
    gradients = chart_gradients(surface, frames, edge_length)
    alignments = align_boundary(surface, fans, frames, seams, edge_length)
    slopes = (
        (gradients.along_first, gradients.along_second),
        (gradients.along_second, gradients.along_first),
    )
    problems = [
        _coordinate(surface, seams, alignment, gradients, pair)
        for alignment, pair in zip(alignments, slopes, strict=True)
    ]
    solved = [_solve(problem, seams) for problem in problems]
    count = len(surface.points)
    start = np.stack([vector[:count] for vector, _ in solved], 1)
    is_fixed = np.stack([fixed for _, fixed in solved], 1)
    shifts = [
        problem.map[:, count:] @ vector[count:]
        for problem, (vector, _) in zip(problems, solved, strict=True)
    ]
    charts = replace(gradients, signs=seams.signs, shifts=np.stack(shifts, 1))
    folded = charts.determinants(start) <= 0
    if folded.mean() > FOLDED:
        raise InputError(
            f"an edge length of {edge_length * surface.size:g} is too large for the surface: "
            "the net has no room for its steps; choose a smaller one"
        )
    values = untangle(surface, charts, start, is_fixed, edge_length)
    return Parametrization(
        charts, values, charts.determinants(values) <= 0,
        sum(problem.alignment.n_sides for problem in problems), int(folded.sum()),
    )  # fmt: skip


def chart_gradients(
    surface: CongruenceMesh, frames: CombedFrames, edge_length: float
) -> ChartGradients:
    """
    Derivatives along the two directions, per edge length.

    Parameters
    ----------
    surface : CongruenceMesh
        The mesh.
    frames : CombedFrames
        The directions.
    edge_length : float
        Length of a unit step, in mean edges.

    Returns
    -------
    ChartGradients
        With trivial signs and shifts.
    """
    points = surface.points[surface.triangles]
    opposite = np.roll(points, -2, axis=1) - np.roll(points, -1, axis=1)
    normals = surface.face_frames[:, None, 2]
    slopes = np.cross(normals, opposite) / (2 * surface.face_areas)[:, None, None]
    along = []
    for angles in (frames.first, frames.second):
        circle = np.stack([np.cos(angles), np.sin(angles)], 1)
        directions = np.einsum("fi,fij->fj", circle, surface.face_frames[:, :2])
        along.append(edge_length * np.einsum("fcj,fj->fc", slopes, directions))
    count = 3 * len(surface.triangles)
    return ChartGradients(
        surface.triangles, along[0], along[1], surface.face_areas, np.ones(count),
        np.zeros((count, 2)),
    )  # fmt: skip


def _coordinate(
    surface: CongruenceMesh,
    seams: Seams,
    alignment: Alignment,
    gradients: ChartGradients,
    slopes: tuple[FloatArray, FloatArray],
) -> _Coordinate:
    from scipy.sparse import csr_array, hstack, vstack

    alignment, solutions = _consistent(seams, alignment)
    corners = np.arange(len(seams.signs))
    faces, vertices = corners // 3, surface.triangles.ravel()
    shape = (len(corners), len(surface.points))
    spread = csr_array((seams.signs, (corners, vertices)), shape=shape)
    runs = csr_array((len(corners), alignment.expressions.shape[1] - seams.shifts.shape[1]))
    corner_map = hstack([spread, seams.shifts, runs]).tocsr()
    scale = np.sqrt(gradients.areas / gradients.areas.sum())
    shape = (len(surface.triangles), len(corners))
    along, across = (
        csr_array(((slope * scale[:, None]).ravel(), (faces, corners)), shape=shape)
        for slope in slopes
    )
    jacobian = vstack([along, np.sqrt(ACROSS) * across]) @ corner_map
    target = np.concatenate([scale, np.zeros(len(scale))])
    is_free = seams.is_free and len(alignment.vertices) == 0
    pinned = np.arange(1 if is_free else 0)
    return _Coordinate(corner_map, jacobian.tocsc(), target, alignment, solutions, pinned)


def _consistent(seams: Seams, alignment: Alignment) -> tuple[Alignment, IntegerSolutions]:
    """The alignment and the integers that it allows; none where it contradicts itself."""
    for trial in (alignment, no_alignment(seams.shifts.shape[1])):
        n_sides = trial.expressions.shape[1] - seams.shifts.shape[1]
        padding = np.zeros((len(seams.relations), n_sides))
        relations = np.concatenate([np.hstack([seams.relations, padding]), trial.relations])
        constants = np.concatenate([np.zeros(len(seams.relations)), trial.relation_constants])
        solutions = integer_solutions(relations, constants)
        if solutions is not None:
            return trial, solutions
    # Without alignment all constants are zero, and zeros are a solution.
    raise AssertionError


def _solve(problem: _Coordinate, seams: Seams) -> tuple[FloatArray, BoolArray]:
    """Vertices and integers at the minimum, and which vertices the integers fix."""
    from scipy.sparse.linalg import splu

    jacobian, alignment = problem.jacobian, problem.alignment
    n_integers = alignment.expressions.shape[1]
    count = jacobian.shape[1] - n_integers
    singular = seams.singular
    fixed = np.concatenate([singular, alignment.vertices, problem.pinned])
    expressions = np.concatenate(
        [
            np.eye(n_integers)[: len(singular)],
            alignment.expressions,
            np.zeros((len(problem.pinned), n_integers)),
        ]
    )
    constants = np.zeros(len(fixed))
    constants[len(singular) : len(singular) + len(alignment.vertices)] = alignment.constants
    is_fixed = np.zeros(count, bool)
    is_fixed[fixed] = True
    real = jacobian[:, np.flatnonzero(~is_fixed)]
    whole = jacobian[:, fixed] @ expressions + jacobian[:, count:].toarray()
    right = problem.target - jacobian[:, fixed] @ constants
    normal = (real.T @ real).tocsc()
    solver = splu(
        normal, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )  # fmt: skip
    mixed = real.T @ whole
    follow = solver.solve(np.concatenate([mixed, (real.T @ right)[:, None]], axis=1))
    hessian = whole.T @ whole - mixed.T @ follow[:, :-1]
    gradient = whole.T @ right - mixed.T @ follow[:, -1]
    integers = round_minimum(hessian, gradient, problem.solutions, len(singular))
    vector = np.zeros(jacobian.shape[1])
    vector[count:] = integers
    vector[fixed] = expressions @ integers + constants
    vector[np.flatnonzero(~is_fixed)] = follow[:, -1] - follow[:, :-1] @ integers
    return vector, is_fixed
