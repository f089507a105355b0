"""repair_mesh and mesh_report take meshes, files and raw faces, alone and wired."""

import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from spheremesh import Graph, Mesh
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import (
    fit_spheres,
    mesh_report,
    node,
    read_mesh,
    repair_mesh,
    vase_mesh,
    write_mesh,
)
from spheremesh.nodes.graphs.node import NodeWarning

POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]
FLIPPED = [[0, 1, 2, 3], [2, 5, 4, 1]]
CLEAN = [[0, 1, 2, 3], [1, 4, 5, 2]]


def obj(faces: list[list[int]]) -> str:
    lines = [f"v {x} {y} {z}" for x, y, z in POINTS]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return "\n".join([*lines, ""])


@pytest.fixture
def flipped(tmp_path: Path) -> Path:
    path = tmp_path / "flipped.obj"
    path.write_text("o roof\n" + obj(FLIPPED))
    return path


def test_a_mesh_that_wants_nothing_is_returned_as_it_is() -> None:
    mesh = vase_mesh(12, 6)
    repaired, report = repair_mesh(mesh)
    assert np.array_equal(repaired.vertices, mesh.vertices)
    assert np.array_equal(repaired.corners, mesh.corners)
    assert report["flipped_faces"] == []


@pytest.mark.parametrize("kind", ["path", "text", "lists", "arrays"])
def test_files_and_raw_faces_are_repaired_alike(flipped: Path, kind: str) -> None:
    given = {
        "path": flipped,
        "text": str(flipped),
        "lists": (POINTS, FLIPPED),
        "arrays": (np.array(POINTS, float), np.array(FLIPPED)),
    }[kind]
    assert mesh_report(given).repair == {"flipped_faces": 1}
    with pytest.warns(NodeWarning, match=r"the mesh was repaired: turned over 1 face"):
        mesh, report = repair_mesh(given)
    assert report.flipped_faces == [1]
    assert mesh.n_faces == 2


def test_what_cannot_be_read_says_what_repairs_it_and_that_does(flipped: Path) -> None:
    with pytest.raises(InputError, match=r"normals of 1 of 2 faces.*repair_mesh \(--repair\)"):
        read_mesh(flipped)
    with pytest.warns(NodeWarning, match="turned over"):
        assert fit_spheres(repair_mesh(flipped).mesh).mesh.n_faces == 2


def test_a_layer_is_of_a_file(flipped: Path) -> None:
    assert mesh_report(flipped, layer="roof").faces == 2
    with pytest.raises(InputError, match="no face is in a group"):
        mesh_report(flipped, layer="wall")
    with pytest.raises(InputError, match="only a file has layers"):
        repair_mesh(vase_mesh(12, 6), layer="roof")


def test_graphs_wire_any_kind_and_save_it(flipped: Path, tmp_path: Path) -> None:
    graph = Graph()
    source = graph.add(vase_mesh, n_around=12, n_across=6)
    graph.add(repair_mesh, "wired", mesh=source)
    graph.add(repair_mesh, "path", mesh=str(flipped))
    graph.add(repair_mesh, "faces", mesh=(POINTS, FLIPPED))
    graph.add(repair_mesh, "arrays", mesh=(np.array(POINTS, float), np.array(FLIPPED)))
    graph.add(mesh_report, "described", mesh=graph.wire("wired.mesh"))
    graph.add(fit_spheres, "spheres", mesh=graph.wire("path.mesh"))
    graph.save(tmp_path / "graph.json")
    again = Graph.load(tmp_path / "graph.json")
    for each in (graph, again):
        with pytest.warns(NodeWarning, match="turned over"):
            each.run(*each.ends)
        assert each.run("described").faces == 72
        for name in ("path", "faces", "arrays"):
            assert each.run(f"{name}.report").flipped_faces == [1]
            assert "turned over 1 face" in each.messages[name][0]
        assert "wired" not in each.messages


def test_a_changed_file_is_repaired_again(flipped: Path) -> None:
    graph = Graph()
    step = graph.add(repair_mesh, mesh=str(flipped))
    with pytest.warns(NodeWarning, match="turned over"):
        assert graph.run(step.report).flipped_faces == [1]
    time.sleep(0.01)
    flipped.write_text(obj(CLEAN) + "\n")
    assert graph.run(step.report).flipped_faces == []


def test_relative_paths_are_found_where_the_graph_reads(
    flipped: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(flipped.parent)
    graph = Graph()
    step = graph.add(mesh_report, mesh=flipped.name)
    made = graph.add(vase_mesh, n_around=12, n_across=6)
    written = graph.add(write_mesh, mesh=made, path="vase.obj")
    of_written = graph.add(mesh_report, "written", mesh=written)
    of_mesh = graph.add(mesh_report, "wired", mesh=made)
    (flipped.parent / "out").mkdir()
    run: Callable[..., object] = graph.run
    results = run(step, of_written, of_mesh, write_to=flipped.parent / "out")
    assert [each.faces for each in results] == [2, 72, 72]  # type: ignore[attr-defined]


@pytest.mark.parametrize("bad", [7, (POINTS,), (POINTS, 3), None])
def test_other_values_are_refused_when_wired(bad: object) -> None:
    with pytest.raises(Exception, match=r"mesh = .*must be Mesh or str or path or tuple of 2"):
        Graph().add(repair_mesh, mesh=bad)


def test_reports_are_json(flipped: Path) -> None:
    with pytest.warns(NodeWarning, match="turned over"):
        report = repair_mesh(flipped).report
    assert json.loads(json.dumps(dict(report)))["flipped_faces"] == [1]
    assert json.loads(json.dumps(dict(mesh_report(flipped))))["faces"] == 2


def test_a_wire_of_a_mesh_or_a_path_fits() -> None:
    @node
    def some_mesh_for_repair() -> Mesh:
        """A mesh."""
        return vase_mesh(12, 6)

    graph = Graph()
    assert graph.run(graph.add(mesh_report, mesh=graph.add(some_mesh_for_repair))).faces == 72
