"""Second derivatives of a sphere congruence at the vertices of a mesh, by local polynomials."""

from dataclasses import dataclass
from math import comb
from typing import NamedTuple

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...errors import InputError
from ...solvers.factorization import SparseArray
from ...spheres.rows import recenter
from ...tolerances import JET_RANK
from .congruence_mesh import CongruenceMesh

CHUNK = 1024
"""Vertices that are fitted at once: bounds the memory."""

SPARE = 1.6
"""Neighbours for each coefficient of the polynomial, where the mesh has as many."""

DEGREES = (3, 5, 7)
"""Degrees to choose from; odd ones have the smaller error in second derivatives."""


@dataclass(frozen=True)
class CongruenceJets:
    """A smooth congruence to second order, at any number of parameters (u, v).

    Attributes
    ----------
    rows : (..., 5) float array
        Rows of the spheres, any five homogeneous coordinates.
    rows_u, rows_v : (..., 5) float array
        First derivatives.
    rows_uu, rows_uv, rows_vv : (..., 5) float array
        Second derivatives.
    """

    rows: FloatArray
    rows_u: FloatArray
    rows_v: FloatArray
    rows_uu: FloatArray
    rows_uv: FloatArray
    rows_vv: FloatArray


class JetFit(NamedTuple):
    """Jets at the vertices of a mesh.

    Attributes
    ----------
    jets : CongruenceJets
        Derivatives at the vertices with respect to the two tangents of `vertex_frames`; rows
        seen from the vertex, everything in mean edges.
    heights : (V, 6) float array
        Height of the surface over the two tangents and its five derivatives, in this order:
        what the frame misses of the surface.
    degree : int
        Degree of the polynomials.
    """

    jets: CongruenceJets
    heights: FloatArray
    degree: int


def fit_jets(surface: CongruenceMesh, degree: int | None = None, rings: int = 4) -> JetFit:
    """Fit a polynomial to all five coordinates of the spheres around each vertex.

    Parameters
    ----------
    degree : int, optional
        Degree of the polynomials, from 2 to 7; by default that of `DEGREES` with the least
        expected error.
    rings : int
        Rings of neighbours; more where that is too few for the degree, as on boundaries.

    Returns
    -------
    JetFit
        Derivatives at the vertices.

    Raises
    ------
    InputError
        If the degree or the rings are out of range, or the mesh has too few vertices.

    Notes
    -----
    Weighted least squares with a Gaussian of the distance. Fits are linear in the spheres:
    ``D = L spheres``, with noise of variance ``σ² |L|²``, σ from what the highest degree
    leaves. Its fit D' has the least bias, so that second derivatives D of a lower degree are
    off by ``|D - D'|² - σ² |L - L'|² + σ² |L|²``, squared and on average (Mallows' criterion).
    One degree is chosen for all vertices.

    References
    ----------
    Cazals and Pouget, Estimating differential quantities using polynomial fitting of osculating
    jets, 2005. Mallows, Some comments on C_p, 1973.
    """
    if degree is not None and not 2 <= degree <= DEGREES[-1]:
        raise InputError(
            f"the degree of the jets must be from 2 to {DEGREES[-1]}, not {degree}"
        )
    if not 1 <= rings <= 10:
        raise InputError(f"the jets need from 1 to 10 rings, not {rings}")
    degrees = _degrees(len(surface.points)) if degree is None else [degree]
    powers = _powers(degrees[-1])
    if len(surface.points) < len(powers):
        raise InputError(
            f"a jet of degree {degrees[-1]} needs {len(powers)} vertices, the mesh has "
            f"{len(surface.points)}: subdivide it"
        )
    neighbors, counts = _neighborhoods(surface, rings, int(SPARE * len(powers)))
    derivatives = np.zeros((len(degrees), len(counts), 6, 6))
    errors = np.zeros(len(degrees))
    order = np.argsort(counts, kind="stable")
    for start in range(0, len(order), CHUNK):
        vertices = order[start : start + CHUNK]
        slots = np.arange(int(counts[vertices].max()))
        is_used = slots < counts[vertices, None]
        places = neighbors.indptr[vertices, None] + np.where(is_used, slots, 0)
        samples = _samples(surface, vertices, neighbors.indices[places], is_used, powers)
        estimates = [_estimate(samples, len(_powers(lower))) for lower in degrees]
        for fitted, estimate in zip(derivatives, estimates, strict=True):
            fitted[vertices] = _derivatives(samples, estimate)
        if len(degrees) > 1:
            errors += _expected_errors(samples, estimates).sum(axis=1)
    best = int(errors.argmin())
    values = derivatives[best, :, :, :5].transpose(1, 0, 2)
    values[0] += surface.rows
    return JetFit(CongruenceJets(*values), derivatives[best, ..., 5], degrees[best])


