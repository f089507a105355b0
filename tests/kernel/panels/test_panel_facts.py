"""Measures of panels against closed forms."""

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import dot, norm, unit
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.cutting import cut_panels, edge_gaps
from spheremesh.kernel.panels.facts import panel_facts
from spheremesh.kernel.panels.panels import (
    opposite_corners,
    panel_arcs,
    scale_panels,
)
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.arcs import Arcs, arc_points, arc_tangents


def octants(mesh: Mesh, radius: float) -> SphereMesh:
    row = np.array([-0.5 / radius, 0, 0, 0, radius / 2])
    scaled = Mesh(radius * mesh.vertices, mesh.faces)
    return SphereMesh(scaled, np.tile(row, (mesh.n_faces, 1)))


def test_octants_in_closed_form(octahedron: Mesh) -> None:
    r, t = 3.0, 0.5
    panels, _ = cut_panels(octants(octahedron, r), thickness=t, side="centred")
    facts = panel_facts(panels)
    outer = r + t / 2
    np.testing.assert_allclose(facts.radii, r, rtol=1e-12)
    np.testing.assert_allclose(facts.outer_radii, outer, rtol=1e-12)
    np.testing.assert_allclose(facts.inner_radii, r - t / 2, rtol=1e-12)
    np.testing.assert_allclose(facts.centers, 0, atol=1e-12)
    np.testing.assert_allclose(facts.areas, np.pi / 2 * outer**2, rtol=1e-11)
    np.testing.assert_allclose(facts.corner_angles, np.pi / 2, rtol=1e-11)
    np.testing.assert_allclose(facts.edge_lengths, np.pi / 2 * outer, rtol=1e-12)
    np.testing.assert_allclose(facts.arc_radii, outer, rtol=1e-12)
    np.testing.assert_allclose(facts.sagittas, outer * (1 - np.sqrt(0.5)), rtol=1e-12)
    np.testing.assert_allclose(facts.wall_tilts, 0, atol=1e-12)
    np.testing.assert_allclose(facts.steps, 0, atol=1e-12)
    np.testing.assert_allclose(norm(facts.corners), outer, rtol=1e-12)
    # Through the three corners: chord radius r sqrt(2/3), on the mould.
    np.testing.assert_allclose(facts.caps.radii, r * np.sqrt(2 / 3), rtol=1e-11)


def test_walls_that_lean_and_their_neighbours(octahedron: Mesh) -> None:
    """A joint moves planes off the centre: alone they lean, between neighbours not."""
    gap, r = 0.2, 1.0
    panels, _ = cut_panels(octants(octahedron, r), joint_gap=gap)
    np.testing.assert_allclose(panel_facts(panels).wall_tilts, 0, atol=1e-12)
    alone = select_parts(panels, np.arange(8) == 2)
    facts = panel_facts(alone)
    np.testing.assert_allclose(facts.wall_tilts, np.arcsin(gap / 2 / r), rtol=1e-11)
    assert np.isnan(facts.steps).all()
    assert (opposite_corners(alone) == -1).all()


def test_flat_polygons_in_closed_form() -> None:
    corners = np.array([[0, 0, 1], [4, 0, 1], [4, 1, 1], [1, 1, 1], [1, 3, 1], [0, 3, 1.0]])
    panels, rejected = cut_panels(face_planes(Mesh(corners, [range(6)])), thickness=0.1)
    assert not rejected
    facts = panel_facts(panels)
    angles = np.degrees(facts.corner_angles)
    np.testing.assert_allclose(angles, [90, 90, 90, 270, 90, 90], rtol=1e-9)
    np.testing.assert_allclose(facts.edge_lengths, [4, 1, 3, 2, 1, 3], rtol=1e-12)
    np.testing.assert_allclose(facts.sizes, [[4, 3, 0]], atol=1e-12)
    assert facts.areas[0] == pytest.approx(6)
    assert facts.volumes[0] == pytest.approx(0.6)
    assert np.isinf(facts.radii).all()
    assert np.isinf(facts.arc_radii).all()
    assert facts.caps.radii[0] == pytest.approx(2.5)
    assert (facts.caps.sagittas == 0).all()


