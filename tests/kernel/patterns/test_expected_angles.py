"""What spheres gain, foretold from curvatures, against nets and closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh, Surface
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_centroids, face_vector_areas
from spheremesh.kernel.patterns.expected_angles import (
    hexagon_angles,
    quad_angles,
    triangle_angles,
)
from spheremesh.kernel.patterns.gain_report import gain_map, gain_report, is_round
from spheremesh.kernel.patterns.surface_curvatures import surface_curvatures
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net

MAJOR, MINOR, WIDE, HIGH = 3.0, 1.0, 1.0, 1.5


def with_shape(mesh: Mesh, first: np.ndarray, second: np.ndarray) -> Surface:
    """The mesh with the given curvatures; its other fields play no part."""
    both = np.stack([np.maximum(first, second), np.minimum(first, second)], 1)
    axes = np.tile(np.eye(3), (mesh.n_vertices, 1, 1))
    return Surface(mesh, axes[:, 2], both, axes[:, :2], np.ones(mesh.n_vertices, bool))


def exact_torus(n: int) -> Surface:
    """A torus; outside normals, so the tube bends away from them."""
    mesh = torus_net(2 * n, n, MAJOR, MINOR)
    out = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    return with_shape(mesh, -(out - MAJOR) / MINOR / out, np.full(len(out), -1 / MINOR))


def exact_ellipsoid(n: int) -> Surface:
    mesh = ellipsoid_net(2 * n, n, WIDE, HIGH, 1.2)
    z = mesh.vertices[:, 2] / HIGH
    # The meridian is an ellipse; the other curvature is that of the parallel, by Meusnier.
    stretch = np.sqrt(WIDE**2 * z**2 + HIGH**2 * (1 - z**2))
    return with_shape(mesh, -WIDE * HIGH / stretch**3, -HIGH / (WIDE * stretch))


def mean_bend(sphere_mesh: SphereMesh) -> float:
    """Angle between neighbours by distance, a mean over the area."""
    mesh = sphere_mesh.mesh
    left, right = mesh.topology.edge_faces.T
    centroids, areas = face_centroids(mesh), norm(face_vector_areas(mesh))
    bends = intersection_angles(sphere_mesh) / norm(centroids[right] - centroids[left])
    weights = areas[left] + areas[right]
    return float(bends @ weights / weights.sum())


@pytest.mark.parametrize(
    ("surface", "slack"), [(exact_torus(90), 1e-3), (exact_ellipsoid(140), 1e-3)]
)
def test_nets_along_the_lines_of_curvature_meet_as_foretold(
    surface: Surface, slack: float
) -> None:
    found, edge = surface_curvatures(surface), 1e-3
    report = gain_report(found, edge)
    for key, net in (
        ("planes", face_planes(surface.mesh)),
        ("spheres", central_spheres(surface.mesh)),
    ):
        expected = np.radians(report.quads[key]) / edge
        assert mean_bend(net) == pytest.approx(expected, rel=slack)


def test_closed_form_on_the_torus() -> None:
    surface, edge = exact_torus(48), 0.1
    report = gain_report(surface_curvatures(surface), edge)
    # |k1| + |k2| = 1/r + |cos v| / w with w = R + r cos v; the area element is r w dv du.
    planes = (1 / MINOR + 2 / (np.pi * MAJOR)) * edge / 2
    spheres = (1 / MINOR - 0.0) * edge / 2
    assert report.quads["planes"] == pytest.approx(np.degrees(planes), rel=1e-3)
    assert report.quads["spheres"] == pytest.approx(np.degrees(spheres), rel=1e-3)
    # On a mesh curvatures are estimates.
    guessed = gain_report(surface_curvatures(torus_net(192, 96, MAJOR, MINOR)), edge)
    assert guessed.quads["planes"] == pytest.approx(np.degrees(planes), rel=1e-2)


def test_a_sphere_has_angles_of_its_patterns() -> None:
    k = np.array([-0.5])
    assert quad_angles(k, k, 0.2, 0.0) == pytest.approx(0.1)
    assert hexagon_angles(k, k, 0.2, 0.0) == pytest.approx(0.1 * np.sqrt(3))
    assert triangle_angles(k, k, 0.2, 0.0) == pytest.approx(0.1 / np.sqrt(3))
    for angles in (quad_angles, hexagon_angles, triangle_angles):
        assert angles(k, k, 0.2, -0.5) == pytest.approx(0.0, abs=1e-15)


def test_hexagons_grow_long_where_neighbours_are_alike() -> None:
    first, second = np.array([1.0, 1.0]), np.array([0.0, 0.0])
    near, far = np.array([1.02, 1.02]), np.array([9.0, 9.0])
    even = hexagon_angles(first, second, 0.1, near)
    # Nearly alike along the first direction: edges are flipped, and angles are smaller.
    assert (hexagon_angles(first, second, 0.1, near, near) < 0.8 * even).all()
    # A metric that is all but round flips nothing.
    assert hexagon_angles(first, second, 0.1, far, far) == pytest.approx(
        hexagon_angles(first, second, 0.1, far), rel=1e-3
    )


@settings(max_examples=10)
@given(st.floats(-3, 3), st.integers(0, 99))
def test_law_nothing_depends_on_units_place_and_numbers(exponent: float, seed: int) -> None:
    surface, scale = exact_ellipsoid(8), 10.0**exponent
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    order = rng.permutation(surface.mesh.n_vertices)
    place = np.argsort(order)
    points = scale * (surface.mesh.vertices @ turn.T + rng.normal(size=3))
    faces = [place[np.asarray(face)].tolist() for face in surface.mesh.faces]
    moved = with_shape(
        Mesh(points[order], [faces[f] for f in rng.permutation(len(faces))]),
        *(surface.curvatures[order] / scale).T,
    )
    one, other = (surface_curvatures(each) for each in (surface, moved))
    before, after = gain_report(one, 0.2), gain_report(other, 0.2 * scale)
    for name in ("quads", "hexagons", "triangles", "turn_deg"):
        assert after[name] == pytest.approx(before[name], rel=1e-9)
    for which in ("spheres", "one-radius", "planes", "hexagons", "triangles"):
        maps = gain_map(one, 0.2, which), gain_map(other, 0.2 * scale, which)
        assert maps[1] == pytest.approx(maps[0][order], rel=1e-9)


def test_turning_the_normals_changes_nothing() -> None:
    surface = exact_ellipsoid(12)
    turned = with_shape(surface.mesh, *-surface.curvatures.T)
    before, after = (gain_report(surface_curvatures(each), 0.2) for each in (surface, turned))
    assert after.quads == pytest.approx(before.quads, rel=1e-2)
    assert after.hexagons == pytest.approx(before.hexagons)
    assert after.triangles == pytest.approx(before.triangles)


def test_what_is_said() -> None:
    net = torus_net(96, 48, MAJOR, MINOR)
    assert "one radius" in gain_report(surface_curvatures(net), 0.2).advice
    assert "larger than its ribs" in gain_report(surface_curvatures(net), 2.0).advice
    ball = surface_curvatures(ellipsoid_net(48, 24, 1.0, 1.01, 1.2))
    assert is_round(ball, 0.2)
    assert "bisector" in gain_report(ball, 0.2).advice
    assert not is_round(surface_curvatures(exact_torus(24)), 0.2)
    flat = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), [[0, 1, 2, 3]])
    level = gain_report(surface_curvatures(with_shape(flat, np.zeros(4), np.zeros(4))), 0.2)
    assert (level.quads["gain"], level.one_radius["radius"]) == (0.0, None)
    assert "flat" in level.advice


def test_saddles_gain_nothing_in_quads() -> None:
    flat = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), [[0, 1, 2, 3]])
    report = gain_report(surface_curvatures(with_shape(flat, np.ones(4), -np.ones(4))), 0.2)
    assert report.quads["gain"] == pytest.approx(0.0)
    assert "bends to both sides" in report.advice


def test_surfaces_without_curvature_are_refused() -> None:
    triangle = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), [[0, 1, 2]])
    with pytest.raises(InputError, match="known nowhere"):
        surface_curvatures(triangle)
