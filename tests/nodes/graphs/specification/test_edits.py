"""Edits: whole or not at all, undone to the byte, and what they say when they do not fit."""

import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from graph_toys import split
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import GraphError, node


def add(a: float, b: float = 1.0) -> float:
    return a + b


def total(values: list[float]) -> float:
    return sum(values)


def spell(text: str) -> str:
    return text


def ramp(n: int) -> NDArray[np.float64]:
    return np.arange(float(n))


def register() -> None:
    for function in (split, add, total, spell, ramp):
        node(function)


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    register()


def example() -> sm.Graph:
    g = sm.Graph("example")
    k = g.param("k", 8.0, min=0)
    parts = g.add(split, value=k)
    low = g.add(add, "low", a=parts.low, b=1)
    g.add(total, values=[low, parts.high, k, 2.0])
    return g


def test_a_step_is_replaced_and_what_it_feeds_is_wired_to_the_new_one() -> None:
    g = example()
    before = g.to_json()
    assert g.run("total") == (2 + 1) + 6 + 8 + 2
    new = g.replace("low", "total", values=[g.steps["split"].low, 5.0])
    assert g.steps["low"] is new
    assert g.run("total") == 7 + 6 + 8 + 2
    with pytest.raises(GraphError, match=r"cannot wire low\.result \(str\) into total\.values"):
        g.replace("low", spell, text="a")
    with pytest.raises(GraphError, match="no step 'lo'; did you mean 'low'"):
        g.replace("lo", spell, text="a")
    assert g.undo()
    assert g.to_json() == before
    assert g.run("total") == 19


def test_inputs_are_rewired_and_cycles_refused() -> None:
    g = example()
    g.rewire("low", b=g.steps["split"].high)
    assert g.run("low") == 8
    late = g.add(add, "late", a=1)
    g.rewire("low", a=late)
    assert list(g.steps) == ["split", "late", "low", "total"], "in order again"
    with pytest.raises(GraphError, match="the steps form a cycle: "):
        g.rewire("late", a=g.steps["total"])
    with pytest.raises(GraphError, match=r"low\.a = 'x': must be float"):
        g.rewire("low", a="x")
    g.unwire("low", "b")
    assert g.run("low") == 3
    assert "b" not in g.steps["low"].inputs


def test_a_step_that_feeds_others_is_not_removed_by_mistake() -> None:
    g = example()
    before = g.to_json()
    with pytest.raises(GraphError, match="step 'low' feeds total: rewire or remove these"):
        g.remove("low")
    assert g.to_json() == before
    g.remove("low", cut=True)
    step = g.steps["total"]
    assert step.unfinished == "step 'total' misses its input 'values' (list of float)"
    with pytest.raises(GraphError, match="step 'total' is not finished: step 'total' misses"):
        g.run("total")
    assert g.run("split.low") == 2, "the others run"
    g.rewire("total", values=[1.0, 2.0])
    assert g.steps["total"].unfinished == ""
    assert g.run("total") == 3
    while g.undo():
        pass
    assert len(g.steps) == 0


def test_names_are_changed_wherever_they_stand() -> None:
    g = example()
    low = g.steps["low"]
    g.group("front", "low", "split")
    g.comment("the lower part", low)
    g.rename(low, "lower")
    g.rename("k", "size")
    assert list(g.steps) == ["split", "lower", "total"]
    assert g.groups == {"front": ("lower", "split")}
    assert g.comments == {"lower": "the lower part"}
    g.set(size=4.0)
    assert g.run("total") == 2 + 3 + 4 + 2
    with pytest.raises(GraphError, match="there is no step 'low' any more"):
        g.run(low)
    with pytest.raises(GraphError, match="there is a step 'split' already"):
        g.rename("lower", "split")
    with pytest.raises(GraphError, match="step name 'a b'"):
        g.rename("lower", "a b")
    assert sm.Graph.from_json(g.to_json()).to_json() == g.to_json()


def test_a_slider_that_is_removed_leaves_its_value() -> None:
    g = example()
    k = g.params["k"]
    g.set(k=4.0)
    g.remove(k)
    assert not g.params
    assert g.run("total") == 2 + 3 + 4 + 2
    with pytest.raises(GraphError, match="there is no param 'k' any more"):
        g.add(add, a=k)


def test_who_holds_a_step_means_what_it_is_now() -> None:
    g = example()
    held = g.steps["low"]
    g.rewire("low", b=10)
    assert g.run(held) == 12
    assert g.run(g.add(add, a=held)) == 13


