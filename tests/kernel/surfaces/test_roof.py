import numpy as np
import pytest

from spheremesh.kernel.arrays import norm
from spheremesh.kernel.meshes.mesh import face_normals, mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.kernel.surfaces.circular_nets import roof_net


@pytest.mark.parametrize("counts", [(1, 1), (2, 3), (12, 30), (24, 60), (40, 20)])
def test_roof_is_circular_and_looks_up_at_any_resolution(counts: tuple[int, int]) -> None:
    mesh = roof_net(*counts, 80.0)
    _, miss = face_circles(mesh)
    assert miss.max() < 1e-12 * mean_edge_length(mesh) * 80
    assert (face_normals(mesh)[:, 2] > 0).all()
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(80.0)
    assert mesh.vertices[:, 2].min() == pytest.approx(0.0)


@pytest.mark.parametrize("fineness", [1, 2, 4])
def test_panels_of_the_roof_are_alike_in_size(fineness: int) -> None:
    mesh = roof_net(12 * fineness, 30 * fineness, 80.0)
    ends = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    sides = norm(ends - mesh.vertices[mesh.corners]).reshape(-1, 4)
    assert sides.max() / sides.min() < 4
    along, across = sides[:, 0] + sides[:, 2], sides[:, 1] + sides[:, 3]
    assert np.maximum(along / across, across / along).max() < 1.6


def test_plan_of_the_roof_does_not_fold() -> None:
    mesh = roof_net(24, 60, 80.0)
    plan = mesh.vertices[mesh.corners, :2].reshape(-1, 4, 2)
    first, second = plan[:, 2] - plan[:, 0], plan[:, 3] - plan[:, 1]
    assert (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0).all()


def test_spheres_halve_the_angles_of_the_roof() -> None:
    planes = face_planes(roof_net(24, 60, 80.0))
    smooth, _ = minimize_angles(planes)
    before, after = intersection_angles(planes), intersection_angles(smooth)
    assert np.degrees(before.mean()) > 4
    assert after.mean() < before.mean() / 2
    assert np.median(after) < np.median(before) / 3


def test_roof_has_hills_and_saddles() -> None:
    mesh = roof_net(24, 60, 80.0)
    faces = np.array(mesh.faces)
    defect = np.full(mesh.n_vertices, 2 * np.pi)
    for corner in range(4):
        here, after, before = (
            mesh.vertices[faces[:, (corner + shift) % 4]] for shift in (0, 1, 3)
        )
        a, b = after - here, before - here
        cosine = (a * b).sum(1) / norm(a) / norm(b)
        np.subtract.at(defect, faces[:, corner], np.arccos(cosine))
    inner = defect[~mesh.topology.is_boundary_vertex]
    assert 0.5 < (inner > 0).mean() < 0.8
