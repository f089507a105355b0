"""The main job as a graph: a mesh in, spherical panels out."""

from collections.abc import Mapping
from typing import Any, Final

from ...kernel.support.beam_supports import own_spheres
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.wires import Param, Step, Wire
from ...nodes.graphs.stores.entries import Store
from .options import PanelOptions, SupportKind, fineness, model_units
from .papers import add_papers
from .pattern import add_pattern
from .support import add_annuli, add_beams

_LAYERS: Final = {"constant": "offset", "power": "power"}
"""Port of `panels` by option: --layer names a layer of the input."""


def feasible_panel_graph(options: PanelOptions, store: Store | None = None) -> Graph:
    """The graph of the main job, as the mesh allows it.

    A support on node axes keeps spheres that the mesh has already if their nodes are exact;
    where no beams on node axes can stand, they are upright. Both are found before anything is
    optimised, with results of the store if there is one.
    """
    graph = panel_graph(options)
    store = graph.cache = store or graph.cache
    if options.pattern != "as-is":
        return _feasible_pattern_graph(graph, options, store)
    if options.support != "axis":
        return graph
    may_keep = not (options.target_angle or options.tolerance)
    if may_keep and own_spheres(graph.run(_source(graph))) is not None:
        graph = panel_graph(options, keeps_spheres=True)
    elif graph.run("feasibility")["verdict"] == "no":
        graph = panel_graph(options, "bisector")
    graph.cache = store
    return graph


def _feasible_pattern_graph(graph: Graph, options: PanelOptions, store: Store) -> Graph:
    """The graph of a pattern: a usable net keeps its spheres, a round one has upright beams."""
    status = graph.run("pattern.report")["status"]
    may_keep = options.support != "exact" and not (options.target_angle or options.tolerance)
    # Triangles have spheres of smallest angles already, but no nodes to keep.
    may_keep = may_keep and options.pattern != "triangles"
    if status == "usable" and may_keep:
        graph = panel_graph(options, keeps_spheres=True)
    elif options.support == "axis" and (
        status == "not planarised" or graph.run("feasibility")["verdict"] == "no"
    ):
        graph = panel_graph(options, "bisector")
    graph.cache = store
    return graph


def panel_graph(
    options: PanelOptions, beams: SupportKind | None = None, *, keeps_spheres: bool = False
) -> Graph:
    """The graph of the main job.

    Parameters
    ----------
    options : PanelOptions
        What is asked for.
    beams : {"axis", "exact", "bisector"}, optional
        The kind of support that is made; by default that which is asked for.
    keeps_spheres : bool
        Whether the spheres of the mesh stay as they are.

    Returns
    -------
    Graph
        Its steps are named mesh, description, start, angles (before an optimum of more than
        angles), optimum, panels, audit, report, step, rhino, table, list, picture and view;
        with a number of moulds also moulds, blanks, mould_drawing and mould_picture, with a
        bound on angles before these fewest, with `flat_below` flat, with prices cost, with
        `ifc` ifc, with a
        support also feasibility, annuli, beams, drawing and beam_table, with either plain, the
        panels without them; tables and drawing sets if asked for. Of a pattern mesh is the
        surface; gain, pattern and net follow it. Its writers write relative to the folder of
        the run.

    Raises
    ------
    GraphError
        If an option is out of range.
    InputError
        If the units of the file are to be used and it cannot be read.
    """
    # Names of files may be no text; what shows them is.
    title = options.mesh.stem.encode(errors="replace").decode() if options.mesh else "roof"
    graph = Graph(title, units=options.units or model_units(options)[0])
    thickness = graph.param("thickness", options.thickness, min=0)
    joint_gap = graph.param("joint_gap", options.joint_gap, min=0)
    pattern = add_pattern(graph, options) if options.pattern != "as-is" else None
    mesh = pattern.mesh if pattern else _mesh(graph, options)
    graph.add("mesh_report", "description", mesh=mesh)
    moves: dict[str, Param] = {}
    if options.tolerance:
        moves = {"tolerance": graph.param("tolerance", options.tolerance, min=0)}
    crease = graph.param("crease", options.crease, min=0, max=180)
    if keeps_spheres:
        net = pattern.net if pattern else graph.add("fit_spheres", "start", mesh=mesh, ring=0)
        optimum = graph.add("keep_spheres", "optimum", sphere_mesh=net, crease=crease)
    else:
        optimum = _optimum(graph, options, mesh, moves, crease)
    design = optimum.sphere_mesh
    spheres, labels, clusters = _few_radii(graph, options, design, moves, crease)
    kind = beams or options.support
    layers: dict[str, Any] = {
        "thickness": thickness, "joint_gap": joint_gap, "side": options.side,
        "layer": _LAYERS[options.offset], "crease": crease,
    }  # fmt: skip
    annuli = add_annuli(graph, options, kind, spheres, design, layers) if kind else None
    cut = annuli.cut if annuli else {"edges": options.edges or "bisector"}
    panels = graph.add(
        "panels", "panels", sphere_mesh=spheres, labels=labels, **{**layers, **cut}
    )
    support = add_beams(graph, options, annuli, panels.panels) if annuli else None
    plain = _plain(graph, design, layers) if support or spheres is not design else {}
    blanks = _add_blanks(graph, panels.panels) if clusters else None
    audit = graph.add(
        "audit", "audit", panels=panels.panels, cut=panels.report,
        max_step=options.allow_step, max_gap=options.allow_gap,
        max_twist=options.allow_torsion, **(support.audit if support else {}),
    )  # fmt: skip
    made = {"panels": panels.panels} | ({"beams": support.beams} if support else {})
    cost = _cost(graph, options, made)
    report = graph.add(
        "panel_report", "report", sphere_mesh=spheres, optimum=optimum.report,
        cut=panels.report, moulds=clusters, blanks=blanks, audit=audit.report, **plain, **cost,
        **(support.report if support else {}),
    )  # fmt: skip
    checked = {"findings": audit.findings, "cut": panels.report}
    _add_writers(graph, pattern.surface if pattern else mesh, made, checked)
    if options.ifc:
        graph.add("write_ifc", "ifc", **made, path="model.ifc", title=title)
    if moves:
        _add_moves(graph, mesh, spheres)
    add_papers(graph, options, made, has_moulds=clusters is not None)
    _add_pages(graph, options, made, checked, spheres, report)
    return graph


