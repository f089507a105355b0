"""Keys of steps and of items of lists: all that a result depends on, as a fingerprint."""

import os
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, cast

import xxhash

from ..annotations import Value
from ..node import Node
from ..specification.wires import Each, Param, Wire, sources
from ..stores.digests import digest

_SCALARS: Final = frozenset((int, float, bool, str, type(None)))


def key_of(parts: Iterable[bytes]) -> bytes:
    """The key that parts make, in their order."""
    joined = b"".join([b"%d:%b" % (len(part), part) for part in parts])
    return xxhash.xxh3_128_digest(joined)


def node_part(node: Node, origin: Callable[[Callable[..., Any]], str]) -> bytes:
    """What a key says of a node: a new version or another function gives other results."""
    code = "" if node.inner is not None else origin(node.function)
    return f"{node.name} {node.version} {node.edition} {code}".encode()


def value_part(value: Value) -> bytes:
    """What a key says of a value; raises TypeError if it has no content to go by."""
    if type(value) in _SCALARS:
        return f"{type(value).__name__} {value!r}".encode(errors="surrogatepass")
    return b"value" + digest(value)


def given_part(
    given: Value, key: Callable[[str], bytes], value: Callable[[str], Value]
) -> bytes:
    """What a key says of what an input was given.

    Parameters
    ----------
    given : object
        Wire, slider, list to map over, list with these, or value.
    key : callable
        Gives the key of a step.
    value : callable
        Gives the value of a slider.
    """
    if isinstance(given, Wire):
        return b"wire" + key(given.step.name) + given.port.name.encode()
    if isinstance(given, Param):
        return value_part(value(given.name))
    if isinstance(given, Each):
        inner = given_part(given.items, key, value)
        return key_of([b"each", inner, given.axis.encode(), given.match.encode()])
    if isinstance(given, list | tuple) and any(sources(cast("Value", given))):
        items = cast("Sequence[Value]", given)
        return key_of([b"list", *(given_part(item, key, value) for item in items)])
    return value_part(given)


def absolute(path: str) -> str:
    """A path from the root, as told: links are not followed."""
    return os.path.abspath(path)  # noqa: PTH100, Path.resolve follows links
