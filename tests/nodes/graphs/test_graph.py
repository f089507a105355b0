"""What the graph promises: lazy, only once, safe results, messages."""

import time
from collections import Counter
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import (
    NodeError,
    NodeWarning,
    Units,
    node,
    warn,
)
from spheremesh.nodes.graphs.node import running_graph
from spheremesh.nodes.graphs.stores.memory import MemoryStore


class Split(NamedTuple):
    """Two parts."""

    low: float
    high: float


calls = Counter[str]()


def number(value: float = 1.0) -> float:
    calls["number"] += 1
    return value


def add(a: float, b: float = 0.0) -> float:
    calls["add"] += 1
    return a + b


def split(value: float) -> Split:
    calls["split"] += 1
    return Split(value / 4, 3 * value / 4)


def total(values: list[float]) -> float:
    calls["total"] += 1
    return sum(values)


def ramp(n: int) -> NDArray[np.float64]:
    calls["ramp"] += 1
    return np.arange(float(n))


def mean(values: NDArray[np.float64]) -> float:
    calls["mean"] += 1
    return float(values.mean())


def describe(value: float) -> Mapping[str, Any]:
    calls["describe"] += 1
    return {"value": value, "parts": [value]}


def fussy(value: float) -> float:
    calls["fussy"] += 1
    if value < 0:
        raise ValueError("value must not be negative: take its square")
    if value > 10:
        warn(f"{value} is large")
    return value


def tell_units(units: Units = "m") -> str:
    return units


TOYS = (
    number,
    add,
    split,
    total,
    ramp,
    mean,
    describe,
    fussy,
    tell_units,
)


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    calls.clear()
    for function in TOYS:
        node(function)


def test_only_what_the_target_needs_runs() -> None:
    g = sm.Graph()
    a = g.add("number", value=2)
    g.add("mean", values=[1.0])
    total = g.add("add", a=a, b=1)
    assert g.run(total) == 3
    assert calls == {"number": 1, "add": 1}


def test_only_what_depends_on_a_slider_runs_again() -> None:
    g = sm.Graph()
    k = g.param("k", 1)
    fixed = g.add("number", value=5)
    moved = g.add("add", a=fixed, b=k)
    assert g.run(moved) == 6
    g.set(k=2)
    assert g.run(moved) == 7
    assert calls == {"number": 1, "add": 2}


def test_an_old_slider_value_costs_nothing() -> None:
    g = sm.Graph()
    k = g.param("k", 1)
    target = g.add("add", a=g.add("number", value=k), b=k)
    for value in (1, 2, 1, 2, 1):
        g.set(k=value)
        assert g.run(target) == 2 * value
    assert calls == {"number": 2, "add": 2}


def test_a_cached_result_does_not_ask_for_its_forgotten_ancestors() -> None:
    store = MemoryStore()
    g = sm.Graph(cache=store)
    k = g.param("k", 0)
    b = g.add("add", a=g.add("number", value=k))
    g.run(b)
    keys = list(store._entries)
    store._drop(keys[0])
    assert g.run(b) == 0
    assert calls["number"] == 1, "it is not asked for"
    g.run("number")
    assert calls["number"] == 2


def test_results_are_forgotten_when_they_are_too_many_bytes() -> None:
    store = MemoryStore(most_bytes=200_000)
    g = sm.Graph(cache=store)
    n = g.param("n", 1000)
    mean = g.add("mean", values=g.add("ramp", n=n))
    for move in range(200):
        g.set(n=1000 + move)
        assert g.run(mean) == (999 + move) / 2
        assert store.size <= store.most_bytes
    assert calls == {"ramp": 200, "mean": 200}
    g.set(n=1199)
    g.run(mean)
    assert calls["ramp"] == 200, "those of late are kept"


def test_more_steps_than_the_store_has_room_for() -> None:
    store = MemoryStore(most_bytes=4000)
    g = sm.Graph(cache=store)
    step = g.add("number", value=0)
    for _ in range(1500):
        step = g.add("add", a=step, b=1)
    assert g.run(step) == 1500
    assert g.run(step) == 1500
    assert store.size <= 4000
    assert calls == {"number": 1, "add": 1500}


