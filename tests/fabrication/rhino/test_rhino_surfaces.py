"""Surfaces and polysurfaces of Rhino files, read as grids of quads that lie on them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm

from spheremesh import nodes
from spheremesh.fabrication.mesh_files.reader import read_mesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.rhino.brep_faces import nurbs_surface
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh, face_normals, face_vector_areas
from spheremesh.kernel.surfaces.nurbs import evaluate_nurbs, nurbs_curvatures

CENTER = np.array([1.0, 2.0, 3.0])


def saved(path: Path, *objects: Any) -> Path:  # noqa: ANN401
    model = rhino3dm.File3dm()
    for each in objects:
        model.Objects.Add(each, None)
    assert model.Write(str(path), 8)
    return path


def sphere() -> rhino3dm.Sphere:
    return rhino3dm.Sphere(rhino3dm.Point3d(*CENTER), 2.5)


def radii(mesh: Mesh) -> FloatArray:
    return np.linalg.norm(mesh.vertices - CENTER, axis=1)


def n_boundary(mesh: Mesh) -> int:
    return int((mesh.topology.twins < 0).sum())


def sloping() -> rhino3dm.NurbsSurface:
    """A bicubic surface with weights and an inner knot."""
    rng = np.random.default_rng(5)
    surface = rhino3dm.NurbsSurface.Create(3, True, 4, 4, 5, 4)  # noqa: FBT003
    for i, knot in enumerate([0, 0, 0, 0.4, 1, 1, 1]):
        surface.KnotsU[i] = knot
    for i, knot in enumerate([-1, -1, -1, 2, 2, 2]):
        surface.KnotsV[i] = knot
    for i in range(5):
        for j in range(4):
            w = rng.uniform(0.5, 2)
            x = np.array([i, j, rng.uniform(0, 2)]) * w
            surface.Points[(i, j)] = rhino3dm.Point4d(*x, w)
    return surface


def test_the_kernel_evaluates_what_opennurbs_does() -> None:
    rng = np.random.default_rng(0)
    for surface in (sphere().ToNurbsSurface(), sloping()):
        record = nurbs_surface(surface)
        low, high = record.domain.T
        u, v = low[:, None] + (high - low)[:, None] * rng.uniform(0.02, 0.98, (2, 50))
        points = evaluate_nurbs(record, u, v).points
        found = [surface.PointAt(a, b) for a, b in zip(u, v, strict=True)]
        assert np.abs(points - [(p.X, p.Y, p.Z) for p in found]).max() < 1e-14 * 20
        normals = nurbs_curvatures(record, u, v).normals
        found = [surface.NormalAt(a, b) for a, b in zip(u, v, strict=True)]
        assert np.abs(normals - [(n.X, n.Y, n.Z) for n in found]).max() < 1e-9
    record = nurbs_surface(sphere().ToNurbsSurface())
    u, v = rng.uniform(0.1, 1.4, (2, 50))
    curvature = nurbs_curvatures(record, u, v)
    assert np.abs(np.abs([curvature.first, curvature.second]) * 2.5 - 1).max() < 1e-12


@pytest.mark.parametrize("as_brep", [False, True])
def test_a_surface_is_a_grid(tmp_path: Path, as_brep: bool) -> None:  # noqa: FBT001
    surface = sloping()
    geometry = rhino3dm.Brep.CreateFromSurface(surface) if as_brep else surface
    mesh = read_mesh(saved(tmp_path / "a.3dm", geometry), n_u=7, n_v=3)
    assert (mesh.n_faces, mesh.n_vertices) == (21, 32)
    for i, j in ((0, 0), (3, 2), (7, 3)):
        point = surface.PointAt(i / 7, -1 + j)
        assert np.abs(mesh.vertices - (point.X, point.Y, point.Z)).max(1).min() < 1e-14
    normal = surface.NormalAt(0.5 / 7, -0.5)
    assert face_normals(mesh)[0] @ (normal.X, normal.Y, normal.Z) > 0.9


def test_seams_close_and_poles_are_triangles(tmp_path: Path) -> None:
    mesh = read_mesh(saved(tmp_path / "a.3dm", sphere().ToBrep()), n_u=12, n_v=8)
    assert n_boundary(mesh) == 0
    assert sorted(set(mesh.degrees.tolist())) == [3, 4]
    assert (mesh.degrees == 3).sum() == 24
    assert mesh.n_vertices == 12 * 7 + 2
    assert np.abs(radii(mesh) - 2.5).max() < 1e-14
    outwards = np.einsum(
        "fi,fi->f", face_normals(mesh), [mesh.vertices[f].mean(0) - CENTER for f in faces(mesh)]
    )
    assert (outwards > 0).all()


def faces(mesh: Mesh) -> list[Any]:
    return np.split(mesh.corners, mesh.offsets[1:-1])


def test_polysurfaces_are_joined(tmp_path: Path) -> None:
    box = rhino3dm.Brep.CreateFromBox(rhino3dm.Box(rhino3dm.BoundingBox(0, 0, 0, 1, 2, 3)))
    mesh = read_mesh(saved(tmp_path / "a.3dm", box), n_u=4, n_v=4)
    assert (mesh.n_faces, n_boundary(mesh)) == (96, 0)
    middle = np.array([0.5, 1.0, 1.5])
    out = [mesh.vertices[f].mean(0) - middle for f in faces(mesh)]
    assert (np.einsum("fi,fi->f", face_normals(mesh), out) > 0).all()


@pytest.mark.parametrize(("net", "degree"), [("quads", 4), ("hexagons", 6), ("triangles", 3)])
def test_trimmed_panels_are_read_back(tmp_path: Path, net: str, degree: int) -> None:
    """What is written as exact trimmed spheres comes back with every vertex on them."""
    mesh = {
        "quads": nodes.torus_mesh(10, 8),
        "hexagons": fan_dome(6),
        "triangles": fan_dome(3),
    }[net]
    spheres = nodes.minimize_angles(nodes.fit_spheres(mesh)).sphere_mesh
    panels = nodes.panels(spheres, edges="intersection").panels
    assert degree in panels.degrees
    file = write_3dm(Model(panels), tmp_path / "a.3dm", RhinoOptions(layers=()))
    grid = read_mesh(file.path, n_u=4, n_v=4)
    assert set(grid.degrees.tolist()) == {4}
    quads = np.where(panels.degrees == 4, 16, 4 * panels.degrees)
    assert grid.n_faces == quads.sum()
    assert n_boundary(grid) == 4 * (mesh.topology.twins < 0).sum()
    owners = np.repeat(np.arange(panels.n_panels), quads)
    a, b, c = panels.spheres[owners, 0], panels.spheres[owners, 1:4], panels.spheres[owners, 4]
    for corner in grid.corners.reshape(-1, 4).T:
        x = grid.vertices[corner] - panels.origins[owners]
        miss = a * (x * x).sum(1) - (b * x).sum(1) + c
        assert np.abs(miss).max() < 1e-12
    flips = np.einsum(
        "fi,fi->f", face_normals(grid), face_normals(mesh)[panels.face_ids][owners]
    )
    assert (flips > 0).all()


def fan_dome(degree: int) -> Mesh:
    """A polygon and quads around it, on a sphere."""
    angles = 2 * np.pi * np.arange(degree) / degree
    rings = [
        np.stack([r * np.cos(angles), r * np.sin(angles), 0 * angles + np.sqrt(9 - r * r)], 1)
        for r in (0.8, 1.7)
    ]
    around = [
        (i, i + degree, (i + 1) % degree + degree, (i + 1) % degree) for i in range(degree)
    ]
    return Mesh(np.concatenate(rings), [tuple(range(degree)), *around])


def test_the_joined_shell_is_read_back(tmp_path: Path) -> None:
    spheres = nodes.minimize_angles(nodes.fit_spheres(nodes.torus_mesh(10, 8))).sphere_mesh
    panels = nodes.panels(spheres, edges="intersection").panels
    file = write_3dm(Model(panels), tmp_path / "a.3dm", RhinoOptions("shell", ()))
    grid = read_mesh(file.path, n_u=2, n_v=2)
    assert (grid.n_faces, n_boundary(grid)) == (320, 0)


def test_layers_blocks_and_meshes_beside_surfaces(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    layers = []
    for name in ("Design", "Mesh"):
        layer = rhino3dm.Layer()
        layer.Name = name
        layers.append(model.Layers.Add(layer))
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = layers[0]
    model.Objects.Add(sloping(), attributes)
    square = rhino3dm.Mesh()
    for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
        square.Vertices.Add(x, y, 9)
    square.Faces.AddFace(0, 1, 2, 3)
    attributes.LayerIndex = layers[1]
    model.Objects.Add(square, attributes)
    attributes.LayerIndex = layers[0]
    model.InstanceDefinitions.Add(
        "block",
        "",
        "",
        "",
        rhino3dm.Point3d(0, 0, 0),
        (sphere().ToNurbsSurface(),),
        (attributes,),
    )
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    path = tmp_path / "a.3dm"
    model.Write(str(path), 8)
    assert read_mesh(path, n_u=3, n_v=5).n_faces == 16
    assert read_mesh(path, layer="Design", n_u=3, n_v=5).n_faces == 15
    assert nodes.read_mesh(path, "Design", 2, 2).n_faces == 4


def test_what_cannot_be_sampled(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a grid of 0 by 3 quads"):
        read_mesh(saved(tmp_path / "b.3dm", sloping()), n_u=0, n_v=3)
    with pytest.raises(InputError, match="1 by 1 quads on surfaces have no area: ask for more"):
        read_mesh(saved(tmp_path / "c.3dm", sphere().ToBrep()), n_u=1, n_v=1)


@pytest.mark.parametrize("edge_length", [None, 0.3])
@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)],
        [(0, 0), (3, 1), (0.5, 0.5), (1, 3)],
        [(0, 0), (3, 0), (3, 3), (1.5, 3.0), (0, 3)],
        [(0, 0), (3, 1), (2.2, 2.2), (1, 3)],
        [(2, 0), (0.5, 0.4), (0, 2), (-0.4, 0.5), (-2, 0), (-0.5, -0.4), (0, -2), (0.4, -0.5)],
    ],
)
def test_concave_faces_are_covered_once(
    tmp_path: Path, corners: list[tuple[float, float]], edge_length: float | None
) -> None:
    face = rhino3dm.Brep.CreateTrimmedPlane(rhino3dm.Plane.WorldXY(), polyline(corners))
    mesh = read_mesh(saved(tmp_path / "a.3dm", face), edge_length=edge_length)
    areas = face_vector_areas(mesh)[:, 2]
    x, y = np.array(corners).T
    assert areas.min() > 0
    assert areas.sum() == pytest.approx((x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def polyline(corners: Any) -> rhino3dm.PolylineCurve:  # noqa: ANN401
    """A closed polyline, at height 0 where none is given."""
    outline = rhino3dm.Polyline(len(corners) + 1)
    for corner in (*corners, corners[0]):
        x, y, z = (*map(float, corner), 0.0)[:3]
        outline.Add(x, y, z)
    return outline.ToPolylineCurve()


def test_extrusions(tmp_path: Path) -> None:
    square = rhino3dm.Polyline(4)
    for x, y in ((0, 0), (2, 0), (2, 1), (0, 1), (0, 0)):
        square.Add(x, y, 0)
    extrusion = rhino3dm.Extrusion.Create(square.ToPolylineCurve(), 3.0, True)  # noqa: FBT003
    mesh = read_mesh(saved(tmp_path / "a.3dm", extrusion), n_u=2, n_v=2)
    assert n_boundary(mesh) == 0
    assert np.abs(mesh.vertices.max(0) - mesh.vertices.min(0) - (2, 1, 3)).max() < 1e-14
