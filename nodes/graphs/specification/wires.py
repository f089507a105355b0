"""What a graph is made of: sliders, steps, the wires between them, lists to map over."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, TypeAlias, cast

from ..annotations import Hint, Value
from ..errors import GraphError, UnknownPortError, nearest
from ..node import Node
from ..ports import Port


def _empty() -> Mapping[str, Any]:
    return _EMPTY


@dataclass(frozen=True, eq=False)
class Param:
    """A slider.

    Attributes
    ----------
    graph : object
        What all that belongs to a graph and its copies has in common.
    value : object
        Its value when the slider was made; that of `Graph.params` is the present one.
    extra : mapping of str to object
        Entries of its place in a graph file that others have put there.
    """

    graph: object = field(repr=False)
    name: str
    value: Value
    port: Port = field(repr=False)
    extra: Mapping[str, Any] = field(default_factory=_empty, repr=False)


@dataclass(frozen=True, eq=False)
class Wire:
    """An output of a step."""

    step: "Step"
    port: Port

    def __str__(self) -> str:
        # The only output of a step whose node is not known has no name.
        return f"{self.step.name}.{self.port.name}".removesuffix(".")

    @property
    def type(self) -> Hint:  # numpydoc ignore=RT01
        """Type of the values that come by the wire."""
        kind = self.port.type
        for _ in range(self.step.nesting):
            kind = list[kind]
        return kind


@dataclass(frozen=True, eq=False)
class Each:
    """A list that a step is mapped over.

    Attributes
    ----------
    items : list, Wire or Param
        The list, or the output or slider that gives it.
    match : {"", "longest", "shortest", "same"}
        How lists of an axis go together; empty for what others of the axis say, or the
        longest.
    axis : str
        Lists of one axis run side by side, those of different axes are combined all with all.
    """

    items: Value
    match: str = ""
    axis: str = ""


_EMPTY: Mapping[str, Any] = MappingProxyType({})
MATCHES = ("longest", "shortest", "same")


def each(values: Value, *, match: str = "", axis: str = "") -> Each:
    """Map a step over a list, instead of giving it the list as one value.

    The outputs of the step are lists. A list that comes by wire and is not marked is one value:
    that is how results are collected.

    Parameters
    ----------
    values : list, Step, Wire or Param
        The list, or what gives it.
    match : {"longest", "shortest", "same"}
        How several lists go together: the longest counts and shorter ones repeat their last
        item (the default), the shortest counts, or all must have the same length.
    axis : str
        Lists of one axis run side by side. Lists of different axes are combined all with all,
        and the outputs are lists within lists, a level for each axis in the order of the
        inputs.

    Returns
    -------
    Each
        To be given for an input in `Graph.add`.

    Raises
    ------
    GraphError
        If it is no list, or the rule is unknown.

    Examples
    --------
    >>> from spheremesh.nodes import Graph, node
    >>> @node
    ... def times(a: float, b: float) -> float:
    ...     return a * b
    >>> graph = Graph()
    >>> graph.run(graph.add(times, a=each([1, 2, 3]), b=each([10, 20])))
    [10, 40, 60]
    >>> graph.run(graph.add(times, a=each([1, 2, 3]), b=each([10, 20], axis="j")))
    [[10, 20], [20, 40], [30, 60]]
    """
    if match not in ("", *MATCHES):
        raise GraphError(f"each: match = {match!r}: {nearest(str(match), MATCHES)}")
    if not isinstance(axis, str) or not (axis == "" or axis.isidentifier()):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise GraphError(f"each: axis = {axis!r}: use letters, digits and _ only")
    if isinstance(values, Step | Wire | Param | Sequence) or hasattr(values, "__array__"):
        return Each(values, match, axis)
    if isinstance(values, Iterable):
        return Each(list(values), match, axis)  # pyright: ignore[reportUnknownArgumentType]
    raise GraphError(f"each needs a list or a wire, not {type(values).__name__}")


@dataclass(frozen=True, eq=False)
class Step:
    """A node within a graph; its outputs are its attributes.

    Attributes
    ----------
    graph : object
        What all that belongs to a graph and its copies has in common.
    inputs : mapping of str to object
        What was given for the inputs: `Wire`, `Param`, `Each` or a value.
    unfinished : str
        Why it cannot be run; empty for a step that is finished.
    extra : mapping of str to object
        Entries of a graph file that others put there.
    """

    graph: object = field(repr=False)
    name: str
    node: Node
    inputs: Mapping[str, Any] = field(repr=False)
    unfinished: str = ""
    extra: Mapping[str, Any] = field(default_factory=_empty, repr=False)

    def __getattr__(self, port: str) -> Wire:
        if port.startswith("_"):
            raise AttributeError(port)
        return output_wire(self, port)

    @cached_property
    def wires(self) -> tuple[Wire, ...]:  # numpydoc ignore=RT01
        """All outputs."""
        return tuple(Wire(self, port) for port in self.node.outputs.values())

    @cached_property
    def sources(self) -> list[tuple[str, Wire | Param]]:  # numpydoc ignore=RT01
        """The inputs that are wired, and to what."""
        return [(name, wire) for name, value in self.inputs.items() for wire in sources(value)]

    @cached_property
    def parents(self) -> tuple[str, ...]:  # numpydoc ignore=RT01
        """Names of the steps that it takes its inputs from."""
        return tuple(wire.step.name for _, wire in self.sources if isinstance(wire, Wire))

    @property
    def is_mapped(self) -> bool:  # numpydoc ignore=RT01
        """Whether an input is a list to map over, so that the outputs are lists."""
        return self.nesting > 0

    @cached_property
    def nesting(self) -> int:  # numpydoc ignore=RT01
        """How deeply the lists are nested that its outputs are; 0 if it is not mapped."""
        eaches = (value for value in self.inputs.values() if isinstance(value, Each))
        return len({value.axis for value in eaches})


def output_wire(step: Step, port: str) -> Wire:
    """An output of a step by name.

    Raises
    ------
    UnknownPortError
        If there is none; the message gives the nearest.
    """
    outputs = step.node.outputs
    if not step.node.is_known:
        return Wire(step, Port(name=port))
    if not port and len(outputs) == 1:
        return step.wires[0]
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


def axes_of(eaches: Mapping[str, Each]) -> dict[str, list[str]]:
    """The inputs of each axis.

    Parameters
    ----------
    eaches : mapping of str to Each
        The inputs that are mapped over, in the order of the ports.

    Returns
    -------
    dict of str to list of str
        In the order in which the axes appear first: that of the levels of the outputs.
    """
    axes: dict[str, list[str]] = {}
    for name, given in eaches.items():
        axes.setdefault(given.axis, []).append(name)
    return axes
