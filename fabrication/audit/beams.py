"""
The audit of beams: numbered findings, errors apart from notes, as for panels.

A check is a function of a `BeamSubject` that returns findings; `BEAM_CHECKS` lists them.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.beams.drilling import NO_MARKS
from ...kernel.beams.facts import BeamFacts, beam_facts
from ...kernel.parts.findings import (
    Finding,
    findings_where,
    refusals,
    rejected_report,
    repeated_names,
)
from ...kernel.parts.records import RejectedPart, finite_parts
from ...kernel.tolerances import OVERLAP
from ..units import millimeters_per
from .panels import AuditLimits


@dataclass(frozen=True)
class BeamSubject:
    """
    What beam checks look at.

    Attributes
    ----------
    beams : Beams
        The beams, in millimetres.
    facts : BeamFacts
        Their measures, in millimetres.
    limits : AuditLimits
        What the workshop can do.
    """

    beams: Beams
    facts: BeamFacts
    limits: AuditLimits


BeamCheck = Callable[[BeamSubject], Iterable[Finding]]


def audit_beams(
    beams: Beams,
    units: str = "m",
    rejected: Iterable[RejectedPart] = (),
    limits: AuditLimits | None = None,
) -> tuple[Finding, ...]:
    """
    Look for whatever would trouble a workshop.

    Parameters
    ----------
    beams : Beams
        B beams, perhaps none.
    units : str
        Model units: mm, cm, m, in or ft.
    rejected : iterable of RejectedPart
        Beams that could not be made.
    limits : AuditLimits, optional
        What the workshop can do.

    Returns
    -------
    tuple of Finding
        By code, then in the order of the beams. Errors: B001 name used twice, B002 numbers that
        are not finite, B100 edge without an annulus, B101 cannot be cut at a node, B102 runs
        into a neighbour. Notes: B201 tilted against the surface, B202 twisted against a node
        axis, B203 ends at a node lie apart, B204 shallow, B205 short, B206 sharp bevel, B207
        too long a piece, B208 drilling marks do not fit. Of each code a beam has one finding,
        the worst. Checks from B102 on need finite numbers: where there is a B002 they wait
        until it is mended.

    Raises
    ------
    InputError
        If the units are not known.
    """
    scaled = scale_beams(beams, millimeters_per(units))
    ids = beams.annuli.ids
    finite = finite_parts(beams)
    findings = [
        *repeated_names(ids, "B001", "beams"),
        *(
            Finding("B002", ids[i], "has numbers that are not finite")
            for i in np.flatnonzero(~finite)
        ),
        *sorted(refusals(rejected_report(rejected)), key=lambda finding: finding.code),
    ]
    if beams.n_beams and finite.all():
        limits = limits or AuditLimits()
        findings += check_beams(BeamSubject(scaled, beam_facts(scaled), limits))
    return tuple(findings)


def check_beams(subject: BeamSubject) -> list[Finding]:
    """
    Run every beam check.

    Parameters
    ----------
    subject : BeamSubject
        At least one beam, with finite numbers.

    Returns
    -------
    list of Finding
        The findings B102 to B208, see `audit_beams`.
    """
    return [finding for check in BEAM_CHECKS for finding in check(subject)]


def _overlaps(subject: BeamSubject) -> list[Finding]:
    depths = -subject.facts.clearances.min(axis=1)
    is_found = depths > OVERLAP * subject.beams.thickness
    message = "runs into a neighbour by {0:.3g} mm: larger nodes or thinner beams"
    ids = subject.beams.annuli.ids
    return findings_where(ids, "B102", depths, is_found, message, "error")


def _tilts(subject: BeamSubject) -> list[Finding]:
    tilts, limit = np.degrees(subject.facts.tilts), subject.limits.wall_tilt_deg
    message = f"tilts by {{0:.3g}} degrees against the surface, more than {limit:g}"
    return _found(subject, "B201", tilts, tilts > limit, message)


def _twists(subject: BeamSubject) -> list[Finding]:
    twists, limit = np.degrees(subject.facts.twists).max(axis=1), subject.limits.twist_deg
    message = f"misses a node axis by {{0:.3g}} degrees, more than {limit:g}"
    return _found(subject, "B202", twists, twists > limit, message)


def _mismatches(subject: BeamSubject) -> list[Finding]:
    apart, limit = subject.facts.mismatches.max(axis=1), subject.limits.step_mm
    message = f"an end lies {{0:.3g}} mm off the others at its node, more than {limit:g}"
    return _found(subject, "B203", apart, apart > limit, message)


def _depths(subject: BeamSubject) -> list[Finding]:
    facts, limit = subject.facts, subject.limits.depth_share * subject.beams.thickness
    depths = np.minimum(facts.depths.min(axis=1), facts.widths)
    message = f"is only {{0:.4g}} mm deep, less than {limit:.4g}"
    return _found(subject, "B204", depths, depths < limit, message)


def _lengths(subject: BeamSubject) -> list[Finding]:
    lengths, limit = subject.facts.chords, subject.limits.edge_mm
    message = f"is only {{0:.4g}} mm long, less than {limit:g}"
    return _found(subject, "B205", lengths, lengths < limit, message)


def _bevels(subject: BeamSubject) -> list[Finding]:
    bevels, limit = np.degrees(subject.facts.bevels).min(axis=(1, 2)), subject.limits.corner_deg
    message = f"an end is cut at {{0:.4g}} degrees, sharper than {limit:g}"
    return _found(subject, "B206", bevels, bevels < limit, message)


def _large_pieces(subject: BeamSubject) -> list[Finding]:
    sizes, limit = subject.facts.sizes.max(axis=1), subject.limits.beam_mm
    message = f"needs a piece of {{0:.5g}} mm, longer than {limit:g}"
    return _found(subject, "B207", sizes, sizes > limit, message)


def _marks(subject: BeamSubject) -> list[Finding]:
    marks = subject.beams.marks
    if marks is None:
        return []
    ids = subject.beams.annuli.ids
    return [
        Finding(NO_MARKS, ids[i], "the drilling marks do not fit", severity="note")
        for i in np.flatnonzero(~marks.fits)
    ]


BEAM_CHECKS: Final[tuple[BeamCheck, ...]] = (
    _overlaps, _tilts, _twists, _mismatches, _depths, _lengths, _bevels, _large_pieces, _marks,
)  # fmt: skip


def _found(
    subject: BeamSubject, code: str, sizes: FloatArray, is_found: BoolArray, message: str
) -> list[Finding]:
    return findings_where(subject.beams.annuli.ids, code, sizes, is_found, message)
