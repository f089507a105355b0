"""Do panels and beams overlap? OpenCASCADE's Booleans and distances against the audit's own.

    python benchmarks/assembly_booleans.py [MESH ...] [--pairs N]

For three models and three sides of the thickness, random near pairs of panels, of panels and
beams, and of beams: the volume of what both have in common, which must not exceed 1 mm³, and
their distance, which must agree with the audit's to 1e-3 mm. Where OpenCASCADE finds a larger
distance, its own classifier is asked about the two points that the audit found: if both lie in
their solids, the smaller distance is right.
"""

import argparse
import sys
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_State
from OCP.TopoDS import TopoDS_Shape

from spheremesh import Mesh
from spheremesh.fabrication.solids.opencascade_beams import beam_shapes
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.clearances.bodies import (
    Bodies,
    beam_bodies,
    panel_bodies,
    select_bodies,
)
from spheremesh.kernel.clearances.near_pairs import near_pairs
from spheremesh.kernel.clearances.overlaps import nearest_points
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.panels.panels import Panels, scale_panels
from spheremesh.nodes import (
    axis_support,
    beams,
    cluster_radii,
    fit_spheres,
    minimize_angles,
    panels,
    read_mesh,
    roof_mesh,
    torus_mesh,
    vase_mesh,
)

SIDES = "inward", "centred", "outward"
ON = TopAbs_State.TopAbs_ON, TopAbs_State.TopAbs_IN


def assembly(mesh: Mesh, side: str) -> tuple[Panels, Beams]:
    """Panels of six moulds on axis beams, in millimetres; sizes in mean edges."""
    edge = mean_edge_length(mesh)
    spheres = minimize_angles(fit_spheres(mesh)).sphere_mesh
    spheres = cluster_radii(spheres, k=6).sphere_mesh
    annuli = axis_support(spheres, depth=0.25 * edge)
    plates = panels(
        spheres, thickness=0.02 * edge, side=side, edges="axis", axes=annuli.axes,
        joint_gap=0.01 * edge,
    ).panels  # fmt: skip
    bars = beams(annuli.annuli, panels=plates).beams
    scale = 1000 / edge  # mean edges of a metre
    return scale_panels(plates, scale), scale_beams(bars, scale)


@dataclass(frozen=True)
class Found:
    """What OpenCASCADE finds on a pair, in mm³ and mm, and whether the audit was right."""

    parts: tuple[int, int]
    volume: float
    difference: float
    is_settled: bool


def judge(
    parts: tuple[int, int], first: TopoDS_Shape, second: TopoDS_Shape, points: np.ndarray
) -> Found:
    """Common volume of two solids, and how far their distance is from that of two points."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(BRepAlgoAPI_Common(first, second).Shape(), properties)
    own = float(np.linalg.norm(points[0] - points[1]))
    difference = BRepExtrema_DistShapeShape(first, second).Value() - own
    is_settled = abs(difference) <= 1e-3
    if difference > 1e-3:
        is_settled = True
        for shape, point in zip((first, second), points.tolist(), strict=True):
            classifier = BRepClass3d_SolidClassifier(shape)
            classifier.Perform(gp_Pnt(*point), 1e-4)
            is_settled &= classifier.State() in ON
    return Found(parts, properties.Mass(), difference, is_settled)


def pairs_of(plates: Panels, bars: Beams, count: int, seed: int) -> Iterator[tuple[str, Found]]:
    """Judge random near pairs of every kind."""
    random = np.random.default_rng(seed)
    bodies = {"panel": panel_bodies(plates), "beam": beam_bodies(bars)}
    shapes = {"panel": panel_shapes(plates), "beam": beam_shapes(bars)}
    for kind, other in (("panel", "panel"), ("panel", "beam"), ("beam", "beam")):
        first, second = bodies[kind], bodies[other]
        rows, others = near_pairs(first.boxes, second.boxes, 10.0)
        if kind == other:
            keep = first.parts[rows] < second.parts[others]
            rows, others = rows[keep], others[keep]
        chosen = random.permutation(len(rows))[:count]
        i, j = rows[chosen], others[chosen]
        points = nearest_points(_some(first, i), _some(second, j))
        parts = first.parts[i].tolist(), second.parts[j].tolist()
        for a, b, pair in zip(*parts, points, strict=True):
            yield f"{kind}-{other}", judge((a, b), shapes[kind][a], shapes[other][b], pair)


def _some(bodies: Bodies, rows: np.ndarray) -> Bodies:
    return select_bodies(bodies, rows)


def main() -> int:
    """Print a line per model, side and kind; 1 if anything overlaps or disagrees."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", nargs="*", help="Mesh files; three nets by default.")
    parser.add_argument("--net", action="append", help="Only this net: torus, vase, roof.")
    parser.add_argument("--pairs", type=int, default=200, help="Pairs of each kind.")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    nets = {"torus": torus_mesh(24, 16), "vase": vase_mesh(24, 12), "roof": roof_mesh()}
    models = {path: read_mesh(path) for path in arguments.meshes} or {
        name: nets[name] for name in arguments.net or nets
    }
    failures = 0
    for name, mesh in models.items():
        for seed, side in enumerate(SIDES):
            began = time.process_time()
            results: dict[str, list[Found]] = {}
            for kind, found in pairs_of(*assembly(mesh, side), arguments.pairs, seed):
                results.setdefault(kind, []).append(found)
            for kind, found in results.items():
                largest = max(each.volume for each in found)
                wrong = sum(not each.is_settled for each in found)
                refined = sum(each.is_settled and each.difference > 1e-3 for each in found)
                apart = max(
                    (abs(each.difference) for each in found if abs(each.difference) <= 1e-3),
                    default=0.0,
                )
                failures += wrong + (largest > 1)
                for each in found:
                    if not each.is_settled:
                        print(f"  {kind} {each.parts}: {each.difference:+.2g} mm")
                print(
                    f"{name} {side} {kind}: {len(found)} pairs, common at most {largest:.2g} "
                    f"mm³, distances agree to {apart:.1e} mm, {refined} where the audit's is "
                    f"smaller and right, {wrong} wrong"
                )
            print(f"  {time.process_time() - began:.0f} s")
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
