"""The lazy graph: nodes wired together, run as far as a target needs."""

import html
import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from threading import Event as Flag
from types import MappingProxyType

from ...fabrication.output_folder import OutputFolder
from .annotations import Value
from .editor import Editor
from .errors import GraphError, nearest
from .node import Node, known_graph, replaced
from .ports import brief
from .running.events import OnEvent, OnStep, Watch
from .running.files import Folders
from .running.run import Run, output, run_steps
from .running.subgraphs import expanded, run_inner
from .specification.connections import check_owner, present
from .specification.differences import Difference, differences
from .specification.file import contents_folder, encode_graph, read_graph, write_graph
from .specification.mermaid import mermaid_text
from .specification.reading import Reading, built, decode_graph
from .specification.specification import Specification
from .specification.subgraphs import graph_node
from .specification.svg import svg_text
from .specification.wires import Param, Step, Target, Wire
from .stores.disk import DiskStore
from .stores.entries import Store
from .stores.memory import MemoryStore
from .stores.results import own, snapshot


class Graph(Editor):
    """Nodes wired together; only what a target needs is run, and only once.

    Parameters
    ----------
    title : str
    units : {"mm", "cm", "m", "in", "ft"}
        Of the model.
    cache : Store or path, optional
        Where results are kept: a `MemoryStore` or `DiskStore` to share them with other graphs,
        or the folder of a `DiskStore`. In memory of its own by default.

    Examples
    --------
    >>> from spheremesh.nodes import Graph, node
    >>> @node
    ... def add_numbers(a: float, b: float = 1.0) -> float:
    ...     return a + b
    >>> graph = Graph("sum")
    >>> a = graph.param("a", 2.0, min=0)
    >>> total = graph.add(add_numbers, a=a)
    >>> graph.run(total)
    3.0
    >>> graph.set(a=5.0)
    >>> graph.run(total)
    6.0
    """

    def __init__(
        self,
        title: str = "",
        units: str = "m",
        *,
        cache: Store | str | os.PathLike[str] | None = None,
    ) -> None:
        super().__init__(Specification(title, units))
        self._cache = _store(cache)
        self._messages: dict[str, tuple[str, ...]] = {}

    @property
    def cache(self) -> Store:  # numpydoc ignore=RT01
        """Where results are kept; a store, or the folder of a `DiskStore`, may be set."""
        return self._cache

    @cache.setter
    def cache(  # numpydoc ignore=GL08
        self, cache: Store | str | os.PathLike[str]
    ) -> None:
        self._cache = _store(cache)

    @property
    def messages(self) -> Mapping[str, tuple[str, ...]]:  # numpydoc ignore=RT01
        """What the steps warned about when they, or steps after them, were last asked for."""
        return MappingProxyType(self._messages)

    def run(
        self,
        *targets: Target,
        on_step: OnStep | None = None,
        on_event: OnEvent | None = None,
        cancel: Flag | None = None,
        read_from: str | os.PathLike[str] | None = None,
        write_to: str | os.PathLike[str] | OutputFolder | None = None,
    ) -> Value:
        """The values of targets; only the steps that they need and that have changed are run.

        What is changed while it runs is for the next run.

        Parameters
        ----------
        *targets : Step, Wire, Param or str
            Outputs, whole steps, or their names ``"step.port"``.
        on_step : callable, optional
            Called with the name of each step touched and ``"running"``, ``"done"``,
            ``"cached"``, ``"failed"`` or ``"cancelled"``.
        on_event : callable, optional
            Called with an `Event` for all that happens: seconds, bytes, and the progress of
            long steps.
        cancel : threading.Event, optional
            Set from another thread, or while on_event is called, it ends the run between steps
            and inside those that say how far they are.
        read_from, write_to : path or OutputFolder, optional
            Folders of the relative paths that nodes read and write; the working directory by
            default. A file that a step has written is read where it was written. An
            `OutputFolder` also says where steps may write.

        Returns
        -------
        object
            The value, or a tuple of them for several targets.

        Raises
        ------
        NodeError
            If a step fails; ``cause`` is what its function raised.
        RunCancelledError
            If the run was called off; what is done is kept.
        GraphError, InputError
            If a step would write over a file that a step reads, or where it must not.
        """
        if not targets:
            raise GraphError(f"run needs a target; {nearest('', self.steps)}")
        with self._lock:
            now, cache = self._specification, self._cache
            wanted = [self._target(target) for target in targets]
            # Lists and arrays of sliders are theirs who set them, and may change.
            values = own(dict(now.values), snapshot)
        output_to = write_to if isinstance(write_to, OutputFolder) else _folder(write_to)
        steps, aliases = expanded(now.steps)
        run = Run(
            steps,
            values,
            now.units,
            cache,
            Watch(on_step, on_event, cancel),
            Folders(_folder(read_from), output_to),
            aliases,
        )
        try:
            with known_graph(partial(encode_graph, now)):
                run_steps(run, wanted)
            found = tuple(output(run, target) for target in wanted)
        finally:
            self._note_messages(run)
            cache.trim()
        return found[0] if len(found) == 1 else found

    def _target(self, target: Target) -> Step | Wire | Param:
        """A target as it is now."""
        if isinstance(target, str):
            return self.wire(target)
        if isinstance(target, Param):
            check_owner(self._specification.owner, target)
            return self.slider(target.name)
        return present(self._specification.owner, self.steps, target)

    def _note_messages(self, run: Run) -> None:
        messages = dict(self._messages)
        for name, key in run.keys.items():
            said = replaced(run.steps[name].node) + run.store.messages(key)
            messages.pop(name, None)
            if said:
                messages[name] = said
        self._messages = messages

    def copy(self) -> "Graph":
        """The same graph, to be edited and run apart from this one.

        Returns
        -------
        Graph
            Shares the results; steps and sliders of one stand for those of the other.
        """
        copy = Graph(cache=self._cache)
        copy._specification = self._specification
        return copy

    def as_node(
        self, name: str | None = None, outputs: Mapping[str, Step | Wire | str] | None = None
    ) -> Node:
        """The graph as it is now as a node, for `add` of other graphs.

        Parameters
        ----------
        name : str, optional
            Of the node; by default made of the title.
        outputs : mapping of str to Step, Wire or str, optional
            What each output is; by default the outputs of the steps that no other uses.

        Returns
        -------
        Node
            Its inputs are the sliders. Its steps run as steps of the other graph, under
            names such as ``"node/step"``.

        Raises
        ------
        GraphError
            If there is no output, or an output is not what its name says.
        """
        targets = {
            port: self.wire(target) if isinstance(target, str) else target
            for port, target in (outputs or {}).items()
        }
        return graph_node(self._specification, name, targets, run_inner)

    def diff(self, other: "Graph") -> tuple[Difference, ...]:
        """What makes another graph of this one.

        Parameters
        ----------
        other : Graph

        Returns
        -------
        tuple of Difference
            Steps, sliders, groups, comments that were added, removed or changed; as texts
            they read like the lines of a report.
        """
        return differences(self._specification, other.specification)

    def to_json(self) -> str:
        """The graph as the text of a graph file.

        Returns
        -------
        str
            Versioned JSON in a stable order, without code. Meshes and long arrays stand in it
            as bytes.
        """
        return encode_graph(self._specification)

    @classmethod
    def from_json(
        cls,
        text: str,
        *,
        cache: Store | str | os.PathLike[str] | None = None,
        unfinished: bool = False,
        imports: bool = False,
        contents: str | os.PathLike[str] | None = None,
    ) -> "Graph":
        """The graph of a graph file's text.

        Parameters
        ----------
        text : str
            From `to_json`; if it is no valid graph, the error says where.
        cache : Store or path, optional
            Where results are kept.
        unfinished : bool
            Whether steps of unknown nodes, or with wrong or missing inputs, are kept as they
            are (`Step.unfinished` says why) instead of being an error.
        imports : bool
            Whether the modules that the text names for nodes that are not known are imported:
            that runs their code.
        contents : path, optional
            Folder of the contents that do not stand in the text.

        Returns
        -------
        Graph
            The same graph.
        """
        folder = None if contents is None else Path(contents)
        reading = Reading(run_inner, unfinished, imports, folder)
        specification = built(decode_graph(text), reading)
        graph = cls(cache=cache)
        graph._specification = specification
        return graph

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a graph file.

        Parameters
        ----------
        path : path
            An old file is replaced only when the new one is complete. Meshes and long arrays
            stand beside it, in the folder ``NAME.contents``, by digest.
        """
        write_graph(path, self._specification)

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        *,
        cache: Store | str | os.PathLike[str] | None = None,
        unfinished: bool = False,
        imports: bool = False,
    ) -> "Graph":
        """Read a graph file.

        Parameters
        ----------
        path : path
            If it is no valid graph file, the error says where.
        cache, unfinished, imports : object
            As for `from_json`.

        Returns
        -------
        Graph
            Nothing has been run.
        """
        parse = partial(
            cls.from_json,
            cache=cache,
            unfinished=unfinished,
            imports=imports,
            contents=contents_folder(path),
        )
        return read_graph(path, parse)

    def mermaid(self) -> str:
        """The graph as a Mermaid flowchart.

        Returns
        -------
        str
            Text that Markdown viewers draw.
        """
        return mermaid_text(self._specification.values, self.steps)

    def svg(self) -> str:
        """The graph as a picture.

        Returns
        -------
        str
            One ``svg`` element, which notebooks and browsers draw.
        """
        return svg_text(self._specification.values, self.steps)

    def __repr__(self) -> str:
        now = self._specification
        sliders = ", ".join(f"{name}={brief(value)}" for name, value in now.values.items())
        parts = [f"{now.title!r}", f"{len(now.steps)} steps", f"sliders {sliders or 'none'}"]
        return f"Graph({'; '.join([*parts, now.units])})"

    def _repr_html_(self) -> str:
        """The picture that a notebook shows, and what the steps warned about."""
        said = [f"{name}: {text}" for name, texts in self._messages.items() for text in texts]
        notes = "".join(f"<br><small>{html.escape(text)}</small>" for text in said)
        return f"{self.svg()}<br><small>{html.escape(repr(self))}</small>{notes}"


def _store(cache: Store | str | os.PathLike[str] | None) -> Store:
    if cache is None:
        return MemoryStore()
    return DiskStore(cache) if isinstance(cache, str | os.PathLike) else cache


def _folder(path: str | os.PathLike[str] | None) -> Path | None:
    return None if path is None else Path(path).absolute()
