"""Supports of meshes as `panel --support --moulds 6` makes them: one line for each mesh.

    python benchmarks/supports.py FOLDER_OR_MESH ... [--kind axis|exact|bisector]

Thickness 0.02, depth 0.25 of a mean edge; steps of 5 % of it and gaps of 3 % are allowed.
Verdict, panels and beams written, torsion, gaps in
the middle of edges and steps at their ends (in % of a mean edge), tilt inside, mean angles with
planes and spheres, errors of the audit, seconds of the processor for all but writing files.
"""

import argparse
import time
import warnings
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spheremesh.interfaces.panel import PanelOptions, feasible_panel_graph
from spheremesh.kernel.errors import SpheremeshError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.nodes import read_mesh
from spheremesh.nodes.graphs.errors import GraphError, NodeError

HEADER = (
    f"{'mesh':28} {'verdict':8} {'kind':8} {'panels':>9} {'beams':>9} {'torsion':>7} "
    f"{'gap p95':>7} {'max':>6} {'step p95':>8} {'max':>6} {'tilt p95':>8} {'max':>5} "
    f"{'planes':>6} {'spheres':>7} {'errors':>6} {'CPU s':>6}"
)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("paths", nargs="+", type=Path)
    parser.add_argument("--kind", choices=["axis", "exact", "bisector"], default="axis")
    parser.add_argument("--moulds", type=int, default=6)
    arguments = parser.parse_args()
    print(HEADER)
    for place in arguments.paths:
        for path in sorted(place.glob("*.obj")) if place.is_dir() else [place]:
            print(_line(path, arguments.kind, arguments.moulds), flush=True)


def _line(path: Path, kind: Any, moulds: int) -> str:  # noqa: ANN401
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        edge = mean_edge_length(read_mesh(path))
        options = PanelOptions(
            mesh=path, moulds=moulds or None, thickness=0.02 * edge, support=kind,
            depth=0.25 * edge, allow_step=50 * edge, allow_gap=30 * edge,
        )  # fmt: skip
        began = time.process_time()
        try:
            graph = feasible_panel_graph(options)
            report = graph.run("report")
        except (SpheremeshError, GraphError, NodeError) as error:
            return f"{path.stem[:28]:28} {error}"
        spent = time.process_time() - began
    return _facts(path.stem, report, edge, spent)


def _facts(name: str, report: Mapping[str, Any], edge: float, spent: float) -> str:
    support, angles, gap = report["support"], report["angles_deg"], report["edge_gap"]
    made = [
        f"{part['written']}-{len(part['rejected'])}"
        for part in (report["panels"], report["beams"])
    ]
    share = 100 / edge
    return (
        f"{name[:28]:28} {support['feasibility']['verdict']:8} {support['kind']:8} "
        f"{made[0]:>9} {made[1]:>9} {support['torsion_deg_max']:7.3f} "
        f"{share * gap['middle_p95']:7.2f} {share * gap['middle_max']:6.2f} "
        f"{share * gap['corner_p95']:8.2f} {share * gap['corner_max']:6.2f} "
        f"{support['beam_tilt_deg_p95']:8.1f} {support['beam_tilt_deg_max']:5.1f} "
        f"{angles['planar']['mean']:6.2f} {angles['spherical']['mean']:7.2f} "
        f"{len(report['audit']['errors']):6d} {spent:6.2f} {_counts(report['audit'])}"
    )


def _counts(audit: Mapping[str, Any]) -> str:
    """How often each error occurs."""
    counts = Counter(found["code"] for found in audit["errors"])
    return " ".join(f"{code}:{count}" for code, count in sorted(counts.items()))


if __name__ == "__main__":
    main()
