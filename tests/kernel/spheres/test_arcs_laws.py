"""Laws of arcs (B3) and of the areas that they bound."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.spheres.arcs import (
    Arcs,
    arc_circles,
    arc_lengths,
    arc_points,
    patch_areas,
    sphere_arcs,
)
from spheremesh.kernel.spheres.circles import Circles, circle_pencils, pencil_spheres
from spheremesh.kernel.spheres.incidence import evaluate, normals, project
from spheremesh.kernel.spheres.rows import recenter

TAU = np.linspace(-1, 1, 9)
UNIT_SPHERE = np.array([-0.5, 0, 0, 0, 0.5])
"""The unit sphere about the origin, N outwards."""

POINTS = arrays(float, 3, elements=st.floats(-4, 4))
CURVATURES = st.floats(-0.5, 0.5) | st.sampled_from([0.0, 1e-9, -1e-9])


@st.composite
def directions(draw: st.DrawFn) -> FloatArray:
    vector = draw(POINTS)
    length = norm(vector)
    assume(length > 0.1)
    return vector / length


@st.composite
def arcs_on_spheres(draw: st.DrawFn) -> tuple[FloatArray, FloatArray, Arcs]:
    """A sphere or plane, an upright or tilted cutting plane, and an arc of both."""
    a, n = draw(CURVATURES), draw(directions())
    row = recenter(np.array([a, *n, 0.0]), -draw(POINTS))
    middle = project(row, draw(POINTS))
    up = normals(row, middle)
    side = np.cross(up, draw(directions()))
    assume(norm(side) > 0.2)
    length, tilt = draw(st.floats(0.05, 0.6)), draw(st.floats(-1.0, 1.0))
    ends = [project(row, middle + s * length * unit(side)) for s in (-1, 1)]
    chord = unit(ends[1] - ends[0])
    inward = unit(np.cross(normals(row, (ends[0] + ends[1]) / 2), chord))
    plane = np.cos(tilt) * inward + np.sin(tilt) * np.cross(chord, inward)
    found = sphere_arcs(row[None], plane[None], ends[0][None], ends[1][None])
    return row, plane, found


def polygon_area(
    row: FloatArray, corners: FloatArray, plane_normals: FloatArray, *, shift: bool = True
) -> float:
    """Area of one patch, computed in coordinates near it."""
    origin = corners.mean(0) if shift else np.zeros(3)
    near, local = recenter(row, origin), corners - origin
    ids = np.zeros(len(corners), np.int64)
    arcs = sphere_arcs(near[None][ids], plane_normals, local, np.roll(local, -1, axis=0))
    return float(patch_areas(near[None], arcs, ids)[0])


def great_planes(corners: FloatArray) -> FloatArray:
    """Planes through the centre of the unit sphere, normals to the left."""
    return unit(np.cross(corners, np.roll(corners, -1, axis=0)))


# B3


@given(case=arcs_on_spheres())
def test_law_b3_arcs_lie_on_sphere_and_plane(case: tuple[FloatArray, FloatArray, Arcs]) -> None:
    row, plane, arcs = case
    points = arc_points(arcs, TAU)[0]
    np.testing.assert_allclose(points[0], arcs.starts[0], atol=1e-14)
    np.testing.assert_allclose(points[-1], arcs.ends[0], atol=1e-14)
    np.testing.assert_allclose(evaluate(row, points), 0, atol=1e-10)
    np.testing.assert_allclose((points - arcs.starts[0]) @ plane, 0, atol=1e-12)
    summit = (arcs.starts + arcs.ends)[0] / 2 + arcs.sagittas[0] * arcs.rises[0]
    np.testing.assert_allclose(points[4], summit, atol=1e-14)


@given(case=arcs_on_spheres())
def test_law_b3_arcs_are_the_shorter_ones(case: tuple[FloatArray, FloatArray, Arcs]) -> None:
    _, plane, arcs = case
    half = norm(arcs.ends - arcs.starts)[0] / 2
    assert abs(arcs.sagittas[0]) <= half
    assert norm(arcs.rises)[0] == pytest.approx(1, abs=1e-12)
    assert abs(arcs.rises[0] @ plane) < 1e-12
    assert abs(arcs.rises[0] @ (arcs.ends - arcs.starts)[0]) < 1e-12


@given(case=arcs_on_spheres())
def test_law_b3_circles_run_from_start_to_end(
    case: tuple[FloatArray, FloatArray, Arcs],
) -> None:
    row, plane, arcs = case
    assume(abs(row[0]) > 1e-3)
    assume(abs(arcs.sagittas[0]) > 1e-6)
    circle = arc_circles(arcs)
    center, axis, sweep = circle.centers[0], circle.axes[0], circle.sweeps[0]
    radius, half = circle.radii[0], norm(arcs.ends - arcs.starts)[0] / 2
    assert 0 < sweep <= np.pi
    assert abs(abs(axis @ plane) - 1) < 1e-12
    tolerance = 1e-9 * (1 + radius)
    turn = Rotation.from_rotvec([axis * sweep * share for share in (0.5, 1.0)])
    middle, end = center + turn.apply(arcs.starts[0] - center)
    np.testing.assert_allclose(end, arcs.ends[0], atol=tolerance)
    np.testing.assert_allclose(middle, arc_points(arcs, TAU)[0, 4], atol=tolerance)
    np.testing.assert_allclose(norm(arcs.starts[0] - center), radius, rtol=1e-8)
    np.testing.assert_allclose(arc_lengths(arcs)[0], radius * sweep, rtol=1e-8)
    np.testing.assert_allclose(np.tan(sweep / 4), abs(arcs.sagittas[0]) / half, rtol=1e-10)


@pytest.mark.parametrize("radius", [0.5001, 1.0, 30.0, 1e4, 1e9])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_law_b3_sagitta_and_length_of_great_circles(radius: float, sign: float) -> None:
    """A chord of length 1; N is z at its middle, the arc rises where the sphere curves down."""
    h = 0.5
    depth = h**2 / (radius + np.sqrt(radius**2 - h**2))
    row = recenter(np.array([sign * 0.5 / radius, 0, 0, 1, 0]), np.array([0, 0, sign * depth]))
    starts, ends = np.array([[-h, 0, 0]]), np.array([[h, 0, 0]])
    arcs = sphere_arcs(row[None], np.array([[0, 1.0, 0]]), starts, ends)
    np.testing.assert_allclose(arcs.rises, [[0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(arcs.sagittas, -sign * depth, rtol=1e-10)
    expected = 2 * radius * np.arcsin(h / radius)
    np.testing.assert_allclose(arc_lengths(arcs), expected, rtol=1e-10)
    circle = arc_circles(arcs)
    np.testing.assert_allclose(circle.radii, radius, rtol=1e-10)
    np.testing.assert_allclose(circle.axes, [[0, -sign, 0]], atol=1e-15)


def test_straight_edges() -> None:
    plane = np.array([[0, 0, 0, 1.0, 2.0]])
    starts, ends = np.array([[0, 0, 2.0]]), np.array([[3, 4, 2.0]])
    arcs = sphere_arcs(plane, unit(np.array([[-4.0, 3, 1]])), starts, ends)
    assert arcs.sagittas[0] == 0
    assert arc_lengths(arcs)[0] == 5
    np.testing.assert_allclose(arc_points(arcs, np.array([0.0]))[0, 0], [1.5, 2, 2])
    circle = arc_circles(arcs)
    assert np.isinf(circle.radii[0])
    assert circle.sweeps[0] == 0


# Areas


@pytest.mark.parametrize("ratio", [1.02, 1.5, 10.0, 1e3, 1e6, 1e9])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_law_areas_of_caps(ratio: float, sign: float) -> None:
    """Caps over a circle of radius 1, from a half sphere down to the plane: 2 π r h."""
    circles = Circles(np.zeros(3), np.array([0, 0, 1.0]), np.array(1.0))
    row = pencil_spheres(*circle_pencils(circles), np.array(sign * np.arcsin(1 / ratio)))
    turns = np.array([0.0, 1.0, 2.5, 4.0, 5.5])
    corners = np.stack([np.cos(turns), np.sin(turns), np.zeros(5)], 1)
    upward = np.broadcast_to([0, 0, 1.0], (5, 3))
    height = 1 / (ratio + np.sqrt(ratio**2 - 1))
    area = polygon_area(row, corners, upward, shift=False)
    np.testing.assert_allclose(area, 2 * np.pi * ratio * height, rtol=1e-12)


def test_law_areas_of_octant_and_lunes() -> None:
    corners = np.eye(3)
    area = polygon_area(UNIT_SPHERE, corners, great_planes(corners))
    np.testing.assert_allclose(area, np.pi / 2, rtol=1e-13)
    for opening in (0.1, 1.0, 2.0):
        west, east = np.array([1.0, 0, 0]), np.array([np.cos(opening), np.sin(opening), 0])
        corners = np.array([[0, 0, -1.0], east, [0, 0, 1.0], west])
        area = polygon_area(UNIT_SPHERE, corners, great_planes(corners))
        np.testing.assert_allclose(area, 2 * opening, rtol=1e-9)


@given(
    seed=st.integers(0, 1000),
    degree=st.integers(3, 6),
    opening=st.floats(0.05, 1.0),
    tilts=arrays(float, 6, elements=st.floats(-0.5, 0.5)),
)
def test_law_areas_agree_with_gauss_and_bonnet(
    seed: int, degree: int, opening: float, tilts: FloatArray
) -> None:
    rng = np.random.default_rng(seed)
    turns = (np.arange(degree) + rng.uniform(-0.2, 0.2, degree)) * 2 * np.pi / degree
    reach = opening * rng.uniform(0.7, 1, degree)
    corners = np.stack(
        [np.sin(reach) * np.cos(turns), np.sin(reach) * np.sin(turns), np.cos(reach)], 1
    )
    corners = corners @ Rotation.from_rotvec(rng.normal(size=3)).as_matrix().T
    following = np.roll(corners, -1, axis=0)
    inward, tilt = great_planes(corners), tilts[:degree, None]
    planes = np.cos(tilt) * inward + np.sin(tilt) * unit(corners + following)
    area = polygon_area(UNIT_SPHERE, corners, planes)

    # 2π = area + sum of geodesic curvature + turning at the corners.
    level = dot(planes, corners)
    radius = np.sqrt(1 - level**2)
    sweep = 2 * np.arcsin(norm(following - corners) / 2 / radius)
    leaving = unit(np.cross(planes, corners))
    arriving = np.roll(unit(np.cross(planes, following)), 1, axis=0)
    turning = np.arctan2(dot(np.cross(arriving, leaving), corners), dot(arriving, leaving))
    expected = 2 * np.pi - (level * sweep).sum() - turning.sum()
    np.testing.assert_allclose(area, expected, atol=1e-12)


@given(points=arrays(float, (5, 2), elements=st.floats(-3, 3)), normal=directions())
def test_law_areas_of_planar_polygons(points: FloatArray, normal: FloatArray) -> None:
    """The shoelace formula, whatever the polygon."""
    x = unit(np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))]))
    y = np.cross(normal, x)
    corners = points[:, :1] * x + points[:, 1:] * y + 2 * normal
    following = np.roll(points, -1, axis=0)
    assume(norm(following - points).min() > 1e-2)
    expected = (points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]).sum() / 2
    sides = np.roll(corners, -1, axis=0) - corners
    planes = unit(np.cross(normal, sides))
    row = np.array([0, *normal, 2.0])
    np.testing.assert_allclose(polygon_area(row, corners, planes), expected, atol=1e-12)


def test_law_areas_go_over_into_the_plane() -> None:
    """The solid angle of a unit square at height d is 4 atan(1 / 4 d r), for any radius r."""
    flat = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    corners = np.column_stack([flat, np.zeros(4)])
    following = np.roll(corners, -1, axis=0)
    for radius in 10.0 ** np.arange(10):
        height = np.sqrt(radius**2 - 0.5)
        row = np.array([-0.5 / radius, 0, 0, height / radius, 0.25 / radius])
        apex = np.array([0, 0, -height])
        planes = unit(np.cross(corners - apex, following - corners))
        area = polygon_area(row, corners, planes, shift=False)
        expected = radius**2 * 4 * np.arctan(0.25 / (height * radius))
        np.testing.assert_allclose(area, expected, rtol=1e-13)


@pytest.mark.parametrize("radius", [1.0, 40.0, 1e6])
def test_law_areas_add_up(radius: float) -> None:
    """A patch cut in two by any plane through a corner and an edge point."""
    circles = Circles(np.zeros(3), np.array([0, 0, 1.0]), np.array(0.25))
    row = pencil_spheres(*circle_pencils(circles), np.array(-np.arcsin(0.5 / radius)))
    turns = np.array([0.2, 1.5, 2.9, 4.6])
    corners = 0.5 * np.stack([np.cos(turns), np.sin(turns), np.zeros(4)], 1)
    sides = np.roll(corners, -1, axis=0) - corners
    planes = unit(np.cross([0.1, -0.2, 1.0], sides))
    whole = polygon_area(row, corners, planes, shift=False)
    diagonal = corners[2] - corners[0]
    cut = unit(np.cross([0.3, 0.1, 1.0], diagonal))
    first = polygon_area(row, corners[:3], np.stack([planes[0], planes[1], -cut]), shift=False)
    second = polygon_area(
        row, corners[[0, 2, 3]], np.stack([cut, planes[2], planes[3]]), shift=False
    )
    np.testing.assert_allclose(first + second, whole, rtol=1e-13)
    assert min(first, second) > 0


def test_law_areas_change_sign_with_the_boundary_and_with_the_sphere() -> None:
    corners = unit(np.array([[1.0, 0.1, 0], [0, 1, 0.2], [0.3, 0.2, 1]]))
    planes = great_planes(corners)
    area = polygon_area(UNIT_SPHERE, corners, planes)
    assert area > 0
    backwards = corners[::-1]
    reverse = polygon_area(UNIT_SPHERE, backwards, great_planes(backwards))
    np.testing.assert_allclose(reverse, -area, rtol=1e-13)
    np.testing.assert_allclose(polygon_area(-UNIT_SPHERE, corners, planes), -area, rtol=1e-13)


@given(seed=st.integers(0, 100), factor=st.sampled_from([1e-3, 1.0, 1e3]))
def test_law_areas_are_covariant(seed: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    turn = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    corners = unit(np.array([[1.0, 0.1, 0.4], [0.3, 1, 0.2], [0.3, 0.2, 1]]))
    area = polygon_area(UNIT_SPHERE, corners, great_planes(corners))
    moved, row = factor * corners @ turn.T, np.array([-0.5 / factor, 0, 0, 0, 0.5 * factor])
    found = polygon_area(row, moved, great_planes(moved))
    np.testing.assert_allclose(found, factor**2 * area, rtol=1e-12)
