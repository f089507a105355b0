"""The report of a panelling."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ....fabrication.sizes import model_extents
from ....kernel.analysis import angle_summary
from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ....kernel.support.annulus_construction import AnnuliReport
from ....kernel.support.node_axes import NodesReport
from ...graphs.node import node
from ...graphs.ports import Units
from ..cluster import BlanksReport, MouldsReport
from ..fabricate import CutReport
from ..outcomes import OptimumReport
from ..support.beams import BeamsReport
from ..support.structure import LandingReport
from .audit import AuditReport


@dataclass(frozen=True, eq=False)
class PanellingReport(Report):
    """The reports of a panelling in one.

    Attributes
    ----------
    input : dict
        ``vertices``, ``faces``, ``units``, ``size`` along x, y and z, and ``mean_edge``.
    angles_deg : dict
        ``planar`` and ``spherical`` (what is built), and with moulds ``unclustered``; over the
        edges that are no crease.
    creases : dict
        Edges that stay sharp, as in `AnglesReport`.
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
    creases: dict[str, Any]
    vertex_error: dict[str, float]
    edge_gap: dict[str, float]
    thickness: dict[str, float]
    moulds: dict[str, Any]
    support: dict[str, Any] | None
    panels: dict[str, Any]
    beams: dict[str, Any]
    audit: dict[str, Any] | None


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
    angles, creases = _built(sphere_mesh, optimum)
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
        creases=creases,
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


def _built(
    sphere_mesh: SphereMesh, optimum: OptimumReport
) -> tuple[dict[str, dict[str, float]], dict[str, Any]]:
    """Angles and creases of an optimum, as they are built."""
    is_crease = np.zeros(len(sphere_mesh.mesh.topology.edge_corners), bool)
    is_crease[optimum["creases"]["edges"]] = True
    sharp = angle_summary(sphere_mesh, is_crease)
    return (
        {**optimum["angles_deg"], "spherical": angle_summary(sphere_mesh, ~is_crease)},
        {**optimum["creases"], "mean_deg": sharp["mean"], "max_deg": sharp["max"]},
    )
