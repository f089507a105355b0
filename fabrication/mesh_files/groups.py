"""Groups and objects of OBJ files by name: exact, else with other capitals, else by start."""

from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

import numpy as np

from ...kernel.arrays import BoolArray
from ...kernel.errors import InputError

Names: TypeAlias = tuple[str, str]
"""The object and the group that faces belong to; a group line may list several groups."""

_MATCHES: Final[tuple[Callable[[str, str], bool], ...]] = (
    lambda name, asked: name == asked,
    lambda name, asked: name.casefold() == asked.casefold(),
    lambda name, asked: name.casefold().startswith(asked.casefold()),
)
_MOST_NAMES: Final = 20


def faces_of_groups(
    names: Sequence[Names], face_names: Sequence[int], layer: str | Sequence[str]
) -> BoolArray:
    """The faces in the groups and objects asked for.

    Parameters
    ----------
    names : sequence of Names
        What was named in the file, in its order.
    face_names : sequence of int
        Place in `names` for each face.
    layer : str or sequence of str
        Names. A string that is the name of nothing is taken apart at its commas. A name is
        that of a group or object, or else the same with other capitals, or else its start.

    Returns
    -------
    (F,) bool array
        Faces in any of them.

    Raises
    ------
    InputError
        If a name fits nothing; the message lists what there is.
    """
    used = sorted(set(face_names))
    is_asked = np.zeros(len(names), bool)
    for asked in _asked_names(layer, [names[i] for i in used]):
        fitting = _fitting(names, used, asked)
        if not fitting:
            raise InputError(_nothing_fits(asked, [names[i] for i in used]))
        is_asked[fitting] = True
    return is_asked[np.asarray(face_names, np.int64)]


def _asked_names(layer: str | Sequence[str], names: Sequence[Names]) -> list[str]:
    if not isinstance(layer, str):
        return list(layer)
    if _fitting(names, range(len(names)), layer):
        return [layer]
    return [word for word in (part.strip() for part in layer.split(",")) if word] or [layer]


def _fitting(names: Sequence[Names], used: Sequence[int], asked: str) -> list[int]:
    """Places in `names` that fit best."""
    for fits in _MATCHES:
        found = [i for i in used if any(fits(each, asked) for each in _single_names(names[i]))]
        if found:
            return found
    return []


def _single_names(names: Names) -> set[str]:
    # A group line may list several groups, or be one name that holds spaces.
    return {each for name in names for each in (name, *name.split()) if each}


def _nothing_fits(asked: str, names: Sequence[Names]) -> str:
    known = list(dict.fromkeys(name for pair in names for name in pair if name))
    listed = ", ".join(map(repr, known[:_MOST_NAMES])) or "none"
    more = f" and {len(known) - _MOST_NAMES} more" if len(known) > _MOST_NAMES else ""
    return (
        f"no face is in a group or object whose name is or starts with {asked!r}; the file "
        f"names {listed}{more}"
    )
