"""Laws of the Möbius group: rows A7 to A9 of the table of operations."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, reject
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_normals
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.mobius import map_mesh, map_sphere_mesh
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.spheres.arcs import Arcs, arc_points, sphere_arcs
from spheremesh.kernel.spheres.circles import (
    Circles,
    PencilKind,
    circle_pencils,
    intersection_circles,
    pencil_kind,
)
from spheremesh.kernel.spheres.incidence import evaluate, project
from spheremesh.kernel.spheres.minkowski import (
    angle,
    is_orthogonal,
    minkowski,
    minkowski_gradient,
)
from spheremesh.kernel.spheres.mobius_group import (
    check_transform,
    compose,
    inverse,
    inversion,
    reflection,
    rotation_about,
    similarity,
)
from spheremesh.kernel.spheres.mobius_images import (
    map_arcs,
    map_circles,
    map_points,
    map_spheres,
    sent_to_infinity,
)
from spheremesh.kernel.spheres.pentaspherical import SIGNATURE, pentaspherical
from spheremesh.kernel.spheres.rows import (
    from_center_radius,
    from_plane,
    lift_points,
    normalize,
    recenter,
)

POINTS = arrays(float, 3, elements=st.floats(-3, 3))
CLOUD = np.random.default_rng(3).uniform(-3, 3, (6, 3))


@st.composite
def directions(draw: st.DrawFn) -> FloatArray:
    vector = draw(POINTS)
    assume(norm(vector) > 0.1)
    return unit(vector)


@st.composite
def simple_maps(draw: st.DrawFn) -> FloatArray:
    """An inversion, a similarity or a reflection in a plane."""
    which = draw(st.sampled_from(["inversion", "similarity", "plane"]))
    if which == "inversion":
        return inversion(draw(POINTS), draw(st.floats(0.5, 3)))
    if which == "plane":
        return reflection(from_plane(draw(directions()), np.array(draw(st.floats(-2, 2)))))
    scale, turn = draw(st.floats(0.5, 2)), rotation_about(draw(POINTS))
    return similarity(scale, turn, draw(POINTS))


MAPS = st.lists(simple_maps(), min_size=1, max_size=3).map(compose)


def assert_maps_close(actual: FloatArray, expected: FloatArray, size: float = 0.0) -> None:
    """M and -M are the same map."""
    sign = np.sign(actual[4, 4] * expected[4, 4])
    size = max(size, np.abs(expected).max())
    np.testing.assert_allclose(sign * actual, expected, rtol=0, atol=1e-12 * size)


def tame(points: FloatArray, transform: FloatArray) -> FloatArray:
    """The points that stay well away from infinity."""
    kept = points[~sent_to_infinity(points, transform)]
    kept = kept[norm(map_points(kept, transform)) < 100]
    assume(len(kept) > 0)
    return kept


def invert(points: FloatArray, center: FloatArray, radius: float) -> FloatArray:
    relative = points - center
    return center + radius**2 * relative / dot(relative, relative)[..., None]


# A7


def test_law_a7_orthogonal_and_tangent() -> None:
    ball = from_center_radius(np.zeros(3), np.array(1.0))
    upright = from_center_radius(np.array([0, 0, np.sqrt(2)]), np.array(1.0))
    touching = from_center_radius(np.array([0.0, 3, 0]), np.array(4.0))
    within = from_center_radius(np.array([0.5, 0, 0]), np.array(0.25))
    through, beside = from_plane(np.eye(3)[:2], np.array([0.0, 1.0]))
    rows = np.stack([ball, upright, touching, within, through, beside])
    assert is_orthogonal(ball, rows).tolist() == [False, True, False, False, True, False]
    is_tangent = pencil_kind(ball, rows) == PencilKind.PARABOLIC
    assert is_tangent.tolist() == [True, False, True, True, False, True]
    turned = pencil_kind(-3 * ball, rows) == PencilKind.PARABOLIC
    assert (turned == is_tangent).all()


@given(transform=MAPS)
def test_law_a7_both_are_kept_by_maps(transform: FloatArray) -> None:
    assume(np.abs(transform).max() < 1e3)
    ball = from_center_radius(np.zeros(3), np.array(1.0))
    rows = np.stack([ball, *from_plane(np.eye(3)[:2], np.array([0.0, 1.0]))])
    images = map_spheres(rows, transform)
    size = np.abs(images).max() ** 2
    assert abs(minkowski(images[0], images[1])) <= 1e-12 * size
    assert abs(minkowski(images[0], images[2]) ** 2 - 4) <= 1e-11 * size


@given(omega=arrays(float, 5, elements=st.floats(-3, 3)), center=POINTS)
def test_law_a7_polar_hyperplane(omega: FloatArray, center: FloatArray) -> None:
    row = from_center_radius(center, np.array(1.7))
    covector = minkowski_gradient(omega)
    np.testing.assert_allclose(covector @ row, minkowski(row, omega), atol=1e-11)
    point = minkowski_gradient(lift_points(center))
    np.testing.assert_allclose(point @ row, -2 * evaluate(row, center), atol=1e-11)


# A8: the group


@given(first=MAPS, second=MAPS)
def test_law_a8_closure(first: FloatArray, second: FloatArray) -> None:
    product = compose([first, second])
    size = np.abs(first).max() * np.abs(second).max()
    assert_maps_close(product, second @ first, size * 10)
    defect = np.abs(product.T @ SIGNATURE @ product - SIGNATURE).max()
    assert defect <= 1e-13 * np.abs(product).max() ** 2
    check_transform(product)


@given(transform=MAPS)
def test_law_a8_identity_and_inverse(transform: FloatArray) -> None:
    size = 10 * np.abs(transform).max() ** 2
    assert_maps_close(compose([]), np.eye(5))
    assert_maps_close(compose([transform]), transform)
    assert_maps_close(compose([np.eye(5), transform, np.eye(5)]), transform)
    assert_maps_close(compose([transform, inverse(transform)]), np.eye(5), size)
    assert_maps_close(compose([inverse(transform), transform]), np.eye(5), size)


@given(first=simple_maps(), second=simple_maps(), third=simple_maps())
def test_law_a8_associativity(first: FloatArray, second: FloatArray, third: FloatArray) -> None:
    left = compose([compose([first, second]), third])
    right = compose([first, compose([second, third])])
    size = np.abs(first).max() * np.abs(second).max() * np.abs(third).max()
    assert_maps_close(left, right, 10 * size)


@given(first=simple_maps(), second=simple_maps())
def test_law_a8_action(first: FloatArray, second: FloatArray) -> None:
    """Applied first to last, on points and on rows; M and -M act alike."""
    both = compose([first, second])
    points = tame(tame(CLOUD, first), both)
    step = map_points(map_points(points, first), second)
    np.testing.assert_allclose(map_points(points, both), step, atol=1e-9)
    np.testing.assert_allclose(map_points(points, -both), step, atol=1e-9)
    rows = normalize(from_center_radius(CLOUD, np.full(6, 1.3)))
    images = map_spheres(map_spheres(rows, first), second)
    tolerance = 1e-12 * np.abs(first).max() * np.abs(second).max() * np.abs(rows).max()
    np.testing.assert_allclose(map_spheres(rows, both), images, atol=10 * tolerance)
    np.testing.assert_allclose(map_spheres(rows, -both), images, atol=10 * tolerance)


def test_law_a8_closed_forms() -> None:
    center, radius = np.array([0.3, -1.0, 2.0]), 1.7
    turn = rotation_about([0.2, 1.0, -0.4])
    np.testing.assert_allclose(
        map_points(CLOUD, inversion(center, radius)), invert(CLOUD, center, radius), atol=1e-12
    )
    moved = map_points(CLOUD, similarity(2.5, turn, center))
    np.testing.assert_allclose(moved, 2.5 * CLOUD @ turn.T + center, atol=1e-13)
    plane = from_plane(turn[0], np.array(0.7))
    mirrored = CLOUD - 2 * (CLOUD @ turn[0] - 0.7)[:, None] * turn[0]
    np.testing.assert_allclose(map_points(CLOUD, reflection(plane)), mirrored, atol=1e-13)
    sphere = from_center_radius(center, np.array(radius**2))
    assert_maps_close(reflection(-4 * sphere), inversion(center, radius))
    quarter = rotation_about([0, 0, np.pi / 2])
    np.testing.assert_allclose(quarter @ [1, 0, 0], [0, 1, 0], atol=1e-15)


@given(transform=MAPS)
def test_law_a8_rows_as_the_matrix_has_it(transform: FloatArray) -> None:
    """The action on rows is the matrix on pentaspherical coordinates."""
    rows = normalize(from_center_radius(CLOUD, np.full(6, 1.3)))
    expected = pentaspherical(rows) @ transform.T
    size = np.abs(transform).max() * np.abs(rows).max()
    found = pentaspherical(map_spheres(rows, transform))
    np.testing.assert_allclose(found, expected, atol=1e-11 * size)


@given(transform=MAPS)
def test_law_a8_products_incidence_and_sides(transform: FloatArray) -> None:
    rows = normalize(from_center_radius(CLOUD, np.full(6, 1.3)))
    rows[3:] = from_plane(unit(CLOUD[3:]), np.array([0.1, -0.4, 0.0]))
    images = map_spheres(rows, transform)
    size = np.abs(images).max() ** 2
    np.testing.assert_allclose(
        minkowski(images[:, None], images), minkowski(rows[:, None], rows), atol=1e-12 * size
    )
    points = tame(project(rows, np.full(3, 0.5)) * 1.0, transform)
    away = map_points(points, transform)
    # What is on a sphere stays on it, the rest on its side.
    before = evaluate(rows[:, None], points)
    after = evaluate(images[:, None], away)
    tolerance = 1e-12 * np.abs(images).max() * (1 + dot(away, away).max())
    is_on = np.abs(before) <= 1e-12
    assert np.abs(after[is_on]).max(initial=0) <= 10 * tolerance
    is_clear = ~is_on & (np.abs(after) > 10 * tolerance)
    assert (np.sign(before) == np.sign(after))[is_clear].all()


@given(transform=MAPS)
def test_law_a8_cross_ratio(transform: FloatArray) -> None:
    points = tame(CLOUD, transform)
    assume(len(points) >= 4)
    images = map_points(points, transform)

    def ratio(p: FloatArray) -> float:
        lengths = norm(p[[0, 2, 0, 1]] - p[[1, 3, 2, 3]])
        return float(lengths[0] * lengths[1] / (lengths[2] * lengths[3]))

    assert ratio(images) == pytest.approx(ratio(points), rel=1e-9)


# A8 for circles and arcs


@given(transform=MAPS, center=POINTS, axis=directions(), radius=st.floats(0.3, 2))
def test_law_a8_circles(
    transform: FloatArray, center: FloatArray, axis: FloatArray, radius: float
) -> None:
    circle = Circles(center, axis, np.array(radius**2))
    x = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]))
    turns = np.linspace(0, 6, 7)[:, None]
    ring = center + radius * (np.cos(turns) * x + np.sin(turns) * np.cross(axis, x))
    assume((~sent_to_infinity(ring, transform)).all())
    moved = map_points(ring, transform)
    assume(norm(moved).max() < 50)
    image = map_circles(circle, transform)
    assume(image.radii_squared < 1e4)
    size = 1 + image.radii_squared
    relative = moved - image.centers
    np.testing.assert_allclose(relative @ image.normals, 0, atol=1e-10 * size)
    np.testing.assert_allclose(norm(relative) ** 2, image.radii_squared, atol=1e-10 * size)
    # Round about the normal as before.
    rounds = [np.cross(relative[i], relative[i + 1]) @ image.normals for i in range(6)]
    assert sum(value > 0 for value in rounds) >= 4
    # The circle of two spheres is the circle of their images.
    pair = intersection_circles(*map_spheres(np.stack(circle_pencils(circle)), transform))
    np.testing.assert_allclose(pair.centers, image.centers, atol=1e-9 * size)
    np.testing.assert_allclose(pair.radii_squared, image.radii_squared, atol=1e-8 * size)


def test_law_a9_circles_that_become_lines() -> None:
    circles = Circles(np.zeros((3, 3)), np.eye(3), np.array([1.0, 1.0, 2.0]))
    with pytest.raises(InputError, match=r"circles \[1, 2\] become straight lines"):
        map_circles(
            Circles(circles.centers, circles.normals[[0, 2, 2]], np.array([4.0, 1, 1])),
            inversion([1, 0, 0], 1),
        )
    image = map_circles(circles, inversion([0, 0, 0], 2))  # about their centre
    np.testing.assert_allclose(image.centers, 0, atol=1e-15)
    np.testing.assert_allclose(image.radii_squared, [16, 16, 8])
    with pytest.raises(InputError, match=r"circles \[0\] are imaginary"):
        map_circles(Circles(np.zeros((1, 3)), np.eye(3)[:1], np.array([-1.0])), np.eye(5))


@given(transform=MAPS)
def test_law_a8_arcs(transform: FloatArray) -> None:
    row = from_plane(np.eye(3)[[2, 2]], np.zeros(2))
    row[1] = normalize(from_center_radius(np.array([0, 0, -1.0]), np.array(1.0)))
    starts = project(row, np.array([[0.5, 0, 0], [0.5, 0.1, 0]]))
    ends = project(row, np.array([[-0.2, 0.6, 0], [-0.2, 0.6, 0]]))
    middles = np.cross(unit(ends - starts), unit(starts + ends + [0, 0, 2.0]))
    planes = unit(np.cross(ends - starts, np.cross(middles, ends - starts)))
    arcs = sphere_arcs(row, planes, starts, ends)
    along = arc_points(arcs, np.linspace(-1, 1, 9))
    assume(not sent_to_infinity(along, transform).any())
    assume(norm(map_points(along, transform)).max() < 20)
    try:
        image = map_arcs(arcs, transform)
    except InputError:
        reject()
    moved = map_points(along, transform)
    np.testing.assert_allclose(image.starts, moved[:, 0], atol=1e-11)
    np.testing.assert_allclose(image.ends, moved[:, -1], atol=1e-11)
    dense = arc_points(image, np.linspace(-1, 1, 20001))
    gap = norm(dense[:, None] - moved[:, :, None]).min(axis=2)
    assert gap.max() <= 1e-3 * norm(image.ends - image.starts).max()
    images = map_spheres(row, transform)[:, None]
    assert np.abs(evaluate(images, dense)).max() <= 1e-10 * (1 + np.abs(images).max())


def test_law_a9_arcs_that_pass_through_infinity() -> None:
    arcs = Arcs(-np.eye(3)[:1], np.eye(3)[:1], np.eye(3)[1:2], np.zeros(1))
    for center in ([1, 0, 0], [0, 0, 0]):
        with pytest.raises(InputError, match=r"arcs \[0\] pass"):
            map_arcs(arcs, inversion(center, 1))
    with pytest.raises(InputError, match=r"arcs \[0\] are more than half"):
        map_arcs(arcs, inversion([0.5, 0, 0], 1))
    straight = map_arcs(arcs, inversion([2, 0, 0], 1))
    assert straight.sagittas[0] == 0
    bent = map_arcs(arcs, inversion([0, 2, 0], 1))
    np.testing.assert_allclose(abs(bent.sagittas[0]), 0.1, atol=1e-15)


# A9


def test_law_a9_planes_and_spheres_swap() -> None:
    center = np.array([0.3, -1.1, 0.7])
    spheres = normalize(from_center_radius(CLOUD, dot(CLOUD - center, CLOUD - center)))
    images = map_spheres(spheres, inversion(center, 1.3))
    assert (images[:, 0] == 0).all()
    np.testing.assert_allclose(minkowski(images, images), 1, atol=1e-12)
    back = map_spheres(images, inversion(center, 1.3))
    np.testing.assert_allclose(back, spheres, atol=1e-12)
    planes = from_plane(unit(CLOUD), np.full(6, 2.0))
    assert (map_spheres(planes, inversion(center, 1.3))[:, 0] != 0).all()
    moved = map_spheres(planes, similarity(2, rotation_about(center), center))
    assert (moved[:, 0] == 0).all()
    through = from_plane(unit(CLOUD), unit(CLOUD) @ center)
    stay = map_spheres(through, inversion(center, 1.3))
    assert (stay[:, 0] == 0).all()
    assert np.isfinite(images).all()


def test_law_a9_points_sent_to_infinity() -> None:
    center = np.array([0.3, -1.1, 0.7])
    points = np.concatenate([CLOUD, center[None], CLOUD, center[None]])
    turned = inversion(center, 2.0)
    assert np.flatnonzero(sent_to_infinity(points, turned)).tolist() == [6, 13]
    with pytest.raises(InputError, match=r"points \[6, 13\] are sent to infinity"):
        map_points(points, turned)
    both = compose([turned, similarity(2, rotation_about(center), center)])
    assert np.flatnonzero(sent_to_infinity(points, both)).tolist() == [6, 13]
    assert not sent_to_infinity(points, compose([turned, turned])).any()


def test_law_a9_vertices_and_faces_at_infinity(octahedron: Mesh) -> None:
    with pytest.raises(InputError, match=r"vertices \[4\] are sent to infinity"):
        map_mesh(octahedron, inversion([0, 0, 1], 1))
    with pytest.raises(InputError, match=r"vertices \[4\] are sent to infinity"):
        map_mesh(octahedron, inversion([0, 1e-7, 1], 1))
    with pytest.raises(InputError, match=r"faces \[\d\] are too near"):
        map_sphere_mesh(face_planes(octahedron), inversion(np.full(3, 1 / 3), 1))
    map_mesh(octahedron, inversion([0, 0, 0.9], 1))


def test_law_a9_reflections_in_nothing() -> None:
    for row in (lift_points(np.ones(3)), from_center_radius(np.zeros(3), np.array(-1.0))):
        with pytest.raises(InputError, match="only real spheres"):
            reflection(row)
    for radius in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="radius must be positive"):
            inversion([0, 0, 0], radius)
    with pytest.raises(InputError, match="3 finite numbers"):
        inversion([0, 0, np.nan], 1)
    with pytest.raises(InputError, match="scale must be positive"):
        similarity(-1)
    with pytest.raises(InputError, match="not orthogonal"):
        similarity(rotation=2 * np.eye(3))


def test_law_a8_matrices_that_are_no_maps() -> None:
    with pytest.raises(InputError, match=r"differs from J by 3"):
        check_transform(2 * np.eye(5))
    with pytest.raises(InputError, match="no Möbius map"):
        map_points(CLOUD, np.zeros((5, 5)))
    with pytest.raises(InputError, match=r"shape \(5, 5\)"):
        check_transform(np.eye(4))
    with pytest.raises(InputError, match="not finite"):
        check_transform(np.diag([1, 1, 1, np.nan, 1]))
    with pytest.raises(InputError, match=r"transform 1: .*no Möbius map"):
        compose([np.eye(5), 2 * np.eye(5)])


# Meshes


CENTERS = {
    "outside": ([5.5, 1.0, 2.0], 3.0),
    "through the hole": ([0.0, 0.1, 0.2], 2.0),
    "inside the solid": ([3.0, 0.2, 0.1], 1.5),
    "near": ([0.0, 0.0, 30.0], 10.0),
}


def by_vertices(sphere_mesh: SphereMesh) -> FloatArray:
    """Angles over the edges, by the ids of their vertices."""
    ends = np.sort(sphere_mesh.mesh.topology.edge_vertices, axis=1)
    return intersection_angles(sphere_mesh)[np.lexsort(ends.T)]


@pytest.fixture(scope="module")
def smooth(nets: dict[str, Mesh]) -> dict[str, SphereMesh]:
    return {name: minimize_angles(fit_spheres(net))[0] for name, net in nets.items()}


def transforms() -> list[FloatArray]:
    turn = similarity(1.7, rotation_about([0.3, -1.1, 0.7]), [1, 2, 3])
    maps = [inversion(*sphere) for sphere in CENTERS.values()]
    return [turn, *maps, compose([maps[0], turn]), compose([maps[2], turn, maps[0]])]


def faces_clear(sphere_mesh: SphereMesh, transform: FloatArray) -> SphereMesh | None:
    try:
        return map_sphere_mesh(sphere_mesh, transform)
    except InputError:
        return None


@pytest.mark.parametrize("number", range(7))
def test_law_a8_sphere_meshes(smooth: dict[str, SphereMesh], number: int) -> None:
    """Angles, incidence and outside are kept on every net that the map can carry."""
    transform, carried = transforms()[number], 0
    for name, before in smooth.items():
        after = faces_clear(before, transform)
        if after is None:
            continue
        carried += 1
        np.testing.assert_allclose(by_vertices(after), by_vertices(before), atol=1e-9)
        agrees = dot(face_normals(after.mesh), after.local_spheres[:, 1:4])
        assert (agrees > 0).all(), name
        size = norm(after.mesh.vertices).max()
        miss = vertex_error(before).max() * size + 1e-10 * size
        if vertex_error(before).max() < 1e-10:
            assert vertex_error(after).max() <= miss * 10, name
        np.testing.assert_allclose(
            after.mesh.vertices, map_points(before.mesh.vertices, transform), atol=1e-12 * size
        )
        rows = map_spheres(before.spheres, transform)
        np.testing.assert_allclose(
            recenter(after.spheres, after.mesh.vertices[0]),
            recenter(rows, after.mesh.vertices[0]),
            atol=1e-9 * (1 + np.abs(rows).max()),
        )
    assert carried >= 3


def signed_volume(mesh: Mesh) -> float:
    centre = mesh.vertices.mean(axis=0)
    corners = mesh.vertices[mesh.corners] - centre
    following = corners[mesh.topology.next_corners]
    firsts = corners[mesh.offsets[:-1]][mesh.topology.corner_faces]
    return float(dot(firsts, np.cross(corners, following)).sum() / 6)


def test_law_a8_outside_stays_outside(nets: dict[str, Mesh]) -> None:
    """About a point of the solid the bounded side of the image is the outside."""
    torus = nets["torus"]
    assert signed_volume(torus) > 0
    assert signed_volume(map_mesh(torus, inversion([6, 0, 0], 2))) > 0
    assert signed_volume(map_mesh(torus, inversion([0, 0, 0], 2))) > 0
    assert signed_volume(map_mesh(torus, inversion([3, 0, 0], 2))) < 0
    mirror = reflection(from_plane(np.eye(3)[0], np.array(9.0)))
    image = map_mesh(torus, mirror)
    assert signed_volume(image) > 0
    # Faces start at the same vertex and run the other way.
    assert image.faces[5].tolist() == np.roll(torus.faces[5][::-1], 1).tolist()
    twice = map_mesh(image, mirror)
    assert (twice.corners == torus.corners).all()


@pytest.mark.parametrize("distance", [1e3, 1e6])
def test_law_a8_far_models_keep_their_digits(
    smooth: dict[str, SphereMesh], distance: float
) -> None:
    """Site coordinates change nothing: shift, invert about a site point, shift back."""
    near, site = smooth["torus"], distance * np.array([1.0, -2.0, 0.3])
    center = np.array([5.5, 1.0, 2.0])
    there, back = similarity(translation=site), similarity(translation=-site)
    far = map_sphere_mesh(near, there)
    expected = map_sphere_mesh(near, inversion(center, 3.0))
    for turned in (
        inversion(site + center, 3.0),
        compose([back, inversion(center, 3.0), there]),
    ):
        image = map_sphere_mesh(far, turned)
        np.testing.assert_allclose(by_vertices(image), by_vertices(near), atol=1e-15 * distance)
        home = map_sphere_mesh(image, back)
        tolerance = 1e-14 * distance
        np.testing.assert_allclose(home.mesh.vertices, expected.mesh.vertices, atol=tolerance)
        np.testing.assert_allclose(
            home.local_spheres, expected.local_spheres, atol=10 * tolerance
        )


def test_law_a8_maps_rounded_away_are_refused() -> None:
    site = similarity(translation=[1e6, 0, 0])
    turn = similarity(rotation=rotation_about([0.3, -1.1, 0.7]))
    back = similarity(translation=[-1e6, 0, 0])
    far = compose([back, inversion([1, 2, 3], 2), turn, site])
    with pytest.raises(InputError, match="lost its digits"):
        map_points(CLOUD, far)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_law_a8_units_change_nothing(smooth: dict[str, SphereMesh], scale: float) -> None:
    center = np.array([5.5, 1.0, 2.0])
    scaled = map_sphere_mesh(smooth["torus"], similarity(scale))
    image = map_sphere_mesh(scaled, inversion(scale * center, 3 * scale))
    expected = map_sphere_mesh(smooth["torus"], inversion(center, 3))
    np.testing.assert_allclose(image.mesh.vertices / scale, expected.mesh.vertices, atol=1e-11)
    np.testing.assert_allclose(by_vertices(image), by_vertices(expected), atol=1e-11)


@pytest.mark.parametrize("name", ["torus", "vase", "enneper"])
def test_law_a8_angle_energy_is_invariant(
    nets: dict[str, Mesh], name: str, assert_spheres_close: Callable[..., None]
) -> None:
    """The optimum of the image is the image of the optimum."""
    mesh, turned = nets[name], inversion([6.0, 1.0, 2.0], 4.0)
    before, report = minimize_angles(face_planes(mesh))
    after, moved = minimize_angles(face_planes(map_mesh(mesh, turned)))
    assert report.converged
    assert moved.converged
    assert moved.energies[-1] == pytest.approx(report.energies[-1], rel=1e-4)
    expected = map_sphere_mesh(before, turned)
    assert_spheres_close(after.local_spheres, expected.local_spheres, 1e-5, oriented=True)


def test_law_a8_the_angle_between_images(smooth: dict[str, SphereMesh]) -> None:
    """Rows of neighbours seen from a shared vertex meet at the angle they met at."""
    before = smooth["torus"]
    turned = inversion([5.5, 1.0, 2.0], 3.0)
    image = map_spheres(before.spheres, turned)
    left, right = before.mesh.topology.edge_faces.T
    vertices = before.mesh.topology.edge_vertices[:, 0]
    spot = map_points(before.mesh.vertices[vertices], turned)
    found = angle(recenter(image[left], spot), recenter(image[right], spot))
    np.testing.assert_allclose(found, intersection_angles(before), atol=1e-9)
