"""STEP files: checked by OpenCASCADE in memory, read back by it, and from their own text."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_LayerTool

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.breps.panel_geometry import panels_in_place
from spheremesh.fabrication.breps.panels import panel_batches
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.solids.cadquery_assembly import to_cadquery
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.fabrication.step.assembly import (
    Group,
    Instance,
    Part,
    StepHeader,
    StepSchema,
    assembly_lines,
)
from spheremesh.fabrication.step.bodies import step_bodies
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.writer import StepOptions, write_step
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.errors import InputError, MissingLibraryError
from spheremesh.kernel.panels.cutting import EdgeMode, cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import (
    Panels,
    panel_areas,
)
from spheremesh.kernel.parts.colors import Color, mould_color
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.surfaces.circular_nets import catenoid_net, roof_net, torus_net


def curved(mesh: Mesh, angles: FloatArray | float) -> SphereMesh:
    """Spheres through the circles of the faces; angle 0 is the plane, ±π/2 half a sphere."""
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.broadcast_to(angles, mesh.n_faces)
    return SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))


def cupola() -> Mesh:
    """A regular hexagon with squares at its sides and triangles at its corners."""
    turns = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(turns), np.sin(turns)], 1)
    out = np.stack([np.cos(turns + np.pi / 6), np.sin(turns + np.pi / 6)], 1)
    outer = np.stack([ring + out, np.roll(ring, -1, 0) + out], 1).reshape(-1, 2)
    heights = np.where(np.arange(18) < 6, 0.6, 0.0)
    faces: list[tuple[int, ...]] = [tuple(range(6))]
    for i in range(6):
        j = (i + 1) % 6
        faces += [(i, 6 + 2 * i, 7 + 2 * i, j), (j, 7 + 2 * i, 6 + 2 * j)]
    return Mesh(np.column_stack([np.concatenate([ring, outer]), heights]), faces)


def mixed() -> SphereMesh:
    """Triangles, squares, a hexagon; planes, domes and dishes."""
    angles = np.array([0.2, 0, -0.3, 0.4, 0.1, 0, -0.1, -0.2, 0.3, 0, 0.02, -0.4, 1e-3])
    return curved(cupola(), angles)


def unit_squares() -> Mesh:
    """Four unit squares in a plane."""
    x, y = np.meshgrid(np.arange(3.0), np.arange(3.0))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(9)], 1)
    return Mesh(points, [[i, i + 1, i + 4, i + 3] for i in (0, 1, 3, 4)])


@pytest.fixture(scope="module")
def panels() -> Panels:
    labels = np.arange(13) % 4 - 1
    found, rejected = cut_panels(mixed(), thickness=0.02, joint_gap=0.01, labels=labels)
    assert not rejected
    return found


WITHOUT_CURVES = StepOptions(title="Dach's Höhe", parameter_curves="none")


@pytest.fixture(scope="module")
def path(panels: Panels, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("step") / "Dächer.step"
    assert write_step(Model(panels), target, WITHOUT_CURVES).path == target
    return target


def areas_and_volumes(shapes: list[TopoDS_Shape]) -> tuple[FloatArray, FloatArray]:
    values = np.empty((2, len(shapes)))
    for i, shape in enumerate(shapes):
        area, volume = GProp_GProps(), GProp_GProps()
        BRepGProp.SurfaceProperties_s(shape, area)
        BRepGProp.VolumeProperties_s(shape, volume)
        values[:, i] = area.Mass(), volume.Mass()
    return values[0], values[1]


def is_valid(shape: TopoDS_Shape) -> bool:
    """Whether OpenCASCADE takes a shape for sound, at its own origin and in its place."""
    return all(
        BRepCheck_Analyzer(s).IsValid() for s in (shape, shape.Located(TopLoc_Location()))
    )


# Shapes


def catenoid() -> SphereMesh:
    """Corners at round numbers, give or take rounding errors."""
    mesh = catenoid_net(12, 8, 3.0, 8.0)
    return curved(mesh, np.random.default_rng(3).uniform(-0.02, 0.02, mesh.n_faces))


CASES = {
    "round numbers": (catenoid(), 0.02, 0.0),
    "mixed": (mixed(), 0.02, 0.0),
    "mixed with joints": (mixed(), 0.02, 0.01),
    "dome": (curved(torus_net(8, 6, 10.0, 3.0), 0.3), 0.02, 0.0),
    "dish": (curved(torus_net(8, 6, 10.0, 3.0), -0.3), 0.02, 0.01),
    "planes": (curved(torus_net(8, 6, 10.0, 3.0), 0.0), 0.02, 0.0),
    "1 mm": (curved(torus_net(8, 6, 5e-4, 1.5e-4), 0.1), 5e-6, 1e-6),
    "1 km": (curved(torus_net(8, 6, 500.0, 150.0), -0.1), 0.1, 0.0),
    "1 km, nearly flat": (curved(torus_net(8, 6, 500.0, 150.0), 1e-3), 0.1, 0.0),
    "radius 0.75 edge": (curved(unit_squares(), np.arcsin(np.sqrt(0.5) / 0.75)), 0.02, 0.0),
    "inner radius 0.75 edge": (
        curved(unit_squares(), -np.arcsin(np.sqrt(0.5) / 0.77)), 0.02, 0.01,
    ),
}  # fmt: skip


@pytest.mark.parametrize("mode", ["bisector", "intersection"])
@pytest.mark.parametrize("case", CASES)
def test_law_shapes_are_sound_and_have_the_areas_and_volumes_of_the_panels(
    case: str, mode: EdgeMode
) -> None:
    sphere_mesh, thickness, gap = CASES[case]
    surfaces, _ = cut_panels(sphere_mesh, mode, 0.0, gap)
    solids, rejected = cut_panels(sphere_mesh, mode, thickness, gap)
    assert mode == "intersection" or not rejected
    assert solids.n_panels > 0.3 * sphere_mesh.mesh.n_faces
    faces = panel_shapes(surfaces, 1000.0)
    assert all(is_valid(shape) for shape in faces)
    areas, _ = areas_and_volumes(faces)
    np.testing.assert_allclose(areas, 1e6 * panel_areas(surfaces), rtol=1e-8)
    shapes = panel_shapes(solids, 1000.0)
    assert all(is_valid(shape) for shape in shapes)
    _, volumes = areas_and_volumes(shapes)
    np.testing.assert_allclose(volumes, 1e9 * panel_volumes(solids), rtol=1e-8)


@pytest.mark.parametrize("mode", ["bisector", "intersection"])
def test_law_whatever_is_not_rejected_is_sound(mode: EdgeMode) -> None:
    """Spheres at random, down to half radius: cut_panels says what cannot be made."""
    rng = np.random.default_rng(7)
    for mesh in (torus_net(8, 6, 10.0, 4.0), cupola()):
        for reach in (0.3, 1.0, 1.35):
            angles = rng.uniform(-reach, reach, mesh.n_faces)
            panels, _ = cut_panels(curved(mesh, angles), mode, 0.02, 0.01)
            shapes = panel_shapes(panels, 1000.0)
            assert all(is_valid(shape) for shape in shapes)
            _, volumes = areas_and_volumes(shapes)
            np.testing.assert_allclose(volumes, 1e9 * panel_volumes(panels), rtol=1e-6)


def test_shapes_are_where_the_panels_are(panels: Panels) -> None:
    for i, shape in enumerate(panel_shapes(panels, 1000.0)):
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(shape, properties)
        center = properties.CentreOfMass()
        corners = panels.corners[panels.corner_panels == i] + panels.origins[i]
        miss = np.array([center.X(), center.Y(), center.Z()]) / 1000 - corners.mean(axis=0)
        assert norm(miss) < 0.25 * norm(corners - corners.mean(axis=0)).max()


# Files read back by OpenCASCADE


@dataclass(frozen=True)
class ReadPart:
    """A component of the assembly in a file."""

    name: str
    definition: str
    color: Color
    layer: str
    shape: TopoDS_Shape


def labels_of(sequence: TDF_LabelSequence) -> Iterator[TDF_Label]:
    return (sequence.Value(i) for i in range(1, sequence.Length() + 1))


def name_of(label: TDF_Label) -> str:
    name = TDataStd_Name()
    assert label.FindAttribute(TDataStd_Name.GetID_s(), name)
    return name.Get().ToExtString()


def layers_by_definition(main: TDF_Label) -> dict[str, str]:
    """Name of the layer by the name of the part."""
    tool, layers, result = XCAFDoc_DocumentTool.LayerTool_s(main), TDF_LabelSequence(), {}
    tool.GetLayerLabels(layers)
    for layer in labels_of(layers):
        text, members = TCollection_ExtendedString(), TDF_LabelSequence()
        tool.GetLayer(layer, text)
        XCAFDoc_LayerTool.GetShapesOfLayer_s(layer, members)
        for member in labels_of(members):
            assert name_of(member) not in result
            result[name_of(member)] = text.ToExtString()
    return result


def read_step(path: Path) -> tuple[str, list[ReadPart]]:
    """Name and parts of the one assembly in a file, whose text is sound."""
    assert check_part21(path) == ()
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    reader = STEPCAFControl_Reader()
    for switch in (reader.SetColorMode, reader.SetNameMode, reader.SetLayerMode):
        switch(True)  # noqa: FBT003
    assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    assert reader.Transfer(document)
    main = document.Main()
    tool, colors = (
        XCAFDoc_DocumentTool.ShapeTool_s(main),
        XCAFDoc_DocumentTool.ColorTool_s(main),
    )
    layers = layers_by_definition(main)
    roots, components = TDF_LabelSequence(), TDF_LabelSequence()
    tool.GetFreeShapes(roots)
    assert roots.Length() == 1
    tool.GetComponents_s(roots.Value(1), components)
    parts: list[ReadPart] = []
    for component in labels_of(components):
        definition, color, inner = TDF_Label(), Quantity_Color(), TDF_LabelSequence()
        assert tool.GetReferredShape_s(component, definition)
        # A shape that stands in several places is alone in an assembly for each of them.
        if tool.GetComponents_s(definition, inner):
            assert name_of(definition) == name_of(component)
            assert inner.Length() == 1
            assert tool.GetReferredShape_s(inner.Value(1), definition)
        assert colors.GetColor_s(definition, XCAFDoc_ColorType.XCAFDoc_ColorSurf, color)
        rgb = color.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)
        red, green, blue = (round(255 * value) for value in rgb)
        layer = layers[name_of(definition)]
        shape = tool.GetShape_s(component)
        parts.append(
            ReadPart(name_of(component), name_of(definition), (red, green, blue), layer, shape)
        )
    return name_of(roots.Value(1)), parts


@pytest.mark.parametrize("thickness", [0.0, 0.02])
@pytest.mark.parametrize("schema", ["AP214IS", "AP242DIS"])
@pytest.mark.parametrize("step_units", ["mm", "m"])
def test_round_trip(
    tmp_path: Path, thickness: float, schema: StepSchema, step_units: str
) -> None:
    labels = np.arange(13) % 4 - 1
    panels, _ = cut_panels(mixed(), thickness=thickness, joint_gap=0.01, labels=labels)
    path = write_step(
        Model(panels), tmp_path / "p.stp", StepOptions(units=step_units, schema=schema)
    ).path
    name, parts = read_step(path)
    assert name == "Panels"
    assert [part.name for part in parts] == [part.definition for part in parts]
    assert tuple(part.name for part in parts) == panels.ids
    assert [part.color for part in parts] == [mould_color(label, 3) for label in labels]
    assert [part.layer for part in parts] == [
        "Panels" if label < 0 else f"Mould {label + 1:02d}" for label in labels
    ]
    shapes = [part.shape for part in parts]
    assert all(is_valid(shape) for shape in shapes)
    areas, volumes = areas_and_volumes(shapes)
    if thickness:
        assert {s.ShapeType() for s in shapes} == {TopAbs_ShapeEnum.TopAbs_SOLID}
        np.testing.assert_allclose(volumes, 1e9 * panel_volumes(panels), rtol=1e-8)
    else:
        np.testing.assert_allclose(areas, 1e6 * panel_areas(panels), rtol=1e-8)


ROUND_TRIPS = {
    "round numbers": 1e-8,
    "1 mm": 1e-8,
    "1 km": 1e-8,
    "1 km, nearly flat": 1e-8,
    "radius 0.75 edge": 1e-6,
}


@pytest.mark.parametrize("case", ROUND_TRIPS)
def test_round_trip_of_any_size(tmp_path: Path, case: str) -> None:
    """What limits large caps is the reader, which approximates curves in parameters anew."""
    sphere_mesh, thickness, gap = CASES[case]
    panels, _ = cut_panels(sphere_mesh, thickness=thickness, joint_gap=gap)
    for step_units in ("mm", "m"):
        _, parts = read_step(
            write_step(Model(panels), tmp_path / "p.step", StepOptions(units=step_units)).path
        )
        shapes = [part.shape.Located(TopLoc_Location()) for part in parts]
        assert all(BRepCheck_Analyzer(shape).IsValid() for shape in shapes)
        _, volumes = areas_and_volumes(shapes)
        expected = 1e9 * panel_volumes(panels)
        np.testing.assert_allclose(volumes, expected, rtol=ROUND_TRIPS[case])


def test_far_from_the_origin_no_digit_is_lost(tmp_path: Path) -> None:
    """A northing of 6000 km: neighbours still meet as well as the model's own numbers."""
    near = roof_net(8, 5, 10.0)
    site = np.array([4.5e5, 6e6, 300.0])
    far = Mesh(near.vertices + site, near.faces)
    panels, _ = cut_panels(curved(far, 0.1), thickness=0.02)
    _, parts = read_step(write_step(Model(panels), tmp_path / "far.step").path)
    shapes = [part.shape.Located(TopLoc_Location()) for part in parts]
    assert all(BRepCheck_Analyzer(shape).IsValid() for shape in shapes)
    _, volumes = areas_and_volumes(shapes)
    np.testing.assert_allclose(volumes, 1e9 * panel_volumes(panels), rtol=1e-8)
    for part, center in zip(parts, 1000 * panels.origins, strict=True):
        place = part.shape.Location().Transformation().TranslationPart()
        assert np.abs(np.array([place.X(), place.Y(), place.Z()]) - center).max() <= 0.51


