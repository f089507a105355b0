"""What steps are given, as JSON: values, wires, sliders and lists to map over."""

import json
import math
import os
from base64 import b64decode, b64encode
from collections.abc import Callable, Mapping, Sequence
from functools import singledispatch
from typing import Any, Final, NamedTuple, TypeAlias, cast

import numpy as np
import xxhash
from numpy.typing import NDArray

from ..annotations import Value
from ..errors import GraphError
from ..stores.packing import PackingError, pack, unpack
from .wires import Each, Param, Wire, each

Contents: TypeAlias = dict[str, Any]
"""Packed values by digest, which stand apart from what is read by people."""

_LONG: Final = 1000
"""Numbers of an array that are too many to be read."""


@singledispatch
def encode(value: Value, contents: Contents | None = None) -> Value:
    """A value, a wire or a slider as JSON.

    Parameters
    ----------
    value : object
        What a step was given.
    contents : dict, optional
        Where meshes and other records, and long arrays, are put.

    Returns
    -------
    object
        Numbers, texts and lists are themselves, all else is tagged.

    Raises
    ------
    GraphError
        If it has no form in JSON.

    Examples
    --------
    >>> encode([1, float("inf"), {"a": None}])
    [1, {'float': 'inf'}, {'mapping': {'a': None}}]
    """
    try:
        return _apart(value, contents)
    except (PackingError, RecursionError) as error:
        raise GraphError(
            f"a {type(value).__name__} cannot be written into a graph file; "
            "let a node make it, or read it from a file"
        ) from error


def _apart(value: Value, contents: Contents | None) -> Value:
    blocks: dict[str, bytes] = {}
    tree = pack(value, blocks)
    if contents is None:
        raise PackingError("there is no place for it")
    packed = {
        "value": tree,
        "blocks": {name: b64encode(block).decode() for name, block in sorted(blocks.items())},
    }
    name = content_name(packed)
    contents[name] = packed
    return {"content": name}


def content_name(packed: Value) -> str:
    """The name of a content: its digest."""
    text = json.dumps(packed, sort_keys=True, ensure_ascii=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())


@encode.register(type(None))
@encode.register(bool)
@encode.register(int)
@encode.register(str)
def _(value: Value, contents: Contents | None = None) -> Value:
    del contents
    return value


@encode.register
def _(value: float, contents: Contents | None = None) -> Value:
    del contents
    return value if math.isfinite(value) else {"float": str(value)}


@encode.register(np.generic)
def _(value: np.generic, contents: Contents | None = None) -> Value:
    return encode(value.item(), contents)


@encode.register(os.PathLike)
def _(value: os.PathLike[str], contents: Contents | None = None) -> Value:
    del contents
    return os.fspath(value)


@encode.register(list)
@encode.register(tuple)
def _(value: Sequence[Value], contents: Contents | None = None) -> Value:
    return [encode(item, contents) for item in value]


@encode.register(Mapping)
def _(value: Mapping[Value, Value], contents: Contents | None = None) -> Value:
    if not isinstance(value, dict) and contents is not None:
        return _apart(value, contents)  # a report
    if not all(isinstance(key, str) for key in value):
        raise GraphError("a mapping in a graph file needs texts as keys")
    return {"mapping": {key: encode(item, contents) for key, item in value.items()}}


@encode.register(np.ndarray)
def _(value: NDArray[Any], contents: Contents | None = None) -> Value:
    if value.dtype.kind not in "biuf":
        raise GraphError(f"an array of {value.dtype} cannot be written into a graph file")
    if value.size > _LONG and contents is not None:
        return _apart(value, contents)
    return {"array": encode(value.tolist()), "dtype": value.dtype.name}


@encode.register
def _(value: Each, contents: Contents | None = None) -> Value:
    rules = {name: rule for name in ("match", "axis") if (rule := getattr(value, name))}
    return {"each": encode(value.items, contents), **rules}


