"""What do damaged graph files do? Changes them at random, loads and runs them.

    python benchmarks/fuzz_graphs.py [CPU_SECONDS] [SEED]

Seeds are graphs of all kinds of values. Each is cut off at every byte; then, until the time is
over, files are changed at random: bytes, spans, numbers, names, values put in the place of
others. A file must load and run, or be refused by an error of ours in one line; it may take 5
CPU seconds, and the process 500 MB more than at the start. Whatever else happens is printed
with the file that did it; the exit code is then 1.
"""

import json
import random
import resource
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh.fabrication.output_folder import output_folder
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.kernel.errors import SpheremeshError
from spheremesh.nodes import Graph, GraphError, NodeError, each

MOST_SECONDS, MOST_MEGABYTES = 5.0, 500.0
OURS = (SpheremeshError, GraphError)

VALUES: list[Any] = [
    None, True, 0, -1, 1.5, 2**31, 2**63, 10**30, 1e308, 1e-308, "", "a", "\ud800", "\0", "..",
    "/dev/null", "../x.obj", "a/b.obj", [], [[]], [1, "a"], {}, {"wire": "mesh"},
    {"wire": "mesh.name"}, {"wire": "few.graph"}, {"param": "k"}, {"each": [1, 2]},
    {"each": {"param": "k"}}, {"float": "nan"}, {"float": "inf"}, {"float": 3},
    {"array": [1, 2.5], "dtype": "int8"}, {"array": [99999], "dtype": "int8"},
    {"array": [[1], [2, 3]]}, {"array": ["a"], "dtype": "U999999999"},
    {"array": ["a"], "dtype": "U1"}, {"array": [1e308, 1e-308, 0]}, {"array": [[0, 0, 0]]},
    {"array": [None], "dtype": "object"}, {"array": [1], "dtype": "(99999999,)f8"},
    {"array": {"wire": "mesh"}}, {"array": 3}, {"mapping": {"a": {"wire": "mesh"}}},
    {"mapping": 3}, [[[[[1]]]]],
]  # fmt: skip
TOKENS = [b"NaN", b"-Infinity", b"1e999", b"9" * 30, b"9" * 5000, b"[" * 200, b'{"a":' * 200]


def small_graph() -> Graph:
    """Sliders, lists, arrays, mappings and a file."""
    graph = Graph("small")
    k = graph.param("k", 2, min=1, max=9)
    graph.param("kind", "best", choices=["best", "fast"])
    graph.param("weights", np.array([[1.0, 2.5]]))
    mesh = graph.add("torus_mesh", "mesh", n_around=8, n_across=6)
    planes = graph.add("face_planes", "planes", mesh=mesh)
    graph.add("cluster_radii", "few", sphere_mesh=planes, k=k)
    graph.add("vase_mesh", "vases", n_around=each([6, k]), amplitude=0.1)
    moved = graph.add("similarity", "moved", scale=2.0, translation=[1, 2, 3])
    graph.add("apply_mobius", "there", geometry=planes, transform=moved)
    graph.add("write_mesh", "file", mesh=mesh, path="torus.obj")
    return graph


def other_graphs() -> list[Graph]:
    """Graphs of other chapters: hexagons, remeshing, transforms, moulds, a repair."""
    hexagons = Graph("hexagons", units="ft")
    surface = hexagons.add("triangulated_surface", "surface", shape="bump", edge_length=0.4)
    hexagons.add("tangent_spheres", "net", mesh=surface.mesh, offset=float("inf"))
    transforms = Graph("transforms")
    inversion = transforms.add("inversion", "inversion", center=[0.0, 0.0, 9.0], radius=3.0)
    scaling = transforms.add("similarity", "scaling", scale=each([0.5, 2.0]))
    transforms.add("compose", "both", transforms=[inversion, scaling])
    moulds = Graph("moulds", units="mm")
    roof = moulds.add("roof_mesh", "roof", n_span=4, n_length=6)
    spheres = moulds.add(
        "minimize_angles", "smooth", sphere_mesh=moulds.add("fit_spheres", "start", mesh=roof)
    )
    few = moulds.add(
        "cluster_radii", "few", sphere_mesh=spheres.sphere_mesh, k=moulds.param("k", 3, min=1)
    )
    cut = moulds.add("panels", "cut", sphere_mesh=few.sphere_mesh, labels=few.labels)
    moulds.add("write_schedule", "table", panels=cut.panels, path="table.csv")
    repair = Graph("repair")
    raw = repair.add("vase_mesh", "vase", n_around=6, n_across=3)
    mended = repair.add("repair_mesh", "mended", mesh=raw)
    repair.add("mesh_report", "facts", mesh=mended.mesh)
    numbers = Graph("numbers")
    numbers.param("weights", np.linspace(0.0, 1.0, 12).reshape(4, 3))
    rows = numbers.add("sphere_rows", "rows", centers=np.eye(3), radii=[1.0, 2.0, 3.0])
    numbers.add("sphere_facts", "facts", spheres=rows)
    return [hexagons, transforms, moulds, repair, numbers]


