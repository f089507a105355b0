"""The beams of the main job: which annuli, and what is made of them."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from ...nodes.graphs.graph import Graph
from ...nodes.graphs.wires import Step, Wire
from .options import PanelOptions, SupportKind


class SupportSteps(NamedTuple):
    """What a support adds to the main job.

    Attributes
    ----------
    cut : dict
        Inputs of `panels`: how panels are cut.
    beams : Wire
        The beams, for the writers.
    audit, report : dict
        Inputs of `audit` and `panel_report`.
    """

    cut: dict[str, Any]
    beams: Wire
    audit: dict[str, Any]
    report: dict[str, Any]


def add_support(
    graph: Graph, options: PanelOptions, kind: SupportKind, spheres: Wire, design: Wire
) -> SupportSteps:
    """Add beams to a graph; their drawing and schedule are written as well.

    Parameters
    ----------
    graph : Graph
        The main job.
    options : PanelOptions
        With the kind of support that was asked for.
    kind : {"axis", "exact", "bisector"}
        The kind that is made.
    spheres : Wire
        What the panels are cut from.
    design : Wire
        The same before moulds.

    Returns
    -------
    SupportSteps
        What the other steps need of it.
    """
    feasibility = graph.add("support_feasibility", "feasibility", sphere_mesh=design)
    depth: dict[str, Any] = {}
    if options.depth is not None:
        depth["depth"] = graph.param("depth", options.depth, min=0)
    thickness: dict[str, Any] = {}
    if options.beam_thickness is not None:
        thickness["thickness"] = graph.param("beam_thickness", options.beam_thickness, min=0)
    if kind == "bisector":
        cut: dict[str, Any] = {"edges": "bisector"}
        annuli = graph.add(
            "bisector_support", "annuli", sphere_mesh=spheres, **depth, **thickness
        )
    else:
        if kind == "exact":
            depth["axes"] = graph.add("common_axes", "axes", sphere_mesh=design)
        elif spheres is not design:
            # Moulds change the spheres: where those before have exact nodes, their axes count.
            axes = graph.add("node_axes", "axes", sphere_mesh=design)
            depth["axes"] = axes
        annuli = graph.add("axis_support", "annuli", sphere_mesh=spheres, **depth)
        cut = {"edges": "axis", "axes": annuli.axes}
    beams = _add_beams(graph, options, kind, annuli, thickness)
    graph.add("write_dxf", "drawing", beams=beams.beams, path="beams.dxf")
    graph.add("write_schedule", "beam_table", beams=beams.beams, path="beams.csv")
    audit = {
        "beams": beams.beams, "annuli_report": annuli.report, "beams_report": beams.report,
    }  # fmt: skip
    report = {
        "annuli": annuli.report, "beams": beams.report, "feasibility": feasibility,
        "support": options.support,
    }  # fmt: skip
    return SupportSteps(cut, beams.beams, audit, report)


def _add_beams(
    graph: Graph,
    options: PanelOptions,
    kind: SupportKind,
    annuli: Step,
    thickness: Mapping[str, Any],
) -> Step:
    """Beams of annuli; upright ones miss the node axes and end at cylinders."""
    radius: dict[str, Any] = {}
    if options.node_radius:
        radius["node_radius"] = graph.param("node_radius", options.node_radius, min=0)
    elif kind == "bisector":
        radius["node_radius"] = graph.add(
            "least_node_radius", "node_radius", annuli=annuli.annuli, **thickness
        )
    return graph.add("beams", "beams", annuli=annuli.annuli, **thickness, **radius)
