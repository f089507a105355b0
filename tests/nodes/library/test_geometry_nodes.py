"""Operations on single spheres, congruences and transforms, through their nodes."""

from pathlib import Path

import numpy as np
import pytest

import spheremesh as sm
from spheremesh import nodes
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net

CENTERS = np.array([[0.0, 0, 0], [3, 0, 0], [5, 0, 0]])


def test_rows_and_what_they_stand_for() -> None:
    radii = np.array([2.0, 2.0, 1.0])
    balls = nodes.sphere_rows(CENTERS, radii)
    facts = nodes.sphere_facts(balls)
    np.testing.assert_allclose(facts.centers, CENTERS, atol=1e-15)
    np.testing.assert_allclose(facts.radii_squared, radii**2)
    np.testing.assert_allclose(nodes.signed_distance(balls, CENTERS), radii)
    mixed = np.array([[1.0, 0, 0, 0, 0], [1, 0, 0, 0, 1], [0, 0, 0, 1, 2], [1, 0, 0, 0, -1]])
    kinds = nodes.sphere_facts(mixed).kinds.tolist()
    assert kinds == ["point", "imaginary", "plane", "sphere"]
    with pytest.raises(InputError, match=r"rows \[1\] are points"):
        nodes.sphere_rows(CENTERS[:2], np.array([1.0, 0.0]))


def test_pairs_bisectors_and_circles() -> None:
    first = nodes.sphere_rows(np.zeros((4, 3)), 1.0)
    places = np.array([[1.0, 0, 0], [2, 0, 0], [3, 0, 0], [np.sqrt(2), 0, 0]])
    second = nodes.sphere_rows(places, 1.0)
    pairs = nodes.sphere_pairs(first, second)
    np.testing.assert_allclose(pairs.angles, [60, 180, 180, 90], atol=1e-6)
    assert pairs.pencils.tolist() == ["elliptic", "parabolic", "hyperbolic", "elliptic"]
    assert pairs.is_tangent.tolist() == [False, True, False, False]
    assert pairs.is_orthogonal.tolist() == [False, False, False, True]
    halves = nodes.bisectors(first[:1], second[:1])
    to_acute = [nodes.sphere_pairs(halves.acute, s[:1]).angles for s in (first, second)]
    np.testing.assert_allclose(to_acute, 30)
    assert nodes.sphere_pairs(*halves).is_orthogonal.all()
    circles = nodes.intersection_circles(first, second)
    np.testing.assert_allclose(circles.centers[:, 0], places[:, 0] / 2)
    np.testing.assert_allclose(circles.radii_squared, [0.75, 0, -1.25, 0.5], atol=1e-15)


def test_spheres_through_points_and_polar_hyperplanes() -> None:
    rng = np.random.default_rng(4)
    balls = nodes.sphere_rows(rng.normal(size=(9, 3)), 1.5)
    points = rng.normal(size=(9, 4, 3))
    points = points / np.linalg.norm(points, axis=-1, keepdims=True) * 1.5
    points = points + nodes.sphere_facts(balls).centers[:, None]
    found = nodes.sphere_through_points(points)
    np.testing.assert_allclose(np.abs(found), np.abs(balls), atol=1e-9)
    planes = nodes.polar_hyperplanes(balls)
    upright = np.tile([1.0, 0, 0], (9, 1))
    through = nodes.plane_rows(upright, nodes.sphere_facts(balls).centers[:, 0])
    np.testing.assert_allclose((planes * through).sum(axis=1), 0, atol=1e-12)


def test_stereographic_images() -> None:
    points = np.random.default_rng(5).normal(size=(20, 3))
    images = nodes.stereographic(points)
    np.testing.assert_allclose((images**2).sum(axis=1), 1)
    np.testing.assert_allclose(nodes.inverse_stereographic(images), points, atol=1e-12)
    balls = nodes.sphere_rows(points, 0.7)
    north = points + np.array([0, 0, 0.7])
    found = nodes.poles(balls)
    assert not found.is_infinite.any()
    np.testing.assert_allclose((found.poles * nodes.stereographic(north)).sum(axis=1), 1)
    transform = nodes.similarity(2.0, translation=[1, 0, 0])
    expected = nodes.pentaspherical_coordinates(nodes.apply_mobius(balls, transform))
    coordinates = nodes.pentaspherical_coordinates(balls) @ transform.T
    np.testing.assert_allclose(coordinates, expected, atol=1e-12)


