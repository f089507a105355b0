"""Damaged files for every reader: each run ends in a mesh or in an error of our own.

    python benchmarks/fuzz_readers.py [--seconds 60] [--readers obj,3dm] [--cut-only|--no-cuts]

A run counts as a fault if it raises what is no error of our own, takes more than 5 s of CPU or
500 MB, or ends the process. Seeds are changed byte by byte, word by word and line by line, and
then cut at every byte: a cut file is refused, or said in a remark, or has lost nothing.
Faulty inputs are kept in the folder of --keep. A reader is a row of READERS in fuzz_seeds.py.
"""

import argparse
import hashlib
import json
import multiprocessing
import os
import random
import re
import resource
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from fuzz_changes import changed
from fuzz_seeds import READERS, Reader

from spheremesh.kernel.errors import SpheremeshError
from spheremesh.nodes.graphs.errors import GraphError, NodeError

MOST_CPU, MOST_MEGABYTES = 5.0, 500
OURS = (SpheremeshError, GraphError, NodeError)
WAIT = 60.0
"""Seconds after which a run that says nothing is ended."""


def used() -> tuple[float, float]:
    """CPU seconds and most megabytes of this process and its children."""
    both = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    cpu = sum(each.ru_utime + each.ru_stime for each in both)
    return cpu, max(each.ru_maxrss for each in both) / 1024


def one_run(reader: Reader, path: Path) -> tuple[str, Any]:
    """How a run ended, and what was read: "read", "refused", or what is wrong."""
    cpu, memory = used()
    found = None
    try:
        found = reader.read(path)
        outcome = "read"
    except OURS as error:
        outcome = "refused" if "\n" not in str(error) else f"FAULT two lines: {error!r}"
    except BaseException as error:  # noqa: BLE001
        outcome = f"FAULT {type(error).__name__}: {error}"[:300].replace("\n", " ")
    cpu_after, memory_after = used()
    if cpu_after - cpu > MOST_CPU:
        outcome = f"FAULT {cpu_after - cpu:.1f} s of CPU"
    if memory_after - memory > MOST_MEGABYTES:
        outcome = f"FAULT {memory_after - memory:.0f} MB"
    return outcome, found


def fuzz(name: str, seconds: float, seed: int, folder: Path, answers: Any) -> None:  # noqa: ANN401
    """In a process of its own: runs until the CPU time is spent; tells the parent of each."""
    warnings.simplefilter("ignore")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    reader, rng = READERS[name], random.Random(seed)  # noqa: S311
    seeds = reader.seeds()
    path = folder / f"{name}{reader.suffix}"
    for data in seeds:  # imports are not the fault of a file
        path.write_bytes(data)
        reader.read(path)
    start, said = used()[0], 0.0
    counts: Counter[str] = Counter()
    while used()[0] - start < seconds:
        path.write_bytes(changed(rng.choice(seeds), seeds, rng))
        outcome, _ = one_run(reader, path)
        counts[outcome.split()[0]] += 1
        if outcome.startswith("FAULT"):
            answers.put(("fault", outcome, path.read_bytes()))
        if time.monotonic() - said > 1:
            said = time.monotonic()
            answers.put(("alive", used()[0] - start, dict(counts)))
    answers.put(("done", used()[0] - start, dict(counts)))


def watched(name: str, seconds: float, keep: Path) -> int:
    """Fuzz a reader and print a row; a process that dies is a fault, and started anew."""
    spent, seed = 0.0, 1
    total: Counter[str] = Counter()
    faults: dict[str, tuple[str, bytes]] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}{READERS[name].suffix}"
        while spent < seconds:
            answers: Any = multiprocessing.Queue()
            process = multiprocessing.Process(
                target=fuzz, args=(name, seconds - spent, seed, Path(folder), answers)
            )
            process.start()
            run, ended = follow(process, answers, faults)
            total.update(run[1])
            spent += max(run[0], 1.0)
            seed += 1
            if ended:
                break
            data = path.read_bytes() if path.exists() else b""
            outcome = f"FAULT the process ended or hung ({process.exitcode})"
            faults.setdefault(outcome, (outcome, data))
    keep.mkdir(parents=True, exist_ok=True)
    print(
        f"{name:6} {spent:6.0f} s  {sum(total.values()):8d} runs  {total['read']:8d} read  "
        f"{total['refused']:8d} refused  {total['FAULT']:5d} faults",
        flush=True,
    )
    for outcome, data in faults.values():
        file = keep / f"{hashlib.sha1(data).hexdigest()[:10]}{READERS[name].suffix}"  # noqa: S324
        file.write_bytes(data)
        print(f"       {outcome}\n       {file}", flush=True)
    return len(faults)


