"""What a sweep found: rows, and a table for spreadsheets, pandas and Parquet."""

import csv
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from ....fabrication.files import check_suffix, replacing
from ..annotations import Value
from ..errors import GraphError

_MOST_IN_A_CELL = 20
LAST_COLUMNS = ("steps_run", "seconds", "warnings", "error", "folder")


class Row(tuple[dict[str, Any], Any]):
    """The values of the sliders and the result of one point: a pair that knows more.

    Attributes
    ----------
    error : str
        Why the point failed; empty if it did not. Its result is None then.
    warnings : tuple of str
        What the steps warned about.
    seconds : float
    steps_run : int or None
        How many steps were run; the others were known already.
    folder : str
        Where its files are; empty if none were asked for.
    """

    error: str
    warnings: tuple[str, ...]
    seconds: float
    steps_run: int | None
    folder: str

    def __new__(
        cls,
        point: Mapping[str, Any],
        value: Value,
        *,
        error: str = "",
        warnings: Iterable[str] = (),
        seconds: float = 0.0,
        steps_run: int | None = None,
        folder: str = "",
    ) -> "Row":
        """Make the pair, and keep the rest beside it.

        Parameters
        ----------
        point : mapping of str to object
        value : object
        error, warnings, seconds, steps_run, folder : object
            As the attributes.

        Returns
        -------
        Row
            The pair.
        """
        row = super().__new__(cls, (dict(point), value))
        row.error, row.warnings, row.seconds = error, tuple(warnings), seconds
        row.steps_run, row.folder = steps_run, folder
        return row

    @property
    def point(self) -> dict[str, Any]:  # numpydoc ignore=RT01
        """The values of the sliders."""
        return self[0]

    @property
    def value(self) -> Value:  # numpydoc ignore=RT01
        """What `Graph.run` gives for them; None if it failed."""
        return self[1]


class Sweep(list[Row]):
    """The rows of a sweep, in the order of its points.

    Parameters
    ----------
    rows : iterable of Row
    targets : sequence of str
        Names of what was run.
    """

    def __init__(self, rows: Iterable[Row], targets: Sequence[str]) -> None:
        super().__init__(rows)
        self.targets = tuple(targets)

    @property
    def failures(self) -> list[Row]:  # numpydoc ignore=RT01
        """The rows that have no result."""
        return [row for row in self if row.error]

    def table(self, fields: Sequence[str] | None = None) -> list[dict[str, Any]]:
        """The rows as records of numbers and texts.

        Parameters
        ----------
        fields : sequence of str, optional
            Of reports, with dots: ``"angles_deg.mean"``; by default all that are numbers or
            texts.

        Returns
        -------
        list of dict
            Sliders, fields of the results, ``steps_run``, ``seconds``, ``warnings``,
            ``error`` and ``folder``.

        Raises
        ------
        GraphError
            If a field is in no result.
        """
        records: list[dict[str, Any]] = []
        for row in self:
            several = len(self.targets) != 1
            values = row.value if several and row.value is not None else (row.value,)
            found: dict[str, Any] = {}
            for target, value in zip(self.targets, values, strict=False):
                _flatten(value, target if several else "", target, found)
            records.append(found)
        return [
            {
                **{name: _cell(value) for name, value in row.point.items()},
                **record,
                "steps_run": row.steps_run,
                "seconds": round(row.seconds, 4),
                "warnings": "; ".join(row.warnings),
                "error": row.error,
                "folder": row.folder,
            }
            for row, record in zip(self, _chosen(records, fields), strict=True)
        ]

    def save(self, path: str | os.PathLike[str], fields: Sequence[str] | None = None) -> None:
        """Write the table as CSV, or as Parquet with pandas and pyarrow.

        Parameters
        ----------
        path : path
            Ends in ``.csv`` or ``.parquet``.
        fields : sequence of str, optional
            As in `table`.
        """
        check_suffix(path, ".csv", ".parquet")
        if Path(path).suffix.lower() == ".parquet":
            frame = self.to_pandas(fields)
            with replacing(path) as temporary:
                frame.to_parquet(temporary)
            return
        records = self.table(fields)
        with (
            replacing(path) as temporary,
            temporary.open("w", encoding="utf-8", newline="") as file,
        ):
            writer = csv.DictWriter(file, columns_of(records), restval="")
            writer.writeheader()
            writer.writerows(records)

    def to_pandas(self, fields: Sequence[str] | None = None) -> Any:  # noqa: ANN401
        """The table as a data frame of pandas, which must be installed.

        Parameters
        ----------
        fields : sequence of str, optional
            As in `table`.

        Returns
        -------
        pandas.DataFrame
            A row for each point.

        Raises
        ------
        GraphError
            If pandas is not installed.
        """
        import importlib

        try:
            pandas = importlib.import_module("pandas")
        except ImportError as error:
            raise GraphError("a data frame needs pandas: pip install pandas") from error
        records = self.table(fields)
        return pandas.DataFrame(records, columns=columns_of(records))


def columns_of(records: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of all columns: those that only some rows have stand before the last ones."""
    names = dict.fromkeys(name for record in records for name in record)
    return [*(name for name in names if name not in LAST_COLUMNS), *LAST_COLUMNS]


def _chosen(
    records: list[dict[str, Any]], fields: Sequence[str] | None
) -> list[dict[str, Any]]:
    if fields is None:
        return records
    known = dict.fromkeys(name for record in records for name in record)
    for field in fields:
        if known and not any(_is_field(name, field) for name in known):
            names = ", ".join(list(known)[:12])
            raise GraphError(f"no result has a field {field!r}; there are {names}")
    return [
        {name: x for name, x in record.items() if any(_is_field(name, f) for f in fields)}
        for record in records
    ]


def _is_field(name: str, field: str) -> bool:
    """Whether a field is a part of a name, from dot to dot."""
    return f".{field}." in f".{name}."


def _flatten(value: Value, name: str, target: str, found: dict[str, Any]) -> None:
    """Numbers and texts of a result by their names with dots; long lists are left out."""
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, np.generic):
        value = cast("Any", value).item()
    if isinstance(value, Mapping):
        for key, item in cast("Mapping[str, Any]", value).items():
            _flatten(item, f"{name}.{key}" if name else str(key), target, found)
    elif isinstance(value, bool | int | float | str):
        found[name or target] = value
    elif _is_short(value):
        found[name or target] = " ".join(map(str, cast("list[Any]", value)))


def _is_short(value: Value) -> bool:
    """Whether it is a list of few numbers, such as the radii of moulds."""
    if isinstance(value, np.ndarray):
        return value.ndim == 1 and value.size <= _MOST_IN_A_CELL
    if not isinstance(value, list | tuple):
        return False
    several = cast("list[Any]", value)
    return len(several) <= _MOST_IN_A_CELL and all(isinstance(x, int | float) for x in several)


def _cell(value: Value) -> Value:
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return " ".join(str(value).split())
