"""Writes panels and beams as exact Breps in JSON."""

from typing import Any

import numpy as np

from ...kernel.beams.beams import Beams
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.panels.checks import NO_PANEL
from ...kernel.panels.panels import Panels
from ...kernel.parts.records import RejectedPart, reject_parts
from ..opennurbs.brep_audit import verify_breps
from ..rhino_models.solids import beam_streams, cylinder_streams, panel_streams
from .fields import Fields, object_fields


def panel_breps(panels: Panels) -> tuple[list[Fields], tuple[RejectedPart, ...]]:
    """Panels as exact Breps, the bytes that .3dm files hold: faces, or solids of a thickness.

    Parameters
    ----------
    panels : Panels

    Returns
    -------
    breps : list of dict
        A Brep for each panel that is exact, in their order.
    rejected : tuple of RejectedPart
        The others, with their reasons.
    """
    streams = panel_streams(panels)
    errors = verify_breps(streams, panels.spheres, panels.origins)
    broken = {i: reason for i, each in enumerate(errors) if (reason := each.reason())}
    _, rejected = reject_parts(panels, broken, NO_PANEL)
    breps = [object_fields(stream) for i, stream in enumerate(streams) if i not in broken]
    return breps, rejected


def beam_solids(beams: Beams) -> list[Fields]:
    """Beams as exact solids, and node cylinders if there are any.

    Parameters
    ----------
    beams : Beams

    Returns
    -------
    list of dict
        Beams in their order, then cylinders.
    """
    streams = [*beam_streams(beams), *cylinder_streams(node_cylinders(beams))]
    return [object_fields(stream) for stream in streams]


def axis_lines(axes: Any) -> list[Fields]:  # noqa: ANN401
    """Lines between two points each in JSON; those that are not finite are left out.

    Parameters
    ----------
    axes : (n, 2, 3) float array

    Returns
    -------
    list of dict
        With ``From`` and ``To``.
    """
    finite = axes[np.isfinite(axes).all(axis=(1, 2))]
    names = ("X", "Y", "Z")
    return [
        {"From": dict(zip(names, a, strict=True)), "To": dict(zip(names, b, strict=True))}
        for a, b in finite.tolist()
    ]
