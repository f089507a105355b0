"""Graph files read: what they say, checked, and the graph that it is."""

import importlib
import json
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any, cast

from ..annotations import Value
from ..errors import GraphError, nearest
from ..node import REGISTRY, Node, find_node
from ..ports import UNITS, Port, check_slider
from ..stores.results import own, snapshot
from .connections import check_name
from .edits import Inputs, with_draft, with_step
from .encoding import Names, decode, parse_json
from .file import FORMAT, OWN_ENTRIES, OWN_PARAM_ENTRIES, OWN_STEP_ENTRIES, VERSIONS
from .order import ordered
from .specification import Specification, frozen
from .subgraphs import Call, graph_node
from .wires import Each, Param, Step, Wire, output_wire

RENAMED_PORTS: dict[str, dict[str, str]] = {"cluster_radii": {"seed": ""}}
"""Present names of ports by node and by the name in older graph files; empty if it has gone."""


@dataclass(frozen=True)
class Reading:
    """How a graph file is read.

    Attributes
    ----------
    call : callable
        Runs inner graphs.
    unfinished : bool
        Whether steps that cannot be run are kept as they are, instead of an error.
    imports : bool
        Whether modules that the file names for its nodes are imported, which runs their code.
    contents : Path, optional
        Folder of contents that do not stand in the file.
    """

    call: Call
    unfinished: bool = False
    imports: bool = False
    contents: Path | None = None


def decode_graph(text: str) -> dict[str, Any]:
    """The content of a graph file, its form checked.

    Returns
    -------
    dict
        ``title``, ``units``, ``params`` and ``steps``, each step after those it needs.

    Raises
    ------
    GraphError
        If it is no graph file of a version that is read; the message says where.
    """
    content = parse_json(text)
    if not isinstance(content, dict) or cast("Any", content).get("format") != FORMAT:
        raise GraphError(f'not a graph file: "format" must be "{FORMAT}"')
    content = cast("dict[str, Any]", content)
    return _checked_content(content)


def _checked_content(content: dict[str, Any]) -> dict[str, Any]:
    version = content.get("version")
    if type(version) is not int or version not in VERSIONS:
        shown = repr(version)[:40]
        known = " and ".join(map(str, VERSIONS))
        raise GraphError(f'"version" is {shown}, this spheremesh reads {known}')
    content = {"groups": {}, "comments": {}, "contents": {}, **content}
    _entry(content, "title", str, "")
    _entry(content, "units", str, "")
    for name, facts in _entry(content, "params", dict, "").items():
        _checked(facts, dict, f"params.{name}")
        _refuse_misspelt(facts, OWN_PARAM_ENTRIES, f"params.{name}")
        if "value" not in facts:
            raise GraphError(f'params.{name}: "value" is missing')
        if not isinstance(facts.get("choices", []), list):
            raise GraphError(f'params.{name}: "choices" must be a list')
    for name, step in _entry(content, "steps", dict, "").items():
        where = f"steps.{name}"
        _checked(step, dict, where)
        _entry(step, "node", str, where)
        _entry(step, "version", str, where)
        _entry(step, "inputs", dict, where)
        if "graph" in step:
            step["graph"] = _inner_content(step, where)
    for name, members in _entry(content, "groups", dict, "").items():
        several = cast("list[Any]", members if isinstance(members, list) else [None])
        if not all(isinstance(member, str) for member in several):
            raise GraphError(f"groups.{name} must be a list of names of steps")
    for name, text in _entry(content, "comments", dict, "").items():
        _checked(text, str, f"comments.{name}")
    _entry(content, "contents", dict, "")
    content["steps"] = _in_order(content["steps"])
    return content


def _inner_content(step: dict[str, Any], where: str) -> dict[str, Any]:
    _entry(step, "outputs", dict, where)
    try:
        return _checked_content(_checked(step["graph"], dict, '"graph"'))
    except GraphError as error:
        raise GraphError(f"{where}.graph: {error}") from error


