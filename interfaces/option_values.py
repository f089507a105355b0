"""Values of options of the command line that are more than a number or a word."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, cast

import click

MOST_ROWS: Final = 2000
MOST_VALUES: Final = 100_000

SUPPORTS: Final = ("axis", "exact", "bisector")
"""Words that --support takes; without one it means the first."""


def vector_option(
    _context: click.Context, _option: click.Parameter, text: str | None
) -> tuple[float, float, float] | None:
    """A vector, such as ``1,0.5,0``.

    Parameters
    ----------
    text : str or None
        What the user wrote.

    Returns
    -------
    (float, float, float) or None
        The vector; None without the option.

    Raises
    ------
    click.BadParameter
        If they are not three finite numbers, one of them other than 0.
    """
    if text is None:
        return None
    try:
        x, y, z = (float(number) for number in text.split(","))
    except ValueError:
        x = y = z = 0.0
    if not 0 < abs(x) + abs(y) + abs(z) < float("inf"):
        raise click.BadParameter(f"a vector is three numbers such as 1,0.5,0, not {text!r}")
    return x, y, z


def rows_option(
    _context: click.Context, _option: click.Parameter, text: str | None
) -> tuple[int, int] | None:
    """Two numbers of rows, such as ``12,20``.

    Parameters
    ----------
    text : str or None
        What the user wrote.

    Returns
    -------
    (int, int) or None
        The numbers; None without the option.

    Raises
    ------
    click.BadParameter
        If they are not two whole numbers from 1 to 2000.
    """
    if text is None:
        return None
    numbers = text.split(",")
    if len(numbers) != 2 or not all(each.strip().isdecimal() for each in numbers):
        raise click.BadParameter(f"{text!r} are not two numbers such as 12,20")
    n_u, n_v = (int(each) for each in numbers)
    if not 1 <= min(n_u, n_v) <= max(n_u, n_v) <= MOST_ROWS:
        raise click.BadParameter(f"numbers of rows are from 1 to {MOST_ROWS}, not {text}")
    return n_u, n_v


def joined_option(
    _context: click.Context, _option: click.Parameter, names: tuple[str, ...]
) -> str:
    """An option that may be repeated, as one list with commas."""
    return ",".join(names)


def plain_value(value: Any) -> Any:  # noqa: ANN401
    """A JSON value of a result: no infinities; what has no JSON form is described."""
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        items = cast("Mapping[str, Any]", value)
        return {str(name): plain_value(item) for name, item in items.items()}
    if isinstance(value, list | tuple):
        return [plain_value(item) for item in cast("list[Any]", value)]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, bool | int | str):
        return value
    return type(value).__name__


def spell_support(arguments: Sequence[str]) -> list[str]:
    """Arguments in which --support has a word of its own.

    Only the words of `SUPPORTS` are taken: in ``--support roof.obj`` the file is the mesh.

    Examples
    --------
    >>> spell_support(["--support", "roof.obj"]), spell_support(["--support", "exact"])
    (['--support=axis', 'roof.obj'], ['--support=exact'])
    """
    result: list[str] = []
    left = list(arguments)
    while left:
        argument = left.pop(0)
        if argument == "--":
            return [*result, argument, *left]
        if argument == "--support":
            word = left.pop(0) if left and left[0] in SUPPORTS else SUPPORTS[0]
            argument = f"--support={word}"
        result.append(argument)
    return result


def setting(text: str) -> tuple[str, Any]:
    """A slider and its value, from ``NAME=VALUE``; what is no JSON is a text.

    Raises
    ------
    click.UsageError
        If there is no ``=``.
    """
    name, value = _name_and_value(text)
    return name, _value(value)


def settings(text: str) -> tuple[str, list[Any]]:
    """A slider and its values, from ``NAME=A,B,C`` or ``NAME=START:STOP:COUNT``.

    Examples
    --------
    >>> settings("k=3,6"), settings("t=0:1:3"), settings("kind=best,fast")
    (('k', [3, 6]), ('t', [0.0, 0.5, 1.0]), ('kind', ['best', 'fast']))
    """
    name, value = _name_and_value(text)
    spread = _spread(value)
    if spread is not None:
        return name, spread
    try:
        several = json.loads(f"[{value}]")
    except (ValueError, RecursionError):
        several = [_value(item) for item in value.split(",")]
    if not several:
        raise click.UsageError(f"--set {text}: name at least one value")
    return name, several


def _spread(text: str) -> list[Any] | None:
    """Evenly spaced numbers, whole ones if all of them are and were given so."""
    parts = text.split(":")
    if len(parts) != 3:
        return None
    try:
        start, stop = float(parts[0]), float(parts[1])
        count = int(parts[2])
    except ValueError:
        return None
    if not (math.isfinite(start) and math.isfinite(stop) and 1 <= count <= MOST_VALUES):
        raise click.UsageError(
            f"{text}: a range is START:STOP:COUNT, up to {MOST_VALUES} values"
        )
    gap = (stop - start) / max(count - 1, 1)
    # Twelve digits: 0.04 and not 0.04000000000000001
    numbers = [float(f"{start + i * gap:.12g}") for i in range(count)]
    is_whole = all(part.strip().lstrip("+-").isdecimal() for part in parts)
    if is_whole and all(number.is_integer() for number in numbers):
        return [int(number) for number in numbers]
    return numbers


def _name_and_value(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise click.UsageError(f"--set takes NAME=VALUE, not {text!r}")
    return name, value


def _value(text: str) -> Any:  # noqa: ANN401
    try:
        return json.loads(text)
    except (ValueError, RecursionError):  # a ValueError: too many digits, too
        return text