def test_names_of_any_script(tmp_path: Path) -> None:
    panels, _ = cut_panels(mixed())
    names = ("Täfelchen Ⅷ", "面板-7", "l'été; #12=('", "a\\b", "𝔘🏠屋ä", "x" * 300)
    panels = replace(panels, ids=(*names, *panels.ids[len(names) :]))
    path = write_step(
        Model(panels), tmp_path / "屋根.step", StepOptions(title="屋根 a\\b")
    ).path
    _, parts = read_step(path)
    assert tuple(part.name for part in parts) == panels.ids


def test_identical_panels_share_a_shape(tmp_path: Path) -> None:
    """Far from the origin as well: instances stand where the panels are."""
    near = torus_net(10, 6, 10.0, 3.0)
    mesh = Mesh(near.vertices + np.array([4.5e4, 6e4, 300.0]), near.faces)
    labels = np.arange(mesh.n_faces) % 2
    panels, _ = cut_panels(curved(mesh, 0.1), thickness=0.05, labels=labels)
    separate, shared = (
        write_step(Model(panels), tmp_path / f"{copies}.step", StepOptions(copies=copies)).path
        for copies in ("shapes", "instances")
    )
    assert shared.stat().st_size < 0.3 * separate.stat().st_size
    (_, expected), (name, parts) = read_step(separate), read_step(shared)
    assert name == "Panels"
    assert len({part.definition for part in parts}) == 6
    by_name = {part.name: part for part in parts}
    assert by_name.keys() == set(panels.ids)
    for part in expected:
        found = by_name[part.name]
        assert (found.layer, found.color) == (part.layer, part.color)
        assert is_valid(found.shape)
        there, here = mass_centers([part.shape, found.shape])
        assert norm(there - here) < 1e-4  # mm
    _, volumes = areas_and_volumes([by_name[name].shape for name in panels.ids])
    np.testing.assert_allclose(volumes, 1e9 * panel_volumes(panels), rtol=1e-8)


