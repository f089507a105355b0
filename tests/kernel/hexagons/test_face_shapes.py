"""Convex, bow-tie or crossing: known faces, and what the pencil of tangent spheres tells."""

from typing import Any

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.congruences.curvature_spheres import (
    mean_curvature_spheres,
    touching_spheres,
)
from spheremesh.kernel.hexagons.dual_sphere_mesh import dual_sphere_mesh
from spheremesh.kernel.hexagons.face_shapes import (
    PencilPosition,
    boundary_crosses,
    face_shapes,
    pencil_positions,
)
from spheremesh.kernel.sphere_meshes.mobius import map_sphere_mesh
from spheremesh.kernel.spheres.mobius_group import inversion

Grids = dict[str, Any]

HEXAGON = [[np.cos(t), np.sin(t)] for t in np.pi / 3 * np.arange(6)]
BOW_TIE = [[1, 0.2], [1, 1], [-1, 1], [-0.3, 0.2], [-1, -1], [1, -1]]
CROSSED = [[0, 0], [2, 0], [2, 1], [0.5, -0.5], [0, 1]]


def one_face(outline: list[list[float]], curvature: float = 0.0) -> SphereMesh:
    """A face over an outline in the plane, on a sphere that touches the plane in the origin."""
    flat = np.array(outline, float)
    square = (flat**2).sum(1, keepdims=True)
    # stereographic lift from the plane: circles of the plane stay circles
    divisor = 1 + curvature**2 * square / 4
    points = np.concatenate([flat, curvature * square / 2], 1) / divisor
    row = touching_spheres(np.zeros((1, 3)), np.array([[0.0, 0, 1]]), np.array([curvature]))
    return SphereMesh(Mesh(points, [list(range(len(flat)))]), row)


@pytest.mark.parametrize("curvature", [0.0, 0.3, -0.3])
@pytest.mark.parametrize(
    ("outline", "shape"),
    [
        (HEXAGON, "convex"),
        (BOW_TIE, "bow-tie"),
        ([[0, 0], [2, 0], [2, 2], [1, 0.5]], "bow-tie"),
        (CROSSED, "crossing"),
        (HEXAGON[::-1], "crossing"),
    ],
)
def test_law_f4_shapes_of_known_faces(
    outline: list[list[float]], shape: str, curvature: float
) -> None:
    face = one_face(outline, curvature)
    assert face_shapes(face).tolist() == [shape]
    turned = SphereMesh(
        Mesh(face.mesh.vertices, [f[::-1] for f in face.mesh.faces]), -face.spheres
    )
    assert face_shapes(turned).tolist() == [shape]


def test_a_straight_corner_is_convex() -> None:
    assert face_shapes(one_face([[0, 0], [1, 0], [2, 0], [1, 1]])).tolist() == ["convex"]


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e6)])
def test_law_f4_shapes_do_not_depend_on_units_and_place(
    scale: float, shift: float, rotation: FloatArray
) -> None:
    for outline in (HEXAGON, BOW_TIE, CROSSED):
        face = one_face(outline)
        points = scale * face.mesh.vertices @ rotation.T + shift
        upwards = rotation[:, 2]
        row = touching_spheres(points[:1], upwards[None], np.zeros(1))
        moved = SphereMesh(Mesh(points, face.mesh.faces), row)
        np.testing.assert_array_equal(face_shapes(moved), face_shapes(face))


def test_law_f4_crossing_is_kept_by_mobius_maps(curved_grids: Grids) -> None:
    grid = curved_grids["torus"]
    rows = touching_spheres(grid.mesh.vertices, grid.normals, np.full(576, 1 / 0.5))
    dual = dual_sphere_mesh(grid.mesh, rows).sphere_mesh
    crosses = boundary_crosses(dual)
    assert 0 < crosses.sum() < dual.mesh.n_faces
    image = map_sphere_mesh(dual, inversion(np.array([6.0, 1.0, 4.0]), 5.0))
    np.testing.assert_array_equal(boundary_crosses(image), crosses)


@pytest.mark.parametrize(("name", "planes"), [("catenoid", "bow-tie"), ("ellipsoid", "convex")])
def test_law_f4_planes_are_convex_or_bow_ties_by_the_sign_of_curvature(
    name: str, planes: str, curved_grids: Grids
) -> None:
    grid = curved_grids[name]
    rows = touching_spheres(grid.mesh.vertices, grid.normals, np.zeros(408))
    shapes = face_shapes(dual_sphere_mesh(grid.mesh, rows).sphere_mesh)
    assert shapes.tolist() == 330 * [planes]


@pytest.mark.parametrize("name", ["catenoid", "ellipsoid", "torus"])
def test_law_f5_empty_spheres_give_convex_faces_and_central_ones_bow_ties(
    name: str, curved_grids: Grids
) -> None:
    grid = curved_grids[name]
    first = np.maximum(grid.around, grid.across)
    second = np.minimum(grid.around, grid.across)
    points = grid.mesh.vertices
    small = np.full(len(points), 1 / 0.3)
    central = (first + second) / 2
    assert (pencil_positions(small, first, second) == PencilPosition.EMPTY).all()
    assert (pencil_positions(central, first, second) == PencilPosition.CENTRAL).all()
    for curvatures, shape in ((small, "convex"), (central, "bow-tie")):
        rows = touching_spheres(points, grid.normals, curvatures)
        dual = dual_sphere_mesh(grid.mesh, rows)
        assert dual.left_out == ()
        assert (face_shapes(dual.sphere_mesh) == shape).all()
    np.testing.assert_allclose(
        mean_curvature_spheres(points, grid.normals, first, second),
        touching_spheres(points, grid.normals, central),
    )


def test_law_f5_positions_along_the_pencil() -> None:
    first, second = np.full(6, 2.0), np.full(6, -1.0)
    curvatures = np.array([5.0, 2.0, 0.5, 0.0, -1.0, -3.0])
    empty, principal, central = PencilPosition
    expected = [empty, principal, central, central, principal, empty]
    assert pencil_positions(curvatures, first, second).tolist() == expected
    # turning the normal over changes all signs and exchanges the principal curvatures
    assert pencil_positions(-curvatures, -second, -first).tolist() == expected
    for scale in (1e-3, 1e3):
        scaled = pencil_positions(scale * curvatures, scale * first, scale * second)
        assert scaled.tolist() == expected
