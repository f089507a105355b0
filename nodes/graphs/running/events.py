"""What is told of a run while it goes on, and how it is called off."""

import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event as Flag
from typing import Literal, TypeAlias

from ..node import reporting_to

State: TypeAlias = Literal[
    "queued", "running", "progress", "done", "cached", "failed", "cancelled"
]
OnStep: TypeAlias = Callable[[str, str], None]


class RunCancelledError(Exception):
    """A run was called off; what was done until then is kept."""


@dataclass(frozen=True)
class Event:
    """What happens to a step.

    Attributes
    ----------
    step : str
        Its name.
    state : str
        ``queued``, ``running``, ``progress``, ``done``, ``cached``, ``failed`` or
        ``cancelled``.
    seconds : float
        Since it began; of a cached step, what it took when it was made.
    bytes : int
        Size of the result of a step that is done, in memory.
    share : float
        From 0 to 1: how much of a running step is done, as far as it says.
    text : str
        What it says besides, or why it failed.
    """

    step: str
    state: State
    seconds: float = 0.0
    bytes: int = 0
    share: float = 0.0
    text: str = ""


OnEvent: TypeAlias = Callable[[Event], None]


@dataclass(frozen=True, eq=False)
class Watch:
    """Who looks on while a graph runs, and may call it off.

    Attributes
    ----------
    on_step : callable, optional
        Called with the name of a step and ``"running"``, ``"done"``, ``"cached"``,
        ``"failed"`` or ``"cancelled"``.
    on_event : callable, optional
        Called with an `Event`.
    cancel : threading.Event, optional
        Set from anywhere, it ends the run.
    """

    on_step: OnStep | None = None
    on_event: OnEvent | None = None
    cancel: Flag | None = None

    def tell(self, event: Event) -> None:
        """Tell all who look on."""
        if self.on_event is not None:
            self.on_event(event)
        if self.on_step is not None and event.state not in ("queued", "progress"):
            self.on_step(event.step, event.state)

    @property
    def is_watched(self) -> bool:
        """Whether anybody looks on."""
        return self.on_event is not None or self.on_step is not None

    def check(self) -> None:
        """Stop here if the run was called off."""
        if self.cancel is not None and self.cancel.is_set():
            raise RunCancelledError("the run was cancelled")

    def note(self, step: str, share: float) -> None:
        """Tell how much of a step is done."""
        if self.on_event is not None:
            self.on_event(Event(step, "progress", share=share))

    @contextmanager
    def step(self, name: str) -> Generator[None]:
        """While a step runs: its start, its progress, and how it ended if it failed."""
        began = time.perf_counter()

        def _report(share: float, text: str) -> None:
            self.check()
            if self.on_event is not None:
                seconds = time.perf_counter() - began
                self.on_event(Event(name, "progress", seconds, share=share, text=text))

        self.check()
        self.tell(Event(name, "running"))
        try:
            with reporting_to(_report):
                yield
        except RunCancelledError:
            raise  # the run tells it of all steps that are left
        except Exception as error:
            seconds = time.perf_counter() - began
            self.tell(Event(name, "failed", seconds, text=str(error)))
            raise
