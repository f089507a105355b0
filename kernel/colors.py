"""Names and colours of moulds: the same in every file, picture and viewer."""

import math
from typing import TypeAlias

Color: TypeAlias = tuple[int, int, int]

UNLABELLED: Color = (178, 182, 187)
"""Light grey of panels that belong to no mould."""

_LIGHTNESSES = (0.74, 0.52)
_CHROMA = 0.15


def mould_name(label: int, count: int) -> str:
    """
    Name of a mould, for layers and schedules.

    Parameters
    ----------
    label : int
        Mould, from 0; -1 for a panel without mould.
    count : int
        Number of moulds.

    Returns
    -------
    str
        ``Mould 01`` for the first; ``Panels`` for panels without mould.

    Examples
    --------
    >>> mould_name(0, 8)
    'Mould 01'
    >>> mould_name(8, 120)
    'Mould 009'
    """
    if label < 0:
        return "Panels"
    width = max(2, len(str(count)))
    return f"Mould {label + 1:0{width}d}"


def mould_color(label: int, count: int) -> Color:
    """
    Colour of a mould, told apart from the colours of the other moulds.

    Parameters
    ----------
    label : int
        Mould, from 0; -1 for a panel without mould.
    count : int
        Number of moulds.

    Returns
    -------
    tuple of int
        Red, green and blue from 0 to 255 (sRGB).

    Notes
    -----
    Hues are spread evenly over the circle of the OKLCH space, from more than five moulds on
    light and dark in turn. Labels follow the hues: moulds sorted by radius read as a scale.

    References
    ----------
    B. Ottosson, A perceptual color space for image processing (OKLab), 2020.

    Examples
    --------
    >>> mould_color(0, 8)
    (251, 131, 113)
    >>> mould_color(-1, 8) == UNLABELLED
    True
    """
    if label < 0:
        return UNLABELLED
    is_few = count <= 5
    lightness = _LIGHTNESSES[0 if is_few else label % 2]
    # An even number of steps: the last hue and the first must not share their lightness.
    steps = max(count, 1) if is_few else count + count % 2
    hue = math.radians(30) + 2 * math.pi * label / steps
    chroma = _CHROMA
    while (color := _linear_rgb(lightness, chroma, hue)) is None:
        chroma *= 0.97
    red, green, blue = (round(255 * _encode(value)) for value in color)
    return red, green, blue


def _linear_rgb(
    lightness: float, chroma: float, hue: float
) -> tuple[float, float, float] | None:
    """Linear red, green and blue of an OKLCH colour; None outside the display's range."""
    a, b = chroma * math.cos(hue), chroma * math.sin(hue)
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    red = 4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short
    green = -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short
    blue = -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short
    is_shown = all(0 <= value <= 1 for value in (red, green, blue))
    return (red, green, blue) if is_shown else None


def _encode(value: float) -> float:
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055
