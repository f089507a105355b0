"""Numbered entities of IFC files; what is rooted has a GlobalId that stays.

A GlobalId is made of the name of the model and of what it stands for: writing again, after the
design has changed, gives each part the same, so that other models can refer to it.
"""

from collections.abc import Iterable
from typing import Final
from uuid import NAMESPACE_URL, UUID, uuid5

from ..step.values import numbers, references, string

_NAMESPACE: Final = uuid5(NAMESPACE_URL, "urn:spheremesh:ifc")

_DIGITS: Final = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$"


def global_id(*names: str) -> str:
    """The 22 digits, of 64, of what names stand for.

    Examples
    --------
    >>> global_id("roof", "panel", "P0007") == global_id("roof", "panel", "P0007")
    True
    >>> len(global_id("roof", "panel", "P0007"))
    22
    """
    return compressed(uuid5(_NAMESPACE, "/".join(names)))


def compressed(uuid: UUID) -> str:
    """A UUID as IFC writes it.

    Examples
    --------
    >>> compressed(UUID("f81d4fae-7dec-11d0-a765-00a0c91e6bf6"))
    '3u7K_kVUmHqA$gG2g9DtJs'
    """
    digits: list[str] = []
    number = uuid.int
    for _ in range(22):
        digits.append(_DIGITS[number % 64])
        number //= 64
    return "".join(reversed(digits))


class Entities:
    """Entities as they are numbered."""

    def __init__(self, model: str) -> None:
        self.lines: list[str] = []
        self.count = 0
        self._model = model

    def add(self, text: str) -> int:
        """Number of an entity."""
        self.count += 1
        self.lines.append(f"#{self.count}={text};\n")
        return self.count

    def append(self, text: str, count: int) -> int:
        """Number of the first of several entities, which are numbered already."""
        first = self.count + 1
        self.lines.append(text)
        self.count += count
        return first

    def rooted(self, kind: str, name: str, rest: str, *, role: str = "") -> int:
        """Number of an entity with a GlobalId, of its kind and name, and that name."""
        root = global_id(self._model, role or kind, name)
        quoted = string(name) if name else "$"
        return self.add(f"{kind}('{root}',$,{quoted},$,{rest})")

    def relation(self, kind: str, name: str, rest: str) -> int:
        """Number of a relation with a GlobalId, which shows no name."""
        return self.add(f"{kind}('{global_id(self._model, kind, name)}',$,$,$,{rest})")

    def assign(self, kind: str, name: str, members: Iterable[int], to: int) -> int:
        """Number of a relation of members to an entity."""
        return self.relation(kind, name, f"({references(members)}),#{to}")

    def assign_to(self, kind: str, name: str, whole: int, members: Iterable[int]) -> int:
        """Number of a relation of an entity to its members."""
        return self.relation(kind, name, f"#{whole},({references(members)})")

    def point(self, place: Iterable[float]) -> int:
        """Number of a point."""
        return self.add(f"IFCCARTESIANPOINT(({numbers(place)}))")
