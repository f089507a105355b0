"""How exact are panels and beams of the whole job? OpenCASCADE judges, built and read back.

    python benchmarks/support_exactness.py [MESH | roof | nodes ...]

The job is ``spheremesh panel MESH --support --thickness 0.02 --depth 0.25``; ``roof`` is a roof
of 5,000 faces. Every solid is checked; areas and volumes are compared with closed forms and
integrals over plane sections, radii of all surfaces with the kernel's, and the text of the file
is checked without OpenCASCADE. ``nodes`` are nets whose annuli meet, mitred and square.
Minutes for 5,000 faces.
"""

import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
from node_ends import judge_ends, judge_square_ends
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Shape

from spheremesh import SphereMesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.solids.opencascade_beams import beam_shapes
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.writer import write_step
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.beams.beams import Beams, beam_volumes, cut_corners, insets_at
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import (
    Panels,
    panel_arcs,
    panel_areas,
)
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.spheres.arcs import (
    Arcs,
    arc_lengths,
    patch_areas,
    segment_areas,
    sphere_arcs,
)
from spheremesh.kernel.spheres.rows import center_radius
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.nodes import roof_mesh, torus_mesh, vase_mesh

MILLIMETERS = 1000.0


def job(name: str, folder: Path) -> tuple[SphereMesh, Panels, Beams]:
    """What the command makes of a mesh."""
    path = Path(name)
    if name == "roof":
        mesh, path = roof_mesh(50, 100), folder / "roof.obj"
        vertices = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist()]
        faces = ["f " + " ".join(str(i + 1) for i in face) + "\n" for face in mesh.faces]
        path.write_text("".join(vertices + faces), encoding="ascii")
    graph = panel_graph(PanelOptions(mesh=path, support="axis", thickness=0.02, depth=0.25))
    for step in ("panels", "annuli", "beams"):
        found = graph.run(f"{step}.report")
        made = found.get("written", found.get("made"))
        codes = [each.get("code", each["reason"]) for each in found["rejected"]]
        print(f"{step}: {made} made, {len(codes)} rejected {sorted(set(codes))}")
    names = ("landing.sphere_mesh", "panels.panels", "beams.beams")
    sphere_mesh, panels, beams = (graph.run(each) for each in names)
    return sphere_mesh, panels, beams


def panel_measures(panels: Panels) -> FloatArray:
    """Areas of all faces, and volumes (P, 2), in model units; walls are segments and quads."""
    owners, outer, inner = panels.corner_panels, panel_arcs(panels), panel_arcs(panels, "inner")
    areas = panel_areas(panels) + patch_areas(panels.inner_spheres, inner, owners)
    walls = np.abs(_quads(outer, inner, panels.plane_normals))
    up = unit(outer.starts - inner.starts)
    for arcs, sign in ((outer, 1), (inner, -1)):
        walls += sign * np.sign(dot(arcs.rises, up)) * segment_areas(arcs)
    return np.stack([areas + np.bincount(owners, walls), panel_volumes(panels)], 1)


def _quads(outer: Arcs, inner: Arcs, normals: FloatArray) -> FloatArray:
    return dot(np.cross(outer.ends - inner.starts, outer.starts - inner.ends), normals) / 2


def beam_measures(beams: Beams) -> FloatArray:
    """Areas of all faces by quadrature over the thickness, and volumes (B, 2)."""
    half = np.full(beams.n_beams, beams.thickness / 2)
    areas = _section(beams, -half)[0] + _section(beams, half)[0]
    ridges = np.sort(beams.levels[:, :, 1], axis=1)
    bounds = np.column_stack([-half, ridges, half])
    nodes, weights = np.polynomial.legendre.leggauss(12)
    for low, high in zip(bounds.T[:-1], bounds.T[1:], strict=True):
        slopes = insets_at(beams.levels, beams.insets, high)
        slopes = slopes - insets_at(beams.levels, beams.insets, low)
        rise = np.maximum(high - low, 1e-300)[:, None]
        slant = np.sqrt(1 + (slopes / rise) ** 2)
        for node, weight in zip(nodes, weights, strict=True):
            _, girths, widths = _section(beams, (low + high) / 2 + node * (high - low) / 2)
            areas += weight * (high - low) / 2 * (girths + (slant * widths).sum(axis=1))
    return np.stack([areas, beam_volumes(beams)], 1)


