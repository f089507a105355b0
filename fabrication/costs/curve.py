"""Cost and smoothness over the number of moulds; vertices stay."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ...kernel.analysis import angle_summary
from ...kernel.arrays import BoolArray
from ...kernel.beams.beams import Beams
from ...kernel.errors import InputError
from ...kernel.optimization.flat_panels import flatten_shallow
from ...kernel.optimization.radius_clustering import each_clustering
from ...kernel.panels.cutting import cut_panels
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..model import Model
from ..units import millimeters_per
from .cost import model_cost
from .prices import Prices


@dataclass(frozen=True)
class CurveOptions:
    """What the panels of a curve have in common; lengths in model units.

    Attributes
    ----------
    same_sagitta : float
        Moulds that differ by less are one, as in `cluster_radii`.
    is_smooth : (E,) bool array
        Edges whose angles count.
    beams : Beams or None
        Cost the same with any moulds.
    """

    thickness: float
    joint_gap: float
    units: str
    same_sagitta: float
    is_smooth: BoolArray
    beams: Beams | None = None


class _Spheres(NamedTuple):
    sphere_mesh: SphereMesh
    labels: Any
    moulds: int


def mould_curve(
    sphere_mesh: SphereMesh, prices: Prices, counts: Sequence[int], options: CurveOptions
) -> list[dict[str, Any]]:
    """Rows of cost and angles, with so many moulds each, and with a radius per panel.

    Parameters
    ----------
    counts : sequence of int
        Numbers of curved moulds; those that cannot be told apart give no row.

    Returns
    -------
    list of dict
        ``moulds`` (that are made), ``mean_deg`` and ``max_deg``, ``total``, its ``parts``,
        ``flat_panels``, and ``rejected``: panels that cannot be made.

    Raises
    ------
    InputError
        If a number is below 1, or prices do not fit.
    """
    if not counts or min(counts) < 1:
        raise InputError("numbers of moulds must be given, of at least 1")
    wanted, found = set(counts), list[_Spheres]()
    # One mould for all would bend panels that are flat; their own costs nothing.
    has_flat = bool((sphere_mesh.local_spheres[:, 0] == 0).any())
    walk = each_clustering(sphere_mesh, options.same_sagitta)
    for spheres, clusters in islice(walk, int(has_flat), None):
        curved = int(np.isfinite(clusters.radii).sum())
        if curved in wanted and (not found or curved > found[-1].moulds):
            found.append(_Spheres(spheres, clusters.labels, curved))
        if curved >= max(wanted):
            break
    found.append(_Spheres(sphere_mesh, None, 0))
    return [_row(each, prices, options) for each in found]


def _row(found: _Spheres, prices: Prices, options: CurveOptions) -> dict[str, Any]:
    panels, rejected = cut_panels(
        found.sphere_mesh, "bisector", options.thickness, options.joint_gap, found.labels
    )
    cost = model_cost(Model(panels, options.beams, options.units), prices)
    angles = angle_summary(found.sphere_mesh, options.is_smooth)
    return {
        "moulds": int(cost.quantities["moulds"]),
        "mean_deg": angles["mean"],
        "max_deg": angles["max"],
        "total": cost.total,
        "parts": cost.parts,
        "flat_panels": int(cost.quantities["flat_panels"]),
        "rejected": len(rejected),
    }


def flat_curve(
    sphere_mesh: SphereMesh, prices: Prices, rows: Sequence[dict[str, Any]],
    options: CurveOptions, flat_below: float,
) -> list[dict[str, Any]]:  # fmt: skip
    """The rows of a `mould_curve` once more, with shallow panels flat.

    Panels that bulge by less than `flat_below` millimetres become planes. What each row
    ``saved`` against that of the same number of moulds is there as well, None where there is no
    such row; the last is a radius per panel on both sides.
    """
    sagitta = flat_below / millimeters_per(options.units)
    flattened, _ = flatten_shallow(sphere_mesh, sagitta)
    counts = [row["moulds"] for row in rows[:-1] if row["moulds"]] or [1]
    totals = {row["moulds"]: row["total"] for row in rows[:-1]}
    found = mould_curve(flattened, prices, counts, options)
    for row in found[:-1]:
        total = totals.get(row["moulds"])
        row["saved"] = None if total is None else total - row["total"]
    found[-1]["saved"] = rows[-1]["total"] - found[-1]["total"]
    return found
