"""One request: its branches and items, and the runs that they ask for.

Branches go side by side, the longest tree counts, and shorter ones repeat their last branch.
Within a branch items go side by side in the same way; a list is one value of an input that
takes lists. What a run gives is under the path of its branch.
"""

from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any, Final

from ...fabrication.output_folder import OutputFolder, output_folder
from ...kernel.errors import InputError, SpheremeshError
from ...kernel.panels.panels import Panels
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...nodes.graphs.annotations import Value
from ...nodes.graphs.errors import GraphError, NodeError, nearest
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.ports import REQUIRED
from ...nodes.graphs.running.files import paths_of
from .components import ANY_NUMBER, Component, Input, Output, writes_files
from .guard import check_paths
from .handles import Handles
from .jobs import Watcher
from .parameters import is_file, is_path
from .trees import Item, Tree, write_tree
from .trees import Path as Branch
from .values_in import port_value
from .values_out import Exchange, output_tree

MOST_RUNS: Final = 10_000

UNITS: Final = {
    "Millimeters": "mm", "Centimeters": "cm", "Meters": "m", "Inches": "in", "Feet": "ft",
}  # fmt: skip
"""Units of Rhino documents."""


class ChangedError(InputError):
    """A request for inputs that a graph does not have, or not any more."""


@dataclass(frozen=True)
class Solver:
    """What runs are done with.

    Attributes
    ----------
    handles : Handles
        In the store of all results.
    files : Path, optional
        The folder that nodes read from and write to.
    """

    handles: Handles
    files: Path | None = None
    writing: Any = field(default_factory=Lock)


@dataclass(frozen=True)
class Solution:
    """What a request gives.

    Attributes
    ----------
    values : list of dict
        Trees in JSON.
    warnings : list of str
    is_lasting : bool
        Whether the client may keep it as long as it is open.
    """

    values: list[dict[str, Any]]
    warnings: list[str]
    is_lasting: bool


def solve(
    solver: Solver,
    component: Component,
    trees: Mapping[str, Tree],
    units: str,
    watcher: Watcher,
) -> Solution:
    """Run a component for all branches and items.

    Parameters
    ----------
    solver : Solver
    component : Component
    trees : mapping of str to dict
        By name of the input.
    units : str
        Of the document, as Rhino names them.
    watcher : Watcher

    Returns
    -------
    Solution
        A tree for every output.

    Raises
    ------
    SpheremeshError, GraphError
        If an input is wrong or a run fails; the message names the component.
    """
    if component.fault:
        raise InputError(component.fault)
    given = _given(component, trees)
    exchange = Exchange(solver.handles, partial(_panels_of, solver))
    if component.shows_all:
        exchange.most_shown = ANY_NUMBER
    outputs: dict[str, dict[Branch, list[Item]]] = {each.name: {} for each in component.outputs}
    with _folder(solver, component) as folder:
        run = _Run(solver, component, units, watcher, exchange, folder)
        for path, several in _branches(given):
            for index, items in enumerate(several):
                _add(outputs, _run(run, items), path, index, is_one=len(several) == 1)
    values = [write_tree(name, tree) for name, tree in outputs.items()]
    is_lasting = exchange.is_lasting and not component.reads_files
    return Solution(values, exchange.warnings, is_lasting)


@dataclass(frozen=True)
class _Run:
    solver: Solver
    component: Component
    units: str
    watcher: Watcher
    exchange: Exchange
    folder: OutputFolder | None


def _given(component: Component, trees: Mapping[str, Tree]) -> dict[Input, Tree]:
    """The trees of the inputs that were given something."""
    inputs = {each.name: each for each in component.inputs}
    for name, tree in trees.items():
        if tree and name not in inputs:
            text = f"{component.name} has no input {name!r}; {nearest(name, inputs)}"
            raise ChangedError(text) if component.node.inner else InputError(text)
    given = {each: trees[name] for name, each in inputs.items() if trees.get(name)}
    for port in component.node.inputs.values():
        names = [each.name for each in component.inputs if each.port is port]
        found = [each.name for each in given if each.port is port]
        if len(found) > 1:
            raise InputError(f"{component.name}: give {' or '.join(found)}, not both")
        if not found and port.default is REQUIRED:
            raise InputError(f"{component.name}: {' or '.join(names)} is missing")
    return given


_Items = dict[Input, list[Item]]


def _branches(given: Mapping[Input, Tree]) -> Iterator[tuple[Branch, list[_Items]]]:
    """Each branch by its path, and the items of each of its runs."""
    if not given:
        yield (0,), [{}]
        return
    # The longest tree has the paths; of equal ones that which is nested most.
    leader = max(given.values(), key=lambda tree: (len(tree), max(map(len, tree))))
    branches = {each: list(tree.values()) for each, tree in given.items()}
    total = 0
    for number, path in enumerate(leader):
        parts = {
            each: several[min(number, len(several) - 1)] for each, several in branches.items()
        }
        runs = _runs(parts)
        total += len(runs)
        if total > MOST_RUNS:
            raise InputError(f"more than {MOST_RUNS} runs in one request; send less at a time")
        yield path, runs


