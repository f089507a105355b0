"""Laws of the model change (E7), of support types (E8) and of sphere bundles (E9)."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_normals, local_corners, mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.mobius import map_sphere_mesh
from spheremesh.kernel.sphere_meshes.model_change import (
    SIGNS,
    Branch,
    Geometry,
    change_model,
    model_points,
    model_spheres,
    sphere_bundle,
)
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.sphere_meshes.support_type import support_type
from spheremesh.kernel.spheres.incidence import evaluate, normals
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.mobius_group import (
    compose,
    inversion,
    rotation_about,
    similarity,
)
from spheremesh.kernel.spheres.mobius_images import map_spheres
from spheremesh.kernel.spheres.rows import (
    center_radius,
    from_center_radius,
    normalize,
    recenter,
)
from spheremesh.kernel.support.beam_tilt import beam_tilt
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net

CENTER = np.array([0.3, -0.2, 0.4])
GEOMETRIES: list[Geometry] = ["hyperbolic", "elliptic"]
BRANCHES: list[Branch] = ["inner", "outer"]


def split_quads(mesh: Mesh) -> Mesh:
    quads = mesh.corners.reshape(-1, 4)
    return Mesh(mesh.vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


def hexagons(n: int = 5) -> Mesh:
    """Planar hexagons: the polar of a triangular net on a paraboloid."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    u, v = 0.3 * (i + 0.5 * j).ravel() - 1.1, (0.3 * 0.87 * j).ravel() - 0.6
    ids = (i * (n + 1) + j).reshape(n + 1, n + 1)
    a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
    triangles = np.stack([np.stack([a, b, d], -1), np.stack([b, c, d], -1)]).reshape(-1, 3)
    # The tangent plane of z = u² + v² at a vertex; three of them meet in a triangle's point.
    planes = np.stack([2 * u, 2 * v, -np.ones_like(u), u * u + v * v], -1)
    points = np.linalg.solve(planes[triangles, :3], planes[triangles, 3:])[..., 0]
    faces: list[IntArray] = []
    for vertex in range((n + 1) ** 2):
        around = np.flatnonzero((triangles == vertex).any(1))
        if len(around) == 6:
            arms = points[around] - points[around].mean(0)
            faces.append(around[np.argsort(np.arctan2(arms[:, 1], arms[:, 0]))])
    return Mesh(points, faces)


@pytest.fixture(scope="module")
def planar_meshes(nets: dict[str, Mesh]) -> dict[str, Mesh]:
    """Planar faces of every degree, within a ball of radius 3 about CENTER."""
    torus = torus_net(16, 8, 1.6, 0.8)
    quads = torus.corners.reshape(-1, 4)
    mixed = [*quads[::2], *quads[1::2][:, [0, 1, 2]], *quads[1::2][:, [0, 2, 3]]]
    return {
        "triangles": split_quads(torus),
        "quads": torus,
        "mixed": Mesh(torus.vertices, mixed),
        "open": nets["catenoid"],
        "hexagons": hexagons(),
    }


# E7


def points_within(count: int) -> FloatArray:
    """Points at every distance below 1, down to nothing and up to the sphere itself."""
    directions = unit(np.random.default_rng(2).normal(size=(count, 3)))
    distances = np.concatenate(
        [10.0 ** -np.arange(1, 16), 1 - 10.0 ** -np.arange(1, 17), np.linspace(0.05, 1, 69)]
    )
    return directions * distances[:, None]


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_law_e7_images_have_the_product_of_the_absolute_sphere(geometry: Geometry) -> None:
    for radius in (1e-3, 1.0, 1e3):
        points = radius * points_within(100)
        inner = model_points(points, geometry, radius)
        outer = model_points(points, geometry, radius, "outer")
        products = dot(inner, outer) / radius**2
        np.testing.assert_allclose(products, SIGNS[geometry], rtol=4e-15)
        assert (norm(inner) <= radius * (1 + 1e-15)).all()
        assert (norm(outer) >= radius * (1 - 1e-15)).all()


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_law_e7_the_printed_formulas_hold(geometry: Geometry) -> None:
    points = points_within(100)[-60:] * 2
    square = dot(points, points)[:, None]
    root = 2 * np.sqrt(np.maximum(4 - SIGNS[geometry] * square, 0))
    small = (SIGNS[geometry] * 4 - SIGNS[geometry] * root) / square
    large = (SIGNS[geometry] * 4 + SIGNS[geometry] * root) / square
    np.testing.assert_allclose(model_points(points, geometry, 2.0), small * points, rtol=1e-12)
    outer = model_points(points, geometry, 2.0, "outer")
    np.testing.assert_allclose(outer, large * points, rtol=1e-12)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_law_e7_near_the_center_points_are_halved(geometry: Geometry) -> None:
    points = 1e-9 * unit(np.random.default_rng(0).normal(size=(20, 3)))
    np.testing.assert_allclose(model_points(points, geometry, 1.0), points / 2, rtol=1e-15)
    np.testing.assert_array_equal(model_points(np.zeros((1, 3)), geometry, 1.0), 0)