def _in_order(steps: dict[str, Any]) -> dict[str, Any]:
    """The order of the file, changed only where a step stands before one it needs."""
    needed = {
        name: {wire for value in step["inputs"].values() for wire in _wired(value)}
        for name, step in steps.items()
    }
    for name, others in needed.items():
        for other in others - steps.keys():
            raise GraphError(
                f"steps.{name}: wired to an unknown step {other!r}; {nearest(other, steps)}"
            )
    return {name: steps[name] for name in ordered(needed)}


def built(content: Mapping[str, Any], reading: Reading) -> Specification:
    """The graph of a graph file.

    Parameters
    ----------
    content : mapping
        From `decode_graph`.

    Raises
    ------
    GraphError
        If a slider or a step is not valid; the message names it.
    """
    if content["units"] not in UNITS:
        raise GraphError(f"units = {content['units']!r}: must be one of {', '.join(UNITS)}")
    extra = {name: x for name, x in content.items() if name not in OWN_ENTRIES}
    graph = Specification(content["title"], content["units"], extra=frozen(extra))
    stored = partial(_stored, content["contents"], reading.contents)
    params: dict[str, Param] = {}
    for name, facts in content["params"].items():
        try:
            params[name] = _slider(graph, name, facts, Names(_no_wire, _no_wire, stored))
        except (GraphError, TypeError) as error:
            raise GraphError(f"params.{name}: {error}") from error
    values = {name: param.value for name, param in params.items()}
    graph = _with(graph, params=frozen(params), values=frozen(values))
    for name, entry in content["steps"].items():
        try:
            graph = _with_entry(graph, name, entry, reading, stored)
        except GraphError as error:
            raise GraphError(f"steps.{name}: {error}") from error
    for name, members in content["groups"].items():
        for member in members:
            if member not in graph.steps:
                raise GraphError(f"groups.{name}: no step {member!r}")
    groups = {name: tuple(members) for name, members in content["groups"].items()}
    return _with(graph, groups=frozen(groups), comments=frozen(content["comments"]))


def _with(graph: Specification, **changes: Any) -> Specification:  # noqa: ANN401
    return replace(graph, **changes)


def _no_wire(name: str) -> Value:
    del name
    raise GraphError("a slider holds a value, no wire and no each(...)")


def _slider(graph: Specification, name: str, facts: Mapping[str, Any], names: Names) -> Param:
    own_facts = {key: value for key, value in facts.items() if key in OWN_PARAM_ENTRIES}
    extra = {key: value for key, value in facts.items() if key not in OWN_PARAM_ENTRIES}
    decoded = {key: decode(value, names) for key, value in own_facts.items()}
    check_name(name, "param")
    value = decoded.pop("value")
    if isinstance(value, Each):
        raise GraphError(f"param {name}: a slider holds a value, no wire and no each(...)")
    choices = tuple(decoded.pop("choices", ()))
    port = Port(name=name, choices=choices, **decoded)
    check_slider(value, port)
    return Param(graph.owner, name, own(value, snapshot), port, frozen(extra))


def _stored(inline: Mapping[str, Any], folder: Path | None, name: str) -> Value:
    """A content that stands in the file, or beside it."""
    if name in inline:
        return inline[name]
    path = Path() if folder is None else folder / f"{name}.json"
    if folder is None or not name.isalnum() or not path.is_file():
        raise GraphError(f"its content {name!r} is missing; it stands beside the graph file")
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise GraphError(f"cannot read its content {path}: {error}") from error


