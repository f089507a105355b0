"""Tangent spheres that grow: bounds, aims, derivatives, and what must not matter."""

from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.hexagons.dual_sphere_mesh import dual_sphere_mesh
from spheremesh.kernel.hexagons.evolution import (
    Evolution,
    descend,
    evolve_best,
    evolve_spheres,
)
from spheremesh.kernel.hexagons.face_shapes import face_shapes
from spheremesh.kernel.hexagons.ortho_energy import axis_deviations, ortho_residuals
from spheremesh.kernel.hexagons.tangent_offsets import (
    CenterSide,
    grow_offsets,
    mesh_edges,
    tangent_surface,
)
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.spheres.incidence import evaluate, normals
from spheremesh.kernel.spheres.rows import center_radius
from spheremesh.kernel.surfaces.triangulated import triangulated_surface

Grids = dict[str, Any]
BOUND = np.radians(15.0)


@pytest.fixture(scope="session")
def evolutions(curved_grids: Grids) -> dict[str, Evolution]:
    return {name: evolve_spheres(grid.mesh) for name, grid in curved_grids.items()}


@pytest.mark.parametrize("name", ["catenoid", "ellipsoid", "torus"])
def test_law_f3_axes_keep_their_bound_and_faces_are_convex(
    name: str, evolutions: dict[str, Evolution], curved_grids: Grids
) -> None:
    found, mesh = evolutions[name], curved_grids[name].mesh
    assert found.converged
    assert found.axis_angles.max() < np.radians(15.5)
    dual = dual_sphere_mesh(found.mesh, found.spheres)
    assert dual.left_out == ()
    assert (face_shapes(dual.sphere_mesh) == "convex").all()
    np.testing.assert_array_equal(found.mesh.vertices, mesh.vertices)
    assert (found.offsets > 0).all()
    assert (found.offsets <= found.radii * (1 + 1e-12)).all()


def test_law_f3_spheres_touch_at_the_vertices_with_their_centers_at_the_offset(
    evolutions: dict[str, Evolution],
) -> None:
    for found in evolutions.values():
        points = found.mesh.vertices
        assert np.abs(evaluate(found.spheres, points)).max() < 1e-12
        upwards = normals(found.spheres, points)
        np.testing.assert_allclose(norm(upwards), 1, atol=1e-12)
        centers, square = center_radius(found.spheres)
        np.testing.assert_allclose(
            centers, points + (found.side * found.offsets)[:, None] * upwards, atol=1e-10
        )
        np.testing.assert_allclose(square, found.offsets**2, rtol=1e-9)


def test_law_f3_reported_angles_are_those_of_the_centers(
    evolutions: dict[str, Evolution],
) -> None:
    for found in evolutions.values():
        centers, _ = center_radius(found.spheres)
        triangles = found.mesh.corners.reshape(-1, 3)
        a, b, c = centers[triangles].transpose(1, 0, 2)
        axes = np.cross(b - a, c - a)
        upwards = normals(found.spheres, found.mesh.vertices)[triangles].sum(1)
        cosines = dot(axes, upwards) / norm(axes) / norm(upwards)
        np.testing.assert_allclose(np.cos(found.axis_angles), cosines, atol=1e-7)


def test_spheres_grow_far(evolutions: dict[str, Evolution]) -> None:
    shares = {name: (e.offsets / e.radii).mean() for name, e in evolutions.items()}
    assert shares["torus"] > 0.9
    assert shares["ellipsoid"] > 0.8
    assert shares["catenoid"] > 0.6
    # the exact radius of the tube is 0.8
    assert evolutions["torus"].offsets.min() > 0.8 * 0.8
    assert evolutions["torus"].offsets.max() < 0.8


def test_without_flips_spheres_stay_small_enough(curved_grids: Grids) -> None:
    for name in ("catenoid", "torus"):
        mesh = curved_grids[name].mesh
        found = evolve_spheres(mesh, BOUND, flips=False)
        np.testing.assert_array_equal(found.mesh.corners, mesh.corners)
        assert found.n_flips == 0
        assert found.converged
        dual = dual_sphere_mesh(found.mesh, found.spheres)
        assert (face_shapes(dual.sphere_mesh) == "convex").all()


