"""Lists: which items go together, in which shape, and only what is new is called."""

from collections import Counter
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import GraphError, NodeError, node

calls = Counter[str]()


class Both(NamedTuple):
    """Sum and product."""

    plus: float
    times: float


def label(a: str, b: str = "", c: str = "") -> str:
    calls["label"] += 1
    return a + b + c


def both(a: float, b: float = 1.0) -> Both:
    return Both(a + b, a * b)


def letters(n: int) -> list[str]:
    return list("abcdefgh"[:n])


def join(texts: list[str]) -> str:
    calls["join"] += 1
    return " ".join(texts)


def count_rows(rows: list[list[str]]) -> int:
    return len(rows)


def fussy(a: float, b: float = 0.0) -> float:
    calls["fussy"] += 1
    if a + b < 0:
        raise ValueError("negative")
    return a + b


def norm(values: NDArray[np.float64]) -> float:
    calls["norm"] += 1
    return float(np.linalg.norm(values))


def opaque(n: int) -> object:
    return iter(range(n))


def count(items: object) -> int:
    calls["count"] += 1
    return len(list(items))  # type: ignore[call-overload]


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    calls.clear()
    toys = (label, both, letters, join, count_rows, fussy, norm, opaque, count)
    for function in toys:
        node(function)


A, B, C = ["a", "b", "c"], ["1", "2"], ["x"]

# Grasshopper's component Longest List, Shortest List, Cross Reference, and one item with many.
MATCHINGS: list[tuple[dict[str, Any], Any]] = [
    ({"a": sm.each(A), "b": sm.each(B)}, ["a1", "b2", "c2"]),
    ({"a": sm.each(B), "b": sm.each(A)}, ["1a", "2b", "2c"]),
    ({"a": sm.each(A, match="longest"), "b": sm.each(C)}, ["ax", "bx", "cx"]),
    ({"a": sm.each(A, match="shortest"), "b": sm.each(B)}, ["a1", "b2"]),
    ({"a": sm.each(A), "b": sm.each(B, match="shortest")}, ["a1", "b2"]),
    ({"a": sm.each(A, match="shortest"), "b": sm.each([])}, []),
    ({"a": sm.each(B, match="same"), "b": sm.each(["y", "z"])}, ["1y", "2z"]),
    ({"a": sm.each(A), "b": "!"}, ["a!", "b!", "c!"]),
    ({"a": sm.each(A), "b": sm.each(B, axis="j")}, [["a1", "a2"], ["b1", "b2"], ["c1", "c2"]]),
    ({"a": sm.each(A), "b": sm.each([], axis="j")}, [[], [], []]),
    ({"a": sm.each([]), "b": sm.each(B, axis="j")}, []),
    (
        {"a": sm.each(B, axis="i"), "b": sm.each(C, axis="j"), "c": sm.each(A, axis="i")},
        [["1xa"], ["2xb"], ["2xc"]],
    ),
    (
        {"a": sm.each(B, axis="i"), "b": sm.each(B, axis="j"), "c": sm.each(B, axis="k")},
        [[["111", "112"], ["121", "122"]], [["211", "212"], ["221", "222"]]],
    ),
    ({"b": sm.each(B, axis="j"), "a": sm.each(C, axis="i")}, [["x1", "x2"]]),
]


@pytest.mark.parametrize(("inputs", "result"), MATCHINGS)
def test_matchings(inputs: dict[str, Any], result: Any) -> None:  # noqa: ANN401
    g = sm.Graph()
    assert g.run(g.add("label", **inputs)) == result
    assert sm.Graph.from_json(g.to_json()).run("label") == result
    assert sm.Graph.from_json(g.to_json()).to_json() == g.to_json()


@given(st.lists(st.integers(1, 4), min_size=1, max_size=3), st.data())
def test_cross_products_are_nested_by_axis(lengths: list[int], data: st.DataObject) -> None:
    node(label)
    lists = [data.draw(st.lists(st.text("ab"), min_size=n, max_size=n)) for n in lengths]
    axes = dict(zip("abc", lists, strict=False))
    g = sm.Graph()
    inputs = {name: sm.each(items, axis=name) for name, items in axes.items()}
    found = g.run(g.add("label", **inputs))

    def at(names: list[str], text: str) -> Any:  # noqa: ANN401
        if not names:
            return text
        return [at(names[1:], text + item) for item in axes[names[0]]]

    assert found == at(list(axes), "")


