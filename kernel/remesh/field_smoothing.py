"""The field of conjugate forms over a triangle mesh, and its smoothing."""

import numpy as np

from ..arrays import ComplexArray, FloatArray, dot, norm, sum_by
from ..errors import InputError
from ..solvers.factorization import SparseArray, factorize_symmetric
from ..tolerances import LEAST_STIFFNESS, UNDETERMINED
from .congruence_mesh import CongruenceMesh
from .conjugate import conjugate_form, split_form
from .jets import CongruenceJets

COHERENCE = 4
"""Power with which disagreement with the neighbours lowers the confidence."""


def transport(source: FloatArray, target: FloatArray) -> ComplexArray:
    """
    Parallel transport between tangent planes, as factors of complex coordinates.

    Parameters
    ----------
    source, target : (..., 3, 3) float array
        Right-handed frames: two tangents and the normal.

    Returns
    -------
    (...) complex array
        Unit factors r: the vector with coordinate w in the source has ``r w`` in the target,
        after the smallest rotation that takes normal to normal.
    """
    first, second = source[..., 0, :], source[..., 1, :]
    along, across = target[..., 0, :], target[..., 1, :]
    cosine = dot(first, along) + dot(second, across)
    result = cosine + 1j * (dot(first, across) - dot(second, along))
    return result / np.abs(result)


def conjugate_field(
    surface: CongruenceMesh, jets: CongruenceJets
) -> tuple[FloatArray, ComplexArray]:
    """
    The forms whose roots are the conjugate directions, as a field without jumps.

    Parameters
    ----------
    surface : CongruenceMesh
        The mesh.
    jets : CongruenceJets
        The congruence at its vertices.

    Returns
    -------
    trace : (V,) float array
        Means of the forms.
    deviator : (V,) complex array
        Deviators, in the coordinates of `vertex_frames`.

    Raises
    ------
    InputError
        If the form vanishes everywhere: then every direction is conjugate to some other.

    Notes
    -----
    The form has a sign as long as ``S, S_u, S_v`` are independent. Where spheres that touch a
    surface pass its principal spheres they are not, on a curve, and the form passes zero. So
    does ``<B_u x B_v, n>``, which is ``(k - k1) (k - k2)`` there: its sign undoes the jump. Of
    the field with and without this sign the one that varies less is taken.
    """
    form = conjugate_form(jets)
    parts = [jets.rows, jets.rows_u, jets.rows_v, jets.rows_uu + jets.rows_vv, jets.rows_uv]
    bound = np.prod([norm(part) for part in parts], axis=0)
    if not (norm(form) > UNDETERMINED * bound).any():
        raise InputError(
            "the spheres do not determine conjugate directions: they are planes, or touch a "
            "sphere, or are all orthogonal to one; use spheres of other radii"
        )
    trace, deviator = split_form(form)
    normals = surface.vertex_frames[:, 2]
    bending = dot(np.cross(jets.rows_u[:, 1:4], jets.rows_v[:, 1:4]), normals)
    signs = np.where(bending < 0, -1.0, 1.0)
    size = np.sqrt(trace**2 + np.abs(deviator) ** 2)
    size = np.where(size > 0, size, 1.0)
    tails, heads = surface.triangles.ravel(), np.roll(surface.triangles, -1, axis=1).ravel()
    frames = surface.vertex_frames
    moved = transport(frames[tails], frames[heads]) ** 2 * deviator[tails]
    likeness = trace[tails] * trace[heads] + (moved * deviator[heads].conj()).real
    likeness /= size[tails] * size[heads]
    if (likeness * signs[tails] * signs[heads]).sum() > likeness.sum():
        return signs * trace, signs * deviator
    return trace, deviator


def smooth_forms(
    surface: CongruenceMesh, trace: FloatArray, deviator: ComplexArray, length: float
) -> tuple[FloatArray, ComplexArray]:
    """
    Smooth a field of forms where it says little, and keep it where it is sure.

    Parameters
    ----------
    surface : CongruenceMesh
        The mesh.
    trace : (V,) float array
        Means of the forms.
    deviator : (V,) complex array
        Deviators, in the coordinates of `vertex_frames`.
    length : float
        Distance over which the field is smoothed, in mean edges; 0 gives the normalised field.

    Returns
    -------
    trace : (V,) float array
        Means of the smooth field.
    deviator : (V,) complex array
        Its deviators.

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
    if length == 0:
        return trace, deviator
    middle = float(np.median(size))
    confidence = size / (size + middle) if middle > 0 else np.zeros_like(size)
    confidence = confidence * _coherence(surface, trace, deviator) ** COHERENCE
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
