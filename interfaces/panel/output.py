"""What the command line says of a panelling."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import click

from .verdict import print_verdict

MOST_ERRORS: Final = 5
"""Errors of one kind that are printed; all are in the report."""


def print_report(
    report: dict[str, Any],
    out: Path,
    files: tuple[str, ...],
    *,
    as_json: bool,
    is_assumed: bool = False,
) -> None:
    """Warnings and rejected panels on standard error; the report, or what matters of it."""
    from ...kernel.repair.description import describe_lines

    for text in report["warnings"]:
        click.echo(f"warning: {text}", err=True)
    refused = (*report["panels"]["rejected"], *report["beams"]["rejected"])
    for part in refused:
        click.echo(f"rejected {part['code']}: {part['id']}: {part['reason']}", err=True)
    audit: Mapping[str, Any] = report["audit"] or {"errors": []}
    _print_errors(audit["errors"], {part["code"] for part in refused})
    if as_json:
        click.echo(json.dumps(report, indent=1))
        print_verdict(report, is_error=True)
        return
    _print_feasibility(report["support"])
    _print_size(report["input"], is_assumed=is_assumed)
    for line in describe_lines(report["mesh"]) if report["mesh"] else ():
        click.echo(line)
    for name in files:
        click.echo(f"  {out / name}")
    _print_pattern(report.get("pattern"))
    _print_angles(report["angles_deg"], report["creases"])
    click.echo(f"moulds {report['moulds']['count'] or 'not asked for: a radius per panel'}")
    panels = report["panels"]
    click.echo(f"panels {panels['written']} written, {len(panels['rejected'])} rejected")
    if report["support"]:
        _print_support(report["support"], report["beams"])
    if report["cost"]:
        _print_cost(report["cost"])
    if report["audit"]:
        _print_audit(report["audit"])
    print_verdict(report)


def _print_errors(errors: Sequence[Mapping[str, Any]], known: set[str]) -> None:
    """The first errors of each code; those of rejected parts are printed already."""
    shown: Counter[str] = Counter()
    for found in errors:
        code = found["code"]
        shown[code] += 1
        if code not in known and shown[code] <= MOST_ERRORS:
            click.echo(f"error {code}: {found['id']}: {found['message']}", err=True)
    for code, count in shown.items():
        if code not in known and count > MOST_ERRORS:
            click.echo(f"error {code}: {count - MOST_ERRORS} more, in report.json", err=True)


def _print_angles(angles: Mapping[str, Any], creases: Mapping[str, Any]) -> None:
    """How smoothly panels meet, and where they do not."""
    planar, spherical = angles["planar"], angles["spherical"]
    click.echo(
        f"angle between neighbours, mean (largest): {planar['mean']:.2f} ({planar['max']:.1f}) "
        f"degrees with planes, {spherical['mean']:.2f} ({spherical['max']:.1f}) with spheres"
    )
    if creases["count"]:
        click.echo(
            f"creases of more than {creases['angle_deg']:g} degrees, not counted: "
            f"{creases['count']}, at {creases['mean_deg']:.2f} ({creases['max_deg']:.1f}) "
            "degrees as built; --crease to change"
        )


def _print_pattern(pattern: Mapping[str, Any] | None) -> None:
    """What became of a pattern, beside what was expected."""
    if pattern:
        net = pattern["net"]
        angles, faces = net["angles_deg"], net["faces"]["count"]
        off = net["deviation"]["surface"]
        tried = f" ({len(net['tries'])} tried)" if net["tries"] else ""
        click.echo(
            f"pattern {net['status']}{tried}: {faces} faces, "
            f"edges of {net['edges']['mean']:.3g}, at most {100 * off:.0f} % of one off the "
            f"surface; {angles['expected']:.2f} degrees expected, {angles['spheres']:.2f} "
            "reached before moulds"
        )


def _print_size(model: Mapping[str, Any], *, is_assumed: bool) -> None:
    """How large the model is, which shows whether its units are right."""
    from ...fabrication.sizes import describe_size

    hint = "; --units to change" if is_assumed else ""
    click.echo(describe_size(model["size"], model["mean_edge"], model["units"]) + hint)


def _print_feasibility(support: Mapping[str, Any] | None) -> None:
    """Whether beams on node axes can stand, which is known before all else."""
    if support and support["feasibility"]:
        found = support["feasibility"]
        click.echo(f"support {found['verdict']}: {found['reason']}")


def _print_support(support: Mapping[str, Any], beams: Mapping[str, Any]) -> None:
    """How straight the beams stand, and how many there are."""
    p95, largest = support["beam_tilt_deg_p95"], support["beam_tilt_deg_max"]
    click.echo(
        f"support {support['kind']}: torsion at most {support['torsion_deg_max']:.2g} degrees, "
        f"tilt inside mostly below {p95:.2g}, of beams made at most {largest:.2g} degrees"
    )
    if support.get("node_radius"):
        radius = support["node_radius"]
        click.echo(f"node cylinders take the torsion up, of a radius of {radius:.3g} at least")
    click.echo(f"beams {beams['written']} written, {len(beams['rejected'])} rejected")


def _print_cost(cost: Mapping[str, Any]) -> None:
    """The total, and what it is made of."""
    area = f" ({cost['per_m2']:,.0f} a square metre)" if cost["per_m2"] is not None else ""
    parts = ", ".join(f"{name} {part:,.0f}" for name, part in cost["parts"].items() if part)
    line = f"cost {cost['total']:,.0f} {cost['currency']}".rstrip()
    click.echo(f"{line}{area}: {parts}" if parts else f"{line}{area}")


def has_errors(report: Mapping[str, Any]) -> bool:
    """Whether a panel or beam is rejected, or made but of no use."""
    return not report["buildable"]


def _print_audit(audit: Mapping[str, Any]) -> None:
    """Number of findings, and of each kind the first."""
    click.echo(f"audit {len(audit['errors'])} errors, {len(audit['notes'])} notes")
    shown: set[str] = set()
    for found in audit["notes"]:
        if found["code"] not in shown:
            shown.add(found["code"])
            count = audit["counts"][found["code"]]
            click.echo(f"  {found['code']} ({count}): {found['id']}: {found['message']}")
