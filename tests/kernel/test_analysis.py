"""Measures of meshes and sphere meshes."""

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.analysis import (
    angle_histogram,
    deviation,
    spiky_faces,
)
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_normals, mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.panels.cutting import edge_arcs, edge_gaps
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.planarity_circularity import circularity, planarity
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.kernel.support.beam_tilt import beam_tilt
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net, vase_net


def optimum(mesh: Mesh) -> SphereMesh:
    return minimize_angles(fit_spheres(mesh))[0]


def reflected(sphere_mesh: SphereMesh) -> SphereMesh:
    """Every sphere reflected in the plane of its face."""
    circles, _ = face_circles(sphere_mesh.mesh)
    rows = pencil_spheres(*circle_pencils(circles), -pencil_angles(sphere_mesh, circles))
    return SphereMesh.from_local(sphere_mesh.mesh, rows)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_planarity_and_circularity_of_a_bent_square(scale: float) -> None:
    corners = scale * np.array([[1, 1, 0.1], [-1, 1, -0.1], [-1, -1, 0.1], [1, -1, -0.1]])
    mesh = Mesh(corners, [[0, 1, 2, 3]])
    assert planarity(mesh) == pytest.approx([0.1 * scale], rel=1e-12)
    assert circularity(mesh) == pytest.approx([0.1 * scale], rel=1e-12)


def test_circularity_of_a_rectangle_pulled_at_a_corner() -> None:
    mesh = Mesh([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1.2, -1.2, 0]], [[0, 1, 2, 3]])
    assert planarity(mesh) == pytest.approx([0.0], abs=1e-15)
    assert 0.01 < circularity(mesh)[0] < 0.2


def test_triangles_are_planar_and_circular() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0.3], [1, 1, 1]], [[0, 1, 2], [2, 1, 3]])
    np.testing.assert_allclose(planarity(mesh), 0, atol=1e-15)
    np.testing.assert_allclose(circularity(mesh), 0, atol=1e-15)


def test_beams_of_mirror_images_stand_upright() -> None:
    """Around a surface of revolution neighbours are mirror images: no tilt, no gap."""
    spheres = optimum(vase_net(16, 1, 1.0, 0.4, 0.3))
    np.testing.assert_allclose(beam_tilt(spheres), 0, atol=1e-7)
    np.testing.assert_allclose(edge_gaps(spheres, "bisector"), 0, atol=1e-12)


def test_tilt_of_two_spheres_in_closed_form() -> None:
    """Two squares folded by 2a, spheres of different radius: the plane of their circle."""
    mesh = Mesh(
        [[0, 0, 0], [0, 1, 0], [-1, 0, -0.2], [-1, 1, -0.2], [1, 0, -0.2], [1, 1, -0.2]],
        [[0, 1, 3, 2], [1, 0, 4, 5]],
    )
    circles, _ = face_circles(mesh)
    angles = np.array([-0.3, -0.5])
    spheres = SphereMesh.from_local(mesh, pencil_spheres(*circle_pencils(circles), angles))
    rows = spheres.spheres
    centers = rows[:, 1:4] / (2 * rows[:, :1])
    circle_normal = centers[1] - centers[0]
    bisector_normal = np.cross(face_normals(mesh).sum(0), [0, 1.0, 0])
    cosine = abs(circle_normal @ bisector_normal) / (
        norm(circle_normal) * norm(bisector_normal)
    )
    assert beam_tilt(spheres) == pytest.approx([np.arccos(cosine)], rel=1e-7)


def test_tilt_is_between_upright_and_tangential() -> None:
    tilt = beam_tilt(optimum(torus_net(24, 12, 3.0, 1.0)))
    assert (tilt >= 0).all()
    assert (tilt <= np.pi / 2).all()
    np.testing.assert_allclose(beam_tilt(face_planes(torus_net(8, 6, 3.0, 1.0))), 0, atol=1e-12)


def test_reflected_spheres_are_spiky_and_the_others_are_not() -> None:
    spheres = optimum(ellipsoid_net(16, 8, 1.0, 1.4, 1.1))
    assert not spiky_faces(spheres).any()
    assert spiky_faces(reflected(spheres)).all()
    assert not spiky_faces(face_planes(spheres.mesh)).any()


def test_histogram_counts_every_edge_once() -> None:
    spheres = optimum(vase_net(16, 8, 1.0, 3.0, 0.3))
    counts = angle_histogram(spheres, 12)
    edges = len(spheres.mesh.topology.edge_corners)
    assert counts.spheres.sum() == counts.planes.sum() == edges
    below = (intersection_angles(spheres) < counts.bounds[4]).sum()
    assert counts.spheres[:4].sum() == below
    middles = (counts.bounds[1:] + counts.bounds[:-1]) / 2
    assert counts.spheres @ middles < counts.planes @ middles
    with pytest.raises(InputError, match="at least 1 bin"):
        angle_histogram(spheres, 0)


def test_histogram_of_one_face() -> None:
    counts = angle_histogram(face_planes(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])))
    assert counts.spheres.sum() == counts.planes.sum() == 0


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_planes_do_not_deviate_and_caps_by_their_height(shift: float) -> None:
    mesh = Mesh(
        np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]]) + shift, [[0, 1, 2, 3]]
    )
    assert deviation(face_planes(mesh), mesh) == pytest.approx([0], abs=1e-9)
    circles, _ = face_circles(mesh)
    rows = pencil_spheres(*circle_pencils(circles), np.array([-np.arcsin(1 / 3)]))
    cap = SphereMesh.from_local(mesh, rows)
    assert deviation(cap, mesh) == pytest.approx([3 - np.sqrt(8)], rel=1e-9)


@pytest.mark.parametrize("mode", ["intersection", "bisector"])
def test_edge_arcs_lie_on_their_spheres(mode: str) -> None:
    spheres = optimum(vase_net(12, 6, 1.0, 2.0, 0.3))
    arcs = edge_arcs(spheres, mode)  # pyright: ignore[reportArgumentType]
    points = arc_points(arcs, np.linspace(-1, 1, 7))
    rows = spheres.spheres[spheres.mesh.topology.corner_faces][:, None]
    np.testing.assert_allclose(signed_distance(rows, points), 0, atol=1e-13)


def test_arcs_of_neighbours_coincide_where_spheres_meet() -> None:
    spheres = optimum(vase_net(12, 6, 1.0, 2.0, 0.3))
    topology = spheres.mesh.topology
    points = arc_points(edge_arcs(spheres, "intersection"), np.linspace(-1, 1, 7))
    first, second = topology.edge_corners, topology.twins[topology.edge_corners]
    np.testing.assert_allclose(points[first], points[second][:, ::-1], atol=1e-9)
    apart = norm(
        arc_points(edge_arcs(spheres, "bisector"), np.zeros(1))[first, 0]
        - arc_points(edge_arcs(spheres, "bisector"), np.zeros(1))[second, 0]
    )
    np.testing.assert_allclose(apart, edge_gaps(spheres, "bisector"), atol=1e-12)
    assert apart.max() > 1e-3 * mean_edge_length(spheres.mesh)
