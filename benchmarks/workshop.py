"""What workshop files cost: STEP, its check, Rhino, schedule, audit, drawings.

    python benchmarks/workshop.py [exact | rhino]

``rhino`` writes the Rhino files alone.
``exact`` also checks every solid of 5,000 panels with OpenCASCADE, as built and as read back
from the file, against the closed forms; that takes minutes. Seconds are CPU time.
"""

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

from exactness import judge_step

from spheremesh.fabrication.audit.report import audit_model
from spheremesh.fabrication.drawings.drawing_set import write_drawings
from spheremesh.fabrication.drawings.moulds import write_mould_drawings
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.opennurbs.render_meshes import (
    MESH_TOLERANCE,
    mesh_streams,
    panel_meshes,
)
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.fabrication.schedules.record_files import write_tables
from spheremesh.fabrication.schedules.writer import write_schedule
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.writer import StepOptions, write_step
from spheremesh.kernel.panels.congruent import congruent_panels
from spheremesh.kernel.panels.mould_blanks import mould_blanks
from spheremesh.kernel.panels.panels import Panels
from spheremesh.nodes import (
    cluster_radii,
    fit_spheres,
    minimize_angles,
    panels,
    roof_mesh,
    torus_mesh,
)


def roof(side: str = "inward") -> Panels:
    """5,000 panels that all differ."""
    optimum = minimize_angles(fit_spheres(roof_mesh(50, 100)))
    clusters = cluster_radii(optimum.sphere_mesh, k=8)
    return panels(
        clusters.sphere_mesh, thickness=0.02, labels=clusters.labels, side=side
    ).panels


def torus() -> Panels:
    """5,000 panels of 25 shapes."""
    optimum = minimize_angles(fit_spheres(torus_mesh(100, 50)))
    return panels(optimum.sphere_mesh, thickness=0.02).panels


def clock(name: str, task: Callable[[], object]) -> None:
    """Print seconds of CPU, and the size of a file."""
    began = time.process_time()
    result = task()
    line = f"{name:28s}{time.process_time() - began:7.2f} s"
    if isinstance(result, Path):
        line += f"{result.stat().st_size / 1e6:9.2f} MB"
    if isinstance(result, tuple):
        line += f"{len(result):6d} findings"
    print(line, flush=True)


def rhino_files(made: Panels, folder: Path) -> None:
    """Panels with user text and edges, with and without render meshes."""
    import rhino3dm  # noqa: F401 - outside the clock

    bare = RhinoOptions(render_meshes=False)
    clock(".3dm", lambda: write_3dm(Model(made), folder / "p.3dm").path)
    clock(".3dm, no render meshes", lambda: write_3dm(Model(made), folder / "b.3dm", bare).path)
    clock("render meshes alone", lambda: mesh_streams(panel_meshes(made, MESH_TOLERANCE)))


def main() -> None:
    """Print a line per task."""
    warnings.simplefilter("ignore")
    folder = Path(tempfile.mkdtemp())
    made = roof()
    rhino_files(made, folder)
    if sys.argv[1:] == ["rhino"]:
        return
    clock("STEP, 5,000 shapes", lambda: write_step(Model(made), folder / "shapes.step").path)
    clock("its check", lambda: check_part21(folder / "shapes.step"))
    ring = torus()
    clock(
        "STEP, instances",
        lambda: (
            write_step(Model(ring), folder / "i.step", StepOptions(copies="instances")).path
        ),
    )
    clock("its check", lambda: check_part21(folder / "i.step"))
    clock("STEP, same without", lambda: write_step(Model(ring), folder / "s.step").path)
    same = congruent_panels(made)
    clock("identical panels", lambda: congruent_panels(made))
    clock("identical panels, torus", lambda: congruent_panels(ring))
    clock("mould blanks", lambda: mould_blanks(made, same))
    clock("audit", lambda: audit_model(Model(made)))
    clock("schedule.csv", lambda: write_schedule(Model(made), folder / "s.csv").path)
    clock("schedule.json", lambda: write_schedule(Model(made), folder / "s.json").path)
    clock("moulds.dxf", lambda: write_mould_drawings(Model(made), folder / "m.dxf").path)
    clock("moulds.svg", lambda: write_mould_drawings(Model(made), folder / "m.svg").path)
    clock("tables.xlsx", lambda: write_tables(Model(made), folder / "t.xlsx").path)
    clock("panel_edges.csv", lambda: write_tables(Model(made), folder / "panel_edges.csv").path)
    clock("drawings.pdf", lambda: write_drawings(Model(made), folder / "d.pdf").path)
    clock("drawings.dxf", lambda: write_drawings(Model(made), folder / "d.dxf").path)
    if sys.argv[1:] == ["exact"]:
        for side in ("inward", "centred"):
            print(side)
            judge_step(roof(side), folder / "exact.step", "m")


if __name__ == "__main__":
    main()
