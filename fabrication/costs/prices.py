"""Prices of a workshop, read from a TOML file; units are part of the names of its keys."""

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite
from pathlib import Path
from typing import Any, Final, cast

from ...kernel.errors import InputError

HIGHEST: Final = 1e12
"""A larger number is no price."""

_KEYS: Final = {
    "moulds": ("min_radius_m", "max_diameter_m", "each", "per_m2"),
    "blanks": ("each", "per_m2", "flat_per_m2"),
    "panels": ("each", "per_m2", "flat_per_m2"),
    "beams": ("each", "per_kg", "density_kg_m3", "per_cut"),
    "nodes": ("each",),
}
"""Keys of every table."""


@dataclass(frozen=True)
class MouldPrice:
    """Price of a mould of at least a radius for blanks of at most a diameter, in metres."""

    min_radius: float = 0.0
    max_diameter: float = inf
    each: float = 0.0
    per_m2: float = 0.0


@dataclass(frozen=True)
class SheetPrice:
    """Price by piece and by area, curved and flat."""

    each: float = 0.0
    per_m2: float = 0.0
    flat_per_m2: float = 0.0


@dataclass(frozen=True)
class BeamPrice:
    """Price by piece, by mass (density in kg/m³) and by cut."""

    each: float = 0.0
    per_kg: float = 0.0
    density: float = 0.0
    per_cut: float = 0.0


@dataclass(frozen=True)
class Prices:
    """Prices of a workshop; None where it says nothing.

    Attributes
    ----------
    moulds : tuple of MouldPrice
        The first that a mould fits is its price.
    node : float or None
        Of a piece.
    source : str
        Where the prices come from, for messages.
    """

    currency: str = ""
    moulds: tuple[MouldPrice, ...] = ()
    blanks: SheetPrice | None = None
    panels: SheetPrice | None = None
    beams: BeamPrice | None = None
    node: float | None = None
    source: str = field(default="prices", compare=False)


def read_prices(path: str | os.PathLike[str]) -> Prices:
    """Read a price file.

    Raises
    ------
    InputError
        If it cannot be read, is no TOML, or `parse_prices` refuses it.
    """
    file = Path(path)
    try:
        content = tomllib.loads(file.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{file} is not text in UTF-8: save it as such") from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{file} is no price file in TOML: {error}") from error
    return parse_prices(content, str(file))


def parse_prices(content: Mapping[str, Any], source: str = "prices") -> Prices:
    """Prices as the tables of a price file have them.

    Parameters
    ----------
    content : mapping
        ``currency`` and the tables moulds (one or a list), blanks, panels, beams, nodes.
    source : str
        How messages name it.

    Raises
    ------
    InputError
        If a table or key is unknown, a price is no number or negative, or nothing is priced;
        all faults are named.
    """
    faults: list[str] = []
    currency = content.get("currency", "")
    if not isinstance(currency, str) or not currency.isprintable() or len(currency) > 16:
        faults.append('currency must be a short text, such as "EUR"')
    faults += [
        f"unknown table or key {name!r}: there are currency and the tables {', '.join(_KEYS)}"
        for name in content
        if name != "currency" and name not in _KEYS
    ]
    tables = {name: _rows(content[name], name, faults) for name in _KEYS if name in content}
    _check_whole(tables, faults)
    if faults:
        count = f"{len(faults)} faults: " if len(faults) > 1 else ""
        raise InputError(f"{source}: {count}{'; '.join(faults)}")
    first = {name: rows[0] for name, rows in tables.items() if rows}
    return Prices(
        currency=str(currency),
        moulds=tuple(
            MouldPrice(
                row.get("min_radius_m", 0.0),
                row.get("max_diameter_m", inf),
                row.get("each", 0.0),
                row.get("per_m2", 0.0),
            )
            for row in tables.get("moulds", ())
        ),
        blanks=_sheet(first.get("blanks")),
        panels=_sheet(first.get("panels")),
        beams=_beam(first.get("beams")),
        node=first["nodes"]["each"] if "nodes" in first else None,
        source=source,
    )


def _rows(table: object, name: str, faults: list[str]) -> list[dict[str, float]]:
    """Numbers of a table, or of each of a list of moulds; faults are added."""
    is_list = name == "moulds" and isinstance(table, list)
    rows: list[object] = cast("list[object]", table) if is_list else [table]
    found: list[dict[str, float]] = []
    for i, row in enumerate(rows):
        where = f"[[moulds]] no. {i + 1}" if is_list else f"[{name}]"
        if not isinstance(row, Mapping):
            faults.append(f"{where} must be a table with the keys {', '.join(_KEYS[name])}")
            continue
        entries = cast("Mapping[str, object]", row)
        known = {key: value for key, value in entries.items() if key in _KEYS[name]}
        faults += [
            f"unknown key {key!r} in {where}: it has {', '.join(_KEYS[name])}; units are part "
            "of the names"
            for key in entries
            if key not in known
        ]
        faults += [
            f"{key} = {value!r} in {where} {fault}"
            for key, value in known.items()
            if (fault := _fault(value))
        ]
        found.append({k: float(v) for k, v in known.items() if isinstance(v, int | float)})
    return found


def _fault(value: object) -> str:
    """What keeps a value from being a price or size; empty if nothing does."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "must be a number alone: its unit is in the name of the key"
    if not isfinite(value) or abs(value) > HIGHEST:
        return f"must be a number up to {HIGHEST:g}"
    return "must not be negative" if value < 0 else ""


def _check_whole(tables: Mapping[str, list[dict[str, float]]], faults: list[str]) -> None:
    """What must stand together, stands together."""
    if faults:
        return
    if not any(tables.values()):
        faults.append(f"nothing is priced: add a table of {', '.join(_KEYS)}")
    for name, rows in tables.items():
        prices = [key for key in _KEYS[name] if key == "each" or "per_" in key]
        if not rows or not all(row.keys() & set(prices) for row in rows):
            faults.append(f"[{name}] needs a price: {' or '.join(prices)}")
    beams = tables.get("beams", [])
    if beams and "per_kg" in beams[0] and not beams[0].get("density_kg_m3"):
        faults.append("per_kg in [beams] needs density_kg_m3, such as 7850 for steel")


def _sheet(row: Mapping[str, float] | None) -> SheetPrice | None:
    if row is None:
        return None
    curved = row.get("per_m2", 0.0)
    return SheetPrice(row.get("each", 0.0), curved, row.get("flat_per_m2", curved))


def _beam(row: Mapping[str, float] | None) -> BeamPrice | None:
    if row is None:
        return None
    names = ("each", "per_kg", "density_kg_m3", "per_cut")
    return BeamPrice(*(row.get(name, 0.0) for name in names))
