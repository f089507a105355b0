"""Three spheres meet in a mirror pair of points: the nearer one, and when there is none."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.congruences.discrete_envelopes import envelope
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.hexagons.vertex_rule import meet_three, triangle_points, vertex_rows
from spheremesh.kernel.meshes.mesh import face_centroids
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.kernel.spheres.rows import (
    center_radius,
    from_center_radius,
    from_plane,
    normalize,
)

SEEDS = st.integers(0, 10**6)


def random_spheres(seed: int, n: int = 40) -> FloatArray:
    """Triples that pass near the origin, of radii from 1 to 1e4."""
    rng = np.random.default_rng(seed)
    radii = 10 ** rng.uniform(0, 4, (n, 3))
    away = rng.normal(size=(n, 3, 3))
    away /= norm(away)[..., None]
    centers = (radii + rng.uniform(-0.3, 0.3, radii.shape))[..., None] * away
    return normalize(from_center_radius(centers, radii**2))


@given(SEEDS)
def test_law_f1_points_lie_on_three_spheres_and_mirror_in_the_plane_of_centers(
    seed: int,
) -> None:
    rows = random_spheres(seed)
    points, is_real = meet_three(rows)
    distances = np.abs(signed_distance(rows[is_real], points[is_real][:, None]))
    assert distances.max(initial=0) < 1e-10
    centers, square = center_radius(rows)
    axis = np.cross(centers[:, 1] - centers[:, 0], centers[:, 2] - centers[:, 0])
    axis /= norm(axis)[:, None]
    height = ((points - centers[:, 0]) * axis).sum(1)
    mirrored = points - 2 * height[:, None] * axis
    small = is_real & (square.max(1) < 1e4)
    assert np.abs(signed_distance(rows[small], mirrored[small][:, None])).max(initial=0) < 1e-6
    assert (norm(points) <= norm(mirrored) * (1 + 1e-9))[is_real].all()


@given(SEEDS)
def test_law_f1_orientation_and_order_play_no_part(seed: int) -> None:
    rows = random_spheres(seed)
    rng = np.random.default_rng(seed)
    points, is_real = meet_three(rows)
    turned = rows[:, rng.permutation(3)] * rng.choice([-1.0, 1.0], (len(rows), 3, 1))
    again, still = meet_three(turned)
    np.testing.assert_array_equal(is_real, still)
    np.testing.assert_allclose(points[is_real], again[is_real], atol=1e-8)


def test_law_f1_nearest_is_the_lower_side_of_the_plane_of_centers(
    curved_grids: dict[str, Any],
) -> None:
    mesh, upwards = curved_grids["torus"].mesh, curved_grids["torus"].normals
    rows = touching_spheres(mesh.vertices, upwards, np.full(len(upwards), 1 / 0.4))
    points, is_real = triangle_points(mesh, vertex_rows(mesh, rows))
    points = points + face_centroids(mesh)
    nearest, oriented = envelope(mesh, rows), envelope(mesh, rows, "oriented")
    np.testing.assert_array_equal(is_real, nearest.is_real)
    assert is_real.all()
    np.testing.assert_allclose(points, nearest.points_plus, atol=1e-12)
    lower = np.minimum(
        norm(points - oriented.points_plus), norm(points - oriented.points_minus)
    )
    assert lower.max() < 1e-12
    same = norm(points - oriented.points_plus) < norm(points - oriented.points_minus)
    assert same.all() or not same.any()


def test_planes_and_nearly_planes_meet_alike() -> None:
    normals = np.array([[0.1, 0, 1], [-0.1, 0.1, 1], [0, -0.1, 1]])
    normals /= norm(normals)[:, None]
    corner = np.array([0.3, -0.2, 0.1])
    planes = from_plane(normals, normals @ corner)
    for radius in (np.inf, 1e12, 1e6, 1e3):
        rows = touching_spheres(np.tile(corner, (3, 1)), normals, np.full(3, 1 / radius))
        points, is_real = meet_three(rows[None])
        assert is_real.all()
        np.testing.assert_allclose(points[0], corner, atol=1e-13)
    np.testing.assert_allclose(meet_three(planes[None])[0][0], corner, atol=1e-14)


def test_spheres_that_do_not_meet_are_told() -> None:
    apart = from_center_radius(np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0]]), np.ones(3))
    same = np.tile(from_center_radius(np.zeros(3), np.array(1.0)), (3, 1))
    in_line = from_center_radius(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.ones(3))
    parallel = from_plane(np.tile([0.0, 0, 1], (3, 1)), np.arange(3.0))
    for rows in (apart, same, in_line, parallel):
        points, is_real = meet_three(normalize(rows)[None])
        assert not is_real.any()
        assert np.isfinite(points).all()
    center = meet_three(normalize(apart)[None])[0][0]
    np.testing.assert_allclose(center, [1.5, 1.5, 0], atol=1e-12)


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e6)])
def test_law_points_do_not_depend_on_units_and_place(
    scale: float, shift: float, curved_grids: dict[str, Any]
) -> None:
    mesh, upwards = curved_grids["torus"].mesh, curved_grids["torus"].normals
    moved = Mesh(scale * mesh.vertices + shift, mesh.faces)

    def _points(mesh: Mesh, offset: float) -> FloatArray:
        rows = touching_spheres(mesh.vertices, upwards, np.full(len(upwards), 1 / offset))
        return triangle_points(mesh, vertex_rows(mesh, rows))[0]

    there, here = _points(moved, 0.4 * scale), _points(mesh, 0.4)
    np.testing.assert_allclose(there / scale, here, atol=1e-8 if shift else 1e-13)


def test_bad_rows_are_named(octahedron: Mesh) -> None:
    rows = touching_spheres(octahedron.vertices, octahedron.vertices, -np.ones(6))
    with pytest.raises(InputError, match=r"shape \(6, 5\), not \(5, 5\)"):
        vertex_rows(octahedron, rows[:5])
    rows[2] = np.nan
    with pytest.raises(InputError, match=r"vertices \[2\] are not finite"):
        vertex_rows(octahedron, rows)
    rows[2] = from_center_radius(np.zeros(3), np.array(-1.0))
    with pytest.raises(InputError, match=r"vertices \[2\] are imaginary or points"):
        vertex_rows(octahedron, rows)
