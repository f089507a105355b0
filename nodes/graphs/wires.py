"""What a graph is made of: sliders, steps, and the wires between them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias, cast

from .errors import UnknownPortError, nearest
from .node import Node
from .ports import Hint, Port, Value


@dataclass(frozen=True, eq=False)
class Param:
    """
    A slider.

    Attributes
    ----------
    graph : object
        The graph that it belongs to.
    name : str
        Its name.
    value : object
        Its value when the graph was put together; `Graph.values` holds the present one.
    port : Port
        Range and choices.
    """

    graph: object = field(repr=False)
    name: str
    value: Value
    port: Port = field(repr=False)


@dataclass(frozen=True, eq=False)
class Wire:
    """
    An output of a step.

    Attributes
    ----------
    step : Step
        The step.
    port : Port
        The output.
    """

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
    """
    A list that a step is mapped over.

    Attributes
    ----------
    items : list, Wire or Param
        The list, or the output or slider that gives it.
    """

    items: Value


@dataclass(frozen=True, eq=False)
class Step:
    """
    A node within a graph; its outputs are its attributes.

    Attributes
    ----------
    graph : object
        The graph that it belongs to.
    name : str
        Its name.
    node : Node
        The node.
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
        outputs = self.node.outputs
        if port not in outputs:
            raise UnknownPortError(
                f"step {self.name!r} (node {self.node.name}) has no output {port!r}; "
                f"{nearest(port, outputs)}"
            )
        return Wire(self, outputs[port])

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


Target: TypeAlias = Step | Wire | Param | str


def sources(value: Value) -> Iterator[Wire | Param]:
    """
    What a value given for an input is wired to.

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
    """
    Names of the steps that a step takes its inputs from.

    Parameters
    ----------
    step : Step
        The step.

    Returns
    -------
    list of str
        Names.
    """
    return [wire.step.name for _, wire in step.sources if isinstance(wire, Wire)]
