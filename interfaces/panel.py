"""The main job: a mesh in, spherical panels out, as a graph that the user can open again."""

import json
import time
from collections.abc import Callable, Mapping
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from .. import __version__
from ..fabrication.files import replacing_all
from ..kernel.errors import InputError
from ..kernel.mesh import Mesh, mean_edge_length
from ..kernel.sphere_mesh import SphereMesh, vertex_error
from ..nodes.graph import Graph

Progress = Callable[[str, str], None]


@dataclass(frozen=True)
class PanelOptions:
    """
    What the main job is asked to do.

    Attributes
    ----------
    mesh : Path or None
        Mesh file; the demo roof if None.
    layer : str
        Layer or group of the file to use.
    units : str
        Model units.
    moulds : int or None
        Number of moulds; None for a radius per panel.
    thickness, joint_gap : float
        In model units.
    edges : {"bisector", "intersection"}
        How panels are cut.
    """

    mesh: Path | None = None
    layer: str = ""
    units: str = "m"
    moulds: int | None = None
    thickness: float = 0.0
    joint_gap: float = 0.0
    edges: Literal["bisector", "intersection"] = "bisector"


def panel_graph(options: PanelOptions) -> Graph:
    """
    The graph of the main job.

    Parameters
    ----------
    options : PanelOptions
        What is asked for.

    Returns
    -------
    Graph
        Its steps are named mesh, start, optimum, moulds (with a number of them), panels, step,
        rhino, table, list and picture; its writers write into the working directory.

    Raises
    ------
    GraphError
        If an option is out of range.
    """
    graph = Graph(options.mesh.stem if options.mesh else "roof", units=options.units)
    thickness = graph.param("thickness", options.thickness, min=0)
    joint_gap = graph.param("joint_gap", options.joint_gap, min=0)
    if options.mesh is None:
        mesh = graph.add("roof_mesh", "mesh")
    else:
        path = str(options.mesh.resolve())
        mesh = graph.add("read_mesh", "mesh", path=path, layer=options.layer)
    start = graph.add("fit_spheres", "start", mesh=mesh)
    optimum = graph.add("minimize_angles", "optimum", sphere_mesh=start)
    spheres, labels = optimum.sphere_mesh, None
    if options.moulds is not None:
        count = graph.param("moulds", options.moulds, min=1)
        moulds = graph.add("cluster_radii", "moulds", sphere_mesh=spheres, k=count)
        spheres, labels = moulds.sphere_mesh, moulds.labels
    panels = graph.add(
        "panels", "panels", sphere_mesh=spheres, edges=options.edges, thickness=thickness,
        joint_gap=joint_gap, labels=labels,
    )  # fmt: skip
    graph.add("write_step", "step", panels=panels.panels, path="panels.step")
    graph.add("write_3dm", "rhino", panels=panels.panels, path="model.3dm", reference=mesh)
    graph.add("write_schedule", "table", panels=panels.panels, path="schedule.csv")
    graph.add("write_schedule", "list", panels=panels.panels, path="schedule.json")
    graph.add("render", "picture", panels=panels.panels, path="preview.png")
    return graph


def is_panel_job(graph: Graph) -> bool:
    """
    Whether a graph is the main job, perhaps with other values and further steps.

    Parameters
    ----------
    graph : Graph
        A graph.

    Returns
    -------
    bool
        Whether it has the steps that the report is made of.
    """
    steps = {name: step.node.name for name, step in graph.steps.items()}
    needed = {"optimum": "minimize_angles", "panels": "panels", "step": "write_step"}
    return "mesh" in steps and needed.items() <= steps.items()


def run_job(
    graph: Graph, folder: Path, progress: Progress
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """
    Run the main job and write all of its files, or none.

    Parameters
    ----------
    graph : Graph
        A graph as made by `panel_graph`. Relative paths are read from the working directory.
    folder : Path
        Where the files go; made if it does not exist.
    progress : callable
        Called with the name of a step and its state, as `Graph.run` does.

    Returns
    -------
    report : dict
        The report, as written to ``report.json``.
    files : tuple of str
        Names of the files written.

    Raises
    ------
    InputError, NodeError, GraphError
        If the input cannot be used or no panel can be made; nothing is written then.
    """
    began = time.perf_counter()
    clock = _StepClock(progress)
    here = Path.cwd()
    with replacing_all(folder) as staging:
        with chdir(staging):
            _refuse_nothing(graph.run("panels.report", on_step=clock.note, read_from=here))
            graph.run(*graph.ends, on_step=clock.note, read_from=here)
            report = _report(graph, here)
        graph.save(staging / "graph.json")
        report["seconds"] = {
            "total": time.perf_counter() - began,
            "optimize": clock.seconds.get("optimum", 0.0),
            "step": clock.seconds.get("step", 0.0),
        }
        text = json.dumps(report, indent=1, allow_nan=False) + "\n"
        (staging / "report.json").write_text(text, encoding="utf-8")
        files = tuple(sorted(path.name for path in staging.iterdir()))
    return report, files


def _refuse_nothing(cut: Mapping[str, Any]) -> None:
    if cut["written"] == 0:
        rejected = cut["rejected"]
        shown = "; ".join(f"{panel['id']}: {panel['reason']}" for panel in rejected[:3])
        more = f"; {len(rejected) - 3} more" if len(rejected) > 3 else ""
        raise InputError(f"none of the {len(rejected)} panels can be made: {shown}{more}")


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


def _report(graph: Graph, read_from: Path) -> dict[str, Any]:
    names = ["mesh", "optimum.report", "optimum.sphere_mesh", "panels.report"]
    is_clustered = "moulds" in graph.steps
    if is_clustered:
        names += ["moulds.report", "moulds.sphere_mesh"]
    values = dict(zip(names, graph.run(*names, read_from=read_from), strict=True))
    mesh: Mesh = values["mesh"]
    built: SphereMesh = values["moulds.sphere_mesh" if is_clustered else "optimum.sphere_mesh"]
    angles = dict(values["optimum.report"]["angles_deg"])
    moulds: Mapping[str, Any] = {"count": 0, "radii": [], "panels_per_mould": []}
    if is_clustered:
        clusters = values["moulds.report"]
        # What is built counts as spherical; what the moulds cost is there to compare.
        angles |= {"spherical": clusters["angles_deg"], "unclustered": angles["spherical"]}
        moulds = {name: clusters[name] for name in moulds}
    miss = float(vertex_error(built).max())
    cut = values["panels.report"]
    source = graph.steps["mesh"]
    return {
        "spheremesh": __version__,
        "input": {
            "path": str(source.inputs.get("path", source.node.name)),
            "vertices": mesh.n_vertices,
            "faces": mesh.n_faces,
            "units": graph.units,
        },
        "angles_deg": angles,
        "vertex_error": {"max": miss, "relative_to_edge": miss / mean_edge_length(mesh)},
        "edge_gap": dict(cut["edge_gap"]),
        "moulds": dict(moulds),
        "support": None,
        "panels": {"written": cut["written"], "rejected": list(cut["rejected"])},
        "beams": {"written": 0, "rejected": []},
        "warnings": [text for messages in graph.messages.values() for text in messages],
    }
