"""Beams in STEP and Rhino files, read back by OpenCASCADE and rhino3dm."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.drawings.beams import write_dxf
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.opennurbs.brep_audit import verify_breps
from spheremesh.fabrication.opennurbs.brep_reader import read_brep_streams
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.fabrication.solids.cadquery_assembly import to_cadquery
from spheremesh.fabrication.solids.opencascade_beams import beam_shapes
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.writer import write_step
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.beams import cutting as beam_cutting
from spheremesh.kernel.beams.beams import Beams, beam_volumes, node_axis_segments
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.beams.node_cylinders import node_cylinders
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.support.annuli import Annuli
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net, vase_net


def make(
    sphere_mesh: SphereMesh,
    kappa: float | None = None,
    thickness: float = 0.05,
    **ends: float,
) -> Beams:
    """Beams of 0.3 edges depth (or a power in squared edges); thickness in edges."""
    size = mean_edge_length(sphere_mesh.mesh)
    depth = 0.3 * size if kappa is None else None
    power = None if kappa is None else kappa * size**2
    annuli = annulus_support(sphere_mesh, depth, power).annuli
    scaled = {name: value * size for name, value in ends.items()}
    return cut_beams(annuli, thickness * size, **scaled)[0]


TORUS = central_spheres(torus_net(7, 5, 3.0, 1.0))
CASES = {
    "mitred": make(TORUS),
    "with gaps": make(TORUS, node_gap=0.05),
    "square": make(TORUS, node_radius=0.1, node_gap=0.01),
    "constant power": make(TORUS, 0.2),
    "to the outer side": make(TORUS, -0.2),
    "with a boundary": make(central_spheres(vase_net(9, 6, 1.0, 3.0, 0.3))),
    "straight": make(face_planes(roof_net(6, 5, 40.0))),
    "torsion": make(central_spheres(roof_net(6, 5, 40.0))),
    "1 mm": make(central_spheres(torus_net(7, 5, 5e-4, 1.5e-4))),
    "1 km": make(central_spheres(torus_net(7, 5, 500.0, 150.0)), node_gap=0.01),
}


def measure(shapes: list[TopoDS_Shape]) -> FloatArray:
    volumes = np.empty(len(shapes))
    for i, shape in enumerate(shapes):
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(shape, properties, 1e-10)
        volumes[i] = properties.Mass()
    return volumes


def is_valid(shape: TopoDS_Shape) -> bool:
    """Whether OpenCASCADE takes a shape for sound, at its own origin and in its place."""
    return all(
        BRepCheck_Analyzer(s).IsValid() for s in (shape, shape.Located(TopLoc_Location()))
    )


@pytest.mark.parametrize("case", CASES)
def test_law_e6_solids_are_sound_and_have_the_volumes_of_the_beams(case: str) -> None:
    beams = CASES[case]
    assert beams.n_beams > 10
    shapes = beam_shapes(beams, 1000.0)
    assert all(is_valid(shape) for shape in shapes)
    assert {shape.ShapeType() for shape in shapes} == {TopAbs_ShapeEnum.TopAbs_SOLID}
    np.testing.assert_allclose(measure(shapes), 1e9 * beam_volumes(beams), rtol=1e-8)


THICK, THIN = 0.05, 0.002


@pytest.mark.parametrize(("radius", "thickness"), [(1.0, THICK), (30.0, THICK), (30.0, THIN)])
def test_nearly_square_ends_are_sound(
    radius: float, thickness: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ellipses whose centres are far away, down to straight lines; as built and read back."""
    sphere_mesh = central_spheres(torus_net(7, 5, 3 * radius, radius))
    turn = np.logspace(-8, -1, 40).reshape(-1, 1, 1) * [[[1, -1], [-1.3, 1.1]]]

    def nearly_square(annuli: Annuli) -> FloatArray:
        return np.pi / 2 - np.resize(turn, (annuli.n_annuli, 2, 2))

    monkeypatch.setattr(beam_cutting, "mitre_angles", nearly_square)
    beams = make(sphere_mesh, thickness=thickness)
    shapes = beam_shapes(beams, 1000.0)
    assert all(is_valid(shape) for shape in shapes)
    if thickness * radius < 1:  # what is thicker than a metre is beyond the reader's digits
        read = read_solids(write_step(Model(beams=beams), tmp_path / "b.step").path)
        assert all(is_valid(shape) for shape in read)
    np.testing.assert_allclose(measure(shapes), 1e9 * beam_volumes(beams), rtol=1e-8)


