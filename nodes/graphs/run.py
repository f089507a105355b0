"""One run of a graph: keys first, then only the steps whose results are not known."""

import os
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from .annotations import Value
from .cache import Cache, Entry, digest, file_state
from .errors import GraphError, NodeError
from .files import (
    FileUses,
    Folders,
    is_file,
    is_wired,
    is_writer,
    is_written,
    note_known_files,
    paths_of,
)
from .kinds import convert
from .node import NodeWarning, collected_messages, replaced
from .ports import Port, check_value
from .results import own, remade, snapshot
from .wires import Each, Param, Step, Wire, parents, sources

OnStep = Callable[[str, str], None]


@dataclass(frozen=True, eq=False)
class Run:
    """A run under way: nobody else changes what it is given.

    Attributes
    ----------
    steps : mapping of str to Step
        The steps of the graph, each after those it depends on.
    values : mapping of str to object
        Values of the sliders.
    cache : Cache
        Results of earlier runs.
    on_step : callable
        Called with the name of a step and ``"running"``, ``"done"``, ``"cached"`` or
        ``"failed"``.
    folders : Folders
        Where the relative paths are that nodes read and write. What a step has written is read
        where it was written.
    entries : dict of str to Entry
        Results at hand so far.
    given : dict of (str, str) to object
        Literals of steps by input, as they were when first asked for.
    """

    steps: Mapping[str, Step]
    values: Mapping[str, Any]
    units: str
    cache: Cache
    on_step: OnStep
    folders: Folders = field(default_factory=Folders)
    keys: dict[str, bytes] = field(default_factory=dict[str, bytes])
    entries: dict[str, Entry] = field(default_factory=dict[str, Entry])
    given: dict[tuple[str, str], Value] = field(default_factory=dict[tuple[str, str], Value])


def run_steps(run: Run, targets: Iterable[str]) -> None:
    """Bring the entries of steps up to date, running as little as possible.

    Parameters
    ----------
    run : Run
        Its keys and entries are filled in.
    targets : iterable of str
        Names of steps.

    Raises
    ------
    NodeError
        If a step fails.
    """
    wanted = list(targets)
    needed = _ancestors(run, wanted)
    for step in needed:
        for text in replaced(step.node):
            warnings.warn(f"step {step.name!r}: {text}", NodeWarning, stacklevel=3)
    uses = FileUses(run.folders)
    note_known_files(uses, needed, run.values)
    for step in needed:
        ports = step.node.inputs
        files = [source for name, source in step.sources if is_file(ports[name])]
        # The state of a file is part of the key, so its path must be known before.
        _bring(run, [w.step.name for w in files if isinstance(w, Wire)])
        _note_files(run, step, uses)
        run.keys[step.name] = _key(run, step)
    writers = [step.name for step in needed if is_writer(step)]
    _bring(run, [*wanted, *writers])


def output(run: Run, source: Step | Wire | Param) -> Value:
    """The value of a target.

    Parameters
    ----------
    run : Run
        A run that has reached it.

    Returns
    -------
    object
        What the function returned, one field of it, or the value of the slider.
    """
    if isinstance(source, Param):
        return own(run.values[source.name])
    step = source.step if isinstance(source, Wire) else source
    value = run.entries[step.name].value
    if isinstance(source, Wire) and step.node.has_fields:
        value = getattr(value, source.port.name)
    return own(value)


def _ancestors(run: Run, targets: Iterable[str]) -> list[Step]:
    names, pending = set[str](), list(targets)
    while pending:
        name = pending.pop()
        if name not in names:
            names.add(name)
            pending.extend(parents(run.steps[name]))
    return [step for name, step in run.steps.items() if name in names]


def _bring(run: Run, targets: Iterable[str]) -> None:
    """Run what is missing for the targets; their keys and those before are known."""
    missing, seen, pending = set[str](), set[str](), list(targets)
    while pending:
        name = pending.pop()
        if name in seen or name in run.entries:
            continue
        seen.add(name)
        entry = run.cache.get(run.keys[name])
        if entry is None:
            missing.add(name)
            pending.extend(parents(run.steps[name]))
        else:
            run.entries[name] = entry
            run.on_step(name, "cached")
    for name in run.steps if missing else ():
        if name in missing:
            # asked again: a step before this one may have been its equal
            entry = run.cache.get(run.keys[name]) or _execute(run, run.steps[name])
            run.cache.put(run.keys[name], entry)
            run.entries[name] = entry


def _given(run: Run, step: Step, port: Port) -> Value:
    """What an input was given when first asked for: somebody may still write to an array."""
    at = step.name, port.name
    if at not in run.given:
        value = step.inputs.get(port.name, run.units if port.graph_units else port.default)
        run.given[at] = value if any(sources(value)) else own(value, snapshot)
    return run.given[at]


def _note_files(run: Run, step: Step, uses: FileUses) -> None:
    """Note the files whose paths come by wires; those of writers are read, but no inputs."""
    for port in step.node.inputs.values():
        given = _given(run, step, port) if is_file(port) else None
        if is_wired(given) and (port.writes or not is_written(given)):
            uses.note(step, port, _resolve(run, given))


