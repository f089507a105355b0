"""Values that pass as a type but are no good: nothing, other counts, numbers of any size.

Every node with numbers among its inputs is run in a graph with the arguments of its example, of
which one is changed. It runs, or it is refused by an error of ours.
"""

import doctest
import functools
import inspect
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spheremesh import nodes
from spheremesh.kernel.errors import SpheremeshError
from spheremesh.nodes import Graph, GraphError, NodeError
from spheremesh.nodes.graphs.annotations import Member, members
from spheremesh.nodes.graphs.node import Node
from spheremesh.nodes.graphs.ports import Port

OURS = (SpheremeshError, GraphError, OSError)
SIZES = [0.0, -1.0, 1e-308, 1e308, 1e-90, 1e90, np.nan, np.inf]
SLOW = {
    "exact_support": "heights of 0 take three times as long as the example",
    "optimize_spheres": "tolerances of any size take as many steps as there may be",
    "panel_report": "needs reports, each with numbers of its own",
}


def changes_numbers(member: Member) -> bool:
    is_list_of_arrays = member.kind is list and "ndarray" in str(member.hint)
    return member.kind in (float, np.ndarray, int) or is_list_of_arrays


def numeric_ports(node: Node) -> list[Port]:
    """Its inputs that are numbers or arrays."""
    return [p for p in node.inputs.values() if any(map(changes_numbers, members(p.type)))]


LIBRARY = [nodes.find_node(name) for name in nodes.__all__ if name in nodes.REGISTRY]
NUMERIC = [node for node in LIBRARY if numeric_ports(node) and node.name not in SLOW]


def hostile(port: Port, example: object) -> Iterator[object]:
    """Values for an input."""
    for member in members(port.type):
        if member.kind is float:
            yield from SIZES
        elif member.kind is int:
            yield from (-1, 0, 2**62)
        elif member.kind is list:
            yield from ([], [np.zeros((5, 5))], [[1.0]], [[[1], [2, 3]]])
        elif member.kind is np.ndarray:
            yield from ([], [[]], [1.0], [[1], [2, 3]], np.array(["a"]))
            shape = member.facts.shape if member.facts else (2, 3)
            for count in (0, 1, 2, 3):
                counts = [count if isinstance(n, str) else n for n in shape]
                for size in (1.0, *SIZES) if count == 3 else (1.0,):
                    yield np.full(counts, size)
    if isinstance(example, np.ndarray) and example.dtype.kind == "f" and example.size:
        yield example[:-1]
        for size in SIZES:
            one = example.copy()
            one.flat[0] = size
            yield one


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """The arguments of every node in its own example."""
    found: dict[str, dict[str, Any]] = {}

    def recorder(node: Node) -> Callable[..., Any]:
        @functools.wraps(node.function)
        def record(*args: object, **kwargs: object) -> object:
            bound = inspect.signature(node.function).bind(*args, **kwargs)
            bound.apply_defaults()
            found.setdefault(node.name, dict(bound.arguments))
            return node.function(*args, **kwargs)

        return record

    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings(action="ignore"):
        patch.chdir(tmp_path_factory.mktemp("examples"))
        recorders = {node.name: recorder(node) for node in LIBRARY}
        for name, record in recorders.items():
            patch.setattr(nodes, name, record, raising=False)
        finder = doctest.DocTestFinder(recurse=False)
        for node in NUMERIC:
            scope = {**vars(sys.modules[node.function.__module__]), **recorders}
            for test in finder.find(node.function, node.name, globs=scope):
                doctest.DocTestRunner().run(test, out=lambda _: None)
    return found


def fault_of(node: Node, arguments: dict[str, Any]) -> Exception | None:
    """What ends a node, if it is no error of ours."""
    graph = Graph()
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
            graph.add(node.name, "s", **arguments)
            graph.run("s")
    except GraphError:
        return None
    except NodeError as error:
        return None if isinstance(error.cause, OURS) else error.cause
    return None


@pytest.mark.parametrize("node", NUMERIC, ids=lambda node: node.name)
def test_numbers_of_any_size_and_count_are_taken_or_refused(
    node: Node,
    examples: dict[str, dict[str, Any]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    for port in numeric_ports(node):
        for value in hostile(port, examples[node.name][port.name]):
            fault = fault_of(node, {**examples[node.name], port.name: value})
            assert fault is None, f"{port.name} = {value!r}: {fault!r}"
