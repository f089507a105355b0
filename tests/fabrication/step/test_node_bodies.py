"""Cylinders and lines in STEP files, read back by OpenCASCADE."""

from pathlib import Path

import numpy as np
import pytest
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Shape

from spheremesh.fabrication.breps.nodes import cylinder_batch
from spheremesh.fabrication.step.assembly import (
    Group,
    Instance,
    Part,
    StepHeader,
    assembly_lines,
)
from spheremesh.fabrication.step.bodies import Body, line_body, step_bodies
from spheremesh.fabrication.step.check import check_part21
from spheremesh.kernel.arrays import unit

HEADER = StepHeader("AP214IS", "mm", 1.0, 1e-7, "Nodes", "test")


def read_back(path: Path, bodies: list[Body], kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    place = (Instance("N", (10.0, 20.0, 30.0)),)
    parts = [Part(b, f"N{i}", "Nodes", (9, 9, 9), 1e-7, place) for i, b in enumerate(bodies)]
    path.write_text("".join(assembly_lines(Group("Nodes", parts), HEADER)), encoding="ascii")
    assert check_part21(path) == ()
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found, shapes = TopExp_Explorer(reader.OneShape(), kind, TopAbs_ShapeEnum.TopAbs_FACE), []
    while found.More():
        shapes.append(found.Current())
        found.Next()
    return shapes


def test_cylinders(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    bases, heights = rng.uniform(-50, 50, (9, 3)), rng.uniform(1, 300, 9)
    directions = np.vstack([np.eye(3), -np.eye(3), unit(rng.normal(size=(3, 3)))])
    made = step_bodies([cylinder_batch(bases, directions, heights, 30.0)])
    solids = read_back(tmp_path / "n.step", made, TopAbs_ShapeEnum.TopAbs_SOLID)
    assert len(solids) == 9
    for i, solid in enumerate(solids):
        assert BRepCheck_Analyzer(solid).IsValid()
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, properties)
        assert properties.Mass() == pytest.approx(np.pi * 900 * heights[i], rel=1e-9)
        center = properties.CentreOfMass()
        middle = bases[i] + heights[i] / 2 * directions[i] + [10, 20, 30]
        assert np.abs(np.array([center.X(), center.Y(), center.Z()]) - middle).max() < 1e-8


def test_lines(tmp_path: Path) -> None:
    segments = np.random.default_rng(6).uniform(-50, 50, (7, 2, 3))
    cylinder = step_bodies([cylinder_batch(np.zeros((1, 3)), np.eye(3)[:1], np.ones(1), 1.0)])
    made = [*cylinder, line_body(segments)]
    edges = read_back(tmp_path / "a.step", made, TopAbs_ShapeEnum.TopAbs_EDGE)
    assert len(edges) == 7
    for edge, ends in zip(edges, segments + np.array([10, 20, 30]), strict=True):
        curve = BRepAdaptor_Curve(TopoDS.Edge_s(edge))
        points = [curve.Value(t) for t in (curve.FirstParameter(), curve.LastParameter())]
        found = np.array([[p.X(), p.Y(), p.Z()] for p in points])
        assert np.abs(found - ends).max() < 1e-10
