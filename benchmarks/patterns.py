"""Patterns on ten surfaces of varied shape, and on files: what comes out, why not, how long.

python benchmarks/patterns.py [quads | hexagons | triangles | all] [FILE ...]

Of each: status, faces, mean angles of planes and spheres and what was foretold, shortest edge,
distance of nodes and rejected parts, seconds of CPU, and for what is flawed the reason.
"""

import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pattern_surfaces import own_surfaces

from spheremesh import Mesh, Surface
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.meshes.mesh import face_vector_areas
from spheremesh.nodes import hexagon_pattern, quad_pattern, read_mesh, triangle_pattern

PANELS = 300

# Area of a panel with edges of 1.
AREAS = {"quads": 1.0, "hexagons": 1.5 * np.sqrt(3), "triangles": np.sqrt(3) / 4}
MAKERS: dict[str, Callable[..., Any]] = {
    "quads": quad_pattern,
    "hexagons": hexagon_pattern,
    "triangles": triangle_pattern,
}


def tell(name: str, source: Mesh | Surface, which: str) -> None:
    """Cover a surface with about 300 panels and say how it went."""
    mesh = source.mesh if isinstance(source, Surface) else source
    area = float(norm(face_vector_areas(mesh)).sum())
    edge = float(np.sqrt(area / PANELS / AREAS[which]))
    start = time.process_time()
    try:
        report = MAKERS[which](source, edge).report
    except ValueError as error:
        print(f"{name:16.16s} {which:10s} refused: {error}", flush=True)
        return
    seconds, angles = time.process_time() - start, report["angles_deg"]
    rejected, off = report["rejected"], report["deviation"]
    print(
        f"{name:16.16s} {which:10s} {report['status']:14s} {report['faces']['count']:4d} faces "
        f"{angles['planes']:6.2f} -> {angles['spheres']:6.2f} (expected "
        f"{angles['expected']:6.2f}) edge {report['edges']['min']:.2f} "
        f"nodes {off['nodes']:.3f} "
        f"convex {report['convex_share']:.2f} axes {report['node_axis_deg']['max']:.1f} "
        f"rejected {rejected['panels']}, {rejected['beams']} {seconds:5.1f} s"
        f"{'  ' + report['reason'][:120] if report['reason'] else ''}",
        flush=True,
    )


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    asked, files = (sys.argv[1:2] or ["quads"])[0], sys.argv[2:]
    surfaces = own_surfaces() if not files else {Path(f).stem: read_mesh(f) for f in files}
    for pattern in MAKERS if asked == "all" else [asked]:
        for title, surface in surfaces.items():
            tell(title, surface, pattern)
