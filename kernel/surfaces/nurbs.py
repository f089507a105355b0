"""NURBS surfaces: exact points, derivatives and principal curvatures.

A surface is a net of homogeneous control points (w x, w y, w z, w) over two knot vectors. Only
the ``degree + 1`` basis functions that do not vanish are evaluated, by the recursion of Cox and
de Boor; the others never meet a division by zero.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, read_only, unit
from ..errors import InputError
from ..tolerances import EPSILON, PARAMETER_SLACK

_GRID = 17
"""Points each way of the grid in which a search for the nearest point begins."""

_STEPS = 20


@dataclass(frozen=True)
class NurbsSurface:
    """A rational tensor-product B-spline surface.

    Attributes
    ----------
    knots_u, knots_v : (n + p + 1,), (m + q + 1,) float array
        Knots, not decreasing; p and q are the degrees.
    points : (n, m, 4) float array
        Homogeneous control points (w x, w y, w z, w) with positive weights.

    Raises
    ------
    InputError
        If the numbers do not fit each other or are not finite, knots decrease or a weight is
        not positive.
    """

    knots_u: FloatArray
    knots_v: FloatArray
    points: FloatArray

    def __post_init__(self) -> None:
        for name in ("knots_u", "knots_v", "points"):
            array = np.array(getattr(self, name), np.float64)
            if not np.isfinite(array).all():
                raise InputError(f"{name} of a NURBS surface are not finite")
            object.__setattr__(self, name, read_only(array))
        if self.points.ndim != 3 or self.points.shape[2] != 4:
            raise InputError(f"control points have shape {self.points.shape}, not (n, m, 4)")
        if not (self.points[..., 3] > 0).all():
            raise InputError("a NURBS surface has a weight that is not positive")
        for knots, degree, count in zip(
            (self.knots_u, self.knots_v), self.degrees, self.points.shape[:2], strict=True
        ):
            if knots.ndim != 1 or not 1 <= degree < count:
                raise InputError(f"{len(knots)} knots do not fit {count} control points")
            if (np.diff(knots) < 0).any() or not knots[degree] < knots[count]:
                raise InputError("the knots of a NURBS surface decrease or span nothing")

    @property
    def degrees(self) -> tuple[int, int]:
        """Degrees along u and v.

        Returns
        -------
        (int, int)
            Degrees along u and v.
        """
        n, m = self.points.shape[:2]
        return len(self.knots_u) - n - 1, len(self.knots_v) - m - 1

    @property
    def domain(self) -> FloatArray:
        """Range of u and range of v, (2, 2).

        Returns
        -------
        (2, 2) float array
            First and last u, first and last v.
        """
        (p, q), (n, m) = self.degrees, self.points.shape[:2]
        return np.array(
            [[self.knots_u[p], self.knots_u[n]], [self.knots_v[q], self.knots_v[m]]]
        )


class SurfaceJet(NamedTuple):
    """Points (N, 3) of a surface and its first and second derivatives there."""

    points: FloatArray
    u: FloatArray
    v: FloatArray
    uu: FloatArray
    uv: FloatArray
    vv: FloatArray


class SurfaceCurvature(NamedTuple):
    """Principal curvatures of a surface at points.

    Attributes
    ----------
    normals : (N, 3) float array
        Unit normals.
    first, second : (N,) float array
        The larger and the smaller principal curvature, towards the normals.
    directions : (N, 2, 3) float array
        Unit principal directions of the two; with the normal they are right-handed.
    """

    normals: FloatArray
    first: FloatArray
    second: FloatArray
    directions: FloatArray


def evaluate_nurbs(surface: NurbsSurface, u: FloatArray, v: FloatArray) -> SurfaceJet:
    """Points of a surface with their derivatives.

    Parameters
    ----------
    u, v : (N,) float array
        Parameters in its domain; what lies outside by rounding counts as its end.

    Raises
    ------
    InputError
        If a parameter lies outside of the domain.

    References
    ----------
    L. Piegl, W. Tiller, The NURBS Book, algorithms A2.2, A2.3 and A4.4.
    """
    u, v = _clipped(surface, u, v)
    p, q = surface.degrees
    first_u, basis_u = _basis(surface.knots_u, p, u)
    first_v, basis_v = _basis(surface.knots_v, q, v)
    origin = _center(surface)
    net = surface.points.copy()
    net[..., :3] -= origin * net[..., 3:]
    rows: IntArray = first_u[:, None] + np.arange(p + 1)
    columns: IntArray = first_v[:, None] + np.arange(q + 1)
    local = net[rows[:, :, None], columns[:, None]]

    def _derivative(a: int, b: int) -> FloatArray:
        return np.einsum("ni,nijk,nj->nk", basis_u[a], local, basis_v[b])

    h, h_u, h_v = _derivative(0, 0), _derivative(1, 0), _derivative(0, 1)
    h_uu, h_uv, h_vv = _derivative(2, 0), _derivative(1, 1), _derivative(0, 2)
    weight = h[:, 3:]
    points = h[:, :3] / weight
    d_u = (h_u[:, :3] - h_u[:, 3:] * points) / weight
    d_v = (h_v[:, :3] - h_v[:, 3:] * points) / weight
    d_uu = (h_uu[:, :3] - 2 * h_u[:, 3:] * d_u - h_uu[:, 3:] * points) / weight
    d_vv = (h_vv[:, :3] - 2 * h_v[:, 3:] * d_v - h_vv[:, 3:] * points) / weight
    mixed = h_u[:, 3:] * d_v + h_v[:, 3:] * d_u + h_uv[:, 3:] * points
    d_uv = (h_uv[:, :3] - mixed) / weight
    return SurfaceJet(points + origin, d_u, d_v, d_uu, d_uv, d_vv)


def _clipped(surface: NurbsSurface, u: FloatArray, v: FloatArray) -> FloatArray:
    """Parameters (2, N) in the domain."""
    parameters, (low, high) = np.stack([u, v]), surface.domain.T[:, :, None]
    inside = np.clip(parameters, low, high)
    # Trims of a file end at a domain up to the digits of the larger of its ends.
    slack = PARAMETER_SLACK * np.maximum(high - low, np.maximum(np.abs(low), np.abs(high)))
    if not (np.abs(parameters - inside) <= slack).all():
        (low_u, high_u), (low_v, high_v) = surface.domain
        raise InputError(
            f"parameters must lie in [{low_u:g}, {high_u:g}] and [{low_v:g}, {high_v:g}]"
        )
    return inside


def _center(surface: NurbsSurface) -> FloatArray:
    """A point near the surface: seen from it, sites far away cost no digits."""
    return surface.points[0, 0, :3] / surface.points[0, 0, 3]


def _basis(knots: FloatArray, degree: int, t: FloatArray) -> tuple[IntArray, list[FloatArray]]:
    """First function that does not vanish, and values, first and second derivatives."""
    last = len(knots) - degree - 2
    span = np.clip(np.searchsorted(knots, t, "right") - 1, degree, last)
    # The end of the domain belongs to the last span of positive length.
    while (is_empty := knots[span] == knots[span + 1]).any():
        span = span - is_empty
    values = [np.ones((len(t), 1))]
    for order in range(1, degree + 1):
        values.append(_raised(knots, span, order, t, values[-1]))
    slopes = _differences(knots, span, degree, values[degree - 1])
    bends = np.zeros_like(slopes)
    if degree > 1:
        inner = _differences(knots, span, degree - 1, values[degree - 2])
        bends = _differences(knots, span, degree, inner)
    return span - degree, [values[degree], slopes, bends]


def _widths(
    knots: FloatArray, span: IntArray, degree: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Starts, ends and lengths (n, degree) of the supports that functions are raised over."""
    starts = knots[span[:, None] + np.arange(1 - degree, 1)]
    ends = knots[span[:, None] + np.arange(1, degree + 1)]
    return starts, ends, ends - starts


