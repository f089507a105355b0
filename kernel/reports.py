"""Reports: what an operation says of its result, as records that read like dictionaries."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class Report(Mapping[str, Any]):
    """A frozen record that is a mapping of its fields.

    Every kind of report is a subclass of its own, so that a wire to the wrong input is refused.
    The values of the fields are plain: ``json.dumps(dict(report))`` writes them.

    Examples
    --------
    >>> @dataclass(frozen=True, eq=False)
    ... class Count(Report):
    ...     written: int
    >>> report = Count(written=3)
    >>> report.written, report["written"], dict(report)
    (3, 3, {'written': 3})
    """

    def __getitem__(self, key: str) -> Any:  # noqa: ANN401
        if key not in self.__dataclass_fields__:
            raise KeyError(key)
        return getattr(self, key)

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dataclass_fields__)

    def __len__(self) -> int:
        return len(self.__dataclass_fields__)
