"""Who runs the points: other processes, any executor, a cluster of Dask.

Each gives pairs of a number and an outcome as points are done, in any order. A worker that dies
takes nothing with it but the point it was at, and that one only if it dies again and again.
"""

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    as_completed,
    wait,
)
from contextlib import suppress
from importlib import import_module
from typing import Any, Final

from ..errors import GraphError
from .tasks import DIED, Outcome, Study, run_task

Task = tuple[int, Mapping[str, Any], str]
"""Number, values and folder of a point."""
Outcomes = Generator[tuple[int, Outcome]]

_RETRIES: Final = 2
_MOST_ABANDONED: Final = 600.0
"""Seconds without any worker after which a cluster is given up."""
_NO_WORKERS: Final = "the cluster has no workers any more"
_ENDS: Final = ("finished", "error", "cancelled")
"""What a future of Dask may end as; one that is pending or lost is still to come."""
_LOOK_AGAIN: Final = 5.0
"""Seconds after which results that were announced are asked for again."""


def on_executor(executor: Executor, study: Study, tasks: Sequence[Task]) -> Outcomes:
    """Run points on any executor; if that breaks, what is left runs in processes of our own.

    Yields
    ------
    (int, Outcome)
        Number of a point, and what became of it.
    """
    _refuse_fork(executor)
    futures: dict[Future[Outcome], Task] = {}
    left: list[Task] = []
    try:
        for task in tasks:
            try:
                futures[executor.submit(run_task, study, *task)] = task
            except BrokenExecutor:
                left.append(task)
        for future in as_completed(futures):
            if isinstance(future.exception(), BrokenExecutor):
                left.append(futures[future])
            else:
                yield futures[future][0], _outcome(future)
    finally:
        for future in futures:
            future.cancel()
    if left:
        yield from in_processes(getattr(executor, "_max_workers", 1), study, left)


def in_processes(workers: int, study: Study, tasks: Sequence[Task]) -> Outcomes:
    """Run points in processes of our own, which are replaced when they die.

    Yields
    ------
    (int, Outcome)
        Number of a point, and what became of it.
    """
    pending, suspects = list(reversed(tasks)), list[Task]()
    deaths: dict[int, int] = {}
    context = multiprocessing.get_context("spawn")
    while pending or suspects:
        # After a death those under way run one at a time, so that it is known whose it was.
        queue, width = (suspects, 1) if suspects else (pending, workers)
        others = set(multiprocessing.active_children())
        with ProcessPoolExecutor(width, context, initializer=_end_on_sigterm) as pool:
            try:
                lost = yield from _until_death(pool, width, study, queue)
            except BaseException:
                # Nobody waits for what runs: it tidies up and ends.
                pool.shutdown(wait=False, cancel_futures=True)
                for process in set(multiprocessing.active_children()) - others:
                    process.terminate()
                raise
        for task in lost:
            deaths[task[0]] = deaths.get(task[0], 0) + (queue is suspects)
            if deaths[task[0]] > _RETRIES - 1:
                yield task[0], Outcome(error=DIED)
            else:
                suspects.append(task)


class _EndedError(SystemExit):
    """The parent ends a worker: what it is at tidies up on the way out."""


def _end_on_sigterm() -> None:
    """In a worker: its parent alone says when to end, and files are left whole then."""

    def _end(number: int, _frame: object) -> None:
        raise _EndedError(128 + number)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)


def _run_or_end(study: Study, number: int, point: Mapping[str, Any], folder: str) -> Outcome:
    """Run a point in a worker; the pool would take an exception that ends it for a result."""
    try:
        return run_task(study, number, point, folder)
    except _EndedError as ended:
        os._exit(ended.code if isinstance(ended.code, int) else 1)


def _until_death(
    pool: ProcessPoolExecutor, width: int, study: Study, queue: list[Task]
) -> Generator[tuple[int, Outcome], None, list[Task]]:
    """Take tasks from the end of a queue, as many at a time as there are processes.

    Returns
    -------
    list of Task
        What was under way when a process died; empty at the end of the queue.
    """
    running: dict[Future[Outcome], Task] = {}
    while queue or running:
        while queue and len(running) < width:
            task = queue.pop()
            try:
                running[pool.submit(_run_or_end, study, *task)] = task
            except BrokenExecutor:
                return [task, *running.values()]
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in done:
            if not isinstance(future.exception(), BrokenExecutor):
                yield running.pop(future)[0], _outcome(future)
        if any(isinstance(future.exception(), BrokenExecutor) for future in done):
            return list(running.values())
    return []


