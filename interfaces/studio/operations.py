"""Edits as the page sends them: JSON in, another graph out, or one sentence why not."""

import json
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeAlias, cast

from ...nodes.graphs.annotations import Value
from ...nodes.graphs.editor import Editor
from ...nodes.graphs.errors import GraphError, nearest
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.node import REGISTRY, Node, find_node
from ...nodes.graphs.ports import Port, check_slider
from ...nodes.graphs.specification.connections import check_name, connect
from ...nodes.graphs.specification.encoding import Contents, Names, decode
from ...nodes.graphs.specification.file import content_of
from ...nodes.graphs.specification.specification import Specification, frozen
from ...nodes.graphs.specification.wires import Step, output_wire

Operation: TypeAlias = Mapping[str, Any]

CANVAS: Final = "canvas"
"""The entry of a graph file that says how it lies on the canvas."""
MOST_OPERATIONS: Final = 2000


@dataclass
class Draft:
    """A graph while operations change it.

    Attributes
    ----------
    editor : Editor
    canvas : dict
        Places of steps and sliders by name, and what is pinned.
    contents : dict
        Meshes and long arrays by digest, which stand apart from what the page knows.
    """

    editor: Editor
    canvas: dict[str, Any]
    contents: Contents = field(default_factory=dict[str, Any])

    @property
    def now(self) -> Specification:
        """The graph as it is."""
        return self.editor.specification

    def names(self) -> Names:
        """What gives wires and sliders by name."""
        return Names(self._wire, self.editor.slider, self._content)

    def _wire(self, name: str) -> Value:
        step, _, port = str(name).partition(".")
        found = self.editor.wire(step)
        return output_wire(cast("Step", found), port) if port else found

    def _content(self, name: str) -> Value:
        if name not in self.contents:
            raise GraphError(f"its content {str(name)[:40]!r} is not in this graph")
        return self.contents[name]


def applied(
    before: Specification, operations: Sequence[Operation], contents: Contents
) -> Specification:
    """Another graph, changed by all of the operations or by none.

    Raises GraphError if one of them cannot be done; the message says why.
    """
    if len(operations) > MOST_OPERATIONS:
        raise GraphError(f"more than {MOST_OPERATIONS} operations at once")
    draft = Draft(Editor(before), _copied(before.extra.get(CANVAS)), contents)
    for operation in operations:
        kind = operation.get("op")
        if kind not in _OPERATIONS:
            raise GraphError(
                f"no operation {str(kind)[:40]!r}; {nearest(str(kind), _OPERATIONS)}"
            )
        try:
            _OPERATIONS[kind](draft, operation)
        except GraphError:
            raise
        except (LookupError, TypeError, ValueError, AttributeError) as error:
            raise GraphError(f"operation {kind!r} misses or mistakes {error}") from error
    if draft.canvas == _copied(before.extra.get(CANVAS)):
        return draft.now
    others = {name: x for name, x in draft.now.extra.items() if name != CANVAS}
    kept = {name: x for name, x in draft.canvas.items() if x}
    return replace(draft.now, extra=frozen({**others, CANVAS: kept} if kept else others))


def _copied(canvas: object) -> dict[str, Any]:
    """The entry of a file, as far as it is one of ours."""
    found = cast("dict[str, Any]", canvas) if isinstance(canvas, dict) else {}
    return {**found, **{kind: _places(found.get(kind)) for kind in ("steps", "params")}}


def _places(places: object) -> dict[str, Any]:
    return dict(cast("dict[str, Any]", places)) if isinstance(places, dict) else {}


def real_node(step: Step) -> Node | None:
    """The node that a step stands for, finished or not; None if it is not known."""
    if step.node.is_known:
        return step.node
    return (
        step.node.inner if isinstance(step.node.inner, Node) else REGISTRY.get(step.node.name)
    )


def _add(draft: Draft, operation: Operation) -> None:
    node = find_node(str(operation["node"]))
    name = str(operation.get("name") or "") or free_name(draft.now.steps, node.name)
    if name in draft.now.steps:
        raise GraphError(f"there is a step {name!r} already")
    draft.editor.draft(node.name, name)
    for port, value in dict(operation.get("inputs", {})).items():
        _give(draft, {"step": name, "port": port, "value": value})
    _place(draft, "steps", name, operation.get("at"))