def _raised(
    knots: FloatArray, span: IntArray, degree: int, t: FloatArray, lower: FloatArray
) -> FloatArray:
    """Functions of a degree from those of the degree below."""
    starts, ends, lengths = _widths(knots, span, degree)
    result = np.zeros((len(t), degree + 1))
    result[:, 1:] += (t[:, None] - starts) / lengths * lower
    result[:, :-1] += (ends - t[:, None]) / lengths * lower
    return result


def _differences(
    knots: FloatArray, span: IntArray, degree: int, lower: FloatArray
) -> FloatArray:
    """Derivatives of combinations of functions of a degree, from the degree below."""
    _, _, lengths = _widths(knots, span, degree)
    result = np.zeros((len(span), degree + 1))
    result[:, 1:] += degree / lengths * lower
    result[:, :-1] -= degree / lengths * lower
    return result


def nurbs_curvatures(surface: NurbsSurface, u: FloatArray, v: FloatArray) -> SurfaceCurvature:
    """Exact principal curvatures of a surface.

    Parameters
    ----------
    u, v : (N,) float array
        Parameters in its domain.

    Returns
    -------
    SurfaceCurvature
        Unit normals along ``x_u × x_v`` and the principal curvatures, positive where the
        surface bends to the normal, with their directions; NaN at singular points, such as the
        poles of a sphere (see `shape_at`).

    Raises
    ------
    InputError
        If a parameter lies outside of the domain.

    Notes
    -----
    Eigenvalues of the second fundamental form in an orthonormal frame, where a difference of
    equal curvatures is a difference of entries: umbilics lose no digits.
    """
    jet = evaluate_nurbs(surface, u, v)
    normals = unit(np.cross(jet.u, jet.v))
    with np.errstate(divide="ignore", invalid="ignore"):
        along = jet.u / norm(jet.u)[:, None]
        across = np.cross(normals, along)
        # x_u = a e1, x_v = b e1 + c e2
        a, b, c = norm(jet.u), dot(jet.v, along), dot(jet.v, across)
        l_uu, l_uv, l_vv = (dot(each, normals) for each in (jet.uu, jet.uv, jet.vv))
        s_11 = l_uu / a**2
        s_12 = (l_uv - b * l_uu / a) / (a * c)
        s_22 = (l_vv - 2 * b * l_uv / a + (b / a) ** 2 * l_uu) / c**2
    return principal_values(normals, along, np.stack([s_11, s_12, s_22], 1))


