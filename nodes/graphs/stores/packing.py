"""Values as JSON and blocks of bytes, and back: without pickles, so reading runs no code.

Numbers, texts and None are themselves; all else is a list that begins with the name of its
kind. Arrays are blocks of their bytes, found by digest; short ones stand in the JSON itself.
Records (dataclasses) and named tuples are named by module and class, and made without their
constructors, as `copy` does.
"""

import base64
import importlib
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias, cast

import numpy as np
import xxhash
from numpy.typing import NDArray

from ..annotations import Value

_ROOT: Final = __name__.partition(".")[0]
_SHORT: Final = 256
"""Bytes of an array that are worth no block of their own."""
_PLAIN: Final = frozenset((bool, int, str, type(None)))
Blocks: TypeAlias = dict[str, bytes]
_Block: TypeAlias = Callable[[str], bytes]


class PackingError(TypeError):
    """A value has no form in JSON and blocks."""


def block_name(block: bytes) -> str:
    """The name of a block: its digest.

    Returns
    -------
    str
        In hexadecimal digits.
    """
    return xxhash.xxh3_128_hexdigest(block)


def pack(value: Value, blocks: Blocks) -> Value:
    """A value as JSON.

    Parameters
    ----------
    value : object
    blocks : dict of str to bytes
        The bytes of its arrays by digest are added to it.

    Returns
    -------
    object
        For `unpack`.

    Raises
    ------
    PackingError
        If it holds something that has no such form; nothing is approximated.
    """
    kind = cast("type[Any]", type(value))
    if kind in _PLAIN:
        return value
    packer = _PACKERS.get(kind)
    if packer is not None:
        return packer(value, blocks)
    return _pack_other(value, kind, blocks)


def _pack_other(value: Value, kind: type[Any], blocks: Blocks) -> Value:
    """Arrays, paths and records, which are of many classes."""
    packed: Value = None
    if kind is np.ndarray:
        packed = _pack_array(cast("NDArray[Any]", value), blocks)
    elif isinstance(value, np.generic):
        scalar: NDArray[Any] = np.asarray(cast("Any", value))
        packed = ["scalar", *_pack_array(scalar, blocks)[1:]]
    elif isinstance(value, Path):
        packed = ["path", str(value)]
    elif isinstance(value, tuple) and hasattr(kind, "_fields"):
        several = cast("tuple[Any, ...]", value)
        packed = ["named", *_class_name(kind), [pack(item, blocks) for item in several]]
    elif is_dataclass(kind):
        packed = _pack_record(value, kind, blocks)
    else:
        raise PackingError(f"a {kind.__qualname__} has no form of its own on disk")
    return packed


def _pack_all(name: str) -> Callable[[Iterable[Value], Blocks], Value]:
    return lambda values, blocks: [name, [pack(item, blocks) for item in values]]


def _pack_mapping(value: Mapping[Value, Value], blocks: Blocks) -> Value:
    return ["dict", [[pack(k, blocks), pack(x, blocks)] for k, x in value.items()]]


def _pack_array(array: NDArray[Any], blocks: Blocks) -> list[Any]:
    if array.dtype.hasobject or array.dtype.names:
        raise PackingError(f"an array of {array.dtype} has no form of its own on disk")
    order = "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
    data = array.tobytes(order)
    head = ["array", array.dtype.str, list(array.shape), order]
    if len(data) <= _SHORT:
        return [*head, "", base64.b64encode(data).decode()]
    name = block_name(data)
    blocks[name] = data
    return [*head, name]


def _pack_record(value: Value, kind: type[Any], blocks: Blocks) -> Value:
    names = [entry.name for entry in fields(kind) if hasattr(value, entry.name)]
    found = {name for name, held in vars(kind).items() if hasattr(held, "func")}
    others = set(getattr(value, "__dict__", {})) - set(names) - found
    if others:
        raise PackingError(f"a {kind.__qualname__} holds more than its fields: {others}")
    items = [[name, pack(getattr(value, name), blocks)] for name in names]
    return ["record", *_class_name(kind), items]