def mass_centers(shapes: list[TopoDS_Shape]) -> FloatArray:
    points: list[tuple[float, float, float]] = []
    for shape in shapes:
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(shape, properties)
        center = properties.CentreOfMass()
        points.append((center.X(), center.Y(), center.Z()))
    return np.array(points)


def test_groups_are_assemblies_within_the_assembly(panels: Panels, tmp_path: Path) -> None:
    placed = panels_in_place(panels, 1000.0)
    parts = [
        Part(body, name, "Layer", (200, 100, 0), 1e-6, (Instance(name, tuple(place)),))
        for body, name, place in zip(
            step_bodies(panel_batches(placed)), placed.ids, placed.origins.tolist(), strict=True
        )
    ]
    first, second = Group("Panels", parts), Group("Beams", parts)
    header = StepHeader("AP242DIS", "mm", 1.0, 1e-7, "Roof", "test")
    path = tmp_path / "roof.step"
    text = "".join(assembly_lines(Group("Roof", [first, second]), header))
    path.write_text(text, encoding="ascii")
    assert check_part21(path) == ()
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)  # noqa: FBT003
    assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    assert reader.Transfer(document)
    tool, roots = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()), TDF_LabelSequence()
    tool.GetFreeShapes(roots)
    assert [name_of(root) for root in labels_of(roots)] == ["Roof"]
    groups = TDF_LabelSequence()
    tool.GetComponents_s(roots.Value(1), groups)
    assert [name_of(group) for group in labels_of(groups)] == ["Panels", "Beams"]
    for group in labels_of(groups):
        definition, members = TDF_Label(), TDF_LabelSequence()
        tool.GetReferredShape_s(group, definition)
        tool.GetComponents_s(definition, members)
        assert {name_of(member) for member in labels_of(members)} == set(panels.ids)


