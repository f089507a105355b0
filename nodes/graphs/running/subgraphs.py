"""Graphs within graphs: their steps run among those of the graph around them."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from ..annotations import Value
from ..errors import GraphError
from ..specification.edits import changed_inputs
from ..specification.subgraphs import Inner
from ..specification.wires import Param, Step, Wire, output_wire
from ..stores.memory import MemoryStore
from .events import Watch
from .run import Aliases, Run, output, run_steps, running

Steps = Mapping[str, Step]


def expanded(steps: Steps) -> tuple[Steps, Aliases]:
    """Steps with those of inner graphs in the places of their nodes.

    Parameters
    ----------
    steps : mapping of str to Step

    Returns
    -------
    steps : mapping of str to Step
        An inner step is called ``"outer/inner"``. Graphs that are mapped over lists stay.
    aliases : dict of str to mapping of str to Wire
        What the outputs of a step that has gone are now, by its name and port.
    """
    if all(step.node.inner is None for step in steps.values()):
        return steps, {}
    found: dict[str, Step] = {}
    aliases: dict[str, Mapping[str, Wire]] = {}
    for step in steps.values():
        _expand(_moved(step, found, aliases), found, aliases)
    return found, aliases


def _moved(step: Step, found: Steps, aliases: Aliases) -> Step:
    """A step wired to what is there now."""

    def _now(given: Value) -> Value:
        if not isinstance(given, Wire):
            return given
        name, port = given.step.name, given.port.name
        return aliases[name][port] if name in aliases else output_wire(found[name], port)

    inputs = {port: changed_inputs(given, _now) for port, given in step.inputs.items()}
    return replace(step, inputs=MappingProxyType(inputs))


def _expand(step: Step, found: dict[str, Step], aliases: dict[str, Mapping[str, Wire]]) -> None:
    inner: Any = step.node.inner
    if not isinstance(inner, Inner) or not step.node.is_known or step.is_mapped:
        if isinstance(inner, Inner):
            _refuse_files(step, inner)
        found[step.name] = step
        return
    now = inner.specification
    values = {**now.values, **step.inputs}
    own_found: dict[str, Step] = {}
    own_aliases: dict[str, Mapping[str, Wire]] = {}
    for each in now.steps.values():
        moved = _moved(each, own_found, own_aliases)
        inputs = {
            port: changed_inputs(given, lambda w: values[w.name] if isinstance(w, Param) else w)
            for port, given in moved.inputs.items()
        }
        for port in moved.node.inputs.values():
            if port.graph_units:
                inputs.setdefault(port.name, now.units)
        placed = replace(
            moved, name=f"{step.name}/{each.name}", inputs=MappingProxyType(inputs)
        )
        _expand(placed, found, aliases)
        if placed.name in found:
            own_found[each.name] = found[placed.name]
        else:
            own_aliases[each.name] = aliases[placed.name]
    aliases[step.name] = {
        port: own_aliases[wire.step.name][wire.port.name]
        if wire.step.name in own_aliases
        else output_wire(own_found[wire.step.name], wire.port.name)
        for port, wire in inner.outputs.items()
    }


def _refuse_files(step: Step, inner: Inner) -> None:
    """The state of files within is not part of the key of the whole."""
    with_files = [s.name for s in inner.specification.steps.values() if s.node.file_inputs]
    if with_files:
        raise GraphError(
            f"step {step.name!r} maps a graph whose step {with_files[0]!r} reads or writes "
            "files; map such steps outside of it"
        )


def run_inner(inner: Inner, kind: Callable[..., Any], inputs: Mapping[str, Any]) -> Value:
    """Run an inner graph on its own, for an item of a list.

    Parameters
    ----------
    kind : callable
        Makes the result of several outputs.
    inputs : mapping of str to object
        Values of its sliders.

    Returns
    -------
    object
        Its output, or a tuple of them.
    """
    now = inner.specification
    steps, aliases = expanded(now.steps)
    around = running()
    store = MemoryStore() if around is None else around.store
    watch = Watch() if around is None else Watch(cancel=around.watch.cancel)
    run = Run(steps, {**now.values, **inputs}, now.units, store, watch, aliases=aliases)
    targets = list(inner.outputs.values())
    run_steps(run, targets)
    values = [output(run, target) for target in targets]
    return values[0] if len(values) == 1 else kind(*values)
