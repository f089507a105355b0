"""A node's version says when its results changed: none is edited without a thought of it.

The table beside has the version and the source of each node as they were last agreed on. Only
the function itself counts: signature and body, without docstring, comments and layout.
"""

import ast
import hashlib
import inspect
import json
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from spheremesh import nodes
from spheremesh.nodes import Node, find_node, node

TABLE = Path(__file__).parent / "node_versions.json"
COMMAND = ".venv/bin/python tests/nodes/test_node_versions.py"

Table = Mapping[str, list[str]]


def library_table() -> dict[str, list[str]]:
    """Version and digest of the source of every node of the library."""
    names = sorted(set(dir(nodes)) - set(nodes._FRAMEWORK))
    return {name: entry_of(find_node(name)) for name in names}


def entry_of(node: Node) -> list[str]:
    source = textwrap.dedent(inspect.getsource(node.function))
    return [node.version, source_digest(source)]


def source_digest(source: str) -> str:
    function = ast.parse(source).body[0]
    assert isinstance(function, ast.FunctionDef)
    function.decorator_list = []
    if ast.get_docstring(function) is not None:
        del function.body[0]
    return hashlib.sha256(repr(shape(function)).encode()).hexdigest()[:16]


def shape(part: Any) -> Any:  # noqa: ANN401
    """A syntax tree as lists: what is empty is left out, as versions of Python differ there."""
    if isinstance(part, ast.AST):
        fields = ((name, value) for name, value in ast.iter_fields(part))
        filled = [[n, shape(v)] for n, v in fields if v is not None and v != []]
        return [type(part).__name__, *filled]
    return [shape(each) for each in part] if isinstance(part, list) else repr(part)


def faults(agreed: Table, present: Table) -> Iterator[str]:
    """What is to be done, a sentence for each node."""
    for name in sorted({*agreed, *present}):
        if name not in present:
            yield f"the node {name} has gone: refresh the table with {COMMAND}"
        elif name not in agreed:
            yield f"the node {name} is new: put it into the table with {COMMAND}"
        elif agreed[name][0] != present[name][0]:
            yield f"{name} has another version now: refresh the table with {COMMAND}"
        elif agreed[name][1] != present[name][1]:
            yield (
                f"the source of {name} has changed: raise its version, @node(version=...), "
                "if the same inputs may give another result; then, or if they do not, "
                f"refresh the table with {COMMAND}"
            )


def test_versions_were_thought_of() -> None:
    agreed = json.loads(TABLE.read_text(encoding="utf-8"))
    found = list(faults(agreed, library_table()))
    assert not found, "\n".join(found)


def test_what_counts_as_a_change() -> None:
    def entry(source: str) -> str:
        return source_digest(textwrap.dedent(source))

    before = entry('''
        @node
        def f(a: float, b: float = 1.0) -> float:
            """Sum."""
            return a + b
    ''')
    assert before == entry('''
        @node(version="2")
        def f(a: float,
              b: float = 1.0) -> float:
            """The sum of two numbers."""
            return (a + b)  # no change
    ''')
    for body in ("a: float, b: float = 2.0) -> float:\n return a + b",
                 "a: float, b: int = 1.0) -> float:\n return a + b",
                 "a: float, b: float = 1.0) -> float:\n return a - b"):  # fmt: skip
        assert entry(f"def f({body}") != before


@pytest.mark.parametrize(
    ("agreed", "said"),
    [
        ({}, "is new"),
        ({"f": ["1", "x"]}, "the source of f has changed: raise its version"),
        ({"f": ["2", "y"]}, "another version"),
        ({"f": ["1", "y"], "g": ["1", "z"]}, "g has gone"),
        ({"f": ["1", "y"]}, None),
    ],
)
def test_it_is_said_what_to_do(agreed: Table, said: str | None) -> None:
    found = list(faults(agreed, {"f": ["1", "y"]}))
    assert len(found) == (said is not None)
    assert said is None or said in found[0]


def test_a_node_is_known_by_its_source() -> None:
    @node(version="3")
    def a_node_of_this_test(a: float) -> float:
        """The same number."""
        return a

    known = entry_of(find_node(a_node_of_this_test))
    assert known == ["3", source_digest("def a_node_of_this_test(a: float) -> float: return a")]


def refresh() -> None:
    """Write the table as the nodes are now."""
    rows = (f"{json.dumps(n)}: {json.dumps(entry)}" for n, entry in library_table().items())
    text = "{\n" + ",\n".join(rows) + "\n}\n"
    TABLE.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    refresh()
