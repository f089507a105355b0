"""Ports: what an input or output of a node accepts, and the checks made when it is wired."""

import inspect
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Complex, Integral, Real
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    TypeAlias,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
)

import numpy as np

from .errors import GraphError

# What no narrower word describes: a value on its way through a port, and an annotation.
Value: TypeAlias = Any
Hint: TypeAlias = Any

REQUIRED = inspect.Parameter.empty
UNITS = ("mm", "cm", "m", "in", "ft")


@dataclass(frozen=True, eq=False)
class Port:
    """
    Facts about one input or output of a node.

    In a signature only what the annotation cannot say is given, for example
    ``Annotated[float, Port(unit="deg", min=0, max=90)]``; `@node` fills in the rest.

    Attributes
    ----------
    name : str
        Name of the port: of the argument, or of the field of the result.
    type : type
        Annotation without the facts.
    default : object
        Value of an input that is not wired; ``REQUIRED`` if there is none.
    help : str
        What it is; by default the text of the docstring.
    unit : str
        Unit of a number, such as ``"deg"``; empty for model units or pure numbers.
    min, max : float, optional
        Range of a number, the ends included.
    choices : tuple, optional
        The values allowed.
    reads : bool
        A path that the node reads: it runs again when the file has changed.
    writes : bool
        A path that the node writes: it runs again when the file is gone or has changed.
    graph_units : bool
        When not wired, the input is the units of the graph.
    """

    name: str = ""
    type: Any = Any
    default: Any = REQUIRED
    help: str = ""
    unit: str = ""
    min: float | None = None
    max: float | None = None
    choices: tuple[Any, ...] = ()
    reads: bool = False
    writes: bool = False
    graph_units: bool = False


ReadPath: TypeAlias = Annotated[str | os.PathLike[str], Port(reads=True)]
WritePath: TypeAlias = Annotated[str | os.PathLike[str], Port(writes=True)]
Units: TypeAlias = Annotated[Literal["mm", "cm", "m", "in", "ft"], Port(graph_units=True)]


def check_value(port: Port, value: object, where: str) -> None:
    """
    Refuse a value that an input does not accept.

    Parameters
    ----------
    port : Port
        The input.
    value : object
        The value for it.
    where : str
        How the message names the input, ``"step.port"``.

    Raises
    ------
    GraphError
        If the type, the range or the choice is wrong; the message says what is allowed.
    """
    if not accepts(port.type, value):
        raise GraphError(f"{where} = {_brief(value)}: must be {type_name(port.type)}")
    check_range(value, port, where)


def check_range(value: object, port: Port, where: str) -> None:
    """
    Refuse a number out of range, or a value that is none of the choices.

    Parameters
    ----------
    value : object
        The value.
    port : Port
        Holds the range and the choices.
    where : str
        How the message names the place.

    Raises
    ------
    GraphError
        The message says what is allowed.
    """
    if port.choices and value is not None and value not in port.choices:
        allowed = ", ".join(map(repr, port.choices))
        raise GraphError(f"{where} = {_brief(value)}: must be one of {allowed}")
    if not isinstance(value, int | float | np.integer | np.floating) or _is_bool(value):
        return
    low, high = port.min, port.max
    # written so that a NaN is outside of every range
    if (low is not None and not value >= low) or (high is not None and not value <= high):
        parts = [f"at least {low}"] * (low is not None) + [f"at most {high}"] * (
            high is not None
        )
        unit = f" {port.unit}" if port.unit else ""
        raise GraphError(f"{where} = {value}: must be {' and '.join(parts)}{unit}")


def convert(port: Port, value: Value) -> Value:
    """
    The value in the form that the function expects: lists become arrays, texts paths.

    Parameters
    ----------
    port : Port
        The input.
    value : object
        A value that it accepts.

    Returns
    -------
    object
        The value itself if it is of the annotated type.
    """
    kinds = [get_origin(member) or member for member in _members(port.type)]
    if any(isinstance(kind, type) and _is_instance(value, kind) for kind in kinds):
        return value
    if isinstance(value, list) and tuple in kinds:
        return tuple(cast("Sequence[Value]", value))
    if isinstance(value, list | tuple) and np.ndarray in kinds:
        numbers = cast("Sequence[Value]", value)
        return cast("Value", np.asarray(numbers, _array_dtype(port.type)))
    if isinstance(value, str) and Path in kinds:
        return Path(value)
    if isinstance(value, os.PathLike) and str in kinds:
        return os.fspath(cast("os.PathLike[str]", value))
    return cast("Value", value)


