"""Damaged files for every reader: each run ends in a mesh or in an error of our own.

    python benchmarks/fuzz_readers.py [--seconds 60] [--readers obj,3dm] [--cut-only|--no-cuts]

A run counts as a fault if it raises what is no error of our own, takes more than 5 s of CPU or
500 MB, or ends the process. Seeds are changed byte by byte, word by word and line by line, and
then cut at every byte: a cut file is refused, or said in a remark, or has lost nothing.
Faulty inputs are kept in the folder of --keep. A reader is a row of READERS.
"""

import argparse
import hashlib
import json
import multiprocessing
import os
import random
import re
import resource
import struct
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh import Graph, Mesh
from spheremesh.fabrication.mesh_files.reader import content_mesh, read_content
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.kernel.errors import SpheremeshError
from spheremesh.nodes.graphs.errors import GraphError, NodeError

MOST_CPU, MOST_MEGABYTES = 5.0, 500
OURS = (SpheremeshError, GraphError, NodeError)
WAIT = 60.0
"""Seconds after which a run that says nothing is ended."""

POINTS = [
    (0, 0, 0),
    (1, 0, 0.25),
    (2, 0, 0),
    (0, 1, 1 / 3),
    (1, 1, 0.5),
    (2, 1, 0),
    (1, 2, 0.1),
]
FACES = [(0, 1, 4, 3), (1, 2, 5, 4), (3, 4, 6), (4, 5, 6)]
TRIANGLES = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (3, 4, 6), (4, 5, 6)]


@dataclass(frozen=True)
class Reader:
    """What is read: the suffix of its files, whole files to start from, and how."""

    suffix: str
    seeds: Callable[[], list[bytes]]
    read: Callable[[Path], Any]


def read_a_mesh(path: Path) -> Any:  # noqa: ANN401
    """What a mesh file holds; and its mesh, which may be refused."""
    content = read_content(path)
    content_mesh(content, path)
    return content


def read_a_graph(path: Path) -> Any:  # noqa: ANN401
    """A graph file, loaded and drawn, not run."""
    return Graph.load(path).mermaid()


def _written(suffix: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = write_mesh(Mesh(POINTS, FACES), f"{folder}/a{suffix}")
        return path.read_bytes()


def _obj_seeds() -> list[bytes]:
    points = "".join("v {:g} {:g} {:g}\n".format(*each) for each in POINTS)
    rich = "# a roof\nmtllib a.mtl\no Roof\n" + points + "vt 0 0\nvn 0 0 1\ng North Glass\n"
    rich += "usemtl steel\ns off\nf 1/1/1 2/1/1 \\\n 5/1/1 4/1/1\nf -6//1 -5//1 -2//1 -3//1\n"
    rich += "g South\nf 4 5 7\nf 5 6 7\nl 1 2 3\np 4\ncstype bezier\ndeg 1 1\n"
    soup = "".join(
        f"v {x} {y} {z}\n" for face in FACES for x, y, z in (POINTS[i] for i in face)
    )
    soup += "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11\nf 12 13 14\n"
    return [_written(".obj"), rich.encode(), soup.encode()]


def _off_seeds() -> list[bytes]:
    head = f"{len(POINTS)} {len(FACES)} 0\n"
    rows = [" ".join(map(str, (len(face), *face))) for face in FACES]
    colored = "".join("{} {} {} 255 0 0 255\n".format(*each) for each in POINTS)
    broken = " ".join(str(x) for each in POINTS for x in each).replace(" 1 ", "\n1 ")
    painted = "".join(f"{row} 0.5 0.5 0.5\n" for row in rows)
    return [
        _written(".off"),
        f"COFF\n# c\n{head}{colored}{painted}".encode(),
        f"OFF{head}{broken}\n{' '.join(rows)}\n".encode(),
    ]


def _ply_seeds() -> list[bytes]:
    def head(order: str, extra: str = "") -> bytes:
        return (
            f"ply\nformat {order} 1.0\ncomment c\nelement vertex {len(POINTS)}\n{extra}"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {len(FACES)}\nproperty list uchar int vertex_indices\n"
            "property list uchar float texcoord\nend_header\n"
        ).encode()

    text = "".join("{} {} {}\n".format(*each) for each in POINTS)
    text += "".join(" ".join(map(str, (len(f), *f))) + " 2 0 0\n" for f in FACES)
    binary = b"".join(struct.pack(">B3f", 9, *each) for each in POINTS)
    for face in FACES:
        binary += struct.pack(f">B{len(face)}iB2f", len(face), *face, 2, 0, 0)
    order = "binary_big_endian"
    return [
        _written(".ply"),
        head("ascii") + text.encode(),
        head(order, "property uchar red\n") + binary,
    ]


def _stl_seeds() -> list[bytes]:
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*POINTS[i]) for i in triangle)
        + "endloop\nendfacet\n"
        for triangle in TRIANGLES
    )
    return [_written(".stl"), f"solid roof\n{facets}endsolid roof\n".encode()]


