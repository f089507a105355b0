"""What graphs cost: a chain of steps, a slider, a store that processes share and are killed on.

``python benchmarks/graphs.py`` prints a line per figure; ``--kills 50`` kills processes.
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import MemoryStore, node


@node
def raised(x: float, by: float = 1.0) -> float:
    """A number and another."""
    return x + by


@node
def filled(n: int, value: float) -> NDArray[np.float64]:
    """An array of equal numbers."""
    return np.full(n, value)


@node
def added(a: NDArray[np.float64], value: float = 1.0) -> NDArray[np.float64]:
    """An array and a number."""
    return a + value


def chain(length: int = 1000) -> None:
    """Overhead of each step of a chain, with checks, keys, events and messages."""
    g = sm.Graph("chain")
    slider = g.param("k", 0.0)
    began = time.process_time()
    step = g.add(raised, x=slider)
    for _ in range(length - 1):
        step = g.add(raised, x=step)
    built = time.process_time() - began
    first: list[float] = []
    again: list[float] = []
    for move in range(5):
        g.set(k=float(move + 1))
        for seconds in (first, again):
            began = time.process_time()
            g.run(step)
            seconds.append(time.process_time() - began)
    per = 1e6 / length
    print(
        f"chain of {length} steps, microseconds a step: built {built * per:.1f}, "
        f"run {min(first) * per:.1f}, cached {min(again) * per:.1f}"
    )


def slider() -> None:
    """A slider in the middle of 40 steps; 200 moves within a bound in bytes."""
    store = MemoryStore(most_bytes=64 * 2**20)
    g = sm.Graph("slider", cache=store)
    k = g.param("k", 0.0)
    step = g.add(filled, n=20_000, value=1.0)
    for i in range(39):
        step = g.add(added, a=step, **({"value": k} if i == 19 else {}))
    g.run(step)
    most = 0
    for move in range(200):
        g.set(k=float(move + 1))
        g.run(step)
        most = max(most, store.size)
    g.set(k=999.0)
    states: list[str] = []
    g.run(step, on_step=lambda _, state: states.append(state))
    print(
        f"slider of a graph of 40 steps: {states.count('running')} run; 200 moves keep "
        f"{most / 2**20:.1f} MB of {store.most_bytes / 2**20:.0f}"
    )


WORKER = """
import sys, time
from pathlib import Path
import numpy as np
from numpy.typing import NDArray
import spheremesh as sm
from spheremesh.nodes import node

folder, name, seed = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])

def note(text):
    with (folder / "calls").open("a") as file:
        file.write(text + "\\\\n")

@node
def slow_ramp(n: int, seed: float) -> NDArray[np.float64]:
    note(f"ramp {n} {seed}")
    time.sleep(0.01)
    return np.arange(20000.0) * n + seed

@node
def slow_sum(values: NDArray[np.float64], others: list[float]) -> float:
    note(f"sum {values[:2].tolist()}")
    return float(values.sum()) + sum(others)

g = sm.Graph(cache=folder / "cache")
others = []
for n in range(30):
    others = [g.add(slow_sum, values=g.add(slow_ramp, n=n, seed=seed), others=others[-2:])]
(folder / name).write_text(repr(g.run(others[0])))
""".replace("\\\\n", "\\n")


def right(seed: float) -> float:
    """What the workers are to find."""
    found = 0.0
    for n in range(30):
        found = float((np.arange(20000.0) * n + seed).sum()) + found
    return found


def shared(kills: int, processes: int = 8) -> None:
    """Processes on one store: each step once; killed at random, no wrong result."""
    chance = random.Random(0)  # noqa: S311
    folder = Path(tempfile.mkdtemp())
    script = folder / "worker.py"
    script.write_text(WORKER)

    def start(name: str, seed: float) -> subprocess.Popen[bytes]:
        command = [sys.executable, str(script), str(folder), name, str(seed)]
        return subprocess.Popen(command, stderr=subprocess.PIPE)

    workers = [start(f"w{i}", 0.5) for i in range(processes)]
    assert all(worker.wait() == 0 for worker in workers), workers
    values = {(folder / f"w{i}").read_text() for i in range(processes)}
    counts = Counter((folder / "calls").read_text().splitlines())
    print(
        f"{processes} processes on one store: {len(counts)} steps, run at most "
        f"{max(counts.values())} times; right: {values == {repr(right(0.5))}}"
    )

    def is_wrong(name: str, process: subprocess.Popen[bytes], seed: float) -> bool:
        _, errors = process.communicate()
        if process.returncode:
            print(name, errors.decode()[-2000:])
            return True
        return (folder / name).read_text() != repr(right(seed))

    running: dict[str, tuple[subprocess.Popen[bytes], float]] = {}
    killed = finished = wrong = number = 0
    while killed < kills:
        while len(running) < processes:
            seed = float(number // 12)
            running[f"k{number}"] = start(f"k{number}", seed), seed
            number += 1
        time.sleep(chance.uniform(0.05, 0.4))
        name = chance.choice(list(running))
        worker, seed = running.pop(name)
        if worker.poll() is None:
            worker.send_signal(signal.SIGKILL)
            killed += 1
        for other, (process, seed) in list(running.items()):
            if process.poll() is not None:
                del running[other]
                finished += 1
                wrong += is_wrong(other, process, seed)
    for name, (worker, seed) in running.items():
        worker.wait()
        finished += 1
        wrong += is_wrong(name, worker, seed)
    left = len(list((folder / "cache").rglob(".unfinished*")))
    print(f"{killed} killed, {finished} finished, {wrong} wrong, {left} unfinished files left")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=0)
    kills = parser.parse_args().kills
    chain()
    slider()
    if kills:
        shared(kills)
