"""Meshes of Rhino files: ngons, layers, seams, and what else a file may hold."""

import base64
from pathlib import Path

import numpy as np
import pytest
import rhino3dm

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.reader import read_mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.fabrication.opennurbs.mesh_ngons import insert_ngons
from spheremesh.kernel.errors import InputError


def faces_of(mesh: Mesh) -> list[list[int]]:
    return [face.tolist() for face in mesh.faces]


def corners_of(mesh: Mesh) -> list[list[list[float]]]:
    return [mesh.vertices[face].tolist() for face in mesh.faces]


def error_of(path: Path, layer: str = "") -> str:
    with pytest.raises(InputError) as caught:
        read_mesh(path, layer)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"cannot read {path}: ")
    return message


def with_ngons(mesh: rhino3dm.Mesh, ngons: list[list[int]]) -> rhino3dm.Mesh:
    fields = mesh.Encode()
    data = base64.b64encode(insert_ngons(base64.b64decode(fields["data"]), ngons)).decode()
    return rhino3dm.CommonObject.Decode({**fields, "data": data})


def rhino_mesh(points: list, faces: list, *, double: bool = True) -> rhino3dm.Mesh:
    mesh = rhino3dm.Mesh()
    for point in points:
        (mesh.Vertices.AddPoint3d if double else mesh.Vertices.Add)(*point)
    for face in faces:
        mesh.Faces.AddFace(*face)
    return mesh


def add_layer(model: rhino3dm.File3dm, name: str, parent: int | None = None) -> int:
    layer = rhino3dm.Layer()
    layer.Name = name
    if parent is not None:
        layer.ParentLayerId = model.Layers[parent].Id
    return model.Layers.Add(layer)


def on_layer(index: int) -> rhino3dm.ObjectAttributes:
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = index
    return attributes


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 1 / 3), (0, 1, 0)]


def hexagons_quad_triangle() -> Mesh:
    angles = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(angles), np.sin(angles), angles / 7], axis=1)
    outside = [[2, 0, 0.1], [1.5, 1.2, 0], [-2, 0, 1 / 3]]
    return Mesh(np.concatenate([ring, outside]), [[0, 6, 7, 1], range(6), [3, 2, 8]])


def test_rhino_reads_our_file_as_we_wrote_it(tmp_path: Path) -> None:
    mesh = hexagons_quad_triangle()
    model = rhino3dm.File3dm.Read(str(write_mesh(mesh, tmp_path / "a.3dm")))
    (entry,) = model.Objects
    seen = entry.Geometry
    assert seen.IsValidWithLog == (True, "")
    assert seen.Vertices.UseDoublePrecisionVertices
    points = [(point.X, point.Y, point.Z) for point in seen.Vertices.ToPoint3dArray()]
    assert np.array_equal(points, mesh.vertices)
    assert (seen.Faces.QuadCount, seen.Faces.TriangleCount) == (1, 4 + 1)
    assert model.Settings.ModelUnitSystem.name == "None"


@pytest.mark.parametrize("version", [6, 7, 8])
def test_ngons_survive_what_rhino_itself_writes(tmp_path: Path, version: int) -> None:
    mesh = hexagons_quad_triangle()
    model = rhino3dm.File3dm.Read(str(write_mesh(mesh, tmp_path / "a.3dm")))
    assert model.Write(str(tmp_path / "b.3dm"), version)
    assert corners_of(read_mesh(tmp_path / "b.3dm")) == corners_of(mesh)


def test_normals_colours_and_user_text_do_no_harm(tmp_path: Path) -> None:
    mesh = hexagons_quad_triangle()
    model = rhino3dm.File3dm.Read(str(write_mesh(mesh, tmp_path / "a.3dm")))
    geometry = model.Objects[0].Geometry
    geometry.SetUserString("note", "caf\u00e9")
    geometry.Normals.ComputeNormals()
    for _ in range(mesh.n_vertices):
        geometry.VertexColors.Add(1, 2, 3)
    decorated = rhino3dm.File3dm()
    decorated.Objects.AddMesh(geometry)
    assert decorated.Write(str(tmp_path / "b.3dm"), 8)
    assert corners_of(read_mesh(tmp_path / "b.3dm")) == corners_of(mesh)


def test_an_ngon_stands_for_its_faces_and_drops_its_inner_vertices(tmp_path: Path) -> None:
    inner = rhino_mesh(
        [(0.5, 0.5, 1), *SQUARE, (2, 0, 0), (2, 1, 0)],
        [(0, 1, 2), (2, 5, 6, 3), (0, 2, 3), (0, 3, 4), (0, 4, 1)],
    )
    model = rhino3dm.File3dm()
    model.Objects.AddMesh(with_ngons(inner, [[4, 4, 1, 2, 3, 4, 0, 2, 3, 4]]))
    model.Write(str(tmp_path / "a.3dm"), 8)
    mesh = read_mesh(tmp_path / "a.3dm")
    assert faces_of(mesh) == [[0, 1, 2, 3], [1, 4, 5, 2]]
    assert mesh.vertices[:4].tolist() == [list(point) for point in SQUARE]