def _with_entry(
    graph: Specification,
    name: str,
    entry: Mapping[str, Any],
    reading: Reading,
    stored: Callable[[str], Value],
) -> Specification:
    """A graph with one more step of a file."""
    names = Names(partial(_wire, graph), partial(_known_slider, graph), stored)
    extra = {key: x for key, x in entry.items() if key not in OWN_STEP_ENTRIES}
    try:
        known = _node(entry, reading)
    except GraphError as error:
        if not reading.unfinished:
            raise
        inputs = {port: decode(value, names) for port, value in entry["inputs"].items()}
        said = {key: entry[key] for key in ("module", "graph", "outputs") if key in entry}
        return with_draft(
            graph, name, entry["node"], inputs, version=entry["version"],
            extra={**said, **extra}, fault=str(error),
        )  # fmt: skip
    inputs = _present_inputs(known, entry["inputs"])
    inputs = {port: decode(value, names) for port, value in inputs.items()}
    if known.inner is None and known.version != entry["version"]:
        warnings.warn(
            f"step {name!r} was saved with version {entry['version']} of node "
            f"{known.name}, this is {known.version}: results may differ",
            stacklevel=2,
        )
    if reading.unfinished:
        return with_draft(graph, name, known, inputs, version=known.version, extra=extra)
    return with_step(graph, name, known, inputs, extra)


def _node(entry: Mapping[str, Any], reading: Reading) -> Node:
    if "graph" in entry:
        inner = built(entry["graph"], reading)
        targets: dict[str, Step | Wire] = {
            port: _wire(inner, target) for port, target in entry["outputs"].items()
        }
        return graph_node(inner, entry["node"], targets, reading.call)
    module = entry.get("module", "")
    if module and entry["node"] not in REGISTRY:
        if reading.imports:
            try:
                importlib.import_module(_checked(module, str, '"module"'))
            except ImportError as error:
                raise GraphError(f"its module cannot be imported: {error}") from error
        try:
            return find_node(entry["node"])
        except GraphError as error:
            raise GraphError(
                f"{error}; it is defined in {module}: import that first"
            ) from error
    return find_node(entry["node"])


def _known_slider(graph: Specification, name: str) -> Param:
    if name not in graph.params:
        raise GraphError(f"no param {name!r}; {nearest(name, graph.params)}")
    return graph.params[name]


def _wire(graph: Specification, name: str) -> Step | Wire:
    """What a graph file names, by its present name."""
    step_name, dot, port = name.partition(".")
    if step_name not in graph.steps:
        raise GraphError(f"no step {step_name!r}; {nearest(step_name, graph.steps)}")
    step = graph.steps[step_name]
    return output_wire(step, _present(step.node, port, step.node.outputs)) if dot else step


def _present_inputs(node: Node, inputs: Inputs) -> dict[str, Value]:
    """Inputs by the present names of their ports."""
    present: dict[str, Value] = {}
    for old, value in inputs.items():
        port = _present(node, old, node.inputs)
        if not port:
            continue
        if port in present:
            raise GraphError(f"{port!r} is given twice, once as {old!r}")
        present[port] = value
    return present


def _present(node: Node, port: str, ports: Mapping[str, Port]) -> str:
    return port if port in ports else RENAMED_PORTS.get(node.name, {}).get(port, port)


def _wired(value: Value) -> list[str]:
    if isinstance(value, list):
        return [name for item in cast("list[Value]", value) for name in _wired(item)]
    if not isinstance(value, dict):
        return []
    tagged = cast("dict[str, Value]", value)
    wire = tagged.get("wire")
    return [wire.partition(".")[0]] if isinstance(wire, str) else _wired(tagged.get("each"))


def _entry(content: Mapping[str, Any], key: str, kind: type, where: str) -> Value:
    at = f"{where}: " if where else ""
    if key not in content:
        raise GraphError(f'{at}"{key}" is missing')
    return _checked(content[key], kind, f'{at}"{key}"')


def _checked(value: Value, kind: type, where: str) -> Value:
    if not isinstance(value, kind):
        name = {dict: "an object", str: "a text"}[kind]
        raise GraphError(f"{where} must be {name}, not {json.dumps(value)[:40]}")
    return value


def _refuse_misspelt(facts: Mapping[str, Any], known: Sequence[str], where: str) -> None:
    """Entries of others are kept; one that nearly has a name of ours was meant to be ours."""
    for key in facts:
        if key not in known and get_close_matches(key[:100], known, n=1, cutoff=0.7):
            raise GraphError(f"{where}: unknown entry {key!r}; {nearest(key, known)}")