def test_law_e7_ideal_points_stay_in_place() -> None:
    points = unit(np.random.default_rng(0).normal(size=(20, 3)))
    for branch in BRANCHES:
        # The square root turns a rounding of the radius into its root.
        images = model_points(points, "hyperbolic", 1.0, branch)
        np.testing.assert_allclose(images, points, atol=5e-8)


@pytest.mark.parametrize("branch", BRANCHES)
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_law_e7_planes_become_spheres(geometry: Geometry, branch: Branch) -> None:
    rng = np.random.default_rng(3)
    points = points_within(100)[15:]
    normal = unit(rng.normal(size=points.shape))
    distances = dot(normal, points)
    rows = model_spheres(normal, distances, geometry, 1.0)
    images = model_points(points, geometry, 1.0, branch)
    scale = 1 + dot(images, images)
    assert np.abs(evaluate(rows, images) / scale).max() < 1e-15
    absolute = from_center_radius(np.zeros(3), np.array(SIGNS[geometry]))
    assert np.abs(minkowski(rows, absolute)).max() < 1e-15
    np.testing.assert_allclose(
        minkowski(rows, rows), 1 - SIGNS[geometry] * distances**2, atol=1e-15
    )


def test_law_e7_elliptic_spheres_meet_the_real_one_in_great_circles() -> None:
    # A great circle lies in a plane through the centre: the radical plane has no offset.
    rng = np.random.default_rng(4)
    rows = model_spheres(unit(rng.normal(size=(50, 3))), rng.normal(size=50), "elliptic", 2.0)
    sphere = from_center_radius(np.zeros(3), np.array(4.0))
    radical = rows - rows[:, :1] * sphere
    assert np.abs(radical[:, 4]).max() < 1e-15


@pytest.mark.parametrize("branch", BRANCHES)
@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("name", ["triangles", "quads", "mixed", "open", "hexagons"])
def test_law_e7_meshes_of_any_degree(
    name: str, geometry: Geometry, branch: Branch, planar_meshes: dict[str, Mesh]
) -> None:
    mesh = planar_meshes[name]
    image = change_model(mesh, geometry, 3.0, CENTER, branch)
    assert vertex_error(image).max() < 1e-12 * np.ptp(image.mesh.vertices)
    assert (image.mesh.degrees == mesh.degrees).all()
    # N stands on the face, and sides are kept: the orientation of faces tells the branch.
    assert (dot(face_normals(image.mesh), image.local_spheres[:, 1:4]) > 0).all()
    is_mirror = branch == "outer" and geometry == "hyperbolic"
    expected = [np.roll(face[::-1], 1) if is_mirror else face for face in mesh.faces]
    for face, other in zip(image.mesh.faces, expected, strict=True):
        np.testing.assert_array_equal(face, other)
    expected_kind = {"hyperbolic": "real", "elliptic": "imaginary"}[geometry]
    assert support_type(image).kind == expected_kind


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_law_e7_the_branches_are_reflections_of_each_other(
    geometry: Geometry, planar_meshes: dict[str, Mesh]
) -> None:
    mesh = planar_meshes["triangles"]
    inner, outer = (change_model(mesh, geometry, 3.0, CENTER, b) for b in BRANCHES)
    turn = [inversion(CENTER, 3.0)]
    if geometry == "elliptic":
        turn.append(similarity(1.0, -np.eye(3), 2 * CENTER))
    mapped = map_sphere_mesh(inner, compose(turn))
    # A coordinate near 0 is rounded as its vertex is: the turn of a map mixes all three.
    differences = norm(mapped.mesh.vertices - outer.mesh.vertices)
    assert (differences / norm(outer.mesh.vertices)).max() < 1e-13
    np.testing.assert_array_equal(mapped.mesh.corners, outer.mesh.corners)
    np.testing.assert_allclose(mapped.spheres, outer.spheres, atol=1e-12)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_law_e7_the_sign_of_rows_follows_the_faces(
    geometry: Geometry, planar_meshes: dict[str, Mesh]
) -> None:
    mesh = planar_meshes["triangles"]
    turned = Mesh(mesh.vertices, [face[::-1] for face in mesh.faces])
    for branch in BRANCHES:
        rows = change_model(mesh, geometry, 3.0, CENTER, branch).spheres
        other = change_model(turned, geometry, 3.0, CENTER, branch).spheres
        np.testing.assert_allclose(other, -rows, atol=1e-12)


