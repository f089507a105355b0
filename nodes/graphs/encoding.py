"""What steps are given, as JSON: values, wires, sliders and lists to map over."""

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from functools import singledispatch
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from .annotations import Value
from .errors import GraphError
from .wires import Each, Param, Wire


@singledispatch
def encode(value: Value) -> Value:
    """A value, a wire or a slider as JSON.

    Parameters
    ----------
    value : object
        What a step was given.

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
    raise GraphError(
        f"a {type(value).__name__} cannot be written into a graph file; "
        "let a node make it, or read it from a file"
    )


@encode.register(type(None))
@encode.register(bool)
@encode.register(int)
@encode.register(str)
def _(value: Value) -> Value:
    return value


@encode.register
def _(value: float) -> Value:
    return value if math.isfinite(value) else {"float": str(value)}


@encode.register(np.generic)
def _(value: np.generic) -> Value:
    return encode(value.item())


@encode.register(os.PathLike)
def _(value: os.PathLike[str]) -> Value:
    return os.fspath(value)


@encode.register(list)
@encode.register(tuple)
def _(value: Sequence[Value]) -> Value:
    return [encode(item) for item in value]


@encode.register(Mapping)
def _(value: Mapping[Value, Value]) -> Value:
    if not all(isinstance(key, str) for key in value):
        raise GraphError("a mapping in a graph file needs texts as keys")
    return {"mapping": {key: encode(item) for key, item in value.items()}}


@encode.register(np.ndarray)
def _(value: NDArray[Any]) -> Value:
    if value.dtype.kind not in "biuf":
        raise GraphError(f"an array of {value.dtype} cannot be written into a graph file")
    return {"array": encode(value.tolist()), "dtype": value.dtype.name}


@encode.register
def _(value: Each) -> Value:
    return {"each": encode(value.items)}


@encode.register
def _(value: Wire) -> Value:
    return {"wire": value.step.name if len(value.step.wires) == 1 else str(value)}


@encode.register
def _(value: Param) -> Value:
    return {"param": value.name}


class Names(NamedTuple):
    """What gives the wires and sliders of a graph by name."""

    wire: Callable[[str], Value]
    slider: Callable[[str], Value]


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
    if not tag or not tagged.keys() <= {tag, "dtype"}:
        raise GraphError(
            f"cannot read {json.dumps(tagged)[:60]}: expected a value or one of "
            f"{', '.join(_DECODERS)}"
        )
    try:
        return _DECODERS[tag](tagged, names)
    except (AttributeError, TypeError, ValueError) as error:
        if isinstance(error, GraphError):
            raise
        raise GraphError(f"cannot read {json.dumps(tagged)[:60]}: {error}") from error


_DECODERS: dict[str, Callable[[dict[str, Value], Names], Value]] = {
    "wire": lambda tagged, names: names.wire(tagged["wire"]),
    "param": lambda tagged, names: names.slider(tagged["param"]),
    "each": lambda tagged, names: Each(decode(tagged["each"], names)),
    "array": lambda tagged, names: np.array(
        decode(tagged["array"], names), np.dtype(tagged.get("dtype", "float64"))
    ),
    "mapping": lambda tagged, names: {
        key: decode(item, names) for key, item in tagged["mapping"].items()
    },
    "float": lambda tagged, _: float(tagged["float"]),
}
