"""What the files of a job cost: seconds of CPU, megabytes, growth, and memory.

    python benchmarks/files.py [ROWS ...]
    python benchmarks/files.py jobs [ROWS ...]

Roofs of ROWS x ROWS panels (by default 38 and 71) in 8 moulds, with a thickness and mitred
beams under all edges. Every writer of `spheremesh panel` writes each; the table has seconds,
their share of all, megabytes, and the exponent by which seconds grow from the first roof to the
last.
Peak memory is that of the whole process. With ``jobs`` the whole command runs instead (by
default 10 and 71 rows, without and with beams), in a process of its own, imports included.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh import nodes


def roof(rows: int) -> tuple[Any, Any]:
    """Panels in 8 moulds, and their beams."""
    optimum = nodes.minimize_angles(nodes.fit_spheres(nodes.roof_mesh(rows, rows)))
    clusters = nodes.cluster_radii(optimum.sphere_mesh, k=8)
    spheres, axes = clusters.sphere_mesh, nodes.node_axes(optimum.sphere_mesh)
    made = nodes.panels(
        spheres, labels=clusters.labels, thickness=0.02, edges="axis", axes=axes
    ).panels
    beams = nodes.beams(nodes.axis_support(spheres, depth=0.25, axes=axes).annuli).beams
    return made, beams


def writers(made: Any, beams: Any, folder: Path) -> dict[str, Callable[[], object]]:  # noqa: ANN401
    """A call for every file, by its name."""
    return {
        "panels.step": lambda: nodes.write_step(made, folder / "panels.step", beams=beams),
        "model.3dm": lambda: nodes.write_3dm(made, folder / "model.3dm", beams=beams),
        "moulds.dxf": lambda: nodes.write_mould_drawings(made, folder / "moulds.dxf"),
        "moulds.svg": lambda: nodes.write_mould_drawings(made, folder / "moulds.svg"),
        "beams.dxf": lambda: nodes.write_dxf(beams, folder / "beams.dxf"),
        "beams.csv": lambda: nodes.write_schedule(beams=beams, path=folder / "beams.csv"),
        "schedule.csv": lambda: nodes.write_schedule(made, folder / "schedule.csv"),
        "schedule.json": lambda: nodes.write_schedule(
            made, folder / "schedule.json", beams=beams
        ),
        "preview.png": lambda: nodes.render(made, folder / "preview.png", beams=beams),
        "view.html": lambda: nodes.write_view(made, folder / "view.html", beams=beams),
    }


def write_all(sizes: list[int]) -> None:
    """Print the table of writers."""
    warnings.simplefilter("ignore")
    seconds: dict[str, list[float]] = {}
    megabytes: dict[str, float] = {}
    counts: list[int] = []
    for rows in sizes:
        made, beams = roof(rows)
        counts.append(made.n_panels)
        print(f"{made.n_panels} panels, {beams.n_beams} beams", flush=True)
        with tempfile.TemporaryDirectory() as name:
            for file, write in writers(made, beams, Path(name)).items():
                began = time.process_time()
                write()
                seconds.setdefault(file, []).append(time.process_time() - began)
                megabytes[file] = (Path(name) / file).stat().st_size / 1e6
    total = sum(spent[-1] for spent in seconds.values())
    for file, spent in seconds.items():
        growth = np.log(spent[-1] / spent[0]) / np.log(counts[-1] / counts[0])
        print(
            f"{file:14} {spent[-1]:7.2f} s {spent[-1] / total:5.0%} "
            f"{megabytes[file]:8.1f} MB  n^{growth:.2f}"
        )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"{'all':14} {total:7.2f} s; {peak:.0f} MB at most")


def run_jobs(sizes: list[int]) -> None:
    """Print what whole jobs take; once before, so that Python has compiled what it reads."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    with tempfile.TemporaryDirectory() as name:
        environment["PYTHONPYCACHEPREFIX"] = f"{name}/compiled"
        beams = ("--support", "axis", "--depth", "0.25")
        jobs = [(4, beams), *((rows, more) for rows in sizes for more in ((), beams))]
        for i, (rows, more) in enumerate(jobs):
            mesh = nodes.write_mesh(nodes.roof_mesh(rows, rows), f"{name}/{i}.obj")
            command = [
                sys.executable, "-m", "spheremesh", "panel", str(mesh), "-o", f"{name}/{i}",
                "--moulds", "8", "--thickness", "0.02", *more,
            ]  # fmt: skip
            child = subprocess.Popen(
                command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            _, _, used = os.wait4(child.pid, 0)
            spent = used.ru_utime + used.ru_stime
            if i:
                print(
                    f"{rows**2:6} panels{', with beams' if more else '':12} {spent:6.2f} s, "
                    f"{used.ru_maxrss / 1e3:5.0f} MB at most",
                    flush=True,
                )


if __name__ == "__main__":
    words = sys.argv[1:]
    if words[:1] == ["jobs"]:
        run_jobs([int(word) for word in words[1:]] or [10, 71])
    else:
        write_all([int(word) for word in words] or [38, 71])