def free_name(taken: Mapping[str, Any], name: str) -> str:
    """A name that nothing has: the name itself, or the same with a number."""
    base, number = name, 2
    while name in taken:
        name, number = f"{base}_{number}", number + 1
    return name


def _place(draft: Draft, kind: str, name: str, at: Any) -> None:  # noqa: ANN401
    if at is not None:
        x, y = at
        draft.canvas[kind][name] = [round(float(x)), round(float(y))]


def _remove(draft: Draft, operation: Operation) -> None:
    for name in operation.get("params", ()):
        draft.editor.remove(draft.editor.slider(name))
        draft.canvas["params"].pop(name, None)
    for name in operation.get("steps", ()):
        draft.editor.remove(str(name), cut=True)
        draft.canvas["steps"].pop(name, None)
    if "pins" in draft.canvas:
        known = draft.now.steps
        draft.canvas["pins"] = [p for p in draft.canvas["pins"] if p.partition(".")[0] in known]
    empty = [name for name, members in draft.now.groups.items() if not members]
    for name in empty:
        draft.editor.group(name)


def _give(draft: Draft, operation: Operation) -> None:
    """Wire an input, or give it a value."""
    name, port = str(operation["step"]), str(operation["port"])
    step = cast("Step", draft.editor.wire(name))
    given = decode(operation["value"], draft.names())
    node = real_node(step)
    if node is not None:
        # An unfinished step takes anything; what does not fit is refused all the same.
        if port not in node.inputs:
            raise GraphError(f"{name} has no input {port!r}; {nearest(port, node.inputs)}")
        given = connect(draft.now.place(name), node.inputs[port], given)
    draft.editor.rewire(name, **{port: given})


def _take(draft: Draft, operation: Operation) -> None:
    draft.editor.unwire(str(operation["step"]), str(operation["port"]))


def _set(draft: Draft, operation: Operation) -> None:
    draft.editor.set(**{operation["param"]: decode(operation["value"], draft.names())})


def _slider(draft: Draft, operation: Operation) -> None:
    """Add a slider, or change its range; it may take the place of what inputs were given."""
    name, limits = str(operation["name"]), dict(operation.get("limits", {}))
    value = decode(operation["value"], draft.names())
    known = draft.now.params.get(name)
    if known is None:
        draft.editor.param(name, value, **_limits(limits))
    else:
        _change_slider(draft, name, value, limits)
    for step, port in operation.get("feeds", ()):
        _give(draft, {"step": step, "port": port, "value": {"param": name}})
    _place(draft, "params", name, operation.get("at"))


def _limits(limits: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: limits[key] for key in ("min", "max", "choices") if limits.get(key) is not None
    }


def _change_slider(draft: Draft, name: str, value: Value, limits: Mapping[str, Any]) -> None:
    now = draft.now
    port = Port(name=name, **_limits(limits))
    check_slider(value, port)
    slider = replace(now.params[name], port=port)
    draft.editor = Editor(replace(now, params=frozen({**now.params, name: slider})))
    draft.editor.set(**{name: value})


def _rename(draft: Draft, operation: Operation) -> None:
    old, new, kind = str(operation["old"]), str(operation["new"]), str(operation["kind"])
    target = draft.editor.slider(old) if kind == "params" else old
    draft.editor.rename(target, new)
    places = draft.canvas[kind]
    draft.canvas[kind] = {new if name == old else name: at for name, at in places.items()}
    if kind == "steps" and "pins" in draft.canvas:
        draft.canvas["pins"] = [
            new + pin.removeprefix(old) if pin.partition(".")[0] == old else pin
            for pin in draft.canvas["pins"]
        ]


def _move(draft: Draft, operation: Operation) -> None:
    for kind, known in (("steps", draft.now.steps), ("params", draft.now.params)):
        for name, at in dict(operation.get(kind, {})).items():
            if name not in known:
                raise GraphError(f"there is no {name!r} to be moved")
            _place(draft, kind, name, at)


