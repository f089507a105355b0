"""Findings: what checks say of parts, numbered, for people and programs to sort."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from .records import RejectedPart

Severity = Literal["error", "note"]


@dataclass(frozen=True)
class Finding:
    """One thing found.

    Attributes
    ----------
    code : str
        Number of the check, such as ``P102``.
    id : str
        What it was found on: a panel, a beam, an entity of a file.
    message : str
        What is wrong, for a person.
    size : float or None
        How much, in the unit that the message names.
    severity : {"error", "note"}
        Whether the part cannot be made or used like this, or somebody should look at it.
    """

    code: str
    id: str
    message: str
    size: float | None = None
    severity: Severity = "error"


def rejected_report(rejected: Iterable[RejectedPart]) -> list[dict[str, str]]:
    """Parts that cannot be made as plain values: ``id``, ``code`` and ``reason`` of each."""
    return [{"id": part.id, "code": part.code, "reason": part.reason} for part in rejected]


def findings_report(findings: Sequence[Finding]) -> dict[str, Any]:
    """``counts`` by code, ``errors`` and ``notes``: lists of code, id, message and size."""
    counts = Counter(finding.code for finding in findings)
    return {
        "counts": dict(sorted(counts.items())),
        "errors": _plain(finding for finding in findings if finding.severity == "error"),
        "notes": _plain(finding for finding in findings if finding.severity == "note"),
    }


def _plain(findings: Iterable[Finding]) -> list[dict[str, Any]]:
    return [
        {
            "code": finding.code,
            "id": finding.id,
            "message": finding.message,
            "size": finding.size,
        }
        for finding in findings
    ]