def test_targets() -> None:
    g = sm.Graph()
    k = g.param("k", 4)
    parts = g.add("split", value=k)
    assert g.run(parts) == Split(1, 3)
    assert g.run(parts.high, parts.low, k) == (3, 1, 4)
    assert g.run("split.low") == 1
    assert calls == {"split": 1}
    assert g.ends == (parts,)


def test_equal_steps_share_their_result() -> None:
    g = sm.Graph()
    assert g.run(g.add("number", value=2), g.add("number", value=2)) == (2, 2)
    assert list(g.steps) == ["number", "number_2"]
    assert calls == {"number": 1}


def test_a_default_given_or_not_is_the_same() -> None:
    g = sm.Graph()
    g.run(g.add("add", a=1), g.add("add", b=0.0, a=1))
    assert calls == {"add": 1}


def test_arrays_are_known_by_content() -> None:
    g = sm.Graph()
    a = np.arange(4.0)
    b = np.arange(8.0)[::2] / 2
    g.run(g.add("mean", values=a), g.add("mean", values=b))
    assert calls == {"mean": 1}
    g.run(g.add("mean", values=a.reshape(2, 2)), g.add("mean", values=a.astype(np.float32)))
    assert calls == {"mean": 3}
    a[0] = 100
    assert g.run("mean") == 26.5, "a literal that has changed is a new one"


def test_lists_become_arrays() -> None:
    g = sm.Graph()
    assert g.run(g.add("mean", values=[1, 2, 6])) == 3


def test_a_list_of_wires() -> None:
    g = sm.Graph()
    k = g.param("k", 3)
    parts = g.add("split", value=4)
    sum_of = g.add("total", values=[g.add("number", value=1), parts.high, k, 10.0])
    assert g.run(sum_of) == 1 + 3 + 3 + 10
    g.set(k=4)
    assert g.run(sum_of) == 18
    assert calls == {"number": 1, "split": 1, "total": 2}
    again = sm.Graph.from_json(g.to_json())
    assert again.run("total") == 18


def test_results_are_read_only() -> None:
    g = sm.Graph()
    array = g.run(g.add("ramp", n=3))
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 7
    report = g.run(g.add("describe", value=1))
    report["value"] = 2
    report["parts"].append(3)
    assert g.run("describe") == {"value": 1, "parts": [1]}


def test_arrays_inside_records_are_read_only() -> None:
    class Pair(NamedTuple):
        arrays: dict[str, NDArray[np.float64]]
        mesh: list[NDArray[np.float64]]

    @node
    def pair() -> Pair:
        return Pair({"a": np.zeros(2)}, [np.zeros(2)])

    g = sm.Graph()
    value = g.run(g.add(pair))
    assert not value.arrays["a"].flags.writeable
    assert not value.mesh[0].flags.writeable


def test_messages_are_there_from_the_cache_too() -> None:
    g = sm.Graph()
    k = g.param("k", 20.0)
    step = g.add("fussy", value=k)
    with pytest.warns(NodeWarning, match="20.0 is large"):
        g.run(step)
    assert g.messages == {"fussy": ("20.0 is large",)}
    g.set(k=1.0)
    g.run(step)
    assert g.messages == {}
    g.set(k=20.0)
    g.run(step)
    assert g.messages == {"fussy": ("20.0 is large",)}
    assert calls == {"fussy": 2}


def test_warn_outside_a_graph_is_a_python_warning() -> None:
    with pytest.warns(NodeWarning, match="by itself"):
        warn("by itself")


def test_a_failing_step_is_named_and_its_error_kept() -> None:
    g = sm.Graph()
    step = g.add("add", "sum", a=g.add("fussy", "check", value=-1))
    with pytest.raises(NodeError, match=r"step 'check' \(node fussy\) failed: value must") as e:
        g.run(step)
    assert (e.value.step, e.value.node) == ("check", "fussy")
    assert e.value.cause is e.value.__cause__
    assert isinstance(e.value.cause, ValueError)
    assert str(e.value.cause) == "value must not be negative: take its square"
    assert "add" not in calls


