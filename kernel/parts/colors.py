"""Names and colours of moulds: the same in every file and picture."""

from math import cos, sin
from typing import Final, TypeAlias

Color: TypeAlias = tuple[int, int, int]

UNLABELLED: Final[Color] = (178, 182, 187)
"""Light grey of panels that belong to no mould."""

BEAM_COLOR: Final[Color] = (112, 92, 74)
"""Brown of beams, which no mould has."""

NODE_COLOR: Final[Color] = (84, 88, 94)
"""Dark grey of node cylinders."""

AXIS_COLOR: Final[Color] = (24, 24, 24)
"""Nearly black, of lines."""

_HUES: Final = (4.45, 1.1)  # radians: from blue over green to sand
_LIGHTNESSES: Final = (0.50, 0.87)
_CHROMA: Final = 0.11


def mould_name(label: int, count: int) -> str:
    """Name of a mould, for layers and schedules; ``Panels`` for panels without mould (-1).

    Examples
    --------
    >>> mould_name(0, 8)
    'Mould 01'
    >>> mould_name(8, 120)
    'Mould 009'
    """
    if label < 0:
        return "Panels"
    return f"Mould {mould_number(label, count)}"


def mould_number(label: int, count: int) -> str:
    """Number of a mould, as its name has it: ``01`` for the first; ``-`` for -1, no mould."""
    width = max(2, len(str(count)))
    return f"{label + 1:0{width}d}" if label >= 0 else "-"


def mould_color(label: int, count: int) -> Color:
    """Colour of a mould, 0 the sharpest of `count` and -1 none: sRGB from 0 to 255.

    Notes
    -----
    A path through the OKLab colour space, where equal steps look equal: from a dark blue for
    the sharpest mould over green to a pale sand for the flattest. Lightness rises with
    the hue, so that grey prints keep the order.

    References
    ----------
    B. Ottosson, A perceptual color space for image processing, 2020.

    Examples
    --------
    >>> mould_color(-1, 8)
    (178, 182, 187)
    >>> len({mould_color(label, 60) for label in range(60)})
    60
    """
    if label < 0:
        return UNLABELLED
    share = label / max(count - 1, 1)
    hue = _HUES[0] + share * (_HUES[1] - _HUES[0])
    lightness = _LIGHTNESSES[0] + share * (_LIGHTNESSES[1] - _LIGHTNESSES[0])
    return _oklab_to_srgb(lightness, _CHROMA * cos(hue), _CHROMA * sin(hue))


def _oklab_to_srgb(lightness: float, a: float, b: float) -> Color:
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    red = 4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short
    green = -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short
    blue = -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short
    return _gamma(red), _gamma(green), _gamma(blue)


def _gamma(linear: float) -> int:
    value = min(max(linear, 0.0), 1.0)
    curve = 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055
    return round(255 * curve)
