"""The reference of all nodes, written from the nodes themselves: a page for each chapter.

What is said of a port is what ``spheremesh nodes NAME`` says of it.
"""

import inspect
import re
from collections.abc import Iterable, Mapping

from spheremesh.interfaces.node_help import port_facts, report_fields
from spheremesh.nodes import Node, Port, library
from spheremesh.nodes.graphs.node import REGISTRY, load_library

SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\n", re.MULTILINE)
CODE = re.compile(r"(`+)(.+?)\1", re.DOTALL)


def library_nodes() -> dict[str, list[Node]]:
    """The nodes of the library by chapter, both in alphabetical order."""
    load_library()
    chapters: dict[str, list[Node]] = {}
    for node in sorted(REGISTRY.values(), key=lambda node: (node.category, node.name)):
        if node.function.__module__.startswith(f"{library.__name__}."):
            chapters.setdefault(node.category, []).append(node)
    return chapters


def reference_pages(pictures: Mapping[str, str] = {}) -> dict[str, str]:
    """The pages by name, in Markdown.

    Parameters
    ----------
    pictures : mapping of str to str
        By node: where its picture is, as seen from the pages.
    """
    chapters = library_nodes()
    about = dict(re.findall(r"^(\w+)  +(\S.*)$", inspect.getdoc(library) or "", re.MULTILINE))
    homes = {node.name: chapter for chapter, nodes in chapters.items() for node in nodes}
    front = [
        "# The nodes",
        f"All {len(homes)} nodes by chapters. Each is a plain function of `spheremesh.nodes`, "
        "and a step of a graph (`g.add`). `spheremesh nodes NAME` tells the same on the "
        "command line.",
    ]
    pages: dict[str, str] = {}
    for chapter, nodes in chapters.items():
        rows = [f"| [`{n.name}`]({chapter}.md#{n.name}) | {_text(n.summary)} |" for n in nodes]
        table = "\n".join(["| node | |", "|---|---|", *rows])
        front += [f"## {chapter.capitalize()}", _text(about[chapter]), table]
        parts = [f"# {chapter.capitalize()}", _text(about[chapter])]
        for node in nodes:
            parts += _described(node, homes, pictures.get(node.name))
        pages[chapter] = "\n\n".join(parts) + "\n"
    pages["index"] = "\n\n".join(front) + "\n"
    return pages


def _described(node: Node, homes: Mapping[str, str], picture: str | None) -> Iterable[str]:
    """Paragraphs on a node."""
    opening, sections = sections_of(node.help)
    yield f"## {node.name}"
    yield _text(opening, homes)
    yield "**Inputs**"
    yield "\n".join(_port(port, homes) for port in node.inputs.values()) or "None."
    yield "**Outputs**"
    yield "\n".join(_port(port, homes) for port in node.outputs.values())
    yield "**Example**"
    yield f"```pycon\n{sections['Examples'].strip()}\n```"
    if picture:
        yield f"![What {node.name} makes in its example]({picture})"
    source = node.function.__module__.removeprefix("spheremesh.").replace(".", "/")
    yield f"Version {node.version}, in `{source}.py`."


def sections_of(doc: str) -> tuple[str, dict[str, str]]:
    """What a numpydoc docstring says first, and its sections by title."""
    opening, *rest = SECTION.split(doc)
    return opening.strip(), dict(zip(rest[::2], rest[1::2], strict=True))


def _port(port: Port, homes: Mapping[str, str]) -> str:
    """A port as an item of a list."""
    lines = [f"- **{_text(port.name)}**: {_text(port_facts(port))}"]
    if port.help:
        lines.append(f"\n  {_text(port.help, homes)}")
    fields = report_fields(port)
    if fields:
        indented = "".join(f"  {line}\n" for line in fields.splitlines())
        lines.append(f"\n  ```text\n{indented}  ```")
    return "\n".join(lines)


def _text(text: str, homes: Mapping[str, str] = {}) -> str:
    """Text of a docstring as Markdown: nodes are links, and nothing else is markup."""
    parts: list[str] = []
    end = 0
    for code in CODE.finditer(text):
        name = code[2]
        link = f"[`{name}`]({homes[name]}.md#{name})" if name in homes else f"`{name}`"
        parts += [_escaped(text[end : code.start()]), link]
        end = code.end()
    return "".join([*parts, _escaped(text[end:])])


def _escaped(text: str) -> str:
    return re.sub(r"([\\*_<>\[\]$|#])", r"\\\1", text)
