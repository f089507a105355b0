"""Processes that share a disk store: one flight per key, and killed at random."""

import random
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import spheremesh as sm
from spheremesh.nodes import node
from spheremesh.nodes.graphs.stores.flights import Flights

WORKER = """
import sys, time
from pathlib import Path
import numpy as np
from numpy.typing import NDArray
import spheremesh as sm
from spheremesh.nodes import node

folder, name = Path(sys.argv[1]), sys.argv[2]

@node
def slow_ramp(n: int) -> NDArray[np.float64]:
    with (folder / "calls").open("a") as file:
        file.write(f"slow_ramp {n}\\n")
    time.sleep(0.005)
    return np.arange(1000.0) * n

@node
def slow_sum(values: NDArray[np.float64], others: list[float]) -> float:
    with (folder / "calls").open("a") as file:
        file.write(f"slow_sum {values[1]}\\n")
    return float(values.sum()) + sum(others)

g = sm.Graph(cache=folder / "cache")
others: list[object] = []
for n in range(12):
    others = [g.add(slow_sum, values=g.add(slow_ramp, n=n), others=others[-2:])]
value = g.run(others[0])
(folder / name).write_text(repr(value))
"""
RIGHT = sum(499500.0 * n for n in range(12))


def start(folder: Path, name: str) -> subprocess.Popen[bytes]:
    script = folder / "worker.py"
    script.write_text(WORKER)
    return subprocess.Popen([sys.executable, str(script), str(folder), name])


def test_each_step_runs_once_for_all(tmp_path: Path) -> None:
    workers = [start(tmp_path, f"w{i}") for i in range(4)]
    assert [worker.wait(60) for worker in workers] == [0] * 4
    assert {(tmp_path / f"w{i}").read_text() for i in range(4)} == {repr(RIGHT)}
    counts = Counter((tmp_path / "calls").read_text().splitlines())
    assert len(counts) == 24
    assert set(counts.values()) == {1}


def test_killed_at_random_there_is_no_wrong_result(tmp_path: Path) -> None:
    chance = random.Random(1)  # noqa: S311
    for _ in range(4):
        worker = start(tmp_path, "killed")
        time.sleep(chance.uniform(0.15, 0.5))
        worker.send_signal(signal.SIGTERM if sys.platform == "win32" else signal.SIGKILL)
        worker.wait(60)
    worker = start(tmp_path, "last")
    assert worker.wait(60) == 0
    assert (tmp_path / "last").read_text() == repr(RIGHT)


def test_a_thread_waits_for_another_and_not_for_itself() -> None:
    import threading

    flights, order = Flights(), list[str]()
    inside = threading.Event()

    def first() -> None:
        with flights.one(b"k", lambda: None), flights.one(b"k", lambda: None):
            inside.set()
            time.sleep(0.05)
            order.append("first")

    thread = threading.Thread(target=first)
    thread.start()
    inside.wait()
    with flights.one(b"other", lambda: None):
        order.append("other")
    with flights.one(b"k", lambda: None):
        order.append("second")
    thread.join()
    assert order == ["other", "first", "second"]


def test_threads_share_a_store() -> None:
    import threading

    calls: list[float] = []

    @node
    def slow(a: float) -> float:
        calls.append(a)
        time.sleep(0.02)
        return a + 1

    g = sm.Graph()
    step = g.add(slow, a=g.add(slow, a=1))
    results: list[float] = []
    threads = [threading.Thread(target=lambda: results.append(g.run(step))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [3.0] * 8
    assert calls == [1, 2]
