"""The reference of all nodes, written from the nodes themselves: a page for each chapter.

What is said of a port is what ``spheremesh nodes NAME`` says of it.
"""

import inspect
import re
from collections.abc import Iterable, Iterator, Mapping

from spheremesh.interfaces.node_help import port_facts, report_fields
from spheremesh.kernel.reports import Report
from spheremesh.nodes import Node, Port, library
from spheremesh.nodes.graphs.annotations import Hint, element_type, members
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
    every = [node for nodes in chapters.values() for node in nodes]
    kinds = wired_types(every)
    homes = {node.name: f"{node.category}.md#{node.name}" for node in every}
    homes |= {name: f"types.md#{name.lower()}" for name in kinds}
    front = [
        "# The nodes",
        f"All {len(every)} nodes by chapters. Each is a plain function of `spheremesh.nodes`, "
        "and a step of a graph (`g.add`). `spheremesh nodes NAME` tells the same on the "
        "command line. [What goes by wire](types.md) tells of meshes, panels, beams.",
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
    pages["types"] = "\n\n".join(_types(kinds, homes)) + "\n"
    return pages


def wired_types(nodes: Iterable[Node]) -> dict[str, type]:
    """Types of the library that ports take and give, by name; reports are told at the ports."""
    ports = (p for node in nodes for p in (*node.inputs.values(), *node.outputs.values()))
    kinds = {kind for port in ports for kind in _kinds(port.type)}
    ours = (kind for kind in kinds if kind.__module__.startswith("spheremesh."))
    return {kind.__name__: kind for kind in sorted(ours, key=lambda kind: kind.__name__)}


def _kinds(hint: Hint) -> Iterator[type]:
    for member in members(hint):
        if isinstance(member.kind, type) and not issubclass(member.kind, Report):
            yield member.kind
        element = element_type(member.hint)
        if isinstance(element, type) and element is not member.kind:
            yield from _kinds(element)


def _types(kinds: Mapping[str, type], homes: Mapping[str, str]) -> Iterable[str]:
    yield "# What goes by wire"
    yield "Records that nobody changes; nodes make new ones. Their arrays are read-only."
    for name, kind in kinds.items():
        opening, sections = sections_of(inspect.getdoc(kind) or "")
        yield f"## {name}"
        yield _text(opening, homes)
        yield f"```text\n{sections['Attributes'].strip()}\n```"


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
    facts = re.sub(r"\b[A-Z]\w+", lambda name: _linked(name[0], homes), _text(port_facts(port)))
    lines = [f"- **{_text(port.name)}**: {facts}"]
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
        link = _linked(code[2], homes, "`")
        parts += [_escaped(text[end : code.start()]), link]
        end = code.end()
    return "".join([*parts, _escaped(text[end:])])


def _linked(name: str, homes: Mapping[str, str], quote: str = "") -> str:
    shown = f"{quote}{name}{quote}"
    return f"[{shown}]({homes[name]})" if name in homes else shown


def _escaped(text: str) -> str:
    return re.sub(r"([\\*_<>\[\]$|#])", r"\\\1", text)
