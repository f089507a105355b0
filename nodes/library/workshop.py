"""What a workshop asks before it starts: blanks, identical panels, findings, the report."""

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...fabrication.audit.report import audit_model
from ...fabrication.audit.subjects import AuditLimits
from ...fabrication.model import Model
from ...kernel.analysis import angle_summary
from ...kernel.beams.beams import Beams
from ...kernel.meshes.mesh import mean_edge_length
from ...kernel.panels import congruent
from ...kernel.panels import mould_blanks as blanks
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding, findings_report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ...kernel.tolerances import SAME_PANEL
from ..graphs.node import node, warn
from ..graphs.ports import Port, Units
from .arrays import PanelLabels

Length = Annotated[float, Port(min=0)]
Millimeters = Annotated[float, Port(unit="mm", min=0)]
Degrees = Annotated[float, Port(unit="deg", min=0, max=180)]


class IdenticalPanels(NamedTuple):
    """Panels gathered by shape."""

    labels: PanelLabels
    report: Mapping[str, Any]


class Audit(NamedTuple):
    """What an audit found."""

    findings: tuple[Finding, ...]
    report: Mapping[str, Any]


@node
def identical_panels(
    panels: Panels, tolerance: Annotated[float, Port(min=0)] = SAME_PANEL
) -> IdenticalPanels:
    """
    Find panels that are the same up to a rigid motion and can share blanks and patterns.

    Parameters
    ----------
    panels : Panels
        The panels.
    tolerance : float
        How far corners and edges of one shape may lie apart, in mean edges.

    Returns
    -------
    labels : (P,) int array
        Shape of each panel, from 0. Mirror images and panels of different moulds differ.
    report : mapping
        ``shapes`` (number), ``panels_per_shape``, ``first`` (id of the first panel of each)
        and ``largest_miss`` in model units.
    """
    same = congruent.congruent_panels(panels, tolerance)
    report: dict[str, Any] = {
        "shapes": len(same.representatives),
        "panels_per_shape": np.bincount(same.labels).tolist(),
        "first": [panels.ids[i] for i in same.representatives.tolist()],
        "largest_miss": float(same.misses.max(initial=0.0)),
    }
    return IdenticalPanels(same.labels, report)


@node
def mould_blanks(panels: Panels, size_step: Length = 0.0) -> Mapping[str, Any]:
    """
    Count the blanks that every mould must give, and how large they are.

    Parameters
    ----------
    panels : Panels
        The panels, with moulds.
    size_step : float
        Blanks come in diameters that are multiples of this length, in model units; 0 for one
        size per mould, that of its largest panel.

    Returns
    -------
    mapping
        ``blanks``: rows of ``mould`` (from 1), ``radius`` (None for a flat mould),
        ``diameter`` (of the rim, as a chord), ``sagitta``, ``opening_deg``, ``count`` and
        ``shapes`` (different panels among them), lengths in model units; ``without_mould``:
        number of panels that belong to none.
    """
    found = blanks.mould_blanks(panels, congruent.congruent_panels(panels), size_step)
    without = int((panels.labels < 0).sum())
    if without:
        warn(f"{without} of {panels.n_panels} panels belong to no mould and count no blank")
    rows = [
        {
            "mould": int(found.labels[i]) + 1,
            "radius": float(found.radii[i]) if np.isfinite(found.radii[i]) else None,
            "diameter": float(found.diameters[i]),
            "sagitta": float(found.sagittas[i]),
            "opening_deg": float(np.degrees(found.openings[i])),
            "count": int(found.counts[i]),
            "shapes": int(found.shapes[i]),
        }
        for i in range(len(found.labels))
    ]
    return {"blanks": rows, "without_mould": without}


