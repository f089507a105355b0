"""Second derivatives of a sphere congruence at the vertices of a mesh, by local polynomials."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import InputError
from ..solvers.factorization import SparseArray
from ..spheres import recenter
from ..tolerances import JET_RANK
from .congruence_mesh import CongruenceMesh

CHUNK = 4096
"""Vertices that are fitted at once: bounds the memory."""

SPARE = 1.6
"""Neighbours for each coefficient of the polynomial, where the mesh has as many."""


@dataclass(frozen=True)
class CongruenceJets:
    """
    A smooth congruence to second order, at any number of parameters (u, v).

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


def fit_jets(
    surface: CongruenceMesh, degree: int = 5, rings: int = 3
) -> tuple[CongruenceJets, FloatArray]:
    """
    Fit a polynomial to all five coordinates of the spheres around each vertex.

    Parameters
    ----------
    surface : CongruenceMesh
        The congruence.
    degree : int
        Degree of the polynomials, from 2 to 6.
    rings : int
        Rings of neighbours; more where that is too few for the degree, as on boundaries.

    Returns
    -------
    jets : CongruenceJets
        Derivatives at the vertices with respect to the two tangents of `vertex_frames`; rows
        seen from the vertex, everything in mean edges.
    slopes : (V, 2) float array
        Slope of the surface along the two tangents: what the frame misses of its tangent plane.

    Raises
    ------
    InputError
        If the degree or the rings are out of range, or the mesh has too few vertices.

    Notes
    -----
    Weighted least squares with a Gaussian of the distance. Degree 5 on 3 rings for exact
    spheres, or degree 4 for three times the error; degree 3 on 5 rings for noisy ones.

    References
    ----------
    Cazals and Pouget, Estimating differential quantities using polynomial fitting of osculating
    jets, 2005.
    """
    if not 2 <= degree <= 6:
        raise InputError(f"the degree of the jets must be from 2 to 6, not {degree}")
    if not 1 <= rings <= 10:
        raise InputError(f"the jets need from 1 to 10 rings, not {rings}")
    powers = [(i - j, j) for i in range(degree + 1) for j in range(i + 1)]
    if len(surface.points) < len(powers):
        raise InputError(
            f"a jet of degree {degree} needs {len(powers)} vertices, the mesh has "
            f"{len(surface.points)}: subdivide it"
        )
    neighbors, counts = _neighborhoods(surface, rings, int(SPARE * len(powers)))
    result = np.zeros((len(counts), 6, 6))
    order = np.argsort(counts, kind="stable")
    for start in range(0, len(order), CHUNK):
        vertices = order[start : start + CHUNK]
        slots = np.arange(int(counts[vertices].max()))
        is_used = slots < counts[vertices, None]
        places = neighbors.indptr[vertices, None] + np.where(is_used, slots, 0)
        result[vertices] = _fit(surface, vertices, neighbors.indices[places], is_used, powers)
    values = result[:, :, :5].transpose(1, 0, 2)
    values[0] += surface.rows
    return CongruenceJets(*values), result[:, 1:3, 5]


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


def _fit(
    surface: CongruenceMesh,
    vertices: IntArray,
    neighbors: IntArray,
    is_used: BoolArray,
    powers: list[tuple[int, int]],
) -> FloatArray:
    """Row minus that of the vertex and its five derivatives, (n, 6, 6); last column: height."""
    offsets = surface.points[neighbors] - surface.points[vertices, None]
    frames = surface.vertex_frames[vertices]
    x, y, height = np.einsum("nki,nji->jnk", offsets, frames)
    scales = np.sqrt(np.where(is_used, x * x + y * y, 0).max(axis=1))[:, None]
    x, y = x / scales, y / scales
    weights = np.where(is_used, np.exp(-(x * x + y * y)), 0.0)
    monomials = np.stack([x**i * y**j for i, j in powers], 2) * weights[..., None]
    rows = recenter(surface.rows[neighbors], -offsets) - surface.rows[vertices, None]
    samples = np.concatenate([rows, height[..., None]], -1) * weights[..., None]
    right = monomials.transpose(0, 2, 1) @ samples
    values, axes = np.linalg.eigh(monomials.transpose(0, 2, 1) @ monomials)
    is_safe = values > JET_RANK * values[:, -1:]
    inverse = np.where(is_safe, 1 / np.where(is_safe, values, 1.0), 0.0)
    solved = axes @ (inverse[..., None] * (axes.transpose(0, 2, 1) @ right))
    wanted = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    factors = np.array([1.0, 1.0, 1.0, 2.0, 1.0, 2.0])[:, None]
    orders = np.array([i + j for i, j in wanted])
    picked = solved[:, [powers.index(power) for power in wanted]] * factors
    return picked / scales[..., None] ** orders[:, None]


def node_axes(jets: CongruenceJets) -> FloatArray:
    """
    Directions of the node axes that the congruence predicts: normals of the centre surface.

    Parameters
    ----------
    jets : CongruenceJets
        The congruence.

    Returns
    -------
    (..., 3) float array
        ``A B_u x B_v + A_u B_v x B + A_v B x B_u``, along the normal of the surface of the
        centres; zero where all spheres are planes, which fix no axis.
    """
    a, b = jets.rows[..., :1], jets.rows[..., 1:4]
    a_u, b_u = jets.rows_u[..., :1], jets.rows_u[..., 1:4]
    a_v, b_v = jets.rows_v[..., :1], jets.rows_v[..., 1:4]
    return a * np.cross(b_u, b_v) + a_u * np.cross(b_v, b) + a_v * np.cross(b, b_u)
