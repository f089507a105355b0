"""Signatures as ports: what annotations and docstrings say of inputs and outputs."""

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import UnionType
from typing import Annotated, Any, Final, Union, get_args, get_origin, get_type_hints

from .annotations import Hint, Value
from .errors import GraphError
from .ports import Port, check_value
from .stores.digests import digest

# A step has attributes of its own; its outputs are found beside them.
RESERVED_OUTPUTS: Final = (
    "graph", "inputs", "name", "node", "wires", "sources", "parents", "is_mapped", "nesting",
    "unfinished",
)  # fmt: skip


def input_ports(
    function: Callable[..., Any], hints: Mapping[str, Any], doc: str
) -> dict[str, Port]:
    """The inputs of a function, with what its docstring says of them.

    Raises
    ------
    GraphError
        If an argument can be no input.
    """
    texts = _entries(doc, "Parameters", "Other Parameters")
    ports: dict[str, Port] = {}
    for name, parameter in inspect.signature(function).parameters.items():
        where = f"{function.__name__}.{name}"
        if parameter.kind not in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            raise GraphError(f"{where}: an input must be a plain argument, not {parameter}")
        if name not in hints:
            raise GraphError(f"{where}: annotate the input with its type")
        kind, facts = split_hint(hints[name])
        port = replace(
            facts,
            name=name,
            type=kind,
            default=parameter.default,
            help=facts.help or texts.get(name, ""),
        )
        if parameter.default is not parameter.empty:
            check_value(port, parameter.default, f"default of {where}")
            _check_content(parameter.default, where)
        ports[name] = port
    return ports


def _check_content(default: Value, where: str) -> None:
    try:
        digest(default)
    except TypeError as error:
        raise GraphError(f"default of {where}: {error}") from error


def output_ports(node_name: str, result: Hint, doc: str) -> dict[str, Port]:
    """The outputs of a function: its result, or the fields of a named tuple.

    Raises
    ------
    GraphError
        If a field can be no output.
    """
    texts = _entries(doc, "Returns")
    kind, facts = split_hint(result)
    if not is_named_tuple(kind):
        text = next(iter(texts.values()), "")
        port = replace(facts, name=facts.name or "result", type=kind, help=facts.help or text)
        return {port.name: port}
    own = _entries(inspect.getdoc(kind) or "", "Parameters", "Attributes")
    ports: dict[str, Port] = {}
    for name, hint in get_type_hints(kind, include_extras=True).items():
        if name in RESERVED_OUTPUTS:
            raise GraphError(f"node {node_name}: an output cannot be called {name!r}")
        kind, facts = split_hint(hint)
        text = facts.help or texts.get(name) or own.get(name, "")
        ports[name] = replace(facts, name=name, type=kind, help=text)
    return ports


def split_hint(hint: Hint) -> tuple[Hint, Port]:
    """An annotation as its type and the facts of its port, also those of an alternative."""
    if get_origin(hint) is Annotated:
        kind, *facts = get_args(hint)
        others = [fact for fact in facts if not isinstance(fact, Port)]
        kind = Annotated[(kind, *others)] if others else kind
    else:
        kind = hint
        options = get_args(hint) if get_origin(hint) in (Union, UnionType) else ()
        facts = [fact for option in options for fact in get_args(option)[1:]]
    return kind, next((fact for fact in facts if isinstance(fact, Port)), Port())


def is_named_tuple(kind: Hint) -> bool:
    """Whether a result has fields, each an output."""
    return isinstance(kind, type) and hasattr(kind, "_fields") and issubclass(kind, tuple)


def _entries(doc: str, *titles: str) -> dict[str, str]:
    """Name and text of each entry in sections of a numpydoc docstring."""
    entries: dict[str, str] = {}
    names: list[str] = []
    inside = False
    lines = doc.splitlines()
    for line, below in zip(lines, [*lines, ""][1:], strict=True):
        if re.fullmatch("-{3,}", below):
            inside = line.strip() in titles
        elif not inside or not line.strip() or re.fullmatch("-{3,}", line):
            continue
        elif not line[0].isspace():
            names = [name.strip() for name in line.partition(" : ")[0].split(",")]
            entries.update(dict.fromkeys(names, ""))
        else:
            entries.update({name: f"{entries[name]} {line.strip()}".strip() for name in names})
    return entries
