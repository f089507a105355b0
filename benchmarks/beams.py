"""How well do beams meet, and how fast are they written? Nodes, annuli, solids and files.

    python benchmarks/beams.py [MESH ...]

Without meshes, on nets of revolution. For each net and kind of spheres: torsion and tilt, how
far ends at a node are apart, whether OpenCASCADE finds all solids valid, their volumes against
the closed form, and processor time per beam. Depth 0.3, thickness 0.05, gap 0.01 mean edges.
"""

import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import ezdxf
import numpy as np
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Shape

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.solids.opencascade_beams import beam_shapes
from spheremesh.kernel.beams.beams import beam_volumes
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.support.annuli import corner_mismatch
from spheremesh.nodes import (
    annulus_support,
    beams,
    central_spheres,
    face_planes,
    fit_spheres,
    minimize_angles,
    read_mesh,
    support_structure,
    torus_mesh,
    vase_mesh,
    write_3dm,
    write_dxf,
    write_step,
)

T = TypeVar("T")


def timed(call: Callable[[], T]) -> tuple[T, float]:
    """Result and processor time in milliseconds."""
    start = time.process_time()
    return call(), 1000 * (time.process_time() - start)


def volume(shape: TopoDS_Shape) -> float:
    """Volume by OpenCASCADE."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, 1e-10)
    return properties.Mass()


def report(name: str, sphere_mesh: SphereMesh) -> None:
    """Print the figures of one sphere mesh."""
    size = mean_edge_length(sphere_mesh.mesh)
    nodes, ms = timed(lambda: support_structure(sphere_mesh))
    found = nodes.report
    print(
        f"{name}: {sphere_mesh.mesh.n_faces} faces\n"
        f"  nodes: torsion mean {found['torsion_deg']['mean']:.2g} max "
        f"{found['torsion_deg']['max']:.2g} deg, tilt p95 {found['beam_tilt_deg']['p95']:.3g} "
        f"max {found['beam_tilt_deg']['max']:.3g} deg, mirror miss {found['mirror_miss']:.1e} "
        f"edges, valid {found['valid']} of {len(nodes.torsion)}, {ms:.0f} ms"
    )
    annuli, ms = timed(lambda: annulus_support(sphere_mesh, depth=0.3 * size))
    rejected = Counter(each["reason"].split(" ")[1] for each in annuli.report["rejected"])
    limit = annuli.report["kappa_max"]
    inside = ~sphere_mesh.mesh.topology.is_boundary_vertex[annuli.annuli.edge_vertices]
    apart = corner_mismatch(annuli.annuli)[inside].max(initial=0.0) / size
    print(
        f"  annuli: {annuli.report['made']} made, rejected {dict(rejected)}, ends apart "
        f"{annuli.report['corner_mismatch']['relative_to_edge']:.1e} edges (inside "
        f"{apart:.1e}), kappa up to "
        f"{'any' if limit is None else f'{limit / size**2:.3g} edges²'}, {ms:.0f} ms"
    )
    if annuli.report["made"] == 0:
        return
    made, ms = timed(lambda: beams(annuli.annuli, 0.05 * size, node_gap=0.01 * size))
    count = made.report["written"]
    print(
        f"  beams: {count} made, rejected {len(made.report['rejected'])}, "
        f"{ms / count:.3f} ms each"
    )
    scale = 1000.0
    shapes, ms = timed(lambda: beam_shapes(made.beams, scale))
    full = beam_shapes(made.beams, scale)
    valid = sum(BRepCheck_Analyzer(shape).IsValid() for shape in full)
    exact = beam_volumes(made.beams) * scale**3
    error = np.abs(np.array([volume(shape) for shape in full]) / exact - 1).max()
    print(
        f"  solids: {valid} of {len(shapes)} valid, volumes within {error:.1e}, "
        f"{ms / count:.2f} ms each"
    )
    with tempfile.TemporaryDirectory() as folder:
        target = str(Path(folder) / "b")
        _, step = timed(lambda: write_step(beams=made.beams, path=f"{target}.step"))
        _, rhino = timed(lambda: write_3dm(beams=made.beams, path=f"{target}.3dm"))
        _, dxf = timed(lambda: write_dxf(made.beams, f"{target}.dxf"))
        drawing = ezdxf.readfile(f"{target}.dxf")  # pyright: ignore
        audit, check = timed(drawing.audit)
        print(
            f"  files: STEP {step / count:.2f}, Rhino {rhino / count:.2f}, DXF "
            f"{dxf / count:.2f} ms each; audit {len(audit.errors)} errors, "
            f"{check / count:.2f} ms each"
        )


def kinds(mesh: Mesh) -> dict[str, SphereMesh]:
    """Sphere meshes on a mesh: planes, least angles, and central spheres if it is circular."""
    result = {
        "planes": face_planes(mesh),
        "least angles": minimize_angles(fit_spheres(mesh)).sphere_mesh,
    }
    try:
        result["central spheres"] = central_spheres(mesh)
    except ValueError:
        print("not circular: no central spheres")
    return result


def main() -> None:
    """Figures of all nets."""
    warnings.simplefilter("ignore")
    meshes = {Path(path).name: read_mesh(path) for path in sys.argv[1:]}
    if not meshes:
        meshes = {"torus": torus_mesh(), "vase": vase_mesh()}
    few = annulus_support(face_planes(torus_mesh(6, 5)), depth=0.1).annuli
    with tempfile.TemporaryDirectory() as folder:
        warm = beams(few, 0.01).beams
        write_step(beams=warm, path=f"{folder}/w.step")
        write_3dm(beams=warm, path=f"{folder}/w.3dm")
        write_dxf(warm, f"{folder}/w.dxf")
    for name, mesh in meshes.items():
        for kind, sphere_mesh in kinds(mesh).items():
            report(f"{name}, {kind}", sphere_mesh)


if __name__ == "__main__":
    main()