def test_units_of_the_model(tmp_path: Path) -> None:
    panels, _ = cut_panels(mixed(), thickness=0.02)
    for units, millimeters in (("mm", 1.0), ("in", 25.4), ("ft", 304.8)):
        _, parts = read_step(
            write_step(
                Model(panels, units=units), tmp_path / "p.step", StepOptions(units=units)
            ).path
        )
        _, volumes = areas_and_volumes([part.shape for part in parts])
        expected = millimeters**3 * panel_volumes(panels)
        np.testing.assert_allclose(volumes, expected, rtol=1e-7)


# The text of the files


GEOMETRY = {"SPHERICAL_SURFACE", "PLANE", "CIRCLE", "LINE"}
OTHER = {"CARTESIAN_POINT", "DIRECTION", "VECTOR", "AXIS2_PLACEMENT_3D", "VERTEX_POINT"}


@dataclass(frozen=True)
class Part21:
    """Entities of a STEP file by number: their types and parameters."""

    types: dict[int, str]
    parameters: dict[int, str]

    def ids(self, kind: str) -> list[int]:
        """Entities of a type."""
        return [i for i, found in self.types.items() if found == kind]

    def references(self, entity: int) -> list[int]:
        """Entities that an entity refers to."""
        return [int(found) for found in re.findall(r"#(\d+)", self.parameters[entity])]

    def numbers(self, entity: int) -> FloatArray:
        """Real numbers among the parameters."""
        found = re.findall(r"[-+]?\d+\.\d*(?:E[-+]?\d+)?", self.parameters[entity])
        return np.array(found, float)

    def sense(self, entity: int) -> bool:
        """Orientation, the last parameter."""
        return self.parameters[entity].endswith(".T.)")

    def placement(self, entity: int) -> FloatArray:
        """Origin, axis and x direction (3, 3) of a surface or circle."""
        return np.array([self.numbers(i) for i in self.references(self.references(entity)[0])])

    def point(self, vertex: int) -> FloatArray:
        """Coordinates of a vertex."""
        return self.numbers(self.references(vertex)[0])


