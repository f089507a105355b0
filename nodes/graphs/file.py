"""Graphs as JSON: versioned, in a stable order, and without code."""

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from functools import singledispatch
from graphlib import CycleError, TopologicalSorter
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from ...fabrication.files import replacing
from .annotations import Value
from .errors import GraphError, nearest
from .wires import Each, Param, Step, Wire

FORMAT = "spheremesh graph"
VERSION = 1


def encode_graph(
    title: str, units: str, params: Mapping[str, Mapping[str, Any]], steps: Mapping[str, Step]
) -> str:
    """
    The text of a graph file.

    Parameters
    ----------
    title, units : str
        Of the graph.
    params : mapping of str to mapping
        Value, range and choices of each slider.
    steps : mapping of str to Step
        The steps.

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
        "params": {
            name: {key: _encode_at(f"params.{name}", value) for key, value in facts.items()}
            for name, facts in params.items()
        },
        "steps": {
            name: {
                "node": step.node.name,
                "version": step.node.version,
                "inputs": {
                    port: _encode_at(f"{name}.{port}", step.inputs[port])
                    for port in step.node.inputs
                    if port in step.inputs
                },
            }
            for name, step in steps.items()
        },
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


@singledispatch
def encode(value: Value) -> Value:
    """
    A value, a wire or a slider as JSON.

    Parameters
    ----------
    value : object
        What a step was given.

    Returns
    -------
    object
        Numbers, texts and lists are themselves, all else is tagged.

    Raises
    ------
    GraphError
        If it has no form in JSON.

    Examples
    --------
    >>> encode([1, float("inf"), {"a": None}])
    [1, {'float': 'inf'}, {'mapping': {'a': None}}]
    """
    raise GraphError(
        f"a {type(value).__name__} cannot be written into a graph file; "
        "let a node make it, or read it from a file"
    )


@encode.register(type(None))
@encode.register(bool)
@encode.register(int)
@encode.register(str)
def _(value: Value) -> Value:
    return value


@encode.register
def _(value: float) -> Value:
    return value if math.isfinite(value) else {"float": str(value)}


@encode.register(np.generic)
def _(value: np.generic) -> Value:
    return encode(value.item())


@encode.register(os.PathLike)
def _(value: os.PathLike[str]) -> Value:
    return os.fspath(value)


@encode.register(list)
@encode.register(tuple)
def _(value: Sequence[Value]) -> Value:
    return [encode(item) for item in value]


@encode.register(Mapping)
def _(value: Mapping[Value, Value]) -> Value:
    if not all(isinstance(key, str) for key in value):
        raise GraphError("a mapping in a graph file needs texts as keys")
    return {"mapping": {key: encode(item) for key, item in value.items()}}


@encode.register(np.ndarray)
def _(value: NDArray[Any]) -> Value:
    if value.dtype.kind not in "biuf":
        raise GraphError(f"an array of {value.dtype} cannot be written into a graph file")
    return {"array": encode(value.tolist()), "dtype": value.dtype.name}


@encode.register
def _(value: Each) -> Value:
    return {"each": encode(value.items)}


@encode.register
def _(value: Wire) -> Value:
    return {"wire": value.step.name if len(value.step.wires) == 1 else str(value)}


@encode.register
def _(value: Param) -> Value:
    return {"param": value.name}


def _encode_at(where: str, value: Value) -> Value:
    try:
        return encode(value)
    except GraphError as error:
        raise GraphError(f"{where}: {error}") from error


def decode_graph(text: str) -> dict[str, Any]:
    """
    The content of a graph file, its form checked.

    Parameters
    ----------
    text : str
        JSON.

    Returns
    -------
    dict
        ``title``, ``units``, ``params`` and ``steps``, each step after those it needs.

    Raises
    ------
    GraphError
        If it is no graph file of this version; the message says where.
    """
    try:
        content = json.loads(text)
    except json.JSONDecodeError as error:
        raise GraphError(f"line {error.lineno}: not JSON: {error.msg}") from error
    if not isinstance(content, dict) or cast("Any", content).get("format") != FORMAT:
        raise GraphError(f'not a graph file: "format" must be "{FORMAT}"')
    content = cast("dict[str, Any]", content)
    if content.get("version") != VERSION:
        raise GraphError(
            f'"version" is {content.get("version")!r}, this spheremesh reads {VERSION}'
        )
    _entry(content, "title", str, "")
    _entry(content, "units", str, "")
    for name, facts in _entry(content, "params", dict, "").items():
        _checked(facts, dict, f"params.{name}")
        _refuse_others(facts, ("value", "min", "max", "choices"), f"params.{name}")
        if "value" not in facts:
            raise GraphError(f'params.{name}: "value" is missing')
    for name, step in _entry(content, "steps", dict, "").items():
        where = f"steps.{name}"
        _checked(step, dict, where)
        _entry(step, "node", str, where)
        _entry(step, "version", str, where)
        _entry(step, "inputs", dict, where)
    content["steps"] = _in_order(content["steps"])
    return content


class _Names(Protocol):
    def wire(self, name: str, /) -> Value: ...
    def slider(self, name: str, /) -> Value: ...


def decode(value: Value, graph: _Names) -> Value:
    """
    The inverse of `encode`.

    Parameters
    ----------
    value : object
        JSON.
    graph : Graph
        Gives the wires and sliders that are named.

    Returns
    -------
    object
        What a step is given.

    Raises
    ------
    GraphError
        If the tag is unknown, or the wire or slider is.
    """
    if isinstance(value, list):
        return [decode(item, graph) for item in cast("list[Value]", value)]
    if not isinstance(value, dict):
        return value
    tagged = cast("dict[str, Value]", value)
    tag = next((tag for tag in tagged if tag in _DECODERS), "")
    if not tag or not tagged.keys() <= {tag, "dtype"}:
        raise GraphError(
            f"cannot read {json.dumps(tagged)[:60]}: expected a value or one of "
            f"{', '.join(_DECODERS)}"
        )
    try:
        return _DECODERS[tag](tagged, graph)
    except (AttributeError, TypeError, ValueError) as error:
        if isinstance(error, GraphError):
            raise
        raise GraphError(f"cannot read {json.dumps(tagged)[:60]}: {error}") from error


_DECODERS: dict[str, Callable[[dict[str, Value], _Names], Value]] = {
    "wire": lambda tagged, graph: graph.wire(tagged["wire"]),
    "param": lambda tagged, graph: graph.slider(tagged["param"]),
    "each": lambda tagged, graph: Each(decode(tagged["each"], graph)),
    "array": lambda tagged, graph: np.array(
        decode(tagged["array"], graph), np.dtype(tagged.get("dtype", "float64"))
    ),
    "mapping": lambda tagged, graph: {
        key: decode(item, graph) for key, item in tagged["mapping"].items()
    },
    "float": lambda tagged, _: float(tagged["float"]),
}


def write_graph(path: str | os.PathLike[str], text: str) -> None:
    """
    Write a graph file: the whole or nothing.

    Parameters
    ----------
    path : path
        The file.
    text : str
        Its content.
    """
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


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
    ordered: dict[str, Any] = {}
    while len(ordered) < len(steps):
        for name, step in steps.items():
            if name not in ordered and needed[name] <= ordered.keys():
                ordered[name] = step
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
