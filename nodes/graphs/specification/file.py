"""Graphs as JSON: versioned, in a stable order, and without code."""

import json
import os
import stat
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any, Protocol, TypeVar, cast

from ....fabrication.files import replacing
from ..annotations import Value
from ..errors import GraphError, nearest
from ..node import Node, find_node
from ..ports import Port
from .encoding import MOST_BYTES, Names, decode, encode, parse_json
from .wires import Param, Step, Wire

_Parsed = TypeVar("_Parsed")

FORMAT = "spheremesh graph"
VERSION = 1
_LONGEST_MESSAGE = 400

RENAMED_PORTS: dict[str, dict[str, str]] = {"cluster_radii": {"seed": ""}}
"""Present names of ports by node and by the name in older graph files; empty if it has gone."""


def encode_graph(
    title: str, units: str, params: Mapping[str, Param], steps: Mapping[str, Step]
) -> str:
    """The text of a graph file.

    Parameters
    ----------
    params : mapping of str to Param
        Its sliders, with their present values.
    steps : mapping of str to Step

    Returns
    -------
    str
        JSON, one entry a line.

    Raises
    ------
    GraphError
        If a value has no form in JSON; the message names the input.
    """
    content = {
        "format": FORMAT,
        "version": VERSION,
        "title": title,
        "units": units,
        "params": {name: _encode_param(param) for name, param in params.items()},
        "steps": {name: _encode_step(step) for name, step in steps.items()},
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _encode_param(param: Param) -> dict[str, Value]:
    port = param.port
    limits = {"min": port.min, "max": port.max, "choices": list(port.choices) or None}
    facts = {"value": param.value, **{k: v for k, v in limits.items() if v is not None}}
    return {key: _encode_at(f"params.{param.name}", value) for key, value in facts.items()}


def _encode_step(step: Step) -> dict[str, Value]:
    inputs = {
        port: _encode_at(f"{step.name}.{port}", step.inputs[port])
        for port in step.node.inputs
        if port in step.inputs
    }
    return {"node": step.node.name, "version": step.node.version, "inputs": inputs}


def _encode_at(where: str, value: Value) -> Value:
    try:
        return encode(value)
    except GraphError as error:
        raise GraphError(f"{where}: {error}") from error


class _Graph(Protocol):
    @property
    def steps(self) -> Mapping[str, Step]: ...
    def wire(self, name: str, /) -> Step | Wire: ...
    def slider(self, name: str, /) -> Param: ...
    @property
    def param(self) -> Callable[..., Param]: ...
    def add(self, node: str, name: str, /, **inputs: Value) -> Step: ...


def decode_graph(text: str) -> dict[str, Any]:
    """The content of a graph file, its form checked.

    Returns
    -------
    dict
        ``title``, ``units``, ``params`` and ``steps``, each step after those it needs.

    Raises
    ------
    GraphError
        If it is no graph file of this version; the message says where.
    """
    content = parse_json(text)
    if not isinstance(content, dict) or cast("Any", content).get("format") != FORMAT:
        raise GraphError(f'not a graph file: "format" must be "{FORMAT}"')
    content = cast("dict[str, Any]", content)
    version = content.get("version")
    if type(version) is not int or version != VERSION:
        shown = repr(version)[:40]
        raise GraphError(f'"version" is {shown}, this spheremesh reads {VERSION}')
    _entry(content, "title", str, "")
    _entry(content, "units", str, "")
    for name, facts in _entry(content, "params", dict, "").items():
        _checked(facts, dict, f"params.{name}")
        _refuse_others(facts, ("value", "min", "max", "choices"), f"params.{name}")
        if "value" not in facts:
            raise GraphError(f'params.{name}: "value" is missing')
        if not isinstance(facts.get("choices", []), list):
            raise GraphError(f'params.{name}: "choices" must be a list')
    for name, step in _entry(content, "steps", dict, "").items():
        where = f"steps.{name}"
        _checked(step, dict, where)
        _entry(step, "node", str, where)
        _entry(step, "version", str, where)
        _entry(step, "inputs", dict, where)
    content["steps"] = _in_order(content["steps"])
    return content


def add_content(graph: _Graph, content: Mapping[str, Any]) -> None:
    """Give an empty graph the sliders and steps of a graph file.

    Parameters
    ----------
    content : mapping
        From `decode_graph`.

    Raises
    ------
    GraphError
        If a slider or a step is not valid; the message names it.
    """
    names = Names(partial(_wire, graph), graph.slider)
    for name, facts in content["params"].items():
        try:
            graph.param(name, **{key: decode(value, names) for key, value in facts.items()})
        except (GraphError, TypeError) as error:
            raise GraphError(f"params.{name}: {error}") from error
    for name, step in content["steps"].items():
        try:
            known = find_node(step["node"])
            inputs = _present_inputs(known, step["inputs"])
            inputs = {port: decode(value, names) for port, value in inputs.items()}
            graph.add(known.name, name, **inputs)
        except GraphError as error:
            raise GraphError(f"steps.{name}: {error}") from error
        if known.version != step["version"]:
            warnings.warn(
                f"step {name!r} was saved with version {step['version']} of node "
                f"{known.name}, this is {known.version}: results may differ",
                stacklevel=2,
            )


def _present_inputs(node: Node, inputs: Mapping[str, Value]) -> dict[str, Value]:
    """Inputs by the present names of their ports."""
    present: dict[str, Value] = {}
    for old, value in inputs.items():
        port = _present(node, old, node.inputs)
        if not port:
            continue
        if port in present:
            raise GraphError(f"{port!r} is given twice, once as {old!r}")
        present[port] = value
    return present


def _wire(graph: _Graph, name: str) -> Step | Wire:
    """What a graph file names, by its present name."""
    step_name, dot, port = name.partition(".")
    step = graph.steps.get(step_name)
    if dot and step is not None:
        name = f"{step_name}.{_present(step.node, port, step.node.outputs)}"
    return graph.wire(name)


def _present(node: Node, port: str, ports: Mapping[str, Port]) -> str:
    return port if port in ports else RENAMED_PORTS.get(node.name, {}).get(port, port)


def write_graph(path: str | os.PathLike[str], text: str) -> None:
    """Write a graph file: the whole or nothing."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def read_graph(path: str | os.PathLike[str], parse: Callable[[str], _Parsed]) -> _Parsed:
    """Read a graph file; errors name it.

    Parameters
    ----------
    parse : callable
        Makes the graph of its text.

    Returns
    -------
    object
        What `parse` returns.

    Raises
    ------
    GraphError
        If it is no valid graph file.
    """
    name = os.fspath(path)
    try:
        return parse(_text(Path(path)))
    except UnicodeDecodeError as error:
        raise GraphError(f"{name}: not UTF-8 text: byte {error.start} is none of it") from error
    except (OSError, ValueError) as error:
        text = getattr(error, "strerror", None) or str(error)
        text = text if len(text) <= _LONGEST_MESSAGE else f"{text[:_LONGEST_MESSAGE]}..."
        raise GraphError(f"{name}: {text}") from error


def _text(path: Path) -> str:
    """Text of a regular file: pipes and devices may never end."""
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise GraphError("not a file: save the graph to one")
    with path.open("rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise GraphError(
            f"longer than {MOST_BYTES} bytes: let a node read what is large from a file "
            "of its own"
        )
    return data.decode("utf-8")


def _in_order(steps: dict[str, Any]) -> dict[str, Any]:
    """The order of the file, changed only where a step stands before one it needs."""
    needed = {
        name: {wire for value in step["inputs"].values() for wire in _wired(value)}
        for name, step in steps.items()
    }
    for name, others in needed.items():
        for other in others - steps.keys():
            raise GraphError(
                f"steps.{name}: wired to an unknown step {other!r}; {nearest(other, steps)}"
            )
    try:
        TopologicalSorter(needed).prepare()
    except CycleError as error:
        cycle = " -> ".join(reversed(cast("list[str]", error.args[1])))
        raise GraphError(f"the steps form a cycle: {cycle}") from error
    position = {name: i for i, name in enumerate(steps)}
    ordered: dict[str, Any] = {}
    for first in steps:
        pending = [first]
        while pending:
            name = pending[-1]
            missing = needed[name] - ordered.keys() if name not in ordered else ()
            if missing:
                pending.extend(sorted(missing, key=position.__getitem__, reverse=True))
            else:
                pending.pop()
                ordered.setdefault(name, steps[name])
    return ordered


def _wired(value: Value) -> list[str]:
    if isinstance(value, list):
        return [name for item in cast("list[Value]", value) for name in _wired(item)]
    if not isinstance(value, dict):
        return []
    tagged = cast("dict[str, Value]", value)
    wire = tagged.get("wire")
    return [wire.partition(".")[0]] if isinstance(wire, str) else _wired(tagged.get("each"))


def _entry(content: Mapping[str, Any], key: str, kind: type, where: str) -> Value:
    at = f"{where}: " if where else ""
    if key not in content:
        raise GraphError(f'{at}"{key}" is missing')
    return _checked(content[key], kind, f'{at}"{key}"')


def _checked(value: Value, kind: type, where: str) -> Value:
    if not isinstance(value, kind):
        name = {dict: "an object", str: "a text"}[kind]
        raise GraphError(f"{where} must be {name}, not {json.dumps(value)[:40]}")
    return value


def _refuse_others(facts: Mapping[str, Any], known: Sequence[str], where: str) -> None:
    for key in facts:
        if key not in known:
            raise GraphError(f"{where}: unknown entry {key!r}; {nearest(key, known)}")
