"""Inputs and outputs of a component, made of the ports of a node."""

import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from types import NoneType
from typing import Any, Final

import numpy as np

from ...kernel.reports import Report
from ...nodes.graphs.annotations import Member, Value, element_type, is_subclass, members
from ...nodes.graphs.node import Node
from ...nodes.graphs.ports import REQUIRED, Port
from ...nodes.graphs.specification.subgraphs import Inner
from .parameters import CODED, Carrier, ParamType, carriers, forms_of, is_file, is_path
from .values_out import AXES, POINTS, SHAPES, Encode, Shape, encoder

ANY_NUMBER: Final = 2**31 - 1


@dataclass(frozen=True)
class Input:
    """An input of a component.

    Attributes
    ----------
    name : str
    port : Port
        Of the node; it may have several inputs, of which one is given.
    carrier : Carrier
    at_least, at_most : int
        How many items Grasshopper asks for; 1 and 1 are an item, all else is a list.
    default : object
        What Grasshopper fills in; None if it does not.
    """

    name: str
    port: Port
    carrier: Carrier
    at_least: int
    at_most: int
    default: bool | int | float | str | None = None


@dataclass(frozen=True)
class Output:
    """An output of a component.

    Attributes
    ----------
    name : str
    param_type : str
    port : str
        Of the node.
    nesting : int
        How deeply its values stand in lists.
    is_list : bool
        Whether one value is a list of items.
    kinds : tuple of type
        Classes of the values that it shows, others leave it empty; none for all.
    encode : callable
    """

    name: str
    param_type: ParamType
    port: Port
    nesting: int
    is_list: bool
    kinds: tuple[type, ...]
    encode: Encode


@dataclass(frozen=True)
class Component:
    """A component.

    Attributes
    ----------
    name : str
        What stands in its address.
    node : Node
    inputs : tuple of Input
    outputs : tuple of Output
    fault : str
        Why it cannot be run; empty if it can.
    category : str
    shows_all : bool
        Whether it shows however much there is.
    """

    name: str
    node: Node
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    category: str
    fault: str = ""
    shows_all: bool = False

    @cached_property
    def reads_files(self) -> bool:
        """Whether it reads or writes files: the same request may give another answer."""
        has_paths = any(is_path(each.port, each.carrier.form) for each in self.inputs)
        return has_paths or any(bool(node.file_inputs) for node in _inner_nodes(self.node))


def writes_files(node: Node) -> bool:
    """Whether a node, or one within it, writes files."""
    return node.is_writer or any(each.is_writer for each in _inner_nodes(node))


def _inner_nodes(node: Node) -> Iterator[Node]:
    """The nodes of a node that is a graph."""
    if isinstance(node.inner, Inner):
        for step in node.inner.specification.steps.values():
            yield step.node
            yield from _inner_nodes(step.node)


def component_of(node: Node, *, with_files: bool, name: str = "") -> Component | None:
    """The component of a node.

    Parameters
    ----------
    with_files : bool
        Whether there is a folder for files.
    name : str
        By default that of the node.

    Returns
    -------
    Component or None
        None if it needs files and there is no folder for them.
    """
    try:
        inputs = tuple(_inputs(node, with_files=with_files))
    except _NeedsFilesError:
        return None
    outputs = tuple(_outputs(node))
    return Component(name or node.name, node, inputs, outputs, node.category)


def _inputs(node: Node, *, with_files: bool) -> Iterator[Input]:
    taken = set(node.inputs)
    for port in node.inputs.values():
        found = [each for each in carriers(port) if with_files or not is_path(port, each.form)]
        if not found and (port.default is REQUIRED or is_file(port)):
            raise _NeedsFilesError
        for i, carrier in enumerate(found):
            name = port.name if i == 0 else _other_name(port, carrier, taken)
            taken.add(name)
            yield _input(name, port, carrier, is_only=len(found) == 1)


class _NeedsFilesError(Exception):
    """A node that does nothing without files."""


