"""How far a long computation has come, told to whoever listens."""

from collections.abc import Callable

_listeners: list[Callable[[float], None]] = []


def listen(listener: Callable[[float], None]) -> None:
    """Be told of the progress of long computations.

    Parameters
    ----------
    listener : callable
        Given a share from 0 to 1, in the thread of the computation; what it raises ends that.
    """
    _listeners.append(listener)


def tell_progress(done: int, most: int) -> None:
    """Say how many of at most so many rounds are done.

    Parameters
    ----------
    done, most : int
    """
    for listener in _listeners:
        listener(done / most)
