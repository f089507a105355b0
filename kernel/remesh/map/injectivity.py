"""Maps of triangles without flips: what is folded is unfolded near where it is."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, dot, sum_by
from ...solvers.factorization import factorize_symmetric
from ...solvers.levenberg_marquardt import DampedStep, levenberg_marquardt
from ...tolerances import FOLD_SMOOTHING, FOLD_STEP
from ..field.congruence_mesh import CongruenceMesh

LEAST_DETERMINANT = 0.1
"""Faces with less of their area in the map are unfolded."""

REACHES = (1.0, 2.0, 4.0)
"""Distances from a fold within which vertices may move, in steps, one attempt after another."""

SOFTNESS = 0.2
"""Width of the barrier against folds, relative to the worst of them."""

UNFOLDING_ROUNDS = 20
UNFOLDING_STEPS = 12


@dataclass(frozen=True)
class ChartGradients:
    """Derivatives of two coordinates in every face with respect to its two directions.

    Attributes
    ----------
    triangles : (F, 3) int array
        Vertices of the faces.
    along_first, along_second : (F, 3) float array
        Derivative along each direction, per unit step, as weights of the corners.
    areas : (F,) float array
        Weights of the faces.
    signs : (H,) float array
        Factor between the value at a vertex and at its corners.
    shifts : (H, 2) float array
        What is added at the corners.
    """

    triangles: IntArray
    along_first: FloatArray
    along_second: FloatArray
    areas: FloatArray
    signs: FloatArray
    shifts: FloatArray

    def corner_values(self, values: FloatArray) -> FloatArray:
        """Coordinates (H, 2) at the corners, with the signs and shifts there."""
        return self.signs[:, None] * values[self.triangles.ravel()] + self.shifts

    def jacobians(self, values: FloatArray) -> FloatArray:
        """Derivatives of u and v along the first and second direction, (F, 2, 2).

        Rows u and v; the unit matrix where the map is as asked for.
        """
        corners = self.corner_values(values).reshape(-1, 3, 2)
        slopes = np.stack([self.along_first, self.along_second], 2)
        return np.einsum("fcu,fcd->fud", corners, slopes)

    def determinants(self, values: FloatArray) -> FloatArray:
        """Area (F,) of each face's image over that asked for; not positive if flipped."""
        return np.linalg.det(self.jacobians(values))

    def spread(self) -> FloatArray:
        """The linear map from the vertices of a face to the entries of its Jacobian, (F, 4, 6).

        Columns u and v of the first vertex, of the second and of the third.
        """
        slopes = np.stack([self.along_first, self.along_second], 1)
        slopes = slopes * self.signs.reshape(-1, 1, 3)
        result = np.zeros((len(slopes), 4, 6))
        result[:, :2, 0::2] = result[:, 2:, 1::2] = slopes
        return result

    def part(self, faces: IntArray) -> "ChartGradients":
        """The same for some of the faces."""
        corners = (3 * faces[:, None] + np.arange(3)).ravel()
        return ChartGradients(
            self.triangles[faces], self.along_first[faces], self.along_second[faces],
            self.areas[faces], self.signs[corners], self.shifts[corners],
        )  # fmt: skip


def untangle(
    surface: CongruenceMesh,
    charts: ChartGradients,
    start: FloatArray,
    is_fixed: BoolArray,
    edge_length: float,
) -> FloatArray:
    """Move the vertices around folded faces until nothing is folded.

    Coordinates are (V, 2), some of them fixed; a unit step is `edge_length` mean edges long.
    The start comes back where it has no folds. Folds that cannot be undone remain.

    Notes
    -----
    Faces with little area are unfolded as well where there are folds, and everything within a
    few steps of them may move.

    References
    ----------
    Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of
    code, 2021.
    """
    values = start
    for steps in REACHES:
        determinants = charts.determinants(values)
        if (determinants > 0).all():
            break
        is_moving = np.zeros(len(values), bool)
        is_moving[surface.triangles[determinants < LEAST_DETERMINANT]] = True
        for _ in range(int(np.ceil(steps * max(edge_length, 2.0)))):
            is_near = is_moving[surface.triangles].any(axis=1)
            is_moving[surface.triangles[is_near]] = True
        faces = np.flatnonzero(is_moving[surface.triangles].any(axis=1))
        values = _unfold(charts.part(faces), values, is_moving[:, None] & ~is_fixed)
    return values


