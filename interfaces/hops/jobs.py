"""Long runs: who asks again joins the run, and only some run at once.

Grasshopper gives up after 100 seconds and keeps every success for the whole session, so an
answer is given before: that it is still running, as an error.
"""

import time
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures import TimeoutError as FutureTimeoutError
from dataclasses import dataclass, field
from threading import Event as Flag
from threading import Lock, Semaphore
from typing import Final

from ...nodes.graphs.running.events import Event

AT_ONCE: Final = 4
PATIENCE: Final = 90.0
MOST_WAITING: Final = 64
MOST_KEPT: Final = 32
"""Answers that nobody has fetched yet."""


@dataclass(frozen=True)
class Answer:
    """An answer to a request.

    Attributes
    ----------
    status : int
    body : bytes
    content_type : str
    """

    status: int
    body: bytes
    content_type: str = "application/json; charset=utf-8"


@dataclass
class Watcher:
    """How far a run has come, and how it is called off."""

    cancel: Flag = field(default_factory=Flag)
    began: float = 0.0
    step: str = ""
    share: float = 0.0

    def note(self, event: Event) -> None:
        """Note what happens to a step."""
        if event.state in ("running", "progress"):
            self.step, self.share = event.step, event.share


Work = Callable[[Watcher], Answer]


class StillRunningError(Exception):
    """A run that is not over; who asks again joins it."""


class BusyError(Exception):
    """No run is begun: too many wait, or the server ends."""


@dataclass(frozen=True)
class _Job:
    future: "Future[Answer]"
    watcher: Watcher


class Jobs:
    """Runs by their key, some at once; the others wait.

    Parameters
    ----------
    at_once : int
    patience : float
        Seconds after which who waits is told that it is still running.
    most_waiting : int
        Requests that may wait at a time.
    """

    def __init__(
        self,
        at_once: int = AT_ONCE,
        patience: float = PATIENCE,
        most_waiting: int = MOST_WAITING,
    ) -> None:
        self.patience = patience
        self._pool = ThreadPoolExecutor(at_once, "spheremesh")
        self._places = Semaphore(most_waiting)
        self._jobs: OrderedDict[bytes, _Job] = OrderedDict()
        self._lock = Lock()
        self._is_closed = False

    def answer(self, key: bytes, work: Work) -> Answer:
        """The answer of a run that is under way for the key, or is begun.

        Parameters
        ----------
        key : bytes
            Equal for requests that ask for the same.
        work : callable
            Gives the answer; what it raises is raised here.

        Raises
        ------
        StillRunningError
            When patience is over; the run goes on.
        BusyError
            If too many wait.
        """
        if not self._places.acquire(blocking=False):
            raise BusyError("too many requests wait; solve again later")
        try:
            return self._wait(key, self._job(key, work))
        finally:
            self._places.release()

    def close(self) -> None:
        """Call off what runs, and let nothing begin."""
        with self._lock:
            self._is_closed = True
            for job in self._jobs.values():
                job.watcher.cancel.set()
        self._pool.shutdown(wait=False, cancel_futures=True)

    @property
    def are_running(self) -> bool:
        """Whether some run is not over."""
        with self._lock:
            return any(job.future.running() for job in self._jobs.values())

    def _job(self, key: bytes, work: Work) -> _Job:
        with self._lock:
            job = self._jobs.get(key)
            if job is None:
                if self._is_closed:
                    raise BusyError("the server ends")
                watcher = Watcher()
                job = _Job(self._pool.submit(_timed, work, watcher), watcher)
                self._jobs[key] = job
                self._forget_old()
            return job

    def _forget_old(self) -> None:
        over = [key for key, job in self._jobs.items() if job.future.done()]
        for key in over[:-MOST_KEPT]:
            del self._jobs[key]

    def _wait(self, key: bytes, job: _Job) -> Answer:
        try:
            answer = job.future.result(self.patience)
        except FutureTimeoutError:
            if job.future.done():  # it ended with a time-out of its own
                self._forget(key, job)
                raise
            raise StillRunningError(_progress(job.watcher)) from None
        except BaseException:
            self._forget(key, job)
            raise
        self._forget(key, job)
        return answer

    def _forget(self, key: bytes, job: _Job) -> None:
        with self._lock:
            if self._jobs.get(key) is job:
                del self._jobs[key]


def _timed(work: Work, watcher: Watcher) -> Answer:
    watcher.began = time.monotonic()
    return work(watcher)


def _progress(watcher: Watcher) -> str:
    if not watcher.began:
        return "waits for others to end: recompute to wait on"
    seconds = time.monotonic() - watcher.began
    share = f", {watcher.share:.0%} of {watcher.step}" if watcher.share else ""
    return f"still running ({seconds:.0f} s{share}): recompute to wait on"
