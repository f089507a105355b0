"""Many results from one graph: steps mapped over lists, and sliders moved over ranges."""

import importlib
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from functools import lru_cache
from itertools import product
from typing import Any

from ..annotations import Value
from ..errors import GraphError
from ..graph import Graph
from ..specification.wires import Param, Step, Target
from ..stores.memory import MemoryStore


def sweep(
    graph: Graph,
    /,
    *targets: Target,
    executor: Executor | None = None,
    **params: Iterable[Any],
) -> list[tuple[dict[str, Any], Any]]:
    """Results for all combinations of slider values.

    Parameters
    ----------
    graph : Graph
        The graph; its sliders stay where they are.
    *targets : Step, Wire, Param or str
        As for `Graph.run`.
    executor : concurrent.futures.Executor, optional
        Runs the combinations. It gets the graph as JSON, so all values must have a form
        there. A process pool must spawn its processes, not fork them.
    **params : iterable
        The values of each slider to combine, the last varying fastest.

    Returns
    -------
    list of (dict, object)
        The values of the sliders, and what `Graph.run` gives for them.

    Raises
    ------
    GraphError
        If a slider or value is not allowed; nothing has been run then.
    """
    axes = [list(values) for values in params.values()]
    points = [
        graph.check_params(dict(zip(params, values, strict=True))) for values in product(*axes)
    ]
    if executor is not None:
        _refuse_fork(executor)
        return list(zip(points, _run_on(executor, graph, targets, points), strict=True))
    before = {name: param.value for name, param in graph.params.items()}
    results: list[Any] = []
    try:
        for point in points:
            graph.set(**point)
            results.append(_run_point(graph, targets, point))
    finally:
        graph.set(**before)
    return list(zip(points, results, strict=True))


def _refuse_fork(executor: Executor) -> None:
    """A forked process inherits the locks of libraries' threads, and waits for ever."""
    context = getattr(executor, "_mp_context", None)
    if context is not None and context.get_start_method() == "fork":
        raise GraphError(
            "the executor forks its processes, which can hang after a graph has run: give it "
            "mp_context=multiprocessing.get_context('spawn')"
        )


def _run_on(
    executor: Executor,
    graph: Graph,
    targets: Sequence[Target],
    points: Sequence[Mapping[str, Any]],
) -> list[Any]:
    text = graph.to_json()
    names = [_name(graph, target) for target in targets]
    modules = sorted({step.node.function.__module__ for step in graph.steps.values()})
    futures = [executor.submit(_run_text, text, names, point, modules) for point in points]
    try:
        return [future.result() for future in futures]
    finally:
        for future in futures:
            future.cancel()


def _name(graph: Graph, target: Target) -> str:
    if isinstance(target, Param):
        raise GraphError(f"param {target.name} is no result of a sweep")
    if isinstance(target, str):
        graph.wire(target)
    return target.name if isinstance(target, Step) else str(target)


def _run_text(
    text: str, targets: Sequence[str], point: Mapping[str, Any], modules: Sequence[str]
) -> Value:
    for module in modules:
        importlib.import_module(module)
    graph = Graph.from_json(text, cache=_worker_cache(text))
    graph.set(**point)
    return _run_point(graph, targets, point)


@lru_cache(maxsize=1)
def _worker_cache(text: str) -> MemoryStore:
    """What the points of one sweep share within a process."""
    del text
    return MemoryStore()


def _run_point(graph: Graph, targets: Sequence[Target], point: Mapping[str, Any]) -> Value:
    try:
        return graph.run(*targets)
    except Exception as error:
        error.add_note("at " + ", ".join(f"{name} = {value}" for name, value in point.items()))
        raise
