"""A studio: one graph, the pages that show it, and the process that runs it."""

from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, Final

from ...fabrication.mesh_files.reader import SUFFIXES, read_mesh
from ...kernel.meshes.mesh import mean_edge_length
from ...nodes.graphs.errors import GraphError
from ...nodes.graphs.running.files import paths_of
from ...nodes.graphs.specification.file import encode_graph
from ...nodes.graphs.specification.specification import Specification
from ...nodes.graphs.specification.wires import Param
from ..hops.guard import RefusedError, check_paths
from .catalogue import Catalogue, unknown_ports
from .channels import Channels
from .code import python_code
from .document import Document, opened
from .folder import free_file, inside, listed
from .operations import real_node
from .runs import Runs
from .templates import TEMPLATES, Design, template_graph
from .worker import Place

UNTITLED: Final = "untitled.json"
MOST_TARGETS: Final = 12


class Session:
    """What a studio has open.

    Parameters
    ----------
    place : Place
        Where its runs work; the folder is also that of its graphs.
    path : Path, optional
        The graph file; an empty graph without one.
    """

    def __init__(self, place: Place, path: Path | None = None) -> None:
        self.folder = Path(place.files)
        self.catalogue = Catalogue()
        self.channels = Channels()
        graph = opened(path) if path is not None and path.exists() else Specification()
        self.document = Document(graph, path, self._changed)
        self.runs = Runs(place, self.channels.tell)

    def state(self) -> dict[str, Any]:
        """All that a page needs to show the graph."""
        return {
            **self.document.content(),
            "facts": self._facts(),
            "runs": self.runs.state,
            "templates": [
                {"name": name, "title": each.title, "summary": each.summary}
                for name, each in TEMPLATES.items()
            ],
            "folder": self.folder.name,
            "place": str(self.folder),
            "versions": [path.stem for path in self.document.versions()],
        }

    def _facts(self) -> dict[str, Any]:
        """What the file does not say of steps: what is unfinished, and ports of others."""
        found: dict[str, Any] = {}
        for name, step in self.document.specification.steps.items():
            facts: dict[str, Any] = {}
            if step.unfinished:
                facts["unfinished"] = step.unfinished
            if step.nesting:
                facts["nesting"] = step.nesting
            node = real_node(step)
            if node is None:
                facts["unknown"] = unknown_ports(step.inputs)
            elif node.inner is not None or node.name not in self.catalogue.nodes:
                facts["node"] = self.catalogue.described(node)
            if facts:
                found[name] = facts
        return found

    def edit(self, rev: int, operations: Sequence[Any], gesture: str) -> dict[str, Any]:
        """Change the graph; what it is then."""
        for operation in operations:
            if not isinstance(operation, dict):
                raise RefusedError(400, "an operation is an object")
        self._check_files(operations)
        self._name_file()
        self.document.edit(rev, operations, gesture)
        return self.present()

    def undo(self) -> dict[str, Any]:
        """Take back the last edit."""
        self.document.undo()
        return self.present()

    def redo(self) -> dict[str, Any]:
        """Do again what was taken back."""
        self.document.redo()
        return self.present()

    def present(self) -> dict[str, Any]:
        """The graph as it is, for a page that knows the rest."""
        return {**self.document.content(), "facts": self._facts()}

    def run(self, targets: list[str]) -> dict[str, Any]:
        """Run what is shown; the number of the run."""
        if len(targets) > MOST_TARGETS:
            raise RefusedError(400, f"more than {MOST_TARGETS} outputs at once")
        text, rev = self._text()
        return {"run": self.runs.run(text, rev, targets)}

    def cancel(self, run: int) -> dict[str, Any]:
        """Kill a run."""
        return {"cancelled": self.runs.cancel(run)}

    def export(self, folder: str, options: Mapping[str, Any]) -> dict[str, Any]:
        """Write the files of the graph into a folder; the number of the run."""
        path = inside(self.folder, folder)
        text, rev = self._text()
        name = path.relative_to(self.folder.resolve()).as_posix()
        overwrite = bool(options.get("overwrite"))
        return {"run": self.runs.run(text, rev, [], folder=name, overwrite=overwrite)}

    def replaced(self, folder: str) -> list[str]:
        """Names of the files in a folder in whose place an export would write."""
        root = inside(self.folder, folder)
        graph = self.document.specification
        found: list[str] = []
        for step in graph.steps.values():
            node = real_node(step)
            for port in () if node is None else node.file_inputs:
                given = step.inputs.get(port.name, port.default)
                given = graph.values.get(given.name) if isinstance(given, Param) else given
                names = paths_of(given) if port.writes else []
                found += [name for name in names if (root / name).is_file()]
        return sorted(set(found))

    def open(self, what: Mapping[str, Any]) -> dict[str, Any]:
        """Open a file or a template, or begin anew."""
        path: Path | None = None
        if "file" in what:
            path = inside(self.folder, str(what["file"]))
            graph = opened(path)
        elif what.get("template"):
            name = str(what["template"])
            if name not in TEMPLATES:
                raise GraphError(f"there is no template {name[:40]!r}")
            graph = template_graph(name, self._design(str(what.get("mesh") or "")))
            path = free_file(self.folder, f"{name}.json")
        else:
            graph = Specification()
        self.runs.forget()
        self.document.replace(graph, path)
        self.channels.tell({"type": "opened", "rev": self.document.rev})
        return self.state()

    def _design(self, name: str) -> Design:
        """A mesh file of the folder as what a template begins with."""
        if not name:
            return Design()
        path = inside(self.folder, name)
        return Design(name, mean_edge_length(read_mesh(path)))

    def receive(self, name: str, data: bytes) -> dict[str, Any]:
        """Keep a mesh file that was dropped on the page; the name that it has in the folder."""
        plain = PurePosixPath(name.replace("\\", "/")).name
        if not plain.lower().endswith(SUFFIXES):
            raise GraphError(
                f"{plain[:80]!r} is no mesh file: take one that ends in {', '.join(SUFFIXES)}"
            )
        path = inside(self.folder, plain)
        if not path.is_file() or path.read_bytes() != data:
            path = free_file(self.folder, plain)
            path.write_bytes(data)
        return {"file": path.name}

    def save_as(self, file: str) -> dict[str, Any]:
        """Save under a name in the folder, and go on there; without one, save where it is."""
        if file:
            name = file if file.endswith(".json") else f"{file}.json"
            path = inside(self.folder, name)
            if path.exists() and path != self.document.path:
                raise RefusedError(
                    409, f"there is a file {name!r} already; choose another name"
                )
            self.document.path = path
        self._name_file()
        self.document.save()
        self._changed(self.document.rev)
        return self.state()

    def revert(self, version: str) -> dict[str, Any]:
        """Go back to an earlier version of the file; that can be undone."""
        known = {path.stem: path for path in self.document.versions()}
        if version not in known:
            raise GraphError(f"there is no version {version[:40]!r}")
        self.document.revert(opened(known[version]))
        return self.state()

    def files(self, ending: str) -> list[str]:
        """Names of files in the folder: all, those of an ending, or those of meshes."""
        endings = SUFFIXES if ending == "mesh" else (ending.lower(),) if ending else ()
        return listed(self.folder, endings)

    def code(self) -> str:
        """The graph as Python code."""
        return python_code(self.document.specification)

    def close(self) -> None:
        """Save, and end what runs."""
        self.document.save()
        self.channels.close()
        self.runs.close()

    def _text(self) -> tuple[str, int]:
        document = self.document
        return encode_graph(document.specification), document.rev

    def _changed(self, rev: int) -> None:
        self.channels.tell({"type": "doc", "rev": rev})

    def _name_file(self) -> None:
        """A graph without a file gets one with its first edit."""
        if self.document.path is None:
            self.document.path = free_file(self.folder, UNTITLED)

    def _check_files(self, operations: Sequence[Mapping[str, Any]]) -> None:
        """Say at once that a path leads out of the folder; a run would be refused besides."""
        steps = self.document.specification.steps
        for operation in operations:
            step = steps.get(str(operation.get("step", "")))
            node = None if step is None or operation.get("op") != "give" else real_node(step)
            port = None if node is None else node.inputs.get(str(operation.get("port")))
            if port is not None and (port.reads or port.writes):
                where = f"{operation['step']}.{port.name}"
                check_paths(operation.get("value"), self.folder, where)
