"""What is kept of a step, and what a store is."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Protocol

from .digests import FileState


@dataclass(frozen=True, eq=False)
class Entry:
    """The outcome of a step.

    Attributes
    ----------
    value : object
        What the function returned, `own`.
    messages : tuple of str
        What it warned about.
    files : tuple of (str, FileState)
        The files that it wrote, as it left them.
    seconds : float
        How long it took.
    made_by : str
        Name and version of the node.
    """

    value: Any
    messages: tuple[str, ...] = ()
    files: tuple[tuple[str, FileState], ...] = ()
    seconds: float = 0.0
    made_by: str = ""


class Store(Protocol):
    """Results by key, for one graph or many, from any thread."""

    def get(self, key: bytes) -> Entry | None:
        """The result of a key; None if there is none, or files that it wrote have changed."""
        ...

    def put(self, key: bytes, entry: Entry, *, is_lasting: bool = True) -> int:
        """Keep a result; how many bytes it takes.

        Parameters
        ----------
        is_lasting : bool
            Whether it is of use to another process.
        """
        ...

    def flight(self, key: bytes, check: Callable[[], None]) -> AbstractContextManager[None]:
        """Wait until nobody else makes the result of a key, and keep others from it meanwhile.

        Parameters
        ----------
        check : callable
            Called while waiting; raises to give up.
        """
        ...

    def messages(self, key: bytes) -> tuple[str, ...]:
        """What a step warned about, also where its result is forgotten."""
        ...

    @property
    def file_state(self) -> Callable[[str], FileState]:
        """What tells that a file has changed."""
        ...

    def origin(self, function: Callable[..., Any]) -> str:
        """What a key must say of the code of a node."""
        ...

    def trim(self) -> None:
        """Forget what was not used for longest, until the store is within its bound."""
        ...