def _argument(run: Run, step: Step, port: Port) -> Value:
    given = _given(run, step, port)
    value = _resolve(run, given)
    if not is_file(port):
        return value
    is_target = is_written(given) if port.reads else port.writes
    return run.folders.target(value) if is_target else run.folders.source(value)


def _resolve(run: Run, value: Value) -> Value:
    if isinstance(value, Each):
        return _resolve(run, value.items)
    if isinstance(value, Wire | Param):
        return output(run, value)
    if any(sources(value)):
        return [_resolve(run, item) for item in value]
    return own(value, snapshot)


def _key_part(run: Run, value: Value) -> Value:
    if isinstance(value, Wire):
        return ("wire", run.keys[value.step.name], value.port.name)
    if isinstance(value, Each):
        return ("each", _key_part(run, value.items))
    if isinstance(value, Param):
        return ("value", run.values[value.name])
    if any(sources(value)):
        return ("list", [_key_part(run, item) for item in value])
    return ("value", value)


def _key(run: Run, step: Step) -> bytes:
    parts: list[Any] = [step.node.name, step.node.version, step.node.edition]
    for port in step.node.inputs.values():
        given = _given(run, step, port)
        parts.append(_key_part(run, given))
        if is_file(port):
            paths = list(map(_absolute, paths_of(_argument(run, step, port))))
            parts.append(paths)
            parts.append([file_state(path) for path in paths] if port.reads else None)
    return digest(parts)


def _execute(run: Run, step: Step) -> Entry:
    run.on_step(step.name, "running")
    with collected_messages() as messages:
        try:
            arguments = {
                port.name: _argument(run, step, port) for port in step.node.inputs.values()
            }
            value = _call_each(step, arguments) if step.is_mapped else _call(step, arguments)
        except Exception as error:
            run.on_step(step.name, "failed")
            name = step.node.name
            what = f"step {step.name!r}" + (f" (node {name})" if name != step.name else "")
            text = run.folders.as_given(str(error)) or type(error).__name__
            raise NodeError(f"{what} failed: {text}", step.name, name, error, text) from error
    written = _written(run, step, arguments)
    run.on_step(step.name, "done")
    states = tuple((path, file_state(path)) for path in map(_absolute, written))
    texts = (run.folders.as_given(text) for text in messages)
    return Entry(own(_returned(value, written)), tuple(dict.fromkeys(texts)), states)


def _written(run: Run, step: Step, arguments: Mapping[str, Any]) -> dict[str, str]:
    """The files that a step writes: the path that it was told, and that which was given."""
    return {
        told: given
        for port in step.node.inputs.values()
        if port.writes
        for told, given in zip(
            paths_of(arguments[port.name]),
            paths_of(_resolve(run, _given(run, step, port))),
            strict=True,
        )
    }


def _returned(value: Value, written: Mapping[str, str]) -> Value:
    """What a step returns, with the paths of its files as they were given."""
    if not written:
        return value
    if isinstance(value, str | Path):
        given = written.get(str(value))
        return value if given is None else type(value)(given)
    if isinstance(value, list | tuple):
        several = cast("list[Any] | tuple[Any, ...]", value)
        return remade(several, [_returned(item, written) for item in several])
    return value


def _call(step: Step, arguments: Mapping[str, Any]) -> Value:
    inputs: dict[str, Any] = {}
    for name, value in arguments.items():
        port = step.node.inputs[name]
        # What comes by wire was checked as a type; only small values are looked at again.
        if value is None or isinstance(value, bool | int | float | str):
            check_value(port, value, f"{step.name}.{name}")
        inputs[name] = _converted(port, value, f"{step.name}.{name}")
    value = step.node.function(**inputs)
    if step.node.has_fields and not isinstance(value, step.node.result_type):
        kind = step.node.result_type.__name__
        raise TypeError(f"node {step.node.name} must return {kind}, not {type(value).__name__}")
    return value


def _converted(port: Port, value: Value, where: str) -> Value:
    try:
        return convert(port.type, value)
    except (TypeError, ValueError, OverflowError):
        # A list into which wires were put may hold what the input does not accept.
        check_value(port, value, where)
        raise


def _call_each(step: Step, arguments: Mapping[str, Any]) -> Value:
    """Map over lists; a shorter list repeats its last item."""
    lists: dict[str, list[Any]] = {
        name: list(arguments[name]) for name, v in step.inputs.items() if isinstance(v, Each)
    }
    length = max(map(len, lists.values()))
    empty = [name for name, items in lists.items() if not items]
    if length and empty:
        raise GraphError(f"{step.name}.{empty[0]} is an empty list, another has {length} items")
    rows = [
        _call(step, {**arguments, **{n: v[min(i, len(v) - 1)] for n, v in lists.items()}})
        for i in range(length)
    ]
    if not step.node.has_fields:
        return rows
    return step.node.result_type(*([row[i] for row in rows] for i in range(len(step.wires))))


def _absolute(path: str) -> str:
    return os.path.abspath(path)  # noqa: PTH100, Path.resolve follows links