def test_fields_are_nested_one_by_one() -> None:
    g = sm.Graph()
    step = g.add("both", a=sm.each([1, 2]), b=sm.each([10, 20, 30], axis="j"))
    assert g.run(step).plus == [[11, 21, 31], [12, 22, 32]]
    assert g.run(step.times) == [[10, 20, 30], [20, 40, 60]]


def test_lists_of_different_lengths_are_refused_by_name_where_they_must_not_be() -> None:
    g = sm.Graph()
    step = g.add("label", a=sm.each(A, match="same"), b=sm.each(B))
    with pytest.raises(NodeError, match=r"label\.a has 3 items and label\.b 2: lists of the"):
        g.run(step)


def test_wrong_rules_are_refused_when_wired() -> None:
    with pytest.raises(GraphError, match="match = 'longes': did you mean 'longest'"):
        sm.each(A, match="longes")
    with pytest.raises(GraphError, match="axis = 'a b': use letters"):
        sm.each(A, axis="a b")
    g = sm.Graph()
    with pytest.raises(
        GraphError, match=r"label\.a and label\.b: match='same' contradicts match='shortest'"
    ):
        g.add("label", a=sm.each(A, match="same"), b=sm.each(B, match="shortest"))
    g.add("label", a=sm.each(A, match="same"), b=sm.each(B, match="shortest", axis="j"))
    text = g.to_json().replace('"same"', '"sam"')
    with pytest.raises(GraphError, match=r"steps\.label: each: match = 'sam': did you mean"):
        sm.Graph.from_json(text)


def test_wires_carry_the_levels() -> None:
    g = sm.Graph()
    grid = g.add("label", a=sm.each(A), b=sm.each(B, axis="j"))
    assert g.run(g.add("count_rows", rows=grid)) == 3, "collected: one value"
    rows = g.add("join", texts=sm.each(grid))
    assert g.run(rows) == ["a1 a2", "b1 b2", "c1 c2"]
    with pytest.raises(GraphError, match="list of list of str"):
        g.add("label", a=grid)
    with pytest.raises(GraphError, match="each of"):
        g.add("label", a=sm.each(grid))


def test_one_more_item_is_one_more_call() -> None:
    g = sm.Graph()
    items = g.param("items", [1.0, 2.0, 3.0])
    step = g.add("fussy", a=sm.each(items))
    assert g.run(step) == [1, 2, 3]
    g.set(items=[1.0, 2.0, 3.0, 4.0])
    assert g.run(step) == [1, 2, 3, 4]
    assert calls["fussy"] == 4
    g.set(items=[9.0, 3.0, 1.0])
    assert g.run(step) == [9, 3, 1]
    assert calls["fussy"] == 5, "wherever it stands in the list"
    g.set(items=[2.0, 2.0, 2.0])
    g.run(step)
    assert calls["fussy"] == 5


def test_one_more_item_of_a_wire_is_one_more_call() -> None:
    g = sm.Graph()
    n = g.param("n", 3)
    step = g.add("label", a=sm.each(g.add("letters", n=n)), b="!")
    last = g.add("label", a=sm.each(step), b="?")
    assert g.run(last) == ["a!?", "b!?", "c!?"]
    g.set(n=4)
    assert g.run(last) == ["a!?", "b!?", "c!?", "d!?"]
    assert calls["label"] == 8


def test_one_more_array_is_one_more_call() -> None:
    g = sm.Graph()
    arrays = [np.full(3, float(i)) for i in range(3)]
    g.run(g.add("norm", values=sm.each(arrays)))
    g.run(g.add("norm", values=sm.each([*arrays, np.ones(2)])))
    assert calls["norm"] == 4


def test_items_without_content_are_known_by_their_place() -> None:
    g = sm.Graph()
    step = g.add("count", items=sm.each(g.add("opaque", n=sm.each([1, 2]))))
    assert g.run(step) == [1, 2]
    assert g.run(step) == [1, 2]
    assert calls["count"] == 2


def test_a_failing_item_is_named_and_those_before_it_are_kept() -> None:
    g = sm.Graph()
    items = g.param("items", [1.0, 2.0, -5.0])
    step = g.add("fussy", "check", a=sm.each(items), b=sm.each([0.0, 1.0], axis="j"))
    with pytest.raises(
        NodeError, match=r"step 'check' \(node fussy\) failed at item \[2\]\[0\]: negative"
    ):
        g.run(step)
    calls.clear()
    g.set(items=[1.0, 2.0, 5.0])
    assert g.run(step) == [[1, 2], [2, 3], [5, 6]]
    assert calls["fussy"] == 2