def parse(path: Path) -> Part21:
    """Syntax of ISO 10303-21, as far as these files use it."""
    text = path.read_bytes().decode("ascii")
    assert text.startswith("ISO-10303-21;\nHEADER;")
    assert text.rstrip().endswith("ENDSEC;\nEND-ISO-10303-21;")
    data = text.partition("DATA;")[2].rpartition("ENDSEC;")[0].replace("\n", "")
    found = [re.match(r"\s*#(\d+)=\s*([A-Z0-9_]*)\s*(\(.*)", x) for x in data.split(";")[:-1]]
    assert all(found)
    matches = [match for match in found if match]
    assert len({match[1] for match in matches}) == len(matches)
    return Part21(
        {int(match[1]): match[2] for match in matches},
        {int(match[1]): match[3] for match in matches},
    )


def test_the_only_geometry_is_spheres_planes_circles_and_lines(path: Path) -> None:
    file = parse(path)
    kinds = set(file.types.values())
    assert kinds >= GEOMETRY
    pattern = r".*(SURFACE|CURVE|CIRCLE|ELLIPSE|LINE|PLANE|SPLINE|POINT|BEZIER|CONIC)$"
    topology = {"EDGE_CURVE"}
    assert {k for k in kinds if re.match(pattern, k)} <= GEOMETRY | OTHER | topology
    assert not [k for k in kinds if "SPLINE" in k or "PCURVE" in k]
    assert len(file.ids("SPHERICAL_SURFACE")) == 2 * 10
    assert len(file.ids("PLANE")) == 6 + 6 * 4 + 6 * 3 + 2 * 3
    assert len(file.ids("MANIFOLD_SOLID_BREP")) == 13


