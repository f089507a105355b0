"""Laws of relaxed congruences (F7): real conjugate nets with axes near the normals."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence, touching_spheres
from spheremesh.kernel.errors import ConvergenceError, InputError
from spheremesh.kernel.meshes.curvature import vertex_normals
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.remesh.field.relax import CongruenceQuality, axis_angle, relax_congruence
from spheremesh.kernel.spheres.incidence import evaluate, normals
from spheremesh.kernel.spheres.rows import recenter, rescale
from spheremesh.kernel.surfaces.circular_nets import torus_net

TARGET = CongruenceQuality(0.02, np.radians(20.0))
UPRIGHT = CongruenceQuality(1.0, np.radians(20.0))


def never_complex(spheres: FloatArray) -> float:
    return 0.0 * len(spheres)


def triangulated(points: FloatArray, *, is_closed: bool = False) -> Mesh:
    """A grid (n, m, 3) of points as triangles; vertices row after row."""
    ids = np.arange(points[..., 0].size).reshape(points.shape[:2])
    if is_closed:
        ids = np.pad(ids, ((0, 1), (0, 1)), mode="wrap")
    corners = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    a, b, c, d = (corner.ravel() for corner in corners)
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return Mesh(points.reshape(-1, 3), triangles)


def bump(n: int = 31) -> Mesh:
    """A freeform hill with a saddle beside it."""
    u, v = np.meshgrid(np.linspace(-1.2, 1.2, n), np.linspace(-1.2, 1.2, n), indexing="ij")
    height = 0.5 * np.cos(0.9 * u) * np.cos(0.7 * v + 0.2) + 0.1 * u * v + 0.08 * u**3
    return triangulated(np.stack([u, v, height], -1))


def share_on_grid(spheres: FloatArray) -> float:
    """Share of the vertices of a square grid at which the conjugate form has no real roots.

    The form by differences along the grid, whose lines are parameter lines.
    """
    n = round(len(spheres) ** 0.5)
    grid = spheres.reshape(n, n, 5)
    along_u, along_v = np.gradient(grid, axis=(0, 1))
    uu, uv = np.gradient(along_u, axis=(0, 1))
    vv = np.gradient(along_v, axis=1)
    pairs = ((uu, uv), (uu, vv), (uv, vv))
    q0, q1, q2 = (
        np.linalg.det(np.stack([grid, along_u, along_v, *pair], -2))[2:-2, 2:-2]
        for pair in pairs
    )
    return float((q1 * q1 <= 4 * q0 * q2).mean())


def test_law_f7_central_spheres_of_a_bump_become_real_and_upright() -> None:
    mesh = bump()
    spheres, _ = sphere_congruence(mesh, "central")
    result = relax_congruence(mesh, spheres, share_on_grid, TARGET)
    assert result.before.complex_share > 0.2
    assert result.before.axis_angle > np.radians(60)
    assert result.after.complex_share < 0.02
    assert result.after.axis_angle < np.radians(20)
    assert share_on_grid(result.spheres) == result.after.complex_share
    assert axis_angle(mesh, result.spheres) == result.after.axis_angle
    assert 0.2 < result.blend < 0.8
    # They still touch the surface, with curvatures on the way to the constant one.
    assert np.abs(evaluate(result.spheres, mesh.vertices)).max() < 1e-12
    agreement = dot(normals(result.spheres, mesh.vertices), vertex_normals(mesh))
    assert agreement.min() > 1 - 1e-12
    expected = (1 - result.blend) * 2 * spheres[:, 0] + result.blend / result.radius
    np.testing.assert_allclose(2 * result.spheres[:, 0], expected, atol=1e-12)


def test_the_blend_is_the_least_one() -> None:
    mesh = bump()
    spheres, _ = sphere_congruence(mesh, "central")
    result = relax_congruence(mesh, spheres, share_on_grid, TARGET)
    constant = touching_spheres(mesh.vertices, vertex_normals(mesh), 1 / result.radius)
    share = result.blend - 0.02
    less = (1 - share) * spheres + share * constant
    assert share_on_grid(less) > 0.02 or axis_angle(mesh, less) > np.radians(20)


def test_fit_congruences_stay() -> None:
    mesh = bump()
    spheres, _ = sphere_congruence(mesh, "tangent", -0.6)
    result = relax_congruence(mesh, spheres, share_on_grid, TARGET)
    assert result.blend == 0
    assert result.before == result.after
    np.testing.assert_allclose(result.spheres, spheres, atol=1e-13)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_given_radius_and_its_side(side: float) -> None:
    mesh = bump()
    spheres, _ = sphere_congruence(mesh, "central")
    result = relax_congruence(mesh, spheres, never_complex, UPRIGHT, radius=side * 0.5)
    assert result.radius == side * 0.5
    assert (side * result.spheres[:, 0] > 0).all()
    assert result.after.axis_angle < np.radians(20)


def test_the_default_radius_is_sharper_than_the_surface() -> None:
    points = torus_net(60, 30, 3.0, 1.0).vertices.reshape(60, 30, 3)
    mesh = triangulated(points, is_closed=True)
    spheres, _ = sphere_congruence(mesh, "central")
    result = relax_congruence(mesh, spheres, never_complex, UPRIGHT)
    # Normals point outwards: centres of central spheres lie inside.
    assert result.radius == pytest.approx(-0.5, rel=0.06)


def test_law_f7_axes_of_a_torus_in_closed_form() -> None:
    """Curvature κ(v) along the tube: tilted by ``κ' / (κ (κ - k))`` towards it."""
    n, m = 240, 120
    points = torus_net(n, m, 3.0, 1.0).vertices.reshape(n, m, 3)
    mesh = triangulated(points, is_closed=True)
    v = np.tile(2 * np.pi * np.arange(m) / m, n)
    along = vertex_normals(mesh)
    curvatures, slope = 3 + np.sin(v), np.cos(v)
    found = axis_angle(mesh, touching_spheres(mesh.vertices, along, curvatures))
    tilts = np.abs(np.arctan(slope / (curvatures * (curvatures + 1))))
    order = np.argsort(tilts)
    passed = np.cumsum((3 + np.cos(v))[order])
    expected = tilts[order][np.searchsorted(passed, 0.95 * passed[-1])]
    assert found == pytest.approx(expected, rel=0.05)