def test_transforms_of_circles_and_arcs() -> None:
    turn = nodes.inversion([5.0, 0, 0], 2.0)
    back = nodes.inverse(turn)
    np.testing.assert_allclose(nodes.compose([turn, back]), np.eye(5), atol=1e-12)
    np.testing.assert_array_equal(nodes.sent_to_infinity(CENTERS, turn), [False, False, True])
    mirror = nodes.sphere_rows(np.array([[5.0, 0, 0]]), 2.0)[0]
    np.testing.assert_allclose(nodes.reflection(mirror), turn, atol=1e-12)
    first = nodes.sphere_rows(np.zeros((1, 3)), 2.0)
    second = nodes.sphere_rows(np.array([[0.0, 1, 0]]), 2.0)
    carried = nodes.apply_mobius(nodes.intersection_circles(first, second), turn)
    images = [nodes.apply_mobius(rows, turn) for rows in (first, second)]
    expected = nodes.intersection_circles(*images)
    np.testing.assert_allclose(carried.centers, expected.centers, atol=1e-12)
    net = nodes.fit_spheres(nodes.torus_mesh(12, 6, major_radius=3.0))
    g = sm.Graph()
    arcs = g.add(nodes.edge_arcs, sphere_mesh=g.add(nodes.fit_spheres, mesh=net.mesh))
    moved = g.add(nodes.inversion, center=[9.0, 0, 0], radius=2.0)
    result = g.run(g.add(nodes.apply_mobius, geometry=arcs.arcs, transform=moved))
    starts = nodes.apply_mobius(g.run(arcs).arcs.starts, g.run(moved))
    np.testing.assert_allclose(result.starts, starts, atol=1e-12)


def test_spheres_of_edges_are_bisected_by_principal_spheres() -> None:
    mesh = nodes.torus_mesh(12, 6, major_radius=3.0)
    spheres = nodes.edge_spheres(mesh)
    edges = mesh.topology.edge_faces
    for side in range(2):
        corners = [mesh.vertices[mesh.faces[face]] for face in edges[:, side]]
        miss = [nodes.signed_distance(spheres, np.array(corners)[:, k]) for k in range(4)]
        np.testing.assert_allclose(miss, 0, atol=1e-9)


def test_envelopes_of_congruences() -> None:
    rng = np.random.default_rng(6)
    centers, along_u, along_v = rng.normal(size=(3, 30, 3))
    slopes = 0.1 * rng.normal(size=(2, 30))
    found = nodes.smooth_envelope(centers, np.ones(30), along_u, along_v, *slopes)
    balls = nodes.sphere_rows(centers, 1.0)
    assert found.is_real.sum() > 20
    distances = nodes.signed_distance(balls, found.points_plus)[found.is_real]
    np.testing.assert_allclose(distances, 0, atol=1e-12)
    mixed = 0.3 * along_u - 2 * along_v
    np.testing.assert_allclose(nodes.conjugacy(along_u, along_v, mixed), 0, atol=1e-12)
    lifted = nodes.conjugacy(along_u, along_v, mixed + centers, centers)
    np.testing.assert_allclose(lifted, 0, atol=1e-12)


def test_points_that_spheres_share() -> None:
    sphere_mesh = nodes.central_spheres(nodes.torus_mesh(16, 8, major_radius=3.0))
    mirrored = nodes.mirror_points(sphere_mesh)
    assert mirrored.is_valid.all()
    assert mirrored.residuals.max() < 1e-9
    plus, minus = nodes.circular_envelopes(sphere_mesh)
    assert max(plus.max(), minus.max()) < 1e-9
    moved = nodes.contact_points(sphere_mesh)
    np.testing.assert_allclose(moved.points, sphere_mesh.mesh.vertices, atol=1e-9)
    assert moved.residuals.max() < 1e-9
    fitted = nodes.fit_spheres(ellipsoid_net(8, 5, 1.0, 0.7, 1.2))
    assert (
        nodes.contact_points(fitted).residuals.max() < nodes.vertex_error(fitted).max() + 1e-9
    )


def test_solids_for_cadquery_and_the_check_of_step(tmp_path: Path) -> None:
    sphere_mesh = nodes.central_spheres(nodes.torus_mesh(8, 6, major_radius=3.0))
    cut = nodes.panels(sphere_mesh, thickness=0.02).panels
    with pytest.warns(nodes.NodeWarning, match="cannot be made"):
        annuli = nodes.annulus_support(sphere_mesh, depth=0.1).annuli
    made = nodes.beams(annuli, thickness=0.02).beams
    both = nodes.cadquery_solids(cut, made)
    groups = {child.name: child.children for child in both.children}
    assert list(groups) == ["Panels", "Beams", "Axes"]
    assert len(groups["Panels"]) == cut.n_panels
    assert [child.name for child in groups["Beams"]] == list(made.annuli.ids)
    with pytest.raises(InputError, match="needs panels or beams"):
        nodes.cadquery_solids()
    path = Path(nodes.write_step(cut, tmp_path / "torus.step"))
    assert nodes.check_step(path).findings == ()
    path.write_text(path.read_text().replace("END-ISO-10303-21;", ""))
    assert nodes.check_step(path).report["counts"] == {"S101": 1}
