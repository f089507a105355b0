"""One coordinate of a seamless map: a least-squares problem in real numbers and integers.

The real unknowns are eliminated once; what is left is a small quadratic function of integers.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...solvers.factorization import SparseArray, factorize_symmetric
from ..field.congruence_mesh import CongruenceMesh
from .boundary_alignment import Alignment
from .integer_rounding import IntegerSolutions, Quadratic, relaxed_minimum, round_minimum
from .seams import Seams

ACROSS = 100.0
"""
Weight of the direction in which a coordinate shall not change.

Where lines leave the directions, planar nodes move; with less weight those near the boundary
move off the surface, with more the lines around singular points crowd.
"""

ACROSS_HELD = 30.0
"""The same where sides of the boundary hold lines: they leave the directions more gently."""

MOST_STRETCH = 1.5
"""Largest factor by which steps that come out too long are shortened."""


@dataclass(frozen=True)
class Coordinate:
    """A coordinate whose real unknowns follow its integers.

    Attributes
    ----------
    corner_map : (H, V + n) sparse array
        Values at the corners from those at the vertices and the integers.
    is_free : bool
        Whether a constant may be added to all values.
    corner_areas : (H,) float array
        A third of the area of the face of each corner.
    is_fixed : (V,) bool array
        Vertices whose values the integers give.
    expressions, constants : (k, n) and (k,) float array
        The values of the fixed vertices, in the order of `fixed`.
    fixed : (k,) int array
        The fixed vertices.
    rest : (2 F, n + 2) float array
        What the integers, the target and the constants leave of the residuals.
    follow : (V - k, n + 2) float array
        How the free vertices follow them, with the opposite sign.
    target : (2 F,) float array
        Right side of the least squares.
    scale : float
        Largest square of a column of the integers before the elimination.
    """

    corner_map: SparseArray
    is_free: bool
    corner_areas: FloatArray
    is_fixed: BoolArray
    expressions: FloatArray
    constants: FloatArray
    fixed: IntArray
    rest: FloatArray
    follow: FloatArray
    target: FloatArray
    scale: float


def eliminate(
    surface: CongruenceMesh,
    seams: Seams,
    alignment: Alignment,
    along: FloatArray,
    across: FloatArray,
) -> Coordinate:
    """Set up one coordinate and eliminate its real unknowns.

    The alignment tells the boundary vertices at which the coordinate is given by integers;
    `along` and `across` (F, 3) are derivatives as weights of the corners: that which shall be
    1, and that which shall be 0.

    Notes
    -----
    Least squares of ``|grad u · t1 h - 1|² + w |grad u · t2 h|²`` over the area, with the
    weight w of `ACROSS` or `ACROSS_HELD`.
    """
    corner_map = _corner_map(surface, seams, alignment)
    weight = ACROSS_HELD if len(alignment.vertices) else ACROSS
    jacobian, target = _least_squares(surface, corner_map, along, np.sqrt(weight) * across)
    is_free = seams.is_free and len(alignment.vertices) == 0
    fixed, expressions, constants = _fixed_vertices(seams, alignment, int(is_free))
    is_fixed = np.zeros(len(surface.points), bool)
    is_fixed[fixed] = True
    real = jacobian[:, np.flatnonzero(~is_fixed)]
    whole = jacobian[:, fixed] @ expressions + jacobian[:, len(is_fixed) :].toarray()
    columns = np.column_stack([whole, target, jacobian[:, fixed] @ constants])
    follow = factorize_symmetric(real.T @ real)(real.T @ columns)
    rest: FloatArray = columns - real @ follow
    return Coordinate(
        corner_map=corner_map,
        is_free=is_free,
        corner_areas=np.repeat(surface.face_areas / 3, 3),
        is_fixed=is_fixed,
        expressions=expressions,
        constants=constants,
        fixed=fixed,
        rest=rest,
        follow=follow,
        target=target,
        scale=float((whole**2).sum(axis=0).max(initial=0.0)),
    )


def solve_coordinate(
    coordinate: Coordinate, solutions: IntegerSolutions, n_first: int
) -> tuple[FloatArray, FloatArray]:
    """Choose the integers of a coordinate, the first `n_first` before the others.

    Values at the vertices and then the integers, (V + n,); and what the integers would be if
    they need not be whole, (n,).
    """
    n = coordinate.expressions.shape[1]
    rest, target = coordinate.rest, coordinate.target
    hessian = rest[:, :n].T @ rest[:, :n]
    slopes = rest[:, :n].T @ rest[:, n:]
    function = Quadratic(hessian, slopes[:, 0] - slopes[:, 1], coordinate.scale)
    relaxed = relaxed_minimum(function, solutions)
    step = float(target @ (target + rest @ np.concatenate([relaxed, [-1.0, 1.0]])))
    # Where the directions do not integrate the steps come out too long: correct their mean.
    stretch = float(np.clip(1 / step, 1.0, MOST_STRETCH)) if step > 0 else 1.0
    function = function._replace(gradient=stretch * slopes[:, 0] - slopes[:, 1])
    relaxed = relaxed_minimum(function, solutions)
    integers = round_minimum(function, solutions, n_first)
    values = np.empty(len(coordinate.is_fixed))
    values[coordinate.fixed] = coordinate.expressions @ integers + coordinate.constants
    known = np.concatenate([integers, [-stretch, 1.0]])
    values[~coordinate.is_fixed] = -coordinate.follow @ known
    if coordinate.is_free:
        # The middle of a surface without marks of its own is the middle of a face.
        corners = coordinate.corner_map @ np.concatenate([values, integers])
        values -= (coordinate.corner_areas @ corners) / coordinate.corner_areas.sum()
    return np.concatenate([values, integers]), relaxed


def _corner_map(surface: CongruenceMesh, seams: Seams, alignment: Alignment) -> SparseArray:
    from scipy.sparse import csr_array, hstack

    corners = np.arange(len(seams.signs))
    shape = (len(corners), len(surface.points))
    spread = csr_array((seams.signs, (corners, surface.triangles.ravel())), shape=shape)
    n_sides = alignment.expressions.shape[1] - seams.shifts.shape[1]
    return hstack([spread, seams.shifts, csr_array((len(corners), n_sides))]).tocsr()


def _least_squares(
    surface: CongruenceMesh, corner_map: SparseArray, along: FloatArray, across: FloatArray
) -> tuple[SparseArray, FloatArray]:
    from scipy.sparse import csr_array, vstack

    corners = np.arange(along.size)
    scale = np.sqrt(surface.face_areas / surface.face_areas.sum())
    shape = (len(scale), len(corners))
    slopes = [
        csr_array(((scale[:, None] * derivative).ravel(), (corners // 3, corners)), shape=shape)
        for derivative in (along, across)
    ]
    target = np.concatenate([scale, np.zeros(len(scale))])
    return (vstack(slopes) @ corner_map).tocsc(), target


def _fixed_vertices(
    seams: Seams, alignment: Alignment, n_pins: int
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Vertices whose values are given: their ids, the expressions by integers, constants."""
    n_singular, n = len(seams.singular), alignment.expressions.shape[1]
    fixed = [seams.singular, alignment.vertices, np.arange(n_pins)]
    expressions = [np.eye(n)[:n_singular], alignment.expressions, np.zeros((n_pins, n))]
    constants = [np.zeros(n_singular), alignment.constants, np.zeros(n_pins)]
    return np.concatenate(fixed), np.concatenate(expressions), np.concatenate(constants)