def test_groups_and_comments() -> None:
    g = example()
    g.group("all", *g.steps)
    g.comment("of the whole")
    with pytest.raises(GraphError, match="no step 'lo'; did you mean 'low'"):
        g.group("x", "lo")
    with pytest.raises(GraphError, match="no step 'lo'"):
        g.comment("x", "lo")
    text = g.to_json()
    assert '"version": 2' in text
    assert sm.Graph.from_json(text).comments == {"": "of the whole"}
    g.remove("total")
    assert g.groups == {"all": ("split", "low")}
    g.group("all")
    g.comment("")
    assert '"version": 1' in g.to_json(), "the oldest that says it all"


def test_copies_are_apart_and_share_results() -> None:
    g = example()
    copy = g.copy()
    copy.set(k=4.0)
    copy.remove("total")
    assert g.run("total") == 19
    assert "total" not in copy.steps
    assert copy.run(g.steps["split"].low) == 1


def test_differences_read_like_a_report() -> None:
    g = example()
    other = g.copy()
    other.set(k=4.0)
    other.rewire("low", b=2)
    other.rename("total", "sum")
    other.group("front", "low")
    other.title = "other"
    assert [str(each) for each in g.diff(other)] == [
        "title: 'example' -> 'other'",
        "params.k.value: 8.0 -> 4.0",
        "steps.low.inputs.b: 1 -> 2",
        "removed steps.total",
        "added steps.sum",
        "added groups.front",
    ]
    assert g.diff(g.copy()) == ()
    assert g.diff(other)[1].after == 4.0


Do = Callable[[sm.Graph, random.Random], object]


def _any(things: Any, chance: random.Random) -> Any:  # noqa: ANN401
    return chance.choice(list(things))


def _given(g: sm.Graph, chance: random.Random) -> Any:  # noqa: ANN401
    options: list[Any] = [chance.random(), *g.params.values()]
    options += [wire for step in g.steps.values() for wire in step.wires]
    return chance.choice(options)


EDITS: list[Do] = [
    lambda g, c: g.add(add, a=_given(g, c), b=_given(g, c)),
    lambda g, c: g.add(split, value=_given(g, c)),
    lambda g, c: g.add(total, values=[_given(g, c), _given(g, c)]),
    lambda g, c: g.add(add, a=sm.each([1.0, _given(g, c)]), b=sm.each([1, 2], axis="j")),
    lambda g, c: g.draft(c.choice(["add", "none", "split"]), f"d{c.randrange(4)}"),
    lambda g, c: g.param(f"p{c.randrange(6)}", c.random()),
    lambda g, c: g.set(**{_any(g.params, c): c.random()}),
    lambda g, c: g.remove(_any(g.params, c)),
    lambda g, c: g.rename(_any(g.params, c), f"p{c.randrange(6)}"),
    lambda g, c: g.remove(_any(g.steps, c), cut=c.random() < 0.7),
    lambda g, c: g.rename(_any(g.steps, c), f"s{c.randrange(9)}"),
    lambda g, c: g.rewire(_any(g.steps, c), a=_given(g, c)),
    lambda g, c: g.unwire(_any(g.steps, c), c.choice("ab")),
    lambda g, c: g.replace(_any(g.steps, c), add, a=_given(g, c)),
    lambda g, c: g.group(c.choice("xy"), *c.sample(list(g.steps), min(2, len(g.steps)))),
    lambda g, c: g.comment(c.choice(["", "said"]), _any(["", *g.steps], c)),
]


@given(st.integers(0, 10**6))
@settings(max_examples=8, deadline=None)
def test_any_edits_undone_give_the_same_bytes(seed: int) -> None:
    register()
    chance = random.Random(seed)  # noqa: S311
    g = example()
    states, texts = [g.specification], {0: g.to_json()}
    while len(states) <= 100:
        try:
            chance.choice(EDITS)(g, chance)
        except (GraphError, IndexError):
            assert g.specification is states[-1], "a refused edit changes nothing"
            continue
        states.append(g.specification)
        if len(states) % 20 == 1:
            texts[len(states) - 1] = g.to_json()
    again = sm.Graph.from_json(texts[100], unfinished=True)
    assert again.to_json() == texts[100], "save and load is the identity"
    for number in reversed(range(100)):
        assert g.undo()
        assert g.specification is states[number]
        assert number not in texts or g.to_json() == texts[number]
    for number in range(1, 101):
        assert g.redo()
        assert number not in texts or g.to_json() == texts[number]
    assert not g.redo()


def test_finished_graphs_run_after_edits() -> None:
    chance = random.Random(3)  # noqa: S311
    g = example()
    for _ in range(300):
        try:
            chance.choice(EDITS)(g, chance)
        except (GraphError, IndexError):
            continue
        for step in g.steps.values():
            for name in step.parents:
                assert list(g.steps).index(name) < list(g.steps).index(step.name)
            for _, source in step.sources:
                if hasattr(source, "step"):
                    assert source.step is g.steps[source.step.name], "wired to what is here"
