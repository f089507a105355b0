"""Which items of several lists go together: along an axis by a rule, across axes all."""

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any, Final

from ..annotations import Value
from ..errors import GraphError
from ..specification.wires import Each, axes_of

Index = tuple[int, ...]


def _longest(where: str, counts: Mapping[str, int]) -> int:
    length = max(counts.values())
    empty = [name for name, count in counts.items() if not count]
    if length and empty:
        raise GraphError(f"{where}.{empty[0]} is an empty list, another has {length} items")
    return length


def _shortest(where: str, counts: Mapping[str, int]) -> int:
    del where
    return min(counts.values())


def _same(where: str, counts: Mapping[str, int]) -> int:
    (first, length), *others = counts.items()
    for name, count in others:
        if count != length:
            raise GraphError(
                f"{where}.{first} has {length} items and {where}.{name} {count}: lists of the "
                'same length are asked for (match="same")'
            )
    return length


_RULES: Final[dict[str, Callable[[str, Mapping[str, int]], int]]] = {
    "longest": _longest,
    "shortest": _shortest,
    "same": _same,
}


def shape_of(where: str, eaches: Mapping[str, Each], counts: Mapping[str, int]) -> Index:
    """How many calls there are along each axis.

    Parameters
    ----------
    where : str
        Name of the step.
    eaches : mapping of str to Each
        The inputs that are mapped over, in the order of the ports.
    counts : mapping of str to int
        Lengths of their lists.

    Returns
    -------
    tuple of int
        One for each axis, in the order in which they appear first.

    Raises
    ------
    GraphError
        If the lists of an axis do not go together.
    """
    lengths: list[int] = []
    for names in axes_of(eaches).values():
        rule = next((eaches[name].match for name in names if eaches[name].match), "longest")
        lengths.append(_RULES[rule](where, {name: counts[name] for name in names}))
    return tuple(lengths)


def items_at(
    eaches: Mapping[str, Each], counts: Mapping[str, int], index: Index
) -> dict[str, int]:
    """Which item of each list is taken for one call; the last one of a list that has ended.

    Returns
    -------
    dict of str to int
        By input.
    """
    return {
        name: min(place, counts[name] - 1)
        for place, names in zip(index, axes_of(eaches).values(), strict=True)
        for name in names
    }


def indices(shape: Index) -> list[Index]:
    """All calls, the last axis fastest."""
    return list(product(*map(range, shape)))


def nested(values: Sequence[Value], shape: Index) -> list[Any]:
    """Values of all calls as lists within lists, one level for each axis."""
    if len(shape) == 1:
        return list(values)
    size = len(values) // shape[0] if shape[0] else 0
    return [nested(values[i * size : (i + 1) * size], shape[1:]) for i in range(shape[0])]
