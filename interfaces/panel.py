"""The main job: a mesh in, spherical panels out, as a graph that the user can open again."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final, Literal

from .. import __version__
from ..fabrication.mesh_files.reader import read_content
from ..fabrication.output_folder import REPORT, OutputFolder, output_folder
from ..kernel.errors import ConvergenceError, InputError
from ..nodes.graphs.files import FileUses, Folders, note_known_files
from ..nodes.graphs.graph import Graph
from ..nodes.graphs.wires import Param, Step, Wire

GRAPH: Final = "graph.json"
"""Name of the graph of a job beside its files."""

Progress = Callable[[str, str], None]

_LAYERS = {"constant": "offset", "power": "power"}
"""Port of `panels` by option: --layer names a layer of the input."""


@dataclass(frozen=True)
class PanelOptions:
    """What the main job is asked to do.

    Attributes
    ----------
    mesh : Path or None
        Mesh file; the demo roof if None.
    layer : str
        Layers or groups of the file to use, several with commas.
    repair : bool
        Whether to repair the mesh first.
    edge_length : float or None
        Length of the edges of faces on surfaces, in model units.
    rows : (int, int) or None
        Rows of faces along u and v of each surface; neither: as `read_mesh` has it.
    units : str or None
        Model units; None for those of the file, and metres if it names none.
    moulds : int or None
        Number of moulds; None for a radius per panel.
    thickness, joint_gap : float
        In model units.
    side : {"inward", "outward", "centred"}
        Where the thickness goes from the spheres.
    offset : {"constant", "power"}
        Whether the thickness is the same everywhere, or the difference of squared radii.
    edges : {"bisector", "intersection"} or None
        How panels are cut; by default where the spheres meet if there is a support, else
        upright.
    tolerance : float or None
        How far vertices may move, in mean edges; at 0 the faces have to lie on circles, and by
        default they need not.
    target_angle : float
        Angle at which neighbours shall meet, in degrees.
    support : bool
        Whether to ask for nodes without torsion, and to write beams.
    depth, beam_thickness : float or None
        Of the beams, in model units; by default a quarter of the mean edge, and a tenth of the
        depth.
    node_radius : float
        Radius of the node cylinders, in model units; 0 for mitred beams.
    """

    mesh: Path | None = None
    layer: str = ""
    repair: bool = False
    edge_length: float | None = None
    rows: tuple[int, int] | None = None
    units: str | None = None
    moulds: int | None = None
    thickness: float = 0.0
    joint_gap: float = 0.0
    side: Literal["inward", "outward", "centred"] = "inward"
    offset: Literal["constant", "power"] = "constant"
    edges: Literal["bisector", "intersection"] | None = None
    tolerance: float | None = None
    target_angle: float = 0.0
    support: bool = False
    depth: float | None = None
    beam_thickness: float | None = None
    node_radius: float = 0.0


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


def model_units(options: PanelOptions) -> tuple[str, bool]:
    """Model units of a job, and whether they are assumed: neither given nor in the file.

    Raises
    ------
    InputError
        If the file cannot be read, or has other units than asked for.
    """
    found = ""
    if options.mesh is not None and options.mesh.suffix.lower() == ".3dm":
        path = options.mesh.resolve()
        found = read_content(path, options.layer, **_fineness(options)).units
    if options.units and found not in ("", options.units):
        raise InputError(
            f"{options.mesh} is drawn in {found}, which contradicts --units {options.units}; "
            "leave that out, or change the units in Rhino (Units) and save"
        )
    units = options.units or found
    return units or "m", options.mesh is not None and not units


def _mesh(graph: Graph, options: PanelOptions) -> Step | Wire:
    """The mesh: of a file, repaired or as it is, or for a demonstration."""
    if options.mesh is None:
        return graph.add("roof_mesh", "mesh")
    path = str(options.mesh.resolve())
    rows = _fineness(options)
    if options.repair:
        return graph.add("repair_mesh", "mesh", mesh=path, layer=options.layer, **rows).mesh
    return graph.add("read_mesh", "mesh", path=path, layer=options.layer, **rows)


def _fineness(options: PanelOptions) -> dict[str, Any]:
    """How finely surfaces are divided."""
    if options.edge_length is not None:
        return {"edge_length": options.edge_length}
    return dict(zip(("n_u", "n_v"), options.rows or (), strict=False))


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


def is_panel_job(graph: Graph) -> bool:
    """Whether a graph is the main job, perhaps with other values and further steps.

    Returns
    -------
    bool
        Whether it has the steps that the report is made of.
    """
    steps = {name: step.node.name for name, step in graph.steps.items()}
    needed = {"panels": "panels", "report": "panel_report"}
    return "mesh" in steps and needed.items() <= steps.items()


def run_job(
    graph: Graph,
    folder: Path,
    progress: Progress,
    *,
    graph_file: Path | None = None,
    overwrite: bool = False,
    allow_outside: bool = False,
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Run the main job and write all of its files, or none.

    Parameters
    ----------
    graph : Graph
        A graph as made by `panel_graph`. Relative paths are read from the working directory.
    folder : Path
        Where the files go; made if it does not exist.
    progress : callable
        Called with the name of a step and its state, as `Graph.run` does.
    graph_file : Path, optional
        Where the graph was read: it may take its own place, and no other file may.
    overwrite : bool
        Whether files may be replaced that the job reads or that spheremesh did not write.
    allow_outside : bool
        Whether steps may write outside of the folder.

    Returns
    -------
    report : dict
        The report, as written to ``report.json``.
    files : tuple of str
        Names of the files written.

    Raises
    ------
    InputError, ConvergenceError, NodeError, GraphError
        If the input cannot be used, the optimisation does not converge, or no panel can be
        made, or a file would be replaced that must not; nothing is written then.
    """
    began = time.perf_counter()
    clock = _StepClock(progress)
    with output_folder(
        folder,
        inputs=() if graph_file is None else (graph_file,),
        renewed=GRAPH,
        overwrite=overwrite,
        allow_outside=allow_outside,
    ) as output:
        _check_files(graph, output)
        run = partial(graph.run, on_step=clock.note, write_to=output)
        _refuse_nothing(run("panels.report"), "panels")
        _refuse_unfinished(run("optimum.report", on_step=None))
        if "annuli" in graph.steps:
            annuli = run("annuli.report")
            _refuse_nothing({**annuli, "written": annuli["made"]}, "beams")
        found = run("report")
        if found["support"]:
            _refuse_nothing(found["beams"], "beams")
        run(*graph.ends)
        graph.save(output.staging / GRAPH)
        source = graph.steps["mesh"]
        path = str(source.inputs.get("path") or source.inputs.get("mesh") or source.node.name)
        report: dict[str, Any] = {
            "spheremesh": __version__,
            **found,
            "input": {"path": path, **found["input"]},
            **_mesh_reports(graph, run),
            "seconds": {
                "total": time.perf_counter() - began,
                "optimize": clock.seconds.get("optimum", 0.0),
                "step": clock.seconds.get("step", 0.0),
            },
            "warnings": [
                text
                for step, messages in graph.messages.items()
                # The angles alone are of no interest once more is asked for.
                if step != "angles"
                for text in messages
            ],
        }
        report = output.write_report(report)
    return report, tuple(sorted(report["files"]))


