"""What a workshop asks for it, and what fewer moulds and flat panels save."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np

from ....fabrication.costs import curve
from ....fabrication.costs.cost import CostReport, model_cost
from ....fabrication.costs.prices import Prices, parse_prices, read_prices
from ....fabrication.model import Model
from ....fabrication.units import millimeters_per
from ....kernel.analysis import angle_summary
from ....kernel.beams.beams import Beams
from ....kernel.meshes.creases import crease_edges
from ....kernel.optimization.flat_panels import flatten_shallow
from ....kernel.panels.panels import Panels
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.tolerances import ROUGHER
from ...graphs.node import node, warn
from ...graphs.ports import Length, Port, ReadPath, Units
from ..arrays import CreaseAngle, FaceMarks

AnyPrices: TypeAlias = ReadPath | dict[str, Any]
Millimeters = Annotated[float, Port(unit="mm", min=0)]

MOULD_COUNTS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64)


@node
def cost(
    panels: Panels | None = None,
    beams: Beams | None = None,
    prices: AnyPrices = "prices.toml",
    units: Units = "m",
) -> CostReport:
    """Price panels, their moulds and blanks, beams and nodes.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    beams : Beams, optional
    prices : path or dict
        A price file in TOML, or its tables: moulds by radius and size, blanks and panels by
        area, beams by mass and cut, nodes by piece.
    units : str

    Returns
    -------
    CostReport
        The total, its parts, what was counted, and every mould.

    Examples
    --------
    >>> from spheremesh.nodes import cost, fit_spheres, panels, vase_mesh
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02).panels
    >>> found = cost(made, prices={"moulds": {"each": 500.0}, "panels": {"each": 10.0}})
    >>> found["parts"]["moulds"], found["parts"]["panels"], found["total"]
    (3000.0, 720.0, 3720.0)
    """
    found = model_cost(Model(panels, beams, units), _known(prices))
    if found.unpriced:
        warn(f"no price for {', '.join(found.unpriced)}: the total is without them")
    return found


def _known(prices: AnyPrices) -> Prices:
    return parse_prices(prices) if isinstance(prices, Mapping) else read_prices(prices)


@dataclass(frozen=True, eq=False)
class FlatReport(Report):
    """Panels that became planes.

    Attributes
    ----------
    count : int
    angles_deg, curved_angles_deg : dict
        ``mean`` and ``max`` with them, and before.
    """

    count: int
    angles_deg: dict[str, float]
    curved_angles_deg: dict[str, float]


class Flattened(NamedTuple):
    """A sphere mesh with more planes."""

    sphere_mesh: SphereMesh
    is_flattened: FaceMarks
    report: FlatReport


@node
def flat_panels(
    sphere_mesh: SphereMesh,
    flat_below: Millimeters = 2.0,
    units: Units = "m",
    crease: CreaseAngle = 40.0,
) -> Flattened:
    """Make panels planes that bulge less than the eye can tell: they need no mould.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    flat_below : float
        Panels that rise by less over the circles of their faces become planes.
    units : str
    crease : float
        Edges at which the flat faces turn by more do not count; 180 for no creases.

    Returns
    -------
    sphere_mesh : SphereMesh
        The same mesh; `cluster_radii` gives its planes a mould of their own, a flat one.
    is_flattened : (F,) bool array
        Faces whose spheres became planes.
    report : FlatReport
        How many, and what it costs in smoothness.

    Examples
    --------
    >>> from spheremesh.nodes import flat_panels, minimize_angles, fit_spheres, roof_mesh
    >>> spheres = minimize_angles(fit_spheres(roof_mesh(6, 8))).sphere_mesh
    >>> flat_panels(spheres, flat_below=20.0).report["count"]
    1
    """
    flattened, is_flattened = flatten_shallow(sphere_mesh, flat_below / millimeters_per(units))
    is_smooth = ~crease_edges(sphere_mesh.mesh, np.radians(crease))
    report = FlatReport(
        count=int(is_flattened.sum()),
        angles_deg=angle_summary(flattened, is_smooth),
        curved_angles_deg=angle_summary(sphere_mesh, is_smooth),
    )
    after, before = report.angles_deg["mean"], report.curved_angles_deg["mean"]
    if after > before * (1 + ROUGHER):
        warn(
            f"{report.count} flat panels make neighbours meet at {after:.3g} degrees in the "
            f"mean instead of {before:.3g}: a bound below {flat_below:g} mm keeps them smoother"
        )
    return Flattened(flattened, is_flattened, report)


@dataclass(frozen=True, eq=False)
class CurveReport(Report):
    """Cost and smoothness over the number of moulds.

    Attributes
    ----------
    currency : str
    rows : list of dict
        By the number of ``moulds``: ``mean_deg`` and ``max_deg``, ``total`` and its ``parts``,
        ``flat_panels``, ``rejected``; the last with a radius per panel.
    flat_rows : list of dict
        The same where shallow panels are flat, with what is ``saved`` against as many moulds
        without; empty if none are to be.
    """

    currency: str
    rows: list[dict[str, Any]]
    flat_rows: list[dict[str, Any]]


@node
def cost_curve(  # noqa: PLR0913, PLR0917 - a node has an input per choice
    sphere_mesh: SphereMesh,
    prices: AnyPrices,
    counts: tuple[int, ...] = MOULD_COUNTS,
    flat_below: Millimeters = 0.0,
    thickness: Length = 0.0,
    joint_gap: Length = 0.0,
    beams: Beams | None = None,
    same_sagitta: Millimeters = 0.1,
    units: Units = "m",
    crease: CreaseAngle = 40.0,
) -> CurveReport:
    """Find cost and smoothness over the number of moulds, vertices fixed.

    Panels are cut upright and priced for every number; the moulds are the best of that number.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    prices : path or dict
        As `cost` takes them.
    counts : tuple of int
        Numbers of moulds that curve; a radius per panel comes last in any case.
    flat_below : float
        Once more with panels flat that bulge by less; 0 for no such rows.
    thickness, joint_gap : float
        Of the panels, in model units.
    beams : Beams, optional
        They cost the same with any moulds.
    same_sagitta : float
        Moulds that differ by less over the largest blank are one, as in `cluster_radii`.
    units : str
    crease : float
        Edges at which the flat faces turn by more do not count; 180 for no creases.

    Returns
    -------
    CurveReport
        Rows by the number of moulds.

    Examples
    --------
    >>> from spheremesh.nodes import cost_curve, fit_spheres, minimize_angles, vase_mesh
    >>> spheres = minimize_angles(fit_spheres(vase_mesh(12, 6))).sphere_mesh
    >>> curve = cost_curve(spheres, {"moulds": {"each": 500.0}}, counts=(1, 3))
    >>> [(row["moulds"], row["total"]) for row in curve["rows"]]
    [(1, 500.0), (3, 1500.0), (6, 3000.0)]
    """
    known = _known(prices)
    options = curve.CurveOptions(
        thickness, joint_gap, units, same_sagitta / millimeters_per(units),
        ~crease_edges(sphere_mesh.mesh, np.radians(crease)), beams,
    )  # fmt: skip
    rows = curve.mould_curve(sphere_mesh, known, counts, options)
    flat_rows = (
        curve.flat_curve(sphere_mesh, known, rows, options, flat_below) if flat_below else []
    )
    return CurveReport(known.currency, rows, flat_rows)
