"""Numbers, strings and references in the text of STEP files (ISO 10303-21)."""

import re
from collections.abc import Iterable
from typing import Final


def real(number: float) -> str:
    """The least digits that are read back as the same number, with a point and a capital E.

    Examples
    --------
    >>> real(0.1), real(-2.0), real(1e-07), real(2.5e+16)
    ('0.1', '-2.0', '1.E-07', '2.5E+16')
    """
    text = repr(number)
    return capital_exponents(text) if "e" in text else text


def capital_exponents(text: str) -> str:
    """A text of capitals and of numbers as Python writes them, with exponents as STEP has them.

    Examples
    --------
    >>> capital_exponents("(1e-07,-2.5e+16,3.25)")
    '(1.E-07,-2.5E+16,3.25)'
    """
    return _EXPONENT.sub(lambda found: f"{found[1]}{found[2] or '.'}E", text)


_EXPONENT: Final = re.compile(r"(\d)(\.\d+)?e")


def references(ids: Iterable[int]) -> str:
    """References, separated by commas, ten to a line.

    Examples
    --------
    >>> references([1, 2])
    '#1,#2'
    """
    words = [f"#{entity}" for entity in ids]
    return ",\n".join(",".join(words[i : i + 10]) for i in range(0, len(words), 10))


def numbers(values: Iterable[float]) -> str:
    """Numbers of a point or direction: the numbers, separated by commas."""
    return ",".join(map(real, values))


def string(text: str) -> str:
    r"""A text in quotes, characters beyond ASCII as directives of ISO 10303-21.

    Those of the basic plane by two bytes each, which more programs read than four.

    Examples
    --------
    >>> print(string("Dach's Höhe 屋根 🏠"))
    'Dach''s H\X2\00F6\X0\he \X2\5C4B6839\X0\ \X4\0001F3E0\X0\'
    """
    quoted = text.replace("\\", "\\\\").replace("'", "''")
    return "'" + _BASIC.sub(_two_bytes, _BEYOND.sub(_four_bytes, quoted)) + "'"


_BASIC: Final = re.compile("[\0-\x1f\x7f-\uffff]+")
_BEYOND: Final = re.compile("[\U00010000-\U0010ffff]+")
"""Runs of characters that a file cannot hold as such, on and beyond the basic plane."""


def _two_bytes(run: re.Match[str]) -> str:
    return f"\\X2\\{''.join(f'{ord(character):04X}' for character in run[0])}\\X0\\"


def _four_bytes(run: re.Match[str]) -> str:
    return f"\\X4\\{''.join(f'{ord(character):08X}' for character in run[0])}\\X0\\"
