"""Lists mapped over, and sliders moved over ranges."""

import importlib
import multiprocessing
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import pytest

import spheremesh as sm
from spheremesh.nodes import GraphError, NodeError, node


class Both(NamedTuple):
    """Sum and product."""

    plus: float
    times: float


runs: list[tuple[float, float]] = []


def both(a: float, b: float = 1.0) -> Both:
    runs.append((a, b))
    return Both(a + b, a * b)


def numbers(n: int) -> list[int]:
    return list(range(n))


def double(a: float) -> float:
    if a < 0:
        raise ValueError("negative")
    return 2 * a


def total(values: list[float]) -> float:
    return sum(values)


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    runs.clear()
    for function in (both, numbers, double, total):
        node(function)


def test_the_longest_list_counts() -> None:
    g = sm.Graph()
    step = g.add("both", a=sm.each([1, 2, 3]), b=sm.each([10, 20]))
    assert g.run(step) == Both([11, 22, 23], [10, 40, 60])
    assert g.run(g.add("total", values=step.times)) == 110


def test_each_of_a_wire_and_of_a_slider() -> None:
    g = sm.Graph()
    n = g.add("numbers", n=3)
    sizes = g.param("sizes", [1.0, 2.0])
    step = g.add("both", a=sm.each(n), b=sm.each(sizes))
    assert g.run(step.plus) == [1, 3, 4]
    g.set(sizes=[5.0])
    assert g.run(step.plus) == [5, 6, 7]
    with pytest.raises(GraphError, match=r"both\.b\[1\] = 'x': must be float"):
        g.set(sizes=[5.0, "x"])
    doubled = g.add("double", a=sm.each(step.plus))
    assert g.run(doubled) == [10, 12, 14]
    mixed = g.add("double", "mixed", a=sm.each([g.add("total", values=n), 4]))
    assert g.run(mixed) == [6, 8]
    assert sm.Graph.from_json(g.to_json()).run("mixed", "double") == ([6, 8], [10, 12, 14])


def test_empty_lists() -> None:
    g = sm.Graph()
    assert g.run(g.add("both", a=sm.each([]))) == Both([], [])
    with pytest.raises(NodeError, match=r"both_2\.b is an empty list, another has 2 items"):
        g.run(g.add("both", a=sm.each([1, 2]), b=sm.each([])))


def test_a_list_is_not_mapped_by_itself() -> None:
    g = sm.Graph()
    step = g.add("double", a=sm.each([1]))
    with pytest.raises(
        GraphError,
        match=r"double\.result \(list of float\) into double_2\.a \(float\); map .* each",
    ):
        g.add("double", a=step)
    with pytest.raises(GraphError, match=r"double_2\.a\[1\] = 'x': must be float"):
        g.add("double", a=sm.each([1, "x"]))
    with pytest.raises(GraphError, match="each needs a list"):
        sm.each(3)


def test_sweep_combines_and_leaves_the_sliders() -> None:
    g = sm.Graph()
    a, b = g.param("a", 1), g.param("b", 1)
    step = g.add("both", a=a, b=b)
    result = sm.sweep(g, step.times, a=[2, 3], b=(5, 7))
    assert result == [
        ({"a": 2, "b": 5}, 10),
        ({"a": 2, "b": 7}, 14),
        ({"a": 3, "b": 5}, 15),
        ({"a": 3, "b": 7}, 21),
    ]
    assert g.run(a, b) == (1, 1)
    sm.sweep(g, step.plus, a=[3, 2], b=[7, 5])
    assert len(runs) == 4, "the results are those of before"


def test_sweep_checks_all_points_first() -> None:
    g = sm.Graph()
    step = g.add("both", a=g.param("a", 1, max=5))
    with pytest.raises(GraphError, match="param a = 6: must be at most 5"):
        sm.sweep(g, step, a=[1, 6])
    g.param("mould", 3)
    with pytest.raises(GraphError, match="no param 'moulds'; did you mean 'mould'"):
        sm.sweep(g, step, moulds=[1])
    assert runs == []


def test_a_failing_point_is_named_and_the_sliders_are_put_back() -> None:
    g = sm.Graph()
    a = g.param("a", 1)
    step = g.add("double", a=a)
    with pytest.raises(NodeError, match="negative") as error:
        sm.sweep(g, step, a=[2, -1])
    assert error.value.__notes__ == ["at a = -1"]
    assert g.run(a) == 1


def test_sweep_in_threads() -> None:
    g = sm.Graph()
    step = g.add("double", a=g.param("a", 1))
    with ThreadPoolExecutor(2) as executor:
        result = sm.sweep(g, step, executor=executor, a=range(4))
    assert [value for _, value in result] == [0, 2, 4, 6]


MODULE = """
from spheremesh.nodes import node


class Refused(ValueError):
    pass


@node
def cube_of_toy(a: float) -> float:
    if a < 0:
        raise Refused(f"{a} is negative")
    return a**3
"""


@pytest.fixture
def toy_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    (tmp_path / "toy_nodes_of_a_user.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("toy_nodes_of_a_user")
    sys.modules.pop("toy_nodes_of_a_user")


def test_sweep_in_processes(toy_module: ModuleType) -> None:
    g = sm.Graph()
    step = g.add(toy_module.cube_of_toy, a=g.param("a", 1))
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as executor:
        assert sm.sweep(g, step, executor=executor, a=[2, 3]) == [({"a": 2}, 8), ({"a": 3}, 27)]
        with pytest.raises(NodeError, match="'cube_of_toy' failed: -1 is negative") as error:
            sm.sweep(g, step, executor=executor, a=[2, -1])
    assert error.value.step == "cube_of_toy"
    assert isinstance(error.value.cause, toy_module.Refused)