def _class_name(kind: type[Any]) -> tuple[str, str]:
    if "<" in kind.__qualname__:
        raise PackingError(f"{kind.__qualname__} cannot be found again by its name")
    return kind.__module__, kind.__qualname__


_PACKERS: dict[type, Callable[[Any, Blocks], Value]] = {
    float: lambda x, _: x if math.isfinite(x) else ["float", str(x)],
    complex: lambda x, blocks: ["complex", pack(x.real, blocks), pack(x.imag, blocks)],
    bytes: lambda x, _: ["bytes", base64.b64encode(x).decode()],
    list: _pack_all("list"),
    tuple: _pack_all("tuple"),
    set: _pack_all("set"),
    frozenset: _pack_all("frozenset"),
    dict: _pack_mapping,
}


def unpack(tree: Value, block: _Block) -> Value:
    """The value that was packed.

    Parameters
    ----------
    tree : object
        From `pack`.
    block : callable
        Gives the bytes of a digest.

    Returns
    -------
    object
        Equal to the value, its arrays read-only.

    Raises
    ------
    ValueError, TypeError, LookupError, AttributeError, ImportError
        If it is nothing that `pack` gives.
    """
    if not isinstance(tree, list):
        if isinstance(tree, dict):
            raise TypeError("no packed value")
        return tree
    kind, *rest = cast("list[Any]", tree)
    return _UNPACKERS[kind](rest, block)


def _unpack_named(rest: list[Any], block: _Block) -> Value:
    module, name, items = rest
    return _class(module, name, _is_named)._make(unpack(item, block) for item in items)


def _unpack_all(kind: Callable[[Iterable[Any]], Any]) -> Callable[[list[Any], _Block], Value]:
    return lambda rest, block: kind(unpack(item, block) for item in rest[0])


def _unpack_array(rest: list[Any], block: _Block) -> NDArray[Any]:
    dtype, shape, order, name, *short = rest
    data = base64.b64decode(short[0], validate=True) if short else block(name)
    kind = np.dtype(dtype)
    if kind.hasobject:
        raise TypeError("no packed array")
    return np.frombuffer(data, kind).reshape(shape, order=order)


def _unpack_record(rest: list[Any], block: _Block) -> Value:
    module, name, items = rest
    kind = _class(module, name, is_dataclass)
    known = {entry.name for entry in fields(kind)}
    record = object.__new__(kind)
    for field, item in items:
        if field not in known:
            raise AttributeError(field)
        object.__setattr__(record, field, unpack(item, block))
    return record


def _class(module: str, name: str, is_kind: Callable[[type[Any]], bool]) -> Any:  # noqa: ANN401
    """A class of the library or of a module that is imported already: nothing else is run."""
    if module not in sys.modules and module.partition(".")[0] != _ROOT:
        raise ImportError(module)
    found: Any = importlib.import_module(module)
    for part in name.split("."):
        found = getattr(found, part)
    if not isinstance(found, type) or not is_kind(found):
        raise TypeError(f"{module}.{name} is no record")
    return found


def _is_named(kind: type[Any]) -> bool:
    return hasattr(kind, "_fields") and tuple in kind.__mro__


_UNPACKERS: dict[str, Callable[[list[Any], _Block], Value]] = {
    "array": _unpack_array,
    "scalar": lambda rest, block: _unpack_array(rest, block)[()],
    "named": _unpack_named,
    "record": _unpack_record,
    "dict": lambda rest, block: {unpack(k, block): unpack(x, block) for k, x in rest[0]},
    "float": lambda rest, _: float(rest[0]),
    "complex": lambda rest, block: complex(unpack(rest[0], block), unpack(rest[1], block)),
    "bytes": lambda rest, _: base64.b64decode(rest[0], validate=True),
    "path": lambda rest, _: Path(rest[0]),
    "list": _unpack_all(list),
    "tuple": _unpack_all(tuple),
    "set": _unpack_all(set),
    "frozenset": _unpack_all(frozenset),
}
