"""Records of parts: a row per part or per corner, choosing some, and which are finite."""

from collections.abc import Mapping
from dataclasses import Field, dataclass, fields, is_dataclass, replace
from itertools import compress
from typing import Any, ClassVar, Final, Protocol, TypeVar, cast

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray

PER_CORNER: Final[Mapping[str, Any]] = {"per_corner": True}
"""Metadata of fields with a row per corner; the field ``offsets`` says whose they are."""

MAY_BE_NAN: Final[Mapping[str, Any]] = {"may_be_nan": True}
"""Metadata of fields whose numbers need not be finite."""


class Parts(Protocol):
    """A frozen record of parts.

    Arrays and tuples have a row per part, or per corner where the metadata of the field say
    `PER_CORNER`. The parts share the numbers. Records within it are of the same kind.
    """

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def ids(self) -> tuple[str, ...]:
        """Stable names."""
        ...

    @property
    def element_ids(self) -> IntArray:
        """Face or edge of the mesh that each part was made of."""
        ...


PartsT = TypeVar("PartsT", bound=Parts)


@dataclass(frozen=True)
class RejectedPart:
    """A part that cannot be made.

    Attributes
    ----------
    id : str
        Name of the part.
    element_id : int
        Its face or edge of the mesh.
    reason : str
        What is wrong, for a person.
    code : str
        Number of the finding that it is.
    """

    id: str
    element_id: int
    reason: str
    code: str


def part_ids(letter: str, count: int) -> tuple[str, ...]:
    """Stable names of parts: ``P`` for panels, ``B`` for beams, and a number.

    The number has as many digits as the last needs, at least four.

    Examples
    --------
    >>> part_ids("B", 2)
    ('B0000', 'B0001')
    """
    width = max(4, len(str(count - 1)))
    return tuple(f"{letter}{number:0{width}d}" for number in range(count))


def select_parts(parts: PartsT, keep: BoolArray) -> PartsT:
    """Some of the parts, in the same order."""
    return parts if keep.all() else cast("PartsT", _select(parts, keep))


def _select(value: object, keep: BoolArray) -> object:
    """The chosen rows of an array, a tuple or a record; anything else as it is."""
    if isinstance(value, np.ndarray):
        return cast("FloatArray", value)[keep]
    if isinstance(value, tuple):
        return tuple(compress(cast("tuple[object, ...]", value), keep.tolist()))
    if not is_dataclass(value) or isinstance(value, type):
        return value
    chosen = {field.name: getattr(value, field.name) for field in fields(value)}
    offsets: IntArray | None = chosen.pop("offsets", None)
    of_corners = keep if offsets is None else np.repeat(keep, np.diff(offsets))
    for field in fields(value):
        if field.name in chosen:
            rows = of_corners if PER_CORNER.items() <= field.metadata.items() else keep
            chosen[field.name] = _select(chosen[field.name], rows)
    if offsets is not None:
        chosen["offsets"] = np.concatenate([[0], np.cumsum(np.diff(offsets)[keep])])
    return replace(value, **chosen)


def reject_parts(
    parts: PartsT, reasons: Mapping[int, str], code: str
) -> tuple[PartsT, tuple[RejectedPart, ...]]:
    """Take out the parts that cannot be made, by row: the others, and those taken out.

    The code is the number of the finding.
    """
    rejected = tuple(
        RejectedPart(parts.ids[row], int(parts.element_ids[row]), reason, code)
        for row, reason in sorted(reasons.items())
    )
    keep = np.ones(len(parts.ids), bool)
    keep[list(reasons)] = False
    return select_parts(parts, keep), rejected


def finite_parts(parts: Parts) -> BoolArray:
    """Which parts, their corners included, have finite numbers only, but for `MAY_BE_NAN`."""
    result = np.ones(len(parts.ids), bool)
    for field in fields(parts):
        value: object = vars(parts)[field.name]
        if is_dataclass(value) and not MAY_BE_NAN.items() <= field.metadata.items():
            result &= finite_parts(cast("Parts", value))
        elif isinstance(value, np.ndarray) and field.name != "offsets":
            numbers = cast("FloatArray", value)
            is_finite = np.isfinite(numbers).all(axis=tuple(range(1, numbers.ndim)))
            if PER_CORNER.items() <= field.metadata.items():
                starts = cast("IntArray", vars(parts)["offsets"])[:-1]
                is_finite = np.logical_and.reduceat(is_finite, starts)
            result &= is_finite
    return result
