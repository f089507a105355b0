"""Who runs the points: other processes, any executor, a cluster of Dask.

Each gives pairs of a number and an outcome as points are done, in any order. A worker that dies
takes nothing with it but the point it was at, and that one only if it dies again and again.
"""

import multiprocessing
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
from typing import Any, Final

from ..annotations import Value
from ..errors import GraphError
from .tasks import Outcome, Study, run_task

Task = tuple[int, Mapping[str, Any], str]
"""Number, values and folder of a point."""
Outcomes = Generator[tuple[int, Outcome]]

_RETRIES: Final = 2
_DIED: Final = "the process that ran it died: out of memory, killed, or a library at fault"


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
                futures[executor.submit(run_task, study, *task[1:])] = task
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
    context = multiprocessing.get_context("spawn")
    while pending or suspects:
        # After a death those under way run one at a time, so that it is known whose it was.
        queue, width = (suspects, 1) if suspects else (pending, workers)
        with ProcessPoolExecutor(width, mp_context=context) as pool:
            lost = yield from _until_death(pool, width, study, queue)
        if queue is pending:
            suspects += lost
        else:
            yield from ((number, Outcome(error=_DIED)) for number, _, _ in lost)


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
                running[pool.submit(run_task, study, *task[1:])] = task
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
    from importlib import import_module

    distributed = import_module("distributed")
    shared = client.submit(_same, study, pure=False)
    futures = {
        client.submit(run_task, shared, *task[1:], pure=False, retries=_RETRIES): task[0]
        for task in tasks
    }
    finished = distributed.as_completed(futures, with_results=True, raise_errors=False)
    try:
        for future, result in finished:
            if future.status == "finished":
                yield futures[future], result
            else:
                yield futures[future], Outcome(error=_lost(result))
    finally:
        client.cancel(list(futures))


def _same(study: Study) -> Study:
    """The study itself, once on the cluster for all points."""
    return study


def _lost(result: Value) -> str:
    error = result[1] if isinstance(result, tuple) else result
    name = type(error).__name__
    return _DIED if name == "KilledWorker" else f"{name}: {' '.join(str(error).split())}"


def _outcome(future: "Future[Outcome]") -> Outcome:
    error = future.exception()
    if error is None:
        return future.result()
    return Outcome(error=f"{type(error).__name__}: {' '.join(str(error).split())}")


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