def _degrees(n_vertices: int) -> list[int]:
    """Those of `DEGREES` for which a mesh has neighbours to spare, else the least."""
    usable = [d for d in DEGREES if int(SPARE * len(_powers(d))) <= n_vertices]
    return usable or [2]


def _powers(degree: int) -> list[tuple[int, int]]:
    """Exponents of the monomials, those of lower degree first."""
    return [(i - j, j) for i in range(degree + 1) for j in range(i + 1)]


def _neighborhoods(
    surface: CongruenceMesh, rings: int, least: int
) -> tuple[SparseArray, IntArray]:
    """A sparse matrix whose rows are the vertices around each and itself, and their numbers."""
    from scipy.sparse import csr_array, eye_array

    count = len(surface.points)
    tails = surface.triangles.ravel()
    heads = np.roll(surface.triangles, -1, axis=1).ravel()
    ones = np.ones(len(tails), bool)
    near = csr_array((ones, (tails, heads)), shape=(count, count))
    near = (near + near.T + eye_array(count, dtype=bool)).tocsr()
    around = near
    for _ in range(rings - 1):
        around = (around @ near).tocsr()
    while True:
        counts: IntArray = np.diff(around.indptr)
        is_short = counts < min(least, count)
        if not is_short.any():
            return around, counts
        short = np.flatnonzero(is_short)
        select = csr_array((np.ones(len(short), bool), (short, short)), shape=(count, count))
        around = (around + select @ (around @ near)).tocsr()


class _Samples(NamedTuple):
    """What polynomials of m coefficients are fitted to: k neighbours of n vertices."""

    monomials: FloatArray
    """Weighted monomials (n, k, m) of the tangential coordinates, in `scales`."""
    weights: FloatArray
    """Weights (n, k); zero for slots without a neighbour."""
    values: FloatArray
    """Weighted rows minus that of the vertex, and heights, (n, k, 6)."""
    gram: FloatArray
    """Products (n, m, m) of the monomials, made safe to invert."""
    scales: FloatArray
    """Distances (n,) of the farthest neighbours."""


def _samples(
    surface: CongruenceMesh,
    vertices: IntArray,
    neighbors: IntArray,
    is_used: BoolArray,
    powers: list[tuple[int, int]],
) -> _Samples:
    offsets = surface.points[neighbors] - surface.points[vertices, None]
    frames = surface.vertex_frames[vertices]
    x, y, height = np.einsum("nki,nji->jnk", offsets, frames)
    scales = np.sqrt(np.where(is_used, x * x + y * y, 0).max(axis=1))
    x, y = x / scales[:, None], y / scales[:, None]
    weights = np.where(is_used, np.exp(-(x * x + y * y)), 0.0)
    left, right = np.array(powers).T
    monomials = _stacked_powers(x, left) * _stacked_powers(y, right) * weights[..., None]
    rows = recenter(surface.rows[neighbors], -offsets) - surface.rows[vertices, None]
    values = np.concatenate([rows, height[..., None]], -1) * weights[..., None]
    gram = monomials.transpose(0, 2, 1) @ monomials
    # Neighbours on few lines leave coefficients open: those become small, in Bombieri's norm,
    # which is the same in all frames.
    bombieri = np.diag([1 / comb(i + j, i) for i, j in powers])
    gram += JET_RANK * gram[:, :1, :1] * bombieri
    return _Samples(monomials, weights, values, gram, scales)