def accepts(kind: Hint, value: Value) -> bool:
    """
    Whether a value may go into an input of a type.

    Parameters
    ----------
    kind : type
        An annotation.
    value : object
        A value.

    Returns
    -------
    bool
        True also where the annotation cannot be decided at run time.

    Examples
    --------
    >>> accepts(float, 1), accepts(int, 1.5), accepts(int | None, None)
    (True, False, True)
    """
    return any(_accepts_member(member, value) for member in _members(kind))


def _accepts_member(member: Hint, value: Value) -> bool:
    origin = get_origin(member) or member
    if origin in _ACCEPTS:
        return _ACCEPTS[origin](member, value)
    if origin in (Sequence, Iterable) and isinstance(value, str | np.ndarray):
        return not isinstance(value, str)
    if not _is_instance(value, origin):
        return False
    if isinstance(value, list | tuple):
        element = element_type(member)
        return all(accepts(element, item) for item in cast("Sequence[Value]", value))
    return True


def fits(source: Hint, target: Hint) -> bool:
    """
    Whether an output of one type may be wired into an input of another.

    Parameters
    ----------
    source : type
        Annotation of the output.
    target : type
        Annotation of the input.

    Returns
    -------
    bool
        False only if no value of the source could be accepted.

    Examples
    --------
    >>> fits(int, float), fits(float, int), fits(str, float | None)
    (True, False, False)
    """
    return any(_fits_member(a, b) for a in _members(source) for b in _members(target))


def _fits_member(source: Hint, target: Hint) -> bool:
    a, b = get_origin(source) or source, get_origin(target) or target
    if a is Literal:
        return any(accepts(target, option) for option in get_args(source))
    if a is Any or source == target:
        return True
    if b in _FITS:
        return _FITS[b](source, target)
    if b in (Sequence, Iterable) and a in (str, np.ndarray):
        return a is np.ndarray
    if not _is_subclass(a, b):
        return False
    return not _is_subclass(b, Sequence) or fits(element_type(source), element_type(target))


def element_type(kind: Hint) -> Hint:
    """
    Type of the elements of a list.

    Parameters
    ----------
    kind : type
        Annotation of the list.

    Returns
    -------
    type
        ``Any`` if the annotation does not say.

    Examples
    --------
    >>> element_type(list[float])
    <class 'float'>
    """
    for member in _members(kind):
        origin, arguments = get_origin(member), set(get_args(member)) - {...}
        is_list = _is_subclass(origin, Iterable) and origin not in (None, np.ndarray)
        if is_list and not _is_subclass(origin, Mapping) and len(arguments) == 1:
            return arguments.pop()
    return Any


def type_name(kind: Hint) -> str:
    """
    A type in the words of a message.

    Parameters
    ----------
    kind : type
        An annotation.

    Returns
    -------
    str
        Short and without module names.

    Examples
    --------
    >>> type_name(float | None), type_name(Literal["a", "b"])
    ('float or None', "'a' or 'b'")
    """
    return " or ".join(dict.fromkeys(_member_name(member) for member in _members(kind)))


def _member_name(member: Hint) -> str:
    origin = get_origin(member) or member
    if origin is Literal:
        return " or ".join(map(repr, get_args(member)))
    if origin is np.ndarray:
        dtype = _array_dtype(member)
        return "array" if dtype is None else f"{np.dtype(dtype).name} array"
    if origin is NoneType:
        return "None"
    if origin is os.PathLike:
        return "path"
    name = getattr(origin, "__name__", str(origin))
    element = element_type(member)
    if origin is tuple and ... not in get_args(member) and get_args(member):
        return f"{name} of {len(get_args(member))}"
    return name if element is Any else f"{name} of {type_name(element)}"


