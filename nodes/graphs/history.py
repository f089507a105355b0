"""A graph and how it came about: what it is now, and what it was before."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from threading import RLock
from typing import Any, Final

from .errors import GraphError, nearest
from .ports import UNITS
from .specification.specification import Specification
from .specification.wires import Param, Step, Wire, output_wire
from .stores.results import own

MOST_UNDONE: Final = 256
"""How many edits are remembered."""

Edit = Callable[[Specification], Specification]


class History:
    """What `Graph` has of looking at it, and of undoing.

    Parameters
    ----------
    specification : Specification
        What it begins with.
    """

    def __init__(self, specification: Specification) -> None:
        _check_units(specification.units)
        self._specification = specification
        self._past: deque[Specification] = deque(maxlen=MOST_UNDONE)
        self._future: list[Specification] = []
        self._numbers: dict[str, int] = {}
        self._lock = RLock()

    @property
    def specification(self) -> Specification:  # numpydoc ignore=RT01
        """The graph as it is now, as a record that nobody changes."""
        return self._specification

    @property
    def title(self) -> str:  # numpydoc ignore=RT01
        """What the graph is called."""
        return self._specification.title

    @title.setter
    def title(self, title: str) -> None:  # numpydoc ignore=GL08
        self._edit(lambda before: replace(before, title=title))

    @property
    def units(self) -> str:  # numpydoc ignore=RT01
        """Units of the model."""
        return self._specification.units

    @units.setter
    def units(self, units: str) -> None:  # numpydoc ignore=GL08
        _check_units(units)
        self._edit(lambda before: replace(before, units=units))

    @property
    def steps(self) -> Mapping[str, Step]:  # numpydoc ignore=RT01
        """The steps by name, each after those that it needs."""
        return self._specification.steps

    @property
    def params(self) -> Mapping[str, Param]:  # numpydoc ignore=RT01
        """The sliders by name, with their present values."""
        now = self._specification
        return {n: replace(p, value=own(now.values[n])) for n, p in now.params.items()}

    @property
    def groups(self) -> Mapping[str, tuple[str, ...]]:  # numpydoc ignore=RT01
        """Names of steps by group."""
        return self._specification.groups

    @property
    def comments(self) -> Mapping[str, str]:  # numpydoc ignore=RT01
        """What is said of steps, and of the whole graph by the empty name."""
        return self._specification.comments

    @property
    def ends(self) -> tuple[Step, ...]:  # numpydoc ignore=RT01
        """The steps that no other step uses."""
        steps = self._specification.steps
        used = {name for step in steps.values() for name in step.parents}
        return tuple(step for name, step in steps.items() if name not in used)

    def undo(self) -> bool:
        """Take back the last edit.

        Returns
        -------
        bool
            Whether there was one.
        """
        return self._step_in_time(self._past, self._future)

    def redo(self) -> bool:
        """Do again what was taken back last.

        Returns
        -------
        bool
            Whether there was something.
        """
        return self._step_in_time(self._future, self._past)

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
        steps = self._specification.steps
        step_name, dot, port = name.partition(".")
        if step_name not in steps:
            raise GraphError(f"no step {step_name!r}; {nearest(step_name, steps)}")
        return output_wire(steps[step_name], port) if dot else steps[step_name]

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
        params = self._specification.params
        if name not in params:
            raise GraphError(f"no param {name!r}; {nearest(name, params)}")
        return params[name]

    def _edit(self, edit: Edit, *, keeps_names: bool = False) -> Specification:
        with self._lock:
            after = edit(self._specification)
            self._past.append(self._specification)
            self._future.clear()
            self._specification = after
            if not keeps_names:
                self._numbers.clear()
            return after

    def _step_in_time(self, there: Any, here: Any) -> bool:  # noqa: ANN401
        with self._lock:
            if not there:
                return False
            here.append(self._specification)
            self._specification = there.pop()
            self._numbers.clear()
            return True


def _check_units(units: str) -> None:
    if units not in UNITS:
        raise GraphError(f"units = {units!r}: must be one of {', '.join(UNITS)}")
