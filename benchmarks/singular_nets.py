"""Freeform congruences with singular directions, remeshed until they can be built.

Ten surfaces of varied shape and topology, each with spheres of constant radius and with those
of Section 7, which grow towards the curvature spheres while node axes stay within 15 degrees of
the normals. Asked for: planarity below 1e-6, corner gaps below 1e-3 edges, no flipped triangle
of the map and no face turned over, no edge below a fifth of the mean. What fails says why.

    python benchmarks/singular_nets.py [name of a surface ...]
"""

import sys
import time
import warnings
from typing import Any, NamedTuple

import numpy as np
from remeshing import Surface, singular_surfaces

from spheremesh import SphereMesh
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.nodes import annulus_support, beams, evolve_spheres, p4_remesh, panels

PLANARITY, GAP, SHORTEST = 1e-6, 1e-3, 0.2


class Case(NamedTuple):
    """A surface, the signed offset of its centres, and the edge length of the net."""

    surface: Surface
    offset: float
    edge: float


def net_of(case: Case, spheres: str) -> Any:  # noqa: ANN401
    """The net of constant or of grown spheres, planarised."""
    (mesh, normals), offset, edge = case
    if spheres == "constant":
        rows = touching_spheres(mesh.vertices, normals, np.full(len(normals), 1 / offset))
        return p4_remesh(mesh, rows, edge)
    grown = evolve_spheres(mesh, 15, "plus" if offset > 0 else "minus")
    return p4_remesh(grown.mesh, grown.spheres, edge)


def misses(report: dict[str, Any]) -> list[str]:
    """What a net fails of what is asked for."""
    planar = report["planarized"]
    if planar is None:
        return ["torsion"]
    found = {
        "planarity": planar["planarity"]["after"] >= PLANARITY,
        "gap": planar["corner_gap"]["after"] >= GAP,
        "flips": report["flipped"] + len(planar["turned_faces"]) > 0,
        "short edges": planar["shortest_edge"]["after"] <= SHORTEST,
    }
    return [name for name, fails in found.items() if fails]


def built(net: SphereMesh) -> str:
    """Panels and beams rejected."""
    size = mean_edge_length(net.mesh)
    cut = panels(net, edges="intersection", thickness=0.02 * size)
    annuli = annulus_support(net, depth=0.15 * size)
    made = beams(annuli.annuli)
    rejected = [len(part.report["rejected"]) for part in (cut, annuli, made)]
    return f"rejected of {net.mesh.n_faces} panels {rejected[0]}, of beams {sum(rejected[1:])}"


def show(name: str, case: Case, spheres: str) -> bool:
    """Print the figures of a net, and whether it is as asked for."""
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        net = net_of(case, spheres)
    seconds = time.perf_counter() - start
    report, planar = net.report, net.report["planarized"]
    failed = misses(report)
    print(f"{name}, {spheres}: {'fails by ' + ', '.join(failed) if failed else 'as asked for'}")
    print(
        f"    {report['faces']['degrees']} faces, {report['irregular_nodes']} irregular nodes, "
        f"{len(report['singular'])} singular points, flips {report['folded']} -> "
        f"{report['flipped']}, {seconds:.1f} s"
    )
    if planar is not None:
        print(
            f"    planarity {planar['planarity']['before']:.0e} -> "
            f"{planar['planarity']['after']:.0e}, gap {planar['corner_gap']['before']:.2f} -> "
            f"{planar['corner_gap']['after']:.0e}, shortest edge "
            f"{planar['shortest_edge']['before']:.2f} -> "
            f"{planar['shortest_edge']['after']:.2f}, real nodes "
            f"{100 * planar['real_nodes']['after']:.1f} %, without axis "
            f"{len(planar['nodes_without_axis'])}, axes p95 "
            f"{planar['axis_angles_deg']['p95']:.1f} deg, moved {planar['moved']['max']:.2f} "
            f"mean {planar['moved']['mean']:.2f}"
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            print(f"    {built(net.sphere_mesh)}")
    for entry in caught if failed else ():
        print(f"    said: {entry.message}")
    return not failed


def main(names: list[str]) -> None:
    """Every surface with both kinds of spheres."""
    cases = {name: Case(*case) for name, case in singular_surfaces().items()}
    met = {"constant": 0, "grown": 0}
    chosen = names or list(cases)
    for name in chosen:
        for spheres in met:
            met[spheres] += show(name, cases[name], spheres)
            sys.stdout.flush()
    for spheres, count in met.items():
        print(f"{spheres}: {count} of {len(chosen)} as asked for")


if __name__ == "__main__":
    main(sys.argv[1:])
