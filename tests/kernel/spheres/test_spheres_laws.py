"""Laws of sphere rows, A1 to A6 of the table of operations, and of their changes of frame."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.spheres.incidence import evaluate, normals, project, signed_distance
from spheremesh.kernel.spheres.minkowski import angle, minkowski
from spheremesh.kernel.spheres.pentaspherical import (
    from_pentaspherical,
    inverse_stereographic,
    pentaspherical,
    pole,
    stereographic,
)
from spheremesh.kernel.spheres.rows import (
    Kind,
    center_radius,
    from_center_radius,
    from_plane,
    kind,
    lift_points,
    normalize,
    offset,
    recenter,
    rescale,
)

POINTS = arrays(float, 3, elements=st.floats(-4, 4))
RADII = st.floats(0.1, 5)
CURVATURES = st.floats(-0.5, 0.5) | st.sampled_from([0.0, 1e-9, -1e-9, 1e-14])
SIGNS = st.sampled_from([-1.0, 1.0])


@st.composite
def directions(draw: st.DrawFn) -> FloatArray:
    vector = draw(POINTS)
    length = norm(vector)
    assume(length > 0.1)
    return vector / length


@st.composite
def unit_rows(draw: st.DrawFn) -> FloatArray:
    """Spheres and planes alike, by a point on them, the normal there and half the curvature."""
    point, normal, a = draw(POINTS), draw(directions()), draw(CURVATURES)
    return recenter(np.array([a, *normal, 0.0]), -point)


def surface_points(row: FloatArray) -> FloatArray:
    """Five points of a sphere or plane."""
    return project(row, np.array([[3, 0, 0], [0, 3, 0], [0, 0, 3], [-2, -1, 1], [1, 1, -3.0]]))


def invert_points(points: FloatArray, center: FloatArray, radius: float) -> FloatArray:
    relative = points - center
    return center + radius**2 * relative / dot(relative, relative)[..., None]


def invert_rows(rows: FloatArray, center: FloatArray, radius: float) -> FloatArray:
    """Reflection in the hyperplane of the sphere of inversion."""
    mirror = normalize(from_center_radius(center, np.array(radius**2)))
    return rows - 2 * minkowski(rows, mirror)[..., None] * mirror


# A1


@given(center=POINTS, radius=RADII)
def test_law_a1_sphere_round_trip(center: FloatArray, radius: float) -> None:
    row = from_center_radius(center, np.array(radius**2))
    found, square = center_radius(row * -3.7)
    np.testing.assert_allclose(found, center, atol=1e-12 * 4)
    # The square of the radius is a difference of squares of up to 3 * 4².
    np.testing.assert_allclose(square, radius**2, rtol=1e-12, atol=1e-12 * 48)
    assert kind(row) == Kind.SPHERE


@given(normal=directions(), distance=st.floats(-10, 10))
def test_law_a1_plane_round_trip(normal: FloatArray, distance: float) -> None:
    row = from_plane(normal, np.array(distance))
    assert kind(row) == Kind.PLANE
    assert kind(-2 * row) == Kind.PLANE
    np.testing.assert_allclose(minkowski(row, row), 1, atol=1e-12)
    scaled = 2.5 * row
    assert scaled[4] / norm(scaled[1:4]) == pytest.approx(distance, rel=1e-12, abs=1e-12)
    np.testing.assert_allclose(evaluate(row, distance * normal), 0, atol=1e-11)
    center, square = center_radius(row)
    assert np.isinf(center).all()
    assert np.isinf(square)


@given(center=POINTS, radius=RADII)
def test_law_a1_kinds(center: FloatArray, radius: float) -> None:
    squares = np.array([radius**2, 0.0, -(radius**2)])
    rows = from_center_radius(np.broadcast_to(center, (3, 3)), squares)
    assert kind(rows).tolist() == [Kind.SPHERE, Kind.POINT, Kind.IMAGINARY]
    assert kind(1e-7 * rows).tolist() == kind(-1e7 * rows).tolist() == kind(rows).tolist()


# A2


@given(center=POINTS, radius=RADII, factor=st.floats(1e-6, 1e6), sign=SIGNS)
def test_law_a2_normalize(
    center: FloatArray, radius: float, factor: float, sign: float
) -> None:
    squares = np.array([radius**2, -(radius**2)])
    rows = from_center_radius(np.broadcast_to(center, (2, 3)), squares)
    unit = normalize(sign * factor * rows)
    size = 48 / radius**2  # what cancels in the norm
    np.testing.assert_allclose(minkowski(unit, unit), [1, -1], atol=1e-14 * (1 + size))
    np.testing.assert_allclose(normalize(unit), unit, rtol=1e-14 * (1 + size))
    assert (np.sign(unit[:, 0]) == sign).all()


def test_law_a2_points_have_no_unit_row() -> None:
    rows = from_center_radius(np.eye(3), np.array([1.0, 0.0, 2.0]))
    with pytest.raises(InputError, match=r"\[1\]"):
        normalize(rows)
    with pytest.raises(InputError, match="point"):
        normalize(lift_points(np.array([0.3, 0.1, 1.0])))


# A3


@given(points=arrays(float, (4, 3), elements=st.floats(-100, 100)))
def test_law_a3_stereographic(points: FloatArray) -> None:
    images = stereographic(points)
    np.testing.assert_allclose(norm(images), 1, atol=1e-14)
    # Near the pole 1 - X4 = 2 / (|p|² + 1) cancels.
    size = 1 + dot(points, points).max()
    back = inverse_stereographic(images)
    np.testing.assert_allclose(back, points, rtol=1e-14 * size, atol=1e-14 * size)


def test_law_a3_landmarks() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 0.6, 0.8]])
    expected = [[0, 0, 0, -1], [1, 0, 0, 0], [0, 0.6, 0.8, 0]]
    np.testing.assert_allclose(stereographic(points), expected, atol=1e-15)
    assert not np.isfinite(inverse_stereographic(np.array([0.0, 0.0, 0.0, 1.0]))).any()


# A4


@given(row=unit_rows(), factor=st.sampled_from([1.0, -3.0, 1e-5]))
def test_law_a4_pole(row: FloatArray, factor: float) -> None:
    poles, is_infinite = pole(factor * row)
    assume(abs(pentaspherical(row)[4]) > 1e-3)
    assert not is_infinite
    images = stereographic(surface_points(row))
    np.testing.assert_allclose(images @ poles, 1, atol=1e-12 * (1 + norm(poles)))
    if abs(row[0]) > 1e-3:
        center, _ = center_radius(row)
        size = 1 + dot(center, center)
        np.testing.assert_allclose(inverse_stereographic(poles), center, atol=1e-12 * size)


@given(center=POINTS)
def test_law_a4_great_spheres_have_their_pole_at_infinity(center: FloatArray) -> None:
    # |c|² - r² + 1 = 0: the sphere meets the unit sphere in a great circle.
    row = from_center_radius(center, dot(center, center) + 1)
    direction, is_infinite = pole(row)
    assert is_infinite
    images = stereographic(surface_points(normalize(row)))
    np.testing.assert_allclose(images @ direction, 0, atol=1e-12 * (1 + dot(center, center)))


def test_law_a4_planes_through_the_origin_are_great_spheres() -> None:
    rows = from_plane(np.eye(3), np.array([0.0, 0.5, 0.0]))
    assert pole(rows)[1].tolist() == [True, False, True]


# A5


@given(point=POINTS, center=POINTS, radius=RADII, normal=directions(), d=st.floats(-5, 5))
def test_law_a5_lifts(
    point: FloatArray, center: FloatArray, radius: float, normal: FloatArray, d: float
) -> None:
    p, s = lift_points(point), from_center_radius(center, np.array(radius**2))
    plane = from_plane(normal, np.array(d))
    size = 1e-14 * 16 * (dot(point, point) + dot(center, center) + radius**2 + 1)
    assert abs(minkowski(p, p)) <= size * (1 + dot(point, point))
    offset_square = dot(center - point, center - point)
    np.testing.assert_allclose(minkowski(s, p), 2 * (radius**2 - offset_square), atol=size)
    np.testing.assert_allclose(minkowski(s, s), 4 * radius**2, atol=size)
    np.testing.assert_allclose(minkowski(plane, plane), 1, atol=1e-14)
    np.testing.assert_allclose(minkowski(plane, p), 2 * (point @ normal - d), atol=size)
    np.testing.assert_allclose(minkowski(s, p) / -2, evaluate(s, point), atol=size)


@given(rows=arrays(float, (2, 5), elements=st.floats(-5, 5)))
def test_law_a5_pentaspherical_coordinates(rows: FloatArray) -> None:
    signature = np.diag([1.0, 1, 1, 1, -1])
    s, t = pentaspherical(rows)
    np.testing.assert_allclose(s @ signature @ t, minkowski(rows[0], rows[1]), atol=1e-12)
    np.testing.assert_allclose(from_pentaspherical(pentaspherical(rows)), rows, atol=1e-14)
    np.testing.assert_allclose(s[3:], [rows[0, 4] - rows[0, 0], rows[0, 4] + rows[0, 0]])


# A6


@given(row=unit_rows(), point=POINTS)
def test_law_a6_incidence_is_half_a_product(row: FloatArray, point: FloatArray) -> None:
    value = minkowski(row, lift_points(point))
    np.testing.assert_allclose(value / -2, evaluate(row, point), atol=1e-11)
    # To first order it is the distance; the error is the square of it times the curvature.
    distance = float(signed_distance(row, point))
    bound = abs(row[0]) * distance**2 + 1e-11
    assert abs(value / 2 - distance) <= bound


@given(center=POINTS, radius=RADII, point=POINTS, sign=SIGNS)
def test_law_a6_signed_distance_of_spheres(
    center: FloatArray, radius: float, point: FloatArray, sign: float
) -> None:
    row = sign * normalize(from_center_radius(center, np.array(radius**2)))
    expected = sign * (radius - norm(point - center))
    # The equation cancels squares of up to 48, divided by twice the radius.
    tolerance = 1e-14 * (1 + 48 / radius)
    np.testing.assert_allclose(signed_distance(row, point), expected, atol=tolerance * 10)


@given(normal=directions(), d=st.floats(-5, 5), point=POINTS)
def test_law_a6_signed_distance_of_planes(
    normal: FloatArray, d: float, point: FloatArray
) -> None:
    found = signed_distance(from_plane(normal, np.array(d)), point)
    np.testing.assert_allclose(found, point @ normal - d, atol=1e-13)


# Normals, projection, frames, offsets


@given(row=unit_rows(), point=POINTS)
def test_law_projection_is_nearest_and_on_the_sphere(
    row: FloatArray, point: FloatArray
) -> None:
    assume(norm(normals(row, point)) > 1e-2)
    foot = project(row, point)
    np.testing.assert_allclose(evaluate(row, foot), 0, atol=1e-11)
    np.testing.assert_allclose(norm(normals(row, foot)), 1, atol=1e-11)
    distance = signed_distance(row, point)
    np.testing.assert_allclose(norm(point - foot), abs(distance), atol=1e-11)
    np.testing.assert_allclose(foot + distance * normals(row, foot), point, atol=1e-10)


@given(row=unit_rows(), delta=st.floats(-0.9, 0.9))
def test_law_normals_and_curvature(row: FloatArray, delta: float) -> None:
    point = project(row, np.array([2.0, -1.0, 0.5]))
    n = normals(row, point)
    # Moving along N makes the sphere's equation negative, and p + N / 2A is the centre.
    assert evaluate(row, point + 1e-3 * n) < 0 < evaluate(row, point - 1e-3 * n)
    assume(abs(row[0]) > 1e-3)
    center, _ = center_radius(row)
    np.testing.assert_allclose(point + n / (2 * row[0]), center, atol=1e-10 / abs(row[0]))
    moved = point + delta * n
    np.testing.assert_allclose(normals(row, moved), (1 - 2 * row[0] * delta) * n, atol=1e-11)


@pytest.mark.parametrize("radius", [1.0, 1e3, 1e6, 1e9, np.inf])
def test_nearly_flat_rows_keep_their_digits(radius: float) -> None:
    """A sphere through the origin with N = z there: nothing may divide by A."""
    row = np.array([0.5 / radius, 0, 0, 1, 0])
    x = np.array([0.3, 0.4, 0.0])
    height = 0.25 / (radius + np.sqrt(radius**2 - 0.25)) if np.isfinite(radius) else 0.0
    point = x + np.array([0, 0, height])
    assert abs(evaluate(row, point)) < 1e-16
    lifted = point + 0.01 * normals(row, point)
    np.testing.assert_allclose(signed_distance(row, lifted), 0.01, rtol=1e-13)
    np.testing.assert_allclose(project(row, lifted), point, atol=1e-15)
    far = recenter(row, np.array([5.0, -3, 2]))
    np.testing.assert_allclose(recenter(far, np.array([-5.0, 3, -2])), row, atol=1e-14)
    parallel = offset(row, 0.01)
    np.testing.assert_allclose(evaluate(parallel, lifted), 0, atol=1e-16)
    np.testing.assert_allclose(minkowski(parallel, parallel), 1, atol=1e-14)


@given(row=unit_rows(), other=unit_rows(), origin=POINTS)
def test_law_recenter(row: FloatArray, other: FloatArray, origin: FloatArray) -> None:
    a, b = recenter(row, origin), recenter(other, origin)
    points = surface_points(row)
    np.testing.assert_allclose(evaluate(a, points - origin), evaluate(row, points), atol=1e-10)
    np.testing.assert_allclose(normals(a, points - origin), normals(row, points), atol=1e-11)
    np.testing.assert_allclose(minkowski(a, b), minkowski(row, other), atol=1e-11)
    np.testing.assert_allclose(recenter(a, -origin), row, atol=1e-11)


@given(row=unit_rows(), factor=st.floats(1e-3, 1e3))
def test_law_rescale(row: FloatArray, factor: float) -> None:
    scaled, points = rescale(row, factor), surface_points(row)
    tolerance = 1e-12 * (1 + np.abs(points).max()) ** 2
    np.testing.assert_allclose(minkowski(scaled, scaled), 1, atol=1e-10)
    values = evaluate(scaled, factor * points) / factor
    np.testing.assert_allclose(values, 0, atol=tolerance)
    np.testing.assert_allclose(
        normals(scaled, factor * points), normals(row, points), atol=1e-11
    )


@given(row=unit_rows(), first=st.floats(-0.4, 0.4), second=st.floats(-0.4, 0.4))
def test_law_offset(row: FloatArray, first: float, second: float) -> None:
    assume(1 - 2 * row[0] * first > 0.1)
    moved, points = offset(row, first), surface_points(row)
    n = normals(row, points)
    np.testing.assert_allclose(minkowski(moved, moved), 1, atol=1e-10)
    np.testing.assert_allclose(evaluate(moved, points + first * n), 0, atol=1e-10)
    np.testing.assert_allclose(normals(moved, points + first * n), n, atol=1e-10)
    assume(1 - 2 * row[0] * (first + second) > 0.1)
    np.testing.assert_allclose(
        offset(moved, second), offset(row, first + second), atol=1e-9, rtol=1e-9
    )


def test_offset_past_the_centre_is_refused() -> None:
    rows = normalize(from_center_radius(np.zeros((3, 3)), np.array([4.0, 1.0, 9.0])))
    with pytest.raises(InputError, match=r"\[1\]"):
        offset(rows, 1.0)
    offset(-rows, 1.0)


# Möbius invariance and angles


@given(row=unit_rows(), other=unit_rows(), center=POINTS, radius=st.floats(0.5, 3))
def test_law_inversion_keeps_products_and_incidence(
    row: FloatArray, other: FloatArray, center: FloatArray, radius: float
) -> None:
    rows = np.stack([row, other])
    images = invert_rows(rows, center, radius)
    size = np.abs(images).max() ** 2 + np.abs(rows).max() ** 2
    tolerance = 1e-13 * size
    before, after = minkowski(row, other), minkowski(images[0], images[1])
    np.testing.assert_allclose(after, before, atol=tolerance)
    np.testing.assert_allclose(invert_rows(images, center, radius), rows, atol=tolerance * 100)
    points = surface_points(row)
    assume(norm(points - center).min() > 0.1)
    moved = invert_points(points, center, radius)
    far = 1 + dot(moved, moved).max()
    np.testing.assert_allclose(evaluate(images[0], moved), 0, atol=tolerance * far)


@given(row=unit_rows(), other=unit_rows(), factor=st.floats(1e-2, 1e2), shift=POINTS)
def test_law_similarities_keep_products(
    row: FloatArray, other: FloatArray, factor: float, shift: FloatArray
) -> None:
    def move(s: FloatArray) -> FloatArray:
        return recenter(rescale(s, factor), shift)

    size = np.abs(move(row)).max() * np.abs(move(other)).max() + 1
    product = minkowski(move(row), move(other))
    np.testing.assert_allclose(product, minkowski(row, other), atol=1e-13 * size * 10)


@example(
    point=np.array([1.125, 0.0, 1.0]), n=np.array([1.0, 0, 0]), m=np.array([1.0, 0, 0]),
    a=0.0, b=0.0031308,
)  # fmt: skip
@given(point=POINTS, n=directions(), m=directions(), a=CURVATURES, b=CURVATURES)
def test_law_product_is_the_cosine_of_the_normals(
    point: FloatArray, n: FloatArray, m: FloatArray, a: float, b: float
) -> None:
    s, t = (recenter(np.array([k, *v, 0.0]), -point) for k, v in ((a, n), (b, m)))
    np.testing.assert_allclose(minkowski(s, t), n @ m, atol=1e-12)
    expected = 2 * np.arctan2(norm(n - m), norm(n + m))
    near_s, near_t = recenter(s, point), recenter(t, point)
    # Seeing a row from elsewhere and back rounds its constant by some ε: at contact, where the
    # angle is the root of a product with the difference of the curvatures, that much remains.
    rounding = 1e-12 + np.sqrt(1e-14 * abs(a - b) * (1 + point @ point))
    np.testing.assert_allclose(angle(near_s, near_t), expected, atol=rounding)
    np.testing.assert_allclose(angle(near_s, -near_t), np.pi - expected, atol=rounding)


def test_rows_may_be_single_or_stacked(assert_spheres_close: Callable[..., None]) -> None:
    """The last axis holds the row; everything before it is broadcast."""
    rng = np.random.default_rng(0)
    center, square = rng.normal(size=(2, 3, 3)), rng.uniform(1, 2, (2, 3))
    stacked = normalize(from_center_radius(center, square))
    assert stacked.shape == (2, 3, 5)
    assert_spheres_close(
        stacked[1, 2], normalize(from_center_radius(center[1, 2], square[1, 2])), oriented=True
    )
    points = rng.normal(size=(2, 3, 3))
    for function in (evaluate, signed_distance, normals, project, recenter):
        whole = function(stacked, points)
        single = function(stacked[1, 2], points[1, 2])
        np.testing.assert_allclose(whole[1, 2], single, atol=1e-14)