def test_the_creases_of_an_unwelded_mesh_are_joined(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    crease = [SQUARE[0], SQUARE[1], SQUARE[2], SQUARE[0], SQUARE[2], SQUARE[3]]
    model.Objects.AddMesh(rhino_mesh(crease, [(0, 1, 2), (3, 4, 5)]))
    model.Write(str(tmp_path / "a.3dm"), 8)
    assert faces_of(read_mesh(tmp_path / "a.3dm")) == [[0, 1, 2], [0, 2, 3]]


def test_float32_vertices_are_read_as_they_are_stored(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    model.Objects.AddMesh(rhino_mesh(SQUARE, [(0, 1, 2, 3)], double=False))
    model.Write(str(tmp_path / "a.3dm"), 8)
    mesh = read_mesh(tmp_path / "a.3dm")
    assert np.array_equal(mesh.vertices, np.array(SQUARE, np.float32))


def layered_model(path: Path) -> Path:
    """Two squares with a common side on sublayers, a decoy, a block and a sphere."""
    model = rhino3dm.File3dm()
    roof = add_layer(model, "Roof")
    panels = add_layer(model, "Panels", roof)
    north = add_layer(model, "North", panels)
    decoy = add_layer(model, "Panels old", roof)
    right = [(x + 1, y, z) for x, y, z in SQUARE]
    right[0], right[3] = (1 + 1e-9, 0, 0), SQUARE[2]
    model.Objects.AddMesh(rhino_mesh(right, [(0, 1, 2, 3)]), on_layer(north))
    model.Objects.AddMesh(rhino_mesh(SQUARE, [(0, 1, 2, 3)]), on_layer(panels))
    model.Objects.AddMesh(rhino_mesh(SQUARE, [(0, 1, 2)]), on_layer(decoy))
    model.Objects.AddSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 1), on_layer(roof))
    model.InstanceDefinitions.Add(
        "block", "", "", "", rhino3dm.Point3d(0, 0, 0),
        (rhino_mesh(SQUARE, [(0, 1, 2, 3)]),), (on_layer(panels),),
    )  # fmt: skip
    model.Write(str(path), 8)
    return path


def test_meshes_on_a_layer_and_below_are_joined_in_order(tmp_path: Path) -> None:
    mesh = read_mesh(layered_model(tmp_path / "a.3dm"), layer="Roof::Panels")
    assert mesh.n_vertices == 6
    assert faces_of(mesh) == [[0, 1, 2, 3], [4, 0, 3, 5]]
    assert mesh.vertices[0].tolist() == [1 + 1e-9, 0, 0]
    assert len(mesh.topology.edge_faces) == 1
    assert read_mesh(tmp_path / "a.3dm", layer="Roof::Panels old").n_faces == 1


def test_3dm_errors_say_what_the_file_holds(tmp_path: Path) -> None:
    path = layered_model(tmp_path / "a.3dm")
    message = error_of(path, layer="Wall")
    assert "'Wall'" in message
    assert "'Roof', 'Roof::Panels', 'Roof::Panels::North', 'Roof::Panels old'" in message
    assert "non-manifold" in error_of(path)

    model = rhino3dm.File3dm()
    model.Objects.AddCircle(rhino3dm.Circle(1.0))
    model.Objects.AddMesh(rhino3dm.Mesh())
    model.Objects.AddCircle(rhino3dm.Circle(2.0))
    model.Write(str(tmp_path / "b.3dm"), 8)
    message = error_of(tmp_path / "b.3dm")
    assert "no meshes and no surfaces" in message
    assert "2 curves, 1 mesh without faces; mesh them in Rhino" in message

    rhino3dm.File3dm().Write(str(tmp_path / "c.3dm"), 8)
    assert "no objects" in error_of(tmp_path / "c.3dm")
    for damaged in (path.read_bytes()[:-200], b"not Rhino"):
        (tmp_path / "d.3dm").write_bytes(damaged)
        assert "damaged" in error_of(tmp_path / "d.3dm")


def test_a_mesh_that_rhino_calls_invalid_is_not_written(tmp_path: Path) -> None:
    degenerate = Mesh([[0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0, 1, 2]])
    with pytest.raises(InputError, match="invalid"):
        write_mesh(degenerate, tmp_path / "a.3dm")
    assert list(tmp_path.iterdir()) == []
