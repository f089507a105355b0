"""Results that nobody can change for others: arrays read-only, lists and dictionaries anew."""

from collections import deque
from collections.abc import Callable
from copy import copy
from dataclasses import fields, is_dataclass
from functools import singledispatch
from operator import is_
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from ..annotations import Value

Share: TypeAlias = Callable[[NDArray[Any]], NDArray[Any]]


def locked(array: NDArray[Any]) -> NDArray[Any]:
    """The array itself, closed for writing.

    Parameters
    ----------
    array : array
        Nobody else writes to it.

    Returns
    -------
    array
        `array`.
    """
    array.flags.writeable = False
    return array


def snapshot(array: NDArray[Any]) -> NDArray[Any]:
    """An array as it is now, although somebody may still write to it.

    Parameters
    ----------
    array : array
        Somebody's.

    Returns
    -------
    array
        A copy, unless nobody can.
    """
    base: object = array
    while isinstance(base, np.ndarray):
        if cast("NDArray[Any]", base).flags.writeable:
            return locked(array.copy())
        base = cast("object", base.base)
    return array


def remade(several: list[Any] | tuple[Any, ...], items: list[Any]) -> Value:
    """A list or tuple of the same class with other items.

    Parameters
    ----------
    several : list or tuple
        Also a NamedTuple.
    items : list
    """
    return getattr(several, "_make", type(several))(items)


def own(value: Value, share: Share = locked) -> Value:
    """A value that its receiver cannot change for others, nor others for it.

    Lists, dictionaries and sets are anew, and with them the tuples and dataclasses that hold
    one. Whatever holds none, such as the frozen records of the kernel, is the very same
    object; so are objects of other classes, which say nothing of what they hold.

    Parameters
    ----------
    value : object
        A result, or what a step was given.
    share : callable
        What becomes of an array: `locked` or `snapshot`.

    Returns
    -------
    object
        Equal to `value`.
    """
    return _own(value, share, {})


@singledispatch
def _own(value: Value, share: Share, done: dict[int, Value]) -> Value:
    """`own`, given what has been made anew by the id of its original."""
    if not is_dataclass(value) or isinstance(value, type):
        return value
    record: Value = value
    if id(record) in done:
        return done[id(record)]
    is_new = not record.__dataclass_params__.frozen
    if is_new:
        record = done[id(value)] = copy(record)
    for entry in fields(value):
        item = getattr(value, entry.name, None)
        owned = _own(item, share, done)
        if owned is not item:
            record, is_new = record if is_new else copy(record), True
            object.__setattr__(record, entry.name, owned)
    return record


@_own.register(str)
@_own.register(int)
@_own.register(float)
def _(value: Value, share: Share, done: dict[int, Value]) -> Value:
    del share, done
    return value


@_own.register(np.ndarray)
def _(value: NDArray[Any], share: Share, done: dict[int, Value]) -> NDArray[Any]:
    del done
    return share(value)


@_own.register(tuple)
def _(value: tuple[Any, ...], share: Share, done: dict[int, Value]) -> tuple[Any, ...]:
    items = [_own(item, share, done) for item in value]
    if all(map(is_, items, value)):
        return value
    return remade(value, items)


@_own.register(list)
@_own.register(deque)
def _(value: list[Any], share: Share, done: dict[int, Value]) -> list[Any]:
    if id(value) not in done:
        anew = done[id(value)] = copy(value)
        for index, item in enumerate(value):
            anew[index] = _own(item, share, done)
    return done[id(value)]


@_own.register(dict)
def _(value: dict[Any, Any], share: Share, done: dict[int, Value]) -> dict[Any, Any]:
    if id(value) not in done:
        anew = done[id(value)] = copy(value)
        for key, item in value.items():
            anew[key] = _own(item, share, done)
    return done[id(value)]


@_own.register(set)
@_own.register(bytearray)
def _(value: Value, share: Share, done: dict[int, Value]) -> Value:
    del share
    return done.setdefault(id(value), copy(value))
