"""One at a time for each key, among the threads of a process."""

import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Final

_LONGEST_WAIT: Final = 0.1
"""Seconds between two looks at whether a run was called off."""


class Flights:
    """What is being made in this process, by key; a thread never waits for itself."""

    def __init__(self) -> None:
        self._makers: dict[bytes, int] = {}
        self._changed = threading.Condition(threading.Lock())

    @contextmanager
    def one(self, key: bytes, check: Callable[[], None]) -> Generator[None]:
        """Be the only one of its key.

        Parameters
        ----------
        check : callable
            Called while waiting; raises to give up.

        Yields
        ------
        None
            While the block runs, other threads wait.
        """
        mine = threading.get_ident()
        with self._changed:
            while self._makers.get(key, mine) != mine:
                self._changed.wait(_LONGEST_WAIT)
                check()
            is_outer = key not in self._makers
            self._makers[key] = mine
        try:
            yield
        finally:
            if is_outer:
                with self._changed:
                    del self._makers[key]
                    self._changed.notify_all()
