"""STEP files as CAD programs take them: sound for Boolean operations, and named."""

import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from OCP.Bnd import Bnd_Box
from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.solids.cadquery_assembly import to_cadquery
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.parameter_curves import ParameterCurves
from spheremesh.fabrication.step.writer import StepEngine, StepOptions, write_step
from spheremesh.kernel.beams.beams import Beams, beam_volumes
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net
from spheremesh.nodes import ellipsoid_mesh, fit_spheres, vase_mesh

MODES = (
    "ArgumentType", "SelfInter", "SmallEdge", "RebuildFace", "Continuity", "CurveOnSurface",
    "Tangent", "MergeVertex", "MergeEdge",
)  # fmt: skip
"""All that FreeCAD asks for in "Check geometry" with Boolean operations."""


@cache
def cut(sphere_mesh: SphereMesh, thickness: float = 0.02) -> Panels:
    panels, rejected = cut_panels(sphere_mesh, thickness=thickness)
    assert not rejected
    return panels


PanelsOrBeams = TypeVar("PanelsOrBeams", Panels, Beams)


def some(parts: PanelsOrBeams, number: int) -> PanelsOrBeams:
    """A few of all, far from one another."""
    ids = np.arange(len(parts.ids))
    return select_parts(parts, ids % (len(ids) // number) == 0)


def solids(path: Path) -> list[TopoDS_Shape]:
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    explorer = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID)
    found: list[TopoDS_Shape] = []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def faults(shape: TopoDS_Shape) -> list[str]:
    analyzer = BOPAlgo_ArgumentAnalyzer()
    analyzer.SetShape1(shape)
    for mode in MODES:
        setattr(analyzer, f"{mode}Mode", True)
    analyzer.Perform()
    return [str(result.GetCheckStatus()) for result in analyzer.GetCheckResult()]


def volume(shape: TopoDS_Shape) -> float:
    facts = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, facts)
    return facts.Mass()


TORUS = central_spheres(torus_net(6, 4, 3.0, 1.0))

SHARP = {
    "vase": lambda: fit_spheres(vase_mesh(8, 3)),
    "ellipsoid": lambda: fit_spheres(ellipsoid_mesh(8, 3)),
    "torus": lambda: TORUS,
}


@pytest.mark.parametrize("name", SHARP)
def test_law_sharply_curved_panels_are_sound_for_boolean_operations(
    tmp_path: Path, name: str
) -> None:
    panels = some(cut(SHARP[name]()), 4)
    path = write_step(Model(panels), tmp_path / "p.step").path
    assert check_part21(path) == ()
    assert "PCURVE" in path.read_text("ascii")
    found = solids(path)
    assert [fault for shape in found for fault in faults(shape)] == []
    # A box takes one side of a panel.
    for shape in found[:1]:
        sides = Bnd_Box()
        BRepBndLib.Add_s(shape, sides)
        low, high = sides.CornerMin(), sides.CornerMax()
        start = gp_Pnt((low.X() + high.X()) / 2, low.Y() - 1, low.Z() - 1)
        box = BRepPrimAPI_MakeBox(start, gp_Pnt(high.X() + 1, high.Y() + 1, high.Z() + 1))
        operation = BRepAlgoAPI_Cut(shape, box.Shape())
        assert operation.IsDone()
        assert 0.1 < volume(operation.Shape()) / volume(shape) < 0.9


def test_without_parameter_curves_sharply_curved_panels_are_not_sound(tmp_path: Path) -> None:
    """The day this fails OpenCASCADE has become better, and files may become smaller."""
    panels = cut(TORUS)
    options = StepOptions(parameter_curves="none")
    found = solids(write_step(Model(panels), tmp_path / "p.step", options).path)
    assert any(faults(shape) for shape in found)


def count(path: Path, entity: str) -> int:
    return len(re.findall(rf"={entity}\(", path.read_text("ascii")))


def test_parameter_curves_are_written_where_needed(tmp_path: Path) -> None:
    """In the unit in which a program reads a file, whatever that of the file."""
    net = torus_net(8, 5, 3.0, 1.0)
    sharp, gentle = (
        cut(central_spheres(Mesh(net.vertices * size, net.faces)), 0.02 * size)
        for size in (1.0, 1e-6)
    )
    curves: tuple[ParameterCurves, ...] = ("none", "needed", "all")

    def counts(panels: Panels, unit: str) -> list[int]:
        return [
            count(
                write_step(
                    Model(panels), tmp_path / "p.step", StepOptions(unit, parameter_curves=each)
                ).path,
                "PCURVE",
            )
            for each in curves
        ]

    everywhere = 2 * len(sharp.corners)
    for unit in ("mm", "m"):
        assert counts(sharp, unit) == [0, everywhere, everywhere]
    assert counts(gentle, "mm") == [0, 0, everywhere]


