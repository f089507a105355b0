"""Runs of the graph in a process of its own: the newest counts, and cancel kills.

A run that is out of date is asked to stop between steps; whoever cancels does not wait for
that: the process is killed and a warm one takes its place. Results stand in the store on disk,
so nothing that was finished is made again.
"""

import multiprocessing
import time
from collections import OrderedDict
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from threading import RLock, Thread, Timer
from typing import Any, Final

from .worker import Place, Told, work

MOST_BLOB_BYTES: Final = 512 * 2**20
"""Of pictures that are kept for the pages."""
LONG: Final = 2.0
"""Seconds after which a run may well be cancelled: a second process is made ready."""


@dataclass
class _Worker:
    process: Any
    line: Connection
    is_ready: bool = False
    waiting: list[Told] = field(default_factory=list[Told])


class Runs:
    """What is run, one at a time.

    Parameters
    ----------
    place : Place
    tell : callable
        Given the events for the pages.
    """

    def __init__(self, place: Place, tell: Callable[[dict[str, Any]], None]) -> None:
        self._place = place
        self._tell = tell
        self._lock = RLock()
        self._number = 0
        self._order: Told | None = None
        self._next: Told | None = None
        self._blobs: OrderedDict[str, bytes] = OrderedDict()
        self._states: dict[str, Told] = {}
        self._previews: dict[str, Told] = {}
        self._is_closed = False
        self._spare: _Worker | None = None
        self._worker = self._started()

    @property
    def state(self) -> dict[str, Any]:
        """What a page that opens is told: states of steps, pictures, and what runs."""
        with self._lock:
            running = self._order["run"] if self._order else 0
            return {
                "steps": dict(self._states),
                "previews": dict(self._previews),
                "running": running,
            }

    def run(self, graph: str, rev: int, targets: list[str], **more: Any) -> int:  # noqa: ANN401
        """Run targets of a graph, or write its files into a folder; the number of the run.

        What was asked for before and has not begun is dropped; what runs is asked to stop,
        unless it writes files.
        """
        with self._lock:
            self._number += 1
            order = {
                "type": "run", "run": self._number, "rev": rev, "graph": graph,
                "targets": targets, **more,
            }  # fmt: skip
            if self._order is not None and self._order.get("folder"):
                self._drop_next()
                self._next = order
            else:
                self._begin(order)
            return self._number

    def cancel(self, run: int) -> bool:
        """Kill the run of a number; whether it was running or waiting."""
        with self._lock:
            if self._next is not None and self._next["run"] == run:
                self._drop_next()
                return True
            if self._order is None or self._order["run"] != run:
                return False
            order = self._order
            self._kill()
            self._ended(order, "cancelled")
            return True

    def blob(self, digest: str) -> bytes | None:
        """A picture by its digest."""
        with self._lock:
            data = self._blobs.get(digest)
            if data is not None:
                self._blobs.move_to_end(digest)
            return data

    def forget(self) -> None:
        """Forget the states of steps: another graph is opened."""
        with self._lock:
            self._states.clear()
            self._previews.clear()

    def close(self) -> None:
        """End the processes."""
        with self._lock:
            self._is_closed = True
            for worker in (self._worker, self._spare):
                if worker is not None:
                    _end(worker)

    def _begin(self, order: Told) -> None:
        before, self._order = self._order, order
        if before is not None:
            self._tell({**_about(before), "type": "run", "state": "replaced"})
        self._tell({**_about(order), "type": "run", "state": "running"})
        self._send(self._worker, order)
        timer = Timer(LONG, self._prepare, [order["run"]])
        timer.daemon = True
        timer.start()

    def _send(self, worker: _Worker, order: Told) -> None:
        if not worker.is_ready:
            worker.waiting = [order]
            return
        try:
            worker.line.send(order)
        except OSError:
            self._lost(worker)

    def _prepare(self, run: int) -> None:
        with self._lock:
            is_long = self._order is not None and self._order["run"] == run
            if is_long and self._spare is None and not self._is_closed:
                self._spare = self._started()

    def _started(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=work, args=(theirs, self._place), daemon=True)
        process.start()
        theirs.close()
        worker = _Worker(process, ours)
        Thread(target=self._listen, args=(worker,), daemon=True).start()
        return worker

    def _listen(self, worker: _Worker) -> None:
        while True:
            try:
                told = worker.line.recv()
            except (EOFError, OSError):
                break
            with self._lock:
                if told["type"] == "ready":
                    worker.is_ready = True
                    for order in worker.waiting:
                        self._send(worker, order)
                    worker.waiting = []
                elif worker is self._worker:
                    self._hear(told)
        self._lost(worker)

    def _hear(self, told: Told) -> None:
        kind, order = told["type"], self._order
        is_present = order is not None and order["run"] == told["run"]
        if kind == "run":
            if is_present and order is not None:
                self._ended(order, told["state"], told)
            return
        if kind == "preview":
            data = told.pop("data")
            self._keep(told["digest"], data)
            told["bytes"] = len(data)
            self._previews[told["target"]] = told
        elif kind == "step":
            self._states[told["step"]] = {**self._states.get(told["step"], {}), **told}
        elif kind == "fault":
            self._states[told["step"]] = {
                **self._states.get(told["step"], {}), "state": "failed", "text": told["text"],
            }  # fmt: skip
            self._previews.pop(told["target"], None)
        elif kind == "messages":
            if not is_present:
                return  # of a result that is not shown any more
            for step, texts in told["messages"].items():
                self._states.setdefault(step, {})["messages"] = texts
        self._tell(told)

    def _keep(self, digest: str, data: bytes) -> None:
        self._blobs[digest] = data
        self._blobs.move_to_end(digest)
        while len(self._blobs) > 1 and sum(map(len, self._blobs.values())) > MOST_BLOB_BYTES:
            self._blobs.popitem(last=False)

    def _ended(self, order: Told, state: str, told: Told | None = None) -> None:
        self._order = None
        for step, known in self._states.items():
            if known.get("state") in ("running", "progress", "queued"):
                known["state"] = "cancelled"
                self._tell(
                    {**_about(order), "type": "step", "step": step, "state": "cancelled"}
                )
        self._tell({**_about(order), **(told or {}), "type": "run", "state": state})
        following, self._next = self._next, None
        if following is not None:
            self._begin(following)

    def _drop_next(self) -> None:
        if self._next is not None:
            self._tell({**_about(self._next), "type": "run", "state": "cancelled"})
            self._next = None

    def _kill(self) -> None:
        dead = self._worker
        self._worker = self._spare or self._started()
        self._spare = None
        _end(dead)

    def _lost(self, worker: _Worker) -> None:
        """A process has ended by itself, for want of memory or by a fault of a library."""
        with self._lock:
            if self._is_closed:
                return
            if worker is self._spare:
                self._spare = None
            if worker is not self._worker:
                return
            order = self._order
            self._kill()
            if order is not None:
                text = "the process that ran it has ended, perhaps for want of memory"
                self._ended(order, "failed", {"text": text})


def _end(worker: _Worker) -> None:
    with suppress(OSError, ValueError):
        worker.process.kill()
        worker.process.join(5)
        worker.line.close()


def _about(order: Told) -> Told:
    folder = order.get("folder", "")
    return {"run": order["run"], "rev": order["rev"], "folder": folder, "at": time.time()}
