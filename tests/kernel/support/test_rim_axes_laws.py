"""Laws of node axes along the boundary: flat beams, or all as it was."""

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm, unit
from spheremesh.kernel.support.rim_axes import rim_axes
from spheremesh.kernel.tolerances import RIM_LEAN

SEEDS = st.integers(0, 10_000)


class Rim(NamedTuple):
    """A mesh, the axes given at its nodes, and the only plane of each node."""

    mesh: Mesh
    directions: FloatArray
    planes: FloatArray


def roof(seed: int, noise: float) -> Rim:
    """A grid with four corners; at the sides a plane across, turned at random by `noise`."""
    u, v = (g.ravel() for g in np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij"))
    ids = np.arange(30).reshape(6, 5)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    points = np.stack([u, v, -0.05 * (u - 2) ** 2 - 0.04 * (v - 2) ** 2], 1)
    on_u, on_v = np.isin(u, [0, 5]), np.isin(v, [0, 4])
    across = np.stack([on_v, on_u, 0 * u], 1).astype(float)
    across[on_u & on_v] = 0
    across[~on_u & ~on_v] = np.nan
    return _rim(Mesh(points, quads.reshape(-1, 4)), across, seed, noise)


def ring(seed: int, noise: float, count: int = 9) -> Rim:
    """A fan with a boundary that has no corner; its planes contain the middle, nearly."""
    turns = 2 * np.pi * np.arange(count) / count
    rim = np.stack([np.cos(turns), np.sin(turns), -0.2 + 0.05 * np.cos(3 * turns)], 1)
    steps = np.arange(count)
    faces = np.stack([0 * steps, 1 + steps, 1 + (steps + 1) % count], 1)
    across = np.stack([-np.sin(turns), np.cos(turns), 0 * turns], 1)
    middle = np.full((1, 3), np.nan)
    points = np.concatenate([np.zeros((1, 3)), rim])
    return _rim(Mesh(points, faces), np.concatenate([middle, across]), seed, noise)


def _rim(mesh: Mesh, across: FloatArray, seed: int, noise: float) -> Rim:
    rng = np.random.default_rng(seed)
    is_given = across.any(axis=1)[:, None]
    planes = np.where(is_given, across + noise * rng.normal(size=across.shape), 0.0)
    planes = np.where(is_given, unit(planes), 0.0)
    up = unit(np.array([0, 0, -1.0]) + 0.1 * rng.normal(size=across.shape))
    within = up - np.where(np.isnan(planes), 0.0, dot(up, planes)[:, None] * planes)
    return Rim(mesh, unit(within), planes)


def beside(mesh: Mesh) -> IntArray:
    """Edges of the boundary as pairs of vertices."""
    outer = np.flatnonzero(mesh.topology.twins < 0)
    return np.stack([mesh.corners[outer], mesh.corners[mesh.topology.next_corners[outer]]], 1)


def bends(rim: Rim, axes: FloatArray) -> FloatArray:
    """Sines of the angles by which beams of the boundary are not flat."""
    first, second = beside(rim.mesh).T
    along = unit(rim.mesh.vertices[second] - rim.mesh.vertices[first])
    return np.abs(dot(np.cross(axes[first], axes[second]), along))


def leans(rim: Rim, axes: FloatArray) -> FloatArray:
    return 2 * np.arcsin(norm(axes - rim.directions) / 2)


@given(SEEDS)
def test_beams_of_sides_are_flat(seed: int) -> None:
    rim = roof(seed, 0.02)
    axes = rim_axes(*rim)
    np.testing.assert_allclose(norm(axes), 1, atol=1e-12)
    is_side = rim.planes.any(axis=1) & ~np.isnan(rim.planes[:, 0])
    assert np.abs(dot(axes, rim.planes)[is_side]).max() < 1e-12
    is_bent = bends(rim, axes) > 1e-12
    assert is_bent.mean() < 0.3
    # A side or a corner that would lean too far stays as it was.
    stays = (axes == rim.directions).all(axis=1)
    assert stays[beside(rim.mesh)[is_bent]].any(axis=1).all()
    assert bends(rim, rim.directions).max() > 1e-3
    assert leans(rim, axes).max() <= RIM_LEAN
    inside = np.isnan(rim.planes[:, 0])
    np.testing.assert_array_equal(axes[inside], rim.directions[inside])


@given(SEEDS)
def test_no_other_choice_leans_less(seed: int) -> None:
    rim = roof(seed, 0.02)
    axes = rim_axes(*rim)
    side = np.array([5, 10, 15, 20])  # v = 0, between the corners
    worst = leans(rim, axes)[side].max()
    for turn in np.linspace(-0.3, 0.3, 601):
        start = rim.directions[side[0]]
        across = np.cross(rim.planes[side[0]], start)
        axis, largest = np.cos(turn) * start + np.sin(turn) * across, abs(turn)
        for here, ahead in pairwise(side):
            edge = rim.mesh.vertices[ahead] - rim.mesh.vertices[here]
            axis = unit(np.cross(rim.planes[ahead], np.cross(edge, axis)))
            axis = axis * np.sign(dot(axis, rim.directions[ahead]))
            largest = max(largest, float(norm(np.cross(axis, rim.directions[ahead]))))
        # One step of the finer of the two scans, and a sine for an angle.
        assert np.sin(worst) <= largest + 2e-4


@given(SEEDS, st.sampled_from([0.01, 0.1, 0.5]))
@settings(max_examples=120)
def test_a_ring_is_flat_or_no_axes_fit(seed: int, noise: float) -> None:
    rim = ring(seed, noise)
    axes = rim_axes(*rim)
    np.testing.assert_array_equal(axes[0], rim.directions[0])
    if not np.array_equal(axes, rim.directions):
        assert bends(rim, axes).max() < 1e-9
        assert leans(rim, axes).max() <= RIM_LEAN
        return
    # Nothing was found: whatever the first axis is, the last leads elsewhere or some lean.
    turns = np.linspace(-RIM_LEAN, RIM_LEAN, 2001)
    ends, largest = followed(rim, turns)
    closes = np.sign(ends - turns)[1:] != np.sign(ends - turns)[:-1]
    small = largest < 0.98 * RIM_LEAN
    assert not (closes & small[1:] & small[:-1]).any()


def followed(rim: Rim, turns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where first axes that turn by so much lead around the ring, and the largest turns."""
    nodes = np.arange(1, rim.mesh.n_vertices)
    found, largest = turns, np.abs(turns)
    for here, ahead in zip(nodes, np.roll(nodes, -1), strict=True):
        edge = rim.mesh.vertices[ahead] - rim.mesh.vertices[here]
        across = np.cross(rim.planes[[here, ahead]], rim.directions[[here, ahead]])
        axis = (
            np.cos(found)[:, None] * rim.directions[here] + np.sin(found)[:, None] * across[0]
        )
        axis = np.cross(rim.planes[ahead], np.cross(edge, axis))
        found = np.arctan(dot(axis, across[1]) / dot(axis, rim.directions[ahead]))
        largest = np.maximum(largest, np.abs(found))
    return found, largest


def test_both_outcomes_of_a_ring_occur() -> None:
    kept = [
        np.array_equal(rim_axes(*rim), rim.directions)
        for rim in (ring(seed, 0.05) for seed in range(40))
    ]
    assert 0 < sum(kept) < 40


def test_axes_through_one_point_are_found() -> None:
    """Axes that meet in a point are flat around any boundary; planes through them keep it."""
    rim = ring(0, 0.0)
    apex = np.array([0.1, 0.05, -3.0])
    through = unit(apex - rim.mesh.vertices)
    rng = np.random.default_rng(5)
    planes = unit(np.cross(through, np.cross([0, 0, 1.0], through) + 0.5 * rng.normal(size=3)))
    planes[0] = np.nan
    turn = np.radians(8)
    turned = np.cos(turn) * through + np.sin(turn) * np.cross(planes, through)
    turned[0] = through[0]
    axes = rim_axes(rim.mesh, turned, planes)
    start = Rim(rim.mesh, turned, planes)
    assert bends(start, axes).max() < 1e-9
    # The other solution may lean less; both are flat.
    assert leans(start, axes).max() <= turn + 1e-9


@given(SEEDS, st.integers(5, 12))
def test_a_ring_that_all_axes_fit_takes_those_that_lean_least(seed: int, count: int) -> None:
    """Planes through a common line: axes fit that go through any one point of it."""
    rim = ring(seed, 0.0, count)
    axes = rim_axes(*rim)
    assert bends(rim, axes).max() < 1e-9
    heights = np.linspace(-60, 60, 4001)
    through = unit(np.array([0, 0, 1.0]) * heights[:, None, None] - rim.mesh.vertices[1:])
    cosines = np.abs(dot(through, rim.directions[1:])).min(axis=1)
    assert leans(rim, axes).max() < np.arccos(cosines.max()) + 1e-9
    far = Mesh(rim.mesh.vertices + np.array([6e5, -6.4e5, 4.8e5]), rim.mesh.faces)
    np.testing.assert_allclose(rim_axes(far, rim.directions, rim.planes), axes, atol=1e-6)


def test_a_side_that_would_lean_too_far_stays() -> None:
    rim = roof(3, 0.02)
    side = np.array([5, 10, 15, 20])
    planes = rim.planes.copy()
    # Planes nearly along the boundary: to be flat, axes would have to lie down.
    planes[side] = unit(planes[side] * 0.05 + np.array([0, 1.0, -0.3]))
    planes[side[::2]] = unit(planes[side[::2]] * [1, 1, -1])
    up = np.array([0, 0, -1.0])
    directions = rim.directions.copy()
    directions[side] = unit(up - dot(np.tile(up, (4, 1)), planes[side])[:, None] * planes[side])
    axes = rim_axes(rim.mesh, directions, planes)
    np.testing.assert_array_equal(axes[side], directions[side])
    others = rim.planes.any(axis=1) & ~np.isnan(rim.planes[:, 0])
    others[side] = False
    on_others = others[beside(rim.mesh)].all(axis=1)
    assert bends(Rim(rim.mesh, directions, planes), axes)[on_others].max() < 1e-12


def test_a_corner_whose_beams_are_in_one_plane_keeps_its_axis() -> None:
    rim = roof(1, 0.0)
    flat = Mesh(rim.mesh.vertices * [1, 1, 0], [list(face) for face in rim.mesh.faces])
    # Drawn out to a point at the first vertex, so that both its edges lie in one line.
    points = flat.vertices.copy()
    points[0] = (points[1] + points[5]) / 2
    straight = Mesh(points, [list(face) for face in rim.mesh.faces])
    up = np.tile([0, 0, -1.0], (len(points), 1))
    axes = rim_axes(
        straight, up, np.where(np.isnan(rim.planes), np.nan, rim.planes * [1, 1, 0])
    )
    np.testing.assert_allclose(axes[0], up[0], atol=1e-12)


@given(SEEDS, st.floats(-3, 3), st.sampled_from([roof, ring]))
def test_nothing_depends_on_scale_place_and_turn(
    seed: int, exponent: float, make: Callable[[int, float], Rim]
) -> None:
    rim = make(seed, 0.02)
    matrix = Rotation.random(random_state=seed).as_matrix()
    shift = 1e3 * np.array([1.0, -2.0, 0.5])
    points = 10**exponent * (rim.mesh.vertices @ matrix.T + shift)
    mesh = Mesh(points, [list(face) for face in rim.mesh.faces])
    moved = rim_axes(mesh, rim.directions @ matrix.T, rim.planes @ matrix.T)
    np.testing.assert_allclose(moved, rim_axes(*rim) @ matrix.T, atol=1e-8)


@given(SEEDS, st.sampled_from([roof, ring]))
def test_nothing_depends_on_the_numbering(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
    seed: int,
    make: Callable[[int, float], Rim],
) -> None:
    rim = make(seed, 0.02)
    mesh, _ = renumber(rim.mesh)
    order = places(mesh, rim.mesh)
    found = rim_axes(mesh, rim.directions[order], rim.planes[order])
    np.testing.assert_allclose(found, rim_axes(*rim)[order], atol=1e-9)


def places(mesh: Mesh, other: Mesh) -> IntArray:
    """For each vertex the one of the other mesh at the same point."""
    away = norm(mesh.vertices[:, None] - other.vertices[None])
    assert away.min(axis=1).max() == pytest.approx(0, abs=1e-12)
    return away.argmin(axis=1)


@pytest.mark.parametrize("make", [roof, ring])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_sides_with_an_edge_of_no_length_stay(make: Callable[[int, float], Rim]) -> None:
    mesh, directions, planes = make(1, 0.0)
    # Two neighbours along the boundary, away from the corners.
    first, second = (2, 3) if make is ring else (5, 10)
    points = mesh.vertices.copy()
    points[second] = points[first]
    found = rim_axes(Mesh(points, mesh.faces), directions, planes)
    np.testing.assert_array_equal(found[[first, second]], directions[[first, second]])
    assert np.isfinite(found).all()
