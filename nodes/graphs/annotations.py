"""Annotations as they are read: alternatives, elements, what arrays hold, and names."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeAlias,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

import numpy as np

# What no narrower word describes: a value on its way through a port, and an annotation.
Value: TypeAlias = Any
Hint: TypeAlias = Any


_NAMES: dict[Hint, str] = {NoneType: "None", os.PathLike: "path"}


@dataclass(frozen=True)
class ArrayFacts:
    """What an array holds, as a fact in ``Annotated``.

    A wire between two arrays that both say it is refused if shapes or kinds of numbers differ;
    an array that does not say it fits all others.

    Attributes
    ----------
    holds : str
        In the words of a message: ``"spheres of vertices"``.
    shape : tuple of str or int
        Along each axis a number, or a letter: one entry per vertex (V), edge (E), face (F) and
        so on; N is any of them.
    """

    holds: str
    shape: tuple[str | int, ...]

    def __str__(self) -> str:
        comma = "," if len(self.shape) == 1 else ""
        return f"{self.holds} ({', '.join(map(str, self.shape))}{comma})"


class Member(NamedTuple):
    """One alternative of an annotation: itself, its class, and what it says of an array."""

    hint: Hint
    kind: Hint
    facts: ArrayFacts | None = None


def element_type(hint: Hint) -> Hint:
    """Type of the elements of a list.

    Returns
    -------
    type
        ``Any`` if the annotation does not say.

    Examples
    --------
    >>> element_type(list[float])
    <class 'float'>
    """
    for member in members(hint):
        arguments = set(get_args(member.hint)) - {...}
        is_list = member.kind is not np.ndarray and is_subclass(member.kind, Iterable)
        if is_list and not is_subclass(member.kind, Mapping) and len(arguments) == 1:
            return arguments.pop()
    return Any


def type_name(hint: Hint) -> str:
    """A type in the words of a message.

    Returns
    -------
    str
        Short and without module names.

    Examples
    --------
    >>> type_name(float | None), type_name(Literal["a", "b"])
    ('float or None', "'a' or 'b'")
    """
    return " or ".join(dict.fromkeys(_name(member) for member in members(hint)))


def _name(member: Member) -> str:
    if member.facts:
        return str(member.facts)
    if member.kind is Literal:
        return " or ".join(map(repr, get_args(member.hint)))
    if member.kind is np.ndarray:
        scalar = scalar_type(member)
        return "array" if scalar is None else f"{np.dtype(scalar).name} array"
    if member.kind in _NAMES:
        return _NAMES[member.kind]
    name = getattr(member.kind, "__name__", str(member.kind))
    element, arguments = element_type(member.hint), get_args(member.hint)
    if member.kind is tuple and arguments and ... not in arguments:
        return f"{name} of {len(arguments)}"
    return name if element is Any else f"{name} of {type_name(element)}"


def members(hint: Hint, facts: ArrayFacts | None = None) -> tuple[Member, ...]:
    """The alternatives that an annotation stands for, seen through names and type variables.

    Parameters
    ----------
    facts : ArrayFacts, optional
        What was said around it.

    Returns
    -------
    tuple of Member
        One, or those of a union.
    """
    if type(hint) is type:  # by far the most: one that stands for itself
        return (Member(hint, hint, facts),)
    origin = get_origin(hint)
    if isinstance(hint, TypeVar):
        inside = hint.__constraints__ or (hint.__bound__ or Any,)
    elif hasattr(hint, "__supertype__"):
        inside = (hint.__supertype__,)
    elif hasattr(origin or hint, "__value__"):
        inside = (_alias_value(hint),)
    elif origin is Annotated:
        kind, *said = get_args(hint)
        inside = (kind,)
        facts = next((fact for fact in said if isinstance(fact, ArrayFacts)), facts)
    elif origin in (Union, UnionType):
        inside = get_args(hint)
    else:
        hint = NoneType if hint is None else hint
        return (Member(hint, origin or hint, facts),)
    return tuple(member for option in inside for member in members(option, facts))


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


def scalar_type(member: Member) -> Hint:
    """The scalar type of ``NDArray[...]``: None if it is not said, or abstract."""
    arguments = get_args(member.hint)
    scalar = get_args(arguments[1]) if len(arguments) == 2 else ()
    return scalar[0] if scalar and scalar[0] in np.sctypeDict.values() else None


def is_subclass(kind: Hint, base: Hint, *, undecided: bool = True) -> bool:
    """Whether values of one class are values of another.

    Parameters
    ----------
    undecided : bool
        The answer for what is no class, such as the signature of a callable.

    Returns
    -------
    bool
        Whether `issubclass` says so.
    """
    try:
        return issubclass(kind, base)
    except TypeError:
        return undecided
