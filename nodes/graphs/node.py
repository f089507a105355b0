"""Typed functions as nodes: the signature is the ports, the docstring the help."""

import importlib
import inspect
import pkgutil
import warnings
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import (
    Any,
    TypeVar,
    get_type_hints,
    overload,
)

from .annotations import Hint
from .errors import GraphError, nearest
from .ports import Port
from .signatures import input_ports, is_named_tuple, output_ports, split_hint

Function = TypeVar("Function", bound=Callable[..., Any])


class NodeWarning(UserWarning):
    """A node has something to say about its result."""


@dataclass(frozen=True, eq=False)
class Node:
    """What is known about a registered function.

    Attributes
    ----------
    name : str
    function : callable
        The function, as it was written.
    version : str
        Changed by the author when the same inputs give another result.
    category : str
        Chapter of the library in which it stands, or the last part of the name of its module.
    summary : str
        First line of the docstring.
    help : str
    inputs, outputs : mapping of str to Port
        The ports by name, in the order of the signature.
    result_type : type
    edition : int
        How often the name was defined anew in this process, as happens in notebooks.
    inner : object
        The graph of a node that is one; None for functions.
    is_known : bool
        Whether there is such a node; what a graph file names may have gone.
    """

    name: str
    function: Callable[..., Any] = field(repr=False)
    version: str
    category: str
    summary: str
    help: str = field(repr=False)
    inputs: Mapping[str, Port] = field(repr=False)
    outputs: Mapping[str, Port] = field(repr=False)
    result_type: Hint = field(repr=False)
    edition: int = 0
    inner: Any = field(default=None, repr=False)
    is_known: bool = True

    @cached_property
    def has_fields(self) -> bool:  # numpydoc ignore=RT01
        """Whether the result is a NamedTuple, its fields the outputs."""
        return is_named_tuple(self.result_type)

    @cached_property
    def file_inputs(self) -> tuple[Port, ...]:  # numpydoc ignore=RT01
        """The inputs that are paths of files."""
        return tuple(port for port in self.inputs.values() if port.reads or port.writes)

    @cached_property
    def is_writer(self) -> bool:  # numpydoc ignore=RT01
        """Whether it writes files."""
        return any(port.writes for port in self.file_inputs)

    @cached_property
    def label(self) -> str:  # numpydoc ignore=RT01
        """Name and version."""
        return f"{self.name} {self.version}"


REGISTRY: dict[str, Node] = {}

Report = Callable[[float, str], None]

_report: ContextVar[Report | None] = ContextVar("report", default=None)
_messages: ContextVar[list[str] | None] = ContextVar("messages", default=None)
_graph_text: ContextVar[Callable[[], str] | None] = ContextVar("graph_text", default=None)


@overload
def node(function: Function, /) -> Function: ...  # numpydoc ignore=GL08
@overload
def node(  # numpydoc ignore=GL08
    *, version: str = "1"
) -> Callable[[Function], Function]: ...
def node(
    function: Callable[..., Any] | None = None, /, *, version: str = "1"
) -> Callable[..., Any]:
    """Register a typed function as a node and return it unchanged.

    Parameters
    ----------
    function : callable
        Every argument and the result are annotated.
    version : str
        To be changed when the same inputs give another result.

    Returns
    -------
    callable
        The function; with a version given, the decorator.

    Raises
    ------
    GraphError
        If the signature cannot be turned into ports, or the name is taken.
    """

    def _register(function: Function) -> Function:
        described = _describe(function, version)
        known = REGISTRY.get(described.name)
        if known is not None:
            _check_same_place(known.function, function)
            described = replace(described, edition=known.edition + 1)
        REGISTRY[described.name] = described
        return function

    return _register if function is None else _register(function)


def find_node(node: str | Callable[..., Any]) -> Node:
    """The node of a name or of a function.

    Parameters
    ----------
    node : str or callable
        A name, or a function decorated with `@node`, also as `spheremesh.nodes` gives it.

    Returns
    -------
    Node
        The record; the library is imported if the name is not known without it.

    Raises
    ------
    GraphError
        If there is no such node; the message gives the nearest name.
    """
    if not isinstance(node, str):
        name = getattr(node, "__name__", repr(node))
        found = REGISTRY.get(name)
        # The library's functions are handed out with checks of their arguments around them.
        if found is None or found.function is not inspect.unwrap(node):
            raise GraphError(
                f"{name} is not a node: decorate its present definition with @node"
            )
        return found
    if node not in REGISTRY:
        load_library()
    if node not in REGISTRY:
        raise GraphError(f"unknown node {node!r}; {nearest(node, REGISTRY)}")
    return REGISTRY[node]


