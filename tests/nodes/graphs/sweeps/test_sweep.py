"""Sliders moved over ranges."""

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
from spheremesh.nodes import GraphError, NodeWarning, node


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


def test_a_failing_point_is_a_row_and_the_sliders_stay() -> None:
    g = sm.Graph()
    a = g.param("a", 1)
    step = g.add("double", a=a)
    with pytest.warns(NodeWarning, match="1 of 3 points failed; at a = -1: .*negative"):
        found = sm.sweep(g, step, a=[2, -1, 3])
    assert found == [({"a": 2}, 4), ({"a": -1}, None), ({"a": 3}, 6)]
    assert [row.error for row in found] == ["", "step 'double' failed: negative", ""]
    assert found.failures == [found[1]]
    assert g.run(a) == 1
    assert g.messages == {}


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
        with pytest.warns(NodeWarning, match="1 of 2 points failed; at a = -1"):
            found = sm.sweep(g, step, executor=executor, a=[2, -1])
    assert found == [({"a": 2}, 8), ({"a": -1}, None)]
    assert found[1].error == "step 'cube_of_toy' failed: -1 is negative"
