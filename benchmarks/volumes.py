"""Volumes of every part in all files of a job: STEP, .3dm, IFC and schedule.

    python benchmarks/volumes.py MESH ...

For each mesh `spheremesh panel --support --moulds 8 --thickness 0.02 --depth 0.25 --ifc` runs.
OpenCASCADE measures the solids of the STEP file, our verifier the Breps of the .3dm from their
bytes (openNURBS says whether they are valid), and IfcOpenShell builds those of the IFC file:
all are compared with the schedule. Minutes for a thousand panels.
"""

import json
import subprocess
import sys
import tempfile
from io import BytesIO
from pathlib import Path
from typing import Any

import ifcopenshell
import ifcopenshell.geom as geometry
import numpy as np
import rhino3dm
from OCP.BRep import BRep_Builder
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepTools import BRepTools
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape

from spheremesh.fabrication.opennurbs.brep_audit import verify_breps
from spheremesh.fabrication.opennurbs.brep_reader import read_brep_streams

OPTIONS = (
    "--support", "axis", "--moulds", "8", "--thickness", "0.02", "--depth", "0.25", "--ifc",
)  # fmt: skip


def measured(shape: Any) -> float:  # noqa: ANN401
    """Volume of a solid in cubic metres of its file, NaN if it is not closed and valid."""
    facts = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, facts, 1e-9)
    return facts.Mass() if BRepCheck_Analyzer(shape).IsValid() else np.nan


def of_step(path: Path) -> list[float]:
    """In the order of the file: panels, then beams."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    explorer, found = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID), []
    while explorer.More():
        found.append(measured(explorer.Current()) * 1e-9)
        explorer.Next()
    return found


def of_rhino(path: Path) -> list[float]:
    """In the order of the file, and NaN where openNURBS finds no valid solid."""
    model = rhino3dm.File3dm.Read(str(path))
    solids = [x.Geometry for x in model.Objects if x.Geometry.ObjectType.name == "Brep"]
    volumes = [errors.volume for errors in verify_breps(read_brep_streams(path.read_bytes()))]
    return [
        volume if solid.IsValid and solid.IsSolid else np.nan
        for solid, volume in zip(solids, volumes, strict=True)
    ]


def of_ifc(path: Path) -> dict[str, float]:
    """By name."""
    settings = geometry.settings()
    settings.set("iterator-output", geometry.ifcopenshell_wrapper.SERIALIZED)
    model = ifcopenshell.open(str(path))
    found: dict[str, float] = {}
    for part in (*model.by_type("IfcPlate"), *model.by_type("IfcMember")):
        shape = TopoDS_Shape()
        text = geometry.create_shape(settings, part).geometry.brep_data
        BRepTools.Read_s(shape, BytesIO(text.encode()), BRep_Builder())
        found[part.Name] = measured(shape)
    return found


def main() -> None:
    """Print the largest relative difference of each file."""
    for mesh in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as name:
            command = [sys.executable, "-m", "spheremesh", "panel", mesh, "-o", name, *OPTIONS]
            subprocess.run(command, check=False, capture_output=True)
            folder = Path(name)
            listed = json.loads((folder / "schedule.json").read_text("utf-8"))
            rows = [*listed["panels"], *listed["beams"]]
            expected = np.array([row["volume_m3"] for row in rows])
            ifc = of_ifc(folder / "model.ifc")
            print(f"{Path(mesh).stem}: {len(rows)} parts")
            for file, volumes in (
                ("panels.step", of_step(folder / "panels.step")),
                ("model.3dm", of_rhino(folder / "model.3dm")),
                ("model.ifc", [ifc.get(row["id"], np.nan) for row in rows]),
            ):
                misses = np.abs(np.array(volumes)[: len(rows)] / expected - 1)
                print(
                    f"  {file}: {np.isfinite(misses).sum()} closed and valid, "
                    f"within {np.nanmax(misses):.1e}, "
                    f"{(folder / file).stat().st_size / 1e6:.1f} MB",
                    flush=True,
                )


if __name__ == "__main__":
    main()
