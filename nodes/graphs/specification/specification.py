"""What a graph is, as a record that nobody changes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, TypeVar

from .connections import Place
from .wires import Param, Step

_Item = TypeVar("_Item")


def _empty() -> Mapping[str, Any]:
    return MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Specification:
    """A graph: edits give another one, and undoing gives the old one back.

    Attributes
    ----------
    title, units : str
    owner : object
        What its steps and sliders, and those of its copies, have in common.
    params : mapping of str to Param
    values : mapping of str to object
        Of the sliders.
    steps : mapping of str to Step
        Each after those that it needs, and wired to the very steps that are here.
    groups : mapping of str to tuple of str
        Names of steps.
    comments : mapping of str to str
        By name of a step; of the whole graph by the empty name.
    extra : mapping of str to object
        Entries of a graph file that others put there.
    """

    title: str = ""
    units: str = "m"
    owner: object = field(default_factory=object)
    params: Mapping[str, Param] = field(default_factory=_empty)
    values: Mapping[str, Any] = field(default_factory=_empty)
    steps: Mapping[str, Step] = field(default_factory=_empty)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=_empty)
    comments: Mapping[str, str] = field(default_factory=_empty)
    extra: Mapping[str, Any] = field(default_factory=_empty)

    def place(self, step: str) -> Place:
        """Where the inputs of a step are wired."""
        return Place(self.owner, self.steps, self.values, step)


def frozen(items: Mapping[str, _Item]) -> Mapping[str, _Item]:
    """A mapping that nobody changes."""
    return MappingProxyType(dict(items))
