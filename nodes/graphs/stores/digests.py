"""Fingerprints of values and files by content."""

import os
from collections.abc import Mapping, Set
from dataclasses import fields, is_dataclass
from functools import singledispatch
from pathlib import Path
from typing import Any, Final, TypeAlias, cast

import numpy as np
import xxhash
from numpy.typing import NDArray

from ..annotations import Value

FileState: TypeAlias = tuple[int | str, ...] | None


def digest(value: object) -> bytes:
    """A fingerprint of a value by its content.

    Parameters
    ----------
    value : object
        Numbers, texts, paths (as texts), arrays, lists, mappings, sets and dataclasses of
        these, or an object with a method ``content_key() -> bytes``.

    Returns
    -------
    bytes
        Equal for equal contents; lists and tuples, and mappings in any order, are alike.

    Raises
    ------
    TypeError
        If something in the value has no content to go by.

    Examples
    --------
    >>> digest({"a": 1, "b": [2.0]}) == digest({"b": (2.0,), "a": 1})
    True
    """
    state = xxhash.xxh3_128()
    _feed(value, state)
    return state.digest()


def _tag(state: xxhash.xxh3_128, text: str) -> None:
    state.update(f"{len(text)}:{text}".encode())


@singledispatch
def _feed(value: Value, state: xxhash.xxh3_128) -> None:
    kind = cast("type[Any]", type(value))
    if hasattr(value, "content_key"):
        _tag(state, f"key {kind.__module__}.{kind.__qualname__}")
        _feed(value.content_key(), state)
    elif is_dataclass(kind):
        _tag(state, f"record {kind.__module__}.{kind.__qualname__}")
        for entry in fields(kind):
            _tag(state, entry.name)
            _feed(getattr(value, entry.name), state)
    else:
        raise TypeError(
            f"a {kind.__qualname__} cannot be told from another by its content: "
            "give it a method content_key() -> bytes, or pass it by a wire"
        )


@_feed.register(type(None))
@_feed.register(bool)
@_feed.register(int)
@_feed.register(float)
@_feed.register(complex)
@_feed.register(str)
def _(value: object, state: xxhash.xxh3_128) -> None:
    _tag(state, f"{type(value).__name__} {value!r}")


@_feed.register
def _(value: bytes, state: xxhash.xxh3_128) -> None:
    _tag(state, f"bytes {len(value)}")
    state.update(value)


@_feed.register
def _(value: os.PathLike, state: xxhash.xxh3_128) -> None:  # pyright: ignore[reportMissingTypeArgument, reportUnknownParameterType]
    _feed(os.fspath(cast("os.PathLike[str]", value)), state)


@_feed.register
def _(value: np.generic, state: xxhash.xxh3_128) -> None:
    _feed(value.item(), state)


@_feed.register(np.ndarray)
def _(value: NDArray[Any], state: xxhash.xxh3_128) -> None:
    if value.dtype.hasobject:
        raise TypeError("an array of objects cannot be told from another by its content")
    _tag(state, f"array {value.dtype.str} {value.shape}")
    state.update(np.ascontiguousarray(value).reshape(-1).view(np.uint8).data)


@_feed.register(list)
@_feed.register(tuple)
def _(value: list[Any] | tuple[Any, ...], state: xxhash.xxh3_128) -> None:
    _tag(state, f"list {len(value)}")
    for item in value:
        _feed(item, state)


@_feed.register(Mapping)
def _(value: Mapping[Any, Any], state: xxhash.xxh3_128) -> None:
    _tag(state, f"mapping {len(value)}")
    for pair in sorted(digest(key) + digest(item) for key, item in value.items()):
        state.update(pair)


@_feed.register(Set)
def _(value: Set[Any], state: xxhash.xxh3_128) -> None:
    _tag(state, f"set {len(value)}")
    for item in sorted(map(digest, value)):
        state.update(item)


def file_state(path: str | os.PathLike[str]) -> FileState:
    """What tells that a file has changed.

    Returns
    -------
    tuple of int or None
        Size and time of the last change; None if there is no such file.
    """
    try:
        status = Path(path).stat()
    except (OSError, ValueError):  # a ValueError is about what can be no path
        return None
    return status.st_size, status.st_mtime_ns


def content_state(path: str | os.PathLike[str]) -> FileState:
    """What tells that a file has changed, whoever wrote it and whenever.

    Returns
    -------
    tuple of (int, str) or None
        Size and digest of its content; None if there is no such file.
    """
    state = xxhash.xxh3_128()
    size = 0
    try:
        if not Path(path).is_file():
            return None
        with Path(path).open("rb") as file:
            while block := file.read(_BLOCK):
                state.update(block)
                size += len(block)
    except (OSError, ValueError):
        return None
    return size, state.hexdigest()


_BLOCK: Final = 2**20
