"""Graph files of a folder as components, and what is not run."""

import json
import os
from collections.abc import Callable
from typing import Any, TypeAlias

import pytest

import spheremesh as sm
from spheremesh.nodes import (
    cluster_radii,
    fit_spheres,
    mesh_report,
    read_mesh,
    roof_mesh,
    write_schedule,
)
from spheremesh.nodes import panels as cut_panels

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any


def roof() -> sm.Graph:
    g = sm.Graph("Roof of a station")
    n = g.param("n", 4, min=3, max=9)
    k = g.param("moulds", 2, min=1)
    fit = g.add(fit_spheres, mesh=g.add(roof_mesh, n_span=n, n_length=5))
    few = g.add(cluster_radii, "few", sphere_mesh=fit, k=k)
    g.add(cut_panels, "cut", sphere_mesh=few.sphere_mesh, labels=few.labels)
    return g


def test_sliders_are_inputs_and_ends_are_outputs(opened: Callable[..., Any]) -> None:
    one = opened()
    graph = roof()
    graph.save(one.graphs / "station roof.json")
    found = one.gh.describe("station_roof")
    n, moulds = found["inputs"]
    assert (n["Name"], n["ParamType"], n["Default"], n["Minimum"], n["Maximum"]) == (
        "n", "Integer", 4, 3, 9,
    )  # fmt: skip
    assert moulds["Default"] == 2
    assert found["outputnames"] == ["panels", "breps", "report"]
    assert found["description"] == "Roof of a station"
    got = one.gh.solve("station_roof", n=5, moulds=3)
    graph.set(n=5, moulds=3)
    cut = graph.run("cut.panels")
    assert len(got["breps"]) == cut.n_panels == 25
    panels = one.service.solver.handles.take(got["panels"][0], "here")
    assert panels.ids == cut.ids
    assert any("Nickname" in each for each in one.gh.get("/")[1])


def test_a_changed_file_is_another_component(opened: Callable[..., Any]) -> None:
    one = opened()
    path = one.graphs / "size.json"
    g = sm.Graph()
    g.add(roof_mesh, n_span=g.param("n", 4))
    g.save(path)
    assert [each["Name"] for each in one.gh.describe("size")["inputs"]] == ["n"]
    g.rename(g.params["n"], "count")
    g.save(path)
    os.utime(path, ns=(1, 1))
    # What Grasshopper still has of the old one makes it look again.
    item = {"type": "System.Int32", "data": "5"}
    values = [{"ParamName": "n", "InnerTree": {"{0}": [item]}}]
    with pytest.raises(Exception, match="size has no input 'n'; there are count") as caught:
        one.gh.ask("size", values, ["mesh"])
    assert type(caught.value).__name__ == "Rebuilt"
    values = [{"ParamName": "n", "InnerTree": {}}]
    assert one.gh.ask("size", values, ["mesh"])["mesh"]
    assert [each["Name"] for each in one.gh.describe("size")["inputs"]] == ["count"]
    path.unlink()
    with pytest.raises(Exception, match="no component 'size'"):
        one.gh.describe("size")


def test_names_of_graphs_are_flat_and_no_node_is_hidden(opened: Callable[..., Any]) -> None:
    one = opened()
    for name in ("panels", "2", "a-b", "a b", "屋根"):
        roof().save(one.graphs / f"{name}.json")
    (one.graphs / "report.json").write_text('{"spheremesh": "0.1.0"}')
    (one.graphs / ".spheremesh.json").write_text("{}")
    names = [each["Name"] for each in one.gh.get("/")[1]]
    assert names[-5:] == ["graph_2", "a_b", "graph_a_b", "graph_panels", "graph"]
    assert len(set(names)) == len(names)
    assert all(one.gh.describe(name) for name in names[-5:])
    assert one.gh.describe("panels")["inputnames"][0] == "sphere_mesh"