def _unfold(part: ChartGradients, start: FloatArray, free: BoolArray) -> FloatArray:
    """Minimise a distortion that grows without bound as a face loses its area."""
    values = start
    last = np.inf
    for _ in range(UNFOLDING_ROUNDS):
        least = float(part.determinants(values).min())
        softness = float(np.sqrt(FOLD_SMOOTHING**2 + (SOFTNESS * min(least, 0.0)) ** 2))
        values, energy = _newton(part, values, free, softness)
        is_unfolded = float(part.determinants(values).min()) > 0
        if is_unfolded and last - energy <= FOLD_STEP * energy:
            break
        last = energy if is_unfolded else np.inf
    return values


def _newton(
    part: ChartGradients, start: FloatArray, free: BoolArray, softness: float
) -> tuple[FloatArray, float]:
    """A few damped steps, and the distortion reached."""
    from scipy.sparse import csc_array, diags_array

    n_free = int(free.sum())
    numbers = np.full(free.shape, n_free)
    numbers[free] = np.arange(n_free)
    unknowns: IntArray = numbers[part.triangles].reshape(-1, 6)
    rows, columns = np.repeat(unknowns, 6, axis=1), np.tile(unknowns, 6)
    shape = (n_free + 1, n_free + 1)

    def _energies(values: FloatArray) -> FloatArray:
        return np.array([distortion(part.jacobians(values), softness)[0] @ part.areas])

    def _linearize(values: FloatArray) -> Callable[[float], DampedStep]:
        value, by_jacobian, curvature = distortion(part.jacobians(values), softness)
        spread = part.spread()
        slopes = np.einsum("f,fj,fjk->fk", part.areas, by_jacobian, spread)
        blocks = np.einsum("f,fji,fjl,flk->fik", part.areas, spread, curvature, spread)
        gradient = sum_by(unknowns.ravel(), slopes.ravel(), n_free + 1)[:n_free]
        entries = (blocks.ravel(), (rows.ravel(), columns.ravel()))
        matrix = csc_array(entries, shape=shape)[:n_free, :n_free]
        diagonal = matrix.diagonal()

        def _solve(damping: float) -> DampedStep:
            damped = matrix + diags_array(damping * diagonal)
            step = factorize_symmetric(damped)(-gradient)
            model = float(value @ part.areas + gradient @ step + step @ (matrix @ step) / 2)
            return DampedStep(step, model)

        return _solve

    def _move(values: FloatArray, step: FloatArray) -> FloatArray:
        moved = values.copy()
        moved[free] += step
        return moved

    found = levenberg_marquardt(start, _energies, _linearize, _move, FOLD_STEP, UNFOLDING_STEPS)
    return found.state, float(found.history[-1, 0])


def distortion(
    jacobians: FloatArray, softness: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Distortion ``(|J|² + det² + 1) / χ(det)`` of maps J (n, 2, 2) of the plane.

    The softness is the width ε in ``χ(d) = (d + sqrt(ε² + d²)) / 2``: positive for all d, and
    about d where that is positive. Values (n,), slopes (n, 4) by the entries of J, and
    curvatures (n, 4, 4): second derivatives without those of the determinant and of χ, positive
    semidefinite, since a square over a linear function is convex.
    """
    flat = jacobians.reshape(-1, 4)
    a, b, c, d = flat.T
    det = a * d - b * c
    cofactors = np.stack([d, -c, -b, a], 1)
    root = np.sqrt(softness**2 + det**2)
    # det + root without cancellation where det is negative.
    chi = np.where(det > 0, det + root, softness**2 / (root - np.minimum(det, 0))) / 2
    chi_d = chi / root
    top = dot(flat, flat) + det**2 + 1
    by_det = 2 * det / chi - top * chi_d / chi**2
    by_det_twice = 2 / chi - 4 * det * chi_d / chi**2 + 2 * top * chi_d**2 / chi**3
    mixed = (-2 * chi_d / chi**2)[:, None] * flat
    slopes = 2 * flat / chi[:, None] + by_det[:, None] * cofactors
    cross = mixed[:, :, None] * cofactors[:, None]
    curvatures = cross + cross.transpose(0, 2, 1)
    curvatures += by_det_twice[:, None, None] * cofactors[:, :, None] * cofactors[:, None]
    curvatures += (2 / chi)[:, None, None] * np.eye(4)
    return top / chi, slopes, curvatures