@encode.register
def _(value: Wire, contents: Contents | None = None) -> Value:
    del contents
    return {"wire": value.step.name if len(value.step.wires) == 1 else str(value)}


@encode.register
def _(value: Param, contents: Contents | None = None) -> Value:
    del contents
    return {"param": value.name}


class Names(NamedTuple):
    """What gives the wires, sliders and contents of a graph by name."""

    wire: Callable[[str], Value]
    slider: Callable[[str], Value]
    content: Callable[[str], Value]


def decode(value: Value, names: Names) -> Value:
    """The inverse of `encode`.

    Returns
    -------
    object
        What a step is given.

    Raises
    ------
    GraphError
        If the tag is unknown, or the wire or slider is.
    """
    if isinstance(value, list):
        return [decode(item, names) for item in cast("list[Value]", value)]
    if not isinstance(value, dict):
        return value
    tagged = cast("dict[str, Value]", value)
    tag = next((tag for tag in tagged if tag in _DECODERS), "")
    if not tag or not tagged.keys() <= {tag, *_BESIDE.get(tag, ())}:
        raise GraphError(
            f"cannot read {_shown(tagged)}: expected a value or one of {', '.join(_DECODERS)}"
        )
    try:
        return _DECODERS[tag](tagged, names)
    except (AttributeError, TypeError, ValueError, ArithmeticError, LookupError) as error:
        if isinstance(error, GraphError):
            raise
        raise GraphError(f"cannot read {_shown(tagged)}: {error}") from error


def _array(tagged: dict[str, Value], names: Names) -> NDArray[Any]:
    """An array, if every item is a number of its kind: the type may not change what is said."""
    name = tagged.get("dtype", "float64")
    if name not in _DTYPES:
        raise ValueError(f'"dtype" must be one of {", ".join(_DTYPES)}')
    items = np.array(decode(tagged["array"], names))
    if items.dtype.kind not in "biuf" and items.size:
        raise ValueError("an array holds numbers alone")
    with np.errstate(all="ignore"):
        # Integers from the list itself: beside others, those of 64 bits would become floats.
        array = np.array(decode(tagged["array"], names), name)
        is_exact = array.dtype.kind == "f" or bool((array == items).all())
    if not is_exact or (np.isfinite(items) & ~np.isfinite(array)).any():
        raise ValueError(f"a number does not fit into {name}")
    return array


def _content(tagged: dict[str, Value], names: Names) -> Value:
    """A content, if it is what its digest says; nothing in it is run."""
    packed = names.content(tagged["content"])
    if content_name(packed) != tagged["content"]:
        raise ValueError("its content is damaged")
    blocks = {name: b64decode(text) for name, text in packed["blocks"].items()}
    try:
        return unpack(packed["value"], blocks.__getitem__)
    except ImportError as error:
        raise GraphError(f"import the module {error} first, whose records it holds") from error


def _float(tagged: dict[str, Value], _: Names) -> float:
    if tagged["float"] not in ("inf", "-inf", "nan"):
        raise ValueError("expected inf, -inf or nan")
    return float(tagged["float"])


def _shown(value: Value) -> str:
    return json.dumps(value)[:60]


_DTYPES: Final = (
    "float64", "float32", "float16", "int64", "int32", "int16", "int8", "uint64", "uint32",
    "uint16", "uint8", "bool",
)  # fmt: skip

_DECODERS: dict[str, Callable[[dict[str, Value], Names], Value]] = {
    "wire": lambda tagged, names: names.wire(tagged["wire"]),
    "param": lambda tagged, names: names.slider(tagged["param"]),
    "each": lambda tagged, names: each(
        decode(tagged["each"], names), **{n: x for n, x in tagged.items() if n != "each"}
    ),
    "array": _array,
    "content": _content,
    "mapping": lambda tagged, names: {
        key: decode(item, names) for key, item in tagged["mapping"].items()
    },
    "float": _float,
}


