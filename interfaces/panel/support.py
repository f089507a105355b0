"""The beams of the main job: which annuli, and what is made of them."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.wires import Step, Wire
from .options import PanelOptions, SupportKind


class AnnuliSteps(NamedTuple):
    """What a support does before panels are cut.

    Attributes
    ----------
    kind : {"axis", "exact", "bisector"}
    annuli : Step
    cut : dict
        Inputs of `panels`: how panels are cut.
    thickness : dict
        Thickness of the beams as an input, if it was given.
    feasibility : Step
    """

    kind: SupportKind
    annuli: Step
    cut: dict[str, Any]
    thickness: dict[str, Any]
    feasibility: Step


class SupportSteps(NamedTuple):
    """What a support adds to the main job.

    Attributes
    ----------
    beams : Wire
        The beams, for the writers.
    audit, report : dict
        Inputs of `audit` and `panel_report`.
    """

    beams: Wire
    audit: dict[str, Any]
    report: dict[str, Any]


def add_annuli(
    graph: Graph,
    options: PanelOptions,
    kind: SupportKind,
    spheres: Wire,
    design: Wire,
    layers: Mapping[str, Any],
) -> AnnuliSteps:
    """Add the annuli of a support to a graph.

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
    layers : mapping
        Thickness and joint of the panels, as inputs of `panels`.

    Returns
    -------
    AnnuliSteps
        What panels and beams need of them.
    """
    feasibility = graph.add("support_feasibility", "feasibility", sphere_mesh=design)
    depth: dict[str, Any] = {}
    if options.depth is not None:
        depth["depth"] = graph.param("depth", options.depth, min=0)
    thickness: dict[str, Any] = {}
    if options.beam_thickness is not None:
        thickness["thickness"] = graph.param("beam_thickness", options.beam_thickness, min=0)
    if kind == "bisector":
        annuli = graph.add(
            "bisector_support", "annuli", sphere_mesh=spheres, **depth, **thickness
        )
        cut: dict[str, Any] = {"edges": "bisector"}
    else:
        if kind == "exact":
            depth["axes"] = graph.add("common_axes", "axes", sphere_mesh=design)
        elif spheres is not design:
            # Moulds change the spheres: where those before have exact nodes, their axes count.
            axes = graph.add("node_axes", "axes", sphere_mesh=design)
            depth["axes"] = axes
        annuli = graph.add("axis_support", "annuli", sphere_mesh=spheres, **depth)
        cut = {"edges": "axis", "axes": annuli.axes}
    cut["joint_gap"] = graph.add(
        "least_joint", "joint", sphere_mesh=spheres, axes=annuli.axes, edges=cut["edges"],
        thickness=layers["thickness"], joint_gap=layers["joint_gap"],
    )  # fmt: skip
    return AnnuliSteps(kind, annuli, cut, thickness, feasibility)


def add_beams(
    graph: Graph, options: PanelOptions, support: AnnuliSteps, panels: Wire
) -> SupportSteps:
    """Add beams under the panels; their drawing and schedule are written as well.

    Parameters
    ----------
    graph : Graph
        The main job.
    options : PanelOptions
        Their sizes.
    support : AnnuliSteps
        Their annuli.
    panels : Wire
        The panels that rest on them.

    Returns
    -------
    SupportSteps
        What the other steps need of them.
    """
    annuli = support.annuli
    beams = _cut_beams(graph, options, support, panels)
    nesting = {"nesting": "rectangles"} if options.nest else {}
    graph.add("write_dxf", "drawing", beams=beams.beams, path="beams.dxf", **nesting)
    graph.add("write_schedule", "beam_table", beams=beams.beams, path="beams.csv")
    audit = {
        "beams": beams.beams, "annuli_report": annuli.report, "beams_report": beams.report,
    }  # fmt: skip
    report = {
        "annuli": annuli.report, "beams": beams.report, "feasibility": support.feasibility,
        "support": options.support,
    }  # fmt: skip
    return SupportSteps(beams.beams, audit, report)


def _cut_beams(graph: Graph, options: PanelOptions, support: AnnuliSteps, panels: Wire) -> Step:
    """Beams of annuli; upright ones miss the node axes and end at cylinders."""
    annuli, thickness = support.annuli.annuli, support.thickness
    sizes: dict[str, Any] = dict(thickness)
    if options.bearing:
        sizes["bearing"] = graph.param("bearing", options.bearing, min=0)
    if options.node_radius:
        sizes["node_radius"] = graph.param("node_radius", options.node_radius, min=0)
    elif support.kind == "bisector":
        sizes["node_radius"] = graph.add(
            "least_node_radius", "node_radius", annuli=annuli, panels=panels, **sizes
        )
    return graph.add("beams", "beams", annuli=annuli, panels=panels, **sizes)
