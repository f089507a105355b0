"""How far a long computation has come, told to whoever listens."""

from collections.abc import Callable

_listeners: list[Callable[[float, str], None]] = []


def listen(listener: Callable[[float, str], None]) -> None:
    """Be told of the progress of long computations.

    Parameters
    ----------
    listener : callable
        Given a share from 0 to 1 and a text, which may be empty, in the thread of the
        computation; what it raises ends that.
    """
    _listeners.append(listener)


def tell_progress(done: int, most: int, text: str = "") -> None:
    """Say how many of at most so many rounds are done, and what else is worth saying.

    Parameters
    ----------
    done, most : int
    text : str
        In a few words.
    """
    for listener in _listeners:
        listener(done / most, text)
