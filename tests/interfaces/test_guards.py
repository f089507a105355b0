"""Nothing of the user's is overwritten, and graph files are harmless."""

import json
import os
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import spheremesh as sm
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.fabrication.output_folder import RECORD
from spheremesh.interfaces.cli import main
from spheremesh.kernel.surfaces.circular_nets import vase_net


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with a mesh."""
    monkeypatch.chdir(tmp_path)
    write_mesh(vase_net(8, 3, 1.0, 2.0, 0.3), tmp_path / "model.3dm")
    return tmp_path


def call(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments)


def refused(*arguments: str) -> str:
    """The one line."""
    result = call(*arguments)
    assert result.exit_code == 3, result.output
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    return line


def writing_graph(path: str = "vase.obj") -> sm.Graph:
    graph = sm.Graph()
    mesh = graph.add("vase_mesh", "mesh", n_around=6, n_across=2)
    name = graph.param("path", path)
    graph.add("write_mesh", "written", mesh=mesh, path=name)
    return graph


def test_panelling_does_not_overwrite_its_mesh(folder: Path) -> None:
    mesh = folder / "model.3dm"
    before = mesh.read_bytes()
    (folder / "out").mkdir()
    (folder / "out" / "model.3dm").hardlink_to(mesh)
    for out in (".", str(folder), "out/..", "out"):
        assert "write over model.3dm, which mesh.path reads" in refused(
            "panel", "model.3dm", "-o", out
        )
    assert mesh.read_bytes() == before
    assert {path.name for path in folder.iterdir()} == {"model.3dm", "out"}
    result = call("panel", "model.3dm", "-o", ".", "--overwrite")
    assert result.exit_code == 0, result.stderr
    assert mesh.read_bytes() != before


def test_panelling_twice(folder: Path) -> None:
    assert call("panel", "model.3dm", "-o", "out", "--thickness", "0.01").exit_code == 0
    graph = folder / "out" / "graph.json"
    edited = graph.read_text(encoding="utf-8").replace('"value": 0.01', '"value": 0.02')
    graph.write_text(edited, encoding="utf-8")
    assert "graph.json: it was changed after spheremesh wrote it" in refused(
        "panel", "model.3dm", "-o", "out"
    )
    assert graph.read_text(encoding="utf-8") == edited
    # the graph that is run takes its own place
    assert call("run", "out/graph.json", "-o", "out").exit_code == 0
    report = json.loads((folder / "out" / "report.json").read_text(encoding="utf-8"))
    assert report["thickness"]["max"] == 0.02
    assert set(report["files"]) == {path.name for path in (folder / "out").iterdir()}
    (folder / "out" / "preview.png").write_bytes(b"mine")
    assert "preview.png: it was changed" in refused("panel", "model.3dm", "-o", "out")


def test_running_twice(folder: Path) -> None:
    writing_graph().save("graph.json")
    for arguments in ((), (), ("--set", "path=other.obj"), ()):
        assert call("run", "graph.json", "-o", "out", *arguments).exit_code == 0
    names = {path.name for path in (folder / "out").iterdir()}
    assert names == {"vase.obj", "other.obj", RECORD}
    (folder / "out" / "vase.obj").write_text("mine")
    assert "vase.obj: it was changed" in refused("run", "graph.json", "-o", "out")
    assert call("run", "graph.json", "-o", "out", "--overwrite").exit_code == 0


def test_a_graph_does_not_overwrite_itself_by_a_step(folder: Path) -> None:
    graph = sm.Graph()
    mesh = graph.add("vase_mesh", n_around=6, n_across=2)
    panels = graph.add("panels", sphere_mesh=graph.add("face_planes", mesh=mesh))
    graph.add("write_schedule", panels=panels.panels, path="graph.json")
    graph.save("graph.json")
    before = (folder / "graph.json").read_bytes()
    assert "what the job is made from" in refused("run", "graph.json", "-o", ".")
    assert (folder / "graph.json").read_bytes() == before


@pytest.mark.parametrize("path", ["../victim.obj", "../../victim.obj", "{}/victim.obj"])
def test_a_graph_writes_nothing_outside(folder: Path, path: str) -> None:
    path = path.format(folder)
    inside = folder / "a"
    inside.mkdir()
    writing_graph(path).save("graph.json")
    assert "it is outside of the folder a/out" in refused("run", "graph.json", "-o", "a/out")
    writing_graph().save("graph.json")
    assert "it is outside of the folder a/out" in refused(
        "run", "graph.json", "-o", "a/out", "--set", f"path={path}"
    )
    assert not list(folder.rglob("victim.obj"))
    assert not list(inside.iterdir())
    if path != "../victim.obj":
        return
    given = ("run", "graph.json", "-o", "a/out", "--set", f"path={path}", "--allow-outside")
    assert call(*given).exit_code == 0
    assert (folder / "a" / "victim.obj").is_file()
    assert call(*given).exit_code == 0, "it is known again"
    (folder / "a" / "victim.obj").write_text("mine")
    assert "it was changed" in refused(*given)


def test_malformed_graph_files_are_one_line(folder: Path) -> None:
    text = writing_graph().to_json()
    path = folder / "graph.json"
    defects = {
        "9" * 5000: "graph.json: params.path.value: a whole number has 64 bits at most",
        '{"array": [99999], "dtype": "int8"}': "graph.json: params.path: cannot read",
        "NaN": "graph.json: params.path.value: no finite number",
        "[" * 90 + "]" * 90: "nested too deeply",
        '1, "value": 2': "graph.json: params.path: 'value' is given twice",
        '"a\\u0000b.obj"': "a\x00b.obj",
        '"\\ud800.obj"': "graph.json: params.path.value: not Unicode text",
    }
    for value, line in defects.items():
        path.write_text(text.replace('"vase.obj"', value), encoding="utf-8")
        assert line in refused("run", "graph.json", "-o", "out")
    path.write_text(text, encoding="utf-8")
    for value in ("9" * 5000, "[" * 5000, "9" * 30):
        assert refused("run", "graph.json", "-o", "out", "--set", f"path={value}")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes")
def test_a_pipe_is_no_graph_file(folder: Path) -> None:
    os.mkfifo(folder / "graph.json")
    assert "graph.json: not a file" in refused("run", "graph.json", "-o", "out")
