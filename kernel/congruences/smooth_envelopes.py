"""The two envelopes of a smooth sphere congruence, from its first derivatives (Sec. 2.2.1)."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, dot
from ..tolerances import EPSILON


@dataclass(frozen=True)
class SphereJet:
    """A smooth sphere congruence to first order, at any number of parameters (u, v).

    Attributes
    ----------
    centers : (..., 3) float array
        Centres c.
    radii : (...) float array
        Radii r.
    centers_u, centers_v : (..., 3) float array
        Derivatives of the centres; independent where the congruence is regular.
    radii_u, radii_v : (...) float array
        Derivatives of the radii.
    """

    centers: FloatArray
    radii: FloatArray
    centers_u: FloatArray
    centers_v: FloatArray
    radii_u: FloatArray
    radii_v: FloatArray


def has_real_envelopes(jet: SphereJet) -> BoolArray:
    """Whether a congruence has two real envelopes.

    ``|c_u|² |c_v|² - <c_u, c_v>² > |r_u c_v - r_v c_u|²``: the gradient of r on the surface of
    the centres is shorter than 1. False where the congruence is not regular.

    References
    ----------
    Meshes with Spherical Faces, Lemma 2.1.
    """
    area, change = _area_and_change(jet)
    return dot(area, area) > dot(change, change)


def envelope_points(jet: SphereJet) -> tuple[FloatArray, FloatArray]:
    """Points (..., 3) in which the spheres of a congruence touch its two envelopes.

    ``f± = c - r grad r ± r sqrt(1 - |grad r|²) N`` with N along ``c_u × c_v``: mirror images in
    the tangent plane of the surface of the centres. NaN where they are not real or the
    congruence is not regular; equal where ``|grad r| = 1`` up to rounding.

    Notes
    -----
    The common points of the sphere and the planes ``<x - c, c_u> + r r_u = 0`` and
    ``<x - c, c_v> + r r_v = 0``.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.2.1.
    """
    area, change = _area_and_change(jet)
    square, slope = dot(area, area), dot(change, change)
    slack = square - slope
    slack = np.where(np.abs(slack) <= 16 * EPSILON * (square + slope), 0.0, slack)
    with np.errstate(divide="ignore", invalid="ignore"):
        gradient = np.cross(change, area) / square[..., None]
        height = (np.sqrt(slack) / square)[..., None] * area
    radii = jet.radii[..., None]
    foot = jet.centers - radii * gradient
    return foot + radii * height, foot - radii * height


def _area_and_change(jet: SphereJet) -> tuple[FloatArray, FloatArray]:
    """``c_u × c_v`` and ``r_u c_v - r_v c_u``; the square of their ratio is that of grad r."""
    area = np.cross(jet.centers_u, jet.centers_v)
    change = jet.radii_u[..., None] * jet.centers_v - jet.radii_v[..., None] * jet.centers_u
    return area, change
