"""What a workshop asks before it starts: identical panels, findings, the report, solids."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...fabrication.audit.report import audit_model
from ...fabrication.audit.subjects import AuditLimits
from ...fabrication.model import Model
from ...fabrication.sizes import model_extents
from ...fabrication.solids.cadquery_assembly import beams_to_cadquery, to_cadquery
from ...fabrication.step.check import check_part21
from ...kernel.analysis import angle_summary
from ...kernel.beams.beams import Beams
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import mean_edge_length
from ...kernel.panels import congruent
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding, findings_report
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ...kernel.support.annulus_construction import AnnuliReport
from ...kernel.support.node_axes import NodesReport
from ...kernel.tolerances import SAME_PANEL
from ..graphs.node import node
from ..graphs.ports import Port, ReadPath, Units
from .arrays import PanelLabels
from .cluster import BlanksReport, MouldsReport
from .fabricate import CutReport
from .optimise import OptimumReport
from .support import BeamsReport, DrillingReport, LandingReport

Millimeters = Annotated[float, Port(unit="mm", min=0)]
Degrees = Annotated[float, Port(unit="deg", min=0, max=180)]


@dataclass(frozen=True, eq=False)
class ShapesReport(Report):
    """Shapes of panels.

    Attributes
    ----------
    shapes : int
    panels_per_shape : list of int
    first : list of str
        Id of the first panel of each.
    largest_miss : float
        How far corners and edges of one shape lie apart, in model units.
    """

    shapes: int
    panels_per_shape: list[int]
    first: list[str]
    largest_miss: float


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


@dataclass(frozen=True, eq=False)
class PanellingReport(Report):
    """The reports of a panelling in one.

    Attributes
    ----------
    input : dict
        ``vertices``, ``faces``, ``units``, ``size`` along x, y and z, and ``mean_edge``.
    angles_deg : dict
        ``planar`` and ``spherical`` (what is built), and with moulds ``unclustered``.
    vertex_error, edge_gap : dict
        ``max`` in model units and ``relative_to_edge``.
    thickness : dict
        ``min``, ``mean`` and ``max``.
    moulds : dict
        ``count``, ``radii``, ``panels_per_mould`` and ``blanks``.
    support : dict or None
        ``torsion_deg_max`` of inner nodes, ``beam_tilt_deg_p95`` of inner edges,
        ``beam_tilt_deg_max`` of annuli made, and ``landed``.
    panels, beams : dict
        ``written`` and ``rejected``.
    audit : dict or None
        As in `AuditReport`.
    """

    input: dict[str, Any]
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]
    edge_gap: dict[str, float]
    thickness: dict[str, float]
    moulds: dict[str, Any]
    support: dict[str, Any] | None
    panels: dict[str, Any]
    beams: dict[str, Any]
    audit: dict[str, Any] | None


class IdenticalPanels(NamedTuple):
    """Panels gathered by shape."""

    labels: PanelLabels
    report: ShapesReport


class Audit(NamedTuple):
    """What an audit found."""

    findings: tuple[Finding, ...]
    report: AuditReport


@node
def identical_panels(
    panels: Panels, tolerance: Annotated[float, Port(min=0)] = SAME_PANEL
) -> IdenticalPanels:
    """Find panels that are the same up to a rigid motion and can share blanks and patterns.

    Parameters
    ----------
    panels : Panels
    tolerance : float
        How far corners and edges of one shape may lie apart, in mean edges.

    Returns
    -------
    labels : (P,) int array
        Shape of each panel, from 0. Mirror images and panels of different moulds differ.
    report : ShapesReport
        Number of shapes, and of panels of each.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, identical_panels, panels, vase_mesh
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> identical_panels(made.panels).report["panels_per_shape"]
    [12, 12, 12, 12, 12, 12]
    """
    same = congruent.congruent_panels(panels, tolerance)
    report = ShapesReport(
        shapes=len(same.representatives),
        panels_per_shape=np.bincount(same.labels).tolist(),
        first=[panels.ids[i] for i in same.representatives.tolist()],
        largest_miss=float(same.misses.max(initial=0.0)),
    )
    return IdenticalPanels(same.labels, report)


@node
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
    max_twist: Degrees = 1.0,
    max_length: Millimeters | None = None,
) -> Audit:
    """Look for whatever would trouble a workshop, as numbered errors and notes.

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
        Highest step between neighbours, and largest distance of the ends of beams at a node.
    max_blank : float, optional
        Diameter of the largest blank to be had.
    units : str
    beams : Beams, optional
    annuli_report : AnnuliReport, optional
    beams_report : BeamsReport or DrillingReport, optional
        Reports of the nodes `annulus_support` and `beams`: what they rejected is among the
        errors then. That of `drilling_marks` rejects nothing.
    max_twist : float
        Largest angle between a beam and a node axis.
    max_length : float, optional
        Longest piece that can be cut for a beam.

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
    >>> from spheremesh.nodes import fit_spheres, panels, torus_mesh, write_step
    >>> torus = panels(fit_spheres(torus_mesh(8, 6)), thickness=0.02).panels
    >>> with TemporaryDirectory() as folder:
    ...     check_step(write_step(torus, Path(folder) / "torus.step")).findings
    ()
    """
    findings = check_part21(path)
    return Audit(findings, AuditReport(**findings_report(findings)))


@node
def panel_report(  # noqa: PLR0913, PLR0917 - a report of every step
    sphere_mesh: SphereMesh,
    optimum: OptimumReport,
    cut: CutReport,
    moulds: MouldsReport | None = None,
    blanks: BlanksReport | None = None,
    audit: AuditReport | None = None,
    nodes: NodesReport | None = None,
    annuli: AnnuliReport | None = None,
    beams: BeamsReport | None = None,
    landing: LandingReport | None = None,
    units: Units = "m",
) -> PanellingReport:
    """Gather the reports of a panelling into one.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        What the panels were cut from.
    optimum : OptimumReport
        Report of `minimize_angles` or `optimize_spheres`.
    cut : CutReport
        Report of `panels`.
    moulds : MouldsReport, optional
        Report of `cluster_radii`.
    blanks : BlanksReport, optional
        Result of `mould_blanks`.
    audit : AuditReport, optional
        Report of `audit`.
    nodes : NodesReport, optional
        Report of `support_structure`.
    annuli : AnnuliReport, optional
        Report of `annulus_support`.
    beams : BeamsReport, optional
        Report of `beams`.
    landing : LandingReport, optional
        Report of `land_nodes`.
    units : str

    Returns
    -------
    PanellingReport
        Angles, gaps, moulds, support, what is written and rejected, and the audit.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, minimize_angles, vase_mesh
    >>> from spheremesh.nodes import panel_report, panels
    >>> optimum = minimize_angles(fit_spheres(vase_mesh(12, 6)))
    >>> made = panels(optimum.sphere_mesh, thickness=0.02)
    >>> panel_report(optimum.sphere_mesh, optimum.report, made.report)["panels"]
    {'written': 72, 'rejected': []}
    """
    mesh = sphere_mesh.mesh
    angles = {**optimum["angles_deg"], "spherical": angle_summary(sphere_mesh)}
    found: dict[str, Any] = {"count": 0, "radii": [], "panels_per_mould": []}
    if moulds is not None:
        # What is built counts as spherical; what the moulds cost is there to compare.
        angles["unclustered"] = optimum["angles_deg"]["spherical"]
        found = {name: moulds[name] for name in found}
    miss = float(vertex_error(sphere_mesh).max())
    return PanellingReport(
        input={
            "vertices": mesh.n_vertices,
            "faces": mesh.n_faces,
            "units": units,
            "size": model_extents(mesh),
            "mean_edge": mean_edge_length(mesh),
        },
        angles_deg=angles,
        vertex_error={"max": miss, "relative_to_edge": miss / mean_edge_length(mesh)},
        edge_gap=dict(cut["edge_gap"]),
        thickness=dict(cut["thickness"]),
        moulds=found | {"blanks": list(blanks["blanks"]) if blanks else []},
        support=None
        if nodes is None
        else {
            "torsion_deg_max": nodes["torsion_deg"]["max"],
            "beam_tilt_deg_p95": nodes["beam_tilt_deg"]["p95"],
            "beam_tilt_deg_max": (annuli["tilt_deg"] if annuli else nodes["beam_tilt_deg"])[
                "max"
            ],
            "landed": bool(landing and landing["landed"]),
        },
        panels={"written": cut["written"], "rejected": list(cut["rejected"])},
        beams={
            "written": beams["written"] if beams else 0,
            "rejected": [
                entry for found in (annuli, beams) if found for entry in found["rejected"]
            ],
        },
        audit=dict(audit) if audit is not None else None,
    )


@node
def cadquery_solids(
    panels: Panels | None = None, beams: Beams | None = None, units: Units = "m"
) -> object:
    """Panels and beams as a CadQuery assembly, for further modelling.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    beams : Beams, optional
        The beams; of beams and panels the former are an assembly within the latter.
    units : str
        Model units; the assembly is in millimetres.

    Returns
    -------
    cadquery.Assembly
        A solid (without thickness a face) for every part, named by its id.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, panels, torus_mesh
    >>> torus = panels(fit_spheres(torus_mesh(8, 6)), thickness=0.02).panels
    >>> len(cadquery_solids(torus).children)
    48
    """
    if panels is None:
        if beams is None:
            raise InputError("cadquery_solids needs panels or beams")
        return beams_to_cadquery(beams, units)
    assembly = to_cadquery(panels, units)
    return assembly if beams is None else assembly.add(beams_to_cadquery(beams, units))