def test_steps_are_the_gaps_in_the_middle_of_edges(nets: dict[str, Mesh]) -> None:
    """Circular nets: bisector arcs meet at their ends, and differ most in the middle."""
    found = minimize_angles(face_planes(nets["egg"]))[0]
    panels, _ = cut_panels(found)
    facts, twins = panel_facts(panels), opposite_corners(panels)
    first = found.mesh.topology.edge_corners
    gaps = edge_gaps(found, "bisector")
    np.testing.assert_allclose(facts.steps[first], gaps, atol=1e-9)
    np.testing.assert_allclose(facts.steps[twins[first]], gaps, atol=1e-9)
    np.testing.assert_array_equal(twins[first], found.mesh.topology.twins[first])
    assert gaps.max() > 1e-4


def test_steps_at_the_ends_of_edges_count_as_well(nets: dict[str, Mesh]) -> None:
    """Quadrilaterals that are not circular: panels differ most at the nodes."""
    net = nets["egg"]
    noise = 0.02 * np.random.default_rng(3).normal(size=net.vertices.shape)
    found = fit_spheres(Mesh(net.vertices + noise, net.faces))
    first, gaps = found.mesh.topology.edge_corners, edge_gaps(found, "bisector")
    panels, rejected = cut_panels(found)
    assert not rejected
    steps = panel_facts(panels).steps[first]
    # Gaps are distances, steps their heights alone.
    assert np.percentile(np.abs(steps / gaps - 1), 90) < 0.05
    joined, rejected = cut_panels(found, joint_gap=0.01)
    assert not rejected
    np.testing.assert_allclose(panel_facts(joined).steps[first], steps, atol=0.1 * gaps.max())


def test_boxes_are_tight(nets: dict[str, Mesh]) -> None:
    """Corners of boxes from 4,000 points of each edge, and the crown."""
    for name in ("egg", "vase", "roof"):
        panels, _ = cut_panels(minimize_angles(fit_spheres(nets[name]))[0])
        sizes, first = panel_facts(panels).sizes, panels.offsets[:-1]
        up = unit(panels.spheres[:, 1:4])
        along = panels.corners[panels.next_corners[first]] - panels.corners[first]
        along = unit(along - dot(along, up)[:, None] * up)
        axes = np.stack([along, np.cross(up, along), up], 1)
        points = arc_points(panel_arcs(panels), np.linspace(-1, 1, 4001))
        found = np.einsum("hij,hnj->hni", axes[panels.corner_panels], points)
        low = np.minimum.reduceat(found.min(axis=1), first)
        high = np.maximum.reduceat(found.max(axis=1), first)
        boxes = (high - low)[:, :2]
        assert (sizes[:, :2] >= boxes * (1 - 1e-12)).all()
        np.testing.assert_allclose(sizes[:, :2], boxes, rtol=1e-6)


def test_law_facts_do_not_depend_on_units(nets: dict[str, Mesh]) -> None:
    panels, _ = cut_panels(minimize_angles(face_planes(nets["vase"]))[0], thickness=0.01)
    expected, found = panel_facts(panels), panel_facts(scale_panels(panels, 304.8))
    for name, power in {
        "radii": 1, "areas": 2, "volumes": 3, "sizes": 1, "corner_angles": 0,
        "edge_lengths": 1, "sagittas": 1, "wall_tilts": 0, "steps": 1, "corners": 1,
    }.items():  # fmt: skip
        before = getattr(expected, name) * 304.8**power
        np.testing.assert_allclose(getattr(found, name), before, rtol=1e-9, atol=1e-9)


def test_tangents_are_derivatives_of_arcs() -> None:
    rng = np.random.default_rng(4)
    starts, ends = rng.normal(size=(2, 50, 3))
    rises = unit(np.cross(ends - starts, rng.normal(size=(50, 3))))
    half = norm(ends - starts) / 2
    arcs = Arcs(starts, ends, rises, half * rng.uniform(-1, 1, 50))
    at_starts, at_ends = arc_tangents(arcs)
    step = 1e-6
    near = arc_points(arcs, np.array([-1, -1 + step, 1 - step, 1]))
    np.testing.assert_allclose(at_starts, unit(near[:, 1] - near[:, 0]), atol=1e-5)
    np.testing.assert_allclose(at_ends, unit(near[:, 3] - near[:, 2]), atol=1e-5)
    np.testing.assert_allclose(dot(at_starts, at_starts), 1, rtol=1e-12)