def _other_name(port: Port, carrier: Carrier, taken: set[str]) -> str:
    """The name of an input that is another way to give a port its value."""
    kind = carrier.form.param_type.lower()
    if kind == "text":
        kind = "path" if is_path(port, carrier.form) else "handle"
    return kind if kind == "mesh" and kind not in taken else f"{port.name}_{kind}"


def _input(name: str, port: Port, carrier: Carrier, *, is_only: bool) -> Input:
    is_list = carrier.form.is_list
    most = ANY_NUMBER if is_list else 1
    default = _default(port)
    if is_only and port.default is REQUIRED:
        return Input(name, port, carrier, 1, most)
    if is_only and default is not None and not is_list:
        return Input(name, port, carrier, 1, 1, default)
    return Input(name, port, carrier, 0, most)


def _default(port: Port) -> bool | int | float | str | None:
    """A default that Grasshopper can fill in: it has neither None nor an empty text."""
    value: Value = port.default
    if port.graph_units or not isinstance(value, bool | int | float | str) or value == "":
        return None
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _outputs(node: Node) -> Iterator[Output]:
    by_port = {name: list(_port_outputs(node, port)) for name, port in node.outputs.items()}
    times = Counter(each.name for several in by_port.values() for each in several)
    for several in by_port.values():
        own = several[0].name
        for each in several:
            # Names of ports stand; what is shown besides gives way.
            is_free = times[each.name] == 1 or not each.kinds
            yield each if is_free else replace(each, name=f"{own}_{each.name}")


def _port_outputs(node: Node, port: Port) -> Iterator[Output]:
    kind, nesting = port.type, 0
    while (several := members(kind))[0].kind is list and len(several) == 1:
        kind, nesting = element_type(several[0].hint), nesting + 1
    options = [member for member in members(kind) if member.kind is not NoneType]
    form = CODED if len(options) > 1 else forms_of(options[0])[0]
    name = _port_name(node, port, options)
    yield Output(name, form.param_type, port, nesting, form.is_list, (), encoder(form))
    shown: dict[Shape, list[type]] = {}
    for shape, shown_kind in _shapes(options):
        shown.setdefault(shape, []).append(shown_kind)
    for shape, kinds in shown.items():
        yield shown_output(shape, port, nesting, tuple(kinds))


def shown_output(shape: Shape, port: Port, nesting: int, kinds: tuple[type, ...]) -> Output:
    """An output that shows values of some classes besides their handles."""
    is_list = True
    return Output(shape.name, shape.param_type, port, nesting, is_list, kinds, shape.encode)


def _shapes(options: list[Member]) -> Iterator[tuple[Shape, type]]:
    """What is shown besides the value itself."""
    for member in options:
        facts = member.facts
        if facts is not None and facts.holds.startswith("axes"):
            yield AXES, np.ndarray
        elif facts is not None and len(options) > 1 and facts.shape[-1] == 3:
            yield POINTS, np.ndarray
        for kind, shape in SHAPES.items():
            is_own = len(options) == 1 and forms_of(member)[0].param_type == shape.param_type
            if member.kind is kind and not is_own:
                yield shape, kind


def _port_name(node: Node, port: Port, options: list[Member]) -> str:
    """The name of an output; the only one of a node has that of what it is."""
    if port.name != "result":
        return port.name
    if len(options) > 1:
        return next(iter(node.inputs), "result")  # the same in another place
    kind, facts = options[0].kind, options[0].facts
    if facts is not None:
        return facts.holds.replace(",", " ").split()[0]
    if kind is str and writes_files(node):
        return "path"
    if is_subclass(kind, Report, undecided=False):
        return "report"
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", getattr(kind, "__name__", "result"))
    return _NAMES.get(kind) or words.lower()


_NAMES: Final[dict[Any, str]] = {
    float: "number", int: "number", bool: "answer", str: "text", list: "values", Any: "value",
}  # fmt: skip