@given(exponent=st.floats(-3, 3), shift=st.sampled_from([0.0, 10.0, 1e6]))
def test_law_e7_does_not_depend_on_units_and_place(exponent: float, shift: float) -> None:
    mesh = split_quads(torus_net(12, 6, 1.6, 0.8))
    scale, move = 10**exponent, shift * np.array([1.0, -0.7, 0.3])
    image = change_model(mesh, "hyperbolic", 3.0, CENTER)
    other = change_model(
        Mesh(scale * (mesh.vertices + move), mesh.faces), "hyperbolic", 3.0 * scale,
        scale * (CENTER + move),
    )  # fmt: skip
    rounding = 1e-13 + 1e-15 * shift
    np.testing.assert_allclose(
        other.mesh.vertices / scale - move, image.mesh.vertices, atol=10 * rounding
    )
    units = np.array([scale, 1, 1, 1, 1 / scale])
    np.testing.assert_allclose(
        other.local_spheres * units, image.local_spheres, atol=1000 * rounding
    )


def test_law_e7_does_not_depend_on_the_numbering(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]], planar_meshes: dict[str, Mesh]
) -> None:
    mesh = planar_meshes["mixed"]
    shuffled, new = renumber(mesh)
    for geometry in GEOMETRIES:
        rows = change_model(mesh, geometry, 3.0, CENTER, "outer").spheres
        other = change_model(shuffled, geometry, 3.0, CENTER, "outer").spheres
        np.testing.assert_allclose(other[new], rows, atol=1e-12)


def test_vertices_at_the_center_and_on_the_sphere() -> None:
    mesh = Mesh([[0, 0, 0], [1e-9, 0, 0], [0, 1, 0], [-0.6, 0, 0.8]], [[0, 1, 2], [0, 2, 3]])
    image = change_model(mesh, "hyperbolic", 1.0, np.zeros(3))
    np.testing.assert_allclose(image.mesh.vertices[:2], mesh.vertices[:2] / 2, atol=1e-24)
    np.testing.assert_allclose(image.mesh.vertices[2:], mesh.vertices[2:], atol=5e-8)
    with pytest.raises(InputError, match=r"vertices \[0, 1\] lie at the centre"):
        change_model(mesh, "hyperbolic", 1.0, np.zeros(3), "outer")
    # On the sphere up to the rounding of a far site.
    shift = np.array([1e6, -1e6, 3e5])
    far = change_model(Mesh(mesh.vertices + shift, mesh.faces), "hyperbolic", 1.0, shift)
    np.testing.assert_allclose(far.mesh.vertices - shift, image.mesh.vertices, atol=1e-4)
    assert vertex_error(far).max() < 1e-9


def test_bad_input_is_named(octahedron: Mesh) -> None:
    mesh = octahedron
    with pytest.raises(
        InputError, match=r"vertices \[0, 1, 3, 4\] lie outside .* at least 1\.10"
    ):
        change_model(mesh, "hyperbolic", 1.0, [-0.1, 0, -0.1])
    with pytest.raises(InputError, match=r"faces \[0, 1, 3, 4\] are too near the centre"):
        change_model(mesh, "elliptic", 1.0, np.full(3, 1 / 3), "outer")
    bent = mesh.vertices.copy()
    quads = Mesh(np.vstack([bent, [[2, 2, 0.01]]]), [[0, 6, 1, 4], [1, 2, 4]])
    with pytest.raises(InputError, match=r"faces \[0\] are not planar: .* 0\.22"):
        change_model(quads, "elliptic", 1.0, np.zeros(3))
    with pytest.raises(InputError, match=r"faces \[0\] are not planar"):
        sphere_bundle(quads, np.zeros(3), 1.0)
    with pytest.raises(InputError, match="geometry must be hyperbolic or elliptic"):
        change_model(mesh, "parabolic", 1.0, np.zeros(3))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="branch must be inner or outer"):
        change_model(mesh, "elliptic", 1.0, np.zeros(3), "both")  # type: ignore[arg-type]
    for radius in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="radius must be positive"):
            change_model(mesh, "elliptic", radius, np.zeros(3))
    with pytest.raises(InputError, match="centre must be 3 finite"):
        change_model(mesh, "elliptic", 1.0, [0.0, np.nan, 0.0])
    with pytest.raises(InputError, match=r"vertices \[4\] are sent to infinity"):
        sphere_bundle(mesh, [0, 0, 1], 1.0)
    with pytest.raises(InputError, match=r"faces \[0\] are too near"):
        sphere_bundle(mesh, np.full(3, 1 / 3), 1.0)


