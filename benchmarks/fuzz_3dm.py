"""Does any damaged .3dm harm? Mutates and cuts small files, and reads them.

    python benchmarks/fuzz_3dm.py [CPU_SECONDS] [SEED] [--no-cuts]

Eight seeds: meshes with ngons, unwelded and double meshes, surfaces, polysurfaces, extrusions,
blocks, several layers, a panel with its render mesh. First each is cut at
every byte: all of these must be refused, or read with the same faces where only a part that
nobody needs is gone. Then random bytes, numbers and blocks are changed until the time is up.

Files are read by forks of this program in place of a process of their own, which would take a
second each; one that dies would have been refused. One changed file of 40, and every one that
takes a fork too long, is read as users read it. Faults are: an error that is not our own, more
than 5 s of processor time, more than 500 MB.
"""

import os
import random
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import rhino3dm

from spheremesh import Mesh, nodes
from spheremesh.fabrication.rhino import reader
from spheremesh.fabrication.rhino.mesh_writer import to_rhino_mesh
from spheremesh.fabrication.rhino.reader import read_3dm
from spheremesh.fabrication.rhino.surface_reader import GridSize
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.parts.records import select_parts

SIZE = GridSize(4, 4)
MOST_SECONDS, MOST_MEGABYTES = 5.0, 500.0
BATCH = 40
"""Files that are read one after the other, the first in a process of its own."""


def seeds(folder: Path) -> dict[str, bytes]:
    """Small files of all kinds."""
    files: dict[str, bytes] = {}
    roof = nodes.vase_mesh(5, 3)
    ball = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0)
    circle = rhino3dm.Circle(1.0)
    a = np.pi / 3 * np.arange(6)
    contents = {
        "mesh": [to_rhino_mesh(roof)],
        "ngons": [
            to_rhino_mesh(Mesh(np.column_stack([np.cos(a), np.sin(a), 0 * a]), [range(6)]))
        ],
        "surface": [ball.ToNurbsSurface()],
        "brep": [ball.ToBrep(), rhino3dm.Cylinder(circle, 2.0).ToBrep(True, True)],  # noqa: FBT003
        "extrusion": [rhino3dm.Extrusion.Create(circle.ToNurbsCurve(), 3.0, True)],  # noqa: FBT003
        "mixed": [to_rhino_mesh(roof), ball.ToNurbsSurface(), circle.ToNurbsCurve()],
    }
    for name, objects in contents.items():
        model = rhino3dm.File3dm()
        for i, each in enumerate(objects):
            layer = rhino3dm.Layer()
            layer.Name = f"layer {i}"
            attributes = rhino3dm.ObjectAttributes()
            attributes.LayerIndex = model.Layers.Add(layer)
            model.Objects.Add(each, attributes)
        files[name] = _bytes(model, folder)
    model = rhino3dm.File3dm()
    origin, plain = rhino3dm.Point3d(0, 0, 0), (rhino3dm.ObjectAttributes(),)
    model.InstanceDefinitions.Add("a", "", "", "", origin, (to_rhino_mesh(roof),), plain)
    block = next(each.Id for each in model.InstanceDefinitions)
    for x in range(3):
        moved = rhino3dm.Transform.Translation(9.0 * x, 0, 0)
        model.Objects.Add(rhino3dm.InstanceReference(block, moved), plain[0])
    files["blocks"] = _bytes(model, folder)
    panels = nodes.panels(nodes.fit_spheres(nodes.vase_mesh(3, 1)), thickness=0.02).panels
    one = select_parts(panels, np.arange(len(panels.ids)) == 0)
    nodes.write_3dm(one, folder / "panels.3dm")
    files["panels"] = (folder / "panels.3dm").read_bytes()
    return files


def _bytes(model: rhino3dm.File3dm, folder: Path) -> bytes:
    model.Write(str(folder / "seed.3dm"), 8)
    return (folder / "seed.3dm").read_bytes()


def mutated(data: bytes, choice: random.Random) -> bytes:
    """A file with some bytes, numbers or blocks changed."""
    found = bytearray(data)
    for _ in range(choice.choice((1, 1, 2, 4, 16))):
        at = choice.randrange(len(found))
        kind = choice.randrange(6)
        if kind == 0:
            found[at] ^= 1 << choice.randrange(8)
        elif kind == 1:
            found[at] = choice.randrange(256)
        elif kind == 2:
            number = choice.choice((0, 1, -1, 2**31 - 1, -(2**31), 10**6, 255))
            found[at : at + 4] = number.to_bytes(4, "little", signed=True)
        elif kind == 3:
            number = choice.choice((np.nan, np.inf, 1e300, -1e-300, 0.0))
            found[at : at + 8] = np.float64(number).tobytes()
        elif kind == 4:
            del found[at : at + choice.randrange(1, 64)]
        else:
            found[at:at] = found[at : at + choice.randrange(1, 64)]
        if not found:
            return b"3"
    return bytes(found)