def _members(kind: Hint) -> tuple[Any, ...]:
    """The alternatives that an annotation stands for, without facts and type variables."""
    if isinstance(kind, TypeVar):
        options = kind.__constraints__ or (kind.__bound__ or Any,)
        return tuple(member for option in options for member in _members(option))
    if hasattr(kind, "__supertype__"):
        return _members(kind.__supertype__)
    if hasattr(get_origin(kind) or kind, "__value__"):
        return _members(_alias_value(kind))
    if get_origin(kind) is Annotated:
        return _members(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return tuple(member for option in get_args(kind) for member in _members(option))
    return (NoneType if kind is None else kind,)


def _alias_value(alias: Hint) -> Hint:
    """What a `type` statement stands for, such as the ``NDArray[...]`` of numpy 2.5."""
    name = get_origin(alias) or alias
    if not all(isinstance(parameter, TypeVar) for parameter in name.__type_params__):
        return Any  # *Ts, **P
    given = dict(zip(name.__type_params__, get_args(alias), strict=False))
    value = name.__value__
    if isinstance(value, TypeVar):
        return given.get(value, value)
    free = tuple(given.get(x, x) for x in getattr(value, "__parameters__", ()))
    return value[free] if free else value


def _anything(_kind: Hint, _value: Value) -> bool:
    return True


def _is_bool(value: Value) -> bool:
    return isinstance(value, bool | np.bool_)


def _is_choice(member: Hint, value: Value) -> bool:
    return any(value == x and _is_bool(value) == _is_bool(x) for x in get_args(member))


def _is_numeric(value: Value) -> bool:
    """Whether it is an array or could become one."""
    if isinstance(value, list | tuple):
        return all(
            isinstance(item, Complex) or _is_numeric(item)
            for item in cast("Sequence[Value]", value)
        )
    return isinstance(value, np.ndarray)


def _is_numeric_type(kind: Hint) -> bool:
    origin = get_origin(kind) or kind
    if kind is Any or origin in (np.ndarray, bool, int, float, complex):
        return True
    element = element_type(kind)
    return (
        isinstance(origin, type)
        and origin is not str
        and issubclass(origin, Sequence)
        and any(_is_numeric_type(member) for member in _members(element))
    )


def _is_tuple(kind: Hint, value: Value) -> bool:
    """Lists will do: JSON knows nothing else."""
    if not isinstance(value, list | tuple):
        return False
    items, elements = cast("Sequence[Value]", value), get_args(kind)
    if not elements or elements[-1] is ...:
        return all(accepts(element_type(kind), item) for item in items)
    return len(items) == len(elements) and all(map(accepts, elements, items))


def _fits_tuple(source: Hint, target: Hint) -> bool:
    is_list = _is_subclass(get_origin(source) or source, Sequence) and source is not str
    return is_list and fits(element_type(source), element_type(target))


def _kind_of(*kinds: type) -> Callable[[Hint, Value], bool]:
    """The rule that a source is one of some classes; bool is no number."""
    return lambda source, _: (
        isinstance(source, type) and issubclass(source, kinds) and source is not bool
    )


# By what is accepted: the rule for a value, and that for the type of a wire.
_ACCEPTS: dict[Hint, Callable[[Hint, Value], bool]] = {
    Any: _anything,
    object: _anything,
    Literal: _is_choice,
    bool: lambda _, value: _is_bool(value),
    int: lambda _, value: isinstance(value, Integral) and not _is_bool(value),
    float: lambda _, value: isinstance(value, Real) and not _is_bool(value),
    complex: lambda _, value: isinstance(value, Complex) and not _is_bool(value),
    np.ndarray: lambda _, value: _is_numeric(value),
    tuple: _is_tuple,
    Path: lambda _, value: isinstance(value, str | os.PathLike),
    str: lambda _, value: isinstance(value, str | os.PathLike),
}
_FITS: dict[Hint, Callable[[Hint, Hint], bool]] = {
    Any: _anything,
    object: _anything,
    Literal: lambda source, target: any(fits(source, type(x)) for x in get_args(target)),
    bool: lambda source, _: source in (bool, np.bool_),
    int: _kind_of(int, np.integer),
    float: _kind_of(int, float, np.integer, np.floating),
    complex: _kind_of(int, float, complex, np.number),
    np.ndarray: lambda source, _: _is_numeric_type(source),
    tuple: _fits_tuple,
    Path: lambda source, _: (
        source is str or _is_subclass(get_origin(source) or source, os.PathLike)
    ),
    str: lambda source, _: (
        source is str or _is_subclass(get_origin(source) or source, os.PathLike)
    ),
}


def _array_dtype(kind: Hint) -> Hint:
    """The scalar type of ``NDArray[...]`` in an annotation, None if it is not said."""
    for member in _members(kind):
        if get_origin(member) is np.ndarray:
            scalar = get_args(get_args(member)[1])
            if scalar and isinstance(scalar[0], type) and scalar[0] is not np.generic:
                return scalar[0]
    return None


def _is_instance(value: object, kind: Hint) -> bool:
    try:
        return isinstance(value, kind)
    except TypeError:  # a protocol that is not checkable, a callable's signature
        return True


def _is_subclass(kind: Hint, base: Hint) -> bool:
    try:
        return issubclass(kind, base)
    except TypeError:  # as above
        return True


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
