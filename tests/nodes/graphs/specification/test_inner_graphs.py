"""Graphs as nodes, steps that are not finished, and contents beside the file."""

import importlib
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import Event, GraphError, NodeError, ReadPath, Units, WritePath, node

calls = Counter[str]()


class Parts(NamedTuple):
    """Low and high."""

    low: float
    high: float


def split(value: float) -> Parts:
    calls["split"] += 1
    return Parts(value / 4, 3 * value / 4)


def add(a: float, b: float = 1.0) -> float:
    calls["add"] += 1
    if a < 0:
        raise ValueError("negative")
    return a + b


def norm(values: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(values))


def count(mesh: sm.Mesh) -> int:
    return mesh.n_faces


def unit(units: Units = "m") -> str:
    return units


def read_text(path: ReadPath) -> str:
    calls["read_text"] += 1
    return Path(path).read_text()


def write_text(text: str, path: WritePath) -> str:
    calls["write_text"] += 1
    Path(path).write_text(text)
    return str(path)


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    calls.clear()
    for function in (split, add, norm, count, unit, read_text, write_text):
        node(function)


def inner() -> sm.Graph:
    g = sm.Graph("two parts", units="mm")
    a, b = g.param("a", 8.0, min=0), g.param("b", 1.0)
    parts = g.add(split, value=a)
    g.add(add, "low", a=parts.low, b=b)
    g.add(add, "high", a=parts.high, b=b)
    g.add(unit)
    return g


def test_a_graph_is_a_node_with_ports() -> None:
    g = sm.Graph("outer")
    k = g.param("k", 4.0)
    step = g.add(inner(), a=k)
    assert step.name == "two_parts"
    assert [wire.port.name for wire in step.wires] == ["low", "high", "unit"]
    assert g.run(step) == (2, 4, "mm")
    assert g.run(step.high, g.add(add, a=step.low, b=step.high)) == (4, 6)
    with pytest.raises(GraphError, match=r"two_parts_2\.a = 'x': must be float"):
        g.add(inner(), a="x")
    with pytest.raises(GraphError, match=r"two_parts_2\.a = -1: must be at least 0"):
        g.add(inner(), a=-1)
    with pytest.raises(GraphError, match="has no input 'c'"):
        g.add(inner(), c=1)


def test_inner_steps_are_cached_and_told_one_by_one() -> None:
    g = sm.Graph("outer")
    b = g.param("b", 1.0)
    step = g.add(inner(), "x", a=4.0, b=b)
    events: list[Event] = []
    g.run(step, on_event=events.append)
    names = ["x/split", "x/low", "x/high", "x/unit"]
    assert [e.step for e in events if e.state == "done"] == names
    g.set(b=2.0)
    g.run(step)
    assert calls == {"split": 1, "add": 4}
    deep, nested = sm.Graph("deep"), sm.Graph("nested")
    deep.add(add, "low", a=deep.param("a", 1.0))
    nested.add(deep, "deep", a=nested.param("a", 1.0))
    failing = g.add(nested, "y", a=-1.0)
    with pytest.raises(NodeError, match=r"step 'y/deep/low' \(node add\) failed: negative"):
        g.run(failing)


def test_chosen_outputs_and_their_names() -> None:
    graph = inner()
    chosen = graph.as_node("halves", {"lower": "low", "part": graph.steps["split"].high})
    g = sm.Graph()
    step = g.add(chosen, a=8.0)
    assert g.run(step) == (3, 6)
    assert g.run(step.lower) == 3
    with pytest.raises(GraphError, match="an output cannot be called 'name'"):
        graph.as_node("x", {"name": "low"})
    with pytest.raises(GraphError, match="a graph without steps is no node"):
        g.add(sm.Graph("empty"))


def test_an_inner_graph_is_saved_with_the_outer_one(tmp_path: Path) -> None:
    g = sm.Graph("outer")
    step = g.add(inner(), "x", a=g.param("k", 4.0))
    g.add(add, "last", a=step.low)
    g.save(tmp_path / "g.json")
    again = sm.Graph.load(tmp_path / "g.json")
    assert again.to_json() == g.to_json()
    assert again.run("last", "x.high") == g.run("last", "x.high")
    content = json.loads(g.to_json())
    content["steps"]["x"]["graph"]["steps"]["low"]["node"] = "ad"
    with pytest.raises(GraphError, match=r"steps\.x: steps\.low: unknown node 'ad'; did you"):
        sm.Graph.from_json(json.dumps(content))


def test_a_graph_is_mapped_over_lists() -> None:
    g = sm.Graph()
    low = inner().as_node("low_part", {"result": "low"})
    step = g.add(low, a=sm.each([4.0, 8.0, 12.0]))
    assert g.run(step) == [2, 3, 4]
    assert sm.Graph.from_json(g.to_json()).run("low_part") == [2, 3, 4]
    before = dict(calls)
    assert g.run(g.add(low, "more", a=sm.each([4.0, 16.0]))) == [2, 5]
    assert calls["split"] == before["split"] + 1
    several = g.add(inner(), "both", a=sm.each([4.0, 8.0]))
    assert g.run(several).high == [4, 7]


def test_files_within_are_read_and_written_as_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "in.txt").write_text("one")
    files = sm.Graph("files")
    text = files.add(read_text, path=files.param("source", "in.txt"))
    files.add(write_text, text=text, path="out.txt")
    g = sm.Graph()
    step = g.add(files)
    places = {"read_from": tmp_path, "write_to": tmp_path}
    assert g.run(step, **places) == "out.txt"
    g.run(step, **places)
    assert calls == {"read_text": 1, "write_text": 1}
    (tmp_path / "out.txt").unlink()
    (tmp_path / "in.txt").write_text("two!")
    g.run(step, **places)
    assert (tmp_path / "out.txt").read_text() == "two!"
    mapped = g.add(files, "mapped", source=sm.each(["in.txt"]))
    with pytest.raises(GraphError, match="step 'mapped' maps a graph whose step 'read_text'"):
        g.run(mapped)


