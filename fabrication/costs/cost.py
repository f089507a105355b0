"""The cost of panels, their moulds and blanks, of beams and nodes."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.beams.beams import Beams, beam_volumes
from ...kernel.errors import InputError
from ...kernel.panels.facts import bounding_sizes
from ...kernel.panels.mould_blanks import PanelCaps, panel_caps
from ...kernel.panels.panels import Panels, panel_areas
from ...kernel.reports import Report
from ...kernel.tolerances import SAME_CURVATURE
from ..model import Model
from ..tables import finite_or_none
from ..units import millimeters_per
from .prices import MouldPrice, Prices, SheetPrice

_METER = 1000.0


@dataclass(frozen=True, eq=False)
class CostReport(Report):
    """What a model costs.

    Attributes
    ----------
    currency : str
    total : float
        Of all that is priced.
    per_m2 : float or None
        The total by the area of the panels; None without panels.
    parts : dict
        ``moulds``, ``blanks``, ``panels``, ``beams`` and ``nodes``; 0 where there is no price.
    quantities : dict
        What was counted: ``moulds``, ``panels``, ``flat_panels``, ``curved_blank_m2``,
        ``flat_blank_m2``, ``curved_panel_m2``, ``flat_panel_m2``, ``beams``, ``beam_kg`` (0
        without a density), ``cuts`` and ``nodes``.
    moulds : list of dict
        ``mould`` (from 1), ``radius_mm``, ``diameter_mm`` (of the largest blank), ``panels``
        and ``cost`` of each curved mould.
    unpriced : list of str
        Parts that the model has and the prices do not; blanks may be in the price of panels.
    """

    currency: str
    total: float
    per_m2: float | None
    parts: dict[str, float]
    quantities: dict[str, float]
    moulds: list[dict[str, Any]]
    unpriced: list[str]


def model_cost(model: Model, prices: Prices) -> CostReport:
    """Add up the cost of a model.

    Notes
    -----
    Moulds cost once each, by their radius and their largest blank; flat ones cost nothing.
    Panels without a mould number share a mould where their radii are the same. The blank of a
    curved panel is the smallest cap of its mould that holds it, that of a flat one a rectangle.
    A beam has two cuts; a node is wherever beams end.

    Raises InputError if there is nothing to price, the units are unknown, or no price fits a
    mould.
    """
    panels, beams = model.panels, model.beams
    if panels is None and beams is None:
        raise InputError("there are no panels or beams to price")
    meter = millimeters_per(model.units) / _METER
    parts: dict[str, float] = {"moulds": 0, "blanks": 0, "panels": 0, "beams": 0, "nodes": 0}
    quantities: dict[str, float] = {}
    rows: list[dict[str, Any]] = []
    if panels is not None:
        caps = panel_caps(panels)
        rows = _mould_rows(panels, caps, prices, meter)
        _add_panels(panels, caps, prices, meter, parts, quantities)
        parts["moulds"] = float(sum(row["cost"] for row in rows))
        quantities["moulds"] = len(rows)
    if beams is not None:
        _add_beams(beams, prices, meter, parts, quantities)
    total = float(sum(parts.values()))
    area = quantities.get("curved_panel_m2", 0.0) + quantities.get("flat_panel_m2", 0.0)
    priced = {
        "moulds": prices.moulds, "panels": prices.panels, "beams": prices.beams,
        "nodes": prices.node,
    }  # fmt: skip
    return CostReport(
        currency=prices.currency,
        total=total,
        per_m2=total / area if area else None,
        parts=parts,
        quantities=quantities,
        moulds=rows,
        unpriced=[
            name
            for name, price in priced.items()
            if quantities.get(name) and price in (None, ())
        ],
    )


class _Moulds(NamedTuple):
    """Curved moulds: number from 1, curvature, radius of the largest rim, number of panels."""

    numbers: IntArray
    curvatures: FloatArray
    rims: FloatArray
    counts: IntArray


def _add_panels(
    panels: Panels, caps: PanelCaps, prices: Prices, meter: float, parts: dict[str, float],
    quantities: dict[str, float],
) -> None:  # fmt: skip
    """Blanks and panels themselves."""
    is_flat, sizes = panels.design_spheres[:, 0] == 0, bounding_sizes(panels)
    blanks = np.where(is_flat, sizes[:, 0] * sizes[:, 1], _cap_areas(caps.radii, caps.sagittas))
    flat_count = int(is_flat.sum())
    quantities |= {"panels": panels.n_panels, "flat_panels": flat_count}
    for name, areas in (("blank", blanks), ("panel", panel_areas(panels))):
        price = prices.blanks if name == "blank" else prices.panels
        curved = float(areas[~is_flat].sum()) * meter**2
        flat = float(areas[is_flat].sum()) * meter**2
        quantities[f"curved_{name}_m2"], quantities[f"flat_{name}_m2"] = curved, flat
        parts[f"{name}s"] = _sheet_cost(price, panels.n_panels, curved, flat)


def _sheet_cost(price: SheetPrice | None, count: int, curved: float, flat: float) -> float:
    if price is None:
        return 0.0
    return price.each * count + price.per_m2 * curved + price.flat_per_m2 * flat


def _add_beams(
    beams: Beams, prices: Prices, meter: float, parts: dict[str, float],
    quantities: dict[str, float],
) -> None:  # fmt: skip
    """Beams and the nodes at which they end."""
    price = prices.beams
    mass = float(beam_volumes(beams).sum()) * meter**3 * (price.density if price else 0.0)
    count, nodes = beams.n_beams, len(np.unique(beams.annuli.edge_vertices))
    quantities |= {"beams": count, "beam_kg": mass, "cuts": 2 * count, "nodes": nodes}
    if price is not None:
        parts["beams"] = price.each * count + price.per_kg * mass + price.per_cut * 2 * count
    parts["nodes"] = (prices.node or 0.0) * nodes


def _mould_rows(
    panels: Panels, caps: PanelCaps, prices: Prices, meter: float
) -> list[dict[str, Any]]:
    """What each curved mould is, and costs."""
    moulds = _curved_moulds(panels, caps)
    # A sphere is never smaller than the circle of its cap, but for rounding.
    sines = np.minimum(moulds.curvatures * moulds.rims, 1.0)
    sagittas = moulds.curvatures * moulds.rims**2 / (1 + np.sqrt(1 - sines**2))
    areas = _cap_areas(moulds.rims, sagittas) * meter**2
    radii, diameters = meter / moulds.curvatures, 2 * meter * moulds.rims
    rows: list[dict[str, Any]] = []
    for i, number in enumerate(moulds.numbers.tolist()):
        price = _mould_price(prices, number, float(radii[i]), float(diameters[i]))
        rows.append(
            {
                "mould": number,
                "radius_mm": finite_or_none(radii[i] * _METER),
                "diameter_mm": float(diameters[i]) * _METER,
                "panels": int(moulds.counts[i]),
                "cost": price.each + price.per_m2 * float(areas[i]),
            }
        )
    return rows


def _curved_moulds(panels: Panels, caps: PanelCaps) -> _Moulds:
    """Moulds by their numbers; panels without one share one if their radii are the same."""
    curvatures = 2 * np.abs(panels.design_spheres[:, 0])
    members = np.flatnonzero(curvatures > 0)
    curvatures, rims = curvatures[members], caps.radii[members]
    numbers = panels.labels[members] + 1
    free = np.flatnonzero(numbers == 0)
    order = free[np.argsort(-curvatures[free])]
    if len(order):
        gaps = -np.diff(curvatures[order]) > SAME_CURVATURE * curvatures[order[0]]
        groups = np.concatenate([np.ones(1, np.int64), 1 + np.cumsum(gaps, dtype=np.int64)])
        numbers[order] = panels.labels.max(initial=-1) + 1 + groups
    kinds, which = np.unique(numbers, return_inverse=True)
    sharpest, largest = np.zeros(len(kinds)), np.zeros(len(kinds))
    np.maximum.at(sharpest, which, curvatures)
    np.maximum.at(largest, which, rims)
    return _Moulds(kinds, sharpest, largest, np.bincount(which, minlength=len(kinds)))


def _mould_price(prices: Prices, number: int, radius: float, diameter: float) -> MouldPrice:
    """The first price that a mould fits; nothing where moulds are not priced."""
    if not prices.moulds:
        return MouldPrice()
    room = 1 + SAME_CURVATURE  # a bound is met up to rounding
    for price in prices.moulds:
        if radius * room >= price.min_radius and diameter <= price.max_diameter * room:
            return price
    raise InputError(
        f"{prices.source}: no price for mould {number}, of a radius of {radius:.4g} m and "
        f"blanks of {diameter:.4g} m: add [[moulds]] without bounds at the end"
    )


def _cap_areas(rims: FloatArray, sagittas: FloatArray) -> FloatArray:
    """Areas of spherical caps by the radii of their rims and their heights."""
    return np.pi * (rims**2 + sagittas**2)
