"""Creases stay sharp, caps stay caps, and no part gets rougher than its planes."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import BoolArray, FloatArray, IntArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.creases import crease_edges
from spheremesh.kernel.optimization.angle_minimization import minimize_angles, pencil_angles
from spheremesh.kernel.panels.cutting import cut_panels, edge_gaps
from spheremesh.kernel.panels.panels import mark_creases
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.kernel.surfaces.circular_nets import enneper_net, torus_net

CREASE = np.radians(40)
CUBE = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def cube(per_side: int = 1) -> Mesh:
    """A cube of squares, six sides of per_side² faces."""
    side = np.linspace(-1, 1, per_side + 1)
    u, v = np.meshgrid(side, side, indexing="ij")
    points, faces = list[FloatArray](), list[IntArray]()
    frames = [(0, 1, 2, 1), (1, 0, 2, -1), (2, 0, 1, 1)]
    for axis, a, b, turn in frames:
        for end in (-1, 1):
            corner = np.zeros((per_side + 1, per_side + 1, 3))
            corner[..., axis], corner[..., a], corner[..., b] = end, u, v
            first = np.arange(per_side)[:, None] * (per_side + 1) + np.arange(per_side)
            steps = np.array([0, per_side + 1, per_side + 2, 1])
            quads = first.reshape(-1, 1) + steps + len(points) * (per_side + 1) ** 2
            faces.append(quads if end * turn > 0 else quads[:, ::-1])
            points.append(corner.reshape(-1, 3))
    every, names = np.unique(np.concatenate(points).round(9), axis=0, return_inverse=True)
    return Mesh(every, names.ravel()[np.concatenate(faces)])


def barrel(rise: float) -> Mesh:
    """A vault with an eaves along it, beyond which a wall falls."""
    turn = np.linspace(-0.6, 0.6, 7)
    arch = np.stack([3 * np.sin(turn), 3 * np.cos(turn) - 2], 1)
    wall = arch[-1] + np.array([[0.2, -rise], [0.4, -2 * rise]])
    profile = np.concatenate([arch, wall])
    count = len(profile)
    points = np.concatenate([np.c_[profile[:, 0], np.full(count, y), profile[:, 1]]
                             for y in range(5)])  # fmt: skip
    first = np.arange(4)[:, None] * count + np.arange(count - 1)
    faces = first.reshape(-1, 1) + np.array([0, 1, count + 1, count])
    return Mesh(points, faces)


def openings(sphere_mesh: SphereMesh) -> FloatArray:
    return np.abs(pencil_angles(sphere_mesh, face_circles(sphere_mesh.mesh)[0]))


def means(sphere_mesh: SphereMesh, is_counted: BoolArray) -> tuple[float, float]:
    """Mean angle of planes and of spheres over some edges, in degrees."""
    planes = np.degrees(intersection_angles(face_planes(sphere_mesh.mesh)))[is_counted]
    return planes.mean(), np.degrees(intersection_angles(sphere_mesh))[is_counted].mean()


def test_a_cube_is_flat_panels_or_one_sphere(assert_spheres_close: Callable[..., None]) -> None:
    for per_side in (1, 3):
        mesh = cube(per_side)
        flat, report = minimize_angles(fit_spheres(mesh), crease=CREASE)
        assert_spheres_close(flat.spheres, face_planes(mesh).spheres, 1e-9, oriented=True)
        assert report.is_crease.sum() == 12 * per_side
    one, report = minimize_angles(fit_spheres(cube()), crease=np.pi)
    assert not report.is_crease.any()
    expected = np.array([-0.5, 0, 0, 0, 1.5]) / np.sqrt(3)
    assert_spheres_close(one.spheres, expected * np.sqrt(3) / np.sqrt(3), 1e-6, oriented=True)


@pytest.mark.parametrize("rise", [1.0, 2.0, 5.0])
def test_faces_beside_a_crease_do_not_bulge(rise: float) -> None:
    """A wall below a vault stays flat, and the vault is as smooth as without it."""
    mesh = barrel(rise)
    found, report = minimize_angles(fit_spheres(mesh), crease=CREASE)
    assert report.converged
    assert report.is_crease.sum() == 4
    wall = mesh.vertices[mesh.corners].reshape(-1, 4, 3)[..., 0].min(axis=1) > 1.6
    assert wall.sum() == 8
    assert np.abs(found.spheres[wall, 0]).max() < 1e-9
    vault = Mesh(mesh.vertices, [face for face, low in zip(mesh.faces, wall, strict=True)
                                 if not low])  # fmt: skip
    alone, _ = minimize_angles(fit_spheres(vault), crease=CREASE)
    np.testing.assert_allclose(found.spheres[~wall], alone.spheres, atol=1e-9)
    planar, spherical = means(found, ~report.is_crease)
    assert spherical <= planar * (1 + 1e-9)


def test_panels_meet_at_mitred_creases() -> None:
    """Their walls lie in the plane that bisects the faces, and flat panels leave no gap."""
    mesh = barrel(2.0)
    found, report = minimize_angles(fit_spheres(mesh), crease=CREASE)
    cut, rejected = cut_panels(found, thickness=0.05)
    panels = mark_creases(cut, mesh, CREASE)
    assert not rejected
    assert panels.is_crease.sum() == 2 * report.is_crease.sum()
    edges = panels.edge_ids[panels.is_crease]
    assert set(edges.tolist()) == set(np.flatnonzero(report.is_crease).tolist())
    for edge in np.unique(edges):
        one, other = panels.plane_normals[panels.edge_ids == edge]
        np.testing.assert_allclose(one, -other, atol=1e-12)
    flat = face_planes(cube(2))
    assert edge_gaps(flat, "bisector").max() < 1e-12
    assert not cut_panels(found)[0].is_crease.any()


@pytest.mark.parametrize("bound", [10.0, 30.0, 60.0])
def test_openings_keep_a_bound(bound: float) -> None:
    """At the bound the energy pulls outwards: what is free is an optimum all the same."""
    rng = np.random.default_rng(4)
    mesh = Mesh(cube(3).vertices + 0.08 * rng.normal(size=(56, 3)), cube(3).faces)
    free, _ = minimize_angles(fit_spheres(mesh))
    found, report = minimize_angles(fit_spheres(mesh), max_opening=np.radians(bound))
    assert report.converged
    assert openings(free).max() > np.radians(bound) or bound == 60
    if not report.is_taken_back.any():
        assert openings(found).max() <= np.radians(bound) + 1e-9


def test_two_steep_triangles_get_gentle_panels() -> None:
    """Without a bound the caps of a folded pair close to more than 80 degrees."""
    pair = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    free, _ = minimize_angles(fit_spheres(pair))
    assert np.degrees(openings(free)).max() > 80
    found, _ = minimize_angles(fit_spheres(pair), crease=CREASE, max_opening=np.radians(60))
    assert np.degrees(openings(found)).max() <= 60 + 1e-9
    planar, spherical = means(found, np.ones(1, bool))
    assert spherical < planar
    panels, rejected = cut_panels(found)
    assert panels.n_panels == 2
    assert not rejected
    skew = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], [[0, 1, 2, 3]])
    flat, _ = minimize_angles(fit_spheres(skew))
    assert flat.spheres[0, 0] == 0
    assert not cut_panels(flat)[1]


@pytest.mark.parametrize("seed", range(4))
def test_no_part_is_rougher_than_its_planes(seed: int) -> None:
    """Of rough meshes, part by part: also of pieces where others gain."""
    rng = np.random.default_rng(seed)
    smooth, rough = torus_net(14, 10, 3.0, 1.0), enneper_net(8, 0.9)
    shaken = rough.vertices + 0.03 * seed * rng.normal(size=rough.vertices.shape)
    points = np.concatenate([smooth.vertices, shaken + 30])
    faces = [*smooth.faces, *(face + smooth.n_vertices for face in rough.faces)]
    mesh = Mesh(points, faces)
    found, report = minimize_angles(fit_spheres(mesh), crease=CREASE)
    of_first = mesh.topology.edge_faces[:, 0] < smooth.n_faces
    for is_part in (of_first, ~of_first):
        counted = is_part & ~report.is_crease
        planar, spherical = means(found, counted)
        assert spherical <= planar * (1 + 1e-9)
    np.testing.assert_array_equal(report.is_crease, crease_edges(mesh, CREASE))


def test_saddles_that_would_get_rougher_are_taken_back() -> None:
    x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9), indexing="ij")
    points = np.stack([x, y, 0.5 * (x**2 - y**2)], -1).reshape(-1, 3)
    first = (np.arange(8)[:, None] * 9 + np.arange(8)).reshape(-1, 1)
    quads = first + np.array([0, 9, 10, 1])
    mesh = Mesh(points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    found, report = minimize_angles(fit_spheres(mesh))
    planar, spherical = means(found, np.ones(len(report.is_crease), bool))
    assert spherical <= planar * (1 + 1e-9)
    assert report.is_taken_back.any()
    # What was taken back is no longer the least energy, and the report says so.
    assert report.energies[-1] > report.energies[-2]


def test_weights_and_creases_multiply() -> None:
    mesh = barrel(2.0)
    weights = np.random.default_rng(1).uniform(0.5, 2, len(mesh.topology.edge_corners))
    is_crease = crease_edges(mesh, CREASE)
    one, _ = minimize_angles(fit_spheres(mesh), 0.0, weights, CREASE)
    two, _ = minimize_angles(fit_spheres(mesh), 0.0, np.where(is_crease, 0.0, weights))
    np.testing.assert_array_equal(one.spheres, two.spheres)


def test_creases_do_not_depend_on_the_numbering(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]], rotation: FloatArray
) -> None:
    mesh = barrel(1.5)
    for target in (0.0, 25.0):
        angle = np.radians(target)
        expected, _ = minimize_angles(fit_spheres(mesh), angle, crease=CREASE)
        other, new = renumber(Mesh(1000 * mesh.vertices @ rotation.T, mesh.faces))
        found, _ = minimize_angles(fit_spheres(other), angle, crease=CREASE)
        one, two = expected.local_spheres[:, 0], 1000 * found.local_spheres[new, 0]
        if target == 0:
            np.testing.assert_allclose(two, one, atol=1e-6)
        # A barrel has symmetries, and with a target optima that are images of each other.
        np.testing.assert_allclose(np.sort(np.abs(two)), np.sort(np.abs(one)), atol=1e-5)


@pytest.mark.parametrize("bad", [-0.1, 3.2, np.nan])
def test_openings_lie_between_0_and_180_degrees(bad: float) -> None:
    with pytest.raises(InputError, match="between 0 and 180 degrees"):
        minimize_angles(face_planes(cube()), max_opening=bad)
    with pytest.raises(InputError, match="between 0 and 180 degrees"):
        minimize_angles(face_planes(cube()), crease=bad)
