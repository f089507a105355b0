"""A graph under the hands of its user: steps, sliders and wires, added and changed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from .annotations import Value
from .errors import GraphError, nearest
from .history import History
from .node import Node, find_node
from .ports import Port, check_range, check_slider
from .specification import edits
from .specification.connections import check_name, connect
from .specification.specification import Specification, frozen
from .specification.wires import Each, Param, Step, Wire, sources
from .stores.digests import digest
from .stores.results import own, snapshot


class Editor(History):
    """What `Graph` has of edits: each is undone as a whole, and none is half done."""

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
        check_name(name, "param")
        if isinstance(value, Each | Param | Step | Wire):
            raise GraphError(f"param {name}: a slider holds a value, no wire and no each(...)")
        value = _plain(value)
        port = Port(name=name, min=min, max=max, choices=tuple(choices))
        check_slider(value, port)

        def _added(before: Specification) -> Specification:
            if name in before.params:
                raise GraphError(f"there is a param {name!r} already; change it with set")
            slider = Param(before.owner, name, value, port)
            return replace(
                before,
                params=frozen({**before.params, name: slider}),
                values=frozen({**before.values, name: value}),
            )

        return self._edit(_added).params[name]

    def add(
        self, node: "str | Callable[..., Any] | Editor | Node", name: str | None = None, /,
        **inputs: Value,
    ) -> Step:  # fmt: skip
        """Add a step and wire its inputs.

        Parameters
        ----------
        node : callable, str, Graph or Node
            A function decorated with `@node`, or its name; or another graph, whose sliders
            are the inputs then, and its ends the outputs (`Graph.as_node` chooses others).
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
        found = self._node(node)
        if name is not None and not isinstance(name, str):  # pyright: ignore[reportUnnecessaryIsInstance]
            inputs_known = ", ".join(found.inputs)
            raise GraphError(f"{found.name}: wire inputs by name; they are {inputs_known}")
        with self._lock:
            if name is None:
                name = self._free_name(found.name)
            elif name in self.steps:
                raise GraphError(f"there is a step {name!r} already")
            step = partial(edits.with_step, name=name, node=found, inputs=inputs)
            return self._edit(step, keeps_names=True).steps[name]

    def draft(self, node: str, name: str, /, **inputs: Value) -> Step:
        """Add a step that need not be finished, or put one in its place.

        Parameters
        ----------
        node : str
            Name of a node, which need not exist.
        name : str
            Name of the step.
        **inputs : object
            Some of the inputs.

        Returns
        -------
        Step
            Its attribute ``unfinished`` says what is missing or wrong; it is empty if nothing
            is. Runs that need an unfinished step are refused.
        """
        after = self._edit(lambda before: edits.with_draft(before, name, node, inputs))
        return after.steps[name]

    def replace(
        self,
        step: str | Step,
        node: "str | Callable[..., Any] | Editor | Node",
        /,
        **inputs: Value,
    ) -> Step:
        """Put another node in the place of a step.

        Parameters
        ----------
        step : Step or str
        node : callable, str or Graph
            As for `add`.
        **inputs : object
            All inputs of the new one.

        Returns
        -------
        Step
            The new one; what it feeds is wired to it, if that fits.
        """
        name, found = _name(step), self._node(node)

        def _replaced(before: Specification) -> Specification:
            if name not in before.steps:
                raise GraphError(f"no step {name!r}; {nearest(name, before.steps)}")
            return edits.with_step(before, name, found, inputs, before.steps[name].extra)

        return self._edit(_replaced).steps[name]

    def rewire(self, step: str | Step, /, **inputs: Value) -> Step:
        """Give some inputs of a step something else.

        Parameters
        ----------
        step : Step or str
        **inputs : object
            The inputs to change; the others stay.

        Returns
        -------
        Step
            The step as it is now.
        """
        name = _name(step)
        return self._edit(lambda before: edits.rewired(before, name, inputs)).steps[name]

    def unwire(self, step: str | Step, port: str) -> Step:
        """Take from an input what it was given, so that it has its default.

        Parameters
        ----------
        step : Step or str
        port : str
            Name of the input.

        Returns
        -------
        Step
            Unfinished if the input has no default.
        """
        name = _name(step)
        return self._edit(lambda before: edits.unwired(before, name, port)).steps[name]

    def remove(self, step: str | Step | Param, *, cut: bool = False) -> None:
        """Remove a step or a slider.

        Parameters
        ----------
        step : Step, Param or str
            Steps that a slider feeds keep its present value.
        cut : bool
            Whether steps that it feeds lose these inputs and may be unfinished; otherwise a
            step that feeds others is not removed.
        """
        name = _name(step)
        if isinstance(step, Param) or (name not in self.steps and name in self.params):
            self._edit(lambda before: edits.without_param(before, name))
        else:
            self._edit(lambda before: edits.without_step(before, name, cut=cut))

    def rename(self, old: str | Step | Param, new: str) -> None:
        """Give a step or a slider another name, wherever it is wired.

        Parameters
        ----------
        old : Step, Param or str
        new : str
        """
        name = _name(old)
        if isinstance(old, Param) or (name not in self.steps and name in self.params):
            self._edit(lambda before: edits.renamed_param(before, name, new))
        else:
            self._edit(lambda before: edits.renamed_step(before, name, new))

    def group(self, name: str, *steps: str | Step) -> None:
        """Put steps into a group; without steps, remove the group.

        Parameters
        ----------
        name : str
        *steps : Step or str
            All of its members.
        """
        members = tuple(map(_name, steps))
        self._edit(lambda before: edits.grouped(before, name, members))

    def comment(self, text: str, step: str | Step = "") -> None:
        """Say something of a step, or of the whole graph; an empty text takes it back.

        Parameters
        ----------
        text : str
        step : Step or str
        """
        self._edit(lambda before: edits.commented(before, _name(step), text))

    def set(self, /, **params: Value) -> None:
        """Move sliders; none if a name is unknown or a value not allowed.

        Parameters
        ----------
        **params : object
        """
        with self._lock:
            values = self.check_params(params)
            self._edit(lambda b: replace(b, values=frozen({**b.values, **values})))

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
        now = self._specification
        values = {name: _plain(value) for name, value in params.items()}
        for name, value in values.items():
            check_range(value, self.slider(name).port, f"param {name}")
            digest(value)
        trial = replace(now, values={**now.values, **values})
        for step in now.steps.values():
            for name, given in step.inputs.items():
                if any(isinstance(s, Param) and s.name in values for s in sources(given)):
                    connect(trial.place(step.name), step.node.inputs[name], given)
        return values

    def as_node(self) -> Node:  # numpydoc ignore=RT01
        """The graph as a node of others."""
        raise NotImplementedError

    def _node(self, node: "str | Callable[..., Any] | Editor | Node") -> Node:
        if isinstance(node, Node):
            return node
        return node.as_node() if isinstance(node, Editor) else find_node(node)

    def _free_name(self, name: str) -> str:
        steps = self._specification.steps
        free, number = name, self._numbers.get(name, 2)
        while free in steps:
            free = f"{name}_{number}"
            number += 1
        self._numbers[name] = max(2, number - 1)  # those below are taken
        return free


def _name(thing: str | Step | Param) -> str:
    return thing if isinstance(thing, str) else thing.name


def _plain(value: Value) -> Value:
    """NumPy's scalars as Python's; lists and arrays the graph's own."""
    return own(value.item() if isinstance(value, np.generic) else value, snapshot)