def on_dask(client: Any, study: Study, tasks: Sequence[Task]) -> Outcomes:  # noqa: ANN401
    """Run points on a cluster of Dask; its scheduler gives those of dead workers to others.

    Parameters
    ----------
    client : distributed.Client

    Yields
    ------
    (int, Outcome)
        Number of a point, and what became of it.
    """
    shared = client.submit(_same, study, pure=False)

    def _submitted(tasks: Sequence[Task]) -> dict[Any, Task]:
        return {client.submit(run_task, shared, *task, pure=False): task for task in tasks}

    suspects: list[Task] = []
    for task, outcome in _finished(client, _submitted(tasks)):
        if outcome is None:
            suspects.append(task)  # or another point on the same worker did it
        else:
            yield task[0], outcome
    for suspect in suspects:
        for task, outcome in _finished(client, _submitted([suspect])):
            yield task[0], outcome or Outcome(error=DIED)


def _finished(
    client: Any,  # noqa: ANN401
    futures: dict[Any, Task],
) -> Generator[tuple[Task, Outcome | None]]:
    """Tasks and their outcomes as they are done; None where workers died of one.

    Results may be lost with a worker after they were announced: the scheduler makes them again,
    and they are waited for again.
    """
    wait_for_any = import_module("distributed").wait
    abandoned = 0.0
    try:
        while futures:
            began = time.monotonic()
            with suppress(TimeoutError):
                wait_for_any(list(futures), timeout=_LOOK_AGAIN, return_when="FIRST_COMPLETED")
            _reopen(client.cluster)
            if client.scheduler_info()["workers"]:
                abandoned = 0.0
            else:
                abandoned += time.monotonic() - began
            if abandoned > _MOST_ABANDONED:
                yield from ((task, Outcome(error=_NO_WORKERS)) for task in futures.values())
                return
            for future in list(futures):
                # Asked one by one: those after it may be lost while one is waited for.
                if future.status in _ENDS:
                    with suppress(TimeoutError):
                        outcome = _dask_outcome(future)
                        yield futures.pop(future), outcome
    finally:
        for future in futures:
            future.cancel()


def _reopen(cluster: Any) -> None:  # noqa: ANN401
    """Have workers back that a cluster of this process has given up.

    It does so with those that are not there fifteen seconds after a death, though they may be
    starting for the second time; what it was asked for it starts when it is asked once more.
    """
    asked = len(getattr(cluster, "worker_spec", ()))
    if asked and len(cluster.workers) < asked:
        cluster.scale(asked)


def _dask_outcome(future: Any) -> Outcome | None:  # noqa: ANN401
    if future.status == "finished":
        return future.result(timeout=_LOOK_AGAIN)
    if future.status == "cancelled":
        return Outcome(error="it was cancelled on the cluster")
    error = future.exception(timeout=_LOOK_AGAIN)
    return None if type(error).__name__ == "KilledWorker" else Outcome(error=_described(error))


def _same(study: Study) -> Study:
    """The study itself, once on the cluster for all points."""
    return study


def _described(error: object) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _outcome(future: "Future[Outcome]") -> Outcome:
    error = future.exception()
    return future.result() if error is None else Outcome(error=_described(error))


def is_dask(executor: object) -> bool:
    """Whether it is a client of Dask rather than an executor."""
    return hasattr(executor, "scheduler_info") and hasattr(executor, "get_executor")


def _refuse_fork(executor: Executor) -> None:
    """A forked process inherits the locks of libraries' threads, and waits for ever."""
    context = getattr(executor, "_mp_context", None)
    if context is not None and context.get_start_method() == "fork":
        raise GraphError(
            "the executor forks its processes, which can hang after a graph has run: give it "
            "mp_context=multiprocessing.get_context('spawn')"
        )


def runner(
    executor: Any,  # noqa: ANN401
    workers: int | None,
) -> Callable[[Study, Sequence[Task]], Outcomes] | None:
    """Who runs the points; None for this process.

    Raises
    ------
    GraphError
        If it cannot.
    """
    if executor is not None and workers is not None:
        raise GraphError("sweep: give an executor or a number of workers, not both")
    if workers is not None:
        if workers < 1:
            raise GraphError(f"sweep: workers = {workers}: must be at least 1")
        return lambda study, tasks: in_processes(workers, study, tasks)
    if executor is None:
        return None
    run = on_dask if is_dask(executor) else on_executor
    return lambda study, tasks: run(executor, study, tasks)
