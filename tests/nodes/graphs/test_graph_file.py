"""Graph files: the same graph again, diffable, and a clear error for each defect."""

import difflib
import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import GraphError, node
from spheremesh.nodes.graphs import file
from spheremesh.nodes.graphs.node import running_graph


class Parts(NamedTuple):
    """Low and high."""

    low: float
    high: float


def split(value: float) -> Parts:
    return Parts(value / 4, 3 * value / 4)


def mix(
    a: float,
    weights: NDArray[np.float64] | None = None,
    facts: Mapping[str, Any] | None = None,
    limit: float = 1.0,
    name: str = "",
) -> float:
    total = 0.0 if weights is None else float(weights.sum())
    return a + total + len(facts or {}) + min(limit, 100) + len(name)


def quote_graph() -> str:
    return running_graph()


class Blob:
    """Has a content, but no form in JSON."""

    def content_key(self) -> bytes:
        """Equal for all."""
        return b""


def use_blob(blob: Blob) -> str:
    return running_graph() + type(blob).__name__


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    for function in (split, mix, quote_graph, use_blob):
        node(function)


def example() -> sm.Graph:
    g = sm.Graph("Dachfläche", units="mm")
    k = g.param("k", 8, min=1, max=60)
    g.param("kind", "best", choices=["best", "fast"])
    parts = g.add(split, value=k)
    g.add(
        mix, "mixed", name="x", a=parts.high, limit=float("inf"), facts={"a": [1, None]},
        weights=np.array([[1.5, 2.5]]),
    )  # fmt: skip
    g.add(mix, "mapped", a=sm.each([1, parts.low, k]), weights=[1, 2])
    return g


def test_a_loaded_graph_is_the_same(tmp_path: Path) -> None:
    g = example()
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
    content = json.loads(example().to_json())
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
    g = example()
    before = g.to_json()
    g.set(k=9)
    lines = difflib.unified_diff(before.splitlines(), g.to_json().splitlines(), n=0)
    changed = [line for line in lines if line[0] in "+-" and line[:3] not in ("+++", "---")]
    assert changed == ['-      "value": 8,', '+      "value": 9,']


def test_saving_replaces_only_with_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "graph.json"
    g = example()
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
    content = json.loads(example().to_json())
    content["steps"] = dict(reversed(content["steps"].items()))
    g = sm.Graph.from_json(json.dumps(content))
    assert list(g.steps) == ["split", "mapped", "mixed"]
    assert g.run("mixed") == example().run("mixed")


def test_another_version_of_a_node_is_told() -> None:
    text = example().to_json()
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
    lines = example().mermaid().splitlines()
    assert lines[0] == "flowchart LR"
    assert '  param_k(["k = 8"])' in lines
    assert '  step_mixed["mixed (mix)"]' in lines
    assert "  param_k -->|value| step_split" in lines
    assert "  step_split -->|high to a| step_mixed" in lines
    assert "  step_split ==>|low to a| step_mapped" in lines


Change = Callable[[dict[str, Any]], object]


def _mixed(content: dict[str, Any]) -> dict[str, Any]:
    return content["steps"]["mixed"]["inputs"]


