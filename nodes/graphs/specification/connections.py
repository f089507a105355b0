"""The checks of what is wired: both ends are named, and what would fit."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from ..annotations import Hint, Value, element_type, type_name
from ..errors import GraphError, nearest
from ..kinds import fits
from ..node import Node
from ..ports import REQUIRED, Port, check_value
from ..stores.digests import digest
from .wires import Each, Param, Step, Wire, axes_of, output_wire, sources


@dataclass(frozen=True, eq=False)
class Place:
    """Where an input is wired.

    Attributes
    ----------
    graph : object
        What its steps and sliders have in common.
    steps : mapping of str to Step
        Those of the graph at present.
    values : mapping of str to object
        Of its sliders.
    step : str
        Name of the step.
    """

    graph: object
    steps: Mapping[str, Step]
    values: Mapping[str, Any]
    step: str


def connect(place: Place, port: Port, given: Value, at: str = "") -> Value:
    """What is kept of a value given for an input: steps become wires.

    Parameters
    ----------
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
        return replace(given, items=_connect_each(place, port, given.items))
    if isinstance(given, Step | Wire):
        given = present(place.graph, place.steps, given)
    if isinstance(given, Step):
        given = only_output(given, port.type, where)
    if isinstance(given, Wire):
        _check_wire(given, given.type, port, where)
    elif isinstance(given, Param):
        value = _present_value(place, given)
        _check_literal(port, value, f"param {given.name} for {where}")
    elif isinstance(given, list | tuple) and _has_sources(given):
        if not fits(list[Any], port.type):
            raise GraphError(f"{where}: a list, must be {type_name(port.type)}; use each(...)")
        item_port = replace(port, type=element_type(port.type))
        items = cast("Sequence[Value]", given)
        return [connect(place, item_port, x, f"{at}[{i}]") for i, x in enumerate(items)]
    else:
        _check_literal(port, given, where)
    return cast("Value", given)


def check_owner(graph: object, target: Step | Wire | Param) -> None:
    """Refuse what belongs to another graph.

    Parameters
    ----------
    target : Step, Wire or Param
        Something that should be part of it.

    Raises
    ------
    GraphError
    """
    if not isinstance(target, Step | Wire | Param):  # pyright: ignore[reportUnnecessaryIsInstance]
        kind = type(target).__name__
        raise GraphError(f"a target is a step, an output, a slider or its name, not {kind}")
    owner = target.step if isinstance(target, Wire) else target
    if owner.graph is not graph:
        name = str(target) if isinstance(target, Wire) else target.name
        raise GraphError(f"{name} is part of another graph")


def present(graph: object, steps: Mapping[str, Step], target: Step | Wire) -> Step | Wire:
    """A step or output as it is now: who holds one knows how it was when it was added.

    Raises
    ------
    GraphError
        If it is of another graph, or there is none of that name any more.
    """
    check_owner(graph, target)
    step = target.step if isinstance(target, Wire) else target
    now = steps.get(step.name)
    if now is None:
        raise GraphError(f"there is no step {step.name!r} any more; {nearest('', steps)}")
    if now is step:
        return target
    return output_wire(now, target.port.name) if isinstance(target, Wire) else now


def _present_value(place: Place, param: Param) -> Value:
    check_owner(place.graph, param)
    if param.name not in place.values:
        raise GraphError(f"there is no param {param.name!r} any more")
    return place.values[param.name]


def check_name(name: str, what: str) -> None:
    """Refuse a name that could not be told from others in ``step.port``.

    Parameters
    ----------
    what : str
        Of what, for the message.

    Raises
    ------
    GraphError
        If it is no identifier.
    """
    if not name.isidentifier():
        raise GraphError(f"{what} name {name!r}: use letters, digits and _ only")


def connect_all(place: Place, node: Node, inputs: Mapping[str, Value]) -> dict[str, Value]:
    """What is kept of all that is given for a step.

    Parameters
    ----------
    inputs : mapping of str to object
        By name of the port, as for `connect`.

    Returns
    -------
    dict of str to object
        The same with `Wire` for steps.

    Raises
    ------
    GraphError
        If an input is unknown, missing or does not fit.
    """
    check_name(place.step, "step")
    at = f"step {place.step!r}" + (f" (node {node.name})" if node.name != place.step else "")
    for name in inputs:
        if name not in node.inputs:
            raise GraphError(f"{at} has no input {name!r}; {nearest(name, node.inputs)}")
    for name, port in node.inputs.items():
        if port.default is REQUIRED and name not in inputs:
            raise GraphError(f"{at} misses its input {name!r} ({type_name(port.type)})")
    ports = node.inputs
    connected = {name: connect(place, ports[name], given) for name, given in inputs.items()}
    _check_axes(place.step, {name: connected[name] for name in ports if name in connected})
    return connected


def _check_axes(step: str, inputs: Mapping[str, Value]) -> None:
    """Refuse lists of one axis whose rules contradict each other."""
    eaches = {name: given for name, given in inputs.items() if isinstance(given, Each)}
    for axis, names in axes_of(eaches).items():
        rules = {eaches[name].match: name for name in names if eaches[name].match}
        if len(rules) > 1:
            (one, first), (other, second) = list(rules.items())[:2]
            where = f" of axis {axis!r}" if axis else ""
            raise GraphError(
                f"{step}.{first} and {step}.{second}{where}: match={one!r} contradicts "
                f"match={other!r}; say it once, or give one an axis of its own"
            )


def _check_literal(port: Port, value: Value, where: str) -> None:
    """Refuse what an input does not accept, or what cannot be part of a key."""
    check_value(port, value, where)
    try:
        digest(value)
    except TypeError as error:
        raise GraphError(f"{where}: {error}") from error


def _has_sources(values: Value) -> bool:
    return any(isinstance(x, Step | Each) or any(sources(x)) for x in values)


def _connect_each(place: Place, port: Port, items: Value) -> Value:
    where = f"{place.step}.{port.name}"
    if isinstance(items, Step | Wire):
        items = present(place.graph, place.steps, items)
    if isinstance(items, Step):
        items = only_output(items, list[port.type], where)
    if isinstance(items, Wire):
        if not fits(items.type, Iterable[Any]):
            raise GraphError(f"{where}: each needs a list, {items} is {type_name(items.type)}")
        _check_wire(items, element_type(items.type), port, f"each of {where}")
        return items
    values = _present_value(place, items) if isinstance(items, Param) else items
    is_list = hasattr(values, "__len__") and getattr(values, "ndim", 1) > 0
    if isinstance(values, str | bytes) or not is_list:
        raise GraphError(f"{where}: each needs a list, not {type(values).__name__}")
    if any(isinstance(item, Each) for item in values):
        raise GraphError(f"{where}: each within each; give one list")
    connected = [connect(place, port, item, f"[{i}]") for i, item in enumerate(values)]
    return items if isinstance(items, Param) else connected


def only_output(step: Step, kind: Hint = Any, where: str = "its place") -> Wire:
    """The output of a step that has one; the error of another says which would fit."""
    if not step.node.is_known:
        return output_wire(step, "")
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
