"""What is measured of parts once, for all files of a job that say it."""

from collections.abc import Callable
from typing import Any, Final, TypeVar
from weakref import finalize

_KNOWN: Final[dict[int, dict[str, Any]]] = {}
"""Measures by their names, of each object that is still alive, by its number."""

MeasureT = TypeVar("MeasureT")


def measured_once(parts: object, name: str, measure: Callable[[], MeasureT]) -> MeasureT:
    """A measure of parts, which is kept as long as they are.

    Parts are records that nobody changes; another name is another measure.

    Examples
    --------
    >>> class Parts: ...
    >>> parts = Parts()
    >>> measured_once(parts, "length", lambda: 3.0)
    3.0
    >>> measured_once(parts, "length", lambda: 4.0)
    3.0
    """
    number = id(parts)
    if number not in _KNOWN:
        _KNOWN[number] = {}
        # The number is free for another object only when this one is gone.
        finalize(parts, _KNOWN.pop, number, None).atexit = False
    known = _KNOWN[number]
    if name not in known:
        known[name] = measure()
    return known[name]