DEFECTS: list[tuple[Change, str]] = [
    (lambda c: c.update(format="grasshopper"), '"format" must be "spheremesh graph"'),
    (lambda c: c.update(version=2), '"version" is 2, this spheremesh reads 1'),
    (lambda c: c.pop("title"), '"title" is missing'),
    (lambda c: c.update(title=[1]), '"title" must be a text, not [1]'),
    (lambda c: c.update(units="km"), "units = 'km': must be one of mm, cm, m, in, ft"),
    (lambda c: c.update(steps=[]), '"steps" must be an object, not []'),
    (lambda c: c["params"].update(k=3), "params.k must be an object, not 3"),
    (lambda c: c["params"]["k"].pop("value"), 'params.k: "value" is missing'),
    (
        lambda c: c["params"]["k"].update(mx=3),
        "params.k: unknown entry 'mx'; did you mean 'max'?",
    ),
    (lambda c: c["params"]["k"].update(max=3), "params.k: param k = 8: must be at least 1 and"),
    (lambda c: c["params"]["k"].update(max="a"), "params.k"),
    (lambda c: c["params"]["kind"].update(choices=3), "params.kind"),
    (lambda c: c["steps"]["split"].pop("node"), 'steps.split: "node" is missing'),
    (lambda c: c["steps"].update(split=None), "steps.split must be an object, not null"),
    (
        lambda c: c["steps"]["split"].update(node="splat"),
        "steps.split: unknown node 'splat'; did you mean 'split'?",
    ),
    (lambda c: _mixed(c).update(b=1), "steps.mixed: step 'mixed' (node mix) has no input 'b'"),
    (lambda c: _mixed(c).update(a="x"), "steps.mixed: mixed.a = 'x': must be float"),
    (lambda c: _mixed(c).update(a={"wire": 3}), 'steps.mixed: cannot read {"wire": 3}'),
    (
        lambda c: _mixed(c).update(a={"wine": "split"}),
        'cannot read {"wine": "split"}: expected',
    ),
    (
        lambda c: _mixed(c).update(a={"param": "kk"}),
        "steps.mixed: no param 'kk'; did you mean 'k'?",
    ),
    (
        lambda c: _mixed(c).update(a={"wire": "splitt.low"}),
        "steps.mixed: wired to an unknown step 'splitt'; did you mean 'split'?",
    ),
    (
        lambda c: _mixed(c).update(a={"wire": "split.hihg"}),
        "steps.mixed: step 'split' (node split) has no output 'hihg'; did you mean 'high'?",
    ),
    (lambda c: _mixed(c).update(weights={"array": [[1], [2, 3]]}), "steps.mixed: cannot read"),
    (
        lambda c: _mixed(c).update(weights={"array": [1], "dtype": "wide"}),
        "steps.mixed: cannot",
    ),
    (
        lambda c: c["steps"]["split"]["inputs"].update(value={"wire": "mixed"}),
        "the steps form a cycle: ",
    ),
    (lambda c: _mixed(c).update(a={"wire": "mixed"}), "the steps form a cycle: mixed -> mixed"),
    (lambda c: c["steps"].update({"a b": c["steps"]["split"]}), "steps.a b: step name 'a b'"),
]


@pytest.mark.parametrize(("change", "message"), DEFECTS, ids=[text for _, text in DEFECTS])
def test_a_defect_of_a_file_is_named(tmp_path: Path, change: Change, message: str) -> None:
    content = json.loads(example().to_json())
    change(content)
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(GraphError) as error:
        sm.Graph.load(path)
    assert str(error.value).startswith(f"{path}: ")
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "line 1: not JSON"),
        (b'{\n "format": ', "line 2: not JSON"),
        (b"[1]", "not a graph file"),
        (b"\xff\xfe", "not UTF-8"),
        (b"[" * 100_000, "nested too deeply"),
    ],
)
def test_what_is_no_graph_file(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "graph.json"
    path.write_bytes(data)
    with pytest.raises(GraphError, match=message):
        sm.Graph.load(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(GraphError, match=r"none\.json: No such file"):
        sm.Graph.load(tmp_path / "none.json")


def test_ports_of_old_files_are_read_by_their_present_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = example().to_json()
    old = text.replace('"weights":', '"loads":').replace('"value": {', '"number": {')
    old = old.replace("split.high", "split.upper")
    with pytest.raises(GraphError, match=r"steps\.split: .* has no input 'number'"):
        sm.Graph.from_json(old)
    renamed = {"mix": {"loads": "weights"}, "split": {"number": "value", "upper": "high"}}
    monkeypatch.setattr(file, "RENAMED_PORTS", renamed)
    assert sm.Graph.from_json(old).to_json() == text
    # a present name is never taken for an old one
    monkeypatch.setattr(
        file, "RENAMED_PORTS", {"mix": {"a": "limit"}, "split": {"low": "high"}}
    )
    assert sm.Graph.from_json(text).to_json() == text


def test_the_table_of_renamed_ports_names_present_ports() -> None:
    code = """
from spheremesh.nodes.graphs.file import RENAMED_PORTS
from spheremesh.nodes.graphs.node import find_node
for name, ports in RENAMED_PORTS.items():
    found = find_node(name)
    for old, new in ports.items():
        assert new in found.inputs or new in found.outputs, (name, new)
        assert old not in found.inputs or old not in found.outputs, (name, old)
"""
    subprocess.run([sys.executable, "-c", code], check=True)