@given(seed=st.integers(0, 10**6), bound=st.floats(0.02, 1.2))
def test_law_f3_derivatives_of_the_tilt(seed: int, bound: float) -> None:
    rng = np.random.default_rng(seed)
    points, upwards = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    upwards /= norm(upwards)[:, None]
    triangles = rng.permutation(9).reshape(3, 3)
    offsets, step = rng.uniform(0.5, 2, 9), 1e-6

    def _residuals(offsets: FloatArray) -> FloatArray:
        return ortho_residuals(points, upwards, triangles, offsets, bound)[0]

    residuals, slopes = ortho_residuals(points, upwards, triangles, offsets, bound)
    angles = axis_deviations(points, upwards, triangles, offsets)
    np.testing.assert_array_equal(residuals > 0, angles > bound)
    signed = np.cos(angles) * np.abs(np.cos(angles))
    expected = np.maximum(0, np.cos(bound) ** 2 - signed)
    np.testing.assert_allclose(residuals, expected, atol=1e-12)
    for corner in range(3):
        shift = np.zeros(9)
        shift[triangles[:, corner]] = step
        change = (_residuals(offsets + shift) - _residuals(offsets - shift)) / (2 * step)
        smooth = np.abs(angles - bound) > 1e-3
        size = 1 + np.abs(slopes[:, corner])
        assert (np.abs(change - slopes[:, corner]) / size)[smooth].max(initial=0) < 1e-4


def test_law_f3_descent_lowers_the_energy_to_a_point_of_rest(curved_grids: Grids) -> None:
    surface, _ = tangent_surface(curved_grids["ellipsoid"].mesh)
    aims = 0.95 * surface.radii
    start = grow_offsets(surface, aims, 1.2 * BOUND)
    first, steps, at_rest = descend(surface, start, aims, BOUND, 30.0)
    assert at_rest
    assert steps > 1
    second, again, _ = descend(surface, first, aims, BOUND, 30.0)
    assert again < steps
    np.testing.assert_allclose(first, second, rtol=0.02)


def test_law_grown_offsets_are_the_largest_of_bounded_slope(curved_grids: Grids) -> None:
    surface, _ = tangent_surface(curved_grids["ellipsoid"].mesh)
    aims = 0.95 * surface.radii
    offsets = grow_offsets(surface, aims, BOUND)
    assert (offsets <= aims + 1e-12).all()
    starts, ends = mesh_edges(surface.mesh)
    length = norm(surface.mesh.vertices[ends] - surface.mesh.vertices[starts])
    assert (np.abs(offsets[ends] - offsets[starts]) <= np.tan(BOUND) * length).all()
    assert (grow_offsets(surface, aims, 2 * BOUND) >= offsets - 1e-9).all()
    lower = aims.copy()
    lower[200] /= 3
    pulled = grow_offsets(surface, lower, BOUND)
    assert pulled[200] == pytest.approx(lower[200])
    assert (pulled <= offsets + 1e-9).all()
    assert (pulled < 0.9 * offsets).sum() > 1


def test_law_offsets_stop_short_of_where_centers_fall_together(curved_grids: Grids) -> None:
    """Whatever the estimated radii: centres around the tube of the torus meet at 0.8."""
    mesh = curved_grids["torus"].mesh
    surface, _ = tangent_surface(mesh)
    offsets = grow_offsets(surface, 3 * surface.radii, BOUND) * mean_edge_length(mesh)
    assert 0.7 < offsets.max() < 0.8


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e4)])
def test_law_evolution_does_not_depend_on_units_and_place(
    scale: float, shift: float, evolutions: dict[str, Evolution], curved_grids: Grids
) -> None:
    mesh, here = curved_grids["ellipsoid"].mesh, evolutions["ellipsoid"]
    moved = evolve_spheres(Mesh(scale * mesh.vertices + shift, mesh.faces))
    assert moved.converged
    assert moved.axis_angles.max() < np.radians(15.5)
    np.testing.assert_allclose(moved.offsets / scale, here.offsets, rtol=0.02)