@node
def audit(  # noqa: PLR0913, PLR0917 - whatever may trouble a workshop
    panels: Panels | None = None,
    cut: Mapping[str, Any] | None = None,
    min_corner: Degrees = 15.0,
    min_edge: Millimeters = 20.0,
    max_wall_tilt: Degrees = 30.0,
    max_step: Millimeters = 5.0,
    max_blank: Millimeters | None = None,
    units: Units = "m",
    beams: Beams | None = None,
    annuli_report: Mapping[str, Any] | None = None,
    beams_report: Mapping[str, Any] | None = None,
    max_twist: Degrees = 1.0,
    max_length: Millimeters | None = None,
) -> Audit:
    """
    Look for whatever would trouble a workshop, as numbered errors and notes.

    Parameters
    ----------
    panels : Panels, optional
        The panels.
    cut : mapping, optional
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
        Model units.
    beams : Beams, optional
        The beams.
    annuli_report, beams_report : mapping, optional
        Reports of the nodes `annulus_support` and `beams`: what they rejected is among the
        errors then.
    max_twist : float
        Largest angle between a beam and a node axis.
    max_length : float, optional
        Longest piece that can be cut for a beam.

    Returns
    -------
    findings : tuple of Finding
        Code, id, message, size and severity of each.
    report : mapping
        ``counts`` by code, ``errors`` and ``notes``.
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
        for part in (report or {}).get("rejected", ())
    ]
    findings = audit_model(Model(panels, beams, units), limits, rejected)
    return Audit(findings, findings_report(findings))


@node
def panel_report(  # noqa: PLR0913, PLR0917 - a report of every step
    sphere_mesh: SphereMesh,
    optimum: Mapping[str, Any],
    cut: Mapping[str, Any],
    moulds: Mapping[str, Any] | None = None,
    blanks: Mapping[str, Any] | None = None,
    audit: Mapping[str, Any] | None = None,
    nodes: Mapping[str, Any] | None = None,
    annuli: Mapping[str, Any] | None = None,
    beams: Mapping[str, Any] | None = None,
    landing: Mapping[str, Any] | None = None,
    units: Units = "m",
) -> Mapping[str, Any]:
    """
    Gather the reports of a panelling into one.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        What the panels were cut from.
    optimum : mapping
        Report of `minimize_angles` or `optimize_spheres`.
    cut : mapping
        Report of `panels`.
    moulds : mapping, optional
        Report of `cluster_radii`.
    blanks : mapping, optional
        Result of `mould_blanks`.
    audit : mapping, optional
        Report of `audit`.
    nodes : mapping, optional
        Report of `support_structure`.
    annuli : mapping, optional
        Report of `annulus_support`.
    beams : mapping, optional
        Report of `beams`.
    landing : mapping, optional
        Report of `land_nodes`.
    units : str
        Model units.

    Returns
    -------
    mapping
        ``input`` (vertices, faces, units), ``angles_deg`` (planar, spherical; with moulds
        ``unclustered`` as well, and spherical is what is built), ``vertex_error`` and
        ``edge_gap`` (max, relative_to_edge), ``thickness``, ``moulds`` (count, radii,
        panels_per_mould, blanks), ``support`` (torsion_deg_max of inner nodes,
        beam_tilt_deg_p95 of inner edges, beam_tilt_deg_max of annuli made, landed; None without
        one), ``panels`` and ``beams`` (written, rejected) and ``audit``.
    """
    mesh = sphere_mesh.mesh
    angles = {**optimum["angles_deg"], "spherical": angle_summary(sphere_mesh)}
    found: dict[str, Any] = {"count": 0, "radii": [], "panels_per_mould": []}
    if moulds is not None:
        # What is built counts as spherical; what the moulds cost is there to compare.
        angles["unclustered"] = optimum["angles_deg"]["spherical"]
        found = {name: moulds[name] for name in found}
    miss = float(vertex_error(sphere_mesh).max())
    return {
        "input": {"vertices": mesh.n_vertices, "faces": mesh.n_faces, "units": units},
        "angles_deg": angles,
        "vertex_error": {"max": miss, "relative_to_edge": miss / mean_edge_length(mesh)},
        "edge_gap": dict(cut["edge_gap"]),
        "thickness": dict(cut["thickness"]),
        "moulds": found | {"blanks": list(blanks["blanks"]) if blanks else []},
        "support": nodes
        and {
            "torsion_deg_max": nodes["torsion_deg"]["max"],
            "beam_tilt_deg_p95": nodes["beam_tilt_deg"]["p95"],
            "beam_tilt_deg_max": (annuli["tilt_deg"] if annuli else nodes["beam_tilt_deg"])[
                "max"
            ],
            "landed": bool(landing and landing["landed"]),
        },
        "panels": {"written": cut["written"], "rejected": list(cut["rejected"])},
        "beams": {
            "written": beams["written"] if beams else 0,
            "rejected": [
                entry for found in (annuli, beams) if found for entry in found["rejected"]
            ],
        },
        "audit": dict(audit) if audit is not None else None,
    }