# Coplanar neighbours


@pytest.mark.parametrize("geometry", [*GEOMETRIES, "bundle"])
def test_coplanar_neighbours_share_their_sphere(geometry: str) -> None:
    mesh = split_quads(ellipsoid_net(16, 8, 2.0, 2.4, 1.2))
    if geometry == "bundle":
        image = sphere_bundle(mesh, CENTER, 2.0)
    else:
        image = change_model(mesh, geometry, 3.0, CENTER)  # type: ignore[arg-type]
    angles = intersection_angles(image)
    is_shared = np.abs(np.diff(image.mesh.topology.edge_faces)[:, 0]) == 128
    assert is_shared.sum() == 128
    assert angles[is_shared].max() < 1e-9
    assert angles[~is_shared].min() > 1e-3
    tilt = beam_tilt(image)
    assert np.isfinite(tilt).all()
    np.testing.assert_allclose(tilt[is_shared], 0, atol=1e-12)
    for edges in ("bisector", "intersection"):
        made, rejected = cut_panels(image, edges, 0.01, 0.0, None)  # type: ignore[arg-type]
        assert made.n_panels == mesh.n_faces
        assert not rejected


# E8


def random_maps(count: int, seed: int) -> list[FloatArray]:
    """Möbius maps that send a point two to five away from the origin to infinity."""
    rng = np.random.default_rng(seed)
    return [
        compose(
            [
                inversion(unit(rng.normal(size=3)) * rng.uniform(4, 7), rng.uniform(2, 3)),
                similarity(
                    rng.uniform(0.1, 10), rotation_about(rng.normal(size=3)),
                    5 * rng.normal(size=3),
                ),
            ]
        )
        for _ in range(count)
    ]  # fmt: skip


@pytest.fixture(scope="module")
def supported() -> dict[str, tuple[SphereMesh, FloatArray]]:
    """Triangle meshes of a torus through each map, and their ω."""
    mesh = split_quads(torus_net(24, 12, 2.0, 0.8))
    far = CENTER + np.array([0, 0, 2.0])
    plane = normalize(from_center_radius(np.array([5.0, 0, 0]), np.array(64.0)))
    return {
        "real": (
            change_model(mesh, "hyperbolic", 3.6, CENTER),
            from_center_radius(CENTER, np.array(3.6**2)) / 7.2,
        ),
        "imaginary": (
            change_model(mesh, "elliptic", 2.5, CENTER),
            from_center_radius(CENTER, np.array(-(2.5**2))) / 5,
        ),
        "point": (
            sphere_bundle(mesh, far, 2.0),
            from_center_radius(far, np.array(0.0)),
        ),
        "plane": (
            map_sphere_mesh(
                change_model(mesh, "hyperbolic", 8.0, [5.0, 0, 0]), inversion([13.0, 0, 0], 5.0)
            ),
            map_spheres(plane, inversion([13.0, 0, 0], 5.0)),
        ),
        "infinity": (face_planes(mesh), np.array([0, 0, 0, 0, 1.0])),
    }


@pytest.mark.parametrize("kind", ["real", "imaginary", "point", "plane", "infinity"])
def test_law_e8_types_are_found(
    kind: str, supported: dict[str, tuple[SphereMesh, FloatArray]]
) -> None:
    image, omega = supported[kind]
    found = support_type(image)
    assert found.kind == kind
    assert found.residual < 1e-14
    sign = np.copysign(1.0, found.omega @ omega) if kind == "plane" else 1.0
    np.testing.assert_allclose(sign * found.omega, omega, atol=1e-12)


