"""Reports: what an operation says of its result, as records that read like dictionaries."""

import html
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

_LONG = 60
"""Characters of a value that a line about a report has room for."""


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
    >>> report
    Count(written=3)
    """

    def __init_subclass__(cls) -> None:
        # A dataclass would write a __repr__ of its own, with every entry of every list.
        cls.__repr__ = Report.__repr__

    def __repr__(self) -> str:
        entries = ", ".join(f"{name}={_brief(value)}" for name, value in self.items())
        return f"{type(self).__name__}({entries})"

    def _repr_html_(self) -> str:
        """The table that a notebook shows."""
        rows = "".join(
            f'<tr><th style="text-align:left;vertical-align:top">{html.escape(name)}</th>'
            f'<td style="text-align:left">{_cell(value)}</td></tr>'
            for name, value in self.items()
        )
        title = html.escape(type(self).__name__)
        return f'<table><caption style="text-align:left">{title}</caption>{rows}</table>'

    def __getitem__(self, key: str) -> Any:  # noqa: ANN401
        if key not in self.__dataclass_fields__:
            raise KeyError(key)
        return getattr(self, key)

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dataclass_fields__)

    def __len__(self) -> int:
        return len(self.__dataclass_fields__)


def _brief(value: object) -> str:
    """A value in few characters: numbers in four digits, long lists by their length."""
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Mapping):
        items = cast("Mapping[str, object]", value).items()
        text = "{" + ", ".join(f"{key!r}: {_brief(item)}" for key, item in items) + "}"
        return text if len(text) <= _LONG else f"{{... {len(items)} entries}}"
    if isinstance(value, list | tuple):
        several = cast("Sequence[object]", value)
        text = "[" + ", ".join(map(_brief, several[:_LONG])) + "]"
        is_short = len(text) <= _LONG and len(several) <= _LONG
        return text if is_short else f"[... {len(several)} items]"
    text = " ".join(repr(value).split())
    return text if len(text) <= _LONG else f"{text[: _LONG - 4]}...{text[-1]}"


def _cell(value: object) -> str:
    if isinstance(value, Mapping):
        items = cast("Mapping[str, object]", value).items()
        return "<br>".join(f"{html.escape(str(key))}: {_cell(item)}" for key, item in items)
    return html.escape(value if isinstance(value, str) else _brief(value))