def follow(
    process: Any,  # noqa: ANN401
    answers: Any,  # noqa: ANN401
    faults: dict[str, tuple[str, bytes]],
) -> tuple[tuple[float, dict[str, int]], bool]:
    """Listen to a process: CPU seconds and counts, and whether it came to its end."""
    run: tuple[float, dict[str, int]] = (0.0, {})
    last = time.monotonic()
    while True:
        try:
            kind, first, second = answers.get(timeout=1)
        except Exception:  # noqa: BLE001
            if process.is_alive() and time.monotonic() - last < WAIT:
                continue
            process.kill()
            process.join()
            return run, False
        last = time.monotonic()
        if kind == "fault":
            if len(faults) < 40:
                faults.setdefault(re.sub(r"\d+", "0", first), (first, second))
        else:
            run = (first, second)
            if kind == "done":
                process.join()
                return run, True


def cuts(name: str) -> int:
    """Cut every seed at every byte and print a row; return how many lose faces in silence."""
    reader, silent_in_all = READERS[name], 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"cut{reader.suffix}"
        for number, data in enumerate(reader.seeds()):
            path.write_bytes(data)
            whole = one_run(reader, path)[1]
            counts: Counter[str] = Counter()
            silent: list[int] = []
            for size in range(len(data)):
                path.write_bytes(data[:size])
                outcome, found = one_run(reader, path)
                kind = outcome.split()[0]
                if kind == "read":
                    kind = judged(found, whole)
                counts[kind] += 1
                if kind not in ("refused", "warned", "same"):
                    silent.append(size)
            silent_in_all += len(silent)
            print(
                f"{name:6} seed {number}  {len(data):6d} cuts  {counts['refused']:6d} refused  "
                f"{counts['warned']:5d} warned  {counts['same']:4d} same  "
                f"{len(silent):3d} lose in silence {silent[:12]}",
                flush=True,
            )
    return silent_in_all


def judged(found: Any, whole: Any) -> str:  # noqa: ANN401
    """Whether a file that was cut lost nothing, or says so."""
    if not hasattr(found, "polygons"):
        return "same" if found == whole else "silent"
    same = all(
        np.array_equal(getattr(found.polygons, each), getattr(whole.polygons, each))
        for each in ("vertices", "corners", "degrees")
    )
    more = set(found.remarks) - set(whole.remarks)
    return "same" if same else "warned" if more else "silent"


def main() -> None:
    """Fuzz readers one after the other, then cut their files."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=float, default=60, help="CPU seconds per reader")
    parser.add_argument("--readers", default=",".join(READERS), help="names, with commas")
    parser.add_argument("--keep", type=Path, default=Path("out/fuzz"), help="faulty inputs")
    parser.add_argument("--cut-only", action="store_true", help="no random changes")
    parser.add_argument("--no-cuts", action="store_true", help="random changes alone")
    parser.add_argument("--json", action="store_true", help="print the totals as JSON as well")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    names = options.readers.split(",")
    n_faults = (
        0
        if options.cut_only
        else sum(watched(name, options.seconds, options.keep) for name in names)
    )
    n_silent = {} if options.no_cuts else {name: cuts(name) for name in names}
    if options.json:
        print(json.dumps({"faults": n_faults, "lost_in_silence": n_silent}))
    sys.exit(n_faults > 0)


if __name__ == "__main__":
    main()