def test_law_turning_the_faces_over_turns_the_spheres(
    evolutions: dict[str, Evolution], curved_grids: Grids
) -> None:
    mesh, here = curved_grids["torus"].mesh, evolutions["torus"]
    turned = evolve_spheres(Mesh(mesh.vertices, [face[::-1] for face in mesh.faces]))
    assert (here.side, turned.side) == (1, -1)
    np.testing.assert_allclose(turned.spheres, -here.spheres, atol=1e-6)


def test_sides(curved_grids: Grids) -> None:
    mesh = curved_grids["catenoid"].mesh
    found = {side: evolve_spheres(mesh, side=side) for side in get_args(CenterSide)}
    assert [found[side].side for side in ("auto", "plus", "minus")] == [1, 1, -1]
    for evolution in found.values():
        assert not evolution.is_outer.any()
        dual = dual_sphere_mesh(evolution.mesh, evolution.spheres)
        assert (face_shapes(dual.sphere_mesh) == "convex").all()
    dome = curved_grids["ellipsoid"].mesh
    assert evolve_spheres(dome, side="minus").is_outer.all()


def test_a_flat_sheet_gets_large_spheres() -> None:
    i, j = np.meshgrid(np.arange(8), np.arange(8), indexing="ij")
    points = np.stack([i + 0.5 * (j % 2), j * 0.75**0.5, 0 * i], -1).reshape(-1, 3)
    a = (i * 8 + j)[:-1, :-1]
    even = np.stack([a, a + 8, a + 1, a + 8, a + 9, a + 1], -1)
    odd = np.stack([a, a + 8, a + 9, a, a + 9, a + 1], -1)
    rows = (j % 2)[:-1, :-1, None]
    mesh = Mesh(points.astype(float), np.where(rows == 0, even, odd).reshape(-1, 3))
    found = evolve_spheres(mesh)
    assert found.converged
    assert not found.is_outer.any()
    assert found.axis_angles.max() < 1e-6
    assert found.offsets.min() > 5 * mean_edge_length(mesh)
    assert (
        face_shapes(dual_sphere_mesh(found.mesh, found.spheres).sphere_mesh) == "convex"
    ).all()


def test_an_impossible_bound_is_owned_up(curved_grids: Grids) -> None:
    found = evolve_spheres(curved_grids["torus"].mesh, np.radians(0.5))
    assert not found.converged
    assert found.axis_angles.max() > np.radians(0.75)


def test_bad_input_is_named(ball: Mesh, octahedron: Mesh) -> None:
    with pytest.raises(InputError, match="are no triangles"):
        evolve_spheres(ball)
    for angle in (0.0, -1.0, np.pi / 2, np.nan):
        with pytest.raises(InputError, match="between 0 and 90 degrees"):
            evolve_spheres(octahedron, angle)
    with pytest.raises(InputError, match="side must be"):
        evolve_spheres(octahedron, side="left")  # type: ignore[arg-type]
    lonely = Mesh(np.vstack([octahedron.vertices, [[9, 9, 9]]]), octahedron.faces)
    with pytest.raises(InputError, match=r"vertices \[6\] have no normal"):
        evolve_spheres(lonely)


def test_law_f3_a_looser_bound_never_gives_smaller_spheres() -> None:
    mesh, _ = triangulated_surface("waves", 0.2)
    shares: list[float] = []
    for bound in np.radians([3.0, 5.0, 12.0, 20.0]):
        found = evolve_best(mesh, bound, "plus")
        assert not found.converged or found.axis_angles.max() <= bound + np.radians(0.5)
        shares.append(float((found.offsets / found.radii).mean()))
    assert shares == sorted(shares)
