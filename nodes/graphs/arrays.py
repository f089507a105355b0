"""Arrays at ports: their shape, the kind and size of their numbers, and that counts agree."""

from collections.abc import Iterator, Mapping, Sequence
from numbers import Complex
from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from .annotations import ArrayFacts, Hint, Member, Value, members, scalar_type
from .errors import GraphError

LARGEST: Final = 1e100
"""Larger numbers are none that anything has: their squares leave float64 nothing to spare."""

_KINDS: Final[dict[Hint, str]] = {
    np.bool_: "b", np.int64: "biu", np.float64: "biuf", np.complex128: "biufc", np.str_: "U",
}  # fmt: skip
"""Kinds of numbers that an array takes without loss."""


def takes_array(target: Member, value: Value) -> bool:
    """Whether a value is an array of the shape and the numbers of an input, or becomes one.

    Lists of numbers do; the empty list stands for no rows of any shape.
    """
    if not _is_numeric(value):
        return False
    try:
        array = np.asarray(value)
    except (ValueError, OverflowError):  # rows of different lengths
        return False
    is_empty_list = isinstance(value, list | tuple) and array.shape == (0,)
    facts = target.facts
    has_shape = facts is None or (
        isinstance(facts.shape[0], str) if is_empty_list else _has_shape(array, facts)
    )
    return has_shape and _has_kind(array, scalar_type(target))


def as_array(target: Member, value: Value) -> NDArray[Any]:
    """The array that an input expects, of a value that it takes."""
    array = np.asarray(value, scalar_type(target))
    if target.facts is None or array.shape != (0,):
        return array
    return array.reshape([0 if isinstance(n, str) else n for n in target.facts.shape])


def is_other_array(hint: Hint, value: Value) -> bool:
    """Whether a value is an array of other numbers than those that an input expects."""
    if not isinstance(value, np.ndarray):
        return False
    scalars = [scalar_type(member) for member in members(hint) if member.kind is np.ndarray]
    dtype = cast("NDArray[Any]", value).dtype
    return bool(scalars) and not any(
        scalar is None or issubclass(dtype.type, scalar) for scalar in scalars
    )


def check_magnitudes(array: NDArray[Any], where: str) -> None:
    """Refuse numbers beyond 1e100; infinity is none of them.

    Raises
    ------
    GraphError
        The message gives the largest.
    """
    if array.dtype.kind != "f" or not array.size:
        return
    sizes = np.abs(array[np.isfinite(array)])
    if sizes.size and sizes.max() > LARGEST:
        raise GraphError(f"{where} has numbers up to {sizes.max():g}: at most {LARGEST:g}")


def check_counts(step: str, hints: Mapping[str, Hint], values: Mapping[str, Value]) -> None:
    """Refuse arrays of different counts along axes with the same letter.

    A record that has `counts`, as meshes do, says how many there are of each letter; without
    one, arrays must agree among each other. One entry may stand for all.

    Parameters
    ----------
    step : str
        For the message.
    hints : mapping of str to type
        Of the inputs.
    values : mapping of str to object
        What they are given.

    Raises
    ------
    GraphError
        The message names both inputs.
    """
    owned: dict[str, dict[int, str]] = {}
    for name, value in values.items():
        counts: Value = getattr(value, "counts", None)
        if isinstance(counts, Mapping):
            for letter, count in cast("Mapping[str, int]", counts).items():
                owned.setdefault(letter, {})[count] = name
    found: dict[str, dict[int, str]] = {}
    for name, holds, letter, count in _axes(hints, values):
        if letter not in owned and count == 1:
            continue
        known = owned.get(letter) or found.setdefault(letter, {count: name})
        if count not in known:
            other_count, other = next(iter(known.items()))
            raise GraphError(
                f"{step}.{name}: {holds} for {count}, but {step}.{other} has {other_count}: "
                "there must be one for each"
            )


def _axes(
    hints: Mapping[str, Hint], values: Mapping[str, Value]
) -> Iterator[tuple[str, str, str, int]]:
    """Inputs that are arrays, what they hold, and letter and count of each of their axes."""
    for name, value in values.items():
        facts = _facts_of(hints[name], value)
        if facts is not None:
            for letter, count in zip(facts.shape, np.shape(value), strict=True):
                if isinstance(letter, str):
                    yield name, facts.holds, letter, count


def _facts_of(hint: Hint, value: Value) -> ArrayFacts | None:
    """What an input says of an array: of several alternatives the one that fits."""
    if not isinstance(value, np.ndarray):
        return None
    array = cast("NDArray[Any]", value)
    several = (member.facts for member in members(hint))
    return next((facts for facts in several if facts and _has_shape(array, facts)), None)


def _is_numeric(value: Value) -> bool:
    """Whether it is an array or could become one."""
    if isinstance(value, list | tuple):
        items = cast("Sequence[Value]", value)
        return all(isinstance(item, Complex) or _is_numeric(item) for item in items)
    return isinstance(value, np.ndarray)


def _has_shape(array: NDArray[Any], facts: ArrayFacts) -> bool:
    """Whether an array has a shape; letters stand for any number."""
    return len(array.shape) == len(facts.shape) and all(
        isinstance(wanted, str) or count == wanted
        for count, wanted in zip(array.shape, facts.shape, strict=True)
    )


def _has_kind(array: NDArray[Any], scalar: Hint) -> bool:
    """Whether the numbers of an array can be of another type and stay what they are."""
    kinds = _KINDS.get(scalar)
    if kinds is None or array.dtype.kind in kinds or not array.size:
        return True
    is_whole = scalar is np.int64 and array.dtype.kind == "f"
    return is_whole and bool((np.abs(array) < 2.0**53).all() and (array % 1 == 0).all())
