"""Structural keys, and the results found by them."""

import os
from collections import OrderedDict
from collections.abc import Mapping, Set
from dataclasses import dataclass, fields, is_dataclass
from functools import singledispatch
from pathlib import Path
from threading import Lock
from typing import Any, cast

import numpy as np
import xxhash
from numpy.typing import NDArray

from .annotations import Value

FileState = tuple[int, int] | None


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


@dataclass(frozen=True, eq=False)
class Entry:
    """The outcome of a step.

    Attributes
    ----------
    value : object
        What the function returned, `own`.
    messages : tuple of str
        What it warned about.
    files : tuple of (str, FileState)
        The files that it wrote, as it left them.
    """

    value: Any
    messages: tuple[str, ...] = ()
    files: tuple[tuple[str, FileState], ...] = ()


class Cache:
    """Results by key, the longest unused forgotten first.

    Parameters
    ----------
    max_entries : int
        How many results are kept.
    """

    def __init__(self, max_entries: int = 256) -> None:
        self.max_entries = max_entries
        self._entries: OrderedDict[bytes, Entry] = OrderedDict()
        self._messages: dict[bytes, tuple[str, ...]] = {}
        self._writers: dict[str, bytes] = {}
        self._lock = Lock()

    def get(self, key: bytes) -> Entry | None:
        """The result of a key, if it is there and the files it wrote are too.

        Returns
        -------
        Entry or None
            None too if a file is gone, has changed, or was written by another step since.
        """
        with self._lock:
            entry = self._entries.get(key)
            if entry is None:
                return None
            for path, state in entry.files:
                # Two writes within a tick of the file system's clock have equal states.
                if self._writers.get(path) != key or state is None:
                    return None
                if file_state(path) != state:
                    return None
            self._entries.move_to_end(key)
            return entry

    def put(self, key: bytes, entry: Entry) -> None:
        """Keep a result."""
        with self._lock:
            self._entries[key] = entry
            self._entries.move_to_end(key)
            self._writers.update((path, key) for path, _ in entry.files)
            if entry.messages:
                self._messages[key] = entry.messages

    def messages(self, key: bytes) -> tuple[str, ...]:
        """What a step warned about; remembered when its result is forgotten.

        Returns
        -------
        tuple of str
            Empty if it did not.
        """
        return self._messages.get(key, ())

    def trim(self, at_least: int = 0) -> None:
        """Forget the results that were not used for longest.

        Parameters
        ----------
        at_least : int
            Keep as many, even if it is more than `max_entries`.
        """
        with self._lock:
            while len(self._entries) > max(self.max_entries, at_least):
                self._entries.popitem(last=False)
