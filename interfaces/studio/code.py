"""A graph as Python code that makes it again."""

import keyword
from collections.abc import Mapping
from typing import Any, Final, cast

import numpy as np

from ...nodes.graphs.annotations import Value
from ...nodes.graphs.specification.specification import Specification
from ...nodes.graphs.specification.wires import Each, Param, Step, Wire

_TAKEN: Final = frozenset({"sm", "nodes", "np", "graph", *keyword.kwlist, *keyword.softkwlist})
_LONGEST: Final = 88
_MOST_NUMBERS: Final = 1000


def python_code(graph: Specification) -> str:
    """The code of a graph, to be run with spheremesh installed.

    Steps that are not finished, or that hold what has no code, stand as remarks.
    """
    names = _variables(graph)
    lines = [
        '"""' + (graph.title or "A graph").replace('"', "'").replace("\\", "/") + '."""', "",
    ]  # fmt: skip
    body = _sliders(graph, names)
    gone = set[str]()
    for name, step in graph.steps.items():
        text = "" if gone & set(step.parents) or step.unfinished else _step(step, names)
        if not text:
            gone.add(name)
            why = step.unfinished or "it holds what has no code, or needs a step that has none"
            body.append(f"# {name} ({step.node.name}): {' '.join(why.split())}")
        else:
            body.append(text)
    for name, members in graph.groups.items():
        present = [names["step", each] for each in members if each not in gone]
        body.append(_call("graph.group", [repr(name), *present]))
    for name, text in graph.comments.items():
        target = [names["step", name]] if name and name not in gone else []
        body.append(_call("graph.comment", [repr(text), *target]))
    ends = [name for name in _ends(graph) if name not in gone]
    if ends:
        body += ["", 'if __name__ == "__main__":']
        body.append("    " + _call("graph.run", [names["step", each] for each in ends], 4))
    imports = ["import numpy as np", ""] if any("np.array(" in line for line in body) else []
    made = f"graph = sm.Graph({graph.title!r}, units={graph.units!r})"
    start = [*imports, "import spheremesh as sm", "from spheremesh import nodes", "", made]
    return "\n".join([*lines, *start, *body]) + "\n"


def _variables(graph: Specification) -> dict[tuple[str, str], str]:
    """A variable for each slider and step."""
    found: dict[tuple[str, str], str] = {}
    used = set(_TAKEN)
    for kind, several in (("step", graph.steps), ("param", graph.params)):
        for name in several:
            variable = name
            while variable in used:
                variable += "_" if variable in _TAKEN else f"_{kind}"
            used.add(variable)
            found[kind, name] = variable
    return found


def _sliders(graph: Specification, names: Mapping[tuple[str, str], str]) -> list[str]:
    lines: list[str] = []
    for name, param in graph.params.items():
        port = param.port
        limits = {"min": port.min, "max": port.max, "choices": port.choices or None}
        given = [f"{key}={limit!r}" for key, limit in limits.items() if limit is not None]
        value = _value(graph.values[name], names)
        lines.append(
            f"{names['param', name]} = "
            + _call("graph.param", [repr(name), value or "None", *given])
        )
    return lines


def _step(step: Step, names: Mapping[tuple[str, str], str]) -> str:
    if step.node.inner is not None or not step.node.is_known:
        return ""
    own = f"nodes.{step.node.name}"
    if ".library." not in step.node.function.__module__:
        own = repr(step.node.name)
    texts = {port: _value(given, names) for port, given in step.inputs.items()}
    if not all(texts.values()):
        return ""
    given = [f"{port}={text}" for port, text in texts.items()]
    return f"{names['step', step.name]} = " + _call("graph.add", [own, repr(step.name), *given])


def _value(value: Value, names: Mapping[tuple[str, str], str]) -> str:
    """A value as code; empty for what has none."""
    if isinstance(value, Wire | Param):
        return _source(value, names)
    if isinstance(value, Each):
        rules = {"match": value.match, "axis": value.axis}
        items = [_value(value.items, names), *(f"{k}={x!r}" for k, x in rules.items() if x)]
        return f"sm.each({', '.join(items)})" if items[0] else ""
    if isinstance(value, list | tuple):
        several = [_value(item, names) for item in cast("list[Value]", value)]
        return f"[{', '.join(several)}]" if all(several) else ""
    return _literal(value)


def _source(value: Wire | Param, names: Mapping[tuple[str, str], str]) -> str:
    if isinstance(value, Param):
        return names["param", value.name]
    step = names["step", value.step.name]
    return step if len(value.step.wires) == 1 else f"{step}.{value.port.name}"


def _literal(value: Value) -> str:
    if isinstance(value, np.ndarray):
        array = cast("np.ndarray[Any, Any]", value)
        short = array.size <= _MOST_NUMBERS and bool(np.isfinite(array).all())
        return f"np.array({array.tolist()!r}, {array.dtype.name!r})" if short else ""
    if isinstance(value, float) and not np.isfinite(value):
        return f'float("{value}")'
    is_plain = value is None or isinstance(value, bool | int | float | str | dict)
    return repr(cast("object", value)) if is_plain else ""


def _call(function: str, arguments: list[str], indent: int = 0) -> str:
    """A call on one line, or with a line for each argument."""
    line = f"{function}({', '.join(arguments)})"
    if len(line) + indent <= _LONGEST:
        return line
    space = " " * indent
    return (
        f"{function}(\n" + "".join(f"{space}    {each},\n" for each in arguments) + f"{space})"
    )


def _ends(graph: Specification) -> list[str]:
    used = {name for step in graph.steps.values() for name in step.parents}
    return [name for name in graph.steps if name not in used]