def _group(draft: Draft, operation: Operation) -> None:
    """Put steps into a group; they leave those that they were in."""
    name, steps = str(operation["name"]).strip(), [str(each) for each in operation["steps"]]
    if not name:
        raise GraphError("a group needs a name")
    for other, members in list(draft.now.groups.items()):
        if other != name and not set(members).isdisjoint(steps):
            draft.editor.group(other, *(each for each in members if each not in steps))
    draft.editor.group(name, *steps)


def _comment(draft: Draft, operation: Operation) -> None:
    draft.editor.comment(str(operation["text"]), str(operation.get("step", "")))


def _title(draft: Draft, operation: Operation) -> None:
    draft.editor.title = str(operation["text"])


def _units(draft: Draft, operation: Operation) -> None:
    draft.editor.units = str(operation["units"])


def _pin(draft: Draft, operation: Operation) -> None:
    draft.canvas["pins"] = list(map(str, operation["outputs"]))


def _paste(draft: Draft, operation: Operation) -> None:
    """Steps and sliders of a graph file, under names that are free."""
    fragment = cast("Mapping[str, Any]", operation["graph"])
    steps, params = dict(fragment.get("steps", {})), dict(fragment.get("params", {}))
    content = content_of(draft.now, draft.contents)
    step_names = _new_names(steps, content["steps"], "step")
    slider_names = _new_names(params, content["params"], "param")
    known = {"step": content["steps"], "param": content["params"]}
    names = {"step": step_names, "param": slider_names}
    for old, entry in params.items():
        content["params"][slider_names[old]] = entry
    for old, entry in steps.items():
        inputs = {p: _renamed(x, names, known) for p, x in dict(entry["inputs"]).items()}
        inputs = {port: x for port, x in inputs.items() if x is not _NOTHING}
        content["steps"][step_names[old]] = {**entry, "inputs": inputs}
    content["contents"] = draft.contents
    content["version"] = 2
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps of other versions
        made = Graph.from_json(json.dumps(content), unfinished=True)
    draft.editor = Editor(made.specification)
    dx, dy = operation.get("by", (0, 0))
    places = cast("Mapping[str, Any]", fragment.get(CANVAS, {}))
    for kind, renamed in (("steps", step_names), ("params", slider_names)):
        for old, (x, y) in dict(places.get(kind, {})).items():
            if old in renamed:
                _place(draft, kind, renamed[old], (x + dx, y + dy))


_NOTHING: Final = object()
"""In place of a wire that leads nowhere."""


def _new_names(
    entries: Mapping[str, Any], taken: Mapping[str, Any], what: str
) -> dict[str, str]:
    found: dict[str, str] = {}
    used = dict(taken)
    for old in entries:
        check_name(old, what)
        found[old] = free_name(used, old)
        used[found[old]] = None
    return found


def _renamed(
    value: Value, names: Mapping[str, Mapping[str, str]], known: Mapping[str, Mapping[str, Any]]
) -> Value:
    """What an input was given, by the new names of steps and sliders."""
    if isinstance(value, list):
        items = [_renamed(item, names, known) for item in cast("list[Value]", value)]
        return [item for item in items if item is not _NOTHING]
    if not isinstance(value, dict):
        return value
    tagged = dict(cast("dict[str, Value]", value))
    if "each" in tagged:
        tagged["each"] = _renamed(tagged["each"], names, known)
        return _NOTHING if tagged["each"] is _NOTHING else tagged
    for tag, kind in (("wire", "step"), ("param", "param")):
        if tag in tagged:
            name, dot, port = str(tagged[tag]).partition(".")
            is_there = name in names[kind] or name in known[kind]
            return {tag: f"{names[kind].get(name, name)}{dot}{port}"} if is_there else _NOTHING
    return tagged


_OPERATIONS: Final[dict[str, Callable[[Draft, Operation], None]]] = {
    "add": _add,
    "comment": _comment,
    "give": _give,
    "group": _group,
    "move": _move,
    "paste": _paste,
    "pin": _pin,
    "remove": _remove,
    "rename": _rename,
    "set": _set,
    "slider": _slider,
    "take": _take,
    "title": _title,
    "units": _units,
}
