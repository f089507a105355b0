"""Graphs as nodes of other graphs: sliders are the inputs, chosen outputs the outputs."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import xxhash

from ..annotations import Value
from ..errors import GraphError
from ..node import Node
from ..ports import Port
from ..signatures import RESERVED_OUTPUTS
from .connections import check_name, only_output, present
from .specification import Specification
from .wires import Each, Param, Step, Wire, sources


@dataclass(frozen=True, eq=False)
class Inner:
    """The graph of a node.

    Attributes
    ----------
    specification : Specification
    outputs : mapping of str to Wire
        By name of the port.
    """

    specification: Specification
    outputs: Mapping[str, Wire]


Call = Callable[[Inner, Callable[..., Any], Mapping[str, Any]], Value]


def graph_node(
    specification: Specification,
    name: str | None,
    targets: Mapping[str, Step | Wire],
    call: Call,
) -> Node:
    """A graph as a node.

    Parameters
    ----------
    name : str, optional
        By default made of the title.
    targets : mapping of str to Step or Wire
        What each output is; if empty, the outputs of the steps that no other uses.
    call : callable
        Runs it for an item of a list.

    Raises
    ------
    GraphError
        If it has no output, or one that cannot be called so.
    """
    name = name or re.sub(r"\W+", "_", specification.title).strip("_") or "graph"
    check_name(name, "node")
    outputs = _outputs(specification, targets)
    for port in outputs:
        check_name(port, "output")
        if port in RESERVED_OUTPUTS or port.startswith("_"):
            raise GraphError(f"node {name}: an output cannot be called {port!r}")
    inner = Inner(specification, outputs)
    ports = {
        port: replace(wire.port, name=port, type=wire.type) for port, wire in outputs.items()
    }
    kinds = [port.type for port in ports.values()]
    title = specification.title or name
    fields = [(port, Any) for port in ports]
    kind: Any = NamedTuple(name, fields) if len(fields) > 1 else kinds[0]

    def _function(**inputs: Value) -> Value:
        return call(inner, kind, inputs)

    return Node(
        name=name,
        function=_function,
        version=_digest(specification, outputs),
        category="graphs",
        summary=title,
        help=specification.comments.get("", title),
        inputs={slider: _input(specification, slider) for slider in specification.params},
        outputs=ports,
        result_type=kind,
        inner=inner,
    )


def _outputs(
    specification: Specification, targets: Mapping[str, Step | Wire]
) -> dict[str, Wire]:
    if targets:
        found: dict[str, Wire] = {}
        for port, target in targets.items():
            now = present(specification.owner, specification.steps, target)
            found[port] = only_output(now) if isinstance(now, Step) else now
        return found
    used = {name for step in specification.steps.values() for name in step.parents}
    wires = [
        wire
        for name, step in specification.steps.items()
        if name not in used
        for wire in step.wires
    ]
    if not wires:
        raise GraphError("a graph without steps is no node")
    if len(wires) == 1:
        return {"result": wires[0]}
    short = [_short(wire) for wire in wires]
    return {
        text if short.count(text) == 1 else f"{wire.step.name}_{wire.port.name}": wire
        for text, wire in zip(short, wires, strict=True)
    }


def _short(wire: Wire) -> str:
    return wire.step.name if len(wire.step.wires) == 1 else wire.port.name


def _input(specification: Specification, slider: str) -> Port:
    """The port of a slider: what it feeds says what it takes."""
    port, value = specification.params[slider].port, specification.values[slider]
    for step in specification.steps.values():
        for name, given in step.inputs.items():
            if isinstance(given, Param) and given.name == slider:
                fed = step.node.inputs[name]
                limits = {
                    name: getattr(fed if getattr(port, name) in (None, ()) else port, name)
                    for name in ("min", "max", "choices")
                }
                return replace(fed, name=slider, default=value, **limits)
            if isinstance(given, Each) and any(
                isinstance(w, Param) and w.name == slider for w in sources(given)
            ):
                return replace(port, type=list[Any], default=value)
    return replace(port, default=value)


def _digest(specification: Specification, outputs: Mapping[str, Wire]) -> str:
    """A version of the node: another graph gives other results."""
    from .file import encode_graph

    text = encode_graph(specification) + repr([(n, str(w)) for n, w in outputs.items()])
    return xxhash.xxh3_64_hexdigest(text.encode(errors="surrogatepass"))
