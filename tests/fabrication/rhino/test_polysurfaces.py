"""Polysurfaces of Rhino files: meshes that close along their joints, as fine as asked for."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh.fabrication.mesh_files.reader import read_mesh
from spheremesh.fabrication.rhino.brep_faces import read_polysurface
from spheremesh.fabrication.rhino.surface_reader import sample_object
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh, face_vector_areas, mean_edge_length
from spheremesh.kernel.surfaces.face_meshes import mesh_polysurface
from spheremesh.kernel.surfaces.nurbs import evaluate_nurbs
from spheremesh.kernel.surfaces.row_counts import GridSize

SEEDS = st.integers(0, 2**32 - 1)
Point = rhino3dm.Point3d


def saved(path: Path, *objects: Any) -> Path:  # noqa: ANN401
    model = rhino3dm.File3dm()
    for each in objects:
        model.Objects.Add(each, None)
    assert model.Write(str(path), 8)
    return path


def polyline(corners: Any) -> Any:  # noqa: ANN401
    outline = rhino3dm.Polyline(len(corners) + 1)
    for corner in (*corners, corners[0]):
        x, y, z = (*map(float, corner), 0.0)[:3]
        outline.Add(x, y, z)
    return outline.ToPolylineCurve()


def circle(x: float, y: float, radius: float) -> Any:  # noqa: ANN401
    return rhino3dm.Circle(Point(x, y, 0), radius).ToNurbsCurve()


def blob() -> Any:  # noqa: ANN401
    """A closed cubic with one corner."""
    corners = [(0, 0), (4, -1), (5, 3), (2, 2), (-1, 4), (0, 0)]
    points = [Point(x, y, 0) for x, y in corners]
    return rhino3dm.NurbsCurve.CreateControlPointCurve(points, 3)


def joined(*parts: Any) -> Any:  # noqa: ANN401
    curve = rhino3dm.PolyCurve()
    for part in parts:
        curve.Append(part)
    return curve


def half_disc() -> Any:  # noqa: ANN401
    arc = rhino3dm.Arc(Point(0, 0, 0), 2.0, np.pi)
    return joined(arc, rhino3dm.Line(Point(-2, 0, 0), Point(2, 0, 0)))


def slot() -> Any:  # noqa: ANN401
    """Two lines and two half circles that join smoothly."""
    return joined(
        rhino3dm.Line(Point(-2, -1, 0), Point(2, -1, 0)),
        rhino3dm.Arc(Point(2, -1, 0), Point(3, 0, 0), Point(2, 1, 0)),
        rhino3dm.Line(Point(2, 1, 0), Point(-2, 1, 0)),
        rhino3dm.Arc(Point(-2, 1, 0), Point(-3, 0, 0), Point(-2, -1, 0)),
    )


def lens() -> Any:  # noqa: ANN401
    return joined(
        rhino3dm.Arc(Point(-2, 0, 0), Point(0, -1, 0), Point(2, 0, 0)),
        rhino3dm.Arc(Point(2, 0, 0), Point(0, 1, 0), Point(-2, 0, 0)),
    )


def extruded(profile: Any, *holes: Any) -> Any:  # noqa: ANN401
    solid = rhino3dm.Extrusion.Create(profile, 1.5, True)  # noqa: FBT003
    for hole in holes:
        assert solid.AddInnerProfile(hole)
    return solid


def star() -> Any:  # noqa: ANN401
    turns, radii = np.arange(10) * np.pi / 5, np.array([2, 0.8] * 5)
    return polyline(np.stack([radii * np.cos(turns), radii * np.sin(turns)], 1))


def tube() -> Any:  # noqa: ANN401
    """A circle about the y axis at distance 3 from z, revolved."""
    profile = circle(0, 0, 1)
    profile.Rotate(np.pi / 2, rhino3dm.Vector3d(1, 0, 0), Point(0, 0, 0))
    profile.Translate(rhino3dm.Vector3d(3, 0, 0))
    axis = rhino3dm.Line(Point(0, 0, 0), Point(0, 0, 1))
    return rhino3dm.RevSurface.Create(profile, axis, 0, 2 * np.pi)


def cone() -> Any:  # noqa: ANN401
    axis = rhino3dm.Line(Point(0, 0, 0), Point(0, 0, 1))
    line = rhino3dm.LineCurve(Point(1, 0, 0), Point(0, 0, 2))
    return rhino3dm.RevSurface.Create(line, axis, 0, 2 * np.pi)


def box() -> Any:  # noqa: ANN401
    return rhino3dm.Brep.CreateFromBox(rhino3dm.Box(rhino3dm.BoundingBox(0, 0, 0, 1, 2, 3)))


RECTANGLE = [(0, 0), (6, 0), (6, 4), (0, 4)]
SOLIDS: dict[str, tuple[Callable[[], Any], float]] = {
    "sphere": (lambda: rhino3dm.Sphere(Point(1, 2, 3), 2.5).ToBrep(), 25 * np.pi),
    "sphere of six faces": (
        lambda: rhino3dm.Brep.CreateQuadSphere(rhino3dm.Sphere(Point(1, 2, 3), 2.5)),
        25 * np.pi,
    ),
    "torus": (tube, 12 * np.pi**2),
    "torus as a Brep": (
        lambda: rhino3dm.Brep.CreateFromRevSurface(tube(), False, False),  # noqa: FBT003
        12 * np.pi**2,
    ),
    "box": (box, 22.0),
    "cylinder with caps": (
        lambda: rhino3dm.Cylinder(rhino3dm.Circle(1.0), 2.0).ToBrep(True, True),  # noqa: FBT003
        6 * np.pi,
    ),
    "box with a round hole": (
        lambda: extruded(polyline(RECTANGLE), circle(2, 2, 1)),
        30 + 48 - 2 * np.pi + 3 * np.pi,
    ),
    "L": (lambda: extruded(polyline([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])), 28.0),
    "slot": (lambda: extruded(slot()), 2 * (8 + np.pi) + 1.5 * (8 + 2 * np.pi)),
    "half disc": (lambda: extruded(half_disc()), 4 * np.pi + 1.5 * (4 + 2 * np.pi)),
    "lens": (lambda: extruded(lens()), 0.0),
    "blob": (lambda: extruded(blob()), 0.0),
    "star": (lambda: extruded(star()), 0.0),
    "chamfered": (
        lambda: extruded(polyline([(0, 0), (4, 0), (4, 2.8), (3.8, 3), (0, 3)])),
        2 * (12 - 0.02) + 1.5 * (4 + 2.8 + np.hypot(0.2, 0.2) + 3.8 + 3),
    ),
}
SIZES = [{"n_u": 5, "n_v": 9}, {"edge_length": 0.5}, {"edge_length": 0.21}]


def n_boundary(mesh: Mesh) -> int:
    return int((mesh.topology.twins < 0).sum())


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_closed(tmp_path: Path, name: str, size: dict[str, Any]) -> None:
    make, expected = SOLIDS[name]
    mesh = read_mesh(saved(tmp_path / "a.3dm", make()), **size)
    assert n_boundary(mesh) == 0
    areas = norm(face_vector_areas(mesh))
    assert areas.min() > 0
    if expected:
        assert areas.sum() == pytest.approx(expected, rel=0.25 if "n_u" in size else 0.03)
    if "edge_length" in size:
        edge = size["edge_length"]
        assert 0.6 * edge < mean_edge_length(mesh) < 1.25 * edge
    volume = np.einsum("fi,fi->", face_vector_areas(mesh), middles(mesh)) / 3
    assert volume > 0


def middles(mesh: Mesh) -> FloatArray:
    return np.array([mesh.vertices[face].mean(0) for face in mesh.faces])


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("edge_length", [None, 0.3])
def test_vertices_lie_on_the_surfaces_of_all_faces(
    name: str, edge_length: float | None
) -> None:
    """Gaps at joints: both faces have the common vertices, at the same place to 1e-9."""
    polysurface = read_polysurface(SOLIDS[name][0](), np.eye(4))
    mesh = mesh_polysurface(polysurface, GridSize(7, 4, edge_length))
    size = np.ptp(mesh.points, axis=0).max()
    owners: dict[int, set[int]] = {}
    for i, (face, part) in enumerate(zip(polysurface.faces, mesh.faces, strict=True)):
        found = evaluate_nurbs(face.surface, *part.uv.T).points
        assert norm(found - mesh.points[part.vertices]).max() < 1e-9 * size
        for vertex in part.vertices:
            owners.setdefault(int(vertex), set()).add(i)
    if len(polysurface.faces) > 1:
        assert sum(len(each) > 1 for each in owners.values()) > 8


@given(SEEDS, st.floats(1e-3, 1e3))
@settings(max_examples=60, deadline=None)
def test_trapezoids_trimmed_from_planes_are_read(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    flat = np.array([[0.0, 0], [4, 0], [4, 3], [0, 3]]) + rng.uniform(-1, 1, (4, 2))
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    corners = scale * (rng.uniform(-9, 9, 3) + flat @ frame[:2])
    axis = np.cross(frame[0], frame[1])
    plane = rhino3dm.Plane(Point(*corners[0]), rhino3dm.Vector3d(*axis))
    brep = rhino3dm.Brep.CreateTrimmedPlane(plane, polyline(corners))
    for size in (GridSize(6, 4), GridSize(24, 24, 0.5 * scale)):
        (grid,) = sample_object(brep, size)
        assert set(grid.degrees.tolist()) == {4}
        assert np.abs((grid.vertices - corners[0]) @ axis).max() < 1e-9 * scale
        x, y = flat.T
        mesh = Mesh(grid.vertices, grid.corners.reshape(-1, 4))
        total = norm(face_vector_areas(mesh)).sum() / scale**2
        assert total == pytest.approx((x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


@pytest.mark.parametrize(
    "name", ["blob", "cylinder with caps", "box with a round hole", "torus"]
)
def test_solids_far_from_the_origin_are_closed(tmp_path: Path, name: str) -> None:
    """A seam has two sides at one place; far away only the digits of that place are known."""
    solid = SOLIDS[name][0]()
    if isinstance(solid, rhino3dm.Extrusion):
        solid = solid.ToBrep(True)  # noqa: FBT003
    solid.Rotate(1.0, rhino3dm.Vector3d(1, 2, 3), Point(0, 0, 0))
    solid.Translate(rhino3dm.Vector3d(1e6, 2e6, -3e5))
    for size in SIZES:
        mesh = read_mesh(saved(tmp_path / "a.3dm", solid), **size)
        assert n_boundary(mesh) == 0


def test_the_edge_length_holds_where_a_block_stands(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    attributes = rhino3dm.ObjectAttributes()
    model.InstanceDefinitions.Add("block", "", "", "", Point(0, 0, 0), (box(),), (attributes,))
    blocks: Any = model.InstanceDefinitions
    transform = rhino3dm.Transform(3.0)
    transform.M33 = 1.0
    model.Objects.Add(rhino3dm.InstanceReference(blocks[0].Id, transform), None)
    assert model.Write(str(tmp_path / "a.3dm"), 8)
    mesh = read_mesh(tmp_path / "a.3dm", edge_length=1.0)
    assert mesh.n_faces == 22 * 9
    assert mean_edge_length(mesh) == pytest.approx(1.0)


def test_neighbours_take_the_larger_number_of_rows(tmp_path: Path) -> None:
    mesh = read_mesh(saved(tmp_path / "a.3dm", box()), n_u=2, n_v=3)
    assert n_boundary(mesh) == 0
    assert set(mesh.degrees.tolist()) == {4}


def test_edge_lengths_are_those_asked_for(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.3dm", box())
    for edge in (1.0, 0.5, 0.1):
        assert mean_edge_length(read_mesh(path, edge_length=edge)) == pytest.approx(edge)
    assert read_mesh(path, edge_length=50.0).n_faces == 6
    with pytest.raises(InputError, match="faces, more than 1000000; ask for longer edges"):
        read_mesh(path, edge_length=1e-5)
    with pytest.raises(InputError, match="edge length must be positive, not -1"):
        read_mesh(path, edge_length=-1)


def test_a_surface_without_equal_parameters_gets_equal_edges(tmp_path: Path) -> None:
    """A ruled surface whose parameters crowd at one end."""
    points = [Point(x, 0, 0) for x in (0, 0.1, 0.3, 10)]
    low = rhino3dm.NurbsCurve.CreateControlPointCurve(points, 3)
    high = low.Duplicate()
    high.Translate(rhino3dm.Vector3d(0, 3, 0))
    surface = rhino3dm.NurbsSurface.CreateRuledSurface(low, high)
    mesh = read_mesh(saved(tmp_path / "a.3dm", surface), edge_length=1.0)
    assert mesh.n_faces == 30
    areas = norm(face_vector_areas(mesh))
    assert areas.max() < 1.05 * areas.min()


def test_a_cone_has_triangles_at_its_apex(tmp_path: Path) -> None:
    mesh = read_mesh(saved(tmp_path / "a.3dm", cone()), edge_length=0.25)
    assert (mesh.degrees == 3).sum() == n_boundary(mesh)
    assert norm(mesh.vertices - (0, 0, 2)).min() < 1e-12


def test_a_hole_that_leaves_its_face_is_refused(tmp_path: Path) -> None:
    solid = extruded(circle(0, 0, 3), circle(0, 0.2, 1))
    with pytest.raises(InputError, match=r"face \d .*(edges|itself); mesh it in Rhino"):
        read_mesh(saved(tmp_path / "a.3dm", solid))


L_SHAPE = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]


@pytest.mark.parametrize("edge_length", [None, 0.7, 0.4])
def test_vertices_stand_on_kinks(tmp_path: Path, edge_length: float | None) -> None:
    """One edge around a face, one surface around a corner: nothing is cut off."""
    loop = polyline(L_SHAPE).ToNurbsCurve()
    face = rhino3dm.Brep.CreateTrimmedPlane(rhino3dm.Plane.WorldXY(), loop)
    assert len(face.Edges) == 1
    wall = rhino3dm.Extrusion.Create(polyline(L_SHAPE), 1.0, False).ToNurbsSurface()  # noqa: FBT003
    as_brep = rhino3dm.Brep.CreateFromSurface(wall)
    for geometry, area in ((face, 5.0), (wall, 12.0), (as_brep, 12.0)):
        mesh = read_mesh(saved(tmp_path / "a.3dm", geometry), edge_length=edge_length)
        assert norm(face_vector_areas(mesh)).sum() == pytest.approx(area)
        corners = np.array([(*corner, 0.0) for corner in L_SHAPE])
        away = norm(mesh.vertices - corners[:, None]).min(1)
        assert away.max() < 1e-9


def test_a_kinked_prism_whose_cap_has_one_edge_is_closed(tmp_path: Path) -> None:
    """A Brep with faces that are not split where their edges break."""
    solid = rhino3dm.Extrusion.Create(polyline(L_SHAPE).ToNurbsCurve(), 1.0, True)  # noqa: FBT003
    for brep in (solid.ToBrep(False), solid.ToBrep(True)):  # noqa: FBT003
        mesh = read_mesh(saved(tmp_path / "a.3dm", brep), edge_length=0.5)
        assert n_boundary(mesh) == 0
        assert norm(face_vector_areas(mesh)).sum() == pytest.approx(22.0)
