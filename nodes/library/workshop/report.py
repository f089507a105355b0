"""The report of a panelling."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ....fabrication.costs.cost import CostReport
from ....fabrication.sizes import model_extents
from ....kernel.analysis import angle_summary
from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ....kernel.support.annulus_construction import AnnuliReport
from ....kernel.support.beam_supports import SupportReport
from ....kernel.support.feasibility import FeasibilityReport
from ....kernel.support.node_axes import NodesReport
from ...graphs.node import node
from ...graphs.ports import Units
from ..cluster import BlanksReport, MouldsReport
from ..fabricate import CutReport
from ..optimise.outcomes import OptimumReport
from ..support.beams import BeamsReport
from ..support.exact import ExactSupportReport
from ..support.structure import LandingReport
from .audit import AuditReport
from .losses import warn_of_losses, warn_of_side, warn_of_support


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
        ``kind`` and the one ``asked`` for, ``torsion_deg_max`` of nodes,
        ``beam_tilt_deg_p95`` of inner edges, ``beam_tilt_deg_max`` of annuli made,
        ``landed``, and ``feasibility`` as in `FeasibilityReport`; of beams in the walls of
        panels also ``gap``, ``lean_deg_max`` and the least ``node_radius``.
    panels, beams : dict
        ``written`` and ``rejected``.
    audit : dict or None
        As in `AuditReport`.
    design_move : dict
        How far vertices moved off the design: ``max`` in model units and
        ``relative_to_edge``; for exact supports also the largest ``height`` off the surface
        and ``slide`` in it, in mean edges.
    cost : dict or None
        As in `CostReport`.
    buildable : bool
        Whether no panel or beam is rejected and the audit, if there is one, has no errors.
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
    design_move: dict[str, float]
    cost: dict[str, Any] | None
    buildable: bool


@node(version="3")
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
    feasibility: FeasibilityReport | None = None,
    support: Literal["axis", "exact", "bisector"] | None = None,
    plain: CutReport | None = None,
    cost: CostReport | None = None,
) -> PanellingReport:
    """Gather the reports of a panelling into one.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        What the panels were cut from.
    optimum : OptimumReport
        Report of `minimize_angles`, `optimize_spheres` or `exact_support`.
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
        Report of `annulus_support`, `axis_support` or `bisector_support`.
    beams : BeamsReport, optional
        Report of `beams`.
    landing : LandingReport, optional
        Report of `land_nodes`.
    units : str
    feasibility : FeasibilityReport, optional
        Result of `support_feasibility`.
    support : {"axis", "exact", "bisector"}, optional
        The kind of support that was asked for.
    plain : CutReport, optional
        Report of panels as they would be without moulds and support, to say what these cost.
    cost : CostReport, optional
        Result of `cost`.

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
    warn_of_losses(angles, cut, plain, annuli, support)
    if annuli is not None:
        warn_of_side(mesh)
    made_beams = {
        "written": beams["written"] if beams else 0,
        "rejected": [
            entry for found in (annuli, beams) if found for entry in found["rejected"]
        ],
    }
    is_whole = not (cut["rejected"] or made_beams["rejected"])
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
        support=_support(optimum, nodes, annuli, landing, feasibility, support),
        panels={"written": cut["written"], "rejected": list(cut["rejected"])},
        beams=made_beams,
        audit=dict(audit) if audit is not None else None,
        design_move=_design_move(optimum, moulds, mean_edge_length(mesh)),
        cost=dict(cost) if cost is not None else None,
        buildable=is_whole and not (audit and audit["errors"]),
    )


def _built(
    sphere_mesh: SphereMesh, optimum: OptimumReport
) -> tuple[dict[str, dict[str, float]], dict[str, Any]]:
    """Angles and creases of an optimum, as they are built."""
    creases: dict[str, Any] = optimum.get("creases") or {"angle_deg": 180.0, "edges": []}
    is_crease = np.zeros(len(sphere_mesh.mesh.topology.edge_corners), bool)
    is_crease[creases["edges"]] = True
    sharp = angle_summary(sphere_mesh, is_crease)
    return (
        {**optimum["angles_deg"], "spherical": angle_summary(sphere_mesh, ~is_crease)},
        {
            **creases,
            "count": len(creases["edges"]),
            "mean_deg": sharp["mean"],
            "max_deg": sharp["max"],
        },
    )


def _design_move(
    optimum: OptimumReport, moulds: MouldsReport | None, edge: float
) -> dict[str, float]:
    """How far vertices moved in all: at most what optimum and moulds did one by one."""
    moved = moulds["vertex_move"] if moulds is not None else 0.0
    if isinstance(optimum, ExactSupportReport):
        found = optimum.design_move
        total = found["relative_to_edge"] + moved
        return found | {"relative_to_edge": total, "max": found["max"] + moved * edge}
    total = moved + float(optimum.get("vertex_move", 0.0))
    return {"max": total * edge, "relative_to_edge": total}


def _support(
    optimum: OptimumReport,
    nodes: NodesReport | None,
    annuli: AnnuliReport | None,
    landing: LandingReport | None,
    feasibility: FeasibilityReport | None,
    asked: str | None,
) -> dict[str, Any] | None:
    """What a user must know of the support; None if there is none."""
    landed = landing is not None and landing["landed"]
    common = {
        "landed": landed or (isinstance(optimum, ExactSupportReport) and optimum.landed),
        "feasibility": dict(feasibility) if feasibility else None,
    }
    if isinstance(annuli, SupportReport):
        warn_of_support(annuli, feasibility, asked)
        return {
            "kind": "exact" if asked == "exact" else annuli.kind,
            "asked": asked or annuli.kind,
            "torsion_deg_max": annuli.torsion_deg["max"],
            "beam_tilt_deg_p95": annuli.inner_tilt_deg["p95"],
            "beam_tilt_deg_max": annuli.tilt_deg["max"],
            "gap": annuli.gap,
            "lean_deg_max": annuli.lean_deg["max"],
            "node_radius": annuli.node_radius,
            **common,
        }
    if nodes is None:
        return None
    return {
        "kind": asked or "exact",
        "asked": asked or "exact",
        "torsion_deg_max": nodes["torsion_deg"]["max"],
        "beam_tilt_deg_p95": nodes["beam_tilt_deg"]["p95"],
        "beam_tilt_deg_max": (annuli["tilt_deg"] if annuli else nodes["beam_tilt_deg"])["max"],
        **common,
    }
