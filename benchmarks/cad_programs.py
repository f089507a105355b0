"""What CAD programs make of STEP files: checks, cuts, meshes and names.

    python benchmarks/cad_programs.py

200 panels of a vase and of an ellipsoid, 0.02 thick, and 20 mitred beams of a roof. Every solid
is judged by OpenCASCADE for Boolean operations (`BOPAlgo_ArgumentAnalyzer`, all modes), halved
by a box and meshed; 20 of each are meshed with tetrahedra by gmsh; FreeCAD, if it is installed,
checks, halves and meshes them as well. Then the names that gmsh and, if it is installed,
build123d give to the parts.
"""

import json
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.StlAPI import StlAPI_Writer
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer

from spheremesh import nodes
from spheremesh.kernel.parts.records import select_parts

MODES = (
    "ArgumentType", "SelfInter", "SmallEdge", "RebuildFace", "Continuity", "CurveOnSurface",
    "Tangent", "MergeVertex", "MergeEdge",
)  # fmt: skip

FREECAD = """
import json, sys
import FreeCAD, Mesh, Part
shape = Part.Shape()
shape.read({path!r})
found = dict(solids=len(shape.Solids), faults=0, cuts=0, meshes=0)
for solid in shape.Solids:
    try:
        solid.check(True)
    except ValueError:
        found["faults"] += 1
    box = solid.BoundBox
    half = Part.makeBox(
        box.XLength, box.YLength + 2, box.ZLength + 2,
        FreeCAD.Vector(box.Center.x, box.YMin - 1, box.ZMin - 1),
    )
    rest, taken = solid.cut(half), solid.common(half)
    whole = abs((rest.Volume + taken.Volume) / solid.Volume - 1) < 1e-6
    found["cuts"] += bool(rest.isValid() and whole)
    mesh = Mesh.Mesh(solid.tessellate(1.0))
    found["meshes"] += bool(mesh.isSolid() and not mesh.hasSelfIntersections())
print("FOUND" + json.dumps(found))
"""

NAMES = """
import build123d, json
def walk(part):
    yield part.label
    for child in part.children:
        yield from walk(child)
print("FOUND" + json.dumps(list(walk(build123d.import_step({path!r})))))
"""


def models() -> dict[str, tuple[Any, Any]]:
    """Panels and beams by name."""
    made: dict[str, tuple[Any, Any]] = {}
    for name, mesh in (
        ("vase", nodes.vase_mesh(20, 10)), ("ellipsoid", nodes.ellipsoid_mesh(20, 10)),
    ):  # fmt: skip
        made[name] = nodes.panels(nodes.fit_spheres(mesh), thickness=0.02).panels, None
    spheres = nodes.minimize_angles(nodes.fit_spheres(nodes.roof_mesh(3, 4))).sphere_mesh
    annuli = nodes.axis_support(spheres, 0.25).annuli
    made["beams"] = None, nodes.beams(annuli).beams
    return made


