"""Which components there are: nodes, and the graphs of a folder."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import Lock
from typing import Any, Final

import numpy as np

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.circles import Circles
from ...kernel.surfaces.surface import Surface
from ...nodes.graphs.annotations import Value
from ...nodes.graphs.errors import GraphError
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.node import REGISTRY, Node, load_library
from ...nodes.graphs.ports import Port
from ...nodes.graphs.specification.file import FORMAT
from ...nodes.graphs.stores.digests import FileState, file_state
from .components import Component, Input, component_of, shown_output
from .description import describe, to_json
from .guard import check_graph_files
from .parameters import CODED, Carrier
from .trees import Item
from .values_out import AXES, POINTS, SHAPES, Exchange, Shape

_HEAD: Final = 4096
"""Bytes of a file in which it says that it is a graph."""


@dataclass(frozen=True)
class Listed:
    """A component and what Grasshopper is told of it."""

    component: Component
    description: dict[str, Any]
    body: bytes


@dataclass
class Catalogue:
    """The components of a server: those of nodes as they were when it began, and graph files.

    Attributes
    ----------
    graphs : Path, optional
        Folder of graph files; looked at anew with every request.
    files : Path, optional
        Folder that nodes may read from and write to.
    """

    graphs: Path | None = None
    files: Path | None = None
    _nodes: dict[str, Listed] = field(default_factory=dict[str, Listed])
    _graphs: dict[Path, tuple[FileState, Listed]] = field(
        default_factory=dict[Path, tuple[FileState, Listed]]
    )
    _lock: Lock = field(default_factory=Lock)

    def __post_init__(self) -> None:
        load_library()
        for node in sorted(REGISTRY.values(), key=lambda each: (each.category, each.name)):
            component = component_of(node, with_files=self.files is not None)
            if component is not None:
                self._nodes[component.name] = _listed(component)
        self._nodes["show"] = _listed(show_component())

    def all(self) -> list[Listed]:
        """All components: nodes by chapter, then graphs."""
        return [*self._nodes.values(), *self._graph_components()]

    def find(self, name: str) -> Listed | None:
        """The component of a name, if there is one."""
        found = self._nodes.get(name)
        if found is not None:
            return found
        return next((x for x in self._graph_components() if x.component.name == name), None)

    def names(self) -> list[str]:
        """The names of all components."""
        return [each.component.name for each in self.all()]

    def _graph_components(self) -> Iterator[Listed]:
        if self.graphs is None:
            return
        taken = set(self._nodes)
        for path in sorted(self.graphs.glob("*.json")):
            listed = self._graph(path)
            if listed is None or path.name.startswith("."):
                continue
            name = component_name(path.stem, taken)
            taken.add(name)
            yield listed if listed.component.name == name else _renamed(listed, name)

    def _graph(self, path: Path) -> Listed | None:
        """The component of a file, made anew when the file has changed; None for no graph."""
        state = file_state(path)
        with self._lock:
            known = self._graphs.get(path)
            if known is not None and known[0] == state:
                return known[1]
            if not _is_graph(path):
                return None
            listed = _listed(graph_component(path, self.files))
            self._graphs[path] = state, listed
            return listed


def _renamed(listed: Listed, name: str) -> Listed:
    return _listed(replace(listed.component, name=name))


def _listed(component: Component) -> Listed:
    description = describe(component)
    return Listed(component, description, to_json(description))


def component_name(text: str, taken: set[str]) -> str:
    """A name that can stand in an address, and that no other component has.

    Examples
    --------
    >>> component_name("roof 2", set()), component_name("panels", {"panels"})
    ('roof_2', 'graph_panels')
    """
    name = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_")
    if not name or name[0].isdigit() or name in taken:
        name = f"graph_{name}".rstrip("_")
    base, number = name, 2
    while name in taken:
        name, number = f"{base}_{number}", number + 1
    return name


def _is_graph(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return FORMAT.encode() in file.read(_HEAD)
    except OSError:
        return False


def graph_component(path: Path, files: Path | None) -> Component:
    """The component of a graph file: its sliders are the inputs, its ends the outputs.

    Parameters
    ----------
    path : Path
    files : Path, optional
        Folder that its steps may read from and write to.

    Returns
    -------
    Component
        Without inputs and outputs, and with a fault, if it cannot be run.
    """
    name = component_name(path.stem, set())
    try:
        graph = Graph.load(path)
        check_graph_files(graph.specification, files)
        node = graph.as_node(name)
        made = component_of(node, with_files=files is not None, name=name)
    except (GraphError, InputError, OSError) as error:
        return _broken(name, f"{path.name}: {error}")
    fault = f"{path.name}: it needs files; start the server with --files"
    return _broken(name, fault) if made is None else made


def _broken(name: str, fault: str) -> Component:
    summary = "A graph that cannot be run."
    node = Node(name, _same, "1", "graphs", summary, "", {}, {}, object)
    return Component(name, node, (), (), "graphs", fault)


def _same(handle: Value) -> Value:
    return handle


def show_component() -> Component:
    """The component that shows what a handle stands for, however much it is."""
    port = Port(name="handle", help="What is to be shown")
    result = Port(name="result", help="what the handle stands for")
    node = Node(
        "show", _same, "1", "show", "What a handle stands for, as geometry.", "",
        {"handle": port}, {"result": result}, object,
    )  # fmt: skip
    outputs = [shown_output(shape, result, 0, kinds) for shape, kinds in _everything()]
    handle = Input("handle", port, Carrier(CODED, ()), 1, 1)
    return Component("show", node, (handle,), tuple(outputs), "show", shows_all=True)


def _everything() -> Iterator[tuple[Shape, tuple[type, ...]]]:
    """Every way to show a value, and the classes that are shown so."""
    breps = [kind for kind, shape in SHAPES.items() if shape.param_type == "Brep"]

    def _breps(value: Value, exchange: Exchange, where: str) -> list[Item]:
        return SHAPES[type(value)].encode(value, exchange, where)

    def _mesh(value: Value, exchange: Exchange, where: str) -> list[Item]:
        mesh = value if isinstance(value, Mesh) else value.mesh
        return SHAPES[Mesh].encode(mesh, exchange, where)

    yield Shape("breps", "Brep", _breps), tuple(breps)
    yield SHAPES[Arcs], (Arcs, Circles)
    yield AXES, (np.ndarray,)
    yield Shape("mesh", "Mesh", _mesh), (Mesh, SphereMesh, Surface)
    yield POINTS, (np.ndarray,)