def test_law_f7_similarities_and_numbers_do_not_matter(
    rotation: FloatArray, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    mesh = bump(21)
    spheres, _ = sphere_congruence(mesh, "central")
    expected = relax_congruence(mesh, spheres, never_complex, UPRIGHT)
    rows = recenter(spheres, mesh.vertices)
    size = mean_edge_length(mesh)
    for scale, distance in ((1e-3, 0.0), (1e3, 1e3), (1.0, 1e6)):
        shift = scale * distance * size * np.array([1.0, -0.7, 0.4])
        points = scale * mesh.vertices @ rotation.T + shift
        turned = rows.copy()
        turned[:, 1:4] = rows[:, 1:4] @ rotation.T
        image = Mesh(points, mesh.faces)
        given = -recenter(rescale(turned, scale), -points)  # orientation does not matter
        found = relax_congruence(image, given, never_complex, UPRIGHT)
        assert found.blend == expected.blend
        assert found.radius == pytest.approx(scale * expected.radius, rel=1e-6)
        assert found.after.axis_angle == pytest.approx(expected.after.axis_angle, rel=1e-3)
        np.testing.assert_allclose(
            scale * found.spheres[:, 0], expected.spheres[:, 0], rtol=1e-6
        )
    other, _ = renumber(mesh)
    places = [int(np.argmin(norm(mesh.vertices - point))) for point in other.vertices]
    found = relax_congruence(other, spheres[places], never_complex, UPRIGHT)
    np.testing.assert_allclose(found.spheres, expected.spheres[places], atol=1e-7)


def test_tangent_planes_relax_to_spheres() -> None:
    mesh = bump()
    planes = touching_spheres(mesh.vertices, vertex_normals(mesh), 0.0)
    result = relax_congruence(mesh, planes, never_complex, UPRIGHT)
    assert result.before.axis_angle == pytest.approx(np.pi / 2)
    assert 0 < result.blend < 0.02
    assert (result.spheres[:, 0] > 0).all()


def test_bad_input_is_refused() -> None:
    mesh = bump(9)
    spheres, _ = sphere_congruence(mesh, "central")
    with pytest.raises(InputError, match="no triangles"):
        relax_congruence(torus_net(6, 6, 3.0, 1.0), spheres, never_complex, TARGET)
    with pytest.raises(InputError, match="shape"):
        relax_congruence(mesh, spheres[:5], never_complex, TARGET)
    for radius in (0.0, np.nan, np.inf):
        with pytest.raises(InputError, match="radius must be"):
            relax_congruence(mesh, spheres, never_complex, TARGET, radius)
    far = recenter(spheres[3], np.array([9.0, 9.0, 9.0]))
    for row, words in ((far, "pass their"), ([1, 0, 0, 0, 1], "imaginary"), (np.nan, "finite")):
        bad = spheres.copy()
        bad[3] = row
        with pytest.raises(InputError, match=rf"vertices \[3\] .*{words}"):
            relax_congruence(mesh, bad, never_complex, TARGET)
    grid = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0), [0.0]), -1)[..., 0, :]
    flat = triangulated(grid)
    planes, _ = sphere_congruence(flat, "central")
    with pytest.raises(InputError, match="flat"):
        relax_congruence(flat, planes, never_complex, TARGET)


def test_a_congruence_that_stays_complex_is_an_error() -> None:
    mesh = bump(9)
    spheres, _ = sphere_congruence(mesh, "central")
    with pytest.raises(ConvergenceError, match=r"leave 100\.0% of the area complex"):
        relax_congruence(mesh, spheres, lambda rows: float(len(rows) > 0), TARGET)
