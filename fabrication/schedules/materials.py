"""Materials and their densities."""

from typing import Final, NamedTuple

import numpy as np

from ...kernel.errors import InputError

DENSITIES: Final = {
    "glass": 2500.0, "steel": 7850.0, "stainless steel": 7900.0, "aluminium": 2700.0,
    "concrete": 2400.0, "timber": 500.0,
}  # fmt: skip
"""Kilograms in a cubic metre."""


class Material(NamedTuple):
    """A name, and the kilograms in a cubic metre."""

    name: str
    density: float


def parse_material(text: str) -> Material:
    """A material that is known by its name, or any other with its density.

    Raises InputError if it is neither.

    Examples
    --------
    >>> parse_material("steel")
    Material(name='steel', density=7850.0)
    >>> parse_material("GFRC=1900")
    Material(name='GFRC', density=1900.0)
    """
    name, sign, number = (word.strip() for word in text.partition("="))
    if not sign:
        if name in DENSITIES:
            return Material(name, DENSITIES[name])
    elif name:
        try:
            density = float(number)
        except ValueError:
            density = np.nan
        if np.isfinite(density) and density > 0:
            return Material(name, density)
    known = ", ".join(DENSITIES)
    raise InputError(
        f"unknown material {text!r}: use one of {known}, or a name and its density in kg/m³, "
        "such as GFRC=1900"
    )