def test_states_of_steps_are_told() -> None:
    g = sm.Graph()
    k = g.param("k", 1.0)
    a = g.add("number", value=3)
    b = g.add("fussy", value=k)
    told: list[tuple[str, str]] = []
    g.run(a, b, on_step=lambda name, state: told.append((name, state)))
    assert told == [(n, s) for n in ("number", "fussy") for s in ("running", "done")]
    told.clear()
    g.set(k=-1.0)
    with pytest.raises(NodeError):
        g.run(a, b, on_step=lambda name, state: told.append((name, state)))
    assert set(told) == {("number", "cached"), ("fussy", "running"), ("fussy", "failed")}


def test_units_reach_the_nodes_that_ask() -> None:
    g = sm.Graph(units="mm")
    assert g.run(g.add("tell_units"), g.add("tell_units", units="ft")) == ("mm", "ft")
    with pytest.raises(ValueError, match="'km': must be one of mm, cm, m, in, ft"):
        sm.Graph(units="km")


def test_the_caller_keeps_its_arrays() -> None:
    @node
    def same(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values

    g = sm.Graph()
    mine = np.zeros(2)
    result = g.run(g.add(same, values=mine))
    mine[0] = 1
    assert result[0] == 0


def test_messages_of_steps_before_a_cached_one() -> None:
    g = sm.Graph()
    k = g.param("k", 20.0)
    step = g.add("add", a=g.add("fussy", value=k))
    with pytest.warns(NodeWarning):
        g.run(step)
    for value, messages in ((1.0, {}), (20.0, {"fussy": ("20.0 is large",)})):
        g.set(k=value)
        g.run(step)
        assert g.messages == messages


def test_a_run_has_its_own_values_and_steps() -> None:
    g = sm.Graph("mine")
    k = g.param("k", 1)
    sizes = [1.0, 2.0]
    listed = g.param("sizes", sizes)
    total = g.add("total", values=listed)
    target = g.add("add", a=g.add("number", value=k), b=k)
    texts: list[str] = []

    def meddle(name: str, state: str) -> None:
        if (name, state) == ("number", "done"):
            g.set(k=100)
            g.add("number", "another", value=3)
            texts.append(running_graph())

    assert g.run(target, on_step=meddle) == 2
    assert '"value": 1' in texts[0]
    assert "another" not in texts[0]
    assert g.run(target) == 200
    g.set(k=1)
    assert g.run(target) == 2
    sizes.append(5.0)
    g.params["sizes"].value.append(5.0)
    g.run(listed).append(5.0)
    assert g.run(total) == 3


def test_a_literal_that_changes_during_a_run_is_for_the_next() -> None:
    g = sm.Graph()
    array, several = np.zeros(4), [1.0]
    number = g.add("number", value=1)
    middle = g.add("add", a=number, b=g.add("total", values=several))
    target = g.add("add", a=middle, b=g.add("mean", values=array))

    def meddle(name: str, state: str) -> None:
        if (name, state) == ("number", "done"):
            array[:] = 8
            several.append(5.0)

    assert g.run(target, on_step=meddle) == 2
    assert g.run(target) == 1 + 6 + 8
    array[:] = 0
    several.pop()
    assert g.run(target) == 2


def test_names_of_many_steps_are_found_at_once() -> None:
    g = sm.Graph()
    began = time.process_time()
    for _ in range(2000):
        g.add("number")
    assert time.process_time() - began < 2
    assert list(g.steps)[::250][:2] == ["number", "number_251"]
    assert list(g.steps)[-1] == "number_2000"
    g.add("number", "number_2002")
    g.add("number")
    g.add("number")
    assert list(g.steps)[-3:] == ["number_2002", "number_2001", "number_2003"]