_BESIDE: Final = {"array": ("dtype",), "each": ("match", "axis")}
"""What may stand beside a tag."""

MOST_BYTES: Final = 2**26
_MOST_VALUES: Final = 1_000_000
_DEEPEST: Final = 64
_LONGEST_NAME: Final = 200
_LONGEST_INTEGER: Final = 20
"""Digits and sign of the integers of 64 bits."""
_TWICE, _OVERLONG = object(), object()


def parse_json(text: str) -> Value:
    """The value of a JSON text, without what JSON allows and nobody means.

    Parameters
    ----------
    text : str

    Returns
    -------
    object
        Objects, lists, texts, finite numbers, integers of 64 bits, booleans and None.

    Raises
    ------
    GraphError
        If it is none, a name stands twice in an object, a number is not finite or has too many
        digits, or it is nested too deeply or too large; the message says where.
    """
    if len(text) > MOST_BYTES or sum(map(text.count, ",[{")) > _MOST_VALUES:
        raise GraphError(
            f"more than {_MOST_VALUES} values or {MOST_BYTES} characters: let a node read what "
            "is large from a file of its own"
        )
    try:
        content = json.loads(text, object_pairs_hook=_object, parse_int=_integer)
    except json.JSONDecodeError as error:
        raise GraphError(f"line {error.lineno}: not JSON: {error.msg}") from error
    except RecursionError as error:
        raise GraphError(f"nested too deeply: {_DEEPEST} levels at most") from error
    _check_json(content)
    return content


def _object(pairs: list[tuple[str, Value]]) -> dict[Any, Value]:
    content: dict[Any, Value] = dict(pairs)
    if len(content) < len(pairs):
        seen = set[str]()
        content[_TWICE] = next(n for n, _ in pairs if n in seen or seen.add(n))
    return content


def _integer(digits: str) -> Value:
    number = int(digits) if len(digits) <= _LONGEST_INTEGER else None
    return number if number is not None and -(2**63) <= number < 2**64 else _OVERLONG


def _check_json(content: Value) -> None:
    """Refuse what JSON allows and nobody means, at any depth and without recursion."""
    pending: list[tuple[str, Value, int]] = [("", content, 0)]
    while pending:
        at, value, depth = pending.pop()
        if depth > _DEEPEST:
            raise GraphError(f"{at[:60]}: nested too deeply: {_DEEPEST} levels at most")
        if isinstance(value, dict):
            items = cast("dict[Any, Value]", value)
            _check_names(at or "the file", items)
            pending += ((f"{at}.{n}" if at else n, x, depth + 1) for n, x in items.items())
        elif isinstance(value, list):
            several = cast("list[Value]", value)
            if not all(type(x) in {int, float} and math.isfinite(x) for x in several):
                pending += ((f"{at}[{i}]", x, depth + 1) for i, x in enumerate(several))
        else:
            fault = _fault(value)
            if fault:
                raise GraphError(f"{at}: {fault}")


def _check_names(at: str, content: dict[Any, Value]) -> None:
    for name, item in content.items():
        if name is _TWICE:
            raise GraphError(f"{at}: {str(item)[:60]!r} is given twice")
        if len(name) > _LONGEST_NAME or not _is_text(name):
            raise GraphError(f"{at}: {name[:60]!r} can be no name")


def _fault(value: Value) -> str:
    """What is wrong with a number or a text."""
    if value is _OVERLONG:
        return "a whole number has 64 bits at most"
    if isinstance(value, float) and not math.isfinite(value):
        return 'no finite number; infinities are {"float": "inf"}'
    if isinstance(value, str) and not _is_text(value):
        return "not Unicode text: half of a character stands alone"
    return ""


def _is_text(text: str) -> bool:
    """Whether there is no half of a character, which JSON can escape and no file can hold."""
    return text.isascii() or not any("\ud800" <= letter <= "\udfff" for letter in text)