def small_panelling() -> str:
    """The graph of the command line on a roof of 24 faces, its pictures small."""
    content = json.loads(
        panel_graph(PanelOptions(moulds=3, support="axis", thickness=0.02)).to_json()
    )
    content["steps"]["mesh"]["inputs"] = {"n_span": 4, "n_length": 6}
    for step in content["steps"].values():
        if step["node"] in ("render", "render_assembly"):
            step["inputs"] |= {"width": 120, "height": 80}
    return json.dumps(content, indent=2)


def seeds() -> list[bytes]:
    """Texts of eight graph files; the last takes longest to run."""
    texts = [graph.to_json() for graph in (small_graph(), Graph(), *other_graphs())]
    return [text.encode() for text in (*texts, small_panelling())]


def changed(data: bytes, others: list[bytes], rng: random.Random) -> bytes:
    """The file with one to three changes."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        kind = rng.randrange(6)
        if kind <= 2:
            data = with_other_value(data, rng)
            continue
        i, j = sorted(rng.randrange(len(data) + 1) for _ in range(2))
        j = min(j, i + 40)
        if kind == 3:
            other = rng.choice(others)
            start = rng.randrange(len(other))
            data = data[:i] + other[start : start + rng.randrange(40)] + data[j:]
        elif kind == 4:
            data = data[:i] + bytes([rng.randrange(256)]) + data[i + 1 :]
        else:
            data = data[:i] + rng.choice(TOKENS) + data[j:]
    return data


def with_other_value(data: bytes, rng: random.Random) -> bytes:
    """The file with another value or name somewhere, if it is JSON."""
    try:
        content = json.loads(data)
    except (ValueError, RecursionError):
        return data
    places: list[tuple[Any, Any]] = []
    pending = [content]
    while pending:
        value = pending.pop()
        if isinstance(value, dict | list):
            keys = list(value) if isinstance(value, dict) else list(range(len(value)))
            places += [(value, key) for key in keys]
            pending += [value[key] for key in keys]
    if not places:
        return data
    holder, key = rng.choice(places)
    if isinstance(holder, dict) and rng.random() < 0.2:
        holder[str(rng.choice(places)[1])] = holder.pop(key)
    elif rng.random() < 0.3:
        other, name = rng.choice(places)
        holder[key] = json.loads(json.dumps(other[name])) if len(str(other)) < 2000 else 1
    else:
        holder[key] = rng.choice(VALUES)
    return json.dumps(content, indent=2).encode()


def outcome(data: bytes, folder: Path, *, is_run: bool) -> str:
    """What a file does: "run", "loaded", the name of one of our errors, or a fault."""
    path = folder / "graph.json"
    path.write_bytes(data)
    try:
        graph = Graph.load(path)
        if not is_run:
            return "loaded"
        names = [step.name for step in graph.ends]
        with output_folder(folder / "out", inputs=(path,)) as output:
            for name in names:
                graph.run(name, write_to=output)
    except NodeError as error:
        if not isinstance(error.cause, (*OURS, OSError)):
            return f"FAULT {type(error.cause).__name__} in a node: {str(error)[:200]}"
        error.reason.encode()
    except OURS as error:
        if len(" ".join(str(error).split()).encode()) > 1000:
            return "FAULT a long message"
        return type(error).__name__
    except Exception as error:  # noqa: BLE001
        return f"FAULT {type(error).__name__}: {str(error)[:200]}"
    return "run"


def measured(data: bytes, folder: Path, *, is_run: bool) -> str:
    """The outcome, or what it took too much of."""
    signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    try:
        found = outcome(data, folder, is_run=is_run)
    except TooSlow:
        return f"FAULT more than {MOST_SECONDS} s"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    more = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024 - before
    return found if more < MOST_MEGABYTES else f"FAULT {more:.0f} MB"


class TooSlow(BaseException):
    """Five CPU seconds are over."""


def _stop(*_: object) -> None:
    raise TooSlow


def main() -> int:
    """Cut files off, then change them until the time is over."""
    warnings.simplefilter("ignore")
    words = [*sys.argv[1:], *("60", "0")[len(sys.argv) - 1 :]]
    seconds, rng = float(words[0]), random.Random(int(words[1]))  # noqa: S311
    signal.signal(signal.SIGPROF, _stop)
    texts = seeds()
    found: Counter[str] = Counter()
    faults: dict[str, bytes] = {}

    def note(result: str, data: bytes) -> None:
        found[result.partition(":")[0]] += 1
        if result.startswith("FAULT"):
            faults.setdefault(result[:90], data)

    with tempfile.TemporaryDirectory() as name, chdir(name):
        for text in texts:
            assert outcome(text, Path(name), is_run=True) == "run"
            for i in range(len(text.rstrip())):
                result = measured(text[:i], Path(name), is_run=False)
                note("FAULT cut off, and not refused" if result == "loaded" else result, text)
        print(f"cut off: {dict(found)}")
        end = time.process_time() + seconds
        while time.process_time() < end:
            # the panelling takes seconds to run; as a rule loading it is enough
            index = rng.randrange(len(texts))
            data = changed(texts[index], texts, rng)
            is_run = index < len(texts) - 1 or rng.random() < 0.02
            note(measured(data, Path(name), is_run=is_run), data)
    print(f"changed for {seconds:.0f} CPU seconds: {dict(found)}")
    for result, data in faults.items():
        print(f"{result}\n{data[:3000]!r}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
