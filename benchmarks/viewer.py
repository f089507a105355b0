"""Figures of the viewer: what triangles, pictures and reports cost; pages have `page.py`.

python benchmarks/viewer.py
"""

import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.panels.tessellation import tessellate
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net
from spheremesh.nodes import beams as cut_beams
from spheremesh.nodes import (
    bisector_support,
    minimize_angles,
    panel_report,
    panels,
    render,
    write_report,
)

Result = TypeVar("Result")


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """A result and the CPU seconds that it took."""
    start = time.process_time()
    result = call()
    return result, time.process_time() - start


def model(rows: int, columns: int, *, carried: bool = True) -> tuple[Panels, Beams | None]:
    """A roof of panels in eight moulds, with beams and node cylinders or without."""
    spheres = fit_spheres(roof_net(rows, columns, 80.0))
    labels = np.arange(rows * columns) % 8
    made, _ = cut_panels(spheres, thickness=0.02 if carried else 0.0, labels=labels)
    if not carried:
        return made, None
    annuli = bisector_support(spheres, depth=0.1).annuli
    return made, cut_beams(annuli, thickness=0.02, node_radius=0.05).beams


def pictures(folder: Path) -> None:
    """Seconds and memory of pictures, in a process for each that does nothing else."""
    for rows, columns in ((8, 12), (50, 100)):
        for carried in ("", "beams"):
            command = [sys.executable, __file__, "picture", str(rows), str(columns), carried]
            subprocess.run(command, cwd=folder, check=True)


def picture(rows: int, columns: int, carried: str) -> None:
    """One picture of 1600 by 1000, file included, as a job draws it: in a fresh process."""
    made, beams = model(rows, columns)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    shown = beams if carried else None
    _, seconds = timed(lambda: render(made, "picture.png", beams=shown))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"picture of {made.n_panels} panels{' with beams' * bool(carried)}: "
        f"{seconds:.2f} s CPU, {peak:.0f} MB in all, {peak - before:.0f} more than before"
    )


def triangles() -> None:
    """Seconds of triangles, and whether a closed net of spheres is closed to the bit."""
    made, _ = model(50, 100)
    skin, seconds = timed(lambda: tessellate(made))
    print(f"triangles of {made.n_panels} solids: {seconds:.2f} s CPU, {len(skin.triangles)}")
    for thickness in (0.0, 0.01):
        spheres = fit_spheres(torus_net(100, 50, 3.0, 1.0))
        torus, _ = cut_panels(spheres, "intersection", thickness=thickness)
        skin, seconds = timed(lambda: tessellate(torus))  # noqa: B023
        outer = skin.triangles[skin.surfaces < torus.n_panels]
        print(
            f"triangles of a torus of {torus.n_panels} panels {thickness:g} thick: "
            f"{seconds:.2f} s CPU, {open_edges(skin.points, outer)} of {3 * len(outer)} edges "
            "of the outer faces are open"
        )


def open_edges(points: FloatArray, corners: IntArray) -> int:
    """Directed edges of triangles without their opposite; points are equal to the bit alone."""
    _, ids = np.unique(points, axis=0, return_inverse=True)
    rows = ids.ravel()[corners]
    halves = np.concatenate([np.roll(rows, k, axis=1)[:, :2] for k in range(3)])
    known = {tuple(half) for half in halves.tolist()}
    return sum((b, a) not in known for a, b in known)


def report(folder: Path) -> None:
    """Size of a report and seconds to write it."""
    optimum = minimize_angles(fit_spheres(roof_net(50, 100, 80.0)))
    cut = panels(optimum.sphere_mesh, thickness=0.02)
    found = panel_report(optimum.sphere_mesh, optimum.report, cut.report)
    path = folder / "report.html"
    _, seconds = timed(lambda: write_report(found, cut.panels, optimum.sphere_mesh, str(path)))
    size = path.stat().st_size / 1e6
    print(f"report of {cut.panels.n_panels} panels: {size:.2f} MB, {seconds:.2f} s CPU")


if __name__ == "__main__":
    words = sys.argv[1:]
    if words[:1] == ["picture"]:
        picture(int(words[1]), int(words[2]), words[3])
    else:
        with tempfile.TemporaryDirectory() as name:
            # First, while this process is small: others that it starts count its memory.
            pictures(Path(name))
            triangles()
            report(Path(name))
