"""Results in memory, bounded in bytes: the longest unused are forgotten first."""

from collections import OrderedDict
from collections.abc import Callable
from contextlib import AbstractContextManager
from threading import RLock
from typing import Any, Final

from .digests import FileState, file_state
from .entries import Entry
from .flights import Flights
from .footprints import footprint

MOST_BYTES: Final = 2**30
ENTRY_BYTES: Final = 1024
"""What an entry takes besides its value."""
_MOST_REMEMBERED: Final = 50_000
"""Messages and names of files that are remembered after their results."""


class MemoryStore:
    """Results in memory, for one graph or shared by several.

    Parameters
    ----------
    most_bytes : int
        How much is kept when a run is over.
    states : callable
        Gives what tells that a file has changed.
    """

    def __init__(
        self,
        most_bytes: int = MOST_BYTES,
        *,
        states: Callable[[str], FileState] = file_state,
    ) -> None:
        self.most_bytes = most_bytes
        self.file_state = states
        self._entries: OrderedDict[bytes, tuple[Entry, dict[int, int]]] = OrderedDict()
        self._shared: dict[int, int] = {}
        self._bytes = 0
        self._messages: OrderedDict[bytes, tuple[str, ...]] = OrderedDict()
        self._writers: OrderedDict[str, bytes] = OrderedDict()
        self._lock = RLock()
        self._flights = Flights()

    @property
    def size(self) -> int:
        """How much is kept at present.

        Returns
        -------
        int
            Bytes; what several results share is counted once.
        """
        return self._bytes

    def __len__(self) -> int:
        return len(self._entries)

    def get(self, key: bytes) -> Entry | None:
        """The result of a key, if it is there and the files it wrote are too.

        Returns
        -------
        Entry or None
            None too if a file is gone, has changed, or was written by another step since.
        """
        with self._lock:
            found = self._entries.get(key)
            if found is None:
                return None
            for path, state in found[0].files:
                # Two writes within a tick of the file system's clock have equal states.
                if self._writers.get(path) != key or state is None:
                    return None
                if self.file_state(path) != state:
                    return None
            self._entries.move_to_end(key)
            return found[0]

    def put(self, key: bytes, entry: Entry, *, is_lasting: bool = True) -> int:
        """Keep a result.

        Parameters
        ----------
        is_lasting : bool
            Says nothing here: all is lost with the process.

        Returns
        -------
        int
            Bytes of the value.
        """
        del is_lasting
        parts = footprint(entry.value)
        with self._lock:
            self._drop(key)
            self._entries[key] = entry, parts
            self._bytes += ENTRY_BYTES
            for part, size in parts.items():
                count = self._shared.get(part, 0)
                self._shared[part] = count + 1
                if not count:
                    self._bytes += size
            for path, _ in entry.files:
                _remember(self._writers, path, key)
            if entry.messages:
                _remember(self._messages, key, entry.messages)
        return sum(parts.values())

    def flight(self, key: bytes, check: Callable[[], None]) -> AbstractContextManager[None]:
        """Keep other threads from making the same result.

        Returns
        -------
        context manager
            Entering waits until nobody else makes it.
        """
        return self._flights.one(key, check)

    def messages(self, key: bytes) -> tuple[str, ...]:
        """What a step warned about; remembered when its result is forgotten.

        Returns
        -------
        tuple of str
            Empty if it did not.
        """
        return self._messages.get(key, ())

    def origin(self, function: Callable[..., Any]) -> str:
        """Nothing: functions defined anew are told apart within a process.

        Returns
        -------
        str
            Empty.
        """
        del function
        return ""

    def trim(self) -> None:
        """Forget the results that were not used for longest, down to the bound."""
        with self._lock:
            while self._bytes > self.most_bytes and self._entries:
                self._drop(next(iter(self._entries)))

    def _drop(self, key: bytes) -> None:
        found = self._entries.pop(key, None)
        if found is None:
            return
        self._bytes -= ENTRY_BYTES
        for part, size in found[1].items():
            self._shared[part] -= 1
            if not self._shared[part]:
                del self._shared[part]
                self._bytes -= size


def _remember(memory: OrderedDict[Any, Any], key: object, value: object) -> None:
    memory[key] = value
    memory.move_to_end(key)
    while len(memory) > _MOST_REMEMBERED:
        memory.popitem(last=False)
