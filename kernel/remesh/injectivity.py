"""Maps of triangles without flips: what is folded is unfolded near where it is."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, sum_by
from ..tolerances import FOLD_SMOOTHING, FOLD_STEP
from .congruence_mesh import CongruenceMesh

LEAST_DETERMINANT = 0.1
"""Faces with less of their area in the map are unfolded."""

RINGS = (4, 8, 16)
"""Rings of faces around a fold that may move, one attempt after the other."""

MAX_ROUNDS = 12


@dataclass(frozen=True)
class ChartGradients:
    """
    Derivatives of two coordinates in every face with respect to its two directions.

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
        """
        Coordinates at the corners.

        Parameters
        ----------
        values : (V, 2) float array
            Coordinates at the vertices.

        Returns
        -------
        (H, 2) float array
            With the signs and shifts of the corners.
        """
        return self.signs[:, None] * values[self.triangles.ravel()] + self.shifts

    def jacobians(self, values: FloatArray) -> FloatArray:
        """
        Derivatives of u and v along the first and second direction.

        Parameters
        ----------
        values : (V, 2) float array
            Coordinates at the vertices.

        Returns
        -------
        (F, 2, 2) float array
            Rows u and v; the unit matrix where the map is as asked for.
        """
        corners = self.corner_values(values).reshape(-1, 3, 2)
        slopes = np.stack([self.along_first, self.along_second], 2)
        return np.einsum("fcu,fcd->fud", corners, slopes)

    def determinants(self, values: FloatArray) -> FloatArray:
        """
        Area of the image of each face, relative to the area asked for.

        Parameters
        ----------
        values : (V, 2) float array
            Coordinates at the vertices.

        Returns
        -------
        (F,) float array
            Not positive where the map is flipped.
        """
        return np.linalg.det(self.jacobians(values))

    def part(self, faces: IntArray) -> "ChartGradients":
        """
        The same for some of the faces.

        Parameters
        ----------
        faces : (n,) int array
            Faces to keep.

        Returns
        -------
        ChartGradients
            Vertices keep their numbers.
        """
        corners = (3 * faces[:, None] + np.arange(3)).ravel()
        return ChartGradients(
            self.triangles[faces], self.along_first[faces], self.along_second[faces],
            self.areas[faces], self.signs[corners], self.shifts[corners],
        )  # fmt: skip


def untangle(
    surface: CongruenceMesh, charts: ChartGradients, start: FloatArray, is_fixed: BoolArray
) -> FloatArray:
    """
    Move the vertices around folded faces until nothing is folded.

    Parameters
    ----------
    surface : CongruenceMesh
        The mesh.
    charts : ChartGradients
        The map.
    start : (V, 2) float array
        Coordinates of the vertices.
    is_fixed : (V, 2) bool array
        Coordinates that stay.

    Returns
    -------
    (V, 2) float array
        Coordinates; the start where it has no folds. Folds that cannot be undone remain.

    References
    ----------
    Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of
    code, 2021.
    """
    values = start
    for rings in RINGS:
        is_bad = charts.determinants(values) < LEAST_DETERMINANT
        if not is_bad.any():
            return values
        is_moving = np.zeros(len(values), bool)
        is_moving[surface.triangles[is_bad]] = True
        for _ in range(rings):
            is_near = is_moving[surface.triangles].any(axis=1)
            is_moving[surface.triangles[is_near]] = True
        faces = np.flatnonzero(is_moving[surface.triangles].any(axis=1))
        free = is_moving[:, None] & ~is_fixed
        candidate = _unfold(charts.part(faces), values, free)
        before, after = charts.determinants(values), charts.determinants(candidate)
        if (after <= 0).sum() <= (before <= 0).sum():
            values = candidate
    return values


def _unfold(part: ChartGradients, start: FloatArray, free: BoolArray) -> FloatArray:
    """Minimise a distortion that grows without bound as a face loses its area."""
    from scipy.optimize import minimize

    values = start.copy()
    energy = np.inf
    for _ in range(MAX_ROUNDS):
        least = float(part.determinants(values).min())
        softness = np.sqrt(FOLD_SMOOTHING**2 + 0.04 * min(least, 0.0) ** 2)

        def _value(x: FloatArray, soft: float = softness) -> tuple[float, FloatArray]:
            moved = values.copy()
            moved[free] = x
            cost, slope = _distortion(part, moved, soft)
            return cost, slope[free]

        found = minimize(
            _value, values[free], jac=True, method="L-BFGS-B",
            options={"maxiter": 300, "maxcor": 10},
        )  # fmt: skip
        values[free] = found.x
        is_unfolded = float(part.determinants(values).min()) > 0
        if is_unfolded and energy - found.fun <= FOLD_STEP * found.fun:
            break
        energy = found.fun if is_unfolded else np.inf
    return values


def _distortion(
    part: ChartGradients, values: FloatArray, softness: float
) -> tuple[float, FloatArray]:
    """Sum of ``(|J|² + det² + 1) / χ(det)`` over the faces, and its gradient (V, 2)."""
    jacobians = part.jacobians(values)
    a, b, c, d = jacobians.reshape(-1, 4).T
    det = a * d - b * c
    root = np.sqrt(softness**2 + det**2)
    # det + root without cancellation where det is negative.
    bound = np.where(det > 0, det + root, softness**2 / (root - np.minimum(det, 0))) / 2
    weights = part.areas / part.areas.sum()
    value = ((jacobians**2).sum(axis=(1, 2)) + det**2 + 1) / bound
    by_det = 2 * det / bound - value / bound * (bound / root)
    cofactors = np.stack([d, -c, -b, a], 1).reshape(-1, 2, 2)
    by_jacobian = 2 * jacobians / bound[:, None, None] + by_det[:, None, None] * cofactors
    slopes = np.stack([part.along_first, part.along_second], 2)
    by_corner = np.einsum("f,fud,fcd->fcu", weights, by_jacobian, slopes).reshape(-1, 2)
    gradient = sum_by(part.triangles.ravel(), part.signs[:, None] * by_corner, len(values))
    return float(weights @ value), gradient
