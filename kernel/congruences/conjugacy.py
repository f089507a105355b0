"""How far parametrisations and nets are from conjugate (Def. 2.2)."""

import numpy as np

from ..arrays import FloatArray, norm
from ..tolerances import EPSILON


def conjugacy_residuals(
    along_u: FloatArray, along_v: FloatArray, mixed: FloatArray, lift: FloatArray | None = None
) -> FloatArray:
    """How far a parametrisation or a net is from conjugate: distance of f_uv from a span.

    Derivatives are (..., n); of a net the differences along the two sides of a face, and the
    difference of the differences. The lift (..., n) is the map itself where it is projective,
    for example rows of spheres, of any scale. Distance (...) of f_uv from ``[f_u, f_v]``, or
    from ``[f, f_u, f_v]`` with a lift; in the unit of f_uv. Zero means conjugate, in every
    coordinate system; other values depend on the parametrisation, and with a lift on its scale
    and coordinates. NaN where a number is not finite.

    References
    ----------
    Meshes with Spherical Faces, Def. 2.2 and below.
    """
    given = [mixed, along_u, along_v] if lift is None else [mixed, lift, along_u, along_v]
    table = np.stack(np.broadcast_arrays(*given))
    is_finite = np.asarray(np.isfinite(table).all(axis=(0, -1)))
    mixed, *vectors = np.where(is_finite[..., None], table, 0.0)
    lengths = [norm(vector)[..., None] for vector in vectors]
    scaled = [
        v / np.where(size > 0, size, 1.0) for v, size in zip(vectors, lengths, strict=True)
    ]
    frames, values, _ = np.linalg.svd(np.stack(scaled, -1), full_matrices=False)
    used = values > 8 * EPSILON * values[..., :1]
    shares = np.where(used, np.einsum("...ij,...i->...j", frames, mixed), 0.0)
    distances = norm(mixed - np.einsum("...ij,...j->...i", frames, shares))
    return np.where(is_finite, distances, np.nan)
