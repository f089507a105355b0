"""Jobs side by side: each has its own files, and the working directory stays."""

import json
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest

import spheremesh as sm
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.panel import (
    PanelOptions,
    feasible_panel_graph,
    panel_graph,
    run_job,
)
from spheremesh.nodes import DiskStore, NodeError
from spheremesh.nodes.library.input import ellipsoid_mesh

CIRCUMFERENCES = (8, 12)


def test_two_jobs_in_one_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    both = Barrier(2, timeout=60)

    def job(n: int) -> None:
        mesh = tmp_path / f"{n}.obj"
        write_mesh(ellipsoid_mesh(n, 2), mesh)
        graph = panel_graph(PanelOptions(mesh=mesh))

        def meet(step: str, state: str) -> None:
            if (step, state) in {("step", "running"), ("step", "done")}:
                both.wait()  # while the other writes as well

        run_job(graph, tmp_path / f"out{n}", meet)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with ThreadPoolExecutor(2) as executor:
            list(executor.map(job, CIRCUMFERENCES))
    assert Path.cwd() == tmp_path
    assert {path.name for path in tmp_path.iterdir()} == {
        f"{name}{n}{suffix}"
        for n in CIRCUMFERENCES
        for name, suffix in (("", ".obj"), ("out", ""))
    }
    for n in CIRCUMFERENCES:
        out = tmp_path / f"out{n}"
        text = (out / "panels.step").read_text()
        assert text.count("SHELL_BASED_SURFACE_MODEL(") == 2 * n
        assert len(json.loads((out / "schedule.json").read_text())["panels"]) == 2 * n
        assert json.loads((out / "report.json").read_text())["panels"]["written"] == 2 * n
        assert sm.Graph.load(out / "graph.json").steps["step"].inputs["path"] == "panels.step"


def test_an_error_of_a_writer_names_the_path_of_the_graph(tmp_path: Path) -> None:
    graph = panel_graph(PanelOptions())
    graph.add("write_mesh", "wrong", mesh=graph.wire("mesh"), path="roof.xyz")
    with pytest.raises(NodeError, match=r"cannot write roof\.xyz: ") as error:
        graph.run("wrong", write_to=tmp_path)
    assert str(tmp_path) not in error.value.reason


def test_with_another_thickness_nothing_before_the_panels_runs(tmp_path: Path) -> None:
    mesh = tmp_path / "dome.obj"
    write_mesh(ellipsoid_mesh(8, 4), mesh)

    def steps_run(thickness: float) -> tuple[set[str], sm.Graph]:
        options = PanelOptions(mesh=mesh, moulds=3, thickness=thickness)
        graph = feasible_panel_graph(options, DiskStore(tmp_path / "cache"))
        said: list[tuple[str, str]] = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            graph.run("report", "blanks", on_step=lambda *state: said.append(state))
        return {step for step, state in said if state == "running"}, graph

    first, graph = steps_run(0.02)
    later = {name for name, step in graph.steps.items() if step.node.name == "panels"}
    for name, step in graph.steps.items():
        if not later.isdisjoint(step.parents):
            later.add(name)
    assert {"mesh", "start", "optimum", "moulds"} <= first - later
    second, _ = steps_run(0.03)
    assert "panels" in second
    assert second <= later