def principal_values(
    normals: FloatArray, along: FloatArray, forms: FloatArray
) -> SurfaceCurvature:
    """Eigenvalues and eigenvectors of second fundamental forms.

    Parameters
    ----------
    normals, along : (N, 3) float array
        Unit normals and the first axes of orthonormal tangent frames; NaN is allowed.
    forms : (N, 3) float array
        Entries 11, 12 and 22 of the forms in these frames.

    Returns
    -------
    SurfaceCurvature
        NaN wherever an entry is not finite.
    """
    across = np.cross(normals, along)
    half, twist = (forms[:, 0] - forms[:, 2]) / 2, forms[:, 1]
    mean, radius = (forms[:, 0] + forms[:, 2]) / 2, np.hypot(half, twist)
    angle = np.arctan2(twist, half)[:, None] / 2
    first = np.cos(angle) * along + np.sin(angle) * across
    directions = np.stack([first, np.cross(normals, first)], 1)
    is_regular = np.isfinite(mean + radius)
    return SurfaceCurvature(
        np.where(is_regular[:, None], normals, np.nan),
        np.where(is_regular, mean + radius, np.nan),
        np.where(is_regular, mean - radius, np.nan),
        np.where(is_regular[:, None, None], directions, np.nan),
    )


def nearest_parameters(
    surface: NurbsSurface, points: FloatArray, seeds: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Parameters of the points of a surface nearest to given points on or near it.

    Parameters
    ----------
    points : (N, 3) float array
    seeds : (N, 2) float array, optional
        Parameters to begin at; without them, those of the nearest point of a grid.

    Returns
    -------
    parameters : (N, 2) float array
        u and v in the domain, from Gauss-Newton steps.
    distances : (N,) float array
        Distances from the surface there, in model units.
    """
    low, high = surface.domain.T
    parameters = _nearest_of_grid(surface, points) if seeds is None else seeds
    parameters = np.clip(parameters, low, high)
    for _ in range(_STEPS):
        jet = evaluate_nurbs(surface, *parameters.T)
        miss = points - jet.points
        e, f, g = dot(jet.u, jet.u), dot(jet.u, jet.v), dot(jet.v, jet.v)
        right_u, right_v = dot(miss, jet.u), dot(miss, jet.v)
        determinant = e * g - f * f
        is_regular = determinant > EPSILON * e * g
        divisor = np.where(is_regular, determinant, 1.0)
        step = np.stack([g * right_u - f * right_v, e * right_v - f * right_u], 1)
        step = np.where(is_regular[:, None], step / divisor[:, None], 0.0)
        moved = np.clip(parameters + step, low, high)
        change = np.abs((moved - parameters) / (high - low)).max()
        parameters = moved
        if change <= 4 * EPSILON:
            break
    found = evaluate_nurbs(surface, *parameters.T).points
    return parameters, norm(points - found)


def _nearest_of_grid(surface: NurbsSurface, points: FloatArray) -> FloatArray:
    from scipy.spatial import cKDTree

    low, high = surface.domain.T
    share = np.stack(np.meshgrid(*[np.linspace(0, 1, _GRID)] * 2, indexing="ij"), -1)
    grid = np.clip(low + share.reshape(-1, 2) * (high - low), low, high)
    origin = _center(surface)
    seeds = evaluate_nurbs(surface, *grid.T).points - origin
    _, nearest = cKDTree(seeds).query(points - origin)
    return grid[nearest]
