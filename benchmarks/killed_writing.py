"""Is a file always whole? Kills writers at random moments and looks at what is left.

    python benchmarks/killed_writing.py [KILLS] [EXPORTS]

For .3dm and STEP: a process writes a new file over an old one and is killed by SIGKILL, half
of the times at a random moment, half of them as soon as there are first bytes on the disk, or
a few milliseconds later. Then the file must be the old one or a whole new one. The same for
the command ``panel --support``, which writes a folder: half of the times it is killed as soon
as the first file has changed. Then all files must be old ones, or all whole new ones: those
that a killed job did not come to move, the next one moves.

What killed processes left beside is counted: hidden files, as nothing can tidy up after
SIGKILL. Before that, EXPORTS whole programs that write panels and beams must end with exit
code 0.
"""

import multiprocessing
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

import rhino3dm

from spheremesh import nodes
from spheremesh.fabrication.folders import finish_moves
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.rhino_models import writer as rhino
from spheremesh.fabrication.step import writer as step
from spheremesh.interfaces.panel import PanelOptions, panel_graph, run_job
from spheremesh.kernel.panels.panels import Panels

OLD = b"the older file"
PROGRAM = """
import sys
from spheremesh import nodes
spheres = nodes.fit_spheres(nodes.roof_mesh(8, 10))
made = nodes.panels(spheres, thickness=0.02).panels
beams = nodes.beams(nodes.annulus_support(spheres, depth=0.25).annuli, 0.025).beams
write = nodes.write_3dm if sys.argv[1].endswith(".3dm") else nodes.write_step
write(made, sys.argv[1], beams=beams)
"""
Writer = Callable[[Model, Path], object]
FORK = multiprocessing.get_context("fork")


def export(path: Path) -> int:
    """Exit code of a program that writes a file."""
    command = [sys.executable, "-W", "ignore", "-c", PROGRAM, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert not done.stderr, done.stderr
    return done.returncode


def kill(write: Writer, panels: Panels, path: Path, wait: Callable[[], None]) -> None:
    """Write in another process and kill it when the wait is over."""
    process = FORK.Process(target=write, args=(Model(panels), path))
    process.start()
    wait()
    process.kill()
    process.join()


def wait_for_bytes(path: Path, delay: float) -> None:
    """Wait until the file has changed or something lies beside it, and a moment longer."""
    end = time.perf_counter() + 60
    while time.perf_counter() < end:
        with suppress(FileNotFoundError):
            sizes = {each.name: each.stat().st_size for each in os.scandir(path.parent)}
            if sizes.pop(path.name) != len(OLD) or any(sizes.values()):
                break
    time.sleep(delay)


def is_whole(path: Path, n_panels: int) -> bool:
    """Whether a file holds all panels and its end."""
    if path.suffix == ".3dm":
        model = rhino3dm.File3dm.Read(str(path))
        return model is not None and len(model.Objects) == 5 * n_panels
    text = path.read_text(encoding="utf-8", errors="replace")
    solids = text.count("MANIFOLD_SOLID_BREP(")
    return solids == n_panels and text.rstrip().endswith("END-ISO-10303-21;")


def torment(write: Writer, panels: Panels, path: Path, kills: int) -> Counter[str]:
    """What was found after each kill."""
    write(Model(panels), path)
    assert is_whole(path, panels.n_panels)
    began = time.perf_counter()
    process = FORK.Process(target=write, args=(Model(panels), path))
    process.start()
    process.join()
    seconds = time.perf_counter() - began
    found: Counter[str] = Counter()
    for i in range(kills):
        path.write_bytes(OLD)
        if i % 2:
            wait = partial(time.sleep, random.uniform(0, 1.6 * seconds))  # noqa: S311
        else:
            wait = partial(wait_for_bytes, path, random.choice((0.0, 0.002)))  # noqa: S311
        kill(write, panels, path, wait)
        if path.read_bytes() == OLD:
            found["old"] += 1
        else:
            found["new" if is_whole(path, panels.n_panels) else "DAMAGED"] += 1
        others = [each for each in path.parent.iterdir() if each != path]
        found["left beside"] += len(others)
        for each in others:
            each.unlink()
    return found


def write_folder(folder: Path) -> None:
    """The main job on a small roof, files of all kinds."""
    mesh = nodes.roof_mesh(6, 8)
    source = folder.parent / "roof.obj"
    vertices = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist()]
    faces = ["f " + " ".join(str(i + 1) for i in face) + "\n" for face in mesh.faces]
    source.write_text("".join(vertices + faces), encoding="ascii")
    options = PanelOptions(mesh=source, thickness=0.02, support="axis", depth=0.25)
    run_job(panel_graph(options), folder, lambda *_: None, overwrite=True)


def torment_folder(folder: Path, kills: int) -> Counter[str]:
    """What was found after each kill of the main job."""
    began = time.perf_counter()
    write_folder(folder)
    seconds = time.perf_counter() - began
    files = sorted(folder.iterdir())
    sizes = {path.name: path.stat().st_size for path in files}
    found: Counter[str] = Counter()
    for i in range(kills):
        for path in files:
            path.write_bytes(OLD)
        process = FORK.Process(target=write_folder, args=(folder,))
        process.start()
        if i % 2:
            time.sleep(random.uniform(0, 1.2 * seconds))  # noqa: S311
        else:
            while process.is_alive() and all(p.stat().st_size == len(OLD) for p in files):
                pass
        process.kill()
        process.join()
        found["killed while files moved"] += any(folder.glob(".spheremesh-whole-*"))
        finish_moves(folder)
        new = {path.name for path in files if path.read_bytes() != OLD}
        # Times in the header and the report change their lengths by little.
        whole = all((folder / n).stat().st_size > 0.99 * sizes[n] for n in new)
        kinds = {0: "all old", len(files): "all new"}
        found[kinds.get(len(new), "DAMAGED") if whole else "DAMAGED"] += 1
        others = [each for each in folder.iterdir() if each not in files]
        found["left beside"] += len(others)
        for each in others:
            shutil.rmtree(each) if each.is_dir() else each.unlink()
    return found


def main() -> None:
    """Torment the writers."""
    warnings.simplefilter("ignore")
    words = [*sys.argv[1:], *("50", "10")[len(sys.argv) - 1 :]]
    kills, exports = int(words[0]), int(words[1])
    mesh = nodes.roof_mesh(12, 15) if kills > 10 else nodes.roof_mesh(6, 8)
    panels = nodes.panels(nodes.fit_spheres(mesh), thickness=0.02, crease=180).panels
    is_good = True
    for name, write in (("model.3dm", rhino.write_3dm), ("panels.step", step.write_step)):
        with tempfile.TemporaryDirectory() as folder:
            codes = Counter(export(Path(folder) / name) for _ in range(exports))
        with tempfile.TemporaryDirectory() as folder:
            found = torment(write, panels, Path(folder) / name, kills)
        print(f"{name}: exit codes {dict(codes)}, after {kills} kills {dict(found)}")
        is_good &= not found["DAMAGED"] and set(codes) <= {0}
    with tempfile.TemporaryDirectory() as folder:
        found = torment_folder(Path(folder) / "out", kills)
    print(f"folder: after {kills} kills {dict(found)}")
    is_good &= not found["DAMAGED"]
    print("always whole" if is_good else "NOT always whole")
    sys.exit(not is_good)


if __name__ == "__main__":
    main()
