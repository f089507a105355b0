"""Laws of smooth congruences (C1 to C3, C5, C6) and of spheres at the vertices of a mesh."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm, unit
from spheremesh.kernel.congruences.conjugacy import conjugacy_residuals
from spheremesh.kernel.congruences.curvature_spheres import (
    mean_curvature_spheres,
    sphere_congruence,
    touching_spheres,
)
from spheremesh.kernel.congruences.discrete_envelopes import envelope
from spheremesh.kernel.congruences.smooth_envelopes import (
    SphereJet,
    envelope_points,
    has_real_envelopes,
)
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.curvature import principal_curvatures, vertex_normals
from spheremesh.kernel.spheres.incidence import evaluate, normals
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.rows import (
    Kind,
    center_radius,
    from_center_radius,
    kind,
    lift_points,
    normalize,
    recenter,
)
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net


def random_jets(count: int, slope: float) -> SphereJet:
    """Jets whose radii change about as fast as `slope` says."""
    rng = np.random.default_rng(3)
    centers, along_u, along_v = rng.normal(size=(3, count, 3))
    radii = rng.uniform(0.1, 3, count)
    radii_u, radii_v = slope * rng.normal(size=(2, count))
    return SphereJet(centers, radii, along_u, along_v, radii_u, radii_v)


def surface_jets(count: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Points, unit normals and principal curvatures, some zero or opposite."""
    rng = np.random.default_rng(8)
    points, directions = rng.normal(size=(2, count, 3))
    first, second = rng.normal(size=(2, count))
    first[:20], second[10:30] = 0, 0
    second[30:50] = -first[30:50]
    return points, unit(directions), first, second


def principal_spheres(
    points: FloatArray, directions: FloatArray, first: FloatArray, second: FloatArray
) -> tuple[FloatArray, FloatArray]:
    return (
        touching_spheres(points, directions, first),
        touching_spheres(points, directions, second),
    )


def ellipsoid_evolute(a: float, b: float) -> tuple[SphereJet, FloatArray]:
    """Principal spheres along the meridians of an ellipsoid of revolution, and its points.

    Their centres are the evolute of the meridian, turned about the axis.
    """
    turn, t = np.meshgrid(np.linspace(0.2, 6, 15), np.linspace(0.2, 1.4, 9), indexing="ij")
    cos, sin = np.cos(t), np.sin(t)
    square = a * a * sin**2 + b * b * cos**2
    x, z = (a * a - b * b) / a * cos**3, -(a * a - b * b) / b * sin**3
    x_t, z_t = -3 * (a * a - b * b) / a * cos**2 * sin, -3 * (a * a - b * b) / b * sin**2 * cos
    radii = square**1.5 / (a * b)
    radii_t = 3 * np.sqrt(square) * (a * a - b * b) * sin * cos / (a * b)
    outward = np.stack([np.cos(turn), np.sin(turn), 0 * turn], -1)
    around = np.stack([-np.sin(turn), np.cos(turn), 0 * turn], -1)
    axis = np.array([0, 0, 1.0])
    jet = SphereJet(
        x[..., None] * outward + z[..., None] * axis,
        radii,
        x[..., None] * around,
        x_t[..., None] * outward + z_t[..., None] * axis,
        np.zeros_like(radii),
        radii_t,
    )
    return jet, (a * cos)[..., None] * outward + (b * sin)[..., None] * axis


# C1


@pytest.mark.parametrize("slope", [0.3, 1.0, 3.0])
def test_law_c1_real_envelopes_agree_with_an_explicit_solve(slope: float) -> None:
    jet = random_jets(5000, slope)
    planes = np.stack([jet.centers_u, jet.centers_v], 1)
    right = -jet.radii[:, None] * np.stack([jet.radii_u, jet.radii_v], 1)
    foot = np.einsum("nij,nj->ni", np.linalg.pinv(planes), right)
    meets = norm(foot) < jet.radii
    assert 0.02 < meets.mean() < 0.98
    assert (has_real_envelopes(jet) != meets).sum() == 0
    plus, minus = envelope_points(jet)
    assert (np.isfinite(plus).all(1) == meets).all()
    assert (np.isfinite(minus).all(1) == meets).all()


def test_law_c1_without_a_surface_of_centers_nothing_is_enveloped() -> None:
    jet = random_jets(4, 0.0)
    line = SphereJet(
        jet.centers, jet.radii, jet.centers_u, 2 * jet.centers_u, 0 * jet.radii, 0 * jet.radii
    )
    assert not has_real_envelopes(line).any()


