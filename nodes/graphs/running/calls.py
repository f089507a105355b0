"""One call of a function, or many: a step mapped over lists, each item with its own key."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from ..annotations import Value
from ..arrays import check_counts, check_magnitudes
from ..errors import NodeError
from ..kinds import convert
from ..node import Node, collected_messages
from ..ports import Port, check_value
from ..specification.wires import Each, Step
from ..stores.digests import digest
from ..stores.entries import Entry, Store
from ..stores.results import own, remade
from .events import RunCancelledError, Watch
from .files import Folders, is_file, paths_of
from .keys import absolute, key_of
from .matching import Index, indices, items_at, nested, shape_of


@dataclass(frozen=True, eq=False)
class Caller:
    """What calls of functions have in common within a run."""

    store: Store
    watch: Watch
    folders: Folders


@dataclass(frozen=True, eq=False)
class Call:
    """What a function is given.

    Attributes
    ----------
    arguments : mapping of str to object
        By input, paths as the function is told.
    written : mapping of str to object
        Of the inputs that write: the paths as the graph gives them.
    parts : mapping of str to bytes
        What the key says of each input.
    at : str
        Item of a list, for messages: ``"[3]"``.
    """

    step: Step
    arguments: Mapping[str, Any]
    written: Mapping[str, Any]
    parts: Mapping[str, bytes]
    at: str = ""


def perform(caller: Caller, call: Call) -> Entry:
    """Call the function of a step once.

    Returns
    -------
    Entry
        Its result, messages and files.

    Raises
    ------
    NodeError
        If it fails; the message names the step, and the item of a list.
    """
    step, folders = call.step, caller.folders
    began = time.perf_counter()
    with collected_messages() as messages:
        try:
            value = _called(step, call.arguments)
        except RunCancelledError:
            raise
        except Exception as error:
            raise failure(folders, step, error, call.at) from error
    seconds = time.perf_counter() - began
    if not call.written and not messages:
        return Entry(own(value), seconds=seconds, made_by=step.node.label)
    told = {
        path: given
        for name, paths in call.written.items()
        for path, given in zip(paths_of(call.arguments[name]), paths_of(paths), strict=True)
    }
    states = tuple((p, caller.store.file_state(p)) for p in map(absolute, told))
    texts = tuple(dict.fromkeys(map(folders.as_given, messages)))
    return Entry(own(_returned(value, told)), texts, states, seconds, step.node.label)


def failure(folders: Folders, step: Step, error: Exception, at: str = "") -> NodeError:
    """The error of a step, from what its function raised."""
    name = step.node.name
    what = f"step {step.name!r}" + (f" (node {name})" if name != step.name else "")
    where = f" at item {at}" if at else ""
    text = folders.as_given(str(error)) or type(error).__name__
    return NodeError(f"{what} failed{where}: {text}", step.name, name, error, text)


def perform_each(caller: Caller, call: Call, node_part: bytes) -> Entry:
    """Map over lists: call the function for each item that is not known yet.

    Parameters
    ----------
    call : Call
        With lists for the inputs that are mapped over.
    node_part : bytes
        What keys say of the node.

    Returns
    -------
    Entry
        Its value is a list, or a named tuple of lists; nested if there are several axes.
    """
    step = call.step
    ports = {name: step.inputs[name] for name in step.node.inputs if name in step.inputs}
    eaches = {name: given for name, given in ports.items() if isinstance(given, Each)}
    lists = {name: list(call.arguments[name]) for name in eaches}
    counts = {name: len(items) for name, items in lists.items()}
    try:
        shape = shape_of(step.name, eaches, counts)
    except ValueError as error:
        raise failure(caller.folders, step, error) from error
    call = replace(
        call,
        arguments={**call.arguments, **lists},
        written={n: list(p) if n in lists else p for n, p in call.written.items()},
    )
    entries: list[Entry] = []
    all_indices = indices(shape)
    for number, index in enumerate(all_indices):
        places = items_at(eaches, counts, index)
        entries.append(_item(caller, _at(caller, call, places, index), node_part))
        caller.watch.check()
        caller.watch.note(step.name, (number + 1) / len(all_indices))
    return _joined(step, entries, shape)


def _at(caller: Caller, call: Call, places: Mapping[str, int], index: Index) -> Call:
    """The call of one item."""
    items = {name: call.arguments[name][place] for name, place in places.items()}
    written = {
        name: paths[places[name]] if name in places else paths
        for name, paths in call.written.items()
    }
    parts = dict(call.parts)
    for name, item in items.items():
        port = call.step.node.inputs[name]
        parts[name] = _item_part(port, item, call.parts[name], places[name], caller.store)
    return Call(
        call.step,
        {**call.arguments, **items},
        written,
        parts,
        "".join(f"[{place}]" for place in index),
    )


def _item_part(port: Port, item: Value, list_part: bytes, place: int, store: Store) -> bytes:
    """An item by its content, so that it is found again elsewhere in the list."""
    try:
        part = digest(item)
    except TypeError:
        part = key_of([list_part, b"%d" % place])
    return key_of([part, file_part(port, item, store.file_state)]) if is_file(port) else part


def file_part(port: Port, value: Value, state: Callable[[str], Any]) -> bytes:
    """What a key says of files: where they are, and of those that are read also their state."""
    paths = list(map(absolute, paths_of(value)))
    return digest([paths, list(map(state, paths)) if port.reads else None])


def _item(caller: Caller, call: Call, node_part: bytes) -> Entry:
    key = key_of([b"item", node_part, *call.parts.values()])
    entry = caller.store.get(key)
    if entry is not None:
        return entry
    with caller.store.flight(key, caller.watch.check):
        entry = caller.store.get(key)
        if entry is None:
            entry = perform(caller, call)
            is_lasting = not (entry.files and caller.folders.is_staged)
            caller.store.put(key, entry, is_lasting=is_lasting)
    return entry


def _joined(step: Step, entries: Sequence[Entry], shape: Index) -> Entry:
    values = [entry.value for entry in entries]
    if step.node.has_fields:
        columns = ([value[i] for value in values] for i in range(len(step.wires)))
        value = step.node.result_type(*(nested(column, shape) for column in columns))
    else:
        value = nested(values, shape)
    return Entry(
        value,
        tuple(dict.fromkeys(text for entry in entries for text in entry.messages)),
        tuple(file for entry in entries for file in entry.files),
        sum(entry.seconds for entry in entries),
        step.node.label,
    )


def _called(step: Step, arguments: Mapping[str, Any]) -> Value:
    node: Node = step.node
    value = node.function(**_inputs(step, arguments))
    if node.has_fields and not isinstance(value, node.result_type):
        kind = node.result_type.__name__
        raise TypeError(f"node {node.name} must return {kind}, not {type(value).__name__}")
    return value


def _inputs(step: Step, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """What a function is given: checked, and in the form that it expects.

    A wire was checked as a type when it was drawn; what has come by it is known only now.
    """
    ports, inputs, has_arrays = step.node.inputs, dict[str, Any](), False
    for name, value in arguments.items():
        where = f"{step.name}.{name}"
        check_value(ports[name], value, where)
        inputs[name] = convert(ports[name].type, value)
        if isinstance(inputs[name], np.ndarray):
            check_magnitudes(inputs[name], where)
            has_arrays = True
    if has_arrays:
        check_counts(step.name, {name: ports[name].type for name in inputs}, inputs)
    return inputs


def _returned(value: Value, written: Mapping[str, str]) -> Value:
    """What a step returns, with the paths of its files as they were given."""
    if not written:
        return value
    if isinstance(value, str | Path):
        given = written.get(os.fspath(value))
        return value if given is None else type(value)(given)
    if isinstance(value, list | tuple):
        several = cast("list[Any] | tuple[Any, ...]", value)
        return remade(several, [_returned(item, written) for item in several])
    return value