def solids(path: Path) -> list[Any]:
    """As OpenCASCADE reads them."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    explorer, found = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def is_sound(shape: Any) -> bool:  # noqa: ANN401
    """For Boolean operations."""
    analyzer = BOPAlgo_ArgumentAnalyzer()
    analyzer.SetShape1(shape)
    for mode in MODES:
        setattr(analyzer, f"{mode}Mode", True)
    analyzer.Perform()
    return not analyzer.HasFaulty()


def volume(shape: Any) -> float:  # noqa: ANN401
    """Of a solid."""
    facts = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, facts)
    return facts.Mass()


def is_halved(shape: Any) -> bool:  # noqa: ANN401
    """Whether a box takes half of it, and what is left is valid and as large as it looks."""
    sides = Bnd_Box()
    BRepBndLib.Add_s(shape, sides)
    low, high = sides.CornerMin(), sides.CornerMax()
    middle, far = (low.X() + high.X()) / 2, high.X() + 1
    parts = [
        BRepAlgoAPI_Cut(
            shape,
            BRepPrimAPI_MakeBox(
                gp_Pnt(a, low.Y() - 1, low.Z() - 1), gp_Pnt(b, high.Y() + 1, high.Z() + 1)
            ).Shape(),
        )
        for a, b in ((middle, far), (low.X() - 1, middle))
    ]
    whole = sum(volume(part.Shape()) for part in parts)
    is_valid = all(
        part.IsDone() and BRepCheck_Analyzer(part.Shape()).IsValid() for part in parts
    )
    return is_valid and abs(whole / volume(shape) - 1) < 1e-6


def is_meshed(shape: Any, folder: Path) -> bool:  # noqa: ANN401
    """Whether its triangles close, by trimesh, and hold its volume."""
    import trimesh

    BRepMesh_IncrementalMesh(shape, 0.05, theAngDeflection=0.1)
    StlAPI_Writer().Write(shape, str(folder / "solid.stl"))
    mesh = trimesh.load(folder / "solid.stl")
    return bool(mesh.is_watertight) and abs(mesh.volume / volume(shape) - 1) < 0.01


def gmsh_names(path: Path) -> set[str]:
    """Names that gmsh gives to the solids of a file, which stays open."""
    gmsh.clear()
    gmsh.model.occ.importShapes(str(path))
    gmsh.model.occ.synchronize()
    found = (gmsh.model.getEntityName(*each) for each in gmsh.model.getEntities(3))
    return {name.rsplit("/", 1)[-1].partition(" & ")[0] for name in found}


def tetrahedra(path: Path) -> tuple[int, float]:
    """How many solids of a file gmsh meshes, and how far volumes are off at most."""
    gmsh_names(path)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 24)
    gmsh.model.mesh.generate(3)
    found = gmsh.model.getEntities(3)
    misses: list[float] = []
    for _, tag in found:
        elements = gmsh.model.mesh.getElementsByType(4, tag)[0]
        held = gmsh.model.mesh.getElementQualities(elements, "volume").sum()
        misses.append(abs(held / gmsh.model.occ.getMass(3, tag) - 1))
    return len(misses), max(misses)


def some(parts: Any) -> Any:  # noqa: ANN401
    """Twenty parts, far from one another."""
    ids = np.arange(len(parts.ids))
    return np.isin(ids, np.linspace(0, len(ids) - 1, 20).astype(int))


def asked(command: list[str], script: str, path: Path) -> Any:  # noqa: ANN401
    """What another program finds, by a script."""
    file = path.with_suffix(".py")
    file.write_text(script.format(path=str(path)), encoding="utf-8")
    ended = subprocess.run([*command, str(file)], capture_output=True, text=True, check=False)
    lines = [line for line in ended.stdout.splitlines() if line.startswith("FOUND")]
    return json.loads(lines[0][5:]) if lines else ended.stderr[-300:]


def main() -> None:
    """Print what was found; another Python with build123d may be named."""
    warnings.simplefilter("ignore")
    freecad = shutil.which("freecadcmd")
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    with tempfile.TemporaryDirectory() as name:
        for model, (panels, beams) in models().items():
            path = Path(name) / f"{model}.step"
            nodes.write_step(panels, path, beams=beams)
            found = solids(path)
            print(
                f"{model}: {len(found)} solids; OpenCASCADE: "
                f"{sum(not is_sound(x) for x in found)} faults, "
                f"{sum(is_halved(x) for x in found)} halved, "
                f"{sum(is_meshed(x, Path(name)) for x in found)} meshed"
            )
            few = {
                "panels": None if panels is None else select_parts(panels, some(panels)),
                "beams": None if beams is None else select_parts(beams, some(beams)),
            }
            ids = set(panels.ids if panels is not None else beams.ids)
            named = len(ids & gmsh_names(path))
            nodes.write_step(**few, path=Path(name) / "few.step")
            meshed, worst = tetrahedra(Path(name) / "few.step")
            print(
                f"  gmsh: {meshed} of 20 meshed, volumes within {worst:.1e}; "
                f"{named} of {len(ids)} named"
            )
            if freecad:
                print(f"  FreeCAD: {asked([freecad], FREECAD, path)}")
            if sys.argv[1:]:
                labels = asked(sys.argv[1:2], NAMES, path)
                print(f"  build123d: {len(ids & set(labels))} of {len(ids)} named")


if __name__ == "__main__":
    main()
