"""What notebooks show: the page of a model over its picture, tables of reports, graphs."""

import html
import json
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from spheremesh import Graph
from spheremesh.interfaces import notebook
from spheremesh.kernel.parts.records import select_parts
from spheremesh.nodes import (
    axis_support,
    beams,
    face_planes,
    fit_spheres,
    mesh_report,
    panels,
    torus_mesh,
    vase_mesh,
)

EXAMPLE = Path(__file__).parents[2] / "examples" / "roof.ipynb"
CODE = """
import json, sys, nbformat
from nbclient import NotebookClient
book = nbformat.read(sys.argv[1], as_version=4)
NotebookClient(book, timeout=300, kernel_name="python3").execute()
print(json.dumps([cell.outputs for cell in book.cells if cell.cell_type == "code"]))
"""


SHAPES = ("Mesh", "SphereMesh", "Panels", "Annuli", "Beams")


@cache
def views() -> dict[str, object]:
    sphere_mesh = fit_spheres(vase_mesh(8, 4))
    annuli = axis_support(sphere_mesh, depth=0.1).annuli
    return {
        "Mesh": sphere_mesh.mesh,
        "SphereMesh": sphere_mesh,
        "Panels": panels(sphere_mesh, thickness=0.02).panels,
        "Annuli": annuli,
        "Beams": beams(annuli, thickness=0.02).beams,
    }


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_shows_its_page_over_a_picture(name: str) -> None:
    shape = views()[name]
    shown = shape._repr_html_()
    assert shown is not None
    page = html.unescape(re.findall(r'srcdoc="([^"]*)"', shown)[0])
    assert page.lower().startswith("<!doctype html>")
    assert html.escape(repr(shape)) in shown
    assert '<img alt="' in shown
    assert shown.index("<img") < shown.index("<iframe"), "the page lies over the picture"


def test_large_models_show_a_picture_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "MOST_PARTS", 10)
    shown = torus_mesh(6, 4)._repr_html_()
    assert "data:image/png;base64,iVBOR" in shown
    assert "iframe" not in shown


def test_nothing_to_draw_shows_nothing() -> None:
    made = panels(face_planes(torus_mesh(6, 4))).panels
    assert select_parts(made, np.zeros(24, bool))._repr_html_() is None


def test_reports_are_tables_and_graphs_are_pictures() -> None:
    table = mesh_report(torus_mesh(6, 4))._repr_html_()
    assert "<caption" in table
    assert table.count("<tr>") == len(mesh_report(torus_mesh(6, 4)))
    graph = Graph("<b>roof</b>")
    k = graph.param("rings", 6)
    graph.add(fit_spheres, mesh=graph.add(torus_mesh, n_around=k))
    shown = graph._repr_html_()
    assert shown.count("<rect") == 3
    assert shown.count("<path") == 2
    assert "rings = 6" in shown
    assert "<b>roof" not in shown


@pytest.mark.long
def test_a_notebook_shows_each_type() -> None:
    pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    run = subprocess.run(
        [sys.executable, "-c", CODE, str(EXAMPLE)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr[-2000:]
    cells = json.loads(run.stdout)
    texts = [
        "".join(output.get("text", "") or output["data"]["text/plain"] for output in cell)
        for cell in cells
    ]
    pages = [
        "".join(output.get("data", {}).get("text/html", "") for output in cell)
        for cell in cells
    ]
    for kind in (
        "Mesh(",
        "SphereMesh(",
        "Panels(",
        "CutReport(",
        "Annuli(",
        "Beams(",
        "Graph(",
    ):
        shown = [page for text, page in zip(texts, pages, strict=True) if text.startswith(kind)]
        assert shown, kind
        wanted = {"CutReport(": "<table", "Graph(": "<svg"}.get(kind, "<iframe")
        assert all(wanted in page for page in shown), kind
    assert max(map(len, texts)) < 1000
    said = "audit: panels must be Panels or None, not PanelSet: give its .panels"
    assert any(said in text for text in texts)