@pytest.mark.parametrize("kind", ["real", "imaginary", "point"])
def test_law_e8_types_are_mobius_invariant(
    kind: str, supported: dict[str, tuple[SphereMesh, FloatArray]]
) -> None:
    image, omega = supported[kind]
    for transform in random_maps(12, 6):
        found = support_type(map_sphere_mesh(image, transform))
        assert found.kind == kind
        center, square = center_radius(map_spheres(omega, transform))
        found_center, found_square = center_radius(found.omega)
        size = norm(center) + np.sqrt(np.abs(square))
        assert norm(found_center - center) < 1e-7 * size
        assert abs(found_square - square) < 1e-7 * size**2


@pytest.mark.parametrize("kind", ["plane", "infinity"])
def test_law_e8_maps_turn_planes_and_infinity_into_spheres_and_points(
    kind: str, supported: dict[str, tuple[SphereMesh, FloatArray]]
) -> None:
    expected = {"plane": "real", "infinity": "point"}[kind]
    for transform in random_maps(5, 7):
        assert support_type(map_sphere_mesh(supported[kind][0], transform)).kind == expected


@pytest.mark.parametrize("noise", [1e-12, 1e-9, 1e-6])
@pytest.mark.parametrize("kind", ["real", "imaginary", "point", "plane", "infinity"])
def test_law_e8_noise_keeps_the_type(
    kind: str, noise: float, supported: dict[str, tuple[SphereMesh, FloatArray]]
) -> None:
    image, omega = supported[kind]
    rng = np.random.default_rng(8)
    for _ in range(10):
        rows = image.spheres + noise * rng.normal(size=image.spheres.shape)
        found = support_type(SphereMesh(image.mesh, rows))
        assert found.kind == kind
        assert 0.1 * noise < found.residual < 10 * noise
        sign = np.copysign(1.0, found.omega @ omega) if kind == "plane" else 1.0
        np.testing.assert_allclose(sign * found.omega, omega, atol=100 * noise)


def test_law_e8_small_spheres_are_told_from_points_as_far_as_noise_allows() -> None:
    rng = np.random.default_rng(9)
    mesh = split_quads(torus_net(24, 12, 2.0, 0.8))
    for sign, kind in ((1.0, "real"), (-1.0, "imaginary")):
        for radius in (0.1, 0.03):
            # Spheres orthogonal to a small one: through the corners, not by the map.
            omega = from_center_radius(CENTER, np.array(sign * radius**2))
            image = orthogonal_spheres(mesh, omega)
            assert support_type(image).kind == kind
            rows = image.local_spheres + 1e-6 * rng.normal(size=image.spheres.shape)
            assert support_type(SphereMesh.from_local(mesh, rows)).kind == kind
        image = orthogonal_spheres(mesh, from_center_radius(CENTER, np.array(sign * 1e-3**2)))
        assert support_type(image).kind == kind
        rows = image.local_spheres + 1e-5 * rng.normal(size=image.spheres.shape)
        assert support_type(SphereMesh.from_local(mesh, rows), 1e-3).kind == "point"


def orthogonal_spheres(mesh: Mesh, omega: FloatArray) -> SphereMesh:
    """Spheres through the corners of triangles, orthogonal to a sphere."""
    planes = face_planes(mesh)
    corners = local_corners(mesh).reshape(-1, 3, 3)
    centers = mesh.vertices[mesh.corners].reshape(-1, 3, 3) - corners
    seen = recenter(omega, centers[:, 0])
    system = np.concatenate(
        [
            np.concatenate(
                [dot(corners, corners)[..., None], -corners, np.ones((*corners.shape[:2], 1))],
                -1,
            ),
            (seen[:, [4, 1, 2, 3, 0]] * np.array([-2.0, 1, 1, 1, -2]))[:, None],
        ],
        1,
    )
    rows = np.linalg.svd(system)[2][:, -1]
    rows *= np.copysign(1.0, dot(rows[:, 1:4], planes.local_spheres[:, 1:4]))[:, None]
    return SphereMesh.from_local(mesh, rows)


