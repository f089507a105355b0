"""Nodes called as plain functions: what they are given is checked as a graph checks it.

The functions of the library stay as they were written, and call each other unchecked. What
`spheremesh.nodes` hands out has the checks in front: a few microseconds for the usual types.
"""

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache, wraps
from types import NoneType
from typing import Any, Literal, NoReturn, cast, get_args

import numpy as np

from ..kernel.errors import ArgumentError
from ..kernel.meshes.mesh import Mesh
from .graphs.annotations import Hint, Value, members, type_name
from .graphs.errors import GraphError, nearest
from .graphs.kinds import accepts, convert
from .graphs.node import REGISTRY, Node
from .graphs.ports import REQUIRED, Port, brief, check_range
from .graphs.specification.wires import Each, Param, Step, Wire

_PLAIN = (str, int, float, bool, NoneType)
_BRIEF = (*_PLAIN, np.ndarray, list, tuple)
_NUMBERS: Mapping[Hint, tuple[type, ...]] = {float: (float, int), int: (int,), str: (str,)}
_FOREIGN = {"trimesh": "from_trimesh", "pyvista": "from_pyvista", "compas": "from_compas"}
"""Libraries whose meshes are known, and the constructor of `Mesh` that reads them."""


@cache
def checked(node: Node) -> Callable[..., Any]:
    """The function of a node, what it is given checked first.

    Parameters
    ----------
    node : Node
        Of the library.

    Returns
    -------
    callable
        The same one each time. It raises `ArgumentError` with one line that says what the
        right call is.
    """
    function, ports = node.function, node.inputs
    positional = _positional(function)
    quick = {name: _quick_types(port) for name, port in ports.items()}

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:  # noqa: ANN401 # numpydoc ignore=GL08
        if len(args) > len(positional) or not kwargs.keys() <= ports.keys():
            _refuse_call(node, args, kwargs)
        given = dict(zip(positional, args, strict=False))
        if given.keys() & kwargs.keys():
            _refuse_call(node, args, kwargs)
        given |= kwargs
        for name, value in given.items():
            port = ports[name]
            if value is port.default:
                continue
            if type(value) not in quick[name]:
                given[name] = _in_its_form(node, port, value, given)
            elif port.min is not None or port.max is not None:
                _check_range(node, port, value)
        if any(port.default is REQUIRED and name not in given for name, port in ports.items()):
            _refuse_call(node, args, kwargs)
        return function(**given)

    # Found again by name, as pickle does it, where it was handed out.
    call.__module__ = __name__.rpartition(".")[0]
    return call


def _positional(function: Callable[..., Any]) -> tuple[str, ...]:
    parameters = inspect.signature(function).parameters.values()
    return tuple(p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD)


def _quick_types(port: Port) -> frozenset[type]:
    """Types whose values need no further look: records, numbers, texts, None."""
    found: set[type] = set()
    for member in members(port.type):
        kind = member.kind
        if kind in _NUMBERS:
            found.update(_NUMBERS[kind])
        elif isinstance(kind, type) and (is_dataclass(kind) or kind is NoneType):
            found.add(kind)
    return frozenset(found)


def _in_its_form(node: Node, port: Port, value: Value, given: Mapping[str, Value]) -> Value:
    """A value of no usual type as the function expects it: lists become arrays."""
    if not accepts(port.type, value):
        _refuse(node, port, value, given)
    if isinstance(value, np.number):
        _check_range(node, port, value)
    return convert(port.type, value)


def _check_range(node: Node, port: Port, value: Value) -> None:
    try:
        check_range(value, port, f"{node.name}: {port.name}")
    except GraphError as error:
        raise ArgumentError(str(error)) from None


def _refuse_call(node: Node, args: tuple[Value, ...], kwargs: Mapping[str, Value]) -> NoReturn:
    """Say which input is missing, unknown, given twice or one too many."""
    ports, positional = node.inputs, _positional(node.function)
    for name in kwargs:
        if name not in ports:
            raise ArgumentError(f"{node.name} has no input {name!r}; {nearest(name, ports)}")
    if len(args) > len(positional):
        rest = [name for name in ports if name not in positional]
        by_name = f"; by name only: {', '.join(rest)}" if rest else ""
        raise ArgumentError(
            f"{node.name} takes at most {len(positional)} inputs without a name, not "
            f"{len(args)}: {', '.join(positional)}{by_name}"
        )
    given = positional[: len(args)]
    for name in given:
        if name in kwargs:
            raise ArgumentError(f"{node.name}: {name} is given twice, in place and by name")
    missing = [
        n for n, p in ports.items() if p.default is REQUIRED and n not in {*given, *kwargs}
    ]
    kinds = ", ".join(f"{name} ({type_name(ports[name].type)})" for name in missing)
    raise ArgumentError(f"{node.name} misses {kinds}")