# C2


def test_law_c2_points_satisfy_the_three_equations_and_mirror_each_other() -> None:
    jet = random_jets(5000, 0.3)
    area = np.cross(jet.centers_u, jet.centers_v)
    use = has_real_envelopes(jet) & (norm(area) > 0.1)
    assert use.sum() > 3000
    points = envelope_points(jet)
    for point, side in zip(points, (1, -1), strict=True):
        arm = point - jet.centers
        size = jet.radii**2
        assert (np.abs(dot(arm, arm) - size) / size)[use].max() < 1e-12
        for along, change in ((jet.centers_u, jet.radii_u), (jet.centers_v, jet.radii_v)):
            defect = np.abs(dot(arm, along) + jet.radii * change)
            assert (defect / (jet.radii * norm(along)))[use].max() < 1e-12
        assert (side * dot(arm, area)[use] > 0).all()
    chord = (points[0] - points[1])[use]
    middle = (points[0] + points[1])[use] / 2 - jet.centers[use]
    assert norm(np.cross(unit(chord), unit(area[use]))).max() < 1e-12
    assert (np.abs(dot(middle, unit(area[use]))) / jet.radii[use]).max() < 1e-12


def test_law_c2_discrete_envelopes_tend_to_the_smooth_ones() -> None:
    jet = random_jets(400, 0.1)
    well = has_real_envelopes(jet) & (norm(np.cross(jet.centers_u, jet.centers_v)) > 0.5)
    fields = (
        jet.centers, jet.radii, jet.centers_u, jet.centers_v, jet.radii_u, jet.radii_v
    )  # fmt: skip
    jet = SphereJet(*(field[well] for field in fields))
    plus, minus = envelope_points(jet)
    errors = []
    for step in (1e-2, 1e-3):
        centers = np.stack(
            [
                jet.centers,
                jet.centers + step * jet.centers_u,
                jet.centers + step * jet.centers_v,
            ],
            1,
        )
        radii = np.stack(
            [jet.radii, jet.radii + step * jet.radii_u, jet.radii + step * jet.radii_v], 1
        )
        corners = centers.reshape(-1, 3)
        mesh = Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
        found = envelope(mesh, from_center_radius(corners, radii.ravel() ** 2), "oriented")
        errors.append(
            max(norm(found.points_plus - plus).max(), norm(found.points_minus - minus).max())
        )
    assert errors[1] < 0.02
    assert errors[1] == pytest.approx(errors[0] / 10, rel=0.5)


# C3


def test_law_c3_a_translation_net_is_conjugate() -> None:
    rng = np.random.default_rng(1)
    for dimension in (3, 5):
        first, second = rng.normal(size=(2, 9, dimension))
        net = first[:, None] + second[None]
        along_u, along_v = net[1:, :-1] - net[:-1, :-1], net[:-1, 1:] - net[:-1, :-1]
        mixed = net[1:, 1:] - net[1:, :-1] - along_v
        assert conjugacy_residuals(along_u, along_v, mixed).max() < 1e-14
        # The same net as a projective map: any factor at every point.
        lifted = np.concatenate([net, np.ones((9, 9, 1))], -1)
        lifted *= rng.uniform(0.5, 2, (9, 9, 1))
        corner = lifted[:-1, :-1]
        derivatives = lifted[1:, :-1] - corner, lifted[:-1, 1:] - corner
        mixed = lifted[1:, 1:] - lifted[1:, :-1] - derivatives[1]
        assert conjugacy_residuals(*derivatives, mixed, lift=corner).max() < 1e-13
        assert conjugacy_residuals(*derivatives, mixed).min() > 1e-6


def test_law_c3_helicoid_by_its_closed_form() -> None:
    u, v = np.random.default_rng(2).uniform(-2, 2, (2, 50))
    zero, one = np.zeros(50), np.ones(50)
    along_u = np.stack([np.cos(v), np.sin(v), zero], -1)
    along_v = np.stack([-u * np.sin(v), u * np.cos(v), one], -1)
    mixed = np.stack([-np.sin(v), np.cos(v), zero], -1)
    residuals = conjugacy_residuals(along_u, along_v, mixed)
    np.testing.assert_allclose(residuals, 1 / np.sqrt(1 + u * u), rtol=1e-13)


