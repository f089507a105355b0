"""Results for all combinations of slider values."""

import os
import tempfile
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

from ..errors import GraphError
from ..graph import Graph
from ..node import NodeWarning
from ..specification.wires import Param, Step, Target
from ..stores.disk import DiskStore, user_cache_folder
from .points import combined, folder_names, in_order
from .rows import Row, Sweep
from .tasks import Outcome, Study, run_point
from .workers import Outcomes, Task, runner

OnRow: TypeAlias = Callable[[Row, int, int], None]


def sweep(
    graph: Graph,
    /,
    *targets: Target,
    executor: Any = None,  # noqa: ANN401, an Executor, or a client of Dask
    workers: int | None = None,
    write_to: str | os.PathLike[str] | None = None,
    cache: str | os.PathLike[str] | None = None,
    on_row: OnRow | None = None,
    **params: Iterable[Any],
) -> Sweep:
    """Results for all combinations of slider values; what fails is a row that says so.

    Parameters
    ----------
    graph : Graph
        The graph; its sliders stay where they are.
    *targets : Step, Wire or str
        As for `Graph.run`.
    executor : concurrent.futures.Executor or distributed.Client, optional
        Runs the points. It gets the graph as JSON, so all values must have a form there, and
        its nodes must be in modules that can be imported. A process pool must spawn its
        processes, not fork them.
    workers : int, optional
        Number of processes to run the points in, instead of an executor.
    write_to : path, optional
        A folder for each point is made in it, where its files go.
    cache : path, optional
        Folder in which all processes keep results. By default that of the graph; with an
        executor or workers the user's cache folder.
    on_row : callable, optional
        Called as points are done, with the row, how many rows there are and will be.
    **params : iterable
        The values of each slider to combine, the last varying fastest.

    Returns
    -------
    Sweep
        Rows in the order of the points. Each is a pair, the values of the sliders and what
        `Graph.run` gives for them, and has ``error``, ``warnings``, ``seconds``, ``folder``.
        If points failed, a warning says how many.

    Raises
    ------
    GraphError
        If a slider or value is not allowed; nothing has been run then.

    Examples
    --------
    >>> from spheremesh.nodes import Graph, node, sweep
    >>> @node
    ... def cubed(a: float) -> float:
    ...     return a**3
    >>> graph = Graph()
    >>> cube = graph.add(cubed, a=graph.param("a", 1.0))
    >>> sweep(graph, cube, a=[2, 3])
    [({'a': 2}, 8), ({'a': 3}, 27)]
    """
    result = run_sweep(
        graph, targets, params, executor=executor, workers=workers, write_to=write_to,
        cache=cache, on_row=on_row,
    )  # fmt: skip
    if result.failures:
        first = result.failures[0]
        at = ", ".join(f"{name} = {value}" for name, value in first.point.items())
        warnings.warn(
            f"{len(result.failures)} of {len(result)} points failed; at {at}: {first.error}",
            NodeWarning,
            stacklevel=2,
        )
    return result


def run_sweep(
    graph: Graph,
    targets: Sequence[Target],
    params: Mapping[str, Iterable[Any]],
    *,
    executor: Any = None,  # noqa: ANN401, an Executor, or a client of Dask
    workers: int | None = None,
    write_to: str | os.PathLike[str] | None = None,
    cache: str | os.PathLike[str] | None = None,
    on_row: OnRow | None = None,
) -> Sweep:
    """`sweep` for sliders of any name; failures are in the rows alone.

    Parameters
    ----------
    graph : Graph
    targets : sequence of Step, Wire or str
    params : mapping of str to iterable
    executor, workers, write_to, cache, on_row : object
        As for `sweep`.

    Returns
    -------
    Sweep
        Rows in the order of the points.
    """
    points = combined(graph, params)
    names = tuple(_name(graph, target) for target in targets)
    if not names:
        raise GraphError("sweep needs a target")
    run = runner(executor, workers)
    folders = [""] * len(points)
    if write_to is not None:
        folders = [str(Path(write_to).absolute() / name) for name in folder_names(points)]
    tasks: list[Task] = [(i, points[i], folders[i]) for i in in_order(graph, points)]
    with _cache_folder(graph, cache, is_shared=run is not None) as shared:
        if run is None:
            outcomes = _here(graph, names, tasks, cache)
        else:
            outcomes = run(_study(graph, names, shared), tasks)
        rows = _collected(outcomes, points, folders, on_row)
    return Sweep(rows, names)


def _collected(
    outcomes: Outcomes,
    points: Sequence[Mapping[str, Any]],
    folders: Sequence[str],
    on_row: OnRow | None,
) -> list[Row]:
    rows: dict[int, Row] = {}
    for number, outcome in outcomes:
        rows[number] = row = _row(points[number], outcome, folders[number])
        if on_row is not None:
            on_row(row, len(rows), len(points))
    return [rows[number] for number in range(len(points))]


def _row(point: Mapping[str, Any], outcome: Outcome, folder: str) -> Row:
    return Row(
        point,
        outcome.value,
        error=outcome.error,
        warnings=outcome.warnings,
        seconds=outcome.seconds,
        steps_run=outcome.steps_run,
        folder=folder,
    )


def _here(
    graph: Graph,
    targets: tuple[str, ...],
    tasks: Sequence[Task],
    cache: str | os.PathLike[str] | None,
) -> Outcomes:
    """Run points one after the other in this process, on copies of the graph."""
    store = graph.cache if cache is None else DiskStore(cache)
    for number, point, folder in tasks:
        copy = graph.copy()
        copy.cache = store
        yield number, run_point(copy, targets, point, folder)


def _study(graph: Graph, targets: tuple[str, ...], cache: str) -> Study:
    modules = {step.node.function.__module__ for step in graph.steps.values()}
    return Study(graph.to_json(), targets, tuple(sorted(modules)), str(Path.cwd()), cache)


def _cache_folder(
    graph: Graph, cache: str | os.PathLike[str] | None, *, is_shared: bool
) -> AbstractContextManager[str]:
    """The folder in which processes share results; a passing one if the user wants none."""
    if not is_shared:
        return nullcontext("")
    if cache is not None:
        return nullcontext(str(Path(cache).absolute()))
    if isinstance(graph.cache, DiskStore):
        return nullcontext(str(graph.cache.folder))
    if os.environ.get("SPHEREMESH_CACHE") == "off":
        make = partial(tempfile.TemporaryDirectory, ignore_cleanup_errors=True)
        return make(prefix="spheremesh-")
    return nullcontext(str(user_cache_folder()))


def _name(graph: Graph, target: Target) -> str:
    if isinstance(target, Param):
        raise GraphError(f"param {target.name} is no result of a sweep")
    if isinstance(target, str):
        graph.wire(target)
    return target.name if isinstance(target, Step) else str(target)
