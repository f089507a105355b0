"""Findings: what checks say of parts, numbered, for people and programs to sort."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..arrays import BoolArray, FloatArray
from .records import RejectedPart

Severity = Literal["error", "note"]


@dataclass(frozen=True)
class Finding:
    """
    One thing found.

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
    """
    Parts that cannot be made as plain values.

    Parameters
    ----------
    rejected : iterable of RejectedPart
        Panels or beams.

    Returns
    -------
    list of dict
        ``id``, ``code`` and ``reason`` of each.
    """
    return [{"id": part.id, "code": part.code, "reason": part.reason} for part in rejected]


def refusals(rejected: Iterable[Mapping[str, str]]) -> list[Finding]:
    """
    Parts that cannot be made as findings.

    Parameters
    ----------
    rejected : iterable of mapping
        Plain values, as `rejected_report` gives them.

    Returns
    -------
    list of Finding
        An error for each.
    """
    return [
        Finding(part["code"], part["id"], f"cannot be made: {part['reason']}")
        for part in rejected
    ]


def repeated_names(ids: Iterable[str], code: str, kind: str) -> list[Finding]:
    """
    Names that several parts have.

    Parameters
    ----------
    ids : iterable of str
    code : str
        Code of the findings.
    kind : str
        What the parts are, as a plural.

    Returns
    -------
    list of Finding
        An error for each such name.
    """
    return [
        Finding(code, name, f"{count} {kind} have this name", float(count))
        for name, count in Counter(ids).items()
        if count > 1
    ]


def findings_where(
    ids: Sequence[str],
    code: str,
    sizes: FloatArray,
    is_found: BoolArray,
    message: str,
    severity: Severity = "note",
) -> list[Finding]:
    """
    The findings of one check.

    Parameters
    ----------
    ids : sequence of str
        Names of n parts.
    code : str
        Number of the check.
    sizes : (n,) float array
        How much was found on each.
    is_found : (n,) bool array
        Which parts have the finding.
    message : str
        What is wrong, with a field for the size.
    severity : {"error", "note"}
        What the findings are.

    Returns
    -------
    list of Finding
        In the order of the parts.
    """
    return [
        Finding(code, ids[i], message.format(float(sizes[i])), float(sizes[i]), severity)
        for i in np.flatnonzero(is_found).tolist()
    ]


def findings_report(findings: Sequence[Finding]) -> dict[str, Any]:
    """
    Findings as plain values.

    Parameters
    ----------
    findings : sequence of Finding

    Returns
    -------
    dict
        ``counts`` by code, ``errors`` and ``notes``: lists of code, id, message and size.
    """
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