@pytest.mark.parametrize("kind", ["real", "imaginary", "point", "infinity"])
def test_law_e8_does_not_depend_on_units_place_and_numbering(
    kind: str,
    supported: dict[str, tuple[SphereMesh, FloatArray]],
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
) -> None:
    image, _ = supported[kind]
    found = support_type(image)
    for scale, shift in ((1e-3, 0.0), (1e3, 0.0), (1.0, 1e6), (1e3, 1e6)):
        mesh = Mesh(scale * (image.mesh.vertices + shift), image.mesh.faces)
        rows = image.local_spheres * np.array([1 / scale, 1, 1, 1, scale])
        moved = support_type(SphereMesh.from_local(mesh, rows))
        assert moved.kind == kind
        assert abs(moved.residual - found.residual) < 1e-15 * (10 + shift)
        if kind != "infinity":
            center = center_radius(moved.omega)[0] / scale - shift
            expected = center_radius(found.omega)[0]
            np.testing.assert_allclose(center, expected, atol=1e-12 + 1e-14 * shift)
    shuffled, new = renumber(image.mesh)
    rows = np.empty_like(image.spheres)
    rows[new] = image.spheres
    again = support_type(SphereMesh(shuffled, rows))
    assert again.kind == kind
    np.testing.assert_allclose(again.omega, found.omega, atol=1e-12)


def test_law_e8_generic_sphere_meshes_have_none(nets: dict[str, Mesh]) -> None:
    for mesh in nets.values():
        for spheres in (fit_spheres(mesh), minimize_angles(fit_spheres(mesh))[0]):
            found = support_type(spheres)
            assert found.kind == "none"
            assert found.residual > 1e-3
            assert np.isfinite(found.omega).all()


def test_spheres_that_leave_a_choice(ball: Mesh, octahedron: Mesh) -> None:
    assert support_type(fit_spheres(ball)).kind in {"real", "imaginary", "plane"}
    # Spheres centred on an axis: every plane through it is orthogonal to them.
    heights = np.linspace(-1, 1, ball.n_faces)
    centers = np.stack([0 * heights, 0 * heights, heights], -1)
    found = support_type(SphereMesh(ball, from_center_radius(centers, 4 - heights)))
    assert found.kind == "plane"
    assert np.abs(found.omega[[0, 3, 4]]).max() < 1e-9
    one = Mesh(octahedron.vertices, octahedron.faces[:1])
    assert support_type(face_planes(one)).kind == "infinity"


def node_axes(sphere_mesh: SphereMesh) -> tuple[FloatArray, FloatArray]:
    """Inner vertices and the direction to the other point of all spheres around each."""
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    inner = np.flatnonzero(~topology.is_boundary_vertex)
    directions = []
    for vertex in inner:
        corners = np.flatnonzero(mesh.corners == vertex)
        faces = topology.corner_faces[corners]
        local = recenter(sphere_mesh.local_spheres[faces], local_corners(mesh)[corners])
        # |x|² A = N·x: the planes of neighbouring spheres' circles meet in the axis.
        a, n = local[:, :1], normals(local, np.zeros((len(local), 3)))
        circles = (a[:, None] * n - a * n[:, None]).reshape(-1, 3)
        directions.append(np.linalg.svd(circles)[2][-1])
    return mesh.vertices[inner], np.array(directions)


@pytest.mark.parametrize("kind", ["real", "imaginary", "point"])
def test_law_e8_axes_pass_through_the_center(
    kind: str, supported: dict[str, tuple[SphereMesh, FloatArray]]
) -> None:
    for transform in (np.eye(5), *random_maps(2, 10)):
        image = map_sphere_mesh(supported[kind][0], transform)
        center = center_radius(support_type(image).omega)[0]
        points, directions = node_axes(image)
        miss = norm(np.cross(points - center, directions))
        assert miss.max() < 1e-9 * (norm(points - center).max() + mean_edge_length(image.mesh))


# E9


def test_law_e9_all_spheres_pass_through_one_point(planar_meshes: dict[str, Mesh]) -> None:
    center = np.array([0.3, 0.1, 4.0])
    for mesh in planar_meshes.values():
        image = sphere_bundle(mesh, center, 1.5)
        residuals = evaluate(recenter(image.spheres, center), np.zeros(3))
        assert np.abs(residuals).max() < 1e-13
        assert vertex_error(image).max() < 1e-13
        assert (dot(face_normals(image.mesh), image.local_spheres[:, 1:4]) > 0).all()
        assert support_type(image).kind == "point"
        # The inversion is its own inverse.
        back = map_sphere_mesh(image, inversion(center, 1.5))
        np.testing.assert_allclose(back.mesh.vertices, mesh.vertices, atol=1e-12)
        assert np.abs(back.spheres[:, 0]).max() < 1e-12