def replaced(node: Node) -> tuple[str, ...]:
    """What is to be said of a step whose node has been defined anew since it was added.

    Parameters
    ----------
    node : Node

    Returns
    -------
    tuple of str
        Empty if the function is the present one.
    """
    present = REGISTRY.get(node.name, node)
    if present.function is node.function:
        return ()
    return (
        f"its function {node.name} was replaced after the step was added, and the step keeps "
        "the old one: add it again to use the new one",
    )


@cache
def load_library() -> None:
    """Import every module of the node library, which registers its nodes."""
    library = importlib.import_module("..library", __package__)
    for module in pkgutil.walk_packages(library.__path__, f"{library.__name__}."):
        importlib.import_module(module.name)


def _category(module: str) -> str:
    """Chapter of the library in which a module stands; of other modules the last name."""
    library = f"{__name__.rpartition('.graphs.')[0]}.library."
    if module.startswith(library):
        return module.removeprefix(library).partition(".")[0]
    return module.rpartition(".")[2]


def warn(text: str) -> None:
    """Say something about the result of the node that is running.

    Parameters
    ----------
    text : str
        One sentence. It goes to Python warnings and, within a graph, to `Graph.messages`.
    """
    messages = _messages.get()
    if messages is not None:
        messages.append(text)
    warnings.warn(text, NodeWarning, stacklevel=2)


def progress(share: float, text: str = "") -> None:
    """Say how far the node that is running has come; a run that was called off ends here.

    Parameters
    ----------
    share : float
        From 0 to 1.
    text : str
        What it does, in a few words.
    """
    report = _report.get()
    if report is not None:
        report(share, text)


@contextmanager
def reporting_to(report: Report) -> Generator[None]:
    """Let nodes say how far they have come.

    Parameters
    ----------
    report : callable
        Given the share and a text, from the thread of the node.

    Yields
    ------
    None
        While the block runs, `progress` calls it.
    """
    token = _report.set(report)
    try:
        yield
    finally:
        _report.reset(token)


def running_graph() -> str:
    """The graph that is running, for files that carry how they were made.

    Returns
    -------
    str
        Its JSON; empty outside of a graph, or where it has values that JSON cannot hold.
    """
    text = _graph_text.get()
    try:
        return "" if text is None else text()
    except GraphError:
        return ""


@contextmanager
def known_graph(text: Callable[[], str]) -> Generator[None]:
    """Let nodes ask for the graph that runs them.

    Parameters
    ----------
    text : callable
        Gives the graph as JSON.

    Yields
    ------
    None
        While the block runs, `running_graph` answers.
    """
    token = _graph_text.set(text)
    try:
        yield
    finally:
        _graph_text.reset(token)


@contextmanager
def collected_messages() -> Generator[list[str]]:
    """Collect what nodes warn about.

    Yields
    ------
    list of str
        Grows while the block runs.
    """
    messages: list[str] = []
    token = _messages.set(messages)
    try:
        yield messages
    finally:
        _messages.reset(token)


def _check_same_place(known: Callable[..., Any], new: Callable[..., Any]) -> None:
    if (known.__module__, known.__qualname__) != (new.__module__, new.__qualname__):
        raise GraphError(
            f"two nodes are called {new.__name__!r}: {known.__module__}.{known.__qualname__} "
            f"and {new.__module__}.{new.__qualname__}; rename one"
        )


def _describe(function: Callable[..., Any], version: str) -> Node:
    name = function.__name__
    try:
        hints = get_type_hints(function, include_extras=True)
    except NameError as error:
        raise GraphError(f"node {name}: an annotation cannot be resolved: {error}") from error
    if "return" not in hints:
        raise GraphError(f"node {name}: annotate its result")
    doc = inspect.getdoc(function) or ""
    result = hints["return"]
    return Node(
        name=name,
        function=function,
        version=version,
        category=_category(function.__module__),
        summary=doc.partition("\n")[0],
        help=doc,
        inputs=input_ports(function, hints, doc),
        outputs=output_ports(name, result, doc),
        result_type=split_hint(result)[0],
    )
