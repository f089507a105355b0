"""Law E10: triangle meshes without a support structure, a pencil of spheres per triangle."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, unit
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.mobius import map_sphere_mesh
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.mobius_group import inversion
from spheremesh.kernel.spheres.rows import center_radius

NAMES = ["torus", "ellipsoid", "vase", "roof", "bumpy"]


def bumpy(mesh: Mesh, size: float) -> Mesh:
    """Vertices moved at random: no net, no symmetry."""
    shift = np.random.default_rng(3).normal(size=mesh.vertices.shape)
    return Mesh(mesh.vertices + size * shift, mesh.faces)


@pytest.fixture(scope="module")
def triangles(nets: dict[str, Mesh]) -> dict[str, Mesh]:
    """Quads of the nets cut in two, every other one along the other diagonal."""
    result: dict[str, Mesh] = {}
    for name, mesh in nets.items():
        quads = mesh.corners.reshape(-1, 4).copy()
        quads[::2] = np.roll(quads[::2], 1, axis=1)
        faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        result[name] = Mesh(mesh.vertices, faces)
    return {**result, "bumpy": bumpy(result["ellipsoid"], 0.05)}


@pytest.mark.parametrize("name", NAMES)
def test_law_e10_optimum_does_not_depend_on_the_start(
    triangles: dict[str, Mesh], name: str
) -> None:
    mesh = triangles[name]
    best, report = minimize_angles(fit_spheres(mesh))
    assert report.converged
    assert vertex_error(best).max() < 1e-10 * np.ptp(mesh.vertices)
    assert (np.diff(report.energies[1:]) <= 1e-13 * report.energies[1]).all()
    pencils = circle_pencils(face_circles(mesh)[0])
    turns = np.random.default_rng(4).uniform(-1.4, 1.4, mesh.n_faces)
    starts = [face_planes(mesh), SphereMesh.from_local(mesh, pencil_spheres(*pencils, turns))]
    for start in starts:
        again, _ = minimize_angles(start)
        # A contact is a minimum of fourth order: rounding leaves 1e-8 of its angle.
        np.testing.assert_allclose(again.spheres, best.spheres, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_law_e10_no_other_spheres_through_the_corners_are_smoother(
    triangles: dict[str, Mesh], name: str
) -> None:
    mesh = triangles[name]
    best, _ = minimize_angles(face_planes(mesh))
    angles = intersection_angles(best)
    energy = (np.sin(angles) ** 4).sum()
    assert energy < (np.sin(intersection_angles(fit_spheres(mesh))) ** 4).sum()
    pencils = circle_pencils(face_circles(mesh)[0])
    rows = best.local_spheres
    optimum = np.arctan2(
        2 * rows[:, 0] * np.sqrt(face_circles(mesh)[0].radii_squared),
        (rows[:, 1:4] * face_circles(mesh)[0].normals).sum(1),
    )
    rng = np.random.default_rng(5)
    for _ in range(20):
        turns = optimum + 1e-3 * rng.normal(size=mesh.n_faces)
        other = SphereMesh.from_local(mesh, pencil_spheres(*pencils, turns))
        assert (np.sin(intersection_angles(other)) ** 4).sum() > energy


def test_law_e10_triangles_of_a_sphere_return_it() -> None:
    rng = np.random.default_rng(6)
    points = unit(rng.normal(size=(200, 3)))
    from scipy.spatial import ConvexHull

    faces = ConvexHull(points).simplices.astype(np.int64)
    normal = np.cross(*(points[faces[:, i]] - points[faces[:, 0]] for i in (1, 2)))
    inward = (normal * points[faces[:, 0]]).sum(1) < 0
    faces[inward] = faces[inward][:, ::-1]
    best, report = minimize_angles(face_planes(Mesh(points, faces)))
    assert report.converged
    # The paper's energy is flat at its minimum: stage 2 leaves about 1e-4 of an angle.
    centers, squares = center_radius(best.spheres)
    np.testing.assert_allclose(centers, 0, atol=1e-6)
    np.testing.assert_allclose(squares, 1, atol=1e-6)


@pytest.mark.parametrize("name", ["torus", "bumpy"])
def test_law_e10_optimum_commutes_with_mobius_maps(
    triangles: dict[str, Mesh], name: str
) -> None:
    mesh = triangles[name]
    turn = inversion([1.0, 9.0, -2.0], 4.0)
    best, _ = minimize_angles(face_planes(mesh))
    carried = map_sphere_mesh(best, turn)
    again, _ = minimize_angles(fit_spheres(carried.mesh))
    np.testing.assert_allclose(again.local_spheres, carried.local_spheres, atol=1e-6)


@pytest.mark.parametrize("name", ["ellipsoid", "bumpy"])
def test_law_e10_does_not_depend_on_numbering_units_and_place(
    triangles: dict[str, Mesh],
    name: str,
    renumber: Callable[[Mesh], tuple[Mesh, FloatArray]],
) -> None:
    mesh = triangles[name]
    best, _ = minimize_angles(fit_spheres(mesh))
    shuffled, new = renumber(mesh)
    again, _ = minimize_angles(fit_spheres(shuffled))
    np.testing.assert_allclose(again.local_spheres[new], best.local_spheres, atol=1e-6)
    for scale, shift in ((1e3, 0.0), (1e-3, 0.0), (1.0, 1e6)):
        moved, _ = minimize_angles(fit_spheres(Mesh(scale * mesh.vertices + shift, mesh.faces)))
        rows = moved.local_spheres * np.array([scale, 1, 1, 1, 1 / scale])
        np.testing.assert_allclose(rows, best.local_spheres, atol=1e-6)