def test_law_loops_close_and_every_edge_is_used_once_each_way(path: Path) -> None:
    file = parse(path)
    used = {i for entity in file.types for i in file.references(entity)}
    assert used <= set(file.types)
    for shell in file.ids("CLOSED_SHELL"):
        uses: list[tuple[int, bool]] = []
        for face in file.references(shell):
            bound, _ = file.references(face)
            ring: list[tuple[int, int]] = []
            for oriented in file.references(file.references(bound)[0]):
                (edge,) = file.references(oriented)
                start, end, _ = file.references(edge)
                forward = file.sense(oriented)
                ring.append((start, end) if forward else (end, start))
                uses.append((edge, forward == file.sense(bound)))
            ends = [end for _, end in ring]
            assert [start for start, _ in ring] == ends[-1:] + ends[:-1]
        assert len(uses) == len(set(uses)) == 2 * len({edge for edge, _ in uses})


def test_law_corners_lie_on_their_edges_and_faces(path: Path) -> None:
    """In millimetres, as any program computes it from the text alone."""
    file = parse(path)
    misses: list[float] = []
    corners: dict[int, set[int]] = {}
    for edge in file.ids("EDGE_CURVE"):
        start, end, curve = file.references(edge)
        corners[edge] = {start, end}
        for vertex in (start, end):
            point = file.point(vertex)
            if file.types[curve] == "CIRCLE":
                center, axis, _ = file.placement(curve)
                radius = file.numbers(curve)[-1]
                misses += [norm(point - center) - radius, float((point - center) @ axis)]
            else:
                origin, vector = file.references(curve)
                direction = file.numbers(file.references(vector)[0])
                misses.append(norm(np.cross(point - file.numbers(origin), direction)))
    for face in file.ids("ADVANCED_FACE"):
        bound, surface = file.references(face)
        center, axis, _ = file.placement(surface)
        oriented = file.references(file.references(bound)[0])
        for vertex in set.union(*(corners[file.references(i)[0]] for i in oriented)):
            relative = file.point(vertex) - center
            if file.types[surface] == "PLANE":
                misses.append(float(relative @ axis))
            else:
                misses.append(norm(relative) - file.numbers(surface)[-1])
    assert np.abs(misses).max() < 1e-8


def test_header(panels: Panels, path: Path, tmp_path: Path) -> None:
    text = path.read_text("ascii")
    header = text.partition("ENDSEC;")[0].replace("\n", "")
    assert r"'Dach''s H\X2\00F6\X0\he'" in header
    assert "spheremesh" in header
    assert "AUTOMOTIVE_DESIGN" in header
    assert ".MILLI.,.METRE." in text
    other = write_step(
        Model(panels), tmp_path / "a.step", StepOptions(units="m", schema="AP242DIS")
    ).path
    text = other.read_text("ascii")
    assert "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING" in text
    assert ".MILLI." not in text
    assert "SI_UNIT($,.METRE.)" in text


# Behaviour


