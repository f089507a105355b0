"""Nodes of a study, in a module that other processes can import."""

import os
import signal
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spheremesh.nodes import WritePath, node, warn


class Measured(NamedTuple):
    """A report and an array."""

    report: dict[str, float]
    values: NDArray[np.float64]


def _note(text: str) -> None:
    folder = os.environ.get("STUDY_CALLS")
    if folder:
        with (Path(folder) / "calls").open("a") as file:
            file.write(f"{text}\n")


@node
def study_base(n: int) -> NDArray[np.float64]:
    """An array that costs something."""
    _note(f"base {n}")
    time.sleep(0.01)
    return np.sqrt(np.arange(1.0, n + 1))


@node
def study_measure(base: NDArray[np.float64], t: float) -> Measured:
    """Measure at a thickness."""
    _note(f"measure {len(base)} {t}")
    if t < 0:
        raise ValueError("t must not be negative")
    if t > 0.3:
        warn(f"{t} is thick")
    return Measured({"sum": float(base.sum() * t), "t": t}, base * t)


@node
def study_write(values: NDArray[np.float64], path: WritePath) -> str:
    """Write numbers."""
    _note(f"write {len(values)} {values[0]}")
    Path(path).write_text(" ".join(map(str, values)))
    return str(path)


@node
def study_die(t: float, folder: str) -> float:
    """Kill the process: always at 0.3, and the first time at 0.2."""
    path = Path(folder) / "died"
    is_first = t == 0.2 and not path.exists()
    if is_first:
        path.write_text("")
    if is_first or t == 0.3:
        os.kill(os.getpid(), signal.SIGTERM if sys.platform == "win32" else signal.SIGKILL)
    return t
