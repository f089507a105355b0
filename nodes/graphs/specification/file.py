"""Graphs as JSON: versioned, in a stable order, and without code."""

import json
import os
import stat
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar, cast

from ....fabrication.files import replacing
from ..annotations import Value
from ..errors import GraphError
from .encoding import MOST_BYTES, Contents, encode
from .specification import Specification
from .subgraphs import Inner
from .wires import Param, Step

_Parsed = TypeVar("_Parsed")

FORMAT = "spheremesh graph"
VERSIONS = (1, 2)
"""Those that are read. A file is of the first one that can say all of it."""
OWN_ENTRIES = (
    "format", "version", "title", "units", "params", "steps", "groups", "comments", "contents",
)  # fmt: skip
OWN_PARAM_ENTRIES = ("value", "min", "max", "choices")
OWN_STEP_ENTRIES = ("node", "version", "module", "graph", "outputs", "inputs")
_LIBRARY = __name__.partition(".graphs.")[0] + ".library."
_LONGEST_MESSAGE = 400


def encode_graph(specification: Specification, contents: Contents | None = None) -> str:
    """The text of a graph file.

    Parameters
    ----------
    contents : dict, optional
        Where meshes and long arrays are put; by default they stand in the text.

    Returns
    -------
    str
        JSON, one entry a line.

    Raises
    ------
    GraphError
        If a value has no form in JSON; the message names the input.
    """
    content = content_of(specification, contents)
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def content_of(
    specification: Specification, contents: Contents | None = None
) -> dict[str, Any]:
    """What a graph file holds.

    Parameters
    ----------
    contents : dict, optional
        As for `encode_graph`.
    """
    apart: Contents = {} if contents is None else contents
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSIONS[0],
        "title": specification.title,
        "units": specification.units,
        "params": {
            name: _encode_param(param, specification.values[name], apart)
            for name, param in specification.params.items()
        },
        "steps": {name: _encode_step(s, apart) for name, s in specification.steps.items()},
    }
    if specification.groups:
        content["groups"] = {name: list(s) for name, s in specification.groups.items()}
    if specification.comments:
        content["comments"] = dict(specification.comments)
    if apart and contents is None:
        content["contents"] = dict(sorted(apart.items()))
    if apart or _is_of_second_version(content):
        content["version"] = VERSIONS[1]
    return {**content, **specification.extra}


def _is_of_second_version(content: Mapping[str, Any]) -> bool:
    """Whether it says what the first version could not."""
    steps = content["steps"].values()
    return (
        "groups" in content
        or "comments" in content
        or any("graph" in step for step in steps)
        or any(map(_has_rules, (step["inputs"] for step in steps)))
    )


def _has_rules(value: Value) -> bool:
    if isinstance(value, dict):
        tagged = cast("dict[str, Any]", value)
        is_each = "each" in tagged and len(tagged) > 1
        return is_each or any(map(_has_rules, tagged.values()))
    return isinstance(value, list) and any(map(_has_rules, cast("list[Any]", value)))


def _encode_param(param: Param, value: Value, contents: Contents) -> dict[str, Value]:
    port = param.port
    limits = {"min": port.min, "max": port.max, "choices": list(port.choices) or None}
    facts = {"value": value, **{k: v for k, v in limits.items() if v is not None}}
    where = f"params.{param.name}"
    own = {key: _encode_at(where, value, contents) for key, value in facts.items()}
    return {**own, **param.extra}


def _encode_step(step: Step, contents: Contents) -> dict[str, Value]:
    ports = step.node.inputs
    inputs = {
        port: _encode_at(f"{step.name}.{port}", step.inputs[port], contents)
        for port in (ports if step.node.is_known else step.inputs)
        if port in step.inputs
    }
    node = step.node
    entry: dict[str, Value] = {"node": node.name, "version": node.version}
    meant = node if node.is_known else node.inner
    inner = None if meant is None else meant.inner
    if isinstance(inner, Inner):
        entry["graph"] = content_of(inner.specification, contents)
        entry["outputs"] = {port: str(wire) for port, wire in inner.outputs.items()}
    elif meant is not None and _is_own(meant.function.__module__):
        entry["module"] = meant.function.__module__
    return {**entry, "inputs": inputs, **step.extra}


def _is_own(module: str) -> bool:
    """Whether it is a module of the user, which can be imported."""
    return not module.startswith(_LIBRARY) and module != "__main__"


def _encode_at(where: str, value: Value, contents: Contents) -> Value:
    try:
        return encode(value, contents)
    except GraphError as error:
        raise GraphError(f"{where}: {error}") from error


def write_graph(path: str | os.PathLike[str], specification: Specification) -> None:
    """Write a graph file, the whole or nothing, and its contents beside it by digest."""
    contents: Contents = {}
    text = encode_graph(specification, contents)
    folder = contents_folder(path)
    if contents:
        folder.mkdir(exist_ok=True)
    for name, packed in contents.items():
        target = folder / f"{name}.json"
        if not target.exists():
            with replacing(target) as temporary:
                temporary.write_text(json.dumps(packed), encoding="utf-8", newline="\n")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def contents_folder(path: str | os.PathLike[str]) -> Path:
    """Where the contents of a graph file stand."""
    return Path(path).with_suffix(".contents")


def read_graph(path: str | os.PathLike[str], parse: Callable[[str], _Parsed]) -> _Parsed:
    """Read a graph file; errors name it.

    Parameters
    ----------
    parse : callable
        Makes the graph of its text.

    Returns
    -------
    object
        What `parse` returns.

    Raises
    ------
    GraphError
        If it is no valid graph file.
    """
    name = os.fspath(path)
    try:
        return parse(_text(Path(path)))
    except UnicodeDecodeError as error:
        raise GraphError(f"{name}: not UTF-8 text: byte {error.start} is none of it") from error
    except (OSError, ValueError) as error:
        text = getattr(error, "strerror", None) or str(error)
        text = text if len(text) <= _LONGEST_MESSAGE else f"{text[:_LONGEST_MESSAGE]}..."
        raise GraphError(f"{name}: {text}") from error


def _text(path: Path) -> str:
    """Text of a regular file: pipes and devices may never end."""
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise GraphError("not a file: save the graph to one")
    with path.open("rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise GraphError(
            f"longer than {MOST_BYTES} bytes: let a node read what is large from a file "
            "of its own"
        )
    return data.decode("utf-8")
