"""Events for all pages that are open: each has a queue of its own."""

import json
import time
from collections.abc import Callable, Iterator
from queue import Empty, Full, Queue
from threading import Lock
from typing import Any, Final

MOST_WAITING: Final = 5000
"""Events that a page may be behind; one that does not read is dropped."""
MOST_PAGES: Final = 24
BEAT: Final = 5.0
"""Seconds after which a line says that it is still there."""


class Channels:
    """The lines to the pages."""

    def __init__(self) -> None:
        self._queues: list[Queue[str | None]] = []
        self._lock = Lock()
        self._is_closed = False

    @property
    def is_full(self) -> bool:
        """Whether no further page gets a line."""
        return len(self._queues) >= MOST_PAGES

    def tell(self, event: dict[str, Any]) -> None:
        """Send an event to all pages."""
        text = json.dumps(event, ensure_ascii=False, allow_nan=False)
        with self._lock:
            for queue in list(self._queues):
                try:
                    queue.put_nowait(text)
                except Full:
                    self._queues.remove(queue)

    def lines(self, first: dict[str, Any], has_gone: Callable[[], bool]) -> Iterator[bytes]:
        """What a page is sent, until it has gone."""
        queue: Queue[str | None] = Queue(MOST_WAITING)
        with self._lock:
            self._queues.append(queue)
        return self._stream(queue, first, has_gone)

    def close(self, patience: float = 3.0) -> None:
        """End all lines, and wait for that a little."""
        with self._lock:
            self._is_closed = True
            for queue in self._queues:
                queue.put(None)
        until = time.monotonic() + patience
        while self._queues and time.monotonic() < until:
            time.sleep(0.02)

    def _stream(
        self, queue: "Queue[str | None]", first: dict[str, Any], has_gone: Callable[[], bool]
    ) -> Iterator[bytes]:
        try:
            yield f"data: {json.dumps(first)}\n\n".encode()
            waited = 0.0
            while not self._is_closed and queue in self._queues:
                try:
                    text = queue.get(timeout=0.5)
                except Empty:
                    waited += 0.5
                    if has_gone():
                        return
                    if waited >= BEAT:
                        waited = 0.0
                        yield b": still here\n\n"
                    continue
                if text is None:
                    return
                yield f"data: {text}\n\n".encode()
        finally:
            with self._lock:
                if queue in self._queues:
                    self._queues.remove(queue)