def test_beams_that_are_not_finite_are_named() -> None:
    beams = CASES["mitred"]
    corners = beams.corners.copy()
    corners[3] = np.nan
    with pytest.raises(InputError, match=r"beam B0003 \(1 in all\) is not finite"):
        beam_shapes(replace(beams, corners=corners))


def read_solids(path: Path) -> list[TopoDS_Shape]:
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID)
    solids: list[TopoDS_Shape] = []
    while found.More():
        solids.append(found.Current())
        found.Next()
    return solids


@pytest.mark.parametrize("case", ["mitred", "square", "straight", "1 mm", "1 km"])
def test_round_trip(tmp_path: Path, case: str) -> None:
    beams = CASES[case]
    path = write_step(Model(beams=beams), tmp_path / "b.step").path
    solids, nodes = read_solids(path), node_cylinders(beams)
    assert len(solids) == beams.n_beams + nodes.n_nodes
    assert all(BRepCheck_Analyzer(solid).IsValid() for solid in solids)
    cylinders = np.pi * nodes.radius**2 * nodes.heights
    volumes = np.concatenate([beam_volumes(beams), cylinders])
    np.testing.assert_allclose(measure(solids), 1e9 * volumes, rtol=1e-8)
    assert check_part21(path) == ()
    text = path.read_text()
    for name in beams.annuli.ids:
        assert f"PRODUCT('{name}'" in text
    assert "PRESENTATION_LAYER_ASSIGNMENT('Beams'" in text


def test_panels_and_beams_in_one_file(tmp_path: Path) -> None:
    panels, _ = cut_panels(TORUS, "intersection", thickness=0.02)
    beams = CASES["mitred"]
    path = write_step(Model(panels, beams), tmp_path / "m.step").path
    assert len(read_solids(path)) == panels.n_panels + beams.n_beams
    names = set(re.findall(r"PRODUCT\('(\w+)'", path.read_text()))
    assert names == {"Model", "Panels", "Beams", "Axes", *panels.ids, *beams.annuli.ids}


