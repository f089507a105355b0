"""What a graph is made of: sliders, steps, the wires between them, and the checks of these."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, cast

from .annotations import Hint, Value, element_type, type_name
from .cache import digest
from .errors import GraphError, UnknownPortError, nearest
from .kinds import accepts, fits
from .node import Node
from .ports import REQUIRED, Port, check_value


@dataclass(frozen=True, eq=False)
class Param:
    """A slider.

    Attributes
    ----------
    graph : object
        The graph that it belongs to.
    value : object
        Its value when the graph was put together; `Graph.values` holds the present one.
    """

    graph: object = field(repr=False)
    name: str
    value: Value
    port: Port = field(repr=False)


@dataclass(frozen=True, eq=False)
class Wire:
    """An output of a step."""

    step: "Step"
    port: Port

    def __str__(self) -> str:
        return f"{self.step.name}.{self.port.name}"

    @property
    def type(self) -> Hint:  # numpydoc ignore=RT01
        """Type of the values that come by the wire."""
        return list[self.port.type] if self.step.is_mapped else self.port.type


@dataclass(frozen=True, eq=False)
class Each:
    """A list that a step is mapped over.

    Attributes
    ----------
    items : list, Wire or Param
        The list, or the output or slider that gives it.
    """

    items: Value


@dataclass(frozen=True, eq=False)
class Step:
    """A node within a graph; its outputs are its attributes.

    Attributes
    ----------
    graph : object
        The graph that it belongs to.
    inputs : mapping of str to object
        What was given for the inputs: `Wire`, `Param`, `Each` or a value.
    """

    graph: object = field(repr=False)
    name: str
    node: Node
    inputs: Mapping[str, Any] = field(repr=False)

    def __getattr__(self, port: str) -> Wire:
        if port.startswith("_"):
            raise AttributeError(port)
        return output_wire(self, port)

    @property
    def wires(self) -> tuple[Wire, ...]:  # numpydoc ignore=RT01
        """All outputs."""
        return tuple(Wire(self, port) for port in self.node.outputs.values())

    @property
    def sources(self) -> list[tuple[str, Wire | Param]]:  # numpydoc ignore=RT01
        """The inputs that are wired, and to what."""
        return [(name, wire) for name, value in self.inputs.items() for wire in sources(value)]

    @property
    def is_mapped(self) -> bool:  # numpydoc ignore=RT01
        """Whether an input is a list to map over, so that the outputs are lists."""
        return any(isinstance(value, Each) for value in self.inputs.values())


def output_wire(step: Step, port: str) -> Wire:
    """An output of a step by name.

    Raises
    ------
    UnknownPortError
        If there is none; the message gives the nearest.
    """
    outputs = step.node.outputs
    if port not in outputs:
        raise UnknownPortError(
            f"step {step.name!r} (node {step.node.name}) has no output {port!r}; "
            f"{nearest(port, outputs)}"
        )
    return Wire(step, outputs[port])


Target: TypeAlias = Step | Wire | Param | str


def sources(value: Value) -> Iterator[Wire | Param]:
    """What a value given for an input is wired to.

    Parameters
    ----------
    value : object
        One of the values of `Step.inputs`.

    Yields
    ------
    Wire or Param
        The value itself, or those in a list.
    """
    if isinstance(value, Wire | Param):
        yield value
    elif isinstance(value, Each):
        yield from sources(value.items)
    elif isinstance(value, list | tuple):
        for item in cast("Sequence[Value]", value):
            yield from sources(item)


def parents(step: Step) -> list[str]:
    """Names of the steps that a step takes its inputs from."""
    return [wire.step.name for _, wire in step.sources if isinstance(wire, Wire)]


@dataclass(frozen=True, eq=False)
class Place:
    """Where an input is wired.

    Attributes
    ----------
    values : mapping of str to object
        Of its sliders.
    """

    graph: object
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
        return Each(_connect_each(place, port, given.items))
    if isinstance(given, Step):
        given = _only_output(given, port.type, where)
    if isinstance(given, Wire):
        check_owner(place.graph, given)
        _check_wire(given, given.type, port, where)
    elif isinstance(given, Param):
        check_owner(place.graph, given)
        value = place.values[given.name]
        _check_literal(port, value, f"param {given.name} for {where}")
    elif isinstance(given, list | tuple) and _has_sources(given):
        if not accepts(port.type, []):
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
    return {name: connect(place, node.inputs[name], given) for name, given in inputs.items()}


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
    if isinstance(items, Step):
        items = _only_output(items, list[port.type], where)
    if isinstance(items, Wire):
        check_owner(place.graph, items)
        if not fits(items.type, Iterable[Any]):
            raise GraphError(f"{where}: each needs a list, {items} is {type_name(items.type)}")
        _check_wire(items, element_type(items.type), port, f"each of {where}")
        return items
    values = place.values[items.name] if isinstance(items, Param) else items
    is_list = hasattr(values, "__len__") and getattr(values, "ndim", 1) > 0
    if isinstance(values, str | bytes) or not is_list:
        raise GraphError(f"{where}: each needs a list, not {type(values).__name__}")
    if any(isinstance(item, Each) for item in values):
        raise GraphError(f"{where}: each within each; give one list")
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
