"""Edits of a graph: each gives another specification, and refuses what would not be one."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Final, cast

from ..annotations import Value
from ..errors import GraphError, nearest
from ..node import Node, find_node
from ..ports import Port
from .connections import check_name, connect_all, only_output, present
from .order import ordered
from .specification import Specification, frozen
from .wires import Each, Param, Step, Wire, output_wire

Inputs = Mapping[str, Any]

_GONE: Final = object()
"""In place of a wire whose step was removed."""


def _stand_in(node: Node | str, version: str, inputs: Inputs) -> Node:
    """In place of a node that is not known, or that does not take what it is given."""
    name = node if isinstance(node, str) else node.name

    def _none(**_: Value) -> Value:
        raise GraphError(f"node {name} is not known")

    ports = {port: Port(name=port) for port in inputs}
    meant = node if isinstance(node, Node) and node.is_known else getattr(node, "inner", None)
    return Node(name, _none, version, "", "", "", ports, {}, Any, inner=meant, is_known=False)


def _meant(node: Node | str) -> Node:
    """The node itself, or the one that a stand-in stands for."""
    if isinstance(node, Node):
        if node.is_known:
            return node
        if node.inner is not None:
            return node.inner
        node = node.name
    return find_node(node)


def with_step(
    before: Specification, name: str, node: Node, inputs: Inputs, extra: Inputs | None = None
) -> Specification:
    """Add a step, or put another node and other inputs in its place.

    Raises
    ------
    GraphError
        If something does not fit, here or in the steps that it feeds.
    """
    connected = connect_all(before.place(name), node, inputs)
    step = Step(before.owner, name, node, MappingProxyType(connected), "", _kept(extra))
    return _put(before, step)


def with_draft(
    before: Specification,
    name: str,
    node: str | Node,
    inputs: Inputs,
    *,
    version: str = "",
    extra: Inputs | None = None,
    fault: str = "",
) -> Specification:
    """Add a step that need not be finished: what is missing or wrong is said of it.

    Parameters
    ----------
    fault : str
        What is known to be wrong.
    """
    check_name(name, "step")
    if not fault:
        try:
            node = _meant(node)
            version = node.version
            return with_step(before, name, node, inputs, extra)
        except GraphError as error:
            fault = str(error)
    loose = {port: _loose(before, given) for port, given in inputs.items()}
    stand_in = _stand_in(node, version, loose)
    step = Step(before.owner, name, stand_in, MappingProxyType(loose), fault, _kept(extra))
    return _put(before, step)


def without_step(before: Specification, name: str, *, cut: bool = False) -> Specification:
    """Remove a step.

    Parameters
    ----------
    cut : bool
        Whether steps that it feeds lose these inputs; if not, they keep it from being removed.
    """
    _check_known(before, name)
    fed = [step.name for step in before.steps.values() if name in step.parents]
    if fed and not cut:
        raise GraphError(
            f"step {name!r} feeds {', '.join(fed[:6])}: rewire or remove these first, or cut"
        )
    entries = [(old, step) for old, step in before.steps.items() if old != name]
    after = replace(
        before,
        groups=frozen({g: tuple(x for x in s if x != name) for g, s in before.groups.items()}),
        comments=frozen({n: text for n, text in before.comments.items() if n != name}),
    )
    return _relinked(after, entries, {name})


def renamed_step(before: Specification, old: str, new: str) -> Specification:
    """Give a step another name, wherever it stands."""
    _check_known(before, old)
    check_name(new, "step")
    if new in before.steps:
        raise GraphError(f"there is a step {new!r} already")

    def _new(name: str) -> str:
        return new if name == old else name

    entries = [(n, replace(s, name=new) if n == old else s) for n, s in before.steps.items()]
    after = replace(
        before,
        groups=frozen({g: tuple(map(_new, s)) for g, s in before.groups.items()}),
        comments=frozen({_new(n): text for n, text in before.comments.items()}),
    )
    return _relinked(after, entries, {old})


def rewired(before: Specification, name: str, inputs: Inputs) -> Specification:
    """Give some inputs of a step something else; the others stay."""
    step = _check_known(before, name)
    given = {**step.inputs, **inputs}
    if step.node.is_known:
        return with_step(before, name, step.node, given, step.extra)
    return with_draft(
        before, name, step.node, given, version=step.node.version, extra=step.extra
    )


def unwired(before: Specification, name: str, port: str) -> Specification:
    """Take from an input what it was given; a step that needs it is unfinished then."""
    step = _check_known(before, name)
    if port not in step.inputs:
        raise GraphError(f"{name}.{port} is given nothing; {nearest(port, step.inputs)}")
    given = {n: x for n, x in step.inputs.items() if n != port}
    return with_draft(
        before, name, step.node, given, version=step.node.version, extra=step.extra
    )


def without_param(before: Specification, name: str) -> Specification:
    """Remove a slider; steps that it feeds keep its present value."""
    if name not in before.params:
        raise GraphError(f"no param {name!r}; {nearest(name, before.params)}")
    value = before.values[name]
    after = replace(
        before,
        params=frozen({n: p for n, p in before.params.items() if n != name}),
        values=frozen({n: x for n, x in before.values.items() if n != name}),
    )

    def _fixed(given: Value) -> Value:
        return value if isinstance(given, Param) and given.name == name else given

    return _with_inputs(after, _fixed)


def renamed_param(before: Specification, old: str, new: str) -> Specification:
    """Give a slider another name, wherever it is wired."""
    if old not in before.params:
        raise GraphError(f"no param {old!r}; {nearest(old, before.params)}")
    check_name(new, "param")
    if new in before.params:
        raise GraphError(f"there is a param {new!r} already")
    slider = before.params[old]
    slider = replace(slider, name=new, port=replace(slider.port, name=new))
    after = replace(
        before,
        params=frozen({
            (new if n == old else n): (slider if n == old else p)
            for n, p in before.params.items()
        }),
        values=frozen({new if n == old else n: x for n, x in before.values.items()}),
    )  # fmt: skip

    def _renamed(given: Value) -> Value:
        return slider if isinstance(given, Param) and given.name == old else given

    return _with_inputs(after, _renamed)


def grouped(before: Specification, group: str, steps: tuple[str, ...]) -> Specification:
    """Put steps into a group; a group of none is gone."""
    for name in steps:
        _check_known(before, name)
    others = {name: members for name, members in before.groups.items() if name != group}
    groups = {**others, group: steps} if steps else others
    return replace(before, groups=frozen(groups))


def commented(before: Specification, step: str, text: str) -> Specification:
    """Say something of a step, or of the whole graph by the empty name."""
    if step:
        _check_known(before, step)
    others = {name: said for name, said in before.comments.items() if name != step}
    return replace(before, comments=frozen({**others, step: text} if text else others))


def changed_inputs(given: Value, change: Callable[[Value], Value]) -> Value:
    """What an input was given, each wire and slider in it changed.

    Parameters
    ----------
    change : callable
        Given a `Wire` or `Param`; the result takes its place.
    """
    if isinstance(given, Wire | Param):
        return change(given)
    if isinstance(given, Each):
        items = changed_inputs(given.items, change)
        return given if items is given.items else replace(given, items=items)
    if type(given) in (list, tuple):
        items = [changed_inputs(item, change) for item in given]
        if any(a is not b for a, b in zip(items, given, strict=True)):
            return items
    return given


def _kept(extra: Inputs | None) -> Mapping[str, Any]:
    return frozen(extra or {})


def _check_known(before: Specification, name: str) -> Step:
    if name not in before.steps:
        raise GraphError(f"no step {name!r}; {nearest(name, before.steps)}")
    return before.steps[name]


def _loose(before: Specification, given: Value) -> Value:
    """What an input of an unfinished step is given, as it is."""
    if isinstance(given, Step):
        step = present(before.owner, before.steps, given)
        return only_output(step) if isinstance(step, Step) else step
    if isinstance(given, Each):
        return replace(given, items=_loose(before, given.items))
    if type(given) in (list, tuple):
        return [_loose(before, item) for item in given]
    return changed_inputs(
        given,
        lambda w: present(before.owner, before.steps, w) if isinstance(w, Wire) else w,
    )


def _put(before: Specification, step: Step) -> Specification:
    if step.name not in before.steps:
        # A new step stands last, and feeds nobody.
        steps = MappingProxyType({**before.steps, step.name: step})
        return replace(before, steps=steps)
    entries = [(n, step if n == step.name else s) for n, s in before.steps.items()]
    return _relinked(before, entries, {step.name})


def _with_inputs(before: Specification, change: Callable[[Value], Value]) -> Specification:
    entries: list[tuple[str, Step]] = []
    changed: set[str] = set()
    for name, step in before.steps.items():
        inputs = {p: changed_inputs(given, change) for p, given in step.inputs.items()}
        if any(inputs[port] is not given for port, given in step.inputs.items()):
            changed.add(name)
            step = replace(step, inputs=MappingProxyType(inputs))  # noqa: PLW2901
        entries.append((name, step))
    return _relinked(before, entries, changed)


def _relinked(
    before: Specification, entries: list[tuple[str, Step]], changed: set[str]
) -> Specification:
    """The steps in order, those after changed ones wired to what is there now.

    Parameters
    ----------
    entries : list of (str, Step)
        Steps by the names by which others are wired to them.
    changed : set of str
        Names of steps that others are to be wired to anew, or that have gone.
    """
    known = dict(entries)
    needed = {name: set(step.parents) & known.keys() for name, step in entries}
    done: dict[str, Step] = {}
    after = before
    for name in ordered(needed):
        step = known[name]
        if changed.isdisjoint(step.parents):
            done[name] = step
            continue
        changed = {*changed, name}
        steps = MappingProxyType({s.name: s for s in done.values()})
        after = replace(before, steps=steps)
        done[name] = _again(after, step, done)
    return replace(after, steps=MappingProxyType({s.name: s for s in done.values()}))


def _again(before: Specification, step: Step, done: Mapping[str, Step]) -> Step:
    """A step whose sources have changed, its wires checked again."""

    def _moved(given: Value) -> Value:
        if not isinstance(given, Wire):
            return given
        source = done.get(given.step.name)
        return _GONE if source is None else output_wire(source, given.port.name)

    inputs = {port: changed_inputs(given, _moved) for port, given in step.inputs.items()}
    left = {port: given for port, given in inputs.items() if not _has_gone(given)}
    if step.node.is_known and len(left) == len(inputs):
        return with_step(before, step.name, step.node, left, step.extra).steps[step.name]
    node = step.node
    after = with_draft(before, step.name, node, left, version=node.version, extra=step.extra)
    return after.steps[step.name]


def _has_gone(given: Value) -> bool:
    if isinstance(given, Each):
        return _has_gone(given.items)
    if isinstance(given, list):
        return any(map(_has_gone, cast("list[Any]", given)))
    return given is _GONE
