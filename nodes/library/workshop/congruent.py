"""Panels of one shape."""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from ....kernel.panels import congruent
from ....kernel.panels.panels import Panels
from ....kernel.reports import Report
from ....kernel.tolerances import SAME_PANEL
from ...graphs.node import node
from ...graphs.ports import Port
from ..arrays import PanelLabels


@dataclass(frozen=True, eq=False)
class ShapesReport(Report):
    """Shapes of panels.

    Attributes
    ----------
    shapes : int
    panels_per_shape : list of int
    first : list of str
        Id of the first panel of each.
    largest_miss : float
        How far corners and edges of one shape lie apart, in model units.
    """

    shapes: int
    panels_per_shape: list[int]
    first: list[str]
    largest_miss: float


class IdenticalPanels(NamedTuple):
    """Panels gathered by shape."""

    labels: PanelLabels
    report: ShapesReport


@node
def identical_panels(
    panels: Panels, tolerance: Annotated[float, Port(min=0)] = SAME_PANEL
) -> IdenticalPanels:
    """Find panels that are the same up to a rigid motion and can share blanks and patterns.

    Parameters
    ----------
    panels : Panels
    tolerance : float
        How far corners and edges of one shape may lie apart, in mean edges.

    Returns
    -------
    labels : (P,) int array
        Shape of each panel, from 0. Mirror images and panels of different moulds differ.
    report : ShapesReport
        Number of shapes, and of panels of each.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, identical_panels, panels, vase_mesh
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> identical_panels(made.panels).report["panels_per_shape"]
    [12, 12, 12, 12, 12, 12]
    """
    same = congruent.congruent_panels(panels, tolerance)
    report = ShapesReport(
        shapes=len(same.representatives),
        panels_per_shape=np.bincount(same.labels).tolist(),
        first=[panels.ids[i] for i in same.representatives.tolist()],
        largest_miss=float(same.misses.max(initial=0.0)),
    )
    return IdenticalPanels(same.labels, report)