def test_law_c3_spheres_of_revolution_are_conjugate_in_rows_of_any_scale() -> None:
    rng = np.random.default_rng(4)
    row, change = rng.normal(size=(2, 30, 5))
    row[:, 2] = change[:, 2] = 0
    turned, turned_change = np.zeros((2, 30, 5))
    turned[:, 2], turned_change[:, 2] = row[:, 1], change[:, 1]
    scale, scale_u, scale_v, scale_uv = rng.normal(size=(4, 30, 1))
    along_u = scale_u * row + scale * turned
    along_v = scale_v * row + scale * change
    mixed = scale_uv * row + scale_u * change + scale_v * turned + scale * turned_change
    assert conjugacy_residuals(along_u, along_v, mixed, lift=scale * row).max() < 1e-12
    other = mixed + rng.normal(size=mixed.shape)
    assert conjugacy_residuals(along_u, along_v, other, lift=scale * row).min() > 1e-3


def test_conjugacy_of_what_is_not_finite_is_unknown() -> None:
    along_u, along_v, mixed = np.random.default_rng(5).normal(size=(3, 4, 3))
    expected = conjugacy_residuals(along_u, along_v, mixed)
    along_u[1, 2], mixed[3, 0] = np.inf, np.nan
    found = conjugacy_residuals(along_u, along_v, mixed)
    np.testing.assert_array_equal(found[[0, 2]], expected[[0, 2]])
    assert np.isnan(found[[1, 3]]).all()
    one = conjugacy_residuals(along_u[:1], along_v[:1], mixed[:3])
    np.testing.assert_array_equal(one[0], expected[0])


# C5


def test_law_c5_principal_spheres_touch_the_surface() -> None:
    points, directions, first, second = surface_jets(200)
    for rows, curvatures in zip(
        principal_spheres(points, directions, first, second),
        (first, second),
        strict=True,
    ):
        np.testing.assert_allclose(minkowski(rows, rows), 1, atol=1e-13)
        np.testing.assert_allclose(evaluate(rows, points), 0, atol=1e-13)
        np.testing.assert_allclose(normals(rows, points), directions, atol=1e-14)
        assert (kind(rows) == np.where(curvatures == 0, Kind.PLANE, Kind.SPHERE)).all()
        curved = curvatures != 0
        centers, _ = center_radius(rows[curved])
        arm = directions[curved] / curvatures[curved, None]
        size = norm(arm)[:, None]
        np.testing.assert_allclose(centers / size, (points[curved] + arm) / size, atol=1e-12)


@pytest.mark.parametrize("axes", [(2.0, 3.0), (3.0, 1.0)])
def test_law_c5_principal_congruences_envelop_one_surface(axes: tuple[float, float]) -> None:
    jet, points = ellipsoid_evolute(*axes)
    area = np.cross(jet.centers_u, jet.centers_v)
    change = jet.radii_v[..., None] * jet.centers_u
    np.testing.assert_allclose(norm(change) / norm(area), 1, rtol=1e-13)
    for found in envelope_points(jet):
        np.testing.assert_allclose(found, points, atol=1e-7)
    inward = unit(jet.centers - points)
    rows = touching_spheres(points, inward, 1 / jet.radii)
    np.testing.assert_allclose(center_radius(rows)[0], jet.centers, atol=1e-12)


# C6


def cross_ratio(pencil: FloatArray, rows: list[FloatArray]) -> FloatArray:
    """Of four rows (n, 5) in pencils (n, 2, 5): (ab)(cd) / (bc)(da)."""
    inverse = np.linalg.pinv(pencil.transpose(0, 2, 1))
    a, b, c, d = (np.einsum("nij,nj->ni", inverse, row) for row in rows)

    def det(x: FloatArray, y: FloatArray) -> FloatArray:
        return x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]

    return det(a, b) * det(c, d) / (det(b, c) * det(d, a))


def test_law_c6_the_cross_ratio_with_the_point_is_minus_one() -> None:
    points, directions, first, second = surface_jets(200)
    second = np.where(np.abs(first - second) < 0.1, first + 1, second)
    s, t = principal_spheres(points, directions, first, second)
    central = mean_curvature_spheres(points, directions, first, second)
    pencil = np.stack([touching_spheres(points, directions, 0.0), lift_points(points)], 1)
    ratios = cross_ratio(pencil, [s, lift_points(points), t, central])
    np.testing.assert_allclose(ratios, -1, atol=1e-12)