def test_writing_again_gives_the_same_text(panels: Panels, path: Path, tmp_path: Path) -> None:
    write_step(
        Model(panels), tmp_path / "other.step", StepOptions(units="m", schema="AP242DIS")
    )
    again = write_step(Model(panels), tmp_path / "again.step", WITHOUT_CURVES).path
    texts = [
        re.sub(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'", "", file.read_text("ascii"))
        for file in (path, again)
    ]
    assert texts[0] == texts[1]


def test_an_interrupted_write_leaves_the_old_file(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "panels.step"
    target.write_text("old")

    def interrupt(*_: object, **__: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_step(Model(panels), target)
    assert [p.name for p in tmp_path.iterdir()] == ["panels.step"]
    assert target.read_text() == "old"


def test_what_cannot_be_written(panels: Panels, tmp_path: Path) -> None:
    target = tmp_path / "p.step"
    nothing = select_parts(panels, np.zeros(panels.n_panels, bool))
    with pytest.raises(InputError, match="no panels"):
        write_step(Model(nothing), target)
    corners = panels.corners.copy()
    corners[20] = np.nan
    with pytest.raises(InputError, match=r"panel P0005 \(1 in all\) is not finite"):
        write_step(Model(replace(panels, corners=corners)), target)
    with pytest.raises(InputError, match="unknown units 'furlong'"):
        write_step(Model(panels, units="furlong"), target)
    with pytest.raises(InputError, match="unknown units 'mile'"):
        write_step(Model(panels), target, StepOptions(units="mile"))
    for option, value, allowed in (
        ("schema", "AP203", "AP214IS or AP242DIS"), ("copies", "twins", "shapes or instances"),
        ("parameter_curves", "some", "needed, all or none"),
        ("engine", "x", "text or cadquery"),
    ):  # fmt: skip
        message = f"{option} of .* must be {allowed}, not '{value}'"
        with pytest.raises(InputError, match=message):
            write_step(Model(panels), target, replace(StepOptions(), **{option: value}))
    with pytest.raises(InputError, match="instances need the engine text"):
        write_step(Model(panels), target, StepOptions(copies="instances", engine="cadquery"))
    twice = replace(panels, ids=("A", "B", "A", *panels.ids[3:]))
    with pytest.raises(InputError, match=r"2 panels are called 'A' \(faces \[0, 2\]\)"):
        write_step(Model(twice), target)
    with pytest.raises(InputError, match="no folder"):
        write_step(Model(panels), tmp_path / "none" / "p.step")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("cause", "remedy"),
    [
        ("libGL.so.1: cannot open shared object file: No such file or directory", "libgl1"),
        ("No module named 'OCP'", "package cadquery"),
    ],
)
def test_a_missing_library_is_named(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cause: str, remedy: str
) -> None:
    (tmp_path / "cadquery.py").write_text(f"raise ImportError({cause!r})")
    monkeypatch.delitem(sys.modules, "cadquery", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(MissingLibraryError, match=remedy) as error:
        to_cadquery(Model(panels))
    assert "\n" not in str(error.value)


def test_files_need_no_opencascade(tmp_path: Path) -> None:
    code = (
        "import sys; from spheremesh import nodes; "
        "made = nodes.panels(nodes.face_planes(nodes.torus_mesh(6, 5))).panels; "
        f"nodes.write_step(made, {str(tmp_path / 't.step')!r}); "
        "sys.exit('OCP' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_objects_of_cadquery(panels: Panels) -> None:
    assembly = to_cadquery(Model(panels))
    assert assembly.name == "Panels"
    assert tuple(child.name for child in assembly.children) == panels.ids
    volumes = [child.obj.Volume() for child in assembly.children]
    np.testing.assert_allclose(volumes, 1e9 * panel_volumes(panels), rtol=1e-8)
    assert {type(child.obj).__name__ for child in assembly.children} == {"Solid"}
    label = int(panels.labels[2])
    red, green, blue, alpha = assembly.children[2].color.toTuple()
    expected = tuple(value / 255 for value in mould_color(label, 3))
    np.testing.assert_allclose((red, green, blue, alpha), (*expected, 1.0), atol=1e-6)
    surfaces, _ = cut_panels(mixed())
    faces = [child.obj for child in to_cadquery(Model(surfaces)).children]
    assert {type(face).__name__ for face in faces} == {"Face"}
    areas = [face.Area() for face in faces]
    np.testing.assert_allclose(areas, 1e6 * panel_areas(surfaces), rtol=1e-8)
