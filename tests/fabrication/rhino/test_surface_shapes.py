"""Surfaces of Rhino files with exact normals and curvatures, whatever their scale and place."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import rhino3dm
from hypothesis import given, settings
from hypothesis import strategies as st

import spheremesh as sm
from spheremesh import nodes
from spheremesh.fabrication.mesh_files.surface_files import read_surface
from spheremesh.fabrication.rhino.surface_shapes import read_surfaces_3dm
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.curvature import vertex_normals
from spheremesh.kernel.surfaces.row_counts import GridSize
from spheremesh.kernel.surfaces.surface import Surface

Point, Vector = rhino3dm.Point3d, rhino3dm.Vector3d
AXIS = rhino3dm.Line(Point(0, 0, 0), Point(0, 0, 1))


def content(*objects: Any) -> bytes:  # noqa: ANN401
    model = rhino3dm.File3dm()
    for each in objects:
        model.Objects.Add(each, None)
    return as_bytes(model)


def as_bytes(model: rhino3dm.File3dm) -> bytes:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.3dm"
        assert model.Write(str(path), 8)
        return path.read_bytes()


def read(geometry: Any, edge_length: float | None = None) -> Surface:  # noqa: ANN401
    return read_surfaces_3dm(content(geometry), "", GridSize(9, 7, edge_length)).surface


def ball() -> Any:  # noqa: ANN401
    return rhino3dm.Sphere(Point(0, 0, 0), 2.5).ToNurbsSurface()


def tube() -> Any:  # noqa: ANN401
    profile = rhino3dm.Circle(Point(0, 0, 0), 1.0).ToNurbsCurve()
    profile.Rotate(np.pi / 2, Vector(1, 0, 0), Point(0, 0, 0))
    profile.Translate(Vector(3, 0, 0))
    return rhino3dm.RevSurface.Create(profile, AXIS, 0, 2 * np.pi)


def barrel() -> Any:  # noqa: ANN401
    return rhino3dm.RevSurface.Create(
        rhino3dm.LineCurve(Point(2, 0, 0), Point(2, 0, 3)), AXIS, 0, 2 * np.pi
    )


def sheet() -> Any:  # noqa: ANN401
    return rhino3dm.NurbsSurface.CreateRuledSurface(
        rhino3dm.LineCurve(Point(0, 0, 0), Point(4, 0, 0)),
        rhino3dm.LineCurve(Point(0, 3, 0), Point(5, 3, 0)),
    )


Shape = tuple[FloatArray, FloatArray]


def of_ball(x: FloatArray) -> Shape:
    """Outward normals and curvatures towards them, the larger first."""
    return x / 2.5, np.full((len(x), 2), -1 / 2.5)


def of_tube(x: FloatArray) -> Shape:
    rho = np.hypot(x[:, 0], x[:, 1])[:, None]
    normals = np.concatenate([x[:, :2] / rho * (rho - 3), x[:, 2:]], 1)
    around = -(rho - 3) / rho
    return normals, np.concatenate([around, np.full_like(around, -1)], 1)


def of_barrel(x: FloatArray) -> Shape:
    return x * (0.5, 0.5, 0), np.tile([0.0, -0.5], (len(x), 1))


def of_sheet(x: FloatArray) -> Shape:
    return np.tile([0.0, 0, 1], (len(x), 1)), np.zeros((len(x), 2))


SHAPES: dict[str, tuple[Callable[[], Any], Callable[[FloatArray], Shape]]] = {
    "sphere": (ball, of_ball),
    "torus": (tube, of_tube),
    "cylinder": (barrel, of_barrel),
    "plane": (sheet, of_sheet),
}


@pytest.mark.parametrize("as_brep", [False, True])
@pytest.mark.parametrize("name", SHAPES)
@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 1e3), st.sampled_from([None, 0.4]))
@settings(max_examples=12, deadline=None)
def test_shapes_are_exact(
    name: str, as_brep: bool, seed: int, scale: float, edge_length: float | None  # noqa: FBT001
) -> None:  # fmt: skip
    """Poles and seams included; scaled, turned and moved."""
    make, truth = SHAPES[name]
    rng = np.random.default_rng(seed)
    geometry = make()
    if as_brep:
        geometry = rhino3dm.Brep.CreateFromSurface(geometry.ToNurbsSurface())
    flip = bool(as_brep and rng.random() < 0.5)
    if flip:
        geometry.Flip()
    angle, axis, shift = rng.uniform(0, 6), rng.normal(size=3), rng.uniform(-9, 9, 3) * scale
    geometry.Scale(scale)
    geometry.Rotate(angle, Vector(*axis), Point(0, 0, 0))
    geometry.Translate(Vector(*shift))
    found = read(geometry, edge_length and edge_length * scale)
    turn = rotation(angle, axis)
    x = (found.mesh.vertices - shift) @ turn / scale
    normals, curvatures = truth(x)
    sides = dot(found.normals @ turn, normals)
    assert np.ptp(np.sign(sides)) == 0
    side = np.sign(sides[0])
    assert norm(found.normals @ turn - side * normals).max() < 1e-9
    expected = np.sort(side * curvatures, axis=1)[:, ::-1]
    assert np.abs(found.curvatures * scale - expected).max() < 1e-9
    assert found.is_smooth.all()
    first, second = found.directions[:, 0], found.directions[:, 1]
    assert np.abs(np.cross(first, second) - found.normals).max() < 1e-9
    assert dot(vertex_sides(found), found.normals).min() > 0


def rotation(angle: float, axis: FloatArray) -> FloatArray:
    x, y, z = axis / norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def vertex_sides(surface: Surface) -> FloatArray:
    """Normals of the mesh at its vertices."""
    return vertex_normals(surface.mesh)


def test_directions_bend_as_the_curvatures_say() -> None:
    found = read(tube(), 0.3)
    x = found.mesh.vertices
    rho = np.hypot(x[:, 0], x[:, 1])
    around = np.stack([-x[:, 1] / rho, x[:, 0] / rho, 0 * rho], 1)
    is_around = np.abs(np.abs(found.curvatures) - (np.abs(rho - 3) / rho)[:, None]).argmin(1)
    along = found.directions[np.arange(len(x)), is_around]
    assert np.abs(np.abs(dot(along, around)) - 1).max() < 1e-9


def test_a_flipped_face_turns_normals_and_signs() -> None:
    brep = rhino3dm.Brep.CreateFromSurface(tube().ToNurbsSurface())
    before = read(brep)
    brep.Flip()
    after = read(brep)
    assert np.allclose(before.mesh.vertices, after.mesh.vertices)
    assert np.allclose(before.normals, -after.normals)
    assert np.allclose(before.curvatures, -after.curvatures[:, ::-1])


def test_creases_and_apexes_are_marked() -> None:
    can = read(rhino3dm.Cylinder(rhino3dm.Circle(1.0), 2.0).ToBrep(True, True), 0.3)  # noqa: FBT003
    z, rho = can.mesh.vertices[:, 2], np.hypot(*can.mesh.vertices[:, :2].T)
    on_rim = (np.minimum(z, 2 - z) < 1e-9) & (rho > 1 - 1e-9)
    assert np.array_equal(~can.is_smooth, on_rim)
    assert np.abs(np.abs(can.normals[on_rim, 2]) - np.sqrt(0.5)).max() < 1e-9
    line = rhino3dm.LineCurve(Point(1, 0, 0), Point(0, 0, 2))
    cone = read(rhino3dm.RevSurface.Create(line, AXIS, 0, 2 * np.pi), 0.3)
    apex = int(np.argmax(cone.mesh.vertices[:, 2]))
    assert np.flatnonzero(~cone.is_smooth).tolist() == [apex]
    assert abs(cone.normals[apex, 2]) > 1 - 1e-9
    six = read(rhino3dm.Brep.CreateQuadSphere(rhino3dm.Sphere(Point(0, 0, 0), 2.0)), 0.4)
    assert six.is_smooth.all()
    # Rhino's six patches are a sphere to 4 % of the curvature.
    assert np.abs(np.abs(six.curvatures) - 0.5).max() < 0.02


def test_an_ellipsoid_has_its_exact_curvature_at_the_pole() -> None:
    """Where meridians bend differently: half axes 3, 2 and 1.5, all exact at the pole."""
    geometry = rhino3dm.Sphere(Point(0, 0, 0), 1.0).ToNurbsSurface()
    stretch = rhino3dm.Transform(1.0)
    stretch.M00, stretch.M11, stretch.M22 = 3.0, 2.0, 1.5
    assert geometry.Transform(stretch)
    found = read(geometry)
    top = int(np.argmax(found.mesh.vertices[:, 2]))
    assert np.abs(np.sort(np.abs(found.curvatures[top])) - (1.5 / 9, 1.5 / 4)).max() < 1e-9
    assert found.is_smooth[top]
    larger = np.abs(found.curvatures[top]).argmax()
    assert abs(found.directions[top, larger, 1]) == pytest.approx(1)


def test_blocks_are_where_they_stand() -> None:
    model = rhino3dm.File3dm()
    attributes = rhino3dm.ObjectAttributes()
    model.InstanceDefinitions.Add("block", "", "", "", Point(0, 0, 0), (ball(),), (attributes,))
    double = rhino3dm.Transform(2.0)
    double.M33 = 1.0
    block = model.InstanceDefinitions[0].Id
    model.Objects.Add(rhino3dm.InstanceReference(block, double), None)
    found = read_surfaces_3dm(as_bytes(model), "", GridSize(9, 7, 0.5)).surface
    assert np.abs(norm(found.mesh.vertices) - 5).max() < 1e-9
    assert np.abs(np.abs(found.curvatures) - 0.2).max() < 1e-9
    sides = norm(found.mesh.vertices - np.roll(found.mesh.vertices, 1, 0))
    assert np.median(sides) < 1


def test_what_is_no_surface_is_said(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    model.Objects.AddSurface(ball())
    model.Objects.AddPoint(Point(0, 0, 0))
    path = tmp_path / "a.3dm"
    path.write_bytes(as_bytes(model))
    with pytest.warns(nodes.NodeWarning, match="left out what is no surface: 1 point"):
        found = nodes.read_surface(path, edge_length=0.5)
    fields = nodes.surface_fields(found)
    assert fields.mesh is found.mesh
    assert fields.curvatures.shape == (found.mesh.n_vertices, 2)
    with pytest.raises(InputError, match=r"only a \.3dm holds surfaces; read a mesh with"):
        read_surface(tmp_path / "a.obj")
    with pytest.raises(InputError, match="at least one row"):
        read_surface(path, n_u=0)
    empty = rhino3dm.File3dm()
    empty.Objects.AddPoint(Point(0, 0, 0))
    path.write_bytes(as_bytes(empty))
    with pytest.raises(InputError, match="there are no surfaces, but 1 point"):
        read_surface(path)


def test_surfaces_go_by_wire_and_are_checked(tmp_path: Path) -> None:
    path = tmp_path / "a.3dm"
    path.write_bytes(content(ball()))
    graph = sm.Graph("surface", units="mm")
    drawn = graph.add("read_surface", path=str(path), edge_length=0.6)
    fields = graph.add("surface_fields", surface=drawn)
    graph.add("fit_spheres", "fit", mesh=fields.mesh)
    assert isinstance(graph.run("read_surface"), sm.Surface)
    assert graph.run("fit").mesh.n_faces > 50
    with pytest.raises(nodes.GraphError, match="cannot wire"):
        graph.add("fit_spheres", "wrong", mesh=drawn)
    mesh = sm.Mesh(np.eye(3), [[0, 1, 2]])
    flat = np.zeros((3, 2)), np.zeros((3, 2, 3)), np.ones(3, bool)
    with pytest.raises(InputError, match="one row for each vertex"):
        sm.Surface(mesh, np.zeros((2, 3)), *flat)
    with pytest.raises(InputError, match="not finite"):
        sm.Surface(mesh, np.full((3, 3), np.nan), *flat)


def drawn(system: rhino3dm.UnitSystem, path: Path) -> Path:
    """A ball that is shown and a barrel on a layer that is off, in some unit."""
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = system
    layer = rhino3dm.Layer()
    layer.Name, layer.Visible = "Old", False
    away = rhino3dm.ObjectAttributes()
    away.LayerIndex = model.Layers.Add(layer)
    model.Objects.Add(ball(), None)
    model.Objects.Add(barrel(), away)
    assert model.Write(str(path), 8)
    return path


def test_surfaces_are_in_the_units_that_are_said(tmp_path: Path) -> None:
    path = drawn(rhino3dm.UnitSystem.Yards, tmp_path / "a.3dm")
    found = read_surface(path, n_u=9, n_v=7)
    assert found.units == "ft"
    assert any("drawn in yards; it is read in ft" in each for each in found.remarks)
    np.testing.assert_allclose(norm(found.surface.mesh.vertices), 7.5, rtol=1e-12)
    np.testing.assert_allclose(np.abs(found.surface.curvatures), 1 / 7.5, rtol=1e-9)


def test_hidden_surfaces_are_left_out_and_said(tmp_path: Path) -> None:
    path = drawn(rhino3dm.UnitSystem.Meters, tmp_path / "a.3dm")
    found = read_surface(path, n_u=9, n_v=7)
    assert any("left out 1 hidden object" in each for each in found.remarks)
    assert norm(found.surface.mesh.vertices).max() < 2.6
    both = read_surface(path, layer="old", n_u=9, n_v=7)
    np.testing.assert_allclose(norm(both.surface.mesh.vertices[:, :2]), 2, rtol=1e-12)


def test_a_graph_in_other_units_refuses_surfaces(tmp_path: Path) -> None:
    path = drawn(rhino3dm.UnitSystem.Millimeters, tmp_path / "a.3dm")
    graph = sm.Graph(units="m")
    step = graph.add("read_surface", path=str(path))
    with pytest.raises(nodes.NodeError, match="drawn in mm, not in m; use units 'mm'"):
        graph.run(step)
