"""Checks of panels: numbered findings, errors apart from notes."""

from typing import Final, TypeAlias

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.panels.congruent import CongruentPanels, congruent_panels
from ...kernel.panels.facts import PanelFacts, panel_facts
from ...kernel.panels.panels import Panels, neighbor_ids, scale_panels
from ...kernel.parts.findings import Finding
from ...kernel.tolerances import CAP_ANGLE
from ..measures import measured_once
from ..units import millimeters_per
from .subjects import USUAL_LIMITS, AuditLimits, Subject

PanelSubject: TypeAlias = Subject[Panels, PanelFacts]


def panel_subject(
    panels: Panels, units: str = "m", limits: AuditLimits = USUAL_LIMITS
) -> PanelSubject:
    """Panels in millimetres, measured: what `check_panels` looks at."""
    made, facts = measured_once(panels, units, lambda: _measure(panels, units))
    return PanelSubject(made, facts, limits)


def _measure(panels: Panels, units: str) -> tuple[Panels, PanelFacts]:
    made = scale_panels(panels, millimeters_per(units))
    return made, panel_facts(made)


def same_shapes(panels: Panels) -> CongruentPanels:
    """Which panels are identical, found once for all who ask."""
    return measured_once(panels, "same", lambda: congruent_panels(panels))


def check_panels(subject: PanelSubject) -> list[Finding]:
    """Run every panel check: the findings P101 to P204, see `audit_model`.

    The subject has at least one panel, with finite numbers.
    """
    return [finding for check in PANEL_CHECKS for finding in check(subject)]


def _caps(subject: PanelSubject) -> list[Finding]:
    half = np.degrees(subject.facts.caps.openings / 2)
    limit = float(np.degrees(CAP_ANGLE))
    message = "reaches {0:.4g} degrees from its middle, beyond 80: split it"
    return subject.found("P101", half, half > limit, message, severity="error")


def _corners(subject: PanelSubject) -> list[Finding]:
    angles, limit = np.degrees(subject.facts.corner_angles), subject.limits.corner_deg
    sharpest = _least(subject, angles)
    message = f"a corner of {{0:.4g}} degrees, sharper than {limit:g}"
    return subject.found("P102", sharpest, sharpest < limit, message)


def _edges(subject: PanelSubject) -> list[Finding]:
    shortest, limit = _least(subject, subject.facts.edge_lengths), subject.limits.edge_mm
    message = f"an edge of {{0:.4g}} mm, shorter than {limit:g}"
    return subject.found("P103", shortest, shortest < limit, message)


def _thickness(subject: PanelSubject) -> list[Finding]:
    facts, panels = subject.facts, subject.parts
    smallest = np.minimum(facts.outer_radii, facts.inner_radii)
    share, limit = panels.thicknesses / smallest, subject.limits.thickness_share
    message = f"its thickness is {{0:.3g}} of its smallest radius, more than {limit:g}"
    return subject.found("P104", share, share > limit, message)


def _walls(subject: PanelSubject) -> list[Finding]:
    tilts, limit = np.degrees(subject.facts.wall_tilts), subject.limits.wall_tilt_deg
    steepest = -_least(subject, -tilts)
    message = f"a wall leans by {{0:.3g}} degrees, more than {limit:g}"
    return subject.found("P105", steepest, steepest > limit, message)


def _other_thickness(subject: PanelSubject) -> list[Finding]:
    panels = subject.parts
    change = np.abs(panels.thicknesses - panels.thickness)
    message = f"its thickness is {{0:.4g}} mm, not {panels.thickness:.4g}"
    other = change > subject.limits.thickness_change * panels.thickness
    return subject.found("P106", panels.thicknesses, other, message)


def _blanks(subject: PanelSubject) -> list[Finding]:
    diameters, limit = 2 * subject.facts.caps.radii, subject.limits.blank_mm
    message = f"needs a blank of {{0:.5g}} mm, larger than {limit:g}"
    return subject.found("P107", diameters, diameters > limit, message)


def _steps(subject: PanelSubject) -> list[Finding]:
    steps, limit = np.nan_to_num(subject.facts.steps), subject.limits.step_mm
    highest = -_least(subject, -steps)
    message = f"a step of {{0:.3g}} mm to a neighbour, more than {limit:g}"
    return subject.found("P201", highest, highest > limit, message, "error")


def _gaps(subject: PanelSubject) -> list[Finding]:
    gaps, limit = np.nan_to_num(subject.facts.gaps), subject.limits.gap_mm
    widest = -_least(subject, -gaps)
    message = f"a joint opens by {{0:.3g}} mm more than asked for, more than {limit:g}"
    return subject.found("P203", widest, widest > limit, message, "error")


def _holes(subject: PanelSubject) -> list[Finding]:
    holes, limit = subject.facts.holes, subject.limits.gap_mm
    widest = -_least(subject, -holes)
    message = f"a hole of {{0:.3g}} mm at a node, more than {limit:g}"
    return subject.found("P204", widest, widest > limit, message, "error")


def _missing_neighbors(subject: PanelSubject) -> list[Finding]:
    panels = subject.parts
    names = neighbor_ids(panels)
    missing = np.array([name is None for name in names]) & (panels.neighbors >= 0)
    counts: IntArray = np.add.reduceat(missing.astype(np.int64), panels.offsets[:-1])
    message = "neighbours are missing, {0:.0f} of them"
    return subject.found("P202", counts.astype(np.float64), counts > 0, message)


PANEL_CHECKS: Final = (
    _caps, _corners, _edges, _thickness, _walls, _other_thickness, _blanks, _steps,
    _missing_neighbors, _gaps, _holes,
)  # fmt: skip


def _least(subject: PanelSubject, values: FloatArray) -> FloatArray:
    """Least of the values at the corners of each panel."""
    return np.minimum.reduceat(values, subject.parts.offsets[:-1])
