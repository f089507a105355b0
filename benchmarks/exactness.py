"""How exact are the files? Panels a mesh, writes both CAD files, and judges them from outside.

    python benchmarks/exactness.py MESH [UNITS] [THICKNESS] [MOULDS]

STEP: OpenCASCADE checks every solid and measures area and volume, before writing and after
reading back, against the closed forms. Rhino: rhino3dm checks every Brep, and the distances of
trims, edges, vertices and spheres are measured from the file's own bytes.
"""

import re
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import rhino3dm
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape

from spheremesh.fabrication.model import Model
from spheremesh.fabrication.opennurbs.brep_audit import verify_breps
from spheremesh.fabrication.opennurbs.brep_reader import read_brep_streams
from spheremesh.fabrication.rhino_models.writer import write_3dm
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.fabrication.step.writer import write_step
from spheremesh.fabrication.units import millimeters_per
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import Panels, panel_arcs, panel_areas
from spheremesh.kernel.spheres.arcs import patch_areas
from spheremesh.nodes import cluster_radii, fit_spheres, minimize_angles, panels, read_mesh


def cut(path: str, thickness: float, moulds: int) -> Panels:
    """Panels of a mesh file."""
    optimum = minimize_angles(fit_spheres(read_mesh(path)))
    clusters = cluster_radii(optimum.sphere_mesh, k=moulds)
    result = panels(clusters.sphere_mesh, thickness=thickness, labels=clusters.labels)
    print(f"panels {result.report['written']}, rejected {result.report['rejected']}")
    return result.panels


def measure(shapes: list[TopoDS_Shape]) -> FloatArray:
    """Area of the spheres' faces and volume of each solid (P, 2), and how many are valid."""
    values = np.empty((len(shapes), 2))
    valid = 0
    for i, shape in enumerate(shapes):
        valid += BRepCheck_Analyzer(shape).IsValid()
        faces = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
        areas: list[float] = []
        while faces.More():
            area = GProp_GProps()
            BRepGProp.SurfaceProperties_s(faces.Current(), area)
            areas.append(area.Mass())
            faces.Next()
        volume = GProp_GProps()
        BRepGProp.VolumeProperties_s(shape, volume)
        # A solid lists its outer and inner face before its walls.
        values[i] = sum(areas[:2]), volume.Mass()
    print(f"  valid {valid} of {len(shapes)}")
    return values


def judge_step(made: Panels, path: Path, units: str) -> None:
    """Check STEP solids in memory and as read back."""
    scale = millimeters_per(units)
    inner = patch_areas(made.inner_spheres, panel_arcs(made, "inner"), made.corner_panels)
    areas = (panel_areas(made) + inner) * scale**2
    closed = np.stack([areas, panel_volumes(made) * scale**3], 1)
    print("STEP, before writing")
    worst = np.abs(measure(panel_shapes(made, scale)) / closed - 1).max(0)
    print(f"  worst relative error: area {worst[0]:.1e}, volume {worst[1]:.1e}")
    write_step(Model(made, units=units), path)
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    solids = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID)
    shapes: list[TopoDS_Shape] = []
    while solids.More():
        shapes.append(solids.Current())
        solids.Next()
    print("STEP, read back")
    worst = np.abs(measure(shapes) / closed - 1).max(0)
    print(f"  worst relative error: area {worst[0]:.1e}, volume {worst[1]:.1e}")
    text = path.read_text(encoding="utf-8")
    kinds = Counter(
        re.findall(r"=\s*([A-Z_]*(?:SURFACE|PLANE|CIRCLE|LINE|CURVE)[A-Z_]*)\(", text)
    )
    print(f"  geometry {dict(kinds)}")
    styled = len(re.findall(r"=\s*STYLED_ITEM\(", text))
    layers = len(re.findall(r"=\s*PRESENTATION_LAYER_ASSIGNMENT\(", text))
    names = len(set(re.findall(r"PRODUCT\('(P\d+)'", text)))
    print(f"  names {names}, layers {layers}, coloured {styled}")
    print(f"  {path.stat().st_size / 1e6:.1f} MB")


def judge_rhino(made: Panels, path: Path, units: str) -> None:
    """Check a Rhino file from its bytes and with rhino3dm."""
    write_3dm(Model(made, units=units), path)
    streams = read_brep_streams(path.read_bytes())
    errors = verify_breps(streams, made.spheres, made.origins)
    refused = [error.reason() for error in errors if error.reason()]
    worst = max(error.worst / error.scale for error in errors)
    print(f"3dm, from its bytes: {len(streams)} Breps, refused {len(refused)}")
    print(f"  worst distance between sphere, edge, vertex and trim: {worst:.1e} R")
    model = rhino3dm.File3dm.Read(str(path))
    breps = [item for item in model.Objects if isinstance(item.Geometry, rhino3dm.Brep)]
    valid = sum(item.Geometry.IsValid for item in breps)
    texts = {len(item.Attributes.GetUserStrings()) for item in breps}
    arcs = sum(isinstance(item.Geometry, rhino3dm.ArcCurve) for item in model.Objects)
    lines = sum(isinstance(item.Geometry, rhino3dm.LineCurve) for item in model.Objects)
    print(f"  rhino3dm: valid {valid} of {len(breps)}, user texts per panel {texts}")
    print(f"  edges: {arcs} arcs, {lines} lines; layers {[x.FullPath for x in model.Layers]}")
    print(f"  {path.stat().st_size / 1e6:.1f} MB")


def main() -> None:
    """Judge the files of one mesh."""
    mesh, units, thickness, moulds, *_ = (
        *sys.argv[1:],
        *("m", "0.02", "8")[len(sys.argv) - 2 :],
    )
    warnings.simplefilter("ignore")
    made = cut(mesh, float(thickness), int(moulds))
    with tempfile.TemporaryDirectory() as folder:
        judge_step(made, Path(folder) / "panels.step", units)
        judge_rhino(made, Path(folder) / "model.3dm", units)


if __name__ == "__main__":
    main()
