"""The audit before files go out: whatever would trouble a workshop, found and numbered."""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import TypeVar

import numpy as np

from ...kernel.beams.beams import Beams
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding
from ...kernel.parts.records import finite_parts
from ..model import Model
from ..units import millimeters_per
from .assembly import assembly, check_assembly
from .beams import beam_subject, check_beams
from .panels import check_panels, panel_subject
from .subjects import USUAL_LIMITS, AuditLimits


def audit_model(
    model: Model, limits: AuditLimits = USUAL_LIMITS, rejected: Iterable[Mapping[str, str]] = ()
) -> tuple[Finding, ...]:
    """Look for whatever would trouble a workshop.

    The parts that could not be made, as `rejected_report` gives them; then findings on panels,
    on beams, and on parts against each other, by code, then in their order. Of each code a part
    has one finding, the worst.

    Errors of panels: P001 name used twice, P002 numbers that are not finite, P100 cannot be
    made, P101 cap beyond 80 degrees, P201 step to a neighbour, P203 gap in a joint, P204
    hole at a node, P205 corner off its node axis, P206 overlaps a panel, P207 overlaps a beam,
    P208 overlaps a node cylinder. Notes: P102 sharp corner, P103 short edge, P104 thick against
    its radius, P105 tilted wall, P106 other thickness than asked for, P107 blank too large,
    P202 neighbour missing.

    Errors of beams: B001 name used twice, B002 numbers that are not finite, B100 edge without
    an annulus, B101 cannot be cut at a node, B102 overlaps a beam, B103 overlaps a node
    cylinder, B202 twisted against a node axis, B203 ends at a node lie apart, B209 its plane
    passes the line of the others at a node. Notes: B201 tilted against the surface, B204
    shallow, B205 short, B206 sharp bevel, B207 too long a piece, B208 drilling marks do not
    fit; with node cylinders, which take every end, P205, B203 and B209 as well, and no B202.

    Checks from P101 and B102 on need finite numbers: where there is a P002 or B002 they wait
    until it is mended. Surfaces without thickness overlap nothing. Raises InputError if the
    units are not known.
    """
    millimeters_per(model.units)
    findings = [
        Finding(part["code"], part["id"], f"cannot be made: {part['reason']}")
        for part in rejected
    ]
    findings.sort(key=lambda finding: finding.code[1:])
    if model.panels is not None:
        found = _unusable(model.panels, "P", "panels")
        findings += found
        if model.panels.ids and not any(finding.code == "P002" for finding in found):
            findings += check_panels(panel_subject(model.panels, model.units, limits))
    if model.beams is not None:
        found = _unusable(model.beams, "B", "beams")
        findings += found
        if model.beams.ids and not any(finding.code == "B002" for finding in found):
            findings += check_beams(beam_subject(model.beams, model.units, limits))
    subject = assembly(_finite(model.panels), _finite(model.beams), model.units, limits)
    findings += check_assembly(subject)
    return tuple(findings)


_PartsT = TypeVar("_PartsT", bound=Panels | Beams)


def _finite(parts: _PartsT | None) -> _PartsT | None:
    """The parts, if they have finite numbers only."""
    return parts if parts is not None and bool(finite_parts(parts).all()) else None


def _unusable(parts: Panels | Beams, letter: str, kind: str) -> list[Finding]:
    """Names used twice and numbers that are not finite."""
    broken = np.flatnonzero(~finite_parts(parts)).tolist()
    message = "has numbers that are not finite"
    return [
        *(
            Finding(f"{letter}001", name, f"{count} {kind} have this name", float(count))
            for name, count in Counter(parts.ids).items()
            if count > 1
        ),
        *(Finding(f"{letter}002", parts.ids[i], message) for i in broken),
    ]
