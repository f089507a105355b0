"""The main job as a graph: a mesh in, spherical panels out."""

from collections.abc import Mapping
from typing import Final

from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.wires import Param, Step, Wire
from .options import PanelOptions, fineness, model_units

_LAYERS: Final = {"constant": "offset", "power": "power"}
"""Port of `panels` by option: --layer names a layer of the input."""


def panel_graph(options: PanelOptions) -> Graph:
    """The graph of the main job.

    Parameters
    ----------
    options : PanelOptions
        What is asked for.

    Returns
    -------
    Graph
        Its steps are named mesh, description, start, angles (before an optimum of more than
        angles), optimum, panels, audit, report, step, rhino, table, list and picture; with a
        number of moulds also moulds, blanks, mould_drawing and mould_picture, with a support
        landing (without moulds or a tolerance), nodes, annuli, beams, drawing and beam_table.
        Its writers write relative to the folder of the run.

    Raises
    ------
    GraphError
        If an option is out of range.
    InputError
        If the units of the file are to be used and it cannot be read.
    """
    graph = Graph(
        options.mesh.stem if options.mesh else "roof",
        units=options.units or model_units(options)[0],
    )
    thickness = graph.param("thickness", options.thickness, min=0)
    joint_gap = graph.param("joint_gap", options.joint_gap, min=0)
    mesh = _mesh(graph, options)
    graph.add("mesh_report", "description", mesh=mesh)
    moves: dict[str, Param] = {}
    if options.tolerance:
        moves = {"tolerance": graph.param("tolerance", options.tolerance, min=0)}
    optimum = _optimum(graph, options, mesh, moves)
    spheres, labels, clusters, blanks = optimum.sphere_mesh, None, None, None
    landing = None
    if options.support and options.tolerance is None and options.moulds is None:
        landed = graph.add("land_nodes", "landing", sphere_mesh=spheres)
        spheres, landing = landed.sphere_mesh, landed.report
    if options.moulds is not None:
        count = graph.param("moulds", options.moulds, min=1)
        moulds = graph.add(
            "cluster_radii", "moulds", sphere_mesh=spheres, k=count, **moves,
            **_support_weights(options),
        )  # fmt: skip
        spheres, labels, clusters = moulds.sphere_mesh, moulds.labels, moulds.report
    panels = graph.add(
        "panels", "panels", sphere_mesh=spheres, thickness=thickness, joint_gap=joint_gap,
        edges=options.edges or ("intersection" if options.support else "bisector"),
        labels=labels, side=options.side, layer=_LAYERS[options.offset],
    )  # fmt: skip
    if options.moulds is not None:
        blanks = graph.add("mould_blanks", "blanks", panels=panels.panels)
        for name, path in (("mould_drawing", "moulds.dxf"), ("mould_picture", "moulds.svg")):
            graph.add("write_mould_drawings", name, panels=panels.panels, path=path)
    structure = _beams(graph, options, spheres) if options.support else {}
    carried: dict[str, Wire] = {}
    if structure:
        carried = {
            "beams": structure["beams"].beams,
            "annuli_report": structure["annuli"].report,
            "beams_report": structure["beams"].report,
        }
    audit = graph.add("audit", "audit", panels=panels.panels, cut=panels.report, **carried)
    graph.add(
        "panel_report", "report", sphere_mesh=spheres, optimum=optimum.report,
        cut=panels.report, moulds=clusters, blanks=blanks, audit=audit.report, landing=landing,
        **{name: step.report for name, step in structure.items()},
    )  # fmt: skip
    made = {"panels": panels.panels}
    if structure:
        made["beams"] = structure["beams"].beams
    graph.add("write_step", "step", **made, path="panels.step")
    graph.add("write_3dm", "rhino", **made, path="model.3dm", reference=mesh)
    graph.add("write_schedule", "table", panels=panels.panels, path="schedule.csv")
    graph.add("write_schedule", "list", **made, path="schedule.json")
    graph.add("render", "picture", panels=panels.panels, path="preview.png")
    return graph


def _mesh(graph: Graph, options: PanelOptions) -> Step | Wire:
    """The mesh: of a file, repaired or as it is, or for a demonstration."""
    if options.mesh is None:
        return graph.add("roof_mesh", "mesh")
    path = str(options.mesh.resolve())
    rows = fineness(options)
    if options.repair:
        return graph.add("repair_mesh", "mesh", mesh=path, layer=options.layer, **rows).mesh
    return graph.add("read_mesh", "mesh", path=path, layer=options.layer, **rows)


def _optimum(
    graph: Graph, options: PanelOptions, mesh: Step | Wire, moves: Mapping[str, Param]
) -> Step:
    """The spheres: of smallest angles alone, or of more than that."""
    start = graph.add("fit_spheres", "start", mesh=mesh)
    target = {"target_angle": options.target_angle} if options.target_angle else {}
    if not (options.support or moves):
        allowed = {} if options.tolerance is None else {"max_miss": options.tolerance}
        return graph.add("minimize_angles", "optimum", sphere_mesh=start, **target, **allowed)
    angles = graph.add("minimize_angles", "angles", sphere_mesh=start, **target)
    return graph.add(
        "optimize_spheres", "optimum", sphere_mesh=angles.sphere_mesh, **target, **moves,
        **_support_weights(options),
    )  # fmt: skip


def _support_weights(options: PanelOptions) -> dict[str, float]:
    """The paper's weights (Table 1)."""
    return {"regularity": 3.5, "support": 1.0} if options.support else {}


def _beams(graph: Graph, options: PanelOptions, spheres: Wire) -> dict[str, Step]:
    """Nodes, annuli and beams; their drawing and schedule are written as well."""
    nodes = graph.add("support_structure", "nodes", sphere_mesh=spheres)
    depth = (
        {} if options.depth is None else {"depth": graph.param("depth", options.depth, min=0)}
    )
    annuli = graph.add("annulus_support", "annuli", sphere_mesh=spheres, **depth)
    thickness = {}
    if options.beam_thickness is not None:
        value = graph.param("beam_thickness", options.beam_thickness, min=0)
        thickness = {"thickness": value}
    cylinders = {}
    if options.node_radius:
        cylinders = {"node_radius": graph.param("node_radius", options.node_radius, min=0)}
    beams = graph.add("beams", "beams", annuli=annuli.annuli, **thickness, **cylinders)
    graph.add("write_dxf", "drawing", beams=beams.beams, path="beams.dxf")
    graph.add("write_schedule", "beam_table", beams=beams.beams, path="beams.csv")
    return {"nodes": nodes, "annuli": annuli, "beams": beams}
