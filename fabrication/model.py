"""A model: the panels and beams that every writer writes, and what it gives back."""

import os
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal, TypeVar
from unicodedata import category

import numpy as np

from ..kernel.beams.beams import Beams
from ..kernel.errors import InputError, name_ids
from ..kernel.panels.panels import Panels
from ..kernel.parts.records import RejectedPart, finite_parts

Kind = Literal["panel", "beam"]

_ELEMENTS: Final = {"panel": "faces", "beam": "edges"}

_UNWRITABLE: Final = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode's categories of control characters, halves of characters, and ends of lines."""

_NO_CHARACTERS: Final = frozenset("\ufffe\uffff")


@dataclass(frozen=True)
class Model:
    """What is written: panels, beams, or both, in ``mm``, ``cm``, ``m``, ``in`` or ``ft``."""

    panels: Panels | None = None
    beams: Beams | None = None
    units: str = "m"


@dataclass(frozen=True)
class Written:
    """What was written: the file, and the parts that it lacks with their reasons.

    Notes say what else differs from what was asked for; counts are numbers of objects by kind,
    where the writer counts them.
    """

    path: Path
    rejected: tuple[RejectedPart, ...] = ()
    notes: tuple[str, ...] = ()
    counts: Mapping[str, int] = field(default_factory=dict[str, int])


def check_model(model: Model, target: str | os.PathLike[str]) -> None:
    """Refuse a model that no file can hold; the target is named in the message.

    Raises InputError if there is neither a panel nor a beam, or `check_parts` refuses them; one
    of both may be empty.
    """
    panels, beams = model.panels, model.beams
    if panels is None and beams is None:
        raise InputError(f"there are no panels or beams to write to {target}")
    if panels is not None and (panels.ids or beams is None or not beams.ids):
        check_parts(panels, "panel", target)
    if beams is not None and (beams.ids or panels is None):
        check_parts(beams, "beam", target)


PanelsOrBeams = TypeVar("PanelsOrBeams", bound=Panels | Beams)


def check_parts(
    parts: PanelsOrBeams | None, kind: Kind, target: str | os.PathLike[str]
) -> PanelsOrBeams:
    """Refuse parts that no file can hold; kind and target are named in the message.

    Raises InputError if there are none, two have the same name, a name is no line of text, or
    one has numbers that are not finite.
    """
    if parts is None or not parts.ids:
        raise InputError(f"there are no {kind}s to write to {target}")
    check_part_names(parts.ids, kind)
    for name, count in Counter(parts.ids).items():
        if count > 1:
            rows = [i for i, other in enumerate(parts.ids) if other == name]
            elements = name_ids(parts.element_ids[rows].tolist())
            raise InputError(
                f"{count} {kind}s are called {name!r} ({_ELEMENTS[kind]} {elements}): give "
                "each a name of its own"
            )
    broken = [parts.ids[i] for i in np.flatnonzero(~finite_parts(parts))]
    if broken:
        raise InputError(f"{kind} {broken[0]} ({len(broken)} in all) is not finite")
    return parts


def check_part_names(names: Iterable[str], kind: Kind) -> None:
    r"""Refuse names that some kinds of files cannot hold, or would change.

    Raises InputError if a name is empty, begins or ends with a blank, or has a character that
    is no text: ends of lines, tabs and other control characters, halves of characters.

    Examples
    --------
    >>> check_part_names(["Dach 1", "屋根"], "panel")
    >>> check_part_names(["A\n1"], "panel")
    Traceback (most recent call last):
    ...
    spheremesh.kernel.errors.InputError: panel 0 is called 'A\n1': a name is one line of ...
    """
    for number, name in enumerate(names):
        if name != name.strip() or not name or any(map(_is_unwritable, name)):
            raise InputError(
                f"{kind} {number} is called {name!a}: a name is one line of text, without "
                "blanks at its ends and control characters"
            )


def _is_unwritable(character: str) -> bool:
    return category(character) in _UNWRITABLE or character in _NO_CHARACTERS
