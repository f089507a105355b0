"""A field of quadratic forms over a triangle mesh: its signs, and its smoothing."""

from typing import NamedTuple

import numpy as np

from ...arrays import ComplexArray, FloatArray, IntArray, dot, norm, sum_by
from ...solvers.factorization import SparseArray, factorize_symmetric
from ...solvers.weighted_graphs import piece_labels
from ...tolerances import LEAST_STIFFNESS
from .congruence_mesh import CongruenceMesh
from .tree_signs import tree_signs

COHERENCE = 4
"""Power with which disagreement with the neighbours lowers the confidence."""

GUIDED = 10.0
"""Confidence of forms that guides ask for; given ones have 1 at most."""

ALIKE_FORMS = 0.9
"""Neighbours with a larger product of their unit forms have the same sign."""

LEAST_PATCH = 0.15
"""Patches of one sign with less of the area are noise; if all are, no form is reversed."""


class Guidance(NamedTuple):
    """Directions wanted at the vertices of a surface.

    Attributes
    ----------
    deviators : (V,) complex array
        Unit forms in the coordinates of `vertex_frames`; 0 where nothing is wanted.
    trust : (V,) float array
        How much the given forms count, from 0 on the guides to 1 far from them.
    """

    deviators: ComplexArray
    trust: FloatArray


def transport(source: FloatArray, target: FloatArray) -> ComplexArray:
    """Parallel transport between tangent planes, as factors of complex coordinates.

    The frames (..., 3, 3) are right-handed: two tangents and the normal. Unit factors r: the
    vector with coordinate w in the source has ``r w`` in the target, after the smallest
    rotation that takes normal to normal; 1 if the normals are opposite.
    """
    first, second = source[..., 0, :], source[..., 1, :]
    along, across = target[..., 0, :], target[..., 1, :]
    cosine = dot(first, along) + dot(second, across)
    result = cosine + 1j * (dot(first, across) - dot(second, along))
    size = np.abs(result)
    return np.divide(result, size, out=np.ones_like(result), where=size > 0)


def orient_forms(
    surface: CongruenceMesh, trace: FloatArray, deviator: ComplexArray
) -> tuple[FloatArray, ComplexArray]:
    """Reverse forms beyond curves on which they vanish.

    Trace and deviator (V,) of the same forms, up to signs, in the coordinates of
    `vertex_frames`.

    Notes
    -----
    In general forms vanish at points alone, and none is reversed. On symmetric surfaces they do
    so along curves: where the curvature of a developable surface changes sign, or on a circle
    of umbilics of a surface of revolution. Beyond, the form has the other sign and the same
    roots, but the first of them would be taken for the second.
    """
    patches, votes = _patches(surface, trace, deviator)
    areas = np.bincount(patches, surface.vertex_areas)
    signs = tree_signs(votes)
    signs *= signs[areas.argmax()]
    if not (areas[signs < 0] > LEAST_PATCH * areas.sum()).any():
        return trace, deviator
    return trace * signs[patches], deviator * signs[patches]


def _patches(
    surface: CongruenceMesh, trace: FloatArray, deviator: ComplexArray
) -> tuple[IntArray, SparseArray]:
    """Patch of forms of one sign of each vertex, and how alike the patches are."""
    from scipy.sparse import csr_array

    tails = surface.triangles.ravel()
    heads = np.roll(surface.triangles, -1, axis=1).ravel()
    frames = surface.vertex_frames
    moved = transport(frames[tails], frames[heads]) ** 2 * deviator[tails]
    products = trace[tails] * trace[heads] + (moved * deviator[heads].conj()).real
    size = np.hypot(trace, np.abs(deviator))
    bound = size[tails] * size[heads]
    likeness = np.divide(products, bound, out=np.ones_like(bound), where=bound > 0)
    is_alike = likeness > ALIKE_FORMS
    patches = piece_labels(tails[is_alike], heads[is_alike], len(size))
    count = int(patches.max()) + 1
    between = patches[tails] != patches[heads]
    ends = (patches[tails[between]], patches[heads[between]])
    votes = csr_array((likeness[between], ends), shape=(count, count))
    votes = (votes + votes.T).tocsr()
    return patches, votes / np.abs(votes.data).max(initial=1.0)


