"""Edits in JSON: another graph, or one sentence why not; code that makes a graph again."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh.interfaces.studio.code import python_code
from spheremesh.interfaces.studio.document import Document, StaleError, opened
from spheremesh.interfaces.studio.operations import applied
from spheremesh.interfaces.studio.templates import TEMPLATES, Design, template_graph
from spheremesh.nodes import Graph, GraphError, each
from spheremesh.nodes.graphs.specification.file import content_of, encode_graph
from spheremesh.nodes.graphs.specification.specification import Specification, frozen

Value = Any


def changed(graph: Graph | Specification, *operations: Value) -> dict[str, Value]:
    before = graph if isinstance(graph, Specification) else graph.specification
    contents: dict[str, Value] = {}
    content_of(before, contents)
    return content_of(applied(before, operations, contents))


@pytest.mark.parametrize(
    ("operation", "message"),
    [
        ({"op": "fly"}, "no operation 'fly'"),
        ({}, "no operation"),
        ({"op": "add"}, "misses or mistakes 'node'"),
        ({"op": "add", "node": "fit_sphere"}, "did you mean 'fit_spheres'"),
        ({"op": "add", "node": "fit_spheres", "name": "fit"}, "a step 'fit' already"),
        ({"op": "add", "node": "fit_spheres", "name": "a b"}, "letters, digits"),
        (
            {"op": "give", "step": "panels", "port": "labels", "value": {"wire": "mesh"}},
            r"cannot wire mesh.result \(Mesh\) into panels.labels",
        ),
        ({"op": "give", "step": "fit", "port": "rings", "value": 1}, "did you mean 'ring'"),
        ({"op": "give", "step": "fit", "port": "ring", "value": 99}, "at most 10"),
        ({"op": "give", "step": "fit", "port": "ring", "value": {"wire": 5}}, "no step '5'"),
        ({"op": "give", "step": "no", "port": "ring", "value": 1}, "no step 'no'"),
        (
            {"op": "give", "step": "fit", "port": "mesh", "value": {"wire": "few.radii"}},
            "cannot wire",
        ),
        ({"op": "set", "param": "moulds", "value": 0}, "at least 1"),
        ({"op": "set", "param": "mould", "value": 3}, "did you mean 'moulds'"),
        ({"op": "slider", "name": "moulds", "value": 3, "limits": {"min": 4}}, "at least 4"),
        ({"op": "rename", "kind": "steps", "old": "fit", "new": "few"}, "'few' already"),
        ({"op": "move", "steps": {"nobody": [1, 2]}}, "no 'nobody'"),
        ({"op": "move", "steps": {"fit": [1]}}, "misses or mistakes"),
        ({"op": "group", "name": " ", "steps": ["fit"]}, "needs a name"),
        ({"op": "group", "name": "a", "steps": ["nobody"]}, "no step"),
        ({"op": "units", "units": "miles"}, "must be one of"),
        ({"op": "paste", "graph": {"steps": {"x": {"node": 5}}}}, "inputs"),
    ],
)
def test_what_cannot_be_done_is_said_and_nothing_is_changed(
    vase: Graph, operation: Value, message: str
) -> None:
    before = vase.to_json()
    first = {"op": "title", "text": "changed before"}
    with pytest.raises(GraphError, match=message):
        applied(vase.specification, [first, operation], {})
    assert vase.to_json() == before


def test_a_wrong_wire_is_refused_at_an_unfinished_step_as_well(vase: Graph) -> None:
    add = {"op": "add", "node": "panels", "name": "more"}
    give = {"op": "give", "step": "more", "port": "labels", "value": {"wire": "mesh"}}
    with pytest.raises(GraphError, match="cannot wire mesh"):
        applied(vase.specification, [add, give], {})
    found = changed(vase, add, {**give, "value": {"wire": "few.labels"}})
    assert found["steps"]["more"]["inputs"] == {"labels": {"wire": "few.labels"}}


def test_a_removed_step_leaves_those_that_it_fed_unfinished(vase: Graph) -> None:
    contents: dict[str, Value] = {}
    place = {"op": "move", "steps": {"fit": [3.4, 5.6], "mesh": [0, 0]}}
    after = applied(vase.specification, [place, {"op": "remove", "steps": ["fit"]}], contents)
    assert "sphere_mesh" in after.steps["few"].unfinished
    assert after.extra["canvas"]["steps"] == {"mesh": [0, 0]}
    again = {"op": "add", "node": "fit_spheres", "name": "fit"}
    feeds = [
        {"op": "give", "step": "fit", "port": "mesh", "value": {"wire": "mesh"}},
        {"op": "give", "step": "few", "port": "sphere_mesh", "value": {"wire": "fit"}},
    ]
    whole = applied(after, [again, *feeds], contents)
    assert not any(step.unfinished for step in whole.steps.values())


def test_names_change_wherever_they_stand(vase: Graph) -> None:
    found = changed(
        vase,
        {"op": "pin", "outputs": ["panels.panels", "panels_2.x"]},
        {"op": "move", "steps": {"panels": [1, 2]}, "params": {"moulds": [3, 4]}},
        {"op": "group", "name": "All", "steps": ["fit", "panels"]},
        {"op": "group", "name": "Some", "steps": ["panels"]},
        {"op": "rename", "kind": "steps", "old": "panels", "new": "skin"},
        {"op": "rename", "kind": "params", "old": "moulds", "new": "k"},
    )
    assert found["canvas"] == {
        "steps": {"skin": [1, 2]},
        "params": {"k": [3, 4]},
        "pins": ["skin.panels", "panels_2.x"],
    }
    assert found["groups"] == {"All": ["fit"], "Some": ["skin"]}
    assert found["steps"]["few"]["inputs"]["k"] == {"param": "k"}


def test_a_slider_takes_the_place_of_a_value_and_goes_again(vase: Graph) -> None:
    found = changed(
        vase,
        {"op": "slider", "name": "n", "value": 8, "limits": {"min": 4, "max": 40},
         "feeds": [["mesh", "n_around"]], "at": [5, 6]},
        {"op": "slider", "name": "n", "value": 9, "limits": {"min": 5}},
    )  # fmt: skip
    assert found["params"]["n"] == {"value": 9, "min": 5}
    assert found["steps"]["mesh"]["inputs"]["n_around"] == {"param": "n"}
    assert (
        changed(vase, {"op": "remove", "params": ["moulds"]})["steps"]["few"]["inputs"]["k"]
        == 3
    )


def test_pasted_steps_are_wired_among_themselves_and_unknown_ones_stay(vase: Graph) -> None:
    steps = json.loads(vase.to_json())["steps"]
    odd = {"node": "gone", "version": "3", "inputs": {"x": {"wire": "few.radii"}}, "own": [1]}
    lost = {"node": "fit_spheres", "version": "1", "inputs": {"mesh": {"wire": "nowhere"}}}
    fragment = {
        "steps": {"few": steps["few"], "panels": steps["panels"], "odd": odd, "lost": lost},
        "params": {"moulds": {"value": 5, "min": 1}},
        "canvas": {"steps": {"few": [0, 0]}, "params": {"moulds": [-200, 0]}},
    }
    found = changed(vase, {"op": "paste", "graph": fragment, "by": [10, 20]})
    assert found["params"]["moulds_2"] == {"value": 5, "min": 1}
    assert found["steps"]["few_2"]["inputs"]["k"] == {"param": "moulds_2"}
    assert found["steps"]["few_2"]["inputs"]["sphere_mesh"] == {"wire": "fit"}
    assert found["steps"]["panels_2"]["inputs"]["labels"] == {"wire": "few_2.labels"}
    assert found["steps"]["odd"] == {**odd, "inputs": {"x": {"wire": "few_2.radii"}}}
    assert found["steps"]["lost"]["inputs"] == {}
    assert found["canvas"] == {"steps": {"few_2": [10, 20]}, "params": {"moulds_2": [-190, 20]}}


def test_a_mesh_in_the_graph_outlives_edits(vase: Graph) -> None:
    mesh = vase.run("mesh")
    vase.rewire("fit", mesh=mesh)
    before = vase.specification
    contents: dict[str, Value] = {}
    content = content_of(before, contents)
    fit = content["steps"]["fit"]
    after = applied(before, [{"op": "paste", "graph": {"steps": {"fit": fit}}}], contents)
    kept = after.steps["fit_2"].inputs["mesh"]
    np.testing.assert_array_equal(kept.vertices, mesh.vertices)


KINDS = st.sampled_from([
    {"op": "title", "text": "a"}, {"op": "set", "param": "moulds", "value": 4},
    {"op": "set", "param": "moulds", "value": 5}, {"op": "take", "step": "few", "port": "k"},
    {"op": "remove", "steps": ["panels"]}, {"op": "move", "steps": {"fit": [1, 1]}},
    {"op": "comment", "text": "said"}, {"op": "add", "node": "planarity"},
])  # fmt: skip


@settings(max_examples=30, deadline=None)
@given(st.lists(KINDS, max_size=6))
def test_undo_gives_the_same_bytes_and_redo_as_well(operations: list[Value]) -> None:
    graph = Graph("Vase")
    few = graph.add("cluster_radii", "few", sphere_mesh=_fit(graph), k=graph.param("moulds", 3))
    graph.add("panels", "panels", sphere_mesh=few.sphere_mesh)
    document = Document(graph.specification)
    texts = [encode_graph(document.specification)]
    for operation in operations:
        before = document.rev
        try:
            document.edit(before, [operation])
        except GraphError:
            continue
        if document.rev == before:
            continue  # what changes nothing is nothing to undo
        texts.append(encode_graph(document.specification))
    for text in reversed(texts[:-1]):
        document.undo()
        assert encode_graph(document.specification) == text
    for text in texts[1:]:
        document.redo()
        assert encode_graph(document.specification) == text


def _fit(graph: Graph) -> Value:
    return graph.add("fit_spheres", "fit", mesh=graph.add("vase_mesh", "mesh", n_around=6))


def test_a_drag_is_undone_as_a_whole_and_old_revisions_are_refused(vase: Graph) -> None:
    document = Document(vase.specification)
    for k in (4, 5, 6):
        document.edit(document.rev, [{"op": "set", "param": "moulds", "value": k}], "drag 1")
    document.edit(document.rev, [{"op": "set", "param": "moulds", "value": 7}], "drag 2")
    assert document.content()["undo"] == 2
    with pytest.raises(StaleError):
        document.edit(document.rev - 1, [{"op": "title", "text": ""}])
    document.undo()
    assert document.specification.values["moulds"] == 6
    document.undo()
    assert document.specification.values["moulds"] == 3
    document.undo()
    assert document.rev == 7


def test_what_a_graph_file_says_besides_is_kept(vase: Graph, tmp_path: Any) -> None:  # noqa: ANN401
    content = json.loads(vase.to_json())
    content |= {"canvas": {"own": 3, "steps": "no places"}, "theirs": [1, 2]}
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(content))
    found = changed(opened(path), {"op": "move", "steps": {"fit": [1, 2]}})
    assert found["canvas"] == {"steps": {"fit": [1, 2]}, "own": 3}
    assert found["theirs"] == [1, 2]


@pytest.mark.parametrize("name", TEMPLATES)
def test_the_code_of_a_template_makes_it_again(name: str) -> None:
    graph = template_graph(name)
    made = _executed(python_code(graph))
    assert made.to_json() == encode_graph(replace(graph, extra=frozen({})))
    assert all(pin.split(".")[0] in graph.steps for pin in graph.extra["canvas"]["pins"])


def test_code_of_awkward_names_and_values() -> None:
    graph = Graph('A "title" \\')
    step = graph.param("nodes", 2.5, min=0)
    graph.add("similarity", "np", scale=step, translation=np.array([1.0, 2, 3]))
    graph.add("sphere_rows", "class_", centers=[[0, 0, 0.0]], radii=float("inf"))
    graph.add("vase_mesh", "nodes", n_around=each([6, 8]))
    graph.group("Those", "np")
    graph.comment("said of all")
    graph.draft("fit_spheres", "open")
    text = python_code(graph.specification)
    assert "# open (fit_spheres): " in text
    graph.remove("open")
    assert _executed(text).to_json() == graph.to_json()


def _executed(text: str) -> Graph:
    names: dict[str, Value] = {"__name__": "made"}
    exec(compile(text, "made.py", "exec"), names)  # noqa: S102
    return names["graph"]


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_templates_fit_a_mesh_of_ones_own(scale: float) -> None:
    """Lengths are shares of its edges, whatever it is measured in."""
    plain, other = (
        {
            name: (graph.values[name], param.port.min, param.port.max)
            for name, param in graph.params.items()
            if name != "moulds"
        }
        for graph in (
            template_graph("beams", Design("a.obj", edge)) for edge in (1.3, 1.3 * scale)
        )
    )
    for name, lengths in plain.items():
        assert other[name] == pytest.approx([scale * length for length in lengths])
    start = template_graph("quads", Design("a.obj", 2.0)).steps["mesh"]
    assert (start.node.name, start.inputs["path"]) == ("read_mesh", "a.obj")


@pytest.mark.parametrize("name", ["moulds", "angle", "study"])
def test_templates_run(name: str) -> None:
    graph = Graph()
    graph._specification = template_graph(name)
    pins = graph.specification.extra["canvas"]["pins"]
    states: dict[str, str] = {}
    graph.run(*pins, on_step=states.__setitem__)
    assert {pin.partition(".")[0] for pin in pins} <= states.keys()
    assert set(states.values()) <= {"done", "cached"}
