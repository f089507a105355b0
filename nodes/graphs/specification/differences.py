"""What makes one graph of another."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from ..annotations import Value
from .file import content_of
from .specification import Specification


@dataclass(frozen=True)
class Difference:
    """One thing that two graphs do not have in common.

    Attributes
    ----------
    change : {"added", "removed", "changed"}
    what : str
        Where: ``"steps.fit"``, ``"steps.fit.inputs.mesh"``, ``"params.k.value"``.
    before, after : object
        As the graph file has them; None for what is not there.
    """

    change: Literal["added", "removed", "changed"]
    what: str
    before: Value = None
    after: Value = None

    def __str__(self) -> str:
        if self.change == "changed":
            return f"{self.what}: {_brief(self.before)} -> {_brief(self.after)}"
        return f"{self.change} {self.what}"


def differences(before: Specification, after: Specification) -> tuple[Difference, ...]:
    """What makes one graph of another, in the order of the file."""
    first, second = content_of(before), content_of(after)
    for content in (first, second):
        content.pop("version")  # follows from the rest
    return tuple(_between("", first, second))


def _between(at: str, before: Mapping[str, Any], after: Mapping[str, Any]) -> list[Difference]:
    found: list[Difference] = []
    for name in dict.fromkeys((*before, *after)):
        where = f"{at}.{name}" if at else name
        a, b = before.get(name), after.get(name)
        if name not in before and not _is_room(where):
            found.append(Difference("added", where, None, b))
        elif name not in after and not _is_room(where):
            found.append(Difference("removed", where, a, None))
        elif a == b:
            continue
        elif where.count(".") < _DEPTHS.get(where.partition(".")[0], 0):
            found += _between(where, a or {}, b or {})
        else:
            found.append(Difference("changed", where, a, b))
    return found


_DEPTHS = {"params": 2, "steps": 3, "groups": 1, "comments": 1}
"""How far down differences are told one by one."""


def _is_room(where: str) -> bool:
    """Whether it is a part of every graph file, written or not."""
    return where in _DEPTHS


def _brief(value: Value) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
