"""Laws of node axes between flat beams, and of the supports made of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.meshes.triangulation import triangulate
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import opposite_corners
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.kernel.spheres.rows import recenter
from spheremesh.kernel.support.annuli import Annuli, twist_angles
from spheremesh.kernel.support.annulus_construction import annuli_in_planes
from spheremesh.kernel.support.beam_axes import beam_axes, beam_edges, upright_directions
from spheremesh.kernel.support.beam_supports import (
    bisector_axes,
    exact_directions,
    node_torsion,
    support_axes,
    wall_planes,
)


def noisy(mesh: Mesh, amount: float = 0.03) -> Mesh:
    shifts = np.random.default_rng(5).normal(size=mesh.vertices.shape)
    return Mesh(mesh.vertices + amount * mean_edge_length(mesh) * shifts, mesh.faces)


def grid(heights: FloatArray, aspect: float = 1.0) -> Mesh:
    n, m = heights.shape
    x, y = np.meshgrid(np.arange(n), aspect * np.arange(m), indexing="ij")
    ids = np.arange(n * m).reshape(n, m)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], 2)
    return Mesh(np.stack([x, y, heights], 2).reshape(-1, 3), faces.reshape(-1, 4))


def twists(mesh: Mesh, directions: FloatArray) -> FloatArray:
    ends = beam_edges(mesh)
    along = unit(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])
    return dot(np.cross(directions[ends[:, 0]], directions[ends[:, 1]]), along)


def price(mesh: Mesh, directions: FloatArray, weight: float) -> float:
    """The sum that axes minimise, which are normals plus leans."""
    upright = upright_directions(mesh)
    rise = dot(-directions, upright)[:, None]
    leans = -directions / rise - upright
    apart = twists(mesh, directions / rise)
    return float(apart @ apart + weight**2 * np.vdot(leans, leans))


# The axis problem


@pytest.mark.parametrize("name", ["roof", "vase", "torus"])
@pytest.mark.parametrize("weight", [0.01, 0.02])
def test_no_axis_can_turn_to_lower_the_price(
    nets: dict[str, Mesh], name: str, weight: float
) -> None:
    mesh = noisy(nets[name])
    directions = beam_axes(mesh, weight)
    least = price(mesh, directions, weight)
    rng = np.random.default_rng(0)
    for size in (1e-5, 1e-3):
        for _ in range(8):
            turned = directions + size * rng.normal(size=directions.shape)
            assert price(mesh, turned, weight) > least
    assert least < price(mesh, -upright_directions(mesh), weight)


@given(factor=st.floats(1e-4, 1e4), seed=st.integers(0, 100))
def test_axes_turn_with_the_mesh_and_do_not_know_its_size(factor: float, seed: int) -> None:
    heights = 0.2 * np.random.default_rng(seed).normal(size=(5, 4))
    mesh = grid(heights)
    turn = np.linalg.qr(np.random.default_rng(seed + 1).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    moved = Mesh(factor * mesh.vertices @ turn.T + factor * 100, mesh.faces)
    found, turned = beam_axes(mesh, 0.02), beam_axes(moved, 0.02)
    np.testing.assert_allclose(turned, found @ turn.T, atol=1e-8)


def test_order_of_faces_and_vertices_does_not_matter(nets: dict[str, Mesh]) -> None:
    mesh = noisy(nets["vase"])
    rng = np.random.default_rng(1)
    places = rng.permutation(mesh.n_vertices)
    where = np.argsort(places)
    faces = [np.roll(where[face], 1) for face in mesh.faces][::-1]
    other = Mesh(mesh.vertices[places], faces)
    np.testing.assert_allclose(beam_axes(other, 0.02), beam_axes(mesh, 0.02)[places], atol=1e-9)


def test_on_a_sphere_all_axes_lead_to_its_center(ball: Mesh) -> None:
    np.testing.assert_allclose(beam_axes(ball, 0.02), -unit(ball.vertices), atol=1e-9)


def test_pieces_do_not_know_of_each_other(nets: dict[str, Mesh]) -> None:
    first, second = noisy(nets["vase"]), noisy(nets["roof"])
    far = second.vertices + 1000
    both = Mesh(
        np.concatenate([first.vertices, far]),
        [*first.faces, *(face + first.n_vertices for face in second.faces)],
    )
    found = beam_axes(both, 0.02)
    np.testing.assert_allclose(found[: first.n_vertices], beam_axes(first, 0.02), atol=1e-8)
    np.testing.assert_allclose(found[first.n_vertices :], beam_axes(second, 0.02), atol=1e-8)


def test_unused_vertices_have_no_axis_and_hinder_nobody(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    more = Mesh(np.concatenate([[[9, 9, 9]], mesh.vertices]), [f + 1 for f in mesh.faces])
    found = beam_axes(more, 0.02)
    assert not found[0].any()
    np.testing.assert_allclose(found[1:], beam_axes(mesh, 0.02), atol=1e-9)


@pytest.mark.parametrize("aspect", [1.0, 0.05])
def test_nets_of_planes_have_flat_beams_however_long_their_faces(aspect: float) -> None:
    """A surface of translation: its planar net is conjugate, and axes nearly please it."""
    x, y = np.meshgrid(np.arange(9.0), aspect * np.arange(9.0), indexing="ij")
    mesh = grid(-0.02 * x**2 - 0.02 * y**2, aspect)
    directions = beam_axes(mesh, 0.02)
    assert np.abs(twists(mesh, directions)).max() < np.radians(0.05)


# Where spheres have exact nodes


def test_exact_nodes_of_spheres_are_kept(nets: dict[str, Mesh]) -> None:
    """A cylinder of revolution: all spheres meet in planes through the axes."""
    sphere_mesh = face_planes(nets["torus"])
    directions = exact_directions(sphere_mesh)
    assert directions is not None
    axes = support_axes(sphere_mesh)
    assert axes.is_exact
    planes = wall_planes(sphere_mesh, "axis", axes.points)
    meet = wall_planes(sphere_mesh, "intersection", None)
    assert norm(np.cross(planes, meet)).max() < 1e-6


def test_spheres_that_miss_their_vertices_have_no_exact_nodes(nets: dict[str, Mesh]) -> None:
    assert exact_directions(fit_spheres(noisy(nets["torus"]))) is None


# Beams and panels


def sphere_meshes(nets: dict[str, Mesh]) -> list[SphereMesh]:
    meshes = [noisy(nets["roof"]), nets["vase"], triangulate(nets["roof"])]
    return [minimize_angles(fit_spheres(mesh), 0.0, None)[0] for mesh in meshes]


def supports(sphere_mesh: SphereMesh) -> list[tuple[str, FloatArray, Annuli]]:
    result: list[tuple[str, FloatArray, Annuli]] = []
    size = mean_edge_length(sphere_mesh.mesh)
    for edges, axes in (
        ("axis", support_axes(sphere_mesh).points),
        ("bisector", bisector_axes(sphere_mesh)),
    ):
        found = annuli_in_planes(sphere_mesh, edges, axes, size / 4, None, np.pi / 2)
        assert not found.rejected
        result.append((edges, axes, found.annuli))
    return result


def test_walls_of_neighbours_lie_in_the_planes_of_their_beam(nets: dict[str, Mesh]) -> None:
    for sphere_mesh in sphere_meshes(nets):
        for edges, axes, annuli in supports(sphere_mesh):
            panels, rejected = cut_panels(
                sphere_mesh, edges, axes=axes if edges == "axis" else None
            )
            assert not rejected
            opposite = opposite_corners(panels)
            pairs = {frozenset(pair): i for i, pair in enumerate(annuli.edge_faces.tolist())}
            for corner in np.flatnonzero(opposite >= 0).tolist():
                owner = panels.corner_panels[corner]
                beam = pairs[frozenset([int(owner), int(panels.neighbors[corner])])]
                normal = annuli.frames[beam, 2]
                offset = normal @ (annuli.origins[beam] - panels.origins[owner])
                sign = np.sign(normal @ panels.plane_normals[corner])
                np.testing.assert_allclose(
                    sign * panels.plane_normals[corner], normal, atol=1e-12
                )
                assert abs(sign * panels.plane_offsets[corner] - offset) < 1e-12


def test_the_outer_circle_halves_the_gap_of_the_panels(nets: dict[str, Mesh]) -> None:
    sphere_mesh = sphere_meshes(nets)[0]
    _, axes, annuli = supports(sphere_mesh)[0]
    rows = sphere_mesh.spheres
    for beam in range(annuli.n_annuli):
        left, right = annuli.edge_faces[beam]
        great = recenter(annuli.outer[beam : beam + 1], -annuli.origins[beam : beam + 1])
        normal = annuli.frames[beam, 2]
        assert (
            abs(great[0, 1:4] @ normal - 2 * great[0, 0] * annuli.origins[beam] @ normal) < 1e-9
        )
        middle = annuli.corners[beam, :, 0].mean(axis=0) + annuli.origins[beam]
        rise = annuli.frames[beam, 1]
        heights = [along(row, middle, rise) for row in (great[0], rows[left], rows[right])]
        if right >= 0:
            apart = abs(heights[1] - heights[2])
            assert abs(heights[0] - np.mean(heights[1:])) < 0.05 * apart + 1e-9
        else:
            np.testing.assert_allclose(heights[0], heights[1], atol=1e-9)
    assert norm(axes[:, 1] - axes[:, 0]).min() > 0


def along(row: FloatArray, point: FloatArray, direction: FloatArray) -> float:
    """Where a line meets a sphere, nearest to the point, by Newton's method."""
    step = 0.0
    for _ in range(30):
        place = point + step * direction
        distance = float(signed_distance(row[None], place[None])[0])
        slope = float(direction @ (row[1:4] - 2 * row[0] * place))
        step -= distance / slope
    return step


def test_torsion_is_the_angle_between_axes_and_beams(nets: dict[str, Mesh]) -> None:
    for sphere_mesh in sphere_meshes(nets):
        for edges, axes, annuli in supports(sphere_mesh):
            planes = wall_planes(sphere_mesh, edges, axes)
            directions = unit(axes[:, 1] - axes[:, 0])
            torsion = node_torsion(beam_edges(sphere_mesh.mesh), planes, directions)
            twist = twist_angles(annuli)
            largest = np.zeros(sphere_mesh.mesh.n_vertices)
            np.maximum.at(largest, annuli.edge_vertices, twist)
            np.testing.assert_allclose(largest, torsion, atol=1e-12)


def test_bisecting_planes_of_an_even_pyramid_meet_in_its_axis() -> None:
    points = [[0, 0, 1], *[[np.cos(t), np.sin(t), 0] for t in np.pi / 3 * np.arange(6)]]
    mesh = Mesh(points, [[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])
    axes = bisector_axes(face_planes(mesh))
    np.testing.assert_allclose(
        axes[0, 1] - axes[0, 0], [0, 0, -mean_edge_length(mesh)], atol=1e-9
    )
