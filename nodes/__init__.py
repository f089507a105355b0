"""Typed functions as nodes, and the lazy graph that runs them.

All nodes of the library can be imported from here by name or with ``*``: as functions that
check what they are given.

direct_calls  Nodes called as plain functions: their arguments are checked as a graph's are.
graphs        The framework: typed functions as nodes, and the lazy graph that runs them.
library       The nodes: what they are given is turned into calls of the kernel.
"""

from collections.abc import Callable
from typing import Any

from ..kernel.progress import listen
from .direct_calls import checked
from .graphs.errors import GraphError, NodeError
from .graphs.graph import Graph
from .graphs.node import (
    REGISTRY,
    Node,
    NodeWarning,
    find_node,
    load_library,
    node,
    progress,
    warn,
)
from .graphs.ports import Port, ReadPath, Units, WritePath
from .graphs.running.events import Event, RunCancelledError
from .graphs.specification.wires import each
from .graphs.stores.disk import DiskStore
from .graphs.stores.memory import MemoryStore
from .graphs.sweeps.sweep import sweep

__all__ = [
    "DiskStore",
    "Event",
    "Graph",
    "GraphError",
    "MemoryStore",
    "Node",
    "NodeError",
    "NodeWarning",
    "Port",
    "ReadPath",
    "RunCancelledError",
    "Units",
    "WritePath",
    "each",
    "find_node",
    "node",
    "progress",
    "sweep",
    "warn",
]

listen(progress)  # long computations of the kernel tell it of the node that runs them

# The nodes are found when first asked for, by the registry: a new function in a module of
# nodes/library needs no line here, and `import spheremesh` does not import the library.
# For static analysis every other name of this package is a callable; who wants its full
# signature imports it from its own module, such as spheremesh.nodes.library.spheres.
_FRAMEWORK = tuple(__all__)
del __all__  # from here on __getattr__ answers for it, with the nodes of the library added


def _library_nodes() -> dict[str, Node]:
    load_library()
    inside = f"{__name__}.library."
    return {n: r for n, r in REGISTRY.items() if r.function.__module__.startswith(inside)}


def __getattr__(name: str) -> Callable[..., Any]:
    if name == "__all__":
        return [*_FRAMEWORK, *sorted(_library_nodes())]  # pyright: ignore[reportReturnType]
    if not name.startswith("_"):
        nodes = _library_nodes()
        if name in nodes:
            return checked(nodes[name])
    raise AttributeError(f"module {__name__!r} has no node {name!r}")


def __dir__() -> list[str]:
    return [*_FRAMEWORK, *sorted(_library_nodes())]