def _section(beams: Beams, heights: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Area of a plane section, length of its two arcs, and width of its ends (B, 2)."""
    insets = insets_at(beams.levels, beams.insets, heights)
    corners = cut_corners(beams.annuli, insets[..., None])[0][:, :, :, 0]
    planes = beams.annuli.frames[:, 2]
    outer, inner = (
        sphere_arcs(rows, -planes, corners[:, 0, k], corners[:, 1, k])
        for k, rows in enumerate((beams.annuli.outer, beams.annuli.inner))
    )
    areas = _quads(outer, inner, planes) + segment_areas(outer) - segment_areas(inner)
    widths = norm(corners[:, :, 0] - corners[:, :, 1])
    return areas, arc_lengths(outer) + arc_lengths(inner), widths


def panel_radii(panels: Panels) -> FloatArray:
    """Radii of outer and inner faces (P, 2); infinite for planes."""
    rows = (panels.spheres, panels.inner_spheres)
    return np.sqrt(np.stack([center_radius(each)[1] for each in rows], 1))


def beam_radii(beams: Beams) -> FloatArray:
    """Radii of outer and inner faces (B, 2); infinite for planes."""
    with np.errstate(divide="ignore"):
        return 0.5 / np.abs(
            np.stack([beams.annuli.outer[:, 0], beams.annuli.inner[:, 0]], axis=1)
        )


def judge(shapes: list[TopoDS_Shape], measures: FloatArray, radii: FloatArray) -> str:
    """Validity, and largest relative errors of areas, volumes and radii."""
    valid, found = 0, np.empty_like(measures)
    worst = 0.0
    for i, shape in enumerate(shapes):
        valid += BRepCheck_Analyzer(shape).IsValid()
        area, volume = GProp_GProps(), GProp_GProps()
        BRepGProp.SurfaceProperties_s(shape, area, 1e-10)
        BRepGProp.VolumeProperties_s(shape, volume, 1e-10)
        found[i] = area.Mass(), volume.Mass()
        expected = np.sort(radii[i][np.isfinite(radii[i])])
        seen = np.sort(surface_radii(shape))
        assert len(seen) == len(expected), (i, seen, expected)
        worst = max(worst, np.abs(seen / expected - 1).max(initial=0.0))
    areas, volumes = np.abs(found / measures - 1).max(axis=0)
    return (
        f"valid {valid} of {len(measures)}, areas within {areas:.1e}, volumes {volumes:.1e}, "
        f"radii {worst:.1e}"
    )


def surface_radii(shape: TopoDS_Shape) -> list[float]:
    """Radii of spheres and cylinders."""
    faces, radii = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE), []
    while faces.More():
        surface = BRepAdaptor_Surface(TopoDS.Face_s(faces.Current()))
        if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Sphere:
            radii.append(surface.Sphere().Radius())
        elif surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder:
            radii.append(surface.Cylinder().Radius())
        faces.Next()
    return radii


def read_solids(path: Path) -> list[TopoDS_Shape]:
    """Solids of a STEP file, in its order."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    solids, found = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID), []
    while solids.More():
        found.append(solids.Current())
        solids.Next()
    return found


def judge_job(name: str) -> None:
    """Print the figures of one job."""
    print(f"\n{name}")
    with tempfile.TemporaryDirectory() as folder:
        sphere_mesh, panels, beams = job(name, Path(folder))
        judge_ends(beams, sphere_mesh)
        scale = np.array([MILLIMETERS**2, MILLIMETERS**3])
        kinds = {
            "panels": (panel_measures(panels) * scale, panel_radii(panels) * MILLIMETERS),
            "beams": (beam_measures(beams) * scale, beam_radii(beams) * MILLIMETERS),
        }
        print("as built")
        print("  panels:", judge(panel_shapes(panels, MILLIMETERS), *kinds["panels"]))
        print("  beams: ", judge(beam_shapes(beams, MILLIMETERS), *kinds["beams"]), flush=True)
        began = time.process_time()
        path = write_step(Model(panels, beams), Path(folder) / "model.step").path
        seconds, count = time.process_time() - began, panels.n_panels + beams.n_beams
        print(
            f"model.step: {seconds:.2f} s, {1000 * seconds / count:.2f} ms each, "
            f"{path.stat().st_size / 1e6:.1f} MB, {len(check_part21(path))} findings"
        )
        solids = read_solids(path)
        print(f"read back: {len(solids)} solids of {count}")
        print("  panels:", judge(solids[: panels.n_panels], *kinds["panels"]))
        print("  beams: ", judge(solids[panels.n_panels :], *kinds["beams"]), flush=True)


def judge_nodes() -> None:
    """Print how ends meet where annuli do."""
    meshes = {"torus": torus_mesh(), "vase": vase_mesh(), "roof": roof_mesh(20, 30)}
    for name, mesh in meshes.items():
        print(f"\n{name}, central spheres")
        sphere_mesh, size = central_spheres(mesh), mean_edge_length(mesh)
        annuli = annulus_support(sphere_mesh, 0.25 * size).annuli
        judge_ends(cut_beams(annuli, 0.025 * size)[0], sphere_mesh)
        square, _ = cut_beams(annuli, 0.025 * size, 0.01 * size, 0.05 * size)
        judge_square_ends(square, sphere_mesh)


def main() -> None:
    """Judge the jobs that are named."""
    warnings.simplefilter("ignore")
    for name in sys.argv[1:] or ["nodes"]:
        if name == "nodes":
            judge_nodes()
        else:
            judge_job(name)


if __name__ == "__main__":
    main()