def _refuse(node: Node, port: Port, value: Value, given: Mapping[str, Value]) -> NoReturn:
    """Say what an input must be, what it is, and what the right call is."""
    is_brief = issubclass(type(value), _BRIEF) and not hasattr(value, "_fields")
    shown = brief(value) if is_brief else type(value).__name__
    advice = next(_advice(node, port, value, given), "")
    raise ArgumentError(
        f"{node.name}: {port.name} must be {_wanted(port)}, not {shown}"
        + (f": {advice}" if advice else "")
    )


def _wanted(port: Port) -> str:
    choices = _choices(port)
    return f"one of {', '.join(map(repr, choices))}" if choices else type_name(port.type)


def _choices(port: Port) -> list[Value]:
    """Values of an input that takes some only."""
    kinds = members(port.type)
    if not all(member.kind in (Literal, NoneType) for member in kinds):
        return []
    return [choice for member in kinds for choice in get_args(member.hint)]


def _advice(node: Node, port: Port, value: Value, given: Mapping[str, Value]) -> Iterator[str]:
    """What may be meant, the likeliest first."""
    if isinstance(value, Each | Param | Step | Wire):
        yield f"in a graph call graph.add({node.name}, {port.name}=...)"
    if inspect.isfunction(value) or isinstance(value, type):
        yield f"{value.__name__} itself was given, call it: {value.__name__}(...)"
    yield from (f"give its .{name}" for name, item in _parts(value) if accepts(port.type, item))
    free = [other for other in node.inputs.values() if other.name not in given]
    makers = list(_makers(port.type, value))
    maker = f", or make one with {makers[0]}" if makers else ""
    if not isinstance(value, _PLAIN):
        yield from (
            f"give it as {other.name}=...{maker}"
            for other in free
            if accepts(other.type, value)
        )
    yield from (
        f"give its .{name} as {other.name}=..."
        for name, item in _parts(value)
        for other in free
        if accepts(other.type, item) and is_dataclass(item)
    )
    yield from _mesh_advice(port, value)
    if isinstance(value, str) and _choices(port):
        said = nearest(value, map(str, _choices(port)))
        yield from [said] * said.startswith("did")
    if makers:
        yield f"make one with {' or '.join(makers[:4])}"


def _parts(value: Value) -> Iterator[tuple[str, Value]]:
    """Fields, if they have a value, of a result with several outputs or of a record."""
    names: list[str] = list(getattr(value, "_fields", ()))
    kind = cast("type[Any]", type(value))
    if is_dataclass(kind):
        names = [field.name for field in fields(kind)]
    found = [(name, getattr(value, name)) for name in names]
    yield from ((name, item) for name, item in found if item is not None)


def _mesh_advice(port: Port, value: Value) -> Iterator[str]:
    """How what other libraries hold becomes a mesh."""
    if not any(member.kind is Mesh for member in members(port.type)):
        return
    reader = _FOREIGN.get(type(value).__module__.partition(".")[0])
    if reader is not None:
        yield f"make a mesh of it with Mesh.{reader}(...)"
    if isinstance(value, tuple | list) and len(cast("tuple[Any, ...]", value)) == 2:
        yield "make a mesh of it with Mesh(vertices, faces)"


def _makers(wanted: Hint, value: Value) -> Iterator[str]:
    """Calls of nodes that make what is wanted of a value and no other object."""
    kinds = {m.kind for m in members(wanted) if is_dataclass(m.kind)}
    for node in sorted(REGISTRY.values(), key=lambda node: len(node.inputs)):
        needed = [port for port in node.inputs.values() if port.default is REQUIRED]
        if not needed or not _is_of(needed[0].type, value):
            continue
        rest = [port for port in needed[1:] if port.type not in _NUMBERS]
        makes = [name for name, port in node.outputs.items() if port.type in kinds]
        if makes and not rest and value.__class__ not in kinds:
            field = f".{makes[0]}" if node.has_fields else ""
            yield f"{node.name}(...){field}"


def _is_of(hint: Hint, value: Value) -> bool:
    """Whether a value is of one of the very types: a text is none that stands for a number."""
    kinds = {member.kind for member in members(hint)}
    return type(value) in kinds or (isinstance(value, str) and bool(kinds & {str}))
