"""Graph files: the same graph again, diffable, and old ones too."""

import difflib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from graph_toys import Blob, mix, mixed_graph, quote_graph, split, use_blob

import spheremesh as sm
from spheremesh.nodes import GraphError, node
from spheremesh.nodes.graphs.node import running_graph
from spheremesh.nodes.graphs.specification import reading


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    for function in (split, mix, quote_graph, use_blob):
        node(function)


def test_a_loaded_graph_is_the_same(tmp_path: Path) -> None:
    g = mixed_graph()
    g.set(k=12)
    path = tmp_path / "graph.json"
    g.save(path)
    again = sm.Graph.load(path)
    assert again.to_json() == g.to_json()
    assert again.mermaid() == g.mermaid()
    assert (again.title, again.units) == ("Dachfläche", "mm")
    assert again.run("mixed", "mapped") == g.run("mixed", "mapped")
    with pytest.raises(GraphError, match="param k = 61: must be at least 1 and at most 60"):
        again.set(k=61)
    with pytest.raises(GraphError, match="param kind = 'slow': must be one of 'best', 'fast'"):
        again.set(kind="slow")


def test_the_form_of_the_file() -> None:
    content = json.loads(mixed_graph().to_json())
    assert content["params"]["k"] == {"value": 8, "min": 1, "max": 60}
    assert content["steps"]["split"]["inputs"] == {"value": {"param": "k"}}
    assert list(content["steps"]["mixed"]["inputs"]) == [
        "a",
        "weights",
        "facts",
        "limit",
        "name",
    ]
    assert content["steps"]["mixed"]["inputs"]["a"] == {"wire": "split.high"}
    assert content["steps"]["mapped"]["inputs"]["a"] == {
        "each": [1, {"wire": "split.low"}, {"param": "k"}]
    }


def test_one_change_is_one_line() -> None:
    g = mixed_graph()
    before = g.to_json()
    g.set(k=9)
    lines = difflib.unified_diff(before.splitlines(), g.to_json().splitlines(), n=0)
    changed = [line for line in lines if line[0] in "+-" and line[:3] not in ("+++", "---")]
    assert changed == ['-      "value": 8,', '+      "value": 9,']


def test_saving_replaces_only_with_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "graph.json"
    g = mixed_graph()
    g.save(path)
    before = path.read_bytes()
    g.add(use_blob, blob=Blob())
    with pytest.raises(
        GraphError, match=r"use_blob\.blob: a Blob cannot be written into a graph"
    ):
        g.save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["graph.json"]


def test_a_step_may_stand_before_what_it_needs() -> None:
    content = json.loads(mixed_graph().to_json())
    content["steps"] = dict(reversed(content["steps"].items()))
    g = sm.Graph.from_json(json.dumps(content))
    assert list(g.steps) == ["split", "mapped", "mixed"]
    assert g.run("mixed") == mixed_graph().run("mixed")


def test_another_version_of_a_node_is_told() -> None:
    text = mixed_graph().to_json()
    node(version="2")(split)
    with pytest.warns(
        UserWarning, match="'split' was saved with version 1 of node split, this"
    ):
        sm.Graph.from_json(text)


def test_a_writer_can_keep_its_graph() -> None:
    assert running_graph() == ""
    g = sm.Graph("mine")
    text = g.run(g.add(quote_graph))
    assert sm.Graph.from_json(text).title == "mine"
    assert running_graph() == ""
    blob = g.add(use_blob, blob=Blob())
    assert g.run(blob) == "Blob", "without a form in JSON there is no text"


def test_mermaid() -> None:
    lines = mixed_graph().mermaid().splitlines()
    assert lines[0] == "flowchart LR"
    assert '  param_k(["k = 8"])' in lines
    assert '  step_mixed["mixed (mix)"]' in lines
    assert "  param_k -->|value| step_split" in lines
    assert "  step_split -->|high to a| step_mixed" in lines
    assert "  step_split ==>|low to a| step_mapped" in lines


def test_arrays_of_all_kinds_stay_as_they_are() -> None:
    floats = [[np.finfo(kind).max, -np.inf, 0.1] for kind in (np.float16, np.float32, float)]
    integers = [
        [np.iinfo(kind).min, 7, np.iinfo(kind).max] for kind in (np.int8, np.uint8, np.int64)
    ]
    rows = [*floats, *integers, [0, 2**64 - 1], [False, True], []]
    names = [
        "float16",
        "float32",
        "float64",
        "int8",
        "uint8",
        "int64",
        "uint64",
        "bool",
        "int8",
    ]
    for row, name in zip(rows, names, strict=True):
        g = sm.Graph()
        g.param("a", np.array(row, name))
        again = sm.Graph.from_json(g.to_json())
        assert again.to_json() == g.to_json()
        value = again.params["a"].value
        assert value.dtype == name
        np.testing.assert_array_equal(value, np.array(row, name))


def test_many_steps_in_the_wrong_order_are_quickly_in_order() -> None:
    content = json.loads(sm.Graph().to_json())
    step = {"node": "mix", "version": "1"}
    steps = {f"s{i}": {**step, "inputs": {"a": {"wire": f"s{i - 1}"}}} for i in range(1, 2000)}
    steps["s0"] = {**step, "inputs": {"a": 1}}
    content["steps"] = dict(reversed(steps.items()))
    g = sm.Graph.from_json(json.dumps(content))
    assert list(g.steps) == [f"s{i}" for i in range(2000)]


def test_ports_of_old_files_are_read_by_their_present_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = mixed_graph().to_json()
    old = text.replace('"weights":', '"loads":').replace('"value": {', '"number": {')
    old = old.replace("split.high", "split.upper")
    with pytest.raises(GraphError, match=r"steps\.split: .* has no input 'number'"):
        sm.Graph.from_json(old)
    renamed = {"mix": {"loads": "weights"}, "split": {"number": "value", "upper": "high"}}
    monkeypatch.setattr(reading, "RENAMED_PORTS", renamed)
    assert sm.Graph.from_json(old).to_json() == text
    # a port that has gone is passed over
    gone = json.loads(text)
    gone["steps"]["mixed"]["inputs"]["seed"] = 7
    monkeypatch.setattr(reading, "RENAMED_PORTS", {"mix": {"seed": ""}})
    assert sm.Graph.from_json(json.dumps(gone)).to_json() == text
    # a present name is never taken for an old one
    monkeypatch.setattr(
        reading, "RENAMED_PORTS", {"mix": {"a": "limit"}, "split": {"low": "high"}}
    )
    assert sm.Graph.from_json(text).to_json() == text


def test_the_table_of_renamed_ports_names_present_ports() -> None:
    code = """
from spheremesh.nodes.graphs.specification.reading import RENAMED_PORTS
from spheremesh.nodes.graphs.node import find_node
for name, ports in RENAMED_PORTS.items():
    found = find_node(name)
    for old, new in ports.items():
        assert not new or new in found.inputs or new in found.outputs, (name, new)
        assert old not in found.inputs or old not in found.outputs, (name, old)
"""
    subprocess.run([sys.executable, "-c", code], check=True)