def _cost(graph: Graph, options: PanelOptions, made: Mapping[str, Wire]) -> dict[str, Step]:
    """What it costs, by the prices of a workshop."""
    if options.prices is None:
        return {}
    return {"cost": graph.add("cost", "cost", **made, prices=str(options.prices.resolve()))}


def _add_pages(
    graph: Graph,
    options: PanelOptions,
    made: Mapping[str, Wire],
    checked: Mapping[str, Wire],
    spheres: Wire,
    report: Step | Wire,
) -> None:
    """Pages for browsers: the model to turn, and what there is to say of it."""
    title = graph.title
    shown = {**checked, "reference": spheres}
    graph.add("write_view", "view", **made, **shown, path="view.html", title=title)
    sheets: dict[str, Step] = {}
    if options.nest and "beams" in made:
        # As in beams.dxf.
        sheets["sheets"] = graph.add(
            "nest_parts", "sheets", beams=made["beams"], kerf=10.0, margin=10.0, grain="along"
        )
    graph.add(
        "write_report", "summary", report=report, panels=made["panels"], sphere_mesh=spheres,
        path="report.html", title=title, **sheets,
    )  # fmt: skip


def _few_radii(
    graph: Graph, options: PanelOptions, spheres: Wire, moves: Mapping[str, Param],
    crease: Param,
) -> tuple[Wire, Wire | None, Wire | None]:  # fmt: skip
    """Spheres that are flat or of few radii where asked for, with their labels and report."""
    if options.flat_below:
        bound = graph.param("flat_below", options.flat_below, min=0)
        spheres = graph.add(
            "flat_panels", "flat", sphere_mesh=spheres, flat_below=bound, crease=crease
        ).sphere_mesh
    count = _mould_count(graph, options, spheres, crease)
    if count is None:
        return spheres, None, None
    # Vertices that move make angles smaller in the mean, and may make the largest larger.
    relaxed: Mapping[str, Param] = moves if options.max_angle_largest is None else {}
    moulds = graph.add(
        "cluster_radii", "moulds", sphere_mesh=spheres, k=count, crease=crease, **relaxed
    )
    return moulds.sphere_mesh, moulds.labels, moulds.report


