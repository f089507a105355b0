"""Rhino files through the graph: ports, the graph inside the document, and what is counted."""

from collections import Counter
from pathlib import Path

import pytest
import rhino3dm

from spheremesh.nodes import Graph, GraphError


def roof_graph(path: Path, *layers: str) -> Graph:
    graph = Graph("roof")
    mesh = graph.add("roof_mesh", "mesh", n_span=4, n_length=5)
    spheres = graph.add("fit_spheres", mesh=mesh)
    made = graph.add("panels", "panels", sphere_mesh=spheres)
    graph.add(
        "write_3dm", "rhino", panels=made.panels, path=str(path), reference=mesh,
        layers=list(layers),
    )  # fmt: skip
    return graph


def test_the_document_holds_the_graph_that_made_it(tmp_path: Path) -> None:
    graph = roof_graph(tmp_path / "a.3dm", "Edges", "Centres")
    assert graph.run("rhino") == str(tmp_path / "a.3dm")
    model = rhino3dm.File3dm.Read(str(tmp_path / "a.3dm"))
    kinds = Counter(type(item.Geometry).__name__ for item in model.Objects)
    assert kinds == {"Brep": 20, "ArcCurve": 80, "Point": 20, "Mesh": 1}
    text = model.Strings["spheremesh::graph"]
    (tmp_path / "again.json").write_text(text, encoding="utf-8")
    again = Graph.load(tmp_path / "again.json")
    (tmp_path / "a.3dm").unlink()
    again.run("rhino")
    assert len(rhino3dm.File3dm.Read(str(tmp_path / "a.3dm")).Objects) == len(model.Objects)


def test_an_unknown_layer_is_refused(tmp_path: Path) -> None:
    with pytest.raises(GraphError, match=r"rhino\.layers = \['Edge'\]"):
        roof_graph(tmp_path / "a.3dm", "Edge")
