"""What is wrong: the verdict on top, and rejected parts and findings by kind.

A part that cannot be made is counted once, as rejected: what the audit says of it is that.
"""

from collections.abc import Mapping
from html import escape
from typing import Any, Final

from .tables import table

MOST_PARTS: Final = 12
"""Parts that are named of each kind of finding; all are in report.json."""
MOST_CAUSES: Final = 3
"""Causes that the verdict names."""

_KINDS: Final = {"panels": "P", "beams": "B"}
"""Kinds of parts, and how their ids begin."""


def verdict(report: Mapping[str, Any]) -> str:
    """Whether it can be built; if not, how many parts cannot, and the causes most have."""
    if report["buildable"]:
        return (
            '<p class="verdict"><b>Can be built:</b> no part is rejected, no error found.</p>'
        )
    causes: dict[str, list[tuple[float, str, str]]] = {}
    for found in _errors(report):
        entry = found.get("size") or 0.0, found["id"], found["message"]
        causes.setdefault(found["code"], []).append(entry)
    ranked = sorted(causes.values(), key=len, reverse=True)
    lines = "".join(
        f"<li>{_parts(len(parts))}, worst {escape(worst[1])}: {escape(worst[2])}</li>"
        for parts in ranked[:MOST_CAUSES]
        for worst in (max(parts),)
    )
    left = len(ranked) - MOST_CAUSES
    more = f"<li>and {left} more causes, below</li>" if left > 0 else ""
    return (
        '<div class="verdict bad"><b>Cannot be built as it is.</b> '
        f"{escape(_counts(report))}" + (f"<ol>{lines}{more}</ol>" if lines else "") + "</div>"
    )


def _parts(count: int) -> str:
    return "1 part" if count == 1 else f"{count:,} parts"


def _counts(report: Mapping[str, Any]) -> str:
    """Parts of each kind, those that cannot be made, and others with errors."""
    wrong = {found["id"] for found in _errors(report)}
    texts: list[str] = []
    for kind, letter in _KINDS.items():
        rejected = len({part["id"] for part in report[kind]["rejected"]})
        total = report[kind]["written"] + rejected
        others = sum(name.startswith(letter) for name in wrong)
        if total:
            what = [f"{rejected:,} cannot be made"] if rejected else []
            what += [f"{others:,} {'more ' if rejected else ''}with errors"] if others else []
            texts.append(f"{total:,} {kind}: {', '.join(what) or 'no error'}")
    return "; ".join(texts) + "."


def _errors(report: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Errors of the audit on parts that are not rejected."""
    rejected = {
        part["id"] for kind in _KINDS for part in report[kind]["rejected"]
    }  # fmt: skip
    errors: list[Mapping[str, Any]] = report["audit"]["errors"] if report["audit"] else []
    return [found for found in errors if found["id"] not in rejected]


def faults(report: Mapping[str, Any]) -> str:
    """Rejected parts and findings, by kind: the largest kinds first."""
    kinds: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for part in (*report["panels"]["rejected"], *report["beams"]["rejected"]):
        kinds.setdefault((part["code"], "rejected"), []).append((part["id"], part["reason"]))
    notes: list[Mapping[str, Any]] = report["audit"]["notes"] if report["audit"] else []
    for severity, found in (("error", _errors(report)), ("note", notes)):
        for each in found:
            known = kinds.setdefault((each["code"], severity), [])
            known.append((each["id"], each["message"]))
    warnings = "".join(f"<li>{escape(text)}</li>" for text in report.get("warnings", ()))
    tail = f"<h2>Warnings</h2><ul>{warnings}</ul>" if warnings else ""
    if not kinds:
        return f"<h2>Rejected, and why</h2><p>Nothing.</p>{tail}"
    rows: list[tuple[str, ...]] = []
    order = {"rejected": 0, "error": 1, "note": 2}
    ranked = sorted(kinds.items(), key=lambda item: (order[item[0][1]], -len(item[1])))
    for (code, severity), parts in ranked:
        names = ", ".join(name for name, _ in parts[:MOST_PARTS])
        more = f" and {len(parts) - MOST_PARTS} more" if len(parts) > MOST_PARTS else ""
        cause = f"{escape(parts[0][0])}: {escape(parts[0][1])}"
        rows.append((severity, f"{len(parts):,}", cause, escape(names + more), code))
    heads = ("kind", "parts", "for example", "which", "code")
    return f"<h2>Rejected, and why</h2>{table(heads, rows, 'words')}{tail}"
