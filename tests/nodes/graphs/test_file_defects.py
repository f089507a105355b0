"""A clear error for each defect of a graph file."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from graph_toys import mix, mixed_graph, quote_graph, split, use_blob

import spheremesh as sm
from spheremesh.nodes import GraphError, node
from spheremesh.nodes.graphs.specification import file


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    for function in (split, mix, quote_graph, use_blob):
        node(function)


Change = Callable[[dict[str, Any]], object]


def _mixed(content: dict[str, Any]) -> dict[str, Any]:
    return content["steps"]["mixed"]["inputs"]


DEFECTS: list[tuple[Change, str]] = [
    (lambda c: c.update(format="grasshopper"), '"format" must be "spheremesh graph"'),
    (lambda c: c.update(version=3), '"version" is 3, this spheremesh reads 1 and 2'),
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
    (lambda c: c.update(version=True), '"version" is True, this spheremesh reads 1 and 2'),
    (lambda c: c["params"]["k"].update(min=[1]), "params.k: param k: min = [1]: must be a num"),
    (
        lambda c: c["params"]["k"].update(value={"array": [1]}, choices=[1, 2]),
        "params.k: param k = float64 array of shape (1,): must be one of 1, 2",
    ),
    (lambda c: c["params"]["k"].update(value=10**30), "params.k.value: a whole number has 64"),
    (
        lambda c: c["params"]["k"].update(value={"each": [1]}),
        "params.k: param k: a slider holds a",
    ),
    (lambda c: _mixed(c).update(limit=float("nan")), "steps.mixed.inputs.limit: no finite"),
    (lambda c: _mixed(c).update(name="\ud800"), "steps.mixed.inputs.name: not Unicode text"),
    (lambda c: c["steps"].update({"a" * 201: 1}), "steps: 'aaa"),
    (lambda c: _mixed(c).update(a={"wire": "split.name"}), "has no output 'name'"),
    (lambda c: _mixed(c).update(a={"wire": "split.low", "dtype": 1}), "cannot read {"),
    (lambda c: _mixed(c).update(a={"each": [1, {"each": [1]}]}), "mixed.a: each within each"),
    (lambda c: _mixed(c).update(a={"each": {"array": 3}}), "mixed.a: each needs a list"),
    (
        lambda c: _mixed(c).update(a={"each": {"wire": "split.low"}}),
        "each needs a list, split.low",
    ),
    (lambda c: _mixed(c).update(limit={"float": "9"}), "expected inf, -inf or nan"),
    (
        lambda c: _mixed(c).update(weights={"array": [99999], "dtype": "int8"}),
        "steps.mixed: cannot read",
    ),
    (
        lambda c: _mixed(c).update(weights={"array": [1.5], "dtype": "int64"}),
        "a number does not fit into int64",
    ),
    (
        lambda c: _mixed(c).update(weights={"array": [None], "dtype": "float64"}),
        "an array holds numbers alone",
    ),
    (
        lambda c: _mixed(c).update(weights={"array": [1], "dtype": "S2000000000"}),
        '"dtype" must be one of float64, ',
    ),
    (
        lambda c: _mixed(c).update(weights={"array": [1], "dtype": "object"}),
        '"dtype" must be one of float64, ',
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
    (lambda c: c.update(groups=[]), '"groups" must be an object, not []'),
    (lambda c: c.update(groups={"a": "split"}), "groups.a must be a list of names of steps"),
    (lambda c: c.update(groups={"a": ["splat"]}), "groups.a: no step 'splat'"),
    (lambda c: c.update(comments={"split": 1}), "comments.split must be a text, not 1"),
    (lambda c: c["steps"]["split"].update(graph=1), 'steps.split: "outputs" is missing'),
    (
        lambda c: c["steps"]["split"].update(graph={"version": 7}, outputs={}),
        'steps.split.graph: "version" is 7',
    ),
    (lambda c: _mixed(c).update(weights={"content": "ab"}), "its content 'ab' is missing"),
    (lambda c: _mixed(c).update(weights={"content": ["../a"]}), "steps.mixed: "),
    (
        lambda c: [c.update(contents={"ab": {}}), _mixed(c).update(weights={"content": "ab"})],
        "steps.mixed: cannot read",
    ),
    (lambda c: _mixed(c).update(a={"each": [1], "match": 3}), "each: match = 3: "),
    (lambda c: _mixed(c).update(a={"each": [1], "axis": "a b"}), "each: axis = 'a b': "),
    (lambda c: c["steps"].update({"a b": c["steps"]["split"]}), "steps.a b: step name 'a b'"),
]


@pytest.mark.parametrize(("change", "message"), DEFECTS, ids=[text for _, text in DEFECTS])
def test_a_defect_of_a_file_is_named(tmp_path: Path, change: Change, message: str) -> None:
    content = json.loads(mixed_graph().to_json())
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
        (b"[" * 70 + b"]" * 70, "nested too deeply"),
        (b'{"format": 1, "format": 2}', "the file: 'format' is given twice"),
        (b'{"a": [{"b": 1, "b": 1}]}', r"a\[0\]: 'b' is given twice"),
        (b'{"a": [1, ' + b"9" * 5000 + b"]}", r"a\[1\]: a whole number has 64 bits"),
        (b'{"a": -Infinity}', "a: no finite number"),
        (b'{"a": 1e999}', "a: no finite number"),
        (b"[" + b"1," * 1_000_001 + b"1]", "more than 1000000 values"),
    ],
)
def test_what_is_no_graph_file(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "graph.json"
    path.write_bytes(data)
    with pytest.raises(GraphError, match=message):
        sm.Graph.load(path)


@pytest.mark.parametrize("kind", ["folder", "pipe", "device"])
def test_only_files_are_read(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "graph.json"
    if kind == "folder":
        path.mkdir()
    elif not hasattr(os, "mkfifo"):
        pytest.skip("there are none")
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero")
    with pytest.raises(GraphError, match=r"graph\.json: not a file: save the graph to one"):
        sm.Graph.load(path)


def test_a_file_that_is_too_long_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "graph.json"
    mixed_graph().save(path)
    monkeypatch.setattr(file, "MOST_BYTES", 100)
    with pytest.raises(GraphError, match=r"graph\.json: longer than 100 bytes"):
        sm.Graph.load(path)


def test_a_cut_off_file_is_refused_at_every_byte() -> None:
    text = mixed_graph().to_json().rstrip()
    for i in range(len(text)):
        with pytest.raises(GraphError, match="not JSON"):
            sm.Graph.from_json(text[:i])


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(GraphError, match=r"none\.json: No such file"):
        sm.Graph.load(tmp_path / "none.json")