def _check_files(graph: Graph, output: OutputFolder) -> None:
    """Refuse at once what the job must not write; a step may still add to it."""
    values = {name: param.value for name, param in graph.params.items()}
    uses = FileUses(Folders(write_to=output))
    note_known_files(uses, graph.steps.values(), values)
    for name in (GRAPH, REPORT):
        output.check(name)


def _mesh_reports(graph: Graph, run: Callable[..., Any]) -> dict[str, Any]:
    """What the mesh is, and what its repair did, where a graph has these steps."""
    is_repaired = graph.steps["mesh"].node.name == "repair_mesh"
    return {
        "mesh": dict(run("description")) if "description" in graph.steps else None,
        "repair": dict(run("mesh.report")) if is_repaired else None,
    }


def _refuse_unfinished(optimum: Mapping[str, Any]) -> None:
    if not optimum["converged"]:
        stage = optimum["stages"][-1]
        raise ConvergenceError(
            f"the optimisation did not converge in {stage['iterations']} iterations of "
            f"its stage {stage['name']!r}: allow more tolerance, or look for nearly degenerate "
            "faces"
        )


def _refuse_nothing(made: Mapping[str, Any], what: str) -> None:
    if made["written"] == 0:
        rejected = made["rejected"]
        shown = "; ".join(f"{part['id']}: {part['reason']}" for part in rejected[:3])
        more = f"; {len(rejected) - 3} more" if len(rejected) > 3 else ""
        raise InputError(f"none of the {len(rejected)} {what} can be made: {shown}{more}")


class _StepClock:
    """Seconds that each step took, on the way of the progress messages."""

    def __init__(self, progress: Progress) -> None:
        self.seconds: dict[str, float] = {}
        self._progress = progress
        self._began = 0.0

    def note(self, step: str, state: str) -> None:
        now = time.perf_counter()
        if state == "running":
            self._began = now
        elif state != "cached":
            self.seconds[step] = now - self._began
        self._progress(step, state)
