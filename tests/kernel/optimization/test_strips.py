"""Strips along a net or along a direction in space."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import IntArray, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.strips import strip_weights, strip_weights_along
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles
from spheremesh.kernel.spheres.rows import center_radius
from spheremesh.nodes import strip_weights as strip_weights_node
from spheremesh.nodes import vase_mesh


def edge_ids(mesh: Mesh, weights: np.ndarray) -> set[frozenset[int]]:
    ends = mesh.topology.edge_vertices[weights > 0]
    return {frozenset(map(int, pair)) for pair in ends}


def test_law_d12_strips_around_a_vase_are_smooth_and_centred_on_its_axis() -> None:
    mesh = vase_mesh(15, 12)
    weights = strip_weights(mesh, "first")
    assert weights.sum() == 15 * 12
    found, _ = minimize_angles(face_planes(mesh), edge_weights=weights)
    angles = np.degrees(intersection_angles(found))
    assert angles[weights > 0].max() < 1e-9
    assert angles[weights == 0].mean() > 1
    centers, _ = center_radius(found.spheres)
    np.testing.assert_allclose(centers[:, :2], 0, atol=1e-9)


def test_the_two_families_share_the_edges() -> None:
    mesh = vase_mesh(9, 6)
    both = strip_weights(mesh, "first") + strip_weights(mesh, "second")
    np.testing.assert_array_equal(both, 1)


def test_numbering_changes_no_strip(renumber: Callable[[Mesh], tuple[Mesh, IntArray]]) -> None:
    mesh = vase_mesh(9, 6)
    shuffled, _ = renumber(mesh)
    up = np.array([0.0, 0, 1])
    assert strip_weights_along(shuffled, up).sum() == strip_weights_along(mesh, up).sum() == 45
    found = {int(strip_weights(shuffled, family).sum()) for family in ("first", "second")}
    assert found == {9 * 6, 9 * 5}


def test_a_direction_in_space_selects_what_crosses_it() -> None:
    mesh = vase_mesh(9, 6)
    level = strip_weights_along(mesh, np.array([0.0, 0, 2]))
    np.testing.assert_array_equal(level, strip_weights(mesh, "second"))
    centroids = np.array([mesh.vertices[face].mean(axis=0) for face in mesh.faces])
    around = unit(np.cross([0, 0, 1], centroids))
    np.testing.assert_array_equal(
        strip_weights_along(mesh, around), strip_weights(mesh, "first")
    )
    # A field of lines has no sign.
    around[::2] *= -1
    np.testing.assert_array_equal(
        strip_weights_along(mesh, around), strip_weights(mesh, "first")
    )


def corner_of_a_cube() -> Mesh:
    points = [[1, 1, 1], [0, 1, 1], [1, 0, 1], [1, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0]]
    return Mesh(points, [[0, 1, 4, 2], [0, 2, 5, 3], [0, 3, 6, 1]])


def test_directions_that_change_places_are_named() -> None:
    with pytest.raises(InputError, match=r"faces \[0, 1, 2\] change places"):
        strip_weights(corner_of_a_cube(), "first")
    assert strip_weights_along(corner_of_a_cube(), np.array([1.0, 0, 0])).sum() == 2


def test_faces_that_are_no_quadrilaterals_belong_to_no_strip() -> None:
    mesh = Mesh(
        [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [0, 1, 0], [3, 0.5, 0]],
        [[0, 1, 4, 5], [1, 2, 3, 4], [2, 6, 3]],
    )
    assert edge_ids(mesh, strip_weights(mesh, "first")) == {frozenset({1, 4})}
    assert not strip_weights(mesh, "second").any()
    with pytest.raises(InputError, match="the mesh has none"):
        strip_weights(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), "first")


@pytest.mark.parametrize(
    ("direction", "message"),
    [
        (np.zeros(3), "zero or not finite"),
        (np.array([1.0, np.nan, 0]), "zero or not finite"),
        (np.ones(2), "must be int or vector"),
        (2, "directions 0 and 1, not 2"),
    ],
)
def test_bad_directions(direction: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        strip_weights_node(vase_mesh(5, 3), direction)
