"""Quads and triangles on regions of the plane cover them once and keep their boundary."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.surfaces.planar_grids import (
    PlanarMesh,
    disc_on_boundary,
    fan_on_sides,
    grid_on_sides,
)
from spheremesh.kernel.surfaces.planar_triangles import inside_loops, triangulate_region

SEEDS = st.integers(0, 2**32 - 1)


def area(points: FloatArray) -> float:
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def check(found: PlanarMesh | None, rim: FloatArray, expected: float) -> PlanarMesh:
    """The rim comes first and is the boundary, every face is positive, the area is right."""
    assert found is not None
    assert np.array_equal(found.points[: len(rim)], rim)
    areas = np.array([area(found.points[face]) for face in found.faces])
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(expected, rel=1e-9)
    edges = {
        (int(a), int(b)) for f in found.faces for a, b in zip(f, np.roll(f, -1), strict=True)
    }
    assert len(edges) == found.faces.size
    alone = {edge for edge in edges if edge[::-1] not in edges}
    assert {vertex for edge in alone for vertex in edge} == set(range(len(rim)))
    assert set(found.faces.ravel()) == set(range(len(found.points)))
    return found


def polygon_sides(corners: FloatArray, counts: list[int]) -> list[FloatArray]:
    return [
        a + np.linspace(0, 1, count + 1)[:, None] * (b - a)
        for a, b, count in zip(corners, np.roll(corners, -1, 0), counts, strict=True)
    ]


def rim_of(sides: list[FloatArray]) -> FloatArray:
    return np.concatenate([side[:-1] for side in sides])


@given(SEEDS, st.integers(1, 6), st.integers(1, 6))
def test_a_grid_fills_any_convex_quad(seed: int, n: int, m: int) -> None:
    rng = np.random.default_rng(seed)
    corners = np.array([[0.0, 0], [4, 0], [4, 3], [0, 3]]) + rng.uniform(-1, 1, (4, 2))
    sides = polygon_sides(corners, [n, m, n, m])
    found = check(grid_on_sides(sides), rim_of(sides), area(corners))
    assert len(found.faces) == n * m


@given(st.integers(3, 8), st.integers(1, 5))
def test_a_fan_fills_regular_polygons(n_sides: int, half: int) -> None:
    turns = 2 * np.pi * np.arange(n_sides) / n_sides
    corners = np.stack([np.cos(turns), np.sin(turns)], 1)
    sides = polygon_sides(corners, [2 * half] * n_sides)
    found = check(fan_on_sides(sides), rim_of(sides), area(corners))
    assert len(found.faces) == n_sides * half**2


@given(st.integers(1, 16), st.floats(0.3, 1), st.floats(0, 6))
def test_a_disc_has_a_square_in_its_middle(quarter: int, flatness: float, start: float) -> None:
    turns = start + 2 * np.pi * np.arange(4 * quarter) / (4 * quarter)
    rim = np.stack([np.cos(turns), flatness * np.sin(turns)], 1)
    found = check(disc_on_boundary(rim), rim, area(rim))
    assert len(found.faces) >= quarter**2 + 4 * quarter


def test_a_grid_that_would_fold_is_none() -> None:
    corners = np.array([[0.0, 0], [3, 1], [0.5, 0.5], [1, 3]])
    assert grid_on_sides(polygon_sides(corners, [8] * 4)) is None


@given(SEEDS, st.integers(5, 40), st.floats(0.05, 2))
@settings(deadline=None)
def test_triangles_fill_any_star(seed: int, count: int, spacing: float) -> None:
    """Edges of very different lengths, thin spikes, segments that Delaunay lacks."""
    rng = np.random.default_rng(seed)
    turns = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.8, count)) / count
    rim = rng.uniform(0.05, 1, count)[:, None] * np.stack([np.cos(turns), np.sin(turns)], 1)
    check(triangulate_region([rim], spacing), rim, area(rim))


@given(SEEDS, st.floats(0.1, 0.6))
@settings(max_examples=20, deadline=None)
def test_holes_stay_open(seed: int, spacing: float) -> None:
    rng = np.random.default_rng(seed)
    outer = rim_of(
        polygon_sides(np.array([[0.0, 0], [4, 0], [4, 3], [0, 3]]), [20, 15, 20, 15])
    )
    holes = []
    for center in ((1, 1), (3, 1), (2, 2)):
        turns = 2 * np.pi * np.arange(12) / 12
        radius = rng.uniform(0.05, 0.45)
        holes.append(center + radius * np.stack([np.cos(turns), np.sin(turns)], 1))
    expected = area(outer) - sum(map(area, holes))
    loops = [outer, *holes]
    found = check(triangulate_region(loops, spacing), np.concatenate(loops), expected)
    middles = found.points[found.faces].mean(1)
    assert inside_loops(loops, middles).all()


def test_boundaries_that_cross_or_touch_are_refused() -> None:
    eight = np.array([[0.0, 0], [2, 2], [2, 0], [0, 2]])
    with pytest.raises(InputError, match=r"crosses itself|touches itself"):
        triangulate_region([eight], 0.5)
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    with pytest.raises(InputError, match="touches itself"):
        triangulate_region([square, np.add(square, (0.5, 0))], 0.5)
    with pytest.raises(InputError, match="no area"):
        triangulate_region([np.array([[0.0, 0], [1, 0], [2, 0], [1, 0]])], 5.0)
