"""Does the unit of a drawing change what is made of it? The whole job, in m, mm and ft.

    python benchmarks/units.py [FACES ACROSS x FACES ALONG ...]

The jobs are ``spheremesh panel ROOF --thickness 0.02`` in metres, alone, with ``--moulds 8``
and with ``--support --depth 0.25``, and the same lengths in the others. Compared are the
corners of panels and beams and the radii of the spheres, all in millimetres, relative to the
largest number of their kind; radii as curvatures.
"""

import itertools
import sys
import tempfile
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from spheremesh import Mesh
from spheremesh.fabrication.units import millimeters_per
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.kernel.arrays import FloatArray
from spheremesh.nodes import roof_mesh, write_mesh


def fabricated(mesh: Mesh, job: str, units: str, folder: Path) -> dict[str, FloatArray]:
    """What the job makes of a mesh in metres, drawn in some unit."""
    millimeters = millimeters_per(units)
    scale = millimeters_per("m") / millimeters
    drawn = Mesh(mesh.vertices * scale, mesh.faces)
    path = Path(write_mesh(drawn, folder / f"roof_{units}.obj"))
    options = PanelOptions(mesh=path, units=units, thickness=0.02 * scale)
    if job == "moulds":
        options = replace(options, moulds=8)
    elif job == "support":
        options = replace(options, support="axis", depth=0.25 * scale)
    graph = panel_graph(options)
    panels = graph.run("panels.panels")
    result = {
        "corners of panels": panels.corners + panels.origins[panels.corner_panels],
        "curvatures": 2 * panels.spheres[:, 0] / millimeters**2,
    }
    if "beams" in graph.steps:
        beams = graph.run("beams.beams")
        result["corners of beams"] = beams.corners + beams.annuli.origins[:, None, None, None]
    return {name: values * millimeters for name, values in result.items()}


def main() -> None:
    """Compare the roofs that are named."""
    warnings.simplefilter("ignore")
    names = sys.argv[1:] or ["6x8", "12x10", "16x24", "24x60", "50x100"]
    for name, job in itertools.product(names, ("plain", "moulds", "support")):
        mesh = roof_mesh(*map(int, name.split("x")))
        with tempfile.TemporaryDirectory() as folder:
            meters, *others = (
                fabricated(mesh, job, units, Path(folder)) for units in ("m", "mm", "ft")
            )
        for units, other in zip(("mm", "ft"), others, strict=True):
            if any(other[key].shape != x.shape for key, x in meters.items()):
                print(f"{name}, {job}, {units}: other parts are made")
                continue
            figures = ", ".join(
                f"{key} {np.abs(other[key] - x).max() / np.abs(x).max():.1e}"
                for key, x in meters.items()
            )
            print(f"{name}, {job}, {units} against m: {figures}", flush=True)


if __name__ == "__main__":
    main()