def read_shapes(path: Path, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    """Shapes of a kind that are no part of a face."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found = TopExp_Explorer(reader.OneShape(), kind, TopAbs_ShapeEnum.TopAbs_FACE)
    shapes: list[TopoDS_Shape] = []
    while found.More():
        shapes.append(found.Current())
        found.Next()
    return shapes


@pytest.mark.parametrize("case", ["mitred", "square"])
def test_node_axes_in_step(tmp_path: Path, case: str) -> None:
    beams = CASES[case]
    path = write_step(Model(beams=beams), tmp_path / "a.step").path
    edges = read_shapes(path, TopAbs_ShapeEnum.TopAbs_EDGE)
    _, segments = node_axis_segments(beams)
    assert len(edges) == len(segments)
    for edge, (start, end) in zip(edges, 1000 * segments, strict=True):
        curve = BRepAdaptor_Curve(TopoDS.Edge_s(edge))
        ends = [curve.Value(t) for t in (curve.FirstParameter(), curve.LastParameter())]
        found = np.array([[p.X(), p.Y(), p.Z()] for p in ends])
        assert np.abs(found - [start, end]).max() < 1e-8
    assert "PRESENTATION_LAYER_ASSIGNMENT('Axes'" in path.read_text()


def test_node_cylinders_in_step_stand_on_their_axes(tmp_path: Path) -> None:
    beams = CASES["square"]
    path = write_step(Model(beams=beams), tmp_path / "n.step").path
    nodes = node_cylinders(beams)
    cylinders = read_solids(path)[beams.n_beams :]
    for i, solid in enumerate(cylinders):
        faces = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_FACE)
        surfaces: list[BRepAdaptor_Surface] = []
        while faces.More():
            surfaces.append(BRepAdaptor_Surface(TopoDS.Face_s(faces.Current())))
            faces.Next()
        round_ = next(
            s for s in surfaces if s.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder
        )
        assert round_.Cylinder().Radius() == pytest.approx(1000 * nodes.radius, rel=1e-12)
        axis = round_.Cylinder().Axis()
        along, place = axis.Direction(), axis.Location()
        direction = np.array([along.X(), along.Y(), along.Z()])
        off = np.array([place.X(), place.Y(), place.Z()]) - 1000 * nodes.origins[i]
        assert norm(np.cross(direction, nodes.directions[i])) < 1e-12
        assert norm(np.cross(off, direction)) < 1e-8
    text = path.read_text()
    assert "PRESENTATION_LAYER_ASSIGNMENT('Nodes'" in text
    for name in nodes.ids:
        assert f"PRODUCT('{name}'" in text


def test_panels_without_any_beam(tmp_path: Path) -> None:
    panels, _ = cut_panels(TORUS, "intersection", thickness=0.02)
    none = select_parts(CASES["mitred"], np.zeros(CASES["mitred"].n_beams, bool))
    path = write_step(Model(panels, none), tmp_path / "m.step").path
    assert len(read_solids(path)) == panels.n_panels
    model = rhino3dm.File3dm.Read(str(write_3dm(Model(panels, none), tmp_path / "m.3dm").path))
    assert on_layer(model, "Beams") == on_layer(model, "Axes") == []


def test_beams_without_any_panel(tmp_path: Path) -> None:
    panels, _ = cut_panels(TORUS, "intersection", thickness=0.02)
    none = select_parts(panels, np.zeros(panels.n_panels, bool))
    beams = CASES["mitred"]
    contents = RhinoOptions(layers=("Edges", "Centres", "Moulds"))
    file = write_3dm(Model(none, beams), tmp_path / "m.3dm", contents)
    assert file.counts == {"Brep": beams.n_beams, "LineCurve": 35}
    assert (
        len(read_solids(write_step(Model(none, beams), tmp_path / "m.step").path))
        == beams.n_beams
    )


@pytest.mark.parametrize("ends", [{"node_gap": 0.02}, {"node_radius": 0.1}])
def test_far_from_the_origin_no_digit_is_lost(tmp_path: Path, ends: dict[str, float]) -> None:
    mesh = TORUS.mesh
    moved = Mesh(mesh.vertices + np.array([5e5, -3e5, 2e5]), mesh.faces)
    beams = make(SphereMesh.from_local(moved, TORUS.local_spheres), **ends)
    solids = read_solids(write_step(Model(beams=beams), tmp_path / "far.step").path)
    local = [solid.Located(TopLoc_Location()) for solid in solids]
    assert all(BRepCheck_Analyzer(solid).IsValid() for solid in local)
    nodes = node_cylinders(beams)
    cylinders = np.pi * nodes.radius**2 * nodes.heights
    volumes = np.concatenate([beam_volumes(beams), cylinders])
    np.testing.assert_allclose(measure(local), 1e9 * volumes, rtol=1e-8)


def test_objects_of_cadquery() -> None:
    beams = select_parts(CASES["mitred"], np.arange(CASES["mitred"].n_beams) < 4)
    assembly = to_cadquery(Model(beams=beams)).children[0]
    assert [child.name for child in assembly.children] == list(beams.annuli.ids)
    for child, volume in zip(assembly.children, beam_volumes(beams), strict=True):
        assert abs(child.obj.Volume() / (1e9 * volume) - 1) < 1e-6  # pyright: ignore


def test_nothing_to_write(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no panels or beams"):
        write_step(Model(), tmp_path / "n.step")
    with pytest.raises(InputError, match="no panels or beams"):
        write_3dm(Model(), tmp_path / "n.3dm")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["b.step", "b.3dm", "b.dxf"])
def test_beams_that_no_file_can_hold_are_refused_by_name(tmp_path: Path, name: str) -> None:
    def write(beams: Beams) -> None:
        if name.endswith("dxf"):
            write_dxf(Model(beams=beams), tmp_path / name)
        elif name.endswith("step"):
            write_step(Model(beams=beams), tmp_path / name)
        else:
            write_3dm(Model(beams=beams), tmp_path / name)

    beams = CASES["mitred"]
    with pytest.raises(InputError, match=r"no (panels or )?beams to write to"):
        write(select_parts(beams, np.zeros(beams.n_beams, bool)))
    ids = ("A", "B", "A", *beams.annuli.ids[3:])
    edges = re.escape(str(beams.annuli.edge_ids[[0, 2]].tolist()))
    with pytest.raises(InputError, match=rf"2 beams are called 'A' \(edges {edges}\)"):
        write(replace(beams, annuli=replace(beams.annuli, ids=ids)))
    sections = beams.sections.copy()
    sections[3] = np.inf
    with pytest.raises(InputError, match=r"beam B0003 \(1 in all\) is not finite"):
        write(replace(beams, sections=sections))
    assert not list(tmp_path.iterdir())


# Rhino


def on_layer(model: Any, name: str) -> list[Any]:  # noqa: ANN401
    return [o for o in model.Objects if model.Layers[o.Attributes.LayerIndex].Name == name]


def point(value: Any) -> FloatArray:  # noqa: ANN401
    return np.array([value.X, value.Y, value.Z])


@pytest.mark.parametrize("case", ["mitred", "square", "straight", "1 mm", "1 km"])
def test_solids_in_rhino(tmp_path: Path, case: str) -> None:
    """Those of STEP files: the same corners, the same volume."""
    beams = CASES[case]
    path = write_3dm(Model(beams=beams), tmp_path / "b.3dm").path
    objects = on_layer(rhino3dm.File3dm.Read(str(path)), "Beams")
    assert [item.Attributes.Name for item in objects] == list(beams.annuli.ids)
    size = norm(beams.sections[:, 0, 0] - beams.sections[:, 1, 0]).max()
    for i, item in enumerate(objects):
        solid = item.Geometry
        assert solid.IsValid
        assert solid.IsSolid
        n_steps = np.where(beams.is_flat[i], 1, 2)
        assert len(solid.Faces) == 4 + n_steps.sum()
        found = np.array([point(vertex.Location) for vertex in solid.Vertices])
        wanted = beams.corners[i].reshape(-1, 3) + beams.annuli.origins[i]
        assert norm(found[:, None] - wanted).min(axis=1).max() < 1e-12 * size
        assert len(found) == 4 * (n_steps + 1).sum() / 2
    errors = verify_breps(read_brep_streams(path.read_bytes())[: beams.n_beams])
    volumes = np.array([each.volume for each in errors])
    np.testing.assert_allclose(volumes, beam_volumes(beams), rtol=1e-8)


def test_solids_of_a_building_site(tmp_path: Path) -> None:
    roof = roof_net(6, 5, 40.0)
    far = np.array([6.1e5, -5.3e6, 480.0])
    site = Mesh(roof.vertices + far, [list(face) for face in roof.faces])
    there, here = make(central_spheres(site)), CASES["torsion"]
    files = [
        write_3dm(Model(beams=each), tmp_path / name).path
        for name, each in (("there.3dm", there), ("here.3dm", here))
    ]
    solids, others = (
        [item.Geometry for item in on_layer(rhino3dm.File3dm.Read(str(path)), "Beams")]
        for path in files
    )
    assert len(solids) == len(others) == here.n_beams
    assert all(solid.IsValid and solid.IsSolid for solid in solids)
    for solid, other in zip(solids, others, strict=True):
        moved = point(solid.GetBoundingBox().Center) - far
        assert norm(moved - point(other.GetBoundingBox().Center)) < 1e-6


@pytest.mark.parametrize("version", [6, 7, 8])
def test_every_version_of_rhino(tmp_path: Path, version: int) -> None:
    panels, _ = cut_panels(TORUS, "intersection", labels=np.arange(35) % 3)
    beams = CASES["mitred"]
    layers = ("Edges", "Centres", "Moulds")
    options = RhinoOptions(layers=layers, reference=TORUS.mesh, version=version)
    path = tmp_path / "m.3dm"
    file = write_3dm(Model(panels, beams), path, options)
    model = rhino3dm.File3dm.Read(str(path))
    assert model.ArchiveVersion // 10 == version
    objects: list[Any] = [model.Objects[i] for i in range(len(model.Objects))]
    kinds = Counter(type(item.Geometry).__name__ for item in objects)
    assert kinds == file.counts
    assert kinds["Brep"] == beams.n_beams + panels.n_panels + 3
    assert kinds["InstanceReference"] == panels.n_panels
    assert all(item.Geometry.IsValid for item in objects)
    assert all(item.Geometry.IsSolid for item in on_layer(model, "Beams"))


def _check_view(view: Any, points: FloatArray) -> None:  # noqa: ANN401
    """All points lie in the frustum."""
    frame = view.GetFrustum()
    relative = points - point(view.CameraLocation)
    x, y, z = (relative @ point(axis) for axis in (view.CameraX, view.CameraY, view.CameraZ))
    shrink = -z / frame["near"] if view.IsPerspectiveProjection else 1
    assert np.abs(x / shrink).max() < frame["right"]
    assert np.abs(y / shrink).max() < frame["top"]
    assert frame["near"] < -z.max()
    assert frame["far"] > -z.min()


def test_axes_layers_and_text_in_rhino(tmp_path: Path) -> None:
    beams = CASES["mitred"]
    panels, _ = cut_panels(TORUS, "intersection")
    path = write_3dm(Model(panels, beams), tmp_path / "m.3dm").path
    model = rhino3dm.File3dm.Read(str(path))
    assert {"Panels", "Edges", "Beams", "Axes"} <= {layer.Name for layer in model.Layers}
    axes = on_layer(model, "Axes")
    assert [item.Attributes.Name for item in axes] == [f"N{i:04d}" for i in range(35)]
    for vertex, item in enumerate(axes):
        start = point(item.Geometry.PointAtStart)
        assert norm(start - TORUS.mesh.vertices[vertex]) < 1e-12
        length = norm(point(item.Geometry.PointAtEnd) - start)
        assert abs(length - beams.annuli.depth) < 1e-12
    assert on_layer(model, "Nodes") == on_layer(model, "Drilling") == []
    item = on_layer(model, "Beams")[4]
    text = dict(item.Attributes.GetUserStrings())
    assert text["id"] == beams.annuli.ids[4] == item.Attributes.Name
    assert text["nodes"] == " ".join(map(str, beams.annuli.edge_vertices[4].tolist()))
    assert float(text["thickness"]) == pytest.approx(beams.thickness, rel=1e-11)
    again = rhino3dm.File3dm.Read(
        str(write_3dm(Model(beams=beams), tmp_path / "again.3dm").path)
    )
    ids = {str(item.Attributes.Id) for item in again.Objects}
    assert ids <= {str(item.Attributes.Id) for item in model.Objects}
    # Beams alone are to be seen as well.
    corners = (beams.annuli.corners + beams.annuli.origins[:, None, None]).reshape(-1, 3)
    for view in again.NamedViews:
        _check_view(view.Viewport, corners)
    assert {view.Name for view in again.NamedViews} == {"Top", "Perspective"}


def test_node_cylinders_in_rhino(tmp_path: Path) -> None:
    beams = CASES["square"]
    nodes = node_cylinders(beams)
    model = rhino3dm.File3dm.Read(str(write_3dm(Model(beams=beams), tmp_path / "n.3dm").path))
    objects = on_layer(model, "Nodes")
    assert [item.Attributes.Name for item in objects] == list(nodes.ids)
    assert len({str(item.Attributes.Id) for item in model.Objects}) == len(model.Objects)
    for i, item in enumerate(objects):
        solid = item.Geometry
        assert solid.IsValid
        assert solid.IsSolid
        assert len(solid.Faces) == 3
        ends = np.array([point(vertex.Location) for vertex in solid.Vertices])
        along = (ends - nodes.origins[i]) @ nodes.directions[i]
        np.testing.assert_allclose(along, [0, nodes.heights[i]], atol=1e-12)
        off = ends - nodes.origins[i] - along[:, None] * nodes.directions[i]
        np.testing.assert_allclose(norm(off), nodes.radius, rtol=1e-9)
        assert model.Materials[item.Attributes.MaterialIndex].Name == "Nodes"


def test_drilling_marks_in_rhino(tmp_path: Path) -> None:
    size = mean_edge_length(TORUS.mesh)
    beams, refused = drill_beams(CASES["mitred"], 2, 0.04 * size, 0.35 * size)
    assert 0 < len(refused) < beams.n_beams
    marks = beams.marks
    assert marks is not None
    model = rhino3dm.File3dm.Read(str(write_3dm(Model(beams=beams), tmp_path / "d.3dm").path))
    objects = on_layer(model, "Drilling")
    expected = [name for name, fits in zip(beams.annuli.ids, marks.fits, strict=True) if fits]
    assert [item.Attributes.Name for item in objects] == [n for n in expected for _ in range(4)]
    lifts = beams.annuli.origins + beams.annuli.frames[:, 2] * beams.thickness / 2
    centers = (marks.holes + lifts[:, None])[marks.fits].reshape(-1, 3)
    for item, center in zip(objects, centers, strict=True):
        circle = item.Geometry
        assert circle.IsCompleteCircle
        assert circle.Radius == pytest.approx(0.02 * size, rel=1e-12)
        assert norm(point(circle.Arc.Center) - center) < 1e-12
        assert circle.AngleDegrees == pytest.approx(360)
