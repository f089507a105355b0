"""Reports of panels and of the blanks of their moulds."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..reports import Report
from .mould_blanks import MouldBlanks


@dataclass(frozen=True, eq=False)
class CutReport(Report):
    """The panels that can be made, and the others.

    Attributes
    ----------
    edge_gap : dict
        Between the arcs of neighbouring panels, at the ends and in the middle, before the
        joint: ``max`` and ``mean`` in model units, ``relative_to_edge``, over so many
        ``edges``.
    thickness : dict
        ``min``, ``mean`` and ``max``.
    written : int
    rejected : list of dict
        ``id``, ``code`` and ``reason`` of each panel that cannot be made.
    """

    edge_gap: dict[str, float]
    thickness: dict[str, float]
    written: int
    rejected: list[dict[str, str]]


@dataclass(frozen=True, eq=False)
class BlanksReport(Report):
    """Blanks that the moulds must give, lengths in model units.

    Attributes
    ----------
    blanks : list of dict
        ``mould`` (from 1), ``radius`` (None for a flat mould), ``diameter`` (of the rim, as a
        chord), ``sagitta``, ``opening_deg``, ``count`` and ``shapes`` (different panels among
        them).
    without_mould : int
        Panels that belong to none.
    """

    blanks: list[dict[str, Any]]
    without_mould: int


def blanks_report(found: MouldBlanks, without_mould: int) -> BlanksReport:
    """The report of blanks.

    Parameters
    ----------
    found : MouldBlanks
    without_mould : int
        Panels that belong to no mould.

    Returns
    -------
    BlanksReport
        A row for each size of each mould.
    """
    rows = [
        {
            "mould": int(found.labels[i]) + 1,
            "radius": float(found.radii[i]) if np.isfinite(found.radii[i]) else None,
            "diameter": float(found.diameters[i]),
            "sagitta": float(found.sagittas[i]),
            "opening_deg": float(np.degrees(found.openings[i])),
            "count": int(found.counts[i]),
            "shapes": int(found.shapes[i]),
        }
        for i in range(len(found.labels))
    ]
    return BlanksReport(rows, without_mould)
