"""Tables, drawings and nesting that `panel` writes when asked."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.kernel.surfaces.circular_nets import vase_net


def test_papers_stand_beside_the_other_files(tmp_path: Path) -> None:
    for library in ("reportlab", "rectpack", "xlsxwriter"):
        pytest.importorskip(library)
    mesh = write_mesh(vase_net(8, 3, 1.0, 2.0, 0.3), tmp_path / "vase.obj")
    options = ["--support", "--thickness", "0.02", "--tables", "xlsx", "--drawings", "A4"]
    out = tmp_path / "out"
    done = CliRunner().invoke(main, ["panel", str(mesh), "-o", str(out), *options, "--nest"])
    assert done.exit_code == 0, done.stderr
    names = {path.name for path in out.iterdir()}
    assert {"tables.xlsx", "drawings.pdf", "drawings.dxf", "beams.dxf", "beams.csv"} <= names
    assert "<h2>Sheets: " in (out / "report.html").read_text("utf-8")


def test_tables_are_those_of_what_there_is() -> None:
    graph = panel_graph(PanelOptions(tables="csv"))
    paths = {s.inputs["path"] for s in graph.steps.values() if s.node.name == "write_tables"}
    assert paths == {"tables_panels.csv", "tables_panel_edges.csv"}
    graph = panel_graph(PanelOptions(tables="parquet", support="axis", moulds=4))
    assert sum(step.node.name == "write_tables" for step in graph.steps.values()) == 7
    assert not any(s.node.name == "write_drawings" for s in graph.steps.values())
