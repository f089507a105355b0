"""Exact supports on a folder of meshes: what they cost, what they give, one radius or many.

    python benchmarks/exact_supports.py FOLDER [--one-radius] [--names conical1 cmc1]

Prints a row for every mesh: torsion and gap, tilt of beams, mean angle of flat panels and of
spheres, moves off the surface and in it, seconds of CPU; for those without, the reason.
"""

import argparse
import time
import warnings
from pathlib import Path

from spheremesh import Mesh
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import exact_support, read_mesh


def row(name: str, mesh: Mesh, *, one_radius: bool) -> str:
    """One row of the table."""
    began = time.process_time()
    try:
        _, report = exact_support(mesh, one_radius=one_radius)
    except InputError as error:
        return f"{name:30s}{mesh.n_faces:6d}  refused: {error}"
    seconds = time.process_time() - began
    planar, spherical = (report.angles_deg[key]["mean"] for key in ("planar", "spherical"))
    radii = report.radii
    spread = 0.0
    if radii["min"] and radii["max"]:
        spread = radii["max"] / radii["min"] - 1
    return (
        f"{name:30s}{mesh.n_faces:6d}  {report.verdict:9s}"
        f"{report.torsion_deg['max']:8.0e}{report.gap['relative_to_edge']:8.0e}"
        f"{report.beam_tilt_deg['p95']:6.1f}{report.beam_tilt_deg['max']:6.1f}"
        f"{planar:7.2f} ->{spherical:6.2f}"
        f"{report.height['p95']:7.3f}{report.height['max']:7.3f}"
        f"{report.slide['p95']:6.2f}{report.slide['max']:6.2f}{report.rim['max']:7.3f}"
        f"{spread:9.1e}{report.curvature['factor']:5.1f}{seconds:7.1f}  {report.reason}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--one-radius", action="store_true")
    parser.add_argument("--names", nargs="*", help="Only these files, without their ending.")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    print(
        f"{'mesh':30s}{'faces':>6s}  {'verdict':9s}{'torsion':>8s}{'gap':>8s}"
        f"{'tilt p95 max':>12s}{'mean angle':>16s}{'height p95 max':>14s}{'slide p95 max':>12s}"
        f"{'rim':>7s}{'radii':>9s}{'κ/κ0':>5s}{'CPU s':>7s}"
    )
    for path in sorted(options.folder.glob("*.obj")):
        if not options.names or path.stem in options.names:
            mesh = read_mesh(str(path))
            print(row(path.stem, mesh, one_radius=options.one_radius), flush=True)


if __name__ == "__main__":
    main()