def _stacked_powers(values: FloatArray, exponents: IntArray) -> FloatArray:
    factors = np.repeat(values[..., None], exponents.max() + 1, axis=-1)
    factors[..., 0] = 1.0
    return np.multiply.accumulate(factors, axis=-1)[..., exponents]


def _estimate(samples: _Samples, count: int) -> FloatArray:
    """The first six coefficients (n, 6, k) of a fit of `count`, as forms of the values."""
    gram = samples.gram[:, :count, :count]
    wanted = np.broadcast_to(np.eye(count, 6), (len(gram), count, 6))
    forms = np.linalg.solve(gram, wanted).transpose(0, 2, 1)
    return forms @ samples.monomials[:, :, :count].transpose(0, 2, 1)


def _derivatives(samples: _Samples, estimate: FloatArray) -> FloatArray:
    """Row minus that of the vertex and its five derivatives, (n, 6, 6); last column: height."""
    factors = np.array([1.0, 1.0, 1.0, 2.0, 1.0, 2.0])[:, None]
    orders = np.array([0, 1, 1, 2, 2, 2])[:, None]
    return (estimate @ samples.values) * factors / samples.scales[:, None, None] ** orders


def _expected_errors(samples: _Samples, estimates: list[FloatArray]) -> FloatArray:
    """Mean squared errors (d, n) of the second derivatives of each fit.

    In units of the square that noise of variance one would give those of the last fit: so the
    vertices inside count more than those on boundaries, which know little.
    """
    noise = _noise(samples)
    weights, rows = samples.weights[:, None], samples.values[..., :5]
    last = estimates[-1]
    unit = ((last[:, 3:] * weights) ** 2).sum(axis=(1, 2))
    result: list[FloatArray] = []
    for estimate in estimates:
        variance = ((estimate[:, 3:] * weights) ** 2).sum(axis=(1, 2))
        change = estimate[:, 3:] - last[:, 3:]
        spread = ((change * weights) ** 2).sum(axis=(1, 2))
        moved = ((change @ rows) ** 2).sum(axis=(1, 2))
        result.append((moved + noise * (variance - spread)) / unit)
    return np.stack(result)


def _noise(samples: _Samples) -> FloatArray:
    """Variance (n,) of the rows, from what the highest degree leaves of them."""
    monomials, weights, rows = samples.monomials, samples.weights, samples.values[..., :5]
    inverse = np.linalg.inv(samples.gram)
    left = rows - monomials @ (inverse @ (monomials.transpose(0, 2, 1) @ rows))
    weighted = monomials * weights[..., None]
    spent = (inverse * (weighted.transpose(0, 2, 1) @ weighted)).sum(axis=(1, 2))
    freedom = (weights**2).sum(axis=1) - spent
    return (left**2).sum(axis=(1, 2)) / freedom


def expected_node_axes(jets: CongruenceJets) -> FloatArray:
    """Directions of the node axes that the congruence predicts: normals of the centre surface.

    ``A B_u x B_v + A_u B_v x B + A_v B x B_u``, (..., 3), along the normal of the surface of
    the centres; zero where all spheres are planes, which fix no axis.
    """
    a, b = jets.rows[..., :1], jets.rows[..., 1:4]
    a_u, b_u = jets.rows_u[..., :1], jets.rows_u[..., 1:4]
    a_v, b_v = jets.rows_v[..., :1], jets.rows_v[..., 1:4]
    return a * np.cross(b_u, b_v) + a_u * np.cross(b_v, b) + a_v * np.cross(b, b_u)
