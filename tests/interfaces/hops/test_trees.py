"""Branches and items: which runs a request asks for, and where their results are."""

import json
from collections.abc import Callable
from typing import Any, TypeAlias

import pytest

from spheremesh.interfaces.hops.trees import read_path, read_trees, write_path
from spheremesh.nodes import fit_spheres, vase_mesh

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any


def number(value: float) -> dict[str, str]:
    return {"type": "System.Double", "data": json.dumps(value)}


def ask(gh: Value, name: str, outputs: list[str], **trees: dict[str, list[Value]]) -> Value:
    values = [{"ParamName": port, "InnerTree": tree} for port, tree in trees.items()]
    return gh.ask(name, values, outputs)


def test_items_of_a_branch_go_side_by_side(gh: Value) -> None:
    items = [{"type": "System.Int32", "data": str(n)} for n in (4, 5, 6)]
    sizes = {"{0}": items}
    found = ask(gh, "vase_mesh", ["mesh"], n_around=sizes, n_across={"{0}": items[:1]})
    assert len(found["mesh"]) == 3
    assert len({each["data"] for each in found["mesh"]}) == 3


def test_lists_of_several_runs_have_branches_of_their_own(opened: Callable[..., Any]) -> None:
    one = opened()
    handle = one.service.solver.handles.give("sphere_mesh", fit_spheres(vase_mesh(8, 4)))
    text = {"type": "System.String", "data": json.dumps(handle)}
    ways = [{"type": "System.String", "data": json.dumps(x)} for x in ("spheres", "planes")]
    angles = ask(
        one.gh, "intersection_angles", ["angles"],
        sphere_mesh={"{2}": [text]}, reference={"{2}": ways},
    )["angles"]  # fmt: skip
    assert list(angles) == ["{2;0}", "{2;1}"]


def test_the_longest_tree_has_the_paths_and_others_repeat_their_last(gh: Value) -> None:
    found = ask(
        gh, "vase_mesh", ["mesh"],
        radius={"{0;5}": [number(1.0)], "{0;7}": [number(2.0)], "{1;0}": [number(3.0)]},
        height={"{0}": [number(4.0)]}, n_around={"{0}": [number(4)]},
    )["mesh"]  # fmt: skip
    assert list(found) == ["{0;5}", "{0;7}", "{1;0}"]
    assert all(len(items) == 1 for items in found.values())


def test_of_equal_trees_the_path_is_that_of_the_deepest(gh: Value) -> None:
    values = [
        {"ParamName": "radius", "InnerTree": {"{0}": [number(1.0)]}},
        {"ParamName": "height", "InnerTree": {"{0;3}": [number(4.0)]}},
        {"ParamName": "amplitude", "InnerTree": {}},
    ]
    body = json.dumps({"pointer": "vase_mesh", "values": values}).encode()
    status, _, content = gh.send("POST", "/solve", body)
    assert status == 200
    assert list(json.loads(content)["values"][0]["InnerTree"]) == ["{0;3}"]


def test_an_input_that_there_is_not_is_named(gh: Value) -> None:
    with pytest.raises(
        Exception, match="vase_mesh has no input 'radus'; did you mean 'radius'"
    ):
        ask(gh, "vase_mesh", ["mesh"], radus={"{0}": [number(1.0)]})


def test_too_many_runs_are_refused(gh: Value) -> None:
    many = {"{0}": [number(1.0)] * 10_001}
    with pytest.raises(Exception, match="more than 10000 runs"):
        ask(gh, "vase_mesh", ["mesh"], radius=many)


def test_paths() -> None:
    for text, path in (
        ("{0}", (0,)),
        ("{0;3;2}", (0, 3, 2)),
        ("4;5", (4, 5)),
        (" {0; 1} ", (0, 1)),
    ):
        assert read_path(text, "here") == path
    assert write_path((0, 3)) == "{0;3}"
    for text in ("", "{}", "{a}", "{-1}", "{0;}", "{0" + ";0" * 40 + "}", "{" + "9" * 12 + "}"):
        with pytest.raises(ValueError, match="is no path"):
            read_path(text, "here")


@pytest.mark.parametrize(
    "values",
    [
        None, {}, [1], [{}], [{"ParamName": 1, "InnerTree": {}}], [{"ParamName": "a"}],
        [{"ParamName": "a", "InnerTree": []}], [{"ParamName": "a", "InnerTree": {"{0}": 1}}],
        [{"ParamName": "a", "InnerTree": {"{0}": [1]}}],
        [{"ParamName": "a", "InnerTree": {}}] * 2,
    ],
)  # fmt: skip
def test_what_is_no_tree_is_refused(values: Value) -> None:
    with pytest.raises(ValueError, match="values"):
        read_trees(values)