def _runs(parts: _Items) -> list[_Items]:
    """The items of each run of a branch."""
    count = max((len(x) for each, x in parts.items() if not _is_whole(each)), default=1)
    return [
        {
            each: items if _is_whole(each) else [items[min(i, len(items) - 1)]]
            for each, items in parts.items()
        }
        for i in range(count)
    ]


def _is_whole(each: Input) -> bool:
    return each.carrier.form.is_list


def _run(run: _Run, items: _Items) -> dict[Output, Tree]:
    """The trees of the outputs of one run."""
    component, exchange = run.component, run.exchange
    inputs: dict[str, Value] = {}
    for each, several in items.items():
        where = f"{component.name}.{each.name}"
        value = port_value(each.carrier, several, where, run.solver.handles)
        if is_file(each.port):
            _check_files(run, each, value, where)
        inputs[each.port.name] = value
    result = _result(run, inputs)
    found: dict[Output, Tree] = {}
    for output in component.outputs:
        where = f"{component.name}.{output.name}"
        value = _of_port(run, output, result)

        def _encode(value: Value, output: Output = output, where: str = where) -> list[Item]:
            if value is None or (output.kinds and not isinstance(value, output.kinds)):
                return []
            return output.encode(value, exchange, where)

        found[output] = output_tree(value, output.nesting, _encode, is_list=output.is_list)
    return found


def _check_files(run: _Run, each: Input, value: Value, where: str) -> None:
    if not is_path(each.port, each.carrier.form) and not isinstance(value, str | list):
        return
    if run.solver.files is None:
        raise InputError(f"{where}: files are not served; start the server with --files")
    check_paths(value, run.solver.files, where)
    if each.port.writes:
        for path in paths_of(value):
            (run.solver.files / path).parent.mkdir(parents=True, exist_ok=True)


def _result(run: _Run, inputs: Mapping[str, Value]) -> Value:
    """What the node returns; what it warns of is noted."""
    component, solver = run.component, run.solver
    graph = Graph(cache=solver.handles.store)
    is_asked = any(
        p.graph_units and p.name not in inputs for p in component.node.inputs.values()
    )
    if is_asked:
        graph = Graph(units=_units(component, run.units), cache=solver.handles.store)
    try:
        step = graph.add(component.node, component.name, **inputs)
        return graph.run(
            step,
            on_event=run.watcher.note,
            cancel=run.watcher.cancel,
            read_from=solver.files,
            write_to=run.folder,
        )
    except NodeError as error:
        raise InputError(f"{component.name}: {_reason(error)}") from error
    finally:
        for name, texts in graph.messages.items():
            inner = name.removeprefix(f"{component.name}/")
            about = "" if inner == component.name else f"{inner}: "
            for text in texts:
                run.exchange.warn(f"{about}{text}")


def _reason(error: NodeError) -> str:
    if isinstance(error.cause, SpheremeshError | GraphError | OSError):
        return error.reason
    return f"{error} ({type(error.cause).__name__}): a fault of the node, report it"


def _units(component: Component, units: str) -> str:
    if not units:
        return "m"  # no document at all
    if units not in UNITS:
        is_none = units in ("None", "Unset")
        shown = "without units" if is_none else f"in {units[:40]}"
        raise InputError(
            f"{component.name}.units: the document is {shown}; give mm, cm, m, in or ft"
        )
    return UNITS[units]


def _of_port(run: _Run, output: Output, result: Value) -> Value:
    node = run.component.node
    several = len(node.outputs) > 1 or node.has_fields
    value = getattr(result, output.port.name) if several else result
    files = run.solver.files
    # A file that was written is told by its whole path: Grasshopper knows no folder.
    if files is not None and run.folder is not None and isinstance(value, str):
        staged = run.folder.staging / value
        return str(files.resolve() / value) if staged.is_file() else value
    return value


@contextmanager
def _folder(solver: Solver, component: Component) -> Generator[OutputFolder | None]:
    """Where files are written: one request at a time, all of its files or none."""
    if solver.files is None or not writes_files(component.node):
        yield None
        return
    with solver.writing, output_folder(solver.files) as folder:
        yield folder


def _add(
    outputs: dict[str, dict[Branch, list[Item]]],
    found: Mapping[Output, Tree],
    path: Branch,
    index: int,
    *,
    is_one: bool,
) -> None:
    """Put what a run gives under the path of its branch; lists of several have their own."""
    for output, tree in found.items():
        is_item = not output.is_list and output.nesting == 0
        for below, items in tree.items():
            at = (*path, *below) if is_one or is_item else (*path, index, *below)
            outputs[output.name].setdefault(at, []).extend(items)


def _panels_of(solver: Solver, sphere_mesh: SphereMesh) -> Panels:
    """The panels of a sphere mesh, kept like other results."""
    graph = Graph(cache=solver.handles.store)
    return graph.run(graph.add("panels", sphere_mesh=sphere_mesh).panels)
