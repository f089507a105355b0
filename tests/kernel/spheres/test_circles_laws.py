"""Laws of circles and pencils, B1 to B6 of the table of operations."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_centroids, local_corners
from spheremesh.kernel.spheres.circles import (
    Circles,
    PencilKind,
    angle_through_points,
    circle_pencils,
    face_circles,
    intersection_circles,
    pencil_kind,
    pencil_spheres,
    sphere_through_points,
)
from spheremesh.kernel.spheres.incidence import evaluate, project
from spheremesh.kernel.spheres.minkowski import angle, minkowski
from spheremesh.kernel.spheres.rows import (
    center_radius,
    from_center_radius,
    from_plane,
    kind,
    normalize,
    recenter,
    rescale,
)

POINTS = arrays(float, 3, elements=st.floats(-4, 4))
RADII = st.floats(0.2, 4)
PARAMETERS = st.floats(-1.5, 1.5)


@st.composite
def directions(draw: st.DrawFn) -> FloatArray:
    vector = draw(POINTS)
    length = norm(vector)
    assume(length > 0.1)
    return vector / length


def sphere(center: FloatArray, radius: float) -> FloatArray:
    return normalize(from_center_radius(np.asarray(center, float), np.array(radius**2)))


def circle_points(circles: Circles, count: int = 7) -> FloatArray:
    """Points of one circle."""
    helper = np.eye(3)[np.argmin(np.abs(circles.normals))]
    x = unit(np.cross(circles.normals, helper))
    y = np.cross(circles.normals, x)
    turns = np.linspace(0, 6, count)
    flat = np.cos(turns)[:, None] * x + np.sin(turns)[:, None] * y
    return circles.centers + np.sqrt(circles.radii_squared) * flat


def invert_rows(rows: FloatArray, center: FloatArray, radius: float) -> FloatArray:
    mirror = sphere(center, radius)
    return rows - 2 * minkowski(rows, mirror)[..., None] * mirror


# B1


@pytest.mark.parametrize(
    ("distance", "discriminant", "expected"),
    [
        (1.5, 15.75, PencilKind.ELLIPTIC),
        (2.0, 0.0, PencilKind.PARABOLIC),
        (3.0, -180.0, PencilKind.HYPERBOLIC),
    ],
)
def test_law_b1_unit_spheres(
    distance: float, discriminant: float, expected: PencilKind
) -> None:
    s = from_center_radius(np.zeros(3), np.array(1.0))
    t = from_center_radius(np.array([0.0, distance, 0.0]), np.array(1.0))
    found = minkowski(s, s) * minkowski(t, t) - minkowski(s, t) ** 2
    assert found == pytest.approx(discriminant, abs=1e-13)
    assert pencil_kind(s, t) == expected
    assert pencil_kind(-7 * t, 1e-3 * s) == expected


def test_law_b1_planes_and_concentric_spheres() -> None:
    x, y = from_plane(np.eye(3)[:2], np.array([1.0, 0.0]))
    shifted = from_plane(np.eye(3)[0], np.array(3.0))
    ball, larger = sphere(np.zeros(3), 1.0), sphere(np.zeros(3), 2.0)
    assert pencil_kind(x, y) == PencilKind.ELLIPTIC
    assert pencil_kind(x, shifted) == PencilKind.PARABOLIC
    assert pencil_kind(ball, larger) == PencilKind.HYPERBOLIC
    assert pencil_kind(ball, x) == PencilKind.PARABOLIC
    assert pencil_kind(ball, y) == PencilKind.ELLIPTIC
    assert pencil_kind(ball, shifted) == PencilKind.HYPERBOLIC


@given(
    distance=st.sampled_from([0.3, 1.0, 1.7, 2.3, 4.0]),
    center=POINTS,
    radius=RADII,
    weights=arrays(float, (2, 2), elements=st.floats(-2, 2)),
)
def test_law_b1_kind_belongs_to_the_pencil(
    distance: float, center: FloatArray, radius: float, weights: FloatArray
) -> None:
    """Möbius maps keep it, and so does any other pair that spans the pencil."""
    pair = np.stack([sphere(np.zeros(3), 1.0), sphere(np.array([distance, 0, 0]), 1.0)])
    expected = pencil_kind(*pair)
    assert pencil_kind(*invert_rows(pair, center, radius)) == expected
    assert pencil_kind(*recenter(pair, center)) == expected
    assume(abs(np.linalg.det(weights)) > 0.05)
    assert pencil_kind(*(weights @ pair)) == expected


# B2


@given(center=POINTS, axis=directions(), radius=RADII, other=RADII, distance=st.floats(0.1, 6))
def test_law_b2_intersection_circles(
    center: FloatArray, axis: FloatArray, radius: float, other: float, distance: float
) -> None:
    s, t = sphere(center, radius), sphere(center + distance * axis, other)
    found = intersection_circles(s, t)
    # Signed distance of the radical plane from the first centre.
    a = (distance**2 + radius**2 - other**2) / (2 * distance)
    size = (1 + radius**2 + other**2) / min(distance, 1)
    np.testing.assert_allclose(found.normals, axis, atol=1e-13 * size * 10)
    np.testing.assert_allclose(found.centers, center + a * axis, atol=1e-12 * size * 10)
    np.testing.assert_allclose(found.radii_squared, radius**2 - a**2, atol=1e-12 * size**2 * 10)
    swapped = intersection_circles(t, s)
    np.testing.assert_allclose(swapped.normals, -found.normals, atol=1e-13)
    np.testing.assert_allclose(swapped.centers, found.centers, atol=1e-11 * size)
    assume(found.radii_squared > 1e-2)
    points = circle_points(found)
    np.testing.assert_allclose(evaluate(s, points), 0, atol=1e-10 * size)
    np.testing.assert_allclose(evaluate(t, points), 0, atol=1e-10 * size)


@given(center=POINTS, radius=RADII, normal=directions(), share=st.floats(-0.9, 0.9))
def test_law_b2_plane_and_sphere(
    center: FloatArray, radius: float, normal: FloatArray, share: float
) -> None:
    height = share * radius
    plane = from_plane(normal, np.array(normal @ center + height))
    for found in (
        intersection_circles(sphere(center, radius), plane),
        intersection_circles(plane, sphere(center, radius)),
    ):
        np.testing.assert_allclose(found.centers, center + height * normal, atol=1e-11)
        np.testing.assert_allclose(
            found.radii_squared, radius**2 - height**2, atol=1e-11 * (1 + 100 / radius)
        )
        np.testing.assert_allclose(np.abs(found.normals @ normal), 1, atol=1e-13)


def test_law_b2_two_planes_have_no_circle() -> None:
    found = intersection_circles(*from_plane(np.eye(3)[:2], np.array([1.0, 0.0])))
    assert np.isnan(found.centers).all()
    assert np.isnan(found.normals).all()
    assert np.isnan(found.radii_squared)


def test_law_b2_nearly_equal_radii_keep_their_circle() -> None:
    """Spheres of radius 1e6 whose circle has radius 1: the radical plane does not cancel."""
    circle = Circles(np.zeros(3), np.array([0.0, 0, 1]), np.array(1.0))
    plane, great = circle_pencils(circle)
    pair = [pencil_spheres(plane, great, np.array(t)) for t in (1e-6, -2e-6)]
    found = intersection_circles(*pair)
    np.testing.assert_allclose(found.radii_squared, 1, rtol=1e-9)
    np.testing.assert_allclose(found.centers, 0, atol=1e-9)
    np.testing.assert_allclose(np.abs(found.normals[2]), 1, atol=1e-15)


# B4


@given(axis=directions(), radius=RADII, other=RADII, share=st.floats(0.02, 0.98), center=POINTS)
def test_law_b4_law_of_cosines(
    axis: FloatArray, radius: float, other: float, share: float, center: FloatArray
) -> None:
    low, high = abs(radius - other), radius + other
    distance = low + share * (high - low)
    assume(distance > 1e-2)
    s, t = sphere(center, radius), sphere(center + distance * axis, other)
    cosine = (radius**2 + other**2 - distance**2) / (2 * radius * other)
    tolerance = 1e-13 * (1 + 100 / (radius * other))
    np.testing.assert_allclose(minkowski(s, t), cosine, atol=tolerance * 10)
    np.testing.assert_allclose(np.cos(angle(s, t)), cosine, atol=tolerance * 10)
    np.testing.assert_allclose(angle(s, -t), np.pi - angle(s, t), atol=1e-12)


@given(normal=directions(), center=POINTS, radius=RADII, share=st.floats(-0.99, 0.99))
def test_law_b4_plane_and_sphere(
    normal: FloatArray, center: FloatArray, radius: float, share: float
) -> None:
    plane = from_plane(normal, np.array(normal @ center - share * radius))
    tolerance = 1e-13 * (1 + 100 / radius)
    # N of the sphere points to its centre: (n·c - d) / r.
    np.testing.assert_allclose(minkowski(plane, sphere(center, radius)), share, atol=tolerance)
    np.testing.assert_allclose(
        angle(plane, sphere(center, radius)), np.arccos(share), atol=tolerance * 10
    )


@given(n=directions(), m=directions(), d=arrays(float, 2, elements=st.floats(-3, 3)))
def test_law_b4_two_planes(n: FloatArray, m: FloatArray, d: FloatArray) -> None:
    first, second = from_plane(n, d[0]), from_plane(m, d[1])
    expected = 2 * np.arctan2(norm(n - m), norm(n + m))
    np.testing.assert_allclose(angle(first, second), expected, atol=1e-12)
    np.testing.assert_allclose(angle(first, -first), np.pi, atol=1e-12)


@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-8, 1e-4, 0.1, 1.5, 3.0])
@pytest.mark.parametrize("t", [0.0, 0.3, -1.0])
def test_law_b4_accurate_at_smooth_contact_and_spikes(tilt: float, t: float) -> None:
    """In a pencil angles add: an arc cosine would lose everything below 1e-8."""
    circle = Circles(np.zeros(3), np.array([0.0, 0, 1]), np.array(1.0))
    plane, great = circle_pencils(circle)
    s, other = (pencil_spheres(plane, great, np.array(x)) for x in (t, t + tilt))
    np.testing.assert_allclose(angle(s, other), tilt, rtol=1e-3, atol=1e-15)
    np.testing.assert_allclose(angle(s, -other), np.pi - tilt, atol=1e-15 + 1e-3 * tilt)
    at_point = recenter(np.stack([s, other]), np.array([0.6, 0.8, 0.0]))
    np.testing.assert_allclose(angle(*at_point), tilt, rtol=1e-7, atol=1e-15)


# B5


@given(points=arrays(float, (4, 3), elements=st.floats(-4, 4)))
def test_law_b5_sphere_through_four_points(points: FloatArray) -> None:
    edges = points[1:] - points[0]
    size = norm(edges).max()
    assume(size > 0.5)
    assume(abs(np.linalg.det(edges)) > 0.02 * size**3)
    row = sphere_through_points(points)
    np.testing.assert_allclose(minkowski(row, row), 1, atol=1e-9)
    local = recenter(row, points[0])
    np.testing.assert_allclose(evaluate(local, points - points[0]), 0, atol=1e-10)


def test_law_b5_four_points_of_a_plane() -> None:
    points = np.array([[0, 0, 2.0], [1, 0, 2], [0, 1, 2], [3, 2, 2]])
    row = sphere_through_points(points)
    assert abs(row[0]) < 1e-15
    np.testing.assert_allclose(row * row[3], [0, 0, 0, 1, 2], atol=1e-14)


@pytest.mark.parametrize(("scale", "distance"), [(1e-3, 0.0), (1.0, 1e3), (1e4, 1e5)])
def test_law_b5_sphere_through_points_at_any_scale(scale: float, distance: float) -> None:
    rng = np.random.default_rng(3)
    center = np.array([distance, -distance, 0.5])
    points = center + scale * unit(rng.normal(size=(6, 4, 3)))
    found, square = center_radius(sphere_through_points(points))
    # The constant of a row in model coordinates is rounded at the square of the distance.
    rounding = 1e-14 * (1 + (distance / scale) ** 2)
    np.testing.assert_allclose(found, np.broadcast_to(center, (6, 3)), atol=1e-11 * scale * 10)
    np.testing.assert_allclose(square, scale**2, rtol=1e-10 + 10 * rounding)


def test_no_sphere_is_through_points_that_coincide() -> None:
    good = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0]])
    far = good.copy()
    far[1, 2] = np.inf
    rows = sphere_through_points(np.array([np.full((4, 3), 7.0), good, far, 0 * good]))
    assert np.isnan(rows).all(axis=1).tolist() == [True, False, True, True]
    np.testing.assert_array_equal(rows[1], sphere_through_points(good))


@given(center=POINTS, normal=directions(), radius=RADII, point=POINTS)
def test_law_b5_sphere_through_circle_and_point(
    center: FloatArray, normal: FloatArray, radius: float, point: FloatArray
) -> None:
    circles = Circles(center, normal, np.array(radius**2))
    plane, great = circle_pencils(circles)
    miss = np.hypot(evaluate(plane, point), evaluate(great, point))
    assume(miss > 1e-2)
    t = angle_through_points(plane, great, point)
    assert -np.pi / 2 < t <= np.pi / 2
    row = pencil_spheres(plane, great, t)
    tolerance = 1e-12 * (1 + 50 / radius)
    np.testing.assert_allclose(evaluate(row, point), 0, atol=tolerance)
    np.testing.assert_allclose(evaluate(row, circle_points(circles)), 0, atol=tolerance)


@pytest.mark.parametrize("name", ["torus", "vase", "roof", "enneper"])
def test_law_b5_neighbouring_circles_share_a_sphere(nets: dict[str, Mesh], name: str) -> None:
    """The four pencil rows of two circular faces with a common edge span only three."""
    mesh = nets[name]
    circles, _ = face_circles(mesh)
    edge = np.sqrt(circles.radii_squared).mean()
    rows = np.stack(circle_pencils(circles), 1)
    left, right = mesh.topology.edge_faces.T
    across = face_centroids(mesh)[left] - face_centroids(mesh)[right]
    moved = recenter(rows[right], np.repeat(across[:, None], 2, 1))
    stacked = rescale(np.concatenate([rows[left], moved], 1), 1 / edge)
    values = np.linalg.svd(stacked, compute_uv=False)
    assert (values[:, 3] / values[:, 0]).max() < 1e-12
    assert (values[:, 2] / values[:, 0]).min() > 1e-4


# B6


@given(center=POINTS, normal=directions(), radius=RADII, t=PARAMETERS)
def test_law_b6_pencil_of_a_circle(
    center: FloatArray, normal: FloatArray, radius: float, t: float
) -> None:
    circles = Circles(center, normal, np.array(radius**2))
    plane, great = circle_pencils(circles)
    tolerance = 1e-13 * (1 + 50 / radius**2)
    np.testing.assert_allclose(minkowski(plane, plane), 1, atol=1e-14)
    np.testing.assert_allclose(minkowski(great, great), 1, atol=tolerance)
    np.testing.assert_allclose(minkowski(plane, great), 0, atol=tolerance)
    found, square = center_radius(great)
    np.testing.assert_allclose(found, center, atol=1e-13)
    np.testing.assert_allclose(square, radius**2, atol=1e-13 * 50)
    assert great[0] > 0
    row = pencil_spheres(plane, great, np.array(t))
    np.testing.assert_allclose(row[0], np.sin(t) / (2 * radius), rtol=1e-14)
    np.testing.assert_allclose(minkowski(row, row), 1, atol=tolerance)
    np.testing.assert_allclose(evaluate(row, circle_points(circles)), 0, atol=tolerance * 10)
    if abs(t) > 1e-2:
        _, square = center_radius(row)
        np.testing.assert_allclose(np.abs(np.sin(t)) * np.sqrt(square), radius, rtol=1e-9)


@given(center=POINTS, normal=directions(), radius=RADII, t=PARAMETERS, u=PARAMETERS)
def test_law_b6_angles_add_within_a_pencil(
    center: FloatArray, normal: FloatArray, radius: float, t: float, u: float
) -> None:
    plane, great = circle_pencils(Circles(center, normal, np.array(radius**2)))
    rows = [pencil_spheres(plane, great, np.array(x)) for x in (t, u)]
    np.testing.assert_allclose(
        minkowski(*rows), np.cos(t - u), atol=1e-13 * (1 + 50 / radius**2)
    )


# Circles of faces


@pytest.mark.parametrize(
    "name", ["torus", "ellipsoid", "egg", "catenoid", "vase", "enneper", "roof"]
)
def test_circular_nets_lie_on_their_circles(nets: dict[str, Mesh], name: str) -> None:
    mesh = nets[name]
    circles, miss = face_circles(mesh)
    assert miss.max() < 1e-12 * norm(np.ptp(mesh.vertices, axis=0))
    relative = local_corners(mesh) - circles.centers[mesh.topology.corner_faces]
    np.testing.assert_allclose(
        dot(relative, relative), circles.radii_squared[mesh.topology.corner_faces], rtol=1e-10
    )


@given(points=arrays(float, (3, 3), elements=st.floats(-4, 4)))
def test_circles_of_triangles_are_circumcircles(points: FloatArray) -> None:
    cross = np.cross(points[1] - points[0], points[2] - points[0])
    lengths = norm(points - np.roll(points, 1, axis=0))
    assume(norm(cross) > 0.02 * lengths.max() ** 2)
    assume(lengths.max() > 0.1)
    mesh = Mesh(points, [[0, 1, 2]])
    circles, miss = face_circles(mesh)
    assert miss[0] < 1e-9 * lengths.max()
    np.testing.assert_allclose(circles.normals[0], unit(cross), atol=1e-10)
    expected = np.prod(lengths) / (2 * norm(cross))
    np.testing.assert_allclose(np.sqrt(circles.radii_squared[0]), expected, rtol=1e-8)


def test_circle_of_a_perturbed_square(assert_spheres_close: Callable[..., None]) -> None:
    """Corners alternately up by h and out and in by d: only the miss shows it."""
    d, h = 1e-3, 2e-3
    turns = np.arange(4) * np.pi / 2
    flat = np.stack([np.cos(turns), np.sin(turns)], 1)
    radii, heights = np.array([1 + d, 1 - d, 1 + d, 1 - d]), np.array([h, -h, h, -h])
    mesh = Mesh(np.column_stack([flat * radii[:, None], heights]), [[0, 1, 2, 3]])
    circles, miss = face_circles(mesh)
    np.testing.assert_allclose(circles.centers[0], 0, atol=1e-14)
    np.testing.assert_allclose(circles.normals[0], [0, 0, 1], atol=1e-14)
    # Kåsa's fit: the mean of the squared distances.
    np.testing.assert_allclose(circles.radii_squared[0], 1 + d**2, rtol=1e-12)
    np.testing.assert_allclose(miss[0], np.hypot(d, h), rtol=1e-3)
    plane, _ = circle_pencils(circles)
    assert_spheres_close(plane[0], np.array([0, 0, 0, 1.0, 0]), oriented=True)


def test_circle_of_a_dart_whose_first_corner_is_its_centroid() -> None:
    """The axes of the fit must not hang on one corner."""
    mesh = Mesh([[0, 0, 0], [2, 0, 0], [-1, 1, 0], [-1, -1, 0]], [[0, 1, 2, 3]])
    circles, miss = face_circles(mesh)
    np.testing.assert_allclose(circles.normals[0], [0, 0, 1], atol=1e-14)
    # The line of |x|² over x by least squares has value 2 and slope 2/3 at the centroid.
    np.testing.assert_allclose(circles.centers[0], [1 / 3, 0, 0], atol=1e-14)
    np.testing.assert_allclose(circles.radii_squared[0], 19 / 9, rtol=1e-12)
    np.testing.assert_allclose(miss[0], np.sqrt(19) / 3 - 1 / 3, rtol=1e-12)


def test_circles_far_from_the_origin_and_at_any_scale(
    nets: dict[str, Mesh], rotation: FloatArray
) -> None:
    mesh = nets["roof"]
    circles, _ = face_circles(mesh)
    for scale in (1e-3, 1e3):
        points = scale * mesh.vertices @ rotation.T
        moved, _ = face_circles(Mesh(points, mesh.faces))
        np.testing.assert_allclose(moved.radii_squared, scale**2 * circles.radii_squared)
        np.testing.assert_allclose(moved.normals, circles.normals @ rotation.T, atol=1e-11)
    far, miss = face_circles(Mesh(mesh.vertices + 1e6, mesh.faces))
    np.testing.assert_allclose(far.radii_squared, circles.radii_squared, rtol=1e-7)
    assert miss.max() < 1e-8


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
        [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]],
        [[5, 5, 5], [5, 5, 5], [5, 5, 5]],
    ],
    ids=["in line", "bow-tie", "one point"],
)
def test_degenerate_faces_are_named(points: list[list[float]]) -> None:
    n = len(points)
    sound = np.array([[0, 0, 9.0], [1, 0, 9], [0, 1, 9]])
    mesh = Mesh(np.concatenate([sound, points]), [[0, 1, 2], list(range(3, 3 + n))])
    with pytest.raises(InputError, match=r"faces \[1\] have zero area"):
        face_circles(mesh)


@given(row=POINTS, radius=RADII)
def test_pencil_spheres_are_spheres_again(row: FloatArray, radius: float) -> None:
    """Through project: the great sphere's points nearest the axis lie at the radius."""
    circles = Circles(row, np.array([0.0, 0, 1]), np.array(radius**2))
    _, great = circle_pencils(circles)
    top = project(great, row + np.array([0, 0, 2 * radius]))
    np.testing.assert_allclose(top, row + np.array([0, 0, radius]), atol=1e-11)
    assert kind(great) == 0
