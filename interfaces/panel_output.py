"""What the command line says of a panelling."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click


def print_report(
    report: dict[str, Any],
    out: Path,
    files: tuple[str, ...],
    *,
    as_json: bool,
    is_assumed: bool = False,
) -> None:
    """Warnings and rejected panels on standard error; the report, or what matters of it."""
    from ..kernel.repair.description import describe_lines

    for text in report["warnings"]:
        click.echo(f"warning: {text}", err=True)
    refused = (*report["panels"]["rejected"], *report["beams"]["rejected"])
    for part in refused:
        click.echo(f"rejected {part['code']}: {part['id']}: {part['reason']}", err=True)
    codes = {part["code"] for part in refused}
    audit: Mapping[str, Any] = report["audit"] or {"errors": []}
    for found in audit["errors"]:
        if found["code"] not in codes:  # these are the rejected ones
            click.echo(f"error {found['code']}: {found['id']}: {found['message']}", err=True)
    if as_json:
        click.echo(json.dumps(report, indent=1))
        return
    _print_size(report["input"], is_assumed=is_assumed)
    for line in describe_lines(report["mesh"]) if report["mesh"] else ():
        click.echo(line)
    for name in files:
        click.echo(f"  {out / name}")
    _print_angles(report["angles_deg"], report["creases"])
    click.echo(f"moulds {report['moulds']['count'] or 'not asked for: a radius per panel'}")
    panels = report["panels"]
    click.echo(f"panels {panels['written']} written, {len(panels['rejected'])} rejected")
    if report["support"]:
        support, beams = report["support"], report["beams"]
        click.echo(
            f"torsion of inner nodes at most {support['torsion_deg_max']:.2g} degrees, tilt of "
            f"inner edges mostly below {support['beam_tilt_deg_p95']:.2g}, of beams made at "
            f"most {support['beam_tilt_deg_max']:.2g} degrees"
        )
        click.echo(f"beams {beams['written']} written, {len(beams['rejected'])} rejected")
    if report["audit"]:
        _print_audit(report["audit"])


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


def _print_size(model: Mapping[str, Any], *, is_assumed: bool) -> None:
    """How large the model is, which shows whether its units are right."""
    from ..fabrication.sizes import describe_size

    hint = "; --units to change" if is_assumed else ""
    click.echo(describe_size(model["size"], model["mean_edge"], model["units"]) + hint)


def has_errors(report: Mapping[str, Any]) -> bool:
    """Whether a panel or beam is rejected, or made but of no use."""
    rejected = report["panels"]["rejected"] or report["beams"]["rejected"]
    return bool(rejected or (report["audit"] and report["audit"]["errors"]))


def _print_audit(audit: Mapping[str, Any]) -> None:
    """Number of findings, and of each kind the first."""
    click.echo(f"audit {len(audit['errors'])} errors, {len(audit['notes'])} notes")
    shown: set[str] = set()
    for found in audit["notes"]:
        if found["code"] not in shown:
            shown.add(found["code"])
            count = audit["counts"][found["code"]]
            click.echo(f"  {found['code']} ({count}): {found['id']}: {found['message']}")
