"""Rectangles on stock sheets, as few as a short search finds, by rectpack."""

from dataclasses import dataclass
from math import ceil
from typing import Any, Final, Literal, TypeAlias

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, IntArray
from ...kernel.errors import InputError, MissingLibraryError

# What comes from rectpack is not typed.
_Untyped: TypeAlias = Any

Grain = Literal["along", "any"]

_LARGEST: Final = 1e6
"""Millimetres: no sheet is a kilometre long."""

_STEPS_PER_MM: Final = 1000
"""Lengths are whole micrometres, rounded up: rectpack is exact on whole numbers."""

_THOROUGH: Final = 600
"""Rectangles up to which every way is tried that is slow for many."""


_Placed: TypeAlias = tuple[int, int, int, int, int, int]
"""Sheet, x, y, width, height and number of a piece."""


@dataclass(frozen=True)
class Stock:
    """Sheets to cut from, in millimetres.

    Attributes
    ----------
    size : (float, float)
        Width and height.
    kerf : float
        Width of the cut, or whatever is to stay between pieces.
    margin : float
        Least distance from the rim of the sheet.
    grain : {"along", "any"}
        Whether pieces lie along the width of the sheet, or may be turned by a right angle.
    """

    size: tuple[float, float] = (3000.0, 1500.0)
    kerf: float = 4.0
    margin: float = 10.0
    grain: Grain = "along"


@dataclass(frozen=True)
class Nesting:
    """Where pieces lie.

    Attributes
    ----------
    places : (n, 2) float array
        Lower left corners on their sheets, as the pieces lie.
    is_turned : (n,) bool array
        Pieces turned by a right angle, counter-clockwise.
    sheets : (n,) int array
        Sheet of each piece, from 0.
    oversize : list of int
        Pieces larger than a sheet: each has one of its own, the last ones.
    count : int
        Number of sheets, without those of the oversize.
    bound : int
        Sheets that are needed by the areas of the pieces alone.
    waste : float
        Share of the sheets that becomes no piece.
    """

    places: FloatArray
    is_turned: BoolArray
    sheets: IntArray
    oversize: list[int]
    count: int
    bound: int
    waste: float


def nest_rectangles(sizes: FloatArray, stock: Stock) -> Nesting:
    """Lay rectangles (n, 2) on sheets.

    Raises
    ------
    InputError
        If sheet, kerf or margin are no lengths.
    MissingLibraryError
        If rectpack is missing.
    """
    room = _check_room(stock)
    count = len(sizes)
    places, turned = np.full((count, 2), stock.margin), np.zeros(count, bool)
    sheets = np.zeros(count, np.int64)
    fits = (sizes <= room).all(axis=1)
    if stock.grain == "any":
        fits |= (sizes[:, ::-1] <= room).all(axis=1)
    rows = np.flatnonzero(fits)
    needed = _whole(sizes[rows] + stock.kerf)
    bin_size = (np.floor((room + stock.kerf) * _STEPS_PER_MM)).astype(int).tolist()
    with_kerf = float((sizes[rows] + stock.kerf).prod(axis=1).sum())
    bound = ceil(with_kerf / float((room + stock.kerf).prod()) - 1e-9)
    best: list[_Placed] = []
    if len(rows):
        best = _best_packing(needed, bin_size, bound, can_turn=stock.grain == "any")
    n_sheets = 1 + max((place[0] for place in best), default=-1)
    for sheet, x, y, width, height, piece in best:
        row = rows[piece]
        sheets[row] = sheet
        places[row] = np.array([x, y]) / _STEPS_PER_MM + stock.margin
        turned[row] = (width, height) != tuple(needed[piece])
    oversize: list[int] = np.flatnonzero(~fits).tolist()
    sheets[oversize] = n_sheets + np.arange(len(oversize))
    areas = float(sizes[rows].prod(axis=1).sum())
    total = n_sheets * stock.size[0] * stock.size[1]
    waste = 1 - areas / total if total else 0.0
    return Nesting(places, turned, sheets, oversize, n_sheets, bound, waste)


def _check_room(stock: Stock) -> FloatArray:
    """Width and height of a sheet within its margins."""
    numbers = np.array([*stock.size, stock.kerf, stock.margin])
    room = np.array(stock.size) - 2 * stock.margin
    is_sheet = np.isfinite(numbers).all() and numbers.min() >= 0 and room.min() > 0
    if not (is_sheet and numbers.max() <= _LARGEST and stock.kerf < room.min()):
        raise InputError(
            f"sheet {stock.size}, kerf {stock.kerf:g} and margin {stock.margin:g} must be "
            f"lengths of up to {_LARGEST:.0f} mm, and leave room on the sheet"
        )
    return room


def _whole(sizes: FloatArray) -> list[tuple[int, int]]:
    numbers = np.ceil(sizes * _STEPS_PER_MM - 1e-6).astype(int)
    return [(width, height) for width, height in numbers.tolist()]


def _best_packing(
    sizes: list[tuple[int, int]], bin_size: list[int], bound: int, *, can_turn: bool
) -> list[_Placed]:
    """The fewest sheets of a few ways to fill them; no more ways once they are at the bound."""
    try:
        import rectpack  # pyright: ignore[reportMissingTypeStubs]
    except ImportError as error:
        raise MissingLibraryError(
            "nesting needs rectpack: install spheremesh[drawings], or lay pieces in rows"
        ) from error
    library: _Untyped = rectpack
    ways = [
        (library.GuillotineBssfSas, library.PackingBin.BFF),  # by far the fastest
        (library.MaxRectsBssf, library.PackingBin.BFF),
        (library.MaxRectsBaf, library.PackingBin.BFF),
    ]
    if len(sizes) <= _THOROUGH:
        ways += [
            (library.MaxRectsBssf, library.PackingBin.Global),
            (library.MaxRectsBaf, library.PackingBin.Global),
            (library.GuillotineBafSlas, library.PackingBin.Global),
        ]
    best: list[_Placed] = []
    for rule, order in ways:
        packer = library.newPacker(bin_algo=order, pack_algo=rule, rotation=can_turn)
        for piece, size in enumerate(sizes):
            packer.add_rect(*size, piece)
        packer.add_bin(*bin_size, count=float("inf"))
        packer.pack()
        found: list[_Placed] = packer.rect_list()
        if not best or max(p[0] for p in found) < max(p[0] for p in best):
            best = found
        if max(p[0] for p in best) < bound:
            break
    return best