def outcome(data: bytes) -> tuple[str, str]:
    """What comes of a file, and the fault if it is one."""
    before = _child_seconds()
    try:
        n_faces = len(read_3dm(data, "", SIZE).polygons.degrees)
        what = f"read {n_faces}"
    except InputError as error:
        what = f"refused: {str(error)[:60]}"
    except Exception as error:  # noqa: BLE001 - this is what is looked for
        return "crash", f"{type(error).__name__}: {error}"
    seconds = _child_seconds() - before
    if seconds > MOST_SECONDS:
        return what, f"{seconds:.1f} s"
    megabytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    return what, f"{megabytes:.0f} MB" if megabytes > MOST_MEGABYTES else ""


def outcomes(files: Sequence[bytes]) -> list[tuple[str, str]]:
    """What comes of files, and the faults: read by forks of this program.

    A fork goes on to the next file until it dies, and the next one takes over after that.
    """
    found: list[tuple[str, str]] = []
    while len(found) < len(files):
        receiver, sender = os.pipe()
        child = os.fork()
        if not child:
            _read_all(files[len(found) :], sender)
        os.close(sender)
        with os.fdopen(receiver) as lines:
            found += [
                (what, fault)
                for what, fault in (line.rstrip("\n").split("|") for line in lines)
            ]
        status = os.waitpid(child, 0)[1]
        if len(found) < len(files):
            is_slow = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
            # rhino3dm loops for ever on some: its own process has to end in time
            found.append(outcome(files[len(found)]) if is_slow else ("died", ""))
    return found


def _read_all(files: Sequence[bytes], sender: int) -> NoReturn:
    """Read files one after the other, and say a line of each."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    reader.isolated = _called
    for data in files:
        used = resource.getrusage(resource.RUSAGE_SELF)
        limit = int(used.ru_utime + used.ru_stime) + 3
        resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
        try:
            said = f"read {len(read_3dm(data, '', SIZE).polygons.degrees)}"
        except Exception as error:  # noqa: BLE001 - refused by its own process, too
            said = f"refused {type(error).__name__}"
        after = resource.getrusage(resource.RUSAGE_SELF)
        more = (after.ru_maxrss - used.ru_maxrss) / 1024
        fault = f"{more:.0f} MB" if more > MOST_MEGABYTES else ""
        os.write(sender, f"{said}|{fault}\n".encode())
    os._exit(0)


def _called(function: Callable[..., Any], *arguments: object) -> object:
    return function(*arguments)


def _child_seconds() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_CHILDREN, resource.RUSAGE_SELF)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def cut_all(files: dict[str, bytes]) -> list[str]:
    """Cut every seed at every byte, print a row of each, and return the faults."""
    faults: list[str] = []
    began = _child_seconds()
    for name, data in files.items():
        whole = len(read_3dm(data, "", SIZE).polygons.degrees)
        read = 0
        cuts = [data[:end] for end in range(len(data))]
        for end, (what, fault) in enumerate(outcomes(cuts)):
            read += what.startswith("read")
            if fault or (what.startswith("read") and what != f"read {whole}"):
                faults.append(f"{name} cut at {end} of {len(data)}: {what} {fault}")
        print(f"{name}: {len(data)} bytes, {whole} faces, cut at each, {read} read whole")
    print(f"cuts: {_child_seconds() - began:.0f} s of processor time", flush=True)
    return faults


def mutate(files: dict[str, bytes], allowed: float, choice: random.Random) -> list[str]:
    """Change seeds at random until the time is up, print a row, and return the faults."""
    counts: Counter[str] = Counter()
    faults: list[str] = []
    slowest = 0.0
    began, wall = _child_seconds(), time.perf_counter()
    names = list(files)
    while _child_seconds() - began < allowed:
        batch = [mutated(files[choice.choice(names)], choice) for _ in range(BATCH)]
        start = _child_seconds()
        alone = outcome(batch[0])
        slowest = max(slowest, _child_seconds() - start)
        found = [alone, *outcomes(batch[1:])]
        for data, (what, fault) in zip(batch, found, strict=True):
            counts[what.split()[0].rstrip(":")] += 1
            if fault:
                path = Path(tempfile.gettempdir()) / f"fuzz_3dm_{os.getpid()}_{len(faults)}.3dm"
                path.write_bytes(data)
                faults.append(f"mutated: {what} {fault}: {path}")
    largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(
        f"mutations: {counts.total()} files in {_child_seconds() - began:.0f} s of processor "
        f"time ({time.perf_counter() - wall:.0f} s): {dict(counts)}; slowest alone "
        f"{slowest:.1f} s, largest {largest:.0f} MB"
    )
    return faults


def main() -> int:
    """Cut, mutate, count."""
    words = [word for word in sys.argv[1:] if word != "--no-cuts"]
    seconds, seed = (*words, *("300", "0")[len(words) :])
    with tempfile.TemporaryDirectory() as folder:
        files = seeds(Path(folder))
    faults = [] if "--no-cuts" in sys.argv else cut_all(files)
    faults += mutate(files, float(seconds), random.Random(int(seed)))  # noqa: S311
    print(f"{len(faults)} faults")
    for each in faults[:20]:
        print(f"  {each}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
