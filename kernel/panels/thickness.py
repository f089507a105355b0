"""The two faces of a panel with a thickness: spheres concentric with its own."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..spheres.rows import offset
from ..tolerances import EPSILON, NEAR_CENTER

ThicknessSide = Literal["inward", "outward", "centred"]
ThicknessRule = Literal["offset", "power"]

OUTWARD_SHARE = {"inward": 0.0, "outward": 1.0, "centred": 0.5}
"""Share of the thickness that lies on the side of N."""


@dataclass(frozen=True)
class PanelFaces:
    """
    Outer and inner faces.

    Attributes
    ----------
    outer_spheres, inner_spheres : (F, 5) float array
        Unit rows, oriented as the given ones; those themselves where one does not exist.
    thicknesses : (F,) float array
        Distance of the inner from the outer face; 0 where one does not exist.
    exists : (F,) bool array
        Whether both stay clear of the centre of the sphere.
    """

    outer_spheres: FloatArray
    inner_spheres: FloatArray
    thicknesses: FloatArray
    exists: BoolArray


def panel_faces(
    rows: FloatArray, thickness: float, side: ThicknessSide, layer: ThicknessRule
) -> PanelFaces:
    """
    Outer and inner faces of panels.

    Parameters
    ----------
    rows : (F, 5) float array
        Unit rows of the spheres of the panels.
    thickness : float
        Distance of the two faces; with constant power its mean over the curved panels.
    side : {"inward", "outward", "centred"}
        Where the thickness goes from the given spheres: against N, along N, or half each way.
    layer : {"offset", "power"}
        ``offset``: the same thickness everywhere. ``power``: the squared radii of the two faces
        differ by the same κ everywhere, so that neighbours which bulge to the same side meet
        in the same plane on both faces. The thickness is then about κ / 2r: sharp panels are
        thicker than flat ones, and planes have none.

    Returns
    -------
    PanelFaces
        The faces.

    References
    ----------
    Meshes with Spherical Faces, Lemma 4.4, for constant power.
    """
    if layer == "offset":
        share = OUTWARD_SHARE[side]
        outwards = np.full(len(rows), share * thickness)
        inwards = np.full(len(rows), (share - 1) * thickness)
    else:
        power = _common_power(rows, thickness, side) if thickness > 0 else 0.0
        outwards, inwards = _power_distances(rows, power, side)
    left = np.stack([1 - 2 * rows[:, 0] * distance for distance in (outwards, inwards)])
    exists = np.all(left > NEAR_CENTER, axis=0)
    outwards, inwards = np.where(exists, outwards, 0.0), np.where(exists, inwards, 0.0)
    return PanelFaces(offset(rows, outwards), offset(rows, inwards), outwards - inwards, exists)


def _power_distances(
    rows: FloatArray, power: float, side: ThicknessSide
) -> tuple[FloatArray, FloatArray]:
    """
    Signed distances along N of the two faces whose squared radii differ by the power.

    With ``r'² = r² + δ`` the distance is ``r' - r = δ / (r' + r)``, written in the curvature k
    so that planes get zero. Faces beyond the centre end at the centre.
    """
    curvature, share = 2 * rows[:, 0], OUTWARD_SHARE[side]
    distances: list[FloatArray] = []
    for change in (share * power, (share - 1) * power):
        square = np.maximum(1 - curvature * np.abs(curvature) * change, 0.0)
        distances.append(np.abs(curvature) * change / (1 + np.sqrt(square)))
    # A face that ends at the centre has gone the radius, no farther.
    with np.errstate(divide="ignore"):
        limit = 1 / np.abs(curvature)
    return np.minimum(distances[0], limit), np.maximum(distances[1], -limit)


def _common_power(rows: FloatArray, thickness: float, side: ThicknessSide) -> float:
    """Difference κ of squared radii that gives curved panels the thickness on average."""
    from scipy.optimize import brentq

    curved = rows[rows[:, 0] != 0]
    if len(curved) == 0:
        return 0.0

    def _excess(power: float) -> float:
        outwards, inwards = _power_distances(curved, power * thickness**2, side)
        return float((outwards - inwards).mean()) / thickness - 1

    # On the flattest sphere this power gives the thickness, on all others no less.
    flattest = 1 / (2 * float(np.abs(curved[:, 0]).min()) * thickness)
    highest = 1 + 2 * flattest
    if _excess(highest) < 0:  # too many radii are smaller than the thickness
        return highest * thickness**2
    root = brentq(_excess, 0.0, highest, xtol=EPSILON, rtol=8 * EPSILON)
    return float(root) * thickness**2
