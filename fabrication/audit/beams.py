"""Checks of beams: numbered findings, errors apart from notes."""

from typing import Final, TypeAlias

import numpy as np

from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.beams.drilling import NO_MARKS
from ...kernel.beams.facts import BeamFacts, beam_facts
from ...kernel.parts.findings import Finding
from ..measures import measured_once
from ..units import millimeters_per
from .subjects import USUAL_LIMITS, AuditLimits, Subject

BeamSubject: TypeAlias = Subject[Beams, BeamFacts]


def beam_subject(
    beams: Beams, units: str = "m", limits: AuditLimits = USUAL_LIMITS
) -> BeamSubject:
    """Beams in millimetres, measured: what `check_beams` looks at."""
    made, facts = measured_once(beams, units, lambda: _measure(beams, units))
    return BeamSubject(made, facts, limits)


def _measure(beams: Beams, units: str) -> tuple[Beams, BeamFacts]:
    made = scale_beams(beams, millimeters_per(units))
    return made, beam_facts(made)


def check_beams(subject: BeamSubject) -> list[Finding]:
    """Run every beam check: the findings B201 to B209, see `audit_model`.

    The subject has at least one beam, with finite numbers.
    """
    return [finding for check in BEAM_CHECKS for finding in check(subject)]


def _tilts(subject: BeamSubject) -> list[Finding]:
    tilts, limit = np.degrees(subject.facts.tilts), subject.limits.wall_tilt_deg
    message = f"tilts by {{0:.3g}} degrees against the surface, more than {limit:g}"
    return subject.found("B201", tilts, tilts > limit, message)


def _twists(subject: BeamSubject) -> list[Finding]:
    """Node cylinders take twisted beams as they are: they end square before them."""
    twists, limit = np.degrees(subject.facts.twists).max(axis=1), subject.limits.twist_deg
    message = f"misses a node axis by {{0:.3g}} degrees, more than {limit:g}"
    found = (twists > limit) & (subject.parts.node_radius == 0)
    return subject.found("B202", twists, found, message, "error")


def _mismatches(subject: BeamSubject) -> list[Finding]:
    apart, limit = subject.facts.mismatches.max(axis=1), subject.limits.step_mm
    message = f"an end lies {{0:.3g}} mm off the others at its node, more than {limit:g}"
    severity = "note" if subject.parts.node_radius > 0 else "error"
    return subject.found("B203", apart, apart > limit, message, severity)


def _line_misses(subject: BeamSubject) -> list[Finding]:
    misses, limit = subject.facts.line_misses.max(axis=1), subject.limits.gap_mm
    message = f"its plane passes the line of its node by {{0:.3g}} mm, more than {limit:g}"
    severity = "note" if subject.parts.node_radius > 0 else "error"
    return subject.found("B209", misses, misses > limit, message, severity)


def _depths(subject: BeamSubject) -> list[Finding]:
    facts, limit = subject.facts, subject.limits.depth_share * subject.parts.thickness
    depths = np.minimum(facts.depths.min(axis=1), facts.widths)
    message = f"is only {{0:.4g}} mm deep, less than {limit:.4g}"
    return subject.found("B204", depths, depths < limit, message)


def _lengths(subject: BeamSubject) -> list[Finding]:
    lengths, limit = subject.facts.chords, subject.limits.edge_mm
    message = f"is only {{0:.4g}} mm long, less than {limit:g}"
    return subject.found("B205", lengths, lengths < limit, message)


def _bevels(subject: BeamSubject) -> list[Finding]:
    bevels, limit = np.degrees(subject.facts.bevels).min(axis=(1, 2)), subject.limits.corner_deg
    message = f"an end is cut at {{0:.4g}} degrees, sharper than {limit:g}"
    return subject.found("B206", bevels, bevels < limit, message)


def _large_pieces(subject: BeamSubject) -> list[Finding]:
    sizes, limit = subject.facts.sizes.max(axis=1), subject.limits.beam_mm
    message = f"needs a piece of {{0:.5g}} mm, longer than {limit:g}"
    return subject.found("B207", sizes, sizes > limit, message)


def _marks(subject: BeamSubject) -> list[Finding]:
    marks = subject.parts.marks
    if marks is None:
        return []
    ids = subject.parts.ids
    return [
        Finding(NO_MARKS, ids[i], "the drilling marks do not fit", severity="note")
        for i in np.flatnonzero(~marks.fits)
    ]


BEAM_CHECKS: Final = (
    _tilts, _twists, _mismatches, _depths, _lengths, _bevels, _large_pieces, _marks,
    _line_misses,
)  # fmt: skip
