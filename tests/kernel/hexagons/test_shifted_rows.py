"""Triangulations with shifted rows keep vertices, orientation and outline of their grid."""

from typing import get_args

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.hexagons.shifted_rows import RowDirection, shifted_rows
from spheremesh.kernel.meshes.mesh import face_normals, face_vector_areas
from spheremesh.kernel.surfaces.circular_nets import catenoid_net, roof_net, torus_net


@pytest.mark.parametrize("along", get_args(RowDirection))
def test_a_torus_gets_six_triangles_around_every_vertex(along: RowDirection) -> None:
    net = torus_net(36, 16, 2.0, 0.8)
    mesh = shifted_rows(net, along)
    assert (mesh.n_vertices, mesh.n_faces) == (288, 576)
    assert (np.bincount(mesh.corners) == 6).all()
    assert {tuple(v) for v in mesh.vertices.tolist()} < {
        tuple(v) for v in net.vertices.tolist()
    }
    core = 2.0 * mesh.vertices[:, :2] / np.linalg.norm(mesh.vertices[:, :2], axis=1)[:, None]
    outwards = mesh.vertices - np.append(core, np.zeros((288, 1)), 1)
    middle = outwards[mesh.corners.reshape(-1, 3)].sum(1)
    assert ((face_normals(mesh) * middle).sum(1) > 0).all()
    edges = mesh.vertices[mesh.topology.edge_vertices]
    heights = np.abs(edges[:, 0, 2] - edges[:, 1, 2])
    in_rows = heights < 1e-9
    # across, only the steps over the highest and the lowest circle are level
    assert in_rows.sum() == (288 if along == "first" else 36)


def test_rows_reach_the_boundary_of_a_catenoid() -> None:
    net = catenoid_net(44, 16, 1.0, 1.2)
    mesh = shifted_rows(net)
    assert mesh.n_vertices == 22 * 17
    assert int((~mesh.topology.is_boundary_vertex).sum()) == 330
    valences = np.bincount(mesh.corners)[~mesh.topology.is_boundary_vertex]
    assert (valences == 6).all()


@pytest.mark.parametrize("along", get_args(RowDirection))
def test_a_sheet_loses_half_a_step_where_rows_end(along: RowDirection) -> None:
    net = roof_net(12, 20, 40.0)
    mesh = shifted_rows(net, along)
    size = np.linalg.norm(face_vector_areas(net), axis=1).sum()
    assert np.linalg.norm(face_vector_areas(mesh), axis=1).sum() == pytest.approx(size, rel=0.1)
    assert (face_normals(mesh)[:, 2] > -0.5).all()


def test_what_is_no_grid_is_named(octahedron: Mesh) -> None:
    with pytest.raises(InputError, match="are no quadrilaterals"):
        shifted_rows(octahedron)
    with pytest.raises(InputError, match="odd number of faces"):
        shifted_rows(torus_net(15, 8, 2.0, 0.8))
    with pytest.raises(InputError, match="along must be"):
        shifted_rows(torus_net(16, 8, 2.0, 0.8), "third")  # type: ignore[arg-type]
    cube = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    corners = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    with pytest.raises(InputError, match=r"vertices \[0, 1.* are irregular"):
        shifted_rows(Mesh(corners, cube))
    net = torus_net(16, 8, 2.0, 0.8)
    faces = [np.roll(face, f == 5) for f, face in enumerate(net.faces)]
    with pytest.raises(InputError, match="start with another side"):
        shifted_rows(Mesh(net.vertices, faces))