def _mould_count(
    graph: Graph, options: PanelOptions, spheres: Wire, crease: Param
) -> Param | Wire | None:
    """How many moulds: as asked for, the fewest that keep angles below bounds, or any."""
    if options.moulds is not None:
        return graph.param("moulds", options.moulds, min=1)
    bounds = {
        name: graph.param(name, bound, min=0, max=180)
        for name in ("max_angle", "max_angle_largest")
        if (bound := getattr(options, name)) is not None
    }
    if not bounds:
        return None
    return graph.add("fewest_moulds", "fewest", sphere_mesh=spheres, crease=crease, **bounds).k


def _add_blanks(graph: Graph, panels: Wire) -> Step:
    """Blanks of the moulds, and their drawings."""
    for name, path in (("mould_drawing", "moulds.dxf"), ("mould_picture", "moulds.svg")):
        graph.add("write_mould_drawings", name, panels=panels, path=path)
    return graph.add("mould_blanks", "blanks", panels=panels)


def _add_writers(
    graph: Graph,
    mesh: Step | Wire,
    made: Mapping[str, Wire],
    checked: Mapping[str, Wire],
) -> None:
    """Files of the parts; those of moulds and beams stand beside what they show."""
    panels = made["panels"]
    graph.add("write_step", "step", **made, path="panels.step")
    graph.add("write_3dm", "rhino", **made, **checked, path="model.3dm", reference=mesh)
    graph.add("write_schedule", "table", panels=panels, path="schedule.csv")
    graph.add("write_schedule", "list", **made, path="schedule.json")
    graph.add("render", "picture", **made, path="preview.png")


def _add_moves(graph: Graph, mesh: Step | Wire, spheres: Wire) -> None:
    """The design, with how far its vertices moved."""
    graph.add("write_move_drawing", "moves", mesh=mesh, sphere_mesh=spheres, path="moves.svg")


def _source(graph: Graph) -> str:
    """Name of the output that is the mesh: of the file, or repaired."""
    return "mesh.mesh" if graph.steps["mesh"].node.name == "repair_mesh" else "mesh"


def _plain(graph: Graph, design: Wire, layers: Mapping[str, Any]) -> dict[str, Wire]:
    """Panels as they would be without moulds and beams, to say what these cost."""
    return {"plain": graph.add("panels", "plain", sphere_mesh=design, **layers).report}


def _mesh(graph: Graph, options: PanelOptions) -> Step | Wire:
    """The mesh: of a file, repaired or as it is, or for a demonstration."""
    if options.mesh is None:
        return graph.add("roof_mesh", "mesh")
    path = str(options.mesh.resolve())
    rows = fineness(options)
    if options.repair:
        return graph.add("repair_mesh", "mesh", mesh=path, layer=options.layer, **rows).mesh
    return graph.add("read_mesh", "mesh", path=path, layer=options.layer, **rows)


def _exact(graph: Graph, options: PanelOptions, mesh: Step | Wire) -> Step:
    """The spheres of an exact support; for one mould with the same radius from the start."""
    bounds = {
        "max_height": graph.param("max_height", options.max_height, min=0),
        "max_slide": graph.param("max_slide", options.max_slide, min=0),
    }
    return graph.add(
        "exact_support", "optimum", mesh=mesh, one_radius=options.moulds == 1, **bounds
    )


def _optimum(
    graph: Graph, options: PanelOptions, mesh: Step | Wire, moves: Mapping[str, Param],
    crease: Param,
) -> Step:  # fmt: skip
    """The spheres: of smallest angles alone, or of more than that."""
    if options.support == "exact":
        return _exact(graph, options, mesh)
    start = graph.add("fit_spheres", "start", mesh=mesh)
    target: dict[str, Any] = {"crease": crease}
    if options.target_angle:
        target["target_angle"] = options.target_angle
    if not moves:
        allowed: dict[str, Any] = {}
        if options.tolerance is not None:
            allowed["max_miss"] = options.tolerance
        if options.target_angle:
            allowed["sides"] = "one"  # cushions to both sides can hardly be built
        return graph.add("minimize_angles", "optimum", sphere_mesh=start, **target, **allowed)
    angles = graph.add("minimize_angles", "angles", sphere_mesh=start, **target)
    return graph.add(
        "optimize_spheres", "optimum", sphere_mesh=angles.sphere_mesh, **target, **moves
    )
