"""Identical panels: found wherever they stand, mirror images told apart."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.congruent import congruent_panels
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.surfaces.circular_nets import torus_net


def curved(mesh: Mesh, angles: FloatArray | float) -> SphereMesh:
    """Spheres through the circles of the faces; angle 0 is the plane."""
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.broadcast_to(angles, mesh.n_faces)
    return SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))


def random_rotation(seed: int) -> FloatArray:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


def scattered(seed: int, scale: float = 1.0) -> tuple[SphereMesh, list[int]]:
    """Separate faces: copies of a triangle, a kite, a quad and its mirror image, a pentagon."""
    rng = np.random.default_rng(seed)
    turns = {
        3: [0.1, 2.0, 4.5],
        4: [0.0, 1.0, 2.9, 4.0],
        5: [0.0, 1.0, 2.0, 3.5, 5.0],
    }
    shapes = [
        (3, 1, 0.3), (4, 1, 0.2), (4, -1, 0.2), (4, 1, -0.2), (5, 1, 0.0), (4, 1, 0.21),
    ]  # fmt: skip
    kinds = rng.permutation(np.repeat(np.arange(len(shapes)), 4)).tolist()
    vertices: list[FloatArray] = []
    faces: list[list[int]] = []
    for kind in kinds:
        degree, mirror, _ = shapes[kind]
        angles = mirror * np.array(turns[degree])[::mirror]
        points = np.stack([np.cos(angles), np.sin(angles), 0 * angles], 1)
        points = np.roll(points, rng.integers(degree), axis=0)
        points = points @ random_rotation(int(rng.integers(1 << 30))).T
        start = sum(map(len, vertices))
        vertices.append(scale * (points + rng.uniform(-50, 50, 3)))
        faces.append(list(range(start, start + degree)))
    mesh = Mesh(np.concatenate(vertices), faces)
    return curved(mesh, np.array([shapes[kind][2] for kind in kinds])), kinds


def marks(panels: Panels) -> list[FloatArray]:
    both = np.concatenate([panels.corners, panels.inner_corners], axis=1)
    return np.split(both, panels.offsets[1:-1])


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.sampled_from([1e-3, 1.0, 1e3]))
def test_law_copies_are_found_in_any_place_and_turn(seed: int, scale: float) -> None:
    found, kinds = scattered(seed, scale)
    panels, rejected = cut_panels(found, thickness=0.05 * scale, joint_gap=0.01 * scale)
    assert not rejected
    same = congruent_panels(panels)
    expected = {kind: i for i, kind in enumerate(dict.fromkeys(kinds))}
    assert same.labels.tolist() == [expected[kind] for kind in kinds]
    assert same.representatives.tolist() == [kinds.index(kind) for kind in expected]


def test_law_motions_carry_the_first_panel_onto_the_others() -> None:
    panels, _ = cut_panels(scattered(3)[0], thickness=0.05)
    same = congruent_panels(panels)
    np.testing.assert_allclose(np.linalg.det(same.rotations), 1, atol=1e-12)
    for panel, points in enumerate(marks(panels)):
        model = marks(panels)[same.representatives[same.labels[panel]]]
        ends = model.reshape(-1, 3) @ same.rotations[panel].T + same.translations[panel]
        apart = norm(ends[:, None] - points.reshape(-1, 3))
        assert apart.min(axis=0).max() < 1e-12
    assert same.misses.max() < 1e-12
    first = same.representatives
    np.testing.assert_array_equal(same.rotations[first], [np.eye(3)] * len(first))


def test_panels_of_a_torus_repeat_around_its_axis() -> None:
    """A half turn carries the upper half onto the lower: n/2 shapes for n panels across."""
    found = minimize_angles(face_planes(torus_net(30, 12, 10.0, 3.0)))[0]
    panels, _ = cut_panels(found, thickness=0.1)
    same = congruent_panels(panels)
    assert np.bincount(same.labels).tolist() == [60] * 6


def test_panels_of_different_moulds_differ() -> None:
    found = curved(torus_net(30, 12, 10.0, 3.0), 0.1)
    labels = np.arange(found.mesh.n_faces) % 2
    panels, _ = cut_panels(found, labels=labels)
    same = congruent_panels(panels)
    assert len(same.representatives) == 12
    assert (labels[same.representatives][same.labels] == labels).all()


def test_tolerance_is_relative_to_the_mean_edge() -> None:
    for scale in (1e-3, 1e3):
        found, kinds = scattered(5, scale)
        vertices = found.mesh.vertices
        shaken = vertices + 1e-4 * scale * np.random.default_rng(1).normal(size=vertices.shape)
        mesh = Mesh(shaken, found.mesh.faces)
        panels, _ = cut_panels(SphereMesh.from_local(mesh, found.local_spheres))
        assert len(congruent_panels(panels).representatives) == panels.n_panels
        # 0.2 and 0.21 radians of bulge differ by some thousandths
        loose = congruent_panels(panels, 2e-3)
        assert len(loose.representatives) == len(set(kinds))
        assert 1e-5 < loose.misses.max() / scale < 2e-3 * 2


def test_no_panels_and_a_bad_tolerance() -> None:
    panels, _ = cut_panels(scattered(1)[0])
    none = select_parts(panels, np.zeros(panels.n_panels, bool))
    assert congruent_panels(none).labels.shape == (0,)
    with pytest.raises(InputError, match="tolerance must be positive"):
        congruent_panels(panels, 0.0)