@pytest.mark.parametrize("curves", ["needed", "all"])
def test_law_parameter_curves_change_no_volume(tmp_path: Path, curves: ParameterCurves) -> None:
    panels = some(cut(TORUS), 4)
    options = StepOptions(parameter_curves=curves)
    found = solids(write_step(Model(panels), tmp_path / "p.step", options).path)
    volumes = [volume(shape) for shape in found]
    np.testing.assert_allclose(volumes, 1e9 * panel_volumes(panels), rtol=1e-8)


def test_geometry_is_written_once(tmp_path: Path) -> None:
    """A quadrilateral panel: a placement for both spheres and one for each wall."""
    panels = cut(TORUS)
    options = StepOptions(parameter_curves="none")
    path = write_step(Model(panels), tmp_path / "p.step", options).path
    in_place = 1 + panels.n_panels
    assert count(path, "AXIS2_PLACEMENT_3D") == in_place + panels.n_panels * (1 + 4)
    # The posts have 4 directions (some are parallel), the walls 4 normals, the spheres 2 axes.
    assert count(path, "DIRECTION") <= 2 + panels.n_panels * (4 + 4 + 2)


def support() -> Beams:
    annuli = annulus_support(TORUS, 0.2).annuli
    beams, _ = cut_beams(annuli, 0.02, node_gap=0.01, node_radius=0.05)
    return some(beams, 6)


LABELS = """
import sys
import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.importShapes(sys.argv[1])
gmsh.model.occ.synchronize()
print(*(gmsh.model.getEntityName(*each) for each in gmsh.model.getEntities(3)), sep="\\n")
"""


def labels(path: Path) -> set[str]:
    """Names of solids in gmsh, in a process of its own: it changes how signals are handled."""
    pytest.importorskip("gmsh", reason="gmsh")
    command = [sys.executable, "-c", LABELS, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    # Behind a name are the layers.
    return {name.rsplit("/", 1)[-1].partition(" & ")[0] for name in done.stdout.splitlines()}


def test_gmsh_names_every_part(tmp_path: Path) -> None:
    panels, beams = some(cut(TORUS), 4), support()
    path = write_step(Model(panels, beams), tmp_path / "m.step").path
    assert labels(path) >= {*panels.ids, *beams.annuli.ids}
    # Instances stand under their own names.
    options = StepOptions(copies="instances")
    path = write_step(Model(panels), tmp_path / "i.step", options).path
    text = path.read_text("ascii")
    assert all(len(re.findall(rf"=PRODUCT\('{name}'", text)) == 1 for name in panels.ids)


@pytest.mark.parametrize("engine", ["text", "cadquery"])
def test_law_both_engines_write_the_same_model(tmp_path: Path, engine: StepEngine) -> None:
    panels, beams = some(cut(TORUS), 4), support()
    model = Model(panels, beams)
    path = write_step(model, tmp_path / "m.step", StepOptions(engine=engine)).path
    text = path.read_text("utf-8").replace("\n", "")
    names = re.findall(r"PRODUCT\('([^']*)'", text)
    nodes = [name for name in names if name.startswith("N")]
    assert len(nodes) - 1 == len({int(v) for v in beams.annuli.edge_vertices.ravel()})
    groups = {"Model", "Panels", "Beams", "Nodes", "Axes"}
    assert set(names) == groups | {*panels.ids, *beams.annuli.ids, *nodes}
    layers = re.findall(r"PRESENTATION_LAYER_ASSIGNMENT\('([^']*)'", text)
    assert set(layers) == {"Panels", "Beams", "Nodes", "Axes"}
    volumes = np.sort([volume(shape) for shape in solids(path)])
    expected = np.concatenate([panel_volumes(panels), beam_volumes(beams)]) * 1e9
    found = volumes[np.searchsorted(volumes, expected * (1 - 1e-7))]
    np.testing.assert_allclose(found, expected, rtol=1e-7)


def test_an_assembly_to_model_on() -> None:
    panels, beams = some(cut(TORUS), 4), support()
    assembly = to_cadquery(Model(panels, beams))
    assert [child.name for child in assembly.children] == ["Panels", "Beams", "Nodes", "Axes"]
    made = {child.name: child for child in assembly.children}
    assert {c.metadata["layer"] for c in made["Nodes"].children} == {"Nodes"}
    node = made["Nodes"].children[0].obj
    assert node.isValid()  # pyright: ignore
    assert len(made["Axes"].obj.Edges()) == len(made["Nodes"].children)  # pyright: ignore
    drilled = made["Panels"].children[0].obj.cut(made["Panels"].children[1].obj)  # pyright: ignore
    assert drilled.isValid()
