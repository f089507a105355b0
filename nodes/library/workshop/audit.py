"""Findings before files go out."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from ....fabrication.audit.report import audit_model
from ....fabrication.audit.subjects import AuditLimits
from ....fabrication.model import Model
from ....fabrication.step.check import check_part21
from ....kernel.beams.beams import Beams
from ....kernel.panels.panels import Panels
from ....kernel.parts.findings import Finding, findings_report
from ....kernel.reports import Report
from ....kernel.support.annulus_construction import AnnuliReport
from ...graphs.node import node
from ...graphs.ports import Port, ReadPath, Units
from ..fabricate import CutReport
from ..support.beams import BeamsReport, DrillingReport

Millimeters = Annotated[float, Port(unit="mm", min=0)]
Degrees = Annotated[float, Port(unit="deg", min=0, max=180)]


@dataclass(frozen=True, eq=False)
class AuditReport(Report):
    """Findings.

    Attributes
    ----------
    counts : dict
        Number of findings by code.
    errors, notes : list of dict
        ``code``, ``id``, ``message`` and ``size`` of each.
    """

    counts: dict[str, int]
    errors: list[dict[str, Any]]
    notes: list[dict[str, Any]]


class Audit(NamedTuple):
    """What an audit found."""

    findings: tuple[Finding, ...]
    report: AuditReport


@node(version="2")
def audit(  # noqa: PLR0913, PLR0917 - whatever may trouble a workshop
    panels: Panels | None = None,
    cut: CutReport | None = None,
    min_corner: Degrees = 15.0,
    min_edge: Millimeters = 20.0,
    max_wall_tilt: Degrees = 30.0,
    max_step: Millimeters = 5.0,
    max_blank: Millimeters | None = None,
    units: Units = "m",
    beams: Beams | None = None,
    annuli_report: AnnuliReport | None = None,
    beams_report: BeamsReport | DrillingReport | None = None,
    max_twist: Degrees = 0.1,
    max_length: Millimeters | None = None,
    max_gap: Millimeters = 5.0,
) -> Audit:
    """Look for whatever would trouble a workshop, as numbered errors and notes.

    Panels are looked at alone, with their neighbours and with everything near: what exceeds the
    largest step, gap or twist is an error, and so is every overlap. What has no errors and
    nothing rejected can be built.

    Parameters
    ----------
    panels : Panels, optional
    cut : CutReport, optional
        Report of the node `panels`: what it rejected is among the errors then.
    min_corner : float
        Sharpest corner of a panel, and bevel of a beam, that is no finding.
    min_edge : float
        Shortest edge, and shortest beam.
    max_wall_tilt : float
        Largest tilt of a wall or a beam from upright.
    max_step : float
        Highest step between neighbours, anywhere along their joint, and largest distance of
        the ends of beams at a node.
    max_blank : float, optional
        Diameter of the largest blank to be had.
    units : str
    beams : Beams, optional
    annuli_report : AnnuliReport, optional
    beams_report : BeamsReport or DrillingReport, optional
        Reports of the nodes `annulus_support` and `beams`: what they rejected is among the
        errors then. That of `drilling_marks` rejects nothing.
    max_twist : float
        Largest angle between a beam and a node axis; node cylinders take any.
    max_length : float, optional
        Longest piece that can be cut for a beam.
    max_gap : float
        Widest gap in a joint beyond its width, widest hole at a node, and farthest that a
        corner of a panel or the plane of a beam may be off its node axis.

    Returns
    -------
    findings : tuple of Finding
        Code, id, message, size and severity of each.
    report : AuditReport
        The findings as plain values.

    Examples
    --------
    >>> from spheremesh.nodes import audit, fit_spheres, panels, vase_mesh
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> audit(made.panels, made.report).report["counts"]
    {'P201': 60}
    """
    limits = AuditLimits(
        corner_deg=min_corner,
        edge_mm=min_edge,
        wall_tilt_deg=max_wall_tilt,
        step_mm=max_step,
        blank_mm=float("inf") if max_blank is None else max_blank,
        twist_deg=max_twist,
        beam_mm=float("inf") if max_length is None else max_length,
        gap_mm=max_gap,
    )
    rejected = [
        part
        for report in (cut, annuli_report, beams_report)
        if report is not None
        for part in report.get("rejected", ())
    ]
    findings = audit_model(Model(panels, beams, units), limits, rejected)
    return Audit(findings, AuditReport(**findings_report(findings)))


@node
def check_step(path: ReadPath) -> Audit:
    """Check the text of a STEP file: syntax, references, open loops, edges of solids.

    Parameters
    ----------
    path : path
        A file as `write_step` writes it.

    Returns
    -------
    findings : tuple of Finding
        What is wrong; empty if nothing is.
    report : AuditReport
        The findings as plain values.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import check_step, fit_spheres, panels, torus_mesh, write_step
    >>> torus = panels(fit_spheres(torus_mesh(8, 6)), thickness=0.02).panels
    >>> with TemporaryDirectory() as folder:
    ...     check_step(write_step(torus, Path(folder) / "torus.step")).findings
    ()
    """
    findings = check_part21(path)
    return Audit(findings, AuditReport(**findings_report(findings)))
