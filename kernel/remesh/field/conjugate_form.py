"""Conjugate directions of a sphere congruence: where two neighbouring spheres of a net meet.

Spheres are points of projective four-space, a congruence is a surface there, and a surface in
four-space has at most one conjugate net. Its directions are the roots of one quadratic form.
"""

import numpy as np

from ...arrays import BoolArray, ComplexArray, FloatArray, norm
from ...errors import InputError
from ...tolerances import EPSILON, UNDETERMINED
from .jets import CongruenceJets


class UndeterminedError(InputError):
    """Spheres for which every direction is conjugate to some other."""


def conjugate_form(jets: CongruenceJets) -> FloatArray:
    """The quadratic form whose roots are the conjugate directions.

    Coefficients (..., 3) of ``du²``, ``du dv`` and ``dv²``: with
    ``[x, y] = det(S, S_u, S_v, x, y)`` they are ``[S_uu, S_uv]``, ``[S_uu, S_vv]`` and
    ``[S_uv, S_vv]``.

    Notes
    -----
    A direction (a, b) is conjugate to (c, d) if ``a c S_uu + (a d + b c) S_uv + b d S_vv`` lies
    in ``span(S, S_u, S_v)``. In the two-dimensional quotient these are two equations in the
    symmetric products; their common solution is the pair of roots. A linear map of the five
    coordinates, such as a Möbius map, multiplies the form by its determinant, a rescaling of
    the rows by the fifth power of the factor: the form is a field over the surface, sign
    included, and needs no combing.

    References
    ----------
    Meshes with Spherical Faces, eq. (12), with both second fundamental forms in one
    parametrisation and without a chart.
    """
    base = [jets.rows, jets.rows_u, jets.rows_v]
    pairs = [
        (jets.rows_uu, jets.rows_uv), (jets.rows_uu, jets.rows_vv), (jets.rows_uv, jets.rows_vv)
    ]  # fmt: skip
    return np.stack([np.linalg.det(np.stack([*base, *pair], -2)) for pair in pairs], -1)


def split_form(form: FloatArray) -> tuple[FloatArray, ComplexArray]:
    """Trace and deviator of quadratic forms (..., 3), by ``x²``, ``x y``, ``y²`` (orthonormal).

    The trace is the mean h of the form over all directions, the deviator ``z = m exp(2 i θ)``:
    in the direction φ the form is ``h + m cos(2 φ - 2 θ)``.
    """
    trace = (form[..., 0] + form[..., 2]) / 2
    return trace, (form[..., 0] - form[..., 2]) / 2 + 0.5j * form[..., 1]


def conjugate_field(jets: CongruenceJets) -> tuple[FloatArray, ComplexArray]:
    """The forms whose roots are the conjugate directions, in trace and deviator.

    For every vertex, (V,); deviators in the coordinates of `vertex_frames`.

    Raises
    ------
    UndeterminedError
        If the form vanishes everywhere: then every direction is conjugate to some other.
    """
    form = conjugate_form(jets)
    parts = [jets.rows, jets.rows_u, jets.rows_v, jets.rows_uu + jets.rows_vv, jets.rows_uv]
    bound = np.prod([norm(part) for part in parts], axis=0)
    if not (norm(form) > UNDETERMINED * bound).any():
        raise UndeterminedError(
            "the spheres do not determine conjugate directions: they are planes, or touch a "
            "sphere, or are all orthogonal to one; use spheres of other radii"
        )
    return split_form(form)


def anisotropy(jets: CongruenceJets) -> FloatArray:
    """How much the second derivatives of spheres vary with the direction.

    Relative to their mean, both up to the spheres and their first derivatives, in orthonormal
    parameters. Where it is zero, as for spheres that touch a sphere, all pairs of orthogonal
    directions are conjugate.
    """
    tangents = np.stack([jets.rows, jets.rows_u, jets.rows_v], -1)
    normals = np.linalg.qr(tangents, mode="complete")[0][..., 3:]
    seconds = [jets.rows_uu + jets.rows_vv, jets.rows_uu - jets.rows_vv, 2 * jets.rows_uv]
    mean, straight, oblique = (
        norm(np.einsum("...i,...ij->...j", second, normals)) for second in seconds
    )
    varies = np.hypot(straight, oblique)
    return np.divide(varies, mean, out=np.full_like(mean, np.inf), where=mean > 0)


def form_roots(
    trace: FloatArray, deviator: ComplexArray, least_angle: float = 0.0
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """The two directions in which quadratic forms vanish.

    Parameters
    ----------
    trace : (...) float array
        Means of the forms.
    deviator : (...) complex array
    least_angle : float
        Roots that meet at less, or are complex, are moved apart to this angle (radians).

    Returns
    -------
    first, second : (...) float array
        Angles ``θ ∓ acos(-h / m) / 2``; from the first to the second is a turn between 0 and π.
    is_real : (...) bool array
        Whether the roots are real and different, ``|h| < m``, and meet at the least angle or
        more. False: the angles are those of the nearest form whose roots do.
    """
    size = np.abs(deviator)
    ratio = np.divide(-trace, size, out=np.zeros_like(size), where=size > 0)
    bound = np.cos(least_angle)
    is_real = (np.abs(trace) < bound * size) & (size > EPSILON * np.abs(trace))
    half = np.arccos(np.clip(ratio, -bound, bound)) / 2
    middle = np.angle(deviator) / 2
    return middle - half, middle + half, is_real
