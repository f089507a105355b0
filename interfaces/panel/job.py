"""The main job run: all of its files, or none."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, Final

from ... import __version__
from ...fabrication.output_folder import REPORT, OutputFolder, output_folder
from ...kernel.errors import ConvergenceError, InputError
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.running.events import Event
from ...nodes.graphs.running.files import FileUses, Folders, note_known_files

GRAPH: Final = "graph.json"
"""Name of the graph of a job beside its files."""

MOST_LOST: Final = 0.1
"""Share of the beams made in place of those asked for that may be missing."""

Progress = Callable[[str, str], None]


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
        Called with the name of a step and its state, as `Graph.run` does, or what the step says
        of itself: how long it will take.
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
        run = partial(
            graph.run, on_step=clock.note, on_event=said_to(progress), write_to=output
        )
        if graph.steps["optimum"].node.name == "exact_support":
            _refuse_no_support(run("optimum.report"))
        _refuse_nothing(run("panels.report"), "panels")
        _refuse_unfinished(run("optimum.report", on_step=None))
        if "annuli" in graph.steps:
            annuli = run("annuli.report")
            _refuse_nothing({**annuli, "written": annuli["made"]}, "beams")
        found = run("report")
        if found["support"]:
            _refuse_nothing(found["beams"], "beams")
            _refuse_few_beams(found["support"], found["beams"])
        run(*graph.ends)
        graph.save(output.staging / GRAPH)
        source = graph.steps["mesh"]
        path = str(source.inputs.get("path") or source.inputs.get("mesh") or source.node.name)
        report: dict[str, Any] = {
            "spheremesh": __version__,
            **found,
            "input": {"path": path, **found["input"]},
            **_mesh_reports(graph, run),
            **_pattern_reports(graph, run),
            "seconds": {
                "total": time.perf_counter() - began,
                "optimize": clock.seconds.get("optimum", 0.0),
                "step": clock.seconds.get("step", 0.0),
            },
            "warnings": [
                text
                for step, messages in graph.messages.items()
                # What there would be otherwise is of no interest once more is asked for.
                if step not in {"angles", "plain"}
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


def _pattern_reports(graph: Graph, run: Callable[..., Any]) -> dict[str, Any]:
    """What a pattern was expected to gain, and how its net was found, where there is one."""
    if "pattern" not in graph.steps:
        return {}
    return {"pattern": {"gain": dict(run("gain.report")), "net": dict(run("pattern.report"))}}


def _refuse_unfinished(optimum: Mapping[str, Any]) -> None:
    """An optimum that is not reached can be built all the same if all that has to hold does."""
    if not (optimum["converged"] or optimum.get("held", False)):
        stage = optimum["stages"][-1]
        raise ConvergenceError(
            f"the optimisation did not converge in {stage['iterations']} iterations of "
            f"its stage {stage['name']!r}: allow more tolerance, or look for nearly degenerate "
            "faces"
        )


def _refuse_no_support(exact: Mapping[str, Any]) -> None:
    if exact["verdict"] == "no":
        raise ConvergenceError(exact["reason"])


def _refuse_nothing(made: Mapping[str, Any], what: str) -> None:
    if made["written"] == 0:
        rejected = made["rejected"]
        shown = "; ".join(f"{part['id']}: {part['reason']}" for part in rejected[:3])
        more = f"; {len(rejected) - 3} more" if len(rejected) > 3 else ""
        raise InputError(f"none of the {len(rejected)} {what} can be made: {shown}{more}")


def _refuse_few_beams(support: Mapping[str, Any], beams: Mapping[str, Any]) -> None:
    """Refuse upright beams that nobody asked for where many cannot be made either."""
    written, lost = beams["written"], len(beams["rejected"])
    if support["kind"] != support["asked"] and lost > MOST_LOST * (written + lost):
        raise InputError(
            f"no support for this mesh: {support['feasibility']['reason']}; of "
            f"{written + lost} upright beams {lost} cannot be made either; remesh it, let "
            "vertices move (--tolerance 0.1), or leave out --support"
        )


def said_to(progress: Progress) -> Callable[[Event], None]:
    """What steps say of themselves while they run, told as states are."""

    def _tell(event: Event) -> None:
        if event.state == "progress" and event.text:
            progress(event.step, event.text)

    return _tell


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
