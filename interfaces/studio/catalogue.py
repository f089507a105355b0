"""What the page is told of nodes: their ports, the fields of these, and what fits what."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from typing import Any, Final, Literal, get_args

import numpy as np

from ...kernel.beams.beams import Beams
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.panels import Panels
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.support.annuli import Annuli
from ...kernel.surfaces.surface import Surface
from ...nodes.graphs.annotations import Hint, is_subclass, members, type_name
from ...nodes.graphs.errors import GraphError
from ...nodes.graphs.kinds import fits
from ...nodes.graphs.node import REGISTRY, Node, load_library
from ...nodes.graphs.ports import REQUIRED, Port
from ...nodes.graphs.specification.encoding import encode

_FAMILIES: Final[Mapping[str, tuple[type, ...]]] = {
    "panels": (Panels,),
    "beams": (Beams, Annuli),
    "spheres": (SphereMesh,),
    "mesh": (Mesh, Surface),
    "report": (Report,),
    "array": (np.ndarray,),
    "switch": (bool,),
    "number": (int, float),
    "text": (str,),
}
"""Families of types, each with a colour of its own; the first that a type is of counts."""


class Catalogue:
    """The nodes there are, and whether an output fits an input, by the names of types."""

    def __init__(self) -> None:
        load_library()
        self.types: list[str] = []
        self._hints: list[Hint] = []
        self._known: dict[str, int] = {}
        self.nodes = {
            node.name: self.described(node)
            for node in sorted(REGISTRY.values(), key=lambda each: (each.category, each.name))
        }

    def content(self) -> dict[str, Any]:
        """All nodes; the types by number; of each type the numbers of those that it fits."""
        return {
            "nodes": self.nodes,
            "types": self.types,
            "families": [family_of(hint) for hint in self._hints],
            "fits": [
                [i for i, target in enumerate(self._hints) if fits(source, target)]
                for source in self._hints
            ],
        }

    def described(self, node: Node) -> dict[str, Any]:
        """A node as the page knows it."""
        return {
            "name": node.name,
            "category": node.category,
            "summary": node.summary,
            "help": node.help,
            "writes": node.is_writer,
            "inputs": [self._input(port) for port in node.inputs.values()],
            "outputs": [self._port(port) for port in node.outputs.values()],
        }

    def _port(self, port: Port) -> dict[str, Any]:
        name = type_name(port.type)
        if name not in self._known:
            self._known[name] = len(self.types)
            self.types.append(name)
            self._hints.append(port.type)
        facts = {"name": port.name, "type": self._known[name], "help": port.help}
        return {**facts, "unit": port.unit} if port.unit else facts

    def _input(self, port: Port) -> dict[str, Any]:
        facts: dict[str, Any] = {**self._port(port), "field": field_of(port)}
        if port.default is REQUIRED:
            facts["required"] = True
        else:
            with suppress(GraphError):
                facts["default"] = encode(port.default)
        limits = {"min": port.min, "max": port.max}
        facts |= {name: limit for name, limit in limits.items() if limit is not None}
        choices = choices_of(port)
        if choices:
            facts["choices"] = list(choices)
        facts |= {name: True for name in ("reads", "writes") if getattr(port, name)}
        if port.graph_units:
            facts["graph_units"] = True
        return facts


def choices_of(port: Port) -> tuple[Any, ...]:
    """The values that an input takes, if these are few."""
    if port.choices:
        return port.choices
    found = [x for m in members(port.type) if m.kind is Literal for x in get_args(m.hint)]
    others = [m for m in members(port.type) if m.kind not in (Literal, type(None))]
    return () if others else tuple(found)


def field_of(port: Port) -> str:
    """How a value is given by hand: the kind of its field, empty if it only comes by wire."""
    if port.reads or port.writes:
        return "file"
    if choices_of(port):
        return "choice"
    kinds = [member.kind for member in members(port.type)]
    for name, kind in (("switch", bool), ("whole", int), ("number", float), ("text", str)):
        if kind in kinds:
            return name
    is_list = any(kind in (list, tuple, np.ndarray) for kind in kinds)
    return "list" if is_list and _is_short(port.type) else ""


def _is_short(hint: Hint) -> bool:
    """Whether a list or an array is short enough to be typed: one of a few numbers."""
    for member in members(hint):
        if member.kind is np.ndarray and member.facts is not None:
            return all(isinstance(size, int) and size <= 5 for size in member.facts.shape)
    return all(member.kind is not np.ndarray for member in members(hint)) and not any(
        is_subclass(argument, (Mesh, Report), undecided=False)
        for member in members(hint)
        for argument in get_args(member.hint)
    )


def family_of(hint: Hint) -> str:
    """The family of a type, which gives ports and wires their colour."""
    kinds = [member.kind for member in members(hint)]
    for family, classes in _FAMILIES.items():
        if any(is_subclass(kind, classes, undecided=False) for kind in kinds):
            return family
    return "choice" if Literal in kinds else "other"


def unknown_ports(names: Iterable[str]) -> list[dict[str, Any]]:
    """Ports of a node that is not known: those that the graph uses."""
    return [{"name": name, "type": -1, "help": "", "field": ""} for name in names]