def test_law_c6_no_mean_curvature_is_a_plane() -> None:
    points, directions, first, _ = surface_jets(200)
    rows = mean_curvature_spheres(points, directions, first, -first)
    assert (kind(rows) == Kind.PLANE).all()
    np.testing.assert_allclose(rows[:, 1:4], directions, atol=1e-15)


def test_law_c6_central_spheres_commute_with_inversion() -> None:
    points, directions, first, second = surface_jets(200)
    center, radius = np.array([0.3, 5.0, -1.0]), 2.0
    mirror = normalize(from_center_radius(center, np.array(radius**2)))

    def inverted(rows: FloatArray) -> FloatArray:
        return rows - 2 * minkowski(rows, mirror)[:, None] * mirror

    s, t = principal_spheres(points, directions, first, second)
    arm = points - center
    images = center + radius**2 * arm / dot(arm, arm)[:, None]
    s, t = inverted(s), inverted(t)
    turned = normals(recenter(s, images), np.zeros(3))
    expected = inverted(mean_curvature_spheres(points, directions, first, second))
    central = mean_curvature_spheres(images, turned, 2 * s[:, 0], 2 * t[:, 0])
    np.testing.assert_allclose(central, expected, atol=1e-12)


# Spheres at the vertices of a mesh


def torus_curvatures(mesh: Mesh) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Outward normals and curvatures on the torus of radii 3 and 1, in falling order."""
    around = norm(mesh.vertices[:, :2])
    side = around - 3
    outward = np.column_stack(
        [mesh.vertices[:, :2] * (side / around)[:, None], mesh.vertices[:, 2]]
    )
    return outward, -side / around, np.full(len(side), -1.0)


def test_law_normals_are_exact_on_spheres_and_planes(ball: Mesh, octahedron: Mesh) -> None:
    for mesh, radius in ((ball, 2.0), (octahedron, 1.0)):
        np.testing.assert_allclose(vertex_normals(mesh), mesh.vertices / radius, atol=1e-13)
    plane = flat_mesh(4, 3)
    np.testing.assert_array_equal(vertex_normals(plane), np.tile([0, 0, 1.0], (20, 1)))


def test_law_normals_are_of_second_order_to_the_boundary() -> None:
    errors = []
    for n in (12, 24, 48):
        mesh = ellipsoid_net(2 * n, n, 2.0, 3.0, 1.2)
        exact = unit(mesh.vertices / np.array([4.0, 4.0, 9.0]))
        errors.append(norm(vertex_normals(mesh) - exact).max())
    assert errors[0] < 0.03
    assert errors[0] > 3.5 * errors[1] > 3.5**2 * errors[2]


def test_curvatures_of_a_torus_converge_as_documented() -> None:
    errors = []
    for n in (12, 24, 48, 96):
        mesh = torus_net(2 * n, n, 3.0, 1.0)
        _, first, second = torus_curvatures(mesh)
        found = principal_curvatures(mesh)
        assert found[2].all()
        errors.append(max(np.abs(found[0] - first).max(), np.abs(found[1] - second).max()))
    np.testing.assert_allclose(errors, [0.39, 0.085, 0.021, 0.005], rtol=0.05)


def test_curvatures_of_a_sphere_converge_as_documented() -> None:
    errors = []
    for n in (8, 16, 32, 64):
        mesh = ellipsoid_net(2 * n, n, 2.0, 2.0, 1.2)
        first, second, _ = principal_curvatures(mesh)
        errors.append(2 * max(np.abs(first + 0.5).max(), np.abs(second + 0.5).max()))
    np.testing.assert_allclose(errors, [0.21, 0.052, 0.013, 0.0033], rtol=0.05)


def test_law_congruence_is_that_of_the_smooth_surface() -> None:
    mesh = torus_net(96, 48, 3.0, 1.0)
    outward, first, second = torus_curvatures(mesh)
    exact = {
        "central": mean_curvature_spheres(mesh.vertices, outward, first, second),
        "first": touching_spheres(mesh.vertices, outward, first),
        "second": touching_spheres(mesh.vertices, outward, second),
    }
    found = {
        "central": sphere_congruence(mesh)[0],
        "first": sphere_congruence(mesh, "principal")[0],
        "second": sphere_congruence(mesh, "principal", which="second")[0],
    }
    for name, rows in found.items():
        np.testing.assert_allclose(minkowski(rows, rows), 1, atol=1e-13)
        np.testing.assert_allclose(evaluate(rows, mesh.vertices), 0, atol=1e-13)
        np.testing.assert_allclose(rows[:, 0], exact[name][:, 0], atol=0.011)
        np.testing.assert_allclose(normals(rows, mesh.vertices), outward, atol=1e-7)


def test_law_tangent_spheres_have_their_centers_at_the_offset(ball: Mesh) -> None:
    distances = np.linspace(-1.5, 3, ball.n_vertices)
    rows, is_fitted = sphere_congruence(ball, "tangent", distances)
    assert is_fitted.all()
    centers, square = center_radius(rows)
    np.testing.assert_allclose(
        centers, ball.vertices * (1 + distances / 2)[:, None], atol=1e-12
    )
    np.testing.assert_allclose(square, distances**2, rtol=1e-10)
    planes, _ = sphere_congruence(ball, "tangent", np.inf)
    assert (kind(planes) == Kind.PLANE).all()


@pytest.mark.parametrize("kind_", ["central", "tangent", "principal"])
def test_law_congruence_does_not_depend_on_units_and_place(
    kind_: str, nets: dict[str, Mesh], rotation: FloatArray
) -> None:
    mesh = nets["roof"]
    rows, _ = sphere_congruence(mesh, kind_, 2.0)
    near = recenter(rows, mesh.vertices)
    for scale, shift in ((1000.0, 0.0), (1e-3, 0.0), (1.0, 1e6)):
        points = scale * mesh.vertices @ rotation.T + shift
        moved, _ = sphere_congruence(Mesh(points, mesh.faces), kind_, 2.0 * scale)
        seen = recenter(moved, points)
        # Coordinates of a million edges are themselves rounded by 1e-10.
        tolerance = 1e-6 if shift else 1e-9
        np.testing.assert_allclose(seen[:, 0] * scale, near[:, 0], atol=tolerance)
        np.testing.assert_allclose(seen[:, 1:4] @ rotation, near[:, 1:4], atol=tolerance)


def test_law_congruence_does_not_depend_on_the_numbering(
    nets: dict[str, Mesh], renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    mesh = nets["roof"]
    shuffled, _ = renumber(mesh)
    rows, again = sphere_congruence(mesh)[0], sphere_congruence(shuffled)[0]
    order = np.lexsort(mesh.vertices.T), np.lexsort(shuffled.vertices.T)
    np.testing.assert_allclose(rows[order[0]], again[order[1]], atol=1e-9)


def test_law_turning_the_faces_over_turns_the_spheres(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    turned = Mesh(mesh.vertices, [face[::-1] for face in mesh.faces])
    first = sphere_congruence(mesh, "principal", which="first")[0]
    second = sphere_congruence(turned, "principal", which="second")[0]
    np.testing.assert_allclose(first, -second, atol=1e-9)


def flat_mesh(rows: int, columns: int) -> Mesh:
    x, y = np.meshgrid(np.arange(rows + 1.0), np.arange(columns + 1.0), indexing="ij")
    ids = np.arange(x.size).reshape(x.shape)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(np.stack([x, y, 0 * x], -1).reshape(-1, 3), faces.reshape(-1, 4))


def test_a_flat_mesh_has_planes_and_a_small_one_says_so() -> None:
    for mesh, fitted in ((flat_mesh(5, 5), True), (flat_mesh(1, 1), False)):
        rows, is_fitted = sphere_congruence(mesh)
        assert (is_fitted == fitted).all()
        np.testing.assert_allclose(rows, np.tile([0, 0, 0, 1, 0], (len(rows), 1)), atol=1e-12)


def test_bad_input_is_named(ball: Mesh) -> None:
    with pytest.raises(InputError, match="need an offset"):
        sphere_congruence(ball, "tangent")
    offsets = np.ones(ball.n_vertices)
    offsets[[3, 5]] = 0, np.nan
    with pytest.raises(InputError, match=r"vertices \[3, 5\]"):
        sphere_congruence(ball, "tangent", offsets)
    with pytest.raises(InputError, match="shape"):
        sphere_congruence(ball, "tangent", offsets[:4])
    with pytest.raises(InputError, match="kind must be"):
        sphere_congruence(ball, "centre")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="which must be"):
        sphere_congruence(ball, "principal", which="third")  # type: ignore[arg-type]
    lonely = Mesh(np.vstack([ball.vertices, [[9, 9, 9]]]), ball.faces)
    with pytest.raises(InputError, match=rf"vertices \[{ball.n_vertices}\] have no normal"):
        sphere_congruence(lonely)
