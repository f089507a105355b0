"""The checks made when a step is added to a graph."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from .cache import digest
from .errors import GraphError, nearest
from .node import Node
from .ports import (
    REQUIRED,
    Hint,
    Port,
    Value,
    accepts,
    check_value,
    element_type,
    fits,
    type_name,
)
from .wires import Each, Param, Step, Wire, sources


@dataclass(frozen=True, eq=False)
class Place:
    """
    Where an input is wired.

    Attributes
    ----------
    graph : object
        The graph.
    values : mapping of str to object
        Values of its sliders.
    step : str
        Name of the step.
    """

    graph: object
    values: Mapping[str, Any]
    step: str


def connect(place: Place, port: Port, given: Value, at: str = "") -> Value:
    """
    What is kept of a value given for an input: steps become wires.

    Parameters
    ----------
    place : Place
        The graph and the step.
    port : Port
        The input.
    given : object
        A step, output, slider, value, list of these, or ``each`` of such a list.
    at : str
        Position in a list, for the message.

    Returns
    -------
    object
        The same with `Wire` for steps.

    Raises
    ------
    GraphError
        If it does not fit; the message names both ends.
    """
    where = f"{place.step}.{port.name}{at}"
    if isinstance(given, Each):
        return Each(_connect_each(place, port, given.items))
    if isinstance(given, Step):
        given = _only_output(given, port.type, where)
    if isinstance(given, Wire):
        own(place.graph, given)
        _check_wire(given, given.type, port, where)
    elif isinstance(given, Param):
        own(place.graph, given)
        value = place.values[given.name]
        check_literal(port, value, f"param {given.name} for {where}")
    elif isinstance(given, list | tuple) and _has_sources(given):
        if not accepts(port.type, []):
            raise GraphError(f"{where}: a list, must be {type_name(port.type)}; use each(...)")
        item_port = replace(port, type=element_type(port.type))
        items = cast("Sequence[Value]", given)
        return [connect(place, item_port, x, f"{at}[{i}]") for i, x in enumerate(items)]
    else:
        check_literal(port, given, where)
    return cast("Value", given)


def own(graph: object, target: Step | Wire | Param) -> None:
    """
    Refuse what belongs to another graph.

    Parameters
    ----------
    graph : object
        The graph.
    target : Step, Wire or Param
        Something that should be part of it.

    Raises
    ------
    GraphError
        If it is not.
    """
    if not isinstance(target, Step | Wire | Param):  # pyright: ignore[reportUnnecessaryIsInstance]
        kind = type(target).__name__
        raise GraphError(f"a target is a step, an output, a slider or its name, not {kind}")
    owner = target.step if isinstance(target, Wire) else target
    if owner.graph is not graph:
        name = str(target) if isinstance(target, Wire) else target.name
        raise GraphError(f"{name} is part of another graph")


def check_literal(port: Port, value: Value, where: str) -> None:
    """
    Refuse a value that an input does not accept, or that cannot be part of a key.

    Parameters
    ----------
    port : Port
        The input.
    value : object
        The value.
    where : str
        How the message names the input.

    Raises
    ------
    GraphError
        The message says what is allowed.
    """
    check_value(port, value, where)
    try:
        digest(value)
    except TypeError as error:
        raise GraphError(f"{where}: {error}") from error


def check_names(node: Node, step: str, inputs: Mapping[str, Value]) -> None:
    """
    Refuse inputs that a node does not have, and require those without a default.

    Parameters
    ----------
    node : Node
        The node.
    step : str
        Name of the step.
    inputs : mapping of str to object
        What was given.

    Raises
    ------
    GraphError
        The message gives the nearest name.
    """
    at = f"step {step!r}" + (f" (node {node.name})" if node.name != step else "")
    for name in inputs:
        if name not in node.inputs:
            raise GraphError(f"{at} has no input {name!r}; {nearest(name, node.inputs)}")
    for name, port in node.inputs.items():
        if port.default is REQUIRED and name not in inputs:
            raise GraphError(f"{at} misses its input {name!r} ({type_name(port.type)})")


def check_name(name: str, what: str) -> None:
    """
    Refuse a name that could not be told from others in ``step.port``.

    Parameters
    ----------
    name : str
        The name.
    what : str
        Of what, for the message.

    Raises
    ------
    GraphError
        If it is no identifier.
    """
    if not name.isidentifier():
        raise GraphError(f"{what} name {name!r}: use letters, digits and _ only")


def _has_sources(values: Value) -> bool:
    return any(isinstance(x, Step | Each) or any(True for _ in sources(x)) for x in values)


def _connect_each(place: Place, port: Port, items: Value) -> Value:
    where = f"{place.step}.{port.name}"
    if isinstance(items, Step):
        items = _only_output(items, list[port.type], where)
    if isinstance(items, Wire):
        own(place.graph, items)
        _check_wire(items, element_type(items.type), port, f"each of {where}")
        return items
    values = place.values[items.name] if isinstance(items, Param) else items
    if isinstance(values, str | bytes) or not hasattr(values, "__len__"):
        raise GraphError(f"{where}: each needs a list, not {type(values).__name__}")
    connected = [connect(place, port, item, f"[{i}]") for i, item in enumerate(values)]
    return items if isinstance(items, Param) else connected


def _only_output(step: Step, kind: Hint, where: str) -> Wire:
    if len(step.wires) == 1:
        return step.wires[0]
    fitting = [str(wire) for wire in step.wires if fits(wire.type, kind)]
    advice = f"choose {' or '.join(fitting)}" if fitting else f"none is {type_name(kind)}"
    raise GraphError(f"cannot wire {step.name} into {where}: it has several outputs; {advice}")


def _check_wire(wire: Wire, kind: Hint, port: Port, where: str) -> None:
    if fits(kind, port.type):
        return
    message = f"cannot wire {wire} ({type_name(kind)}) into {where} ({type_name(port.type)})"
    if kind == wire.type and wire.step.is_mapped and fits(wire.port.type, port.type):
        raise GraphError(f"{message}; map over the list with each(...)")
    others = [str(o) for o in wire.step.wires if fits(o.type, port.type)]
    raise GraphError(f"{message}" + (f"; {' or '.join(others)} would fit" if others else ""))