def test_unknown_nodes_and_entries_are_kept() -> None:
    g = sm.Graph("g")
    parts = g.add(split, value=g.param("k", 4.0))
    g.add(add, "low", a=parts.low)
    g.add(add, "last", a=g.steps["low"])
    content = json.loads(g.to_json())
    content["canvas"] = {"zoom": 2}
    content["params"]["k"]["label"] = "Size"
    content["steps"]["low"].pop("module")
    content["steps"]["low"].update(node="of_the_future", version="9", at=[1, 2])
    content["steps"]["low"]["inputs"]["c"] = {"wire": "split.high"}
    text = json.dumps(content, indent=2) + "\n"
    with pytest.raises(GraphError, match=r"steps\.low: unknown node 'of_the_future'"):
        sm.Graph.from_json(text)
    kept = sm.Graph.from_json(text, unfinished=True)
    assert kept.to_json() == text
    assert kept.steps["low"].unfinished.startswith("unknown node 'of_the_future'")
    assert kept.steps["low"].parents == ("split", "split")
    assert kept.run("split.low") == 1
    with pytest.raises(GraphError, match="step 'low' is not finished: unknown node"):
        kept.run("last")
    kept.rename("split", "parts")
    kept.rename("k", "size")
    kept.set(size=8.0)
    assert kept.diff(kept.copy()) == ()
    assert '"label": "Size"' in kept.to_json()
    assert '"wire": "parts.high"' in kept.to_json()
    kept.replace("low", add, a=1.0)
    assert kept.run("last") == 3
    assert '"at"' in kept.to_json()


def test_drafts_are_finished_step_by_step() -> None:
    g = sm.Graph()
    assert g.draft("add", "sum").unfinished == (
        "step 'sum' (node add) misses its input 'a' (float)"
    )
    assert g.draft("ad", "other").unfinished == "unknown node 'ad'; did you mean 'add'?"
    text = g.to_json()
    assert sm.Graph.from_json(text, unfinished=True).to_json() == text
    step = g.rewire("sum", a=2.0)
    assert step.unfinished == ""
    assert g.run(step) == 3


MODULE = """
from spheremesh.nodes import node

@node
def mine_of_a_user(a: float) -> float:
    return 10 * a
"""


def test_own_nodes_are_found_by_their_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "nodes_of_a_user.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    module = importlib.import_module("nodes_of_a_user")
    g = sm.Graph()
    g.add(module.mine_of_a_user, a=2)
    text = g.to_json()
    assert json.loads(text)["steps"]["mine_of_a_user"]["module"] == "nodes_of_a_user"
    sys.modules.pop("nodes_of_a_user")
    from spheremesh.nodes.graphs.node import REGISTRY

    REGISTRY.pop("mine_of_a_user")
    with pytest.raises(GraphError, match="defined in nodes_of_a_user: import that first"):
        sm.Graph.from_json(text)
    assert "nodes_of_a_user" not in sys.modules, "no file runs code"
    assert sm.Graph.from_json(text, imports=True).run("mine_of_a_user") == 20
    sys.modules.pop("nodes_of_a_user")
    REGISTRY.pop("mine_of_a_user")
    broken = text.replace("nodes_of_a_user", "nodes_of_nobody")
    with pytest.raises(GraphError, match="its module cannot be imported: No module named"):
        sm.Graph.from_json(broken, imports=True)


def with_contents() -> tuple[sm.Graph, Any]:
    mesh = sm.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    g = sm.Graph()
    values = np.random.default_rng(0).normal(size=5000)
    g.add(norm, values=values)
    g.add(norm, "short", values=[3.0, 4.0])
    g.add(count, mesh=mesh)
    g.param("mesh", mesh)
    return g, (float(np.linalg.norm(values)), 5.0, 2)


def test_meshes_and_arrays_are_saved_beside_the_file(tmp_path: Path) -> None:
    g, results = with_contents()
    g.save(tmp_path / "g.json")
    files = sorted((tmp_path / "g.contents").iterdir())
    assert len(files) == 2, "the mesh once"
    assert (tmp_path / "g.json").stat().st_size < 2000
    again = sm.Graph.load(tmp_path / "g.json")
    assert again.run("norm", "short", "count") == results == g.run("norm", "short", "count")
    assert again.to_json() == g.to_json()
    assert sm.Graph.from_json(g.to_json()).run("norm", "short", "count") == results
    text = files[0].read_text()
    files[0].write_text(text.replace("A", "B"))
    with pytest.raises(GraphError, match="its content is damaged"):
        sm.Graph.load(tmp_path / "g.json")
    files[0].unlink()
    with pytest.raises(GraphError, match=r"its content '.*' is missing"):
        sm.Graph.load(tmp_path / "g.json")


def test_contents_run_nothing() -> None:
    g, _ = with_contents()
    content = json.loads(g.to_json())
    name = next(iter(content["contents"]))
    from spheremesh.nodes.graphs.specification.encoding import content_name

    packed = {"value": ["record", "antigravity", "x", []], "blocks": {}}
    bad = content_name(packed)
    content["contents"][bad] = packed
    text = json.dumps(content).replace(f'"content": "{name}"', f'"content": "{bad}"')
    with pytest.raises(GraphError, match="import the module antigravity first"):
        sm.Graph.from_json(text)
    assert "antigravity" not in sys.modules