def other_seeds(suffix: str) -> list[bytes]:
    """Of a format that meshio or trimesh writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"a{suffix}"
        if suffix == ".glb":
            import trimesh

            trimesh.Trimesh(POINTS, TRIANGLES, process=False).export(path)
        else:
            import meshio

            meshio.Mesh(np.array(POINTS), [("quad", FACES[:2]), ("triangle", FACES[2:])]).write(
                path
            )
        return [path.read_bytes()]


def _rhino_seeds() -> list[bytes]:
    import rhino3dm

    sphere = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0)
    seeds = [_written(".3dm")]
    with tempfile.TemporaryDirectory() as folder:
        for add, what in (
            ("AddBrep", sphere.ToBrep()),
            ("AddSurface", sphere.ToNurbsSurface()),
        ):
            model = rhino3dm.File3dm()
            getattr(model.Objects, add)(what)
            model.Write(f"{folder}/a.3dm", 8)
            seeds.append((Path(folder) / "a.3dm").read_bytes())
    return seeds


def _graph_seeds() -> list[bytes]:
    graph = Graph("roof", units="m")
    count = graph.param("moulds", 3, min=1, max=9)
    mesh = graph.add("roof_mesh", n_span=4, n_length=6)
    spheres = graph.add("fit_spheres", mesh=mesh)
    graph.add("cluster_radii", sphere_mesh=spheres, k=count)
    with tempfile.TemporaryDirectory() as folder:
        graph.save(f"{folder}/a.json")
        return [(Path(folder) / "a.json").read_bytes()]


READERS: dict[str, Reader] = {
    "obj": Reader(".obj", _obj_seeds, read_a_mesh),
    "off": Reader(".off", _off_seeds, read_a_mesh),
    "ply": Reader(".ply", _ply_seeds, read_a_mesh),
    "stl": Reader(".stl", _stl_seeds, read_a_mesh),
    "3dm": Reader(".3dm", _rhino_seeds, read_a_mesh),
    "graph": Reader(".json", _graph_seeds, read_a_graph),
    "vtk": Reader(".vtk", lambda: other_seeds(".vtk"), read_a_mesh),
    "vtu": Reader(".vtu", lambda: other_seeds(".vtu"), read_a_mesh),
    "msh": Reader(".msh", lambda: other_seeds(".msh"), read_a_mesh),
    "bdf": Reader(".bdf", lambda: other_seeds(".bdf"), read_a_mesh),
    "inp": Reader(".inp", lambda: other_seeds(".inp"), read_a_mesh),
    "glb": Reader(".glb", lambda: other_seeds(".glb"), read_a_mesh),
}

NUMBERS = (
    b"0", b"-1", b"1", b"3", b"255", b"65536", b"2147483647", b"4294967295", b"999999999999",
    b"18446744073709551616", b"1e308", b"-1e-308", b"1e999", b"nan", b"inf", b"0.5", b"1.0D+2",
    b"1_0", b"", b"x", b"1/2", b"-9223372036854775808", b"9" * 5000,
)  # fmt: skip
PACKED = tuple(
    struct.pack(order + code, value)
    for order in "<>"
    for code, values in (
        ("B", (0, 1, 127, 255)), ("H", (0, 65535)), ("i", (-1, 0, 2**31 - 1, -(2**31))),
        ("I", (2**32 - 1, 10**9)), ("q", (-1, 2**63 - 1)), ("f", (np.nan, np.inf, 1e38, 1e-45)),
        ("d", (np.nan, -np.inf, 1e308, 5e-324)),
    )
    for value in values
)  # fmt: skip


def changed(data: bytes, others: list[bytes], rng: random.Random) -> bytes:
    """One of the seeds with a few random changes."""
    result = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        change = rng.choice(CHANGES)
        result = bytearray(change(bytes(result), others, rng))
        if not result:
            return data[: rng.randrange(1, len(data))]
    return bytes(result[:200_000])


def _span(data: bytes, rng: random.Random) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + rng.choice((1, 1, 2, 4, 8, 30, 200)))


def _poke(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start = rng.randrange(len(data))
    return data[:start] + bytes([rng.randrange(256)]) + data[start + 1 :]


def _pack(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start, patch = rng.randrange(len(data)), rng.choice(PACKED)
    return data[:start] + patch + data[start + len(patch) :]


def _delete(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start, end = _span(data, rng)
    return data[:start] + data[end:]


def _repeat(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start, end = _span(data, rng)
    return data[:end] + data[start:end] * rng.choice((1, 2, 100)) + data[end:]


def _splice(data: bytes, others: list[bytes], rng: random.Random) -> bytes:
    other = rng.choice(others)
    start, end = _span(other, rng)
    at = rng.randrange(len(data) + 1)
    return data[:at] + other[start:end] + data[at + rng.choice((0, end - start)) :]


def _number(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    found = list(re.finditer(rb"[-+.\w/]+", data[:20_000]))
    if not found:
        return data
    word = rng.choice(found)
    return data[: word.start()] + rng.choice(NUMBERS) + data[word.end() :]


def _lines(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    lines = data.split(b"\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(4)
    if kind == 0:
        lines[i], lines[j] = lines[j], lines[i]
    elif kind == 1:
        del lines[i]
    elif kind == 2:
        lines.insert(i, lines[j])
    else:
        lines[i] = lines[i].upper() if rng.random() < 0.5 else lines[i] + b" " + lines[j]
    return b"\n".join(lines)


def _cut(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    return data[: rng.randrange(1, len(data) + 1)]


CHANGES = (_poke, _pack, _pack, _delete, _repeat, _splice, _number, _number, _lines, _cut)


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
