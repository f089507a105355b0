"""Identical panels: found under motions, and told apart from mirror images and near misses."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import nodes
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.cutting import cut_panels
from spheremesh.kernel.mesh import Mesh
from spheremesh.kernel.panel_kinds import identical_panels, panel_kinds_report
from spheremesh.kernel.panels import Panels, scale_panels, select_panels
from spheremesh.kernel.sphere_mesh import SphereMesh

SEEDS = st.integers(0, 2**32 - 1)


def rotation(rng: np.random.Generator) -> FloatArray:
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return frame * np.linalg.det(frame)


def scattered(corners: list[FloatArray], radii: list[float]) -> Panels:
    """One panel for each polygon on a circle; outwards is along its normal."""
    vertices = np.concatenate(corners)
    starts = np.cumsum([0, *map(len, corners)])
    mesh = Mesh(vertices, [range(i, j) for i, j in pairwise(starts)])
    spheres = []
    for radius, points in zip(radii, corners, strict=True):
        local = points - points.mean(0)
        normal = np.cross(local[1] - local[0], local[2] - local[0])
        normal /= np.linalg.norm(normal)
        size = np.linalg.norm(local[0])
        center = -np.sqrt(radius**2 - size**2) * normal
        a = -0.5 / radius
        spheres.append([a, *(2 * a * center), a * (center @ center - radius**2)])
    panels, rejected = cut_panels(SphereMesh.from_local(mesh, np.array(spheres)))
    assert not rejected
    return panels


def kite(angles: FloatArray, size: float = 1.0) -> FloatArray:
    return size * np.stack([np.cos(angles), np.sin(angles), 0 * angles], 1)


# Balanced about the centre, so that the centroid is the centre of the circle.
KITE = np.array([0.0, 0.8, np.pi, np.pi + 0.8])


@given(SEEDS, st.floats(1e-3, 1e3))
def test_motions_and_numbering_do_not_matter(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    polygons, radii, wanted = [], [], []
    for kind, (shape, radius) in enumerate(((KITE, 3.0), (KITE, 4.0), (KITE * 1.0, 3.0))):
        size = 1.1 if kind == 2 else 1.0
        for _ in range(3):
            points = np.roll(kite(shape, size), int(rng.integers(4)), 0) @ rotation(rng).T
            polygons.append(points + rng.uniform(-20, 20, 3))
            radii.append(radius)
            wanted.append(kind)
    order = rng.permutation(9)
    panels = scale_panels(
        scattered([polygons[i] for i in order], [radii[i] for i in order]), scale
    )
    found = identical_panels(panels)
    expected = np.array(wanted)[order]
    assert all(
        len(set(expected[found.kinds == kind])) == 1
        for kind in range(len(found.representatives))
    )
    assert len(found.representatives) == 3
    assert (found.representatives[found.kinds] <= np.arange(9)).all()
    assert found.deviations.max() < 1e-13 * scale
    for panel in range(9):
        leader = found.representatives[found.kinds[panel]]
        turn, shift = found.rotations[panel], found.translations[panel]
        assert np.abs(turn @ turn.T - np.eye(3)).max() < 1e-14
        assert np.linalg.det(turn) > 0
        own = panels.corners[4 * panel : 4 * panel + 4] + panels.origins[panel]
        moved = panels.corners[4 * leader : 4 * leader + 4] @ turn.T + shift
        apart = np.linalg.norm(own[:, None] - moved, axis=2).min(1).max()
        assert apart < 1e-12 * scale


def test_mirror_images_differ() -> None:
    angles = np.array([0.0, 0.5, 1.7, np.pi, np.pi + 0.5, np.pi + 1.7])
    panels = scattered([kite(angles), kite(-angles[::-1]) + 5.0, kite(angles) + 9.0], [3.0] * 3)
    assert identical_panels(panels).kinds.tolist() == [0, 1, 0]


def test_a_millionth_is_the_same_panel_and_a_thousandth_is_not() -> None:
    for change, kinds in ((1e-7, 1), (1e-3, 2)):
        panels = scattered([kite(KITE), kite(KITE) + 5.0], [3.0, 3.0 * (1 + change)])
        found = identical_panels(panels)
        assert len(found.representatives) == kinds
        assert found.deviations.max() < 1e-6


def test_moulds_and_thickness_count() -> None:
    panels = scattered([kite(KITE), kite(KITE) + 5.0], [3.0, 3.0])
    assert identical_panels(panels).kinds.tolist() == [0, 0]
    assert identical_panels(replace(panels, labels=np.array([0, 1]))).kinds.tolist() == [0, 1]
    tilted = panels.inner_corners.copy()
    tilted[5] += 1e-3
    assert identical_panels(replace(panels, inner_corners=tilted)).kinds.tolist() == [0, 1]


@pytest.mark.parametrize(
    ("net", "kinds"),
    [
        (nodes.torus_mesh(12, 8), 4),
        (nodes.ellipsoid_mesh(10, 6), 3),
        (nodes.vase_mesh(9, 5), 5),
    ],
)
def test_nets_of_revolution_repeat(net: Mesh, kinds: int) -> None:
    made = nodes.panels(
        nodes.minimize_angles(nodes.fit_spheres(net)).sphere_mesh, thickness=0.01
    )
    report = nodes.identical_panels(made.panels).report
    assert report["kinds"] == kinds
    assert report["repeated_panels"] == report["panels"] == net.n_faces
    assert report["deviation"] < 1e-12


def test_no_panels() -> None:
    panels = scattered([kite(KITE)], [3.0])
    none = select_panels(panels, np.zeros(1, bool))
    report = panel_kinds_report(identical_panels(none))
    assert set(report.values()) == {0}
