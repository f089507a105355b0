"""Exact supports: beams and panels meet to rounding, moves are bounded, spelling is free."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.exact_supports import search
from spheremesh.kernel.exact_supports.axes import common_axes
from spheremesh.kernel.exact_supports.curvatures import common_curvatures, one_curvature
from spheremesh.kernel.exact_supports.search import Attempt, find_exact_support
from spheremesh.kernel.exact_supports.setting import Bounds
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.panels.cutting import gaps_along_edges
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles, vertex_error
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.kernel.support.beam_supports import axis_points
from spheremesh.kernel.surfaces.circular_nets import catenoid_net, ellipsoid_net

BOUNDS = Bounds(0.06, 0.7)


def sheared_dome(n: int = 4, m: int = 5, shear: float = 0.12) -> Mesh:
    """A net on an elliptic paraboloid whose lines are off the lines of curvature."""
    u, v = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, m + 1), indexing="ij")
    x, y = (u + shear * v).ravel(), (v + 0.5 * shear * u).ravel()
    vertices = np.stack([x, y, -0.25 * x**2 - 0.35 * y**2], 1)
    ids = np.arange(len(x)).reshape(n + 1, m + 1)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return Mesh(vertices, np.stack(quads, -1).reshape(-1, 4))


@pytest.fixture(scope="module")
def dome() -> Mesh:
    return sheared_dome()


@pytest.fixture(scope="module")
def found(dome: Mesh) -> Attempt:
    return find_exact_support(dome, BOUNDS)


def test_beams_and_panels_meet_to_rounding(dome: Mesh, found: Attempt) -> None:
    assert found.is_exact
    assert found.is_upright
    judged = found.judgement
    assert np.degrees(judged.torsion.max()) < 1e-9
    assert judged.gaps.max() < 1e-10
    assert judged.vertex_miss < 1e-10
    assert judged.heights.max() <= 0.06
    assert judged.slides.max() <= 0.7
    # The design itself is far from it.
    assert np.degrees(judged.flat_angles.mean()) > 1.2 * np.degrees(judged.angles.mean())
    assert np.ptp(found.sphere_mesh.local_spheres[:, 0]) > 0
    assert found.sphere_mesh.mesh.n_faces == dome.n_faces


def test_law_e3_spheres_of_a_node_share_a_second_point(found: Attempt) -> None:
    mesh = found.sphere_mesh.mesh
    size = mean_edge_length(mesh)
    axes = common_axes(found.sphere_mesh)
    rows, faces = found.sphere_mesh.spheres, mesh.topology.corner_faces
    for vertex in np.flatnonzero(~mesh.topology.is_boundary_vertex).tolist():
        around = rows[faces[mesh.corners == vertex]]
        normals = around[:, 1:4] - 2 * around[:, :1] * mesh.vertices[vertex]
        # The way along the axis on which each sphere is left again: N·a / A.
        ways = normals @ axes[vertex] / around[:, 0]
        np.testing.assert_allclose(ways, ways.mean(), rtol=1e-6)
        second = mesh.vertices[vertex] + ways.mean() * axes[vertex]
        assert np.abs(signed_distance(around, second)).max() < 1e-9 * size


def test_panels_cut_on_the_axes_leave_no_gap(found: Attempt) -> None:
    axes = axis_points(found.sphere_mesh.mesh, common_axes(found.sphere_mesh))
    gaps = gaps_along_edges(found.sphere_mesh, "axis", axes)
    size = mean_edge_length(found.sphere_mesh.mesh)
    assert max(gaps.middle.max(), gaps.ends.max()) < 1e-10 * size


def test_one_radius(dome: Mesh) -> None:
    found = find_exact_support(dome, BOUNDS, one_radius=True)
    assert found.is_exact
    curvatures = found.sphere_mesh.local_spheres[:, 0]
    assert np.ptp(curvatures) <= 1e-12 * np.abs(curvatures).max()
    assert np.degrees(found.judgement.torsion.max()) < 1e-6
    assert found.judgement.is_within(BOUNDS)


def same(first: SphereMesh, second: SphereMesh, faces: IntArray | None = None) -> float:
    """How much mean edge and curvatures of two results differ, relatively."""
    left, right = first.local_spheres[:, 0], second.local_spheres[:, 0]
    right = right if faces is None else right[faces]
    left = left * mean_edge_length(first.mesh)
    right = right * mean_edge_length(second.mesh)
    return float(np.abs(left - right).max() / np.abs(left).max())


def test_neither_units_nor_place_nor_turning_matter(
    dome: Mesh, found: Attempt, rotation: FloatArray
) -> None:
    for vertices in (
        1000 * dome.vertices,
        0.3048 * dome.vertices,
        dome.vertices @ rotation.T,
        dome.vertices + np.array([3e3, -2e3, 50.0]),
    ):
        other = find_exact_support(Mesh(vertices, dome.faces), BOUNDS)
        assert same(found.sphere_mesh, other.sphere_mesh) < 1e-6


def test_a_mirror_image_has_the_mirrored_support(dome: Mesh, found: Attempt) -> None:
    mirrored = Mesh(dome.vertices * [-1, 1, 1], [face[::-1] for face in dome.faces])
    other = find_exact_support(mirrored, BOUNDS)
    assert same(found.sphere_mesh, other.sphere_mesh) < 1e-6


def test_faces_turned_over_have_the_same_spheres(dome: Mesh, found: Attempt) -> None:
    over = Mesh(dome.vertices, [face[::-1] for face in dome.faces])
    other = find_exact_support(over, BOUNDS).sphere_mesh
    sizes = -other.local_spheres[:, 0]
    np.testing.assert_allclose(sizes, found.sphere_mesh.local_spheres[:, 0], rtol=1e-6)


def test_numbers_of_faces_and_vertices_do_not_matter(
    dome: Mesh, found: Attempt, renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    shuffled, new = renumber(dome)
    other = find_exact_support(shuffled, BOUNDS)
    assert same(found.sphere_mesh, other.sphere_mesh, new) < 1e-6


def test_far_from_the_origin_it_is_as_exact_as_coordinates(dome: Mesh) -> None:
    far = Mesh(dome.vertices + np.array([1e6, 2e6, 0.0]), dome.faces)
    found = find_exact_support(far, BOUNDS)
    assert found.is_exact
    miss = vertex_error(found.sphere_mesh).max() / mean_edge_length(dome)
    assert miss < 1e-8


def test_of_several_pieces_each_has_its_curvature() -> None:
    first, second = sheared_dome(4, 4), sheared_dome(4, 5)
    upside = second.vertices * [1, 1, -0.5] + [4, 0, 0]
    faces = [*first.faces, *(face + first.n_vertices for face in second.faces)]
    both = Mesh(np.concatenate([first.vertices, upside]), faces)
    curvatures = common_curvatures(both)
    assert len(np.unique(curvatures)) == 2
    assert curvatures[0] * curvatures[-1] < 0
    np.testing.assert_allclose(np.abs(one_curvature(both)), np.abs(one_curvature(both)[0]))
    found = find_exact_support(both, BOUNDS)
    assert found.is_exact
    assert found.judgement.torsion.max() < 1e-9


def test_hexagons_have_one_too() -> None:
    """Of three spheres at a node any have a common axis; here vertices find their spheres."""
    found = find_exact_support(honeycomb(), BOUNDS)
    assert found.is_landed
    assert found.judgement.torsion.max() < 1e-8


def honeycomb() -> Mesh:
    """Hexagons on a paraboloid."""
    centers = [
        (1.5 * i, np.sqrt(3) * (j + 0.5 * (i % 2))) for i in range(-2, 3) for j in range(-2, 3)
    ]
    points: list[tuple[float, float]] = []
    ids: dict[tuple[int, int], int] = {}
    faces: list[list[int]] = []
    for x, y in centers:
        face: list[int] = []
        for k in range(6):
            corner = (x + np.cos(k * np.pi / 3), y + np.sin(k * np.pi / 3))
            key = (round(corner[0] * 1e6), round(corner[1] * 1e6))
            if key not in ids:
                ids[key] = len(points)
                points.append(corner)
            face.append(ids[key])
        faces.append(face)
    flat = np.array(points)
    heights = -0.03 * flat[:, 0] ** 2 - 0.045 * flat[:, 1] ** 2
    return Mesh(np.concatenate([flat, heights[:, None]], axis=1), faces)


def test_planes_stay_planes() -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij")
    ids = np.arange(20).reshape(4, 5)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(20)], 1)
    found = find_exact_support(Mesh(vertices, np.stack(quads, -1).reshape(-1, 4)), BOUNDS)
    assert found.is_landed
    np.testing.assert_allclose(intersection_angles(found.sphere_mesh), 0, atol=1e-9)
    assert found.judgement.moves.max() < 1e-9


def test_a_sphere_stays_where_it_is() -> None:
    ball = ellipsoid_net(12, 6, 2.0, 2.0, 1.2)
    found = find_exact_support(ball, BOUNDS)
    assert found.is_exact
    assert found.judgement.moves.max() < 0.01
    assert np.degrees(found.judgement.angles.max()) < 1.5


def test_bounds_are_kept() -> None:
    narrow = Bounds(0.03, 0.4)
    found = find_exact_support(sheared_dome(shear=0.06), narrow)
    assert found.is_exact
    assert found.judgement.is_within(narrow)


def test_bounds_that_are_too_tight_lead_to_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "SEARCHES", search.SEARCHES[:2])
    tight = find_exact_support(sheared_dome(3, 3), Bounds(0.0, 0.001))
    assert not tight.is_exact
    assert len(tight.tried) == 2


def test_triangles_are_refused() -> None:
    net = catenoid_net(8, 4, 1.0, 1.0)
    split = [part for a, b, c, d in net.faces for part in ([a, b, c], [a, c, d])]
    with pytest.raises(InputError, match="triangles"):
        find_exact_support(Mesh(net.vertices, split), BOUNDS)


@pytest.mark.parametrize("bounds", [Bounds(-1.0, 0.7), Bounds(0.06, float("nan"))])
def test_bounds_must_be_lengths(dome: Mesh, bounds: Bounds) -> None:
    with pytest.raises(InputError, match="must be a number from 0 on"):
        find_exact_support(dome, bounds)
