"""
The audit before files go out: numbered findings about panels, errors apart from notes.

A check is a function of a `PanelSubject` that returns findings; `PANEL_CHECKS` lists them.
Beams have checks of their own in `fabrication.beam_audit`, for the same workshop.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, IntArray
from ...kernel.panels.facts import PanelFacts, panel_facts
from ...kernel.panels.panels import Panels, neighbor_ids, scale_panels
from ...kernel.parts.findings import (
    Finding,
    Severity,
    findings_where,
    refusals,
    rejected_report,
    repeated_names,
)
from ...kernel.parts.records import RejectedPart, finite_parts
from ...kernel.tolerances import CAP_ANGLE
from ..units import millimeters_per


@dataclass(frozen=True)
class AuditLimits:
    """
    What a workshop can do.

    Attributes
    ----------
    corner_deg : float
        Corners of panels and bevels of beams sharper than this break.
    edge_mm : float
        Edges and beams shorter than this are hard to cut.
    wall_tilt_deg : float
        Walls and beams that lean more than this from upright need another tool.
    step_mm : float
        Steps between neighbours, and between the ends of beams at a node, larger than this are
        seen.
    thickness_share : float
        Panels thicker than this share of their smallest radius are hard to form.
    thickness_change : float
        Thicknesses that differ by more than this share from the one asked for.
    blank_mm : float
        Largest blank to be had; infinite for any.
    twist_deg : float
        Beams whose plane misses a node axis by more than this do not fit there.
    depth_share : float
        Beams shallower than this many thicknesses are no beams any more.
    beam_mm : float
        Longest piece that can be cut; infinite for any.
    """

    corner_deg: float = 15.0
    edge_mm: float = 20.0
    wall_tilt_deg: float = 30.0
    step_mm: float = 5.0
    thickness_share: float = 0.2
    thickness_change: float = 0.2
    blank_mm: float = float("inf")
    twist_deg: float = 1.0
    depth_share: float = 2.0
    beam_mm: float = float("inf")


@dataclass(frozen=True)
class PanelSubject:
    """
    What panel checks look at.

    Attributes
    ----------
    panels : Panels
        The panels, in millimetres.
    facts : PanelFacts
        Their measures, in millimetres.
    limits : AuditLimits
        What the workshop can do.
    """

    panels: Panels
    facts: PanelFacts
    limits: AuditLimits


PanelCheck = Callable[[PanelSubject], Iterable[Finding]]


def audit_panels(
    panels: Panels,
    units: str = "m",
    rejected: Iterable[RejectedPart] = (),
    limits: AuditLimits | None = None,
) -> tuple[Finding, ...]:
    """
    Look for whatever would trouble a workshop.

    Parameters
    ----------
    panels : Panels
        P panels, perhaps none.
    units : str
        Model units: mm, cm, m, in or ft.
    rejected : iterable of RejectedPart
        Panels that could not be made.
    limits : AuditLimits, optional
        What the workshop can do.

    Returns
    -------
    tuple of Finding
        By code, then in the order of the panels. Errors: P001 name used twice, P002 numbers
        that are not finite, P100 cannot be made, P101 cap beyond 80 degrees. Notes: P102 sharp
        corner, P103 short edge, P104 thick against its radius, P105 tilted wall, P106 other
        thickness than asked for, P107 blank too large, P201 step to a neighbour, P202 neighbour
        missing. Of each code a panel has one finding, the worst. Checks from P101 on need
        finite numbers: where there is a P002 they wait until it is mended.

    Raises
    ------
    InputError
        If the units are not known.
    """
    scaled = scale_panels(panels, millimeters_per(units))
    findings = [
        *repeated_names(panels.ids, "P001", "panels"),
        *refusals(rejected_report(rejected)),
    ]
    finite = finite_parts(panels)
    findings += [
        Finding("P002", panels.ids[i], "has numbers that are not finite")
        for i in np.flatnonzero(~finite)
    ]
    if panels.n_panels and finite.all():
        subject = PanelSubject(scaled, panel_facts(scaled), limits or AuditLimits())
        findings += check_panels(subject)
    return tuple(findings)


def check_panels(subject: PanelSubject) -> list[Finding]:
    """
    Run every panel check.

    Parameters
    ----------
    subject : PanelSubject
        At least one panel, with finite numbers.

    Returns
    -------
    list of Finding
        The findings P101 to P202, see `audit_panels`.
    """
    return [finding for check in PANEL_CHECKS for finding in check(subject)]


def findings_by_id(findings: Iterable[Finding]) -> dict[str, list[Finding]]:
    """
    Findings of each part.

    Parameters
    ----------
    findings : iterable of Finding
        The findings.

    Returns
    -------
    dict of str to list of Finding
        By the id of the part.
    """
    result: dict[str, list[Finding]] = {}
    for finding in findings:
        result.setdefault(finding.id, []).append(finding)
    return result


def warning_text(findings: Iterable[Finding]) -> str:
    """
    Findings of one part in a line.

    Parameters
    ----------
    findings : iterable of Finding
        The findings.

    Returns
    -------
    str
        Codes and messages, separated by semicolons.
    """
    return "; ".join(f"{finding.code} {finding.message}" for finding in findings)


def _caps(subject: PanelSubject) -> Iterator[Finding]:
    half = np.degrees(subject.facts.caps.openings / 2)
    limit = float(np.degrees(CAP_ANGLE))
    message = "reaches {0:.4g} degrees from its middle, beyond 80: split it"
    yield from _found(subject, "P101", half, half > limit, message, severity="error")


def _corners(subject: PanelSubject) -> Iterator[Finding]:
    angles, limit = np.degrees(subject.facts.corner_angles), subject.limits.corner_deg
    sharpest = _least(subject, angles)
    message = f"a corner of {{0:.4g}} degrees, sharper than {limit:g}"
    yield from _found(subject, "P102", sharpest, sharpest < limit, message)


def _edges(subject: PanelSubject) -> Iterator[Finding]:
    shortest, limit = _least(subject, subject.facts.edge_lengths), subject.limits.edge_mm
    message = f"an edge of {{0:.4g}} mm, shorter than {limit:g}"
    yield from _found(subject, "P103", shortest, shortest < limit, message)


def _thickness(subject: PanelSubject) -> Iterator[Finding]:
    facts, panels = subject.facts, subject.panels
    smallest = np.minimum(facts.outer_radii, facts.inner_radii)
    share, limit = panels.thicknesses / smallest, subject.limits.thickness_share
    message = f"its thickness is {{0:.3g}} of its smallest radius, more than {limit:g}"
    yield from _found(subject, "P104", share, share > limit, message)


def _walls(subject: PanelSubject) -> Iterator[Finding]:
    tilts, limit = np.degrees(subject.facts.wall_tilts), subject.limits.wall_tilt_deg
    steepest = -_least(subject, -tilts)
    message = f"a wall leans by {{0:.3g}} degrees, more than {limit:g}"
    yield from _found(subject, "P105", steepest, steepest > limit, message)


def _other_thickness(subject: PanelSubject) -> Iterator[Finding]:
    panels = subject.panels
    change = np.abs(panels.thicknesses - panels.thickness)
    message = f"its thickness is {{0:.4g}} mm, not {panels.thickness:.4g}"
    other = change > subject.limits.thickness_change * panels.thickness
    yield from _found(subject, "P106", panels.thicknesses, other, message)


def _blanks(subject: PanelSubject) -> Iterator[Finding]:
    diameters, limit = 2 * subject.facts.caps.radii, subject.limits.blank_mm
    message = f"needs a blank of {{0:.5g}} mm, larger than {limit:g}"
    yield from _found(subject, "P107", diameters, diameters > limit, message)


def _steps(subject: PanelSubject) -> Iterator[Finding]:
    steps, limit = np.nan_to_num(subject.facts.steps), subject.limits.step_mm
    highest = -_least(subject, -steps)
    message = f"a step of {{0:.3g}} mm to a neighbour, more than {limit:g}"
    yield from _found(subject, "P201", highest, highest > limit, message)


def _missing_neighbors(subject: PanelSubject) -> Iterator[Finding]:
    panels = subject.panels
    names = neighbor_ids(panels)
    missing = np.array([name is None for name in names]) & (panels.neighbors >= 0)
    counts: IntArray = np.add.reduceat(missing.astype(np.int64), panels.offsets[:-1])
    message = "{0:.0f} of its neighbours are missing"
    yield from _found(subject, "P202", counts.astype(np.float64), counts > 0, message)


PANEL_CHECKS: Final[tuple[PanelCheck, ...]] = (
    _caps, _corners, _edges, _thickness, _walls, _other_thickness, _blanks, _steps,
    _missing_neighbors,
)  # fmt: skip


def _least(subject: PanelSubject, values: FloatArray) -> FloatArray:
    """Least of the values at the corners of each panel."""
    return np.minimum.reduceat(values, subject.panels.offsets[:-1])


def _found(
    subject: PanelSubject,
    code: str,
    sizes: FloatArray,
    is_found: BoolArray,
    message: str,
    severity: Severity = "note",
) -> list[Finding]:
    return findings_where(subject.panels.ids, code, sizes, is_found, message, severity)
