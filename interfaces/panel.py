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
from ..kernel.mesh import Mesh
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
    graph.add("write_3dm", "rhino", panels=panels.panels, path="model.3dm")
    graph.add("write_schedule", "table", panels=panels.panels, path="schedule.csv")
    graph.add("write_schedule", "list", panels=panels.panels, path="schedule.json")
    graph.add("render", "picture", panels=panels.panels, path="preview.png")
    return graph


def run_panel(options: PanelOptions, folder: Path, progress: Progress) -> dict[str, Any]:
    """
    Run the main job and write all of its files, or none.

    Parameters
    ----------
    options : PanelOptions
        What is asked for.
    folder : Path
        Where the files go; made if it does not exist.
    progress : callable
        Called with the name of a step and its state, as `Graph.run` does.

    Returns
    -------
    dict
        The report, as written to ``report.json``.

    Raises
    ------
    InputError, NodeError, GraphError
        If the input cannot be used; nothing is written then.
    """
    began = time.perf_counter()
    clock = _StepClock(progress)
    graph = panel_graph(options)
    with replacing_all(folder) as staging:
        with chdir(staging):
            graph.run(*graph.ends, on_step=clock.note)
        graph.save(staging / "graph.json")
        seconds = {
            "total": time.perf_counter() - began,
            "optimize": clock.seconds["optimum"],
            "step": clock.seconds["step"],
        }
        report = _report(graph, options, seconds)
        text = json.dumps(report, indent=1, allow_nan=False) + "\n"
        (staging / "report.json").write_text(text, encoding="utf-8")
    return report


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
        else:
            self.seconds[step] = now - self._began
        self._progress(step, state)


def _report(
    graph: Graph, options: PanelOptions, seconds: Mapping[str, float]
) -> dict[str, Any]:
    mesh: Mesh = graph.run("mesh")
    optimum: Mapping[str, Any] = graph.run("optimum.report")
    panels: Mapping[str, Any] = graph.run("panels.report")
    angles = dict(optimum["angles_deg"])
    moulds: Mapping[str, Any] = {"count": 0, "radii": [], "panels_per_mould": []}
    if options.moulds is not None:
        clusters: Mapping[str, Any] = graph.run("moulds.report")
        # What is built counts as spherical; what the moulds cost is there to compare.
        angles |= {"spherical": clusters["angles_deg"], "unclustered": angles["spherical"]}
        moulds = {name: clusters[name] for name in moulds}
    return {
        "spheremesh": __version__,
        "input": {
            "path": str(options.mesh) if options.mesh else "roof_mesh",
            "vertices": mesh.n_vertices,
            "faces": mesh.n_faces,
            "units": options.units,
        },
        "angles_deg": angles,
        "vertex_error": dict(optimum["vertex_error"]),
        "edge_gap": dict(panels["edge_gap"]),
        "moulds": dict(moulds),
        "support": None,
        "panels": {"written": panels["written"], "rejected": list(panels["rejected"])},
        "beams": {"written": 0, "rejected": []},
        "seconds": dict(seconds),
        "warnings": [text for messages in graph.messages.values() for text in messages],
    }
