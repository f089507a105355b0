"""What the files of a job cost: seconds of CPU, megabytes, growth, and memory.

    python benchmarks/files.py [ROWS ...]

Roofs of ROWS x ROWS panels (by default 12 and 24) in 8 moulds, with a thickness and beams.
Every writer writes each; the table has its seconds, their share of all, megabytes, and the
exponent by which seconds grow from the first roof to the last. Peak memory is that of the whole
process.
"""

import resource
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
    made = nodes.panels(clusters.sphere_mesh, labels=clusters.labels, thickness=0.02).panels
    beams = nodes.beams(nodes.annulus_support(clusters.sphere_mesh, depth=0.25).annuli).beams
    return made, beams


def writers(made: Any, beams: Any, folder: Path) -> dict[str, Callable[[], object]]:  # noqa: ANN401
    """A call for every file, by its name."""
    return {
        "panels.step": lambda: nodes.write_step(made, folder / "panels.step", beams=beams),
        "model.3dm": lambda: nodes.write_3dm(made, folder / "model.3dm", beams=beams),
        "moulds.dxf": lambda: nodes.write_mould_drawings(made, folder / "moulds.dxf"),
        "beams.dxf": lambda: nodes.write_dxf(beams, folder / "beams.dxf"),
        "schedule.json": lambda: nodes.write_schedule(
            made, folder / "schedule.json", beams=beams
        ),
        "audit": lambda: nodes.audit(made, beams=beams),
    }


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    sizes = [int(word) for word in sys.argv[1:]] or [12, 24]
    seconds: dict[str, list[float]] = {}
    megabytes: dict[str, float] = {}
    counts: list[int] = []
    for rows in sizes:
        made, beams = roof(rows)
        counts.append(made.n_panels)
        print(f"{made.n_panels} panels, {beams.n_beams} beams")
        with tempfile.TemporaryDirectory() as name:
            for file, write in writers(made, beams, Path(name)).items():
                began = time.process_time()
                write()
                seconds.setdefault(file, []).append(time.process_time() - began)
                path = Path(name) / file
                megabytes[file] = path.stat().st_size / 1e6 if path.exists() else 0.0
    total = sum(spent[-1] for spent in seconds.values())
    for file, spent in seconds.items():
        growth = np.log(spent[-1] / spent[0]) / np.log(counts[-1] / counts[0])
        print(
            f"{file:14} {spent[-1]:7.2f} s {spent[-1] / total:5.0%} "
            f"{megabytes[file]:8.1f} MB  n^{growth:.2f}"
        )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"{'all':14} {total:7.2f} s; {peak:.0f} MB at most")


if __name__ == "__main__":
    main()
