"""Blocks of Rhino files are read wherever an instance of them stands."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm

from spheremesh import nodes
from spheremesh.fabrication.mesh_files.reader import read_mesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.rhino.mesh_writer import to_rhino_mesh
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh, face_normals

HEXAGON = [(np.cos(a), np.sin(a), 0.1) for a in np.pi / 3 * np.arange(6)]
TURN = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
MIRROR = np.diag([1, 1, -1.0])


def piece() -> Mesh:
    """A hexagon and a quad beside it."""
    return Mesh(
        np.array([*HEXAGON, (2, 0, 0.3), (1.5, 0.9, 0.3)]), [(0, 1, 2, 3, 4, 5), (1, 0, 6, 7)]
    )


def attributes(layer: int) -> rhino3dm.ObjectAttributes:
    found = rhino3dm.ObjectAttributes()
    found.LayerIndex = layer
    return found


def model_with_layers(*names: str) -> Any:  # noqa: ANN401
    model: Any = rhino3dm.File3dm()
    for name in names:
        layer = rhino3dm.Layer()
        layer.Name = name
        model.Layers.Add(layer)
    return model


def define(model: Any, name: str, geometry: Any, layer: int = 0) -> Any:  # noqa: ANN401
    """A block of one object; its id."""
    origin = rhino3dm.Point3d(0, 0, 0)
    each = (attributes(layer),)
    model.InstanceDefinitions.Add(name, "", "", "", origin, (geometry,), each)
    return next(block.Id for block in model.InstanceDefinitions if block.Name == name)


def instance(block: Any, linear: FloatArray, shift: FloatArray) -> Any:  # noqa: ANN401
    transform = rhino3dm.Transform(1.0)
    for i in range(3):
        for j in range(3):
            setattr(transform, f"M{i}{j}", float(linear[i, j]))
        setattr(transform, f"M{i}3", float(shift[i]))
    return rhino3dm.InstanceReference(block, transform)


def save(model: Any, path: Path) -> Path:  # noqa: ANN401
    assert model.Write(str(path), 8)
    return path


def test_instances_of_meshes_and_of_blocks_in_blocks(tmp_path: Path) -> None:
    mesh, model = piece(), model_with_layers("Roof")
    block = define(model, "piece", to_rhino_mesh(mesh))
    outer = define(model, "outer", instance(block, TURN, np.array([0, 0, 5.0])))
    shift = np.array([1e5, 0, 0])
    model.Objects.Add(instance(block, np.eye(3), shift), attributes(0))
    model.Objects.Add(instance(outer, 2 * TURN, -shift), attributes(0))
    found = read_mesh(save(model, tmp_path / "a.3dm"))
    twice = 2 * mesh.vertices @ (TURN @ TURN).T + (0, 0, 10) - shift
    expected = np.concatenate([mesh.vertices + shift, twice])
    assert found.degrees.tolist() == [6, 4, 6, 4]
    assert np.abs(found.vertices - expected).max() < 1e-10
    corners = [mesh.corners, mesh.corners + mesh.n_vertices]
    assert np.array_equal(found.corners, np.concatenate(corners))


def test_mirrored_instances_keep_their_side(tmp_path: Path) -> None:
    mesh, model = piece(), model_with_layers("Roof")
    block = define(model, "piece", to_rhino_mesh(mesh))
    model.Objects.Add(instance(block, MIRROR, np.zeros(3)), attributes(0))
    found = read_mesh(save(model, tmp_path / "a.3dm"))
    assert np.abs(face_normals(found) - face_normals(mesh) @ MIRROR).max() < 1e-12


def test_layers_of_members_and_of_instances(tmp_path: Path) -> None:
    model = model_with_layers("Roof", "Site", "Other")
    block = define(model, "piece", to_rhino_mesh(piece()), layer=2)
    model.Objects.Add(instance(block, np.eye(3), np.zeros(3)), attributes(1))
    model.Objects.Add(to_rhino_mesh(piece()), attributes(0))
    path = save(model, tmp_path / "a.3dm")
    for layer in ("Roof", "Site", "Other"):
        assert read_mesh(path, layer).n_faces == 2
    with pytest.raises(InputError, match="nothing is on layer 'Wall'"):
        read_mesh(path, "Wall")


def test_an_instance_without_a_block_is_named(tmp_path: Path) -> None:
    model = model_with_layers("Roof")
    block = define(model, "piece", rhino3dm.Point(rhino3dm.Point3d(0, 0, 0)))
    model.Objects.Add(instance(block, np.eye(3), np.zeros(3)), attributes(0))
    missing = "00000000-0000-0000-0000-000000000001"
    model.Objects.Add(instance(missing, np.eye(3), np.zeros(3)), attributes(0))
    with pytest.raises(InputError, match="1 point, 1 instance of a block that the file"):
        read_mesh(save(model, tmp_path / "a.3dm"))


def test_blocks_of_surfaces_are_what_single_surfaces_are(tmp_path: Path) -> None:
    """Panels written one by one and as instances give the same grid of quads."""
    optimum = nodes.minimize_angles(nodes.fit_spheres(nodes.torus_mesh(8, 6)))
    panels = nodes.panels(optimum.sphere_mesh, joint_gap=0.02).panels
    meshes: list[Mesh] = []
    for shape in ("panels", "blocks"):
        file = write_3dm(Model(panels), tmp_path / f"{shape}.3dm", RhinoOptions(shape, ()))
        meshes.append(read_mesh(file.path, "Panels", n_u=2, n_v=2))
    first, second = (mesh.vertices[mesh.corners].reshape(-1, 4, 3) for mesh in meshes)
    assert len(first) == len(second) == 48 * 4
    middles, others = first.mean(1), second.mean(1)
    nearest = np.linalg.norm(middles[:, None] - others, axis=2).argmin(1)
    assert sorted(nearest) == list(range(len(others)))
    assert np.abs(middles - others[nearest]).max() < 1e-9
    normals, turned = face_normals(meshes[0]), face_normals(meshes[1])[nearest]
    assert np.abs(normals - turned).max() < 1e-6
