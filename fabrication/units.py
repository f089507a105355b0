"""Units of length: the only place that knows what a millimetre is."""

from typing import Final

from ..kernel.errors import InputError

MILLIMETERS: Final = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}
"""Millimetres per model unit."""

SQUARE_METER: Final = 1e6
"""Square millimetres in a square metre."""

CUBIC_METER: Final = 1e9
"""Cubic millimetres in a cubic metre."""


def millimeters_per(units: str) -> float:
    """Millimetres in one model unit.

    Parameters
    ----------
    units : str
        One of ``mm``, ``cm``, ``m``, ``in``, ``ft``.

    Raises
    ------
    InputError
        If the unit is not known.

    Examples
    --------
    >>> millimeters_per("ft")
    304.8
    """
    if units not in MILLIMETERS:
        raise InputError(f"unknown units {units!r}: use one of {', '.join(MILLIMETERS)}")
    return MILLIMETERS[units]
