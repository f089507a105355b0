"""Whether a model can be built, in one line: if not, why not, and what would do."""

from collections.abc import Mapping
from typing import Any, Final

import click

MOST_CAUSES: Final = 3
"""Causes that the line names."""

_LIMITS: Final = {
    "P201": "--allow-step", "P203": "--allow-gap", "P204": "--allow-gap", "P205": "--allow-gap",
    "B202": "--allow-torsion", "B203": "--allow-step", "B209": "--allow-gap",
}  # fmt: skip
"""The option that allows more, by code."""


def print_verdict(report: Mapping[str, Any], *, is_error: bool = False) -> None:
    """Print the last line where a model cannot be built: its causes, and what would do.

    The three causes that most parts have, each with its worst part.
    """
    if report["buildable"]:
        return
    causes: dict[str, list[tuple[float, str]]] = {}
    errors: list[dict[str, Any]] = report["audit"]["errors"] if report["audit"] else []
    for found in errors:
        text = f"{found['id']} {found['message']}"
        causes.setdefault(found["code"], []).append((found["size"] or 0.0, text))
    for part in (*report["panels"]["rejected"], *report["beams"]["rejected"]):
        if not report["audit"]:
            causes.setdefault(part["code"], []).append((0.0, f"{part['id']} {part['reason']}"))
    ranked = sorted(causes.items(), key=lambda item: -len(item[1]))
    texts = [f"{code} ({len(parts)}): {max(parts)[1]}" for code, parts in ranked[:MOST_CAUSES]]
    left = len(ranked) - MOST_CAUSES
    more = f"; {left} more causes" if left > 0 else ""
    worst = {code: max(parts)[0] for code, parts in causes.items()}
    cures = _cures(report, worst)
    would_do = f". What would do: {'; '.join(cures)}" if cures else ""
    line = f"NOT BUILDABLE: {'; '.join(texts)}{more}{would_do}"
    click.secho(line, fg="red", err=is_error)


def _cures(report: Mapping[str, Any], worst: Mapping[str, float]) -> list[str]:
    """What would do, of errors by code with their largest size."""
    cures: list[str] = []
    if "P201" in worst:
        cures += _smaller_steps(report)
    if "P204" in worst:
        cures.append("thinner panels leave smaller holes")
    if "B202" in worst:
        cures.append("upright beams before node cylinders (--support bisector)")
    if not worst.keys() <= _LIMITS.keys():
        return cures
    allowed: dict[str, float] = {}
    for code, size in worst.items():
        allowed[_LIMITS[code]] = max(allowed.get(_LIMITS[code], 0.0), size)
    limits = " ".join(f"{option} {_rounded_up(size)}" for option, size in allowed.items())
    return [*cures, f"a workshop that bears it ({limits})"]


def _smaller_steps(report: Mapping[str, Any]) -> list[str]:
    """What makes steps between neighbours smaller: they come from corners, arcs, or both."""
    corner, middle = report["edge_gap"]["corner_max"], report["edge_gap"]["middle_max"]
    cures: list[str] = []
    if 2 * corner >= middle:
        share = 100 * report["vertex_error"]["relative_to_edge"]
        cures.append(
            f"vertices on their spheres, which they miss by up to {share:.2g} % of an edge: "
            "faces on circles, a net along the lines of curvature, or triangles"
        )
    if middle > corner:
        cures.append("more moulds" if report["moulds"]["count"] else "shorter edges")
    return cures


def _rounded_up(size: float) -> str:
    """A limit of three digits that is not exceeded."""
    return f"{size * 1.005:.3g}"
