"""The lazy graph: nodes wired together, run as far as a target needs."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Event as Flag
from types import MappingProxyType
from typing import Any

import numpy as np

from ...fabrication.output_folder import OutputFolder
from .annotations import Value
from .errors import GraphError, nearest
from .node import find_node, known_graph, replaced
from .ports import UNITS, Port, check_range, check_slider
from .running.events import OnEvent, OnStep, Watch
from .running.files import Folders
from .running.run import Run, output, run_steps
from .specification.connections import Place, check_name, check_owner, connect, connect_all
from .specification.file import (
    add_content,
    decode_graph,
    encode_graph,
    read_graph,
    write_graph,
)
from .specification.mermaid import mermaid_text
from .specification.wires import Each, Param, Step, Target, Wire, output_wire, sources
from .stores.digests import digest
from .stores.disk import DiskStore
from .stores.entries import Store
from .stores.memory import MemoryStore
from .stores.results import own, snapshot


class Graph:
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
        if units not in UNITS:
            raise GraphError(f"units = {units!r}: must be one of {', '.join(UNITS)}")
        self.title = title
        self.units = units
        self._cache = _store(cache)
        self._params: dict[str, Param] = {}
        self._values: dict[str, Any] = {}
        self._steps: dict[str, Step] = {}
        self._numbers: dict[str, int] = {}
        self._messages: dict[str, tuple[str, ...]] = {}

    @property
    def steps(self) -> Mapping[str, Step]:  # numpydoc ignore=RT01
        """The steps by name, each after those that it needs."""
        return MappingProxyType(self._steps)

    @property
    def params(self) -> Mapping[str, Param]:  # numpydoc ignore=RT01
        """The sliders by name, with their present values."""
        return {n: replace(p, value=own(self._values[n])) for n, p in self._params.items()}

    @property
    def ends(self) -> tuple[Step, ...]:  # numpydoc ignore=RT01
        """The steps that no other step uses."""
        used = {name for step in self._steps.values() for name in step.parents}
        return tuple(step for name, step in self._steps.items() if name not in used)

    @property
    def messages(self) -> Mapping[str, tuple[str, ...]]:  # numpydoc ignore=RT01
        """What the steps warned about when they, or steps after them, were last asked for."""
        return MappingProxyType(self._messages)

    def param(
        self,
        name: str,
        value: Value,
        *,
        min: float | None = None,  # noqa: A002, the words of a slider
        max: float | None = None,  # noqa: A002
        choices: Sequence[Any] = (),
    ) -> Param:
        """Add a slider.

        Parameters
        ----------
        name : str
        value : object
        min, max : float, optional
            Range of a number, the ends included.
        choices : sequence, optional

        Returns
        -------
        Param
            To be wired into steps.

        Raises
        ------
        GraphError
            If the name is taken or the value not allowed.
        """
        if name in self._params:
            raise GraphError(f"there is a param {name!r} already; change it with set")
        check_name(name, "param")
        if isinstance(value, Each | Param | Step | Wire):
            raise GraphError(f"param {name}: a slider holds a value, no wire and no each(...)")
        value = _plain(value)
        port = Port(name=name, min=min, max=max, choices=tuple(choices))
        check_slider(value, port)
        self._values[name] = value
        self._params[name] = Param(self, name, value, port)
        return self._params[name]

    def add(
        self, node: str | Callable[..., Any], name: str | None = None, /, **inputs: Value
    ) -> Step:
        """Add a step and wire its inputs.

        Parameters
        ----------
        node : callable or str
            A function decorated with `@node`, or its name.
        name : str, optional
            Name of the step; by default that of the node, numbered when repeated.
        **inputs : object
            For each input an output of another step, a slider, ``each(...)`` or a value.

        Returns
        -------
        Step
            Its outputs are its attributes; if there is one, the step itself can be wired.

        Raises
        ------
        GraphError
            If the node, an input or a type is wrong; the message names both ends.
        """
        found = find_node(node)
        if name is not None and not isinstance(name, str):  # pyright: ignore[reportUnnecessaryIsInstance]
            inputs_known = ", ".join(found.inputs)
            raise GraphError(f"{found.name}: wire inputs by name; they are {inputs_known}")
        if name is None:
            name = self._free_name(found.name)
        elif name in self._steps:
            raise GraphError(f"there is a step {name!r} already")
        connected = connect_all(Place(self, self._values, name), found, inputs)
        self._steps[name] = Step(self, name, found, MappingProxyType(connected))
        return self._steps[name]

    def _free_name(self, name: str) -> str:
        free, number = name, self._numbers.get(name, 2)
        while free in self._steps:
            free = f"{name}_{number}"
            number += 1
        self._numbers[name] = max(2, number - 1)  # those below are taken
        return free

    def set(self, /, **params: Value) -> None:
        """Move sliders; none if a name is unknown or a value not allowed.

        Parameters
        ----------
        **params : object
        """
        self._values.update(self.check_params(params))

    def check_params(self, params: Mapping[str, Any]) -> dict[str, Any]:
        """Values for sliders, checked against their ranges and the inputs that they feed.

        Parameters
        ----------
        params : mapping of str to object

        Returns
        -------
        dict of str to object
            The same values, NumPy's scalars as Python's.
        """
        values = {name: _plain(value) for name, value in params.items()}
        for name, value in values.items():
            check_range(value, self.slider(name).port, f"param {name}")
            digest(value)
        present = {**self._values, **values}
        for step in self._steps.values():
            place = Place(self, present, step.name)
            for name, given in step.inputs.items():
                if any(isinstance(s, Param) and s.name in values for s in sources(given)):
                    connect(place, step.node.inputs[name], given)
        return values

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
            raise GraphError(f"run needs a target; {nearest('', self._steps)}")
        wanted = [self.wire(t) if isinstance(t, str) else t for t in targets]
        for target in wanted:
            check_owner(self, target)
        steps = [t.step if isinstance(t, Wire) else t for t in wanted]
        names = [step.name for step in steps if isinstance(step, Step)]
        values = own(self._values, snapshot)
        output_to = write_to if isinstance(write_to, OutputFolder) else _folder(write_to)
        run = Run(
            dict(self._steps),
            values,
            self.units,
            self._cache,
            Watch(on_step, on_event, cancel),
            Folders(_folder(read_from), output_to),
        )
        text = partial(encode_graph, self.title, self.units, self.params, run.steps)
        try:
            with known_graph(text):
                run_steps(run, names)
            values = tuple(output(run, target) for target in wanted)
        finally:
            for name, key in run.keys.items():
                messages = replaced(run.steps[name].node) + self._cache.messages(key)
                self._messages.pop(name, None)
                if messages:
                    self._messages[name] = messages
            self._cache.trim()
        return values[0] if len(values) == 1 else values

    def wire(self, name: str) -> Step | Wire:
        """A step or an output by name.

        Parameters
        ----------
        name : str
            ``"step"`` or ``"step.port"``.

        Returns
        -------
        Step or Wire
            What has the name; if nothing has, the error gives the nearest.
        """
        step_name, dot, port = name.partition(".")
        if step_name not in self._steps:
            raise GraphError(f"no step {step_name!r}; {nearest(step_name, self._steps)}")
        step = self._steps[step_name]
        return output_wire(step, port) if dot else step

    def slider(self, name: str) -> Param:
        """A slider by name.

        Parameters
        ----------
        name : str

        Returns
        -------
        Param
            To be wired into steps; if there is none, the error gives the nearest name.
        """
        if name not in self._params:
            raise GraphError(f"no param {name!r}; {nearest(name, self._params)}")
        return self._params[name]

    def to_json(self) -> str:
        """The graph as the text of a graph file.

        Returns
        -------
        str
            Versioned JSON in a stable order, without code.
        """
        return encode_graph(self.title, self.units, self.params, self._steps)

    @classmethod
    def from_json(
        cls, text: str, *, cache: Store | str | os.PathLike[str] | None = None
    ) -> "Graph":
        """The graph of a graph file's text.

        Parameters
        ----------
        text : str
            From `to_json`; if it is no valid graph, the error says where.
        cache : Store or path, optional
            Where results are kept.

        Returns
        -------
        Graph
            The same graph.
        """
        content = decode_graph(text)
        graph = cls(content["title"], content["units"], cache=cache)
        add_content(graph, content)
        return graph

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a graph file.

        Parameters
        ----------
        path : path
            An old file is replaced only when the new one is complete.
        """
        write_graph(path, self.to_json())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "Graph":
        """Read a graph file.

        Parameters
        ----------
        path : path
            If it is no valid graph file, the error says where.

        Returns
        -------
        Graph
            Nothing has been run.
        """
        return read_graph(path, cls.from_json)

    def mermaid(self) -> str:
        """The graph as a Mermaid flowchart.

        Returns
        -------
        str
            Text that Markdown viewers draw.
        """
        return mermaid_text(self._values, self._steps)


def _store(cache: Store | str | os.PathLike[str] | None) -> Store:
    if cache is None:
        return MemoryStore()
    return DiskStore(cache) if isinstance(cache, str | os.PathLike) else cache


def _folder(path: str | os.PathLike[str] | None) -> Path | None:
    return None if path is None else Path(path).absolute()


def _plain(value: Value) -> Value:
    """NumPy's scalars as Python's; lists and arrays the graph's own."""
    return own(value.item() if isinstance(value, np.generic) else value, snapshot)
