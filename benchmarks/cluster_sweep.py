"""A sweep of 24 points on two Dask workers: equal to a serial one, and what a death costs.

``python benchmarks/cluster_sweep.py`` prints a line per figure. Once nothing goes wrong; once a
point raises and the process of a worker is killed; once a point kills every worker it runs on.
"""

import os
import signal
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import distributed
import numpy as np

import spheremesh as sm
from spheremesh.nodes.graphs.sweeps.rows import Row, Sweep

NODES = '''
"""Nodes of the study: a base that several points share, a measure, a file."""

import os, signal, time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spheremesh.nodes import WritePath, node

CALLS = Path(__file__).parent / "calls"


def note(text: str) -> None:
    with CALLS.open("a") as file:
        file.write(text + "\\\\n")


@node
def cluster_base(n: int) -> NDArray[np.float64]:
    """An array that costs something."""
    note(f"base {n}")
    time.sleep(0.2)
    return np.sqrt(np.arange(1.0, n + 1))


@node
def cluster_measure(base: NDArray[np.float64], t: float, bad: str) -> NDArray[np.float64]:
    """A product; t = 0.4 raises or dies with n = 30 if asked to."""
    note(f"measure {len(base)} {t}")
    time.sleep(0.1)
    if t == 0.4 and len(base) == 30 and bad == "raise":
        raise ValueError("0.4 is refused")
    if t == 0.4 and len(base) == 30 and bad == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    return base * t


@node
def cluster_write(values: NDArray[np.float64], path: WritePath) -> str:
    """A file of numbers."""
    note(f"write {len(values)} {values[0]}")
    Path(path).write_text(" ".join(map(str, values)))
    return str(path)
'''.replace("\\\\n", "\\n")

N, T = [3, 30, 300], [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4]
TARGETS = ("cluster_measure", "cluster_write")


def study(bad: str) -> sm.Graph:
    """Base, measure and file of 24 points."""
    g = sm.Graph("study")
    base = g.add("cluster_base", n=g.param("n", 3, min=1))
    g.add("cluster_write", values=g.add("cluster_measure", base=base, t=g.param("t", 0.1),
                                        bad=bad), path="numbers.txt")  # fmt: skip
    return g


def calls(folder: Path) -> Counter[str]:
    """What ran since the last time it was asked."""
    path = folder / "calls"
    found = Counter(path.read_text().splitlines()) if path.exists() else Counter[str]()
    path.unlink(missing_ok=True)
    return found


def are_equal(one: Sweep, other: Sweep) -> bool:
    """The same points, values and errors."""
    return len(one) == len(other) and all(
        a.point == b.point
        and a.error == b.error
        and (a.error or (np.array_equal(a.value[0], b.value[0])))
        for a, b in zip(one, other, strict=True)
    )


def files_differ(rows: Sweep) -> str:
    """How many folders and how many different files there are."""
    texts = [(Path(row.folder) / "numbers.txt").read_text() for row in rows if not row.error]
    return f"{len({row.folder for row in rows})} folders, {len(set(texts))} different files"


def swept(
    folder: Path, bad: str, kill_after: int | None = None
) -> tuple[Sweep, Counter[str], Sweep, Counter[str]]:
    """A sweep on a new cluster and its repetition, and what ran in each.

    Parameters
    ----------
    kill_after : int, optional
        Number of rows after which a worker's process is killed.
    """
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):

        def on_row(_row: Row, done: int, _total: int) -> None:
            if done == kill_after:
                pid = next(iter(client.run(os.getpid).values()))
                os.kill(pid, signal.SIGKILL)

        options: dict[str, Any] = {
            "executor": client, "write_to": folder / "out", "cache": folder / "cache",
            "n": N, "t": T,
        }  # fmt: skip
        found = sm.sweep(study(bad), *TARGETS, on_row=on_row, **options)
        ran = calls(folder)
        again = sm.sweep(study(bad), *TARGETS, **options)
        return found, ran, again, calls(folder)


def main() -> None:
    """Three sweeps, each with its repetition."""
    cases = (("nothing wrong", "", None), ("a point raises, a worker is killed", "raise", 8),
             ("a point kills its workers", "die", None))  # fmt: skip
    for title, bad, kill_after in cases:
        folder = Path(tempfile.mkdtemp())
        (folder / "cluster_nodes.py").write_text(NODES)
        os.environ["PYTHONPATH"] = str(folder)
        sys.path.insert(0, str(folder))
        sys.modules.pop("cluster_nodes", None)
        __import__("cluster_nodes")
        found, ran, again, ran_again = swept(folder, bad, kill_after)
        good = len(found) - len(found.failures)
        print(f"{title}: {good} of {len(found)} rows; {files_differ(found)}")
        for row in found.failures:
            print(f"  failed: {row.point}: {row.error}")
        most = {text: count for text, count in ran.items() if count > 1}
        print(f"  {len(ran)} unique steps, run more than once: {most}")
        print(f"  the second time: {dict(ran_again)}; equal: {are_equal(found, again)}")
        if bad != "die":
            os.chdir(folder)
            serial = sm.sweep(study(bad), *TARGETS, n=N, t=T)
            print(f"  equal to the serial one: {are_equal(found, serial)}")
        sys.path.remove(str(folder))


if __name__ == "__main__":
    main()