def test_lists_of_a_graph_are_trees(opened: Callable[..., Any]) -> None:
    one = opened()
    g = sm.Graph()
    sizes = g.param("sizes", [3, 4])
    nets = g.add(roof_mesh, n_span=sm.each(sizes), n_length=3)
    g.add(fit_spheres, mesh=sm.each(nets))
    g.save(one.graphs / "many.json")
    (port,) = one.gh.describe("many")["inputs"]
    assert (port["AtLeast"], port["ParamType"]) == (0, "Text")
    default = one.gh.solve("many")
    assert len(default["sphere_mesh"]) == 2
    assert {path: len(items) for path, items in default["spheres"].items()} == {
        "{0;0}": 9, "{0;1}": 12,
    }  # fmt: skip
    three = one.gh.solve("many", sizes=["3", "4", "5"])
    assert len(three["sphere_mesh"]) == 3


def test_a_broken_graph_says_why_and_spoils_nothing(opened: Callable[..., Any]) -> None:
    one = opened()
    text = roof().to_json().replace('"fit_spheres"', '"fit_spheresx"')
    (one.graphs / "broken.json").write_text(text)
    (one.graphs / "half.json").write_text(text[:300])
    for name, message in (("broken", "fit_spheresx"), ("half", "not JSON")):
        with pytest.raises(Exception, match=rf"{name}.json: .*{message}"):
            one.gh.describe(name)
        with pytest.raises(Exception, match=message):
            one.gh.ask(name, [], [])
    names = {each["Name"] for each in one.gh.get("/")[1]}
    assert not names & {"broken", "half"}
    _, kind, page = one.gh.send("GET", "/", None, HTTP_ACCEPT="text/html")
    assert kind.startswith("text/html")
    assert b"broken.json" in page


def test_files_of_a_graph_stay_in_the_folder(opened: Callable[..., Any]) -> None:
    one, without = opened(), opened(files=None)
    g = sm.Graph()
    fit = g.add(fit_spheres, mesh=g.add(roof_mesh, n_span=3, n_length=3))
    made = g.add(cut_panels, sphere_mesh=fit)
    g.add(write_schedule, panels=made.panels, path=g.param("path", "lists/roof.csv"))
    g.save(one.graphs / "list.json")
    for _ in range(2):
        assert one.gh.solve("list")["path"] == [str(one.files / "lists" / "roof.csv")]
        assert one.gh.status == 203
    assert (one.files / "lists" / "roof.csv").is_file()
    with pytest.raises(Exception, match=r"list.path = '../x.csv': outside of the folder"):
        one.gh.solve("list", path="../x.csv")
    with pytest.raises(Exception, match=r"list.json: .* start with --files"):
        without.gh.describe("list")
    for node, path in ((read_mesh, "/etc/x.obj"), (read_mesh, "../x.obj")):
        g = sm.Graph()
        g.add(node, path=path)
        g.save(one.graphs / "out.json")
        with pytest.raises(Exception, match=r"out.json: step 'read_mesh': path = .* outside"):
            one.gh.describe("out")
    inner = sm.Graph()
    inner.add(g.as_node("inner"))
    inner.save(one.graphs / "deep.json")
    with pytest.raises(Exception, match=r"deep.json: step 'read_mesh': path = .* outside"):
        one.gh.solve("deep")


def test_a_mesh_by_wire_is_no_path(opened: Callable[..., Any]) -> None:
    one = opened(files=None)
    g = sm.Graph()
    g.add(mesh_report, mesh=g.add(roof_mesh, n_span=g.param("n", 3), n_length=3))
    g.save(one.graphs / "facts.json")
    assert json.loads(one.gh.solve("facts")["report"][0])
    assert one.gh.status == 203  # the node could read a file


def test_code_of_a_graph_is_not_imported(opened: Callable[..., Any]) -> None:
    one = opened()
    content = json.loads(roof().to_json())
    content["steps"]["cut"].update(node="own_node", module="antigravity")
    (one.graphs / "own.json").write_text(json.dumps(content))
    with pytest.raises(Exception, match="own_node"):
        one.gh.describe("own")
