"""How many bytes a value takes; what several values share is counted once."""

import sys
from collections import deque
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from ..annotations import Value

_SCALARS: Final = frozenset((int, float, bool, complex, type(None)))
_SCALAR_BYTES: Final = 32
_OBJECT_BYTES: Final = 64
_BUFFERS: Final = (np.ndarray, bytes, bytearray, memoryview)


def footprint(value: Value) -> dict[int, int]:
    """The parts of a value and their bytes.

    Parameters
    ----------
    value : object
        Whatever a step returns. Of objects that say nothing of what they hold, only the
        objects themselves are counted.

    Returns
    -------
    dict of int to int
        Bytes by the id of the part, which is of use as long as the value lives.
    """
    sizes: dict[int, int] = {}
    pending: list[Any] = [value]
    while pending:
        item = pending.pop()
        if type(item) in _SCALARS:
            continue
        if isinstance(item, np.ndarray):
            buffer = _buffer(cast("NDArray[Any]", item))
            sizes[id(buffer)] = getattr(buffer, "nbytes", len(buffer)) + _OBJECT_BYTES
        elif id(item) not in sizes:
            sizes[id(item)] = _own_size(item)
            pending.extend(_held(item))
    return sizes


def _buffer(array: NDArray[Any]) -> Value:
    """What holds the numbers of an array, which may be a view of a small part."""
    base: Any = array
    while isinstance(inner := getattr(base, "base", None), _BUFFERS):
        base = cast("Any", inner)
    return base


def _own_size(item: Value) -> int:
    size = sys.getsizeof(item, _OBJECT_BYTES)
    if isinstance(item, list | tuple | set | frozenset | deque | dict):
        size += _SCALAR_BYTES * len(cast("list[Any]", item))
    return size


def _held(item: Value) -> list[Any]:
    """What an object holds, without its numbers."""
    held: Any = ()
    if isinstance(item, dict):
        mapping = cast("dict[Any, Any]", item)
        held = [*mapping, *mapping.values()]
    elif isinstance(item, list | tuple | set | frozenset | deque):
        held = cast("list[Any]", item)
    elif not isinstance(item, type):
        held = list(cast("Mapping[str, Any]", getattr(item, "__dict__", {})).values())
        if not held and is_dataclass(item):
            held = [getattr(item, entry.name, None) for entry in fields(item)]
    return [part for part in held if type(part) not in _SCALARS]