def smooth_forms(
    surface: CongruenceMesh,
    trace: FloatArray,
    deviator: ComplexArray,
    length: float,
    guidance: Guidance | None = None,
) -> tuple[FloatArray, ComplexArray]:
    """Smooth a field of forms where it says little, and keep it where it is sure.

    Trace and deviator are (V,), in the coordinates of `vertex_frames`. `length` is the distance
    over which the field is smoothed, in mean edges; 0 gives the normalised field. Where there
    is guidance, its forms take the place of the given ones.

    Notes
    -----
    Screened Poisson: the minimum of ``Σ c |q - q'|² + length² |grad q|²`` for the forms q' of
    unit size. The confidence c grows with the size of the given form, which vanishes where
    every direction is conjugate, and with its likeness to the forms around, which noise does
    not have: elsewhere the neighbours decide, and pairs of singularities vanish.
    """
    from scipy.sparse import block_array

    size = np.sqrt(trace**2 + np.abs(deviator) ** 2)
    unit_size = np.where(size > 0, size, 1.0)
    trace, deviator = trace / unit_size, deviator / unit_size
    if length == 0 and guidance is None:
        return trace, deviator
    middle = float(np.median(size))
    confidence = size / (size + middle) if middle > 0 else np.zeros_like(size)
    confidence = confidence * _coherence(surface, trace, deviator) ** COHERENCE
    if guidance is not None:
        is_guided = guidance.deviators != 0
        confidence = np.where(is_guided, GUIDED, guidance.trust * confidence)
        trace = np.where(is_guided, 0.0, trace)
        deviator = np.where(is_guided, guidance.deviators, deviator)
    weights = surface.vertex_areas * np.maximum(confidence, LEAST_STIFFNESS)
    flat = _solve(length**2 * _stiffness(surface, 0).real, weights, trace)
    # In real coordinates: the factorisation of complex matrices is ten times slower.
    stiffness = length**2 * _stiffness(surface, 2)
    parts = block_array([[stiffness.real, -stiffness.imag], [stiffness.imag, stiffness.real]])
    values = np.concatenate([deviator.real, deviator.imag])
    real, imaginary = np.split(_solve(parts, np.tile(weights, 2), values), 2)
    return flat, real + 1j * imaginary


def _coherence(
    surface: CongruenceMesh, trace: FloatArray, deviator: ComplexArray
) -> FloatArray:
    """Length of the mean of the unit forms around each vertex: 1 where all are alike."""
    starts = surface.triangles.ravel()
    ends = np.roll(surface.triangles, -1, axis=1).ravel()
    tails, heads = np.concatenate([starts, ends]), np.concatenate([ends, starts])
    count = len(trace)
    frames = surface.vertex_frames
    moved = transport(frames[tails], frames[heads]) ** 2 * deviator[tails]
    parts = np.stack([trace[tails], moved.real, moved.imag], 1)
    return norm(sum_by(heads, parts, count)) / np.bincount(heads, minlength=count)


def _solve(stiffness: SparseArray, weights: FloatArray, values: FloatArray) -> FloatArray:
    """Solve ``(stiffness + weights) x = weights values``."""
    from scipy.sparse import diags_array

    return factorize_symmetric(stiffness + diags_array(weights))(weights * values)


def _stiffness(surface: CongruenceMesh, power: int) -> SparseArray:
    """Hermitian connection Laplacian (V, V) of fields that turn by a power of the frames."""
    from scipy.sparse import csr_array

    tails = surface.triangles.ravel()
    heads = np.roll(surface.triangles, -1, axis=1).ravel()
    apexes = np.roll(surface.triangles, -2, axis=1).ravel()
    first = surface.points[tails] - surface.points[apexes]
    second = surface.points[heads] - surface.points[apexes]
    cotangents = dot(first, second) / norm(np.cross(first, second))
    weights = np.maximum(cotangents / 2, LEAST_STIFFNESS)
    frames = surface.vertex_frames
    turns = transport(frames[tails], frames[heads]) ** power
    values = np.concatenate([weights, weights, -weights * turns, -weights * turns.conj()])
    rows = np.concatenate([tails, heads, heads, tails])
    columns = np.concatenate([tails, heads, tails, heads])
    shape = (len(surface.points), len(surface.points))
    return csr_array((values, (rows, columns)), shape=shape)
