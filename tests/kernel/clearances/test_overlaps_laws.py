"""Laws of clearances: closed forms of balls and boxes, motions, witnesses, and OpenCASCADE."""

from functools import cache

import numpy as np
import pytest
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from spheremesh import Mesh
from spheremesh.fabrication.solids.opencascade_beams import beam_shapes
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.layers import beams_under_panels
from spheremesh.kernel.beams.node_cylinders import node_cylinders
from spheremesh.kernel.clearances.bodies import (
    Bodies,
    beam_bodies,
    common_frame,
    cylinder_bodies,
    face_slopes,
    face_values,
    panel_bodies,
    select_bodies,
)
from spheremesh.kernel.clearances.near_pairs import near_pairs
from spheremesh.kernel.clearances.overlaps import (
    body_distances,
    nearest_points,
    overlap_depths,
    part_pairs,
    separated_by_planes,
)
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels, scale_panels
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.model_change import change_model
from spheremesh.kernel.spheres.rows import from_plane
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net

SIDES = "inward", "centred", "outward"


def boxes(*corners: tuple[FloatArray, FloatArray]) -> Bodies:
    """Boxes along the axes, between least and greatest corners."""
    rows = np.array(
        [[*from_plane(np.eye(3), low), *from_plane(-np.eye(3), -high)] for low, high in corners]
    )
    points = np.array(
        [
            [[(low, high)[(k >> i) & 1][i] for i in range(3)] for k in range(8)]
            for low, high in corners
        ]
    )
    count = len(corners)
    return Bodies(
        np.arange(count), np.zeros((count, 3)), rows, np.zeros((count, 6, 3)), points,
        np.zeros((count, 0, 3), np.int64), np.array(corners),
    )  # fmt: skip


@cache
def assembly(
    side: str = "inward", joint: float = 0.0, bearing: float = 0.0
) -> tuple[Panels, Beams]:
    """Panels on beams of exact nodes, in millimetres."""
    net = ellipsoid_net(10, 6, 3.0, 4.5, np.radians(70))
    spheres = change_model(net, "hyperbolic", 12.0, np.zeros(3), "inner")
    panels, _ = cut_panels(spheres, "intersection", 0.02, joint, None, side)  # pyright: ignore
    annuli = annulus_support(spheres, depth=0.15).annuli
    beams, rejected = beams_under_panels(annuli, panels, 0.03, bearing=bearing)
    assert rejected == ()
    return scale_panels(panels, 1000.0), scale_beams(beams, 1000.0)


def test_law_boxes_have_closed_forms() -> None:
    random = np.random.default_rng(5)
    start = random.uniform(-2, 2, (300, 3))
    end = start + random.uniform(0.1, 2, (300, 3))
    one = boxes(*[(np.zeros(3), np.ones(3))] * 300)
    two = boxes(*zip(start, end, strict=True))
    apart = norm(np.maximum(np.maximum(start - 1, -end), 0))
    assert (apart > 0).sum() > 50
    np.testing.assert_allclose(body_distances(one, two), apart, atol=1e-6)
    common = (np.minimum(1, end) - np.maximum(0, start)).min(axis=1)
    np.testing.assert_allclose(overlap_depths(one, two), common, atol=1e-5)


def test_faces_are_distances_at_their_surface_and_have_right_slopes() -> None:
    panels, beams = assembly()
    for bodies in (panel_bodies(panels), beam_bodies(beams)):
        points = bodies.points[:, 0] + np.array([3.0, -2.0, 5.0])
        values = face_values(bodies.rows, bodies.axes, points)
        slopes = face_slopes(bodies.rows, bodies.axes, points)
        for i, step in enumerate(1e-3 * np.eye(3)):
            change = face_values(bodies.rows, bodies.axes, points + step)
            change -= face_values(bodies.rows, bodies.axes, points - step)
            np.testing.assert_allclose(change / 2e-3, slopes[..., i], atol=1e-6)
        assert values.shape == slopes.shape[:2]
        # The corners of a part lie on it.
        for k in range(bodies.points.shape[1]):
            corner = face_values(bodies.rows, bodies.axes, bodies.points[:, k])
            assert corner.min() > -20  # middles of faces may lie under their bulge
        for k in range(4):
            corner = face_values(bodies.rows, bodies.axes, bodies.points[:, k])
            assert corner.min() > -1e-6


@pytest.mark.parametrize("side", SIDES)
def test_law_distances_and_overlaps_are_those_of_opencascade(side: str) -> None:
    panels, beams = assembly(side, 0.004, 0.002)
    bodies = {"panel": panel_bodies(panels), "beam": beam_bodies(beams)}
    shapes = {"panel": panel_shapes(panels), "beam": beam_shapes(beams)}
    random = np.random.default_rng(SIDES.index(side))
    for kind, other in (("panel", "panel"), ("panel", "beam"), ("beam", "beam")):
        first, second = bodies[kind], bodies[other]
        i, j = near_pairs(first.boxes, second.boxes, 5.0)
        different = np.flatnonzero((first.parts[i] != second.parts[j]) | (kind != other))
        chosen = random.permutation(different)[:5]
        i, j = i[chosen], j[chosen]
        own = body_distances(select_bodies(first, i), select_bodies(second, j))
        for a, b, distance in zip(first.parts[i], second.parts[j], own, strict=True):
            pair = shapes[kind][a], shapes[other][b]
            assert BRepExtrema_DistShapeShape(*pair).Value() == pytest.approx(
                distance, abs=1e-3
            )
            found = GProp_GProps()
            BRepGProp.VolumeProperties_s(BRepAlgoAPI_Common(*pair).Shape(), found)
            assert found.Mass() <= 1


def test_nearest_points_lie_in_their_bodies() -> None:
    panels, beams = assembly("inward", 0.004, 0.002)
    first, second = panel_bodies(panels), beam_bodies(beams)
    i, j = near_pairs(first.boxes, second.boxes, 5.0)
    one, two = select_bodies(first, i[:300]), select_bodies(second, j[:300])
    points = nearest_points(one, two)
    for k, bodies in enumerate((one, two)):
        local = points[:, k] - bodies.origins
        assert face_values(bodies.rows, bodies.axes, local).min() > -1e-5
    depths = overlap_depths(one, two)
    apart = norm(points[:, 0] - points[:, 1])
    # The ball in both is no larger than the distance tells.
    assert (-depths <= apart + 1e-5).all()
    assert depths.max() < 1e-6


def test_law_a_part_moved_in_by_some_overlaps_by_as_much() -> None:
    panels, beams = assembly()
    bodies = beam_bodies(beams)
    lifted = select_bodies(bodies, np.arange(bodies.n_bodies))
    up = beams.annuli.frames[bodies.parts, 1]
    raised = Bodies(**{**vars(lifted), "origins": lifted.origins + 4 * up})
    plates = panel_bodies(panels)
    sides = beams.annuli.edge_faces[:, 0]
    before = body_distances(select_bodies(plates, sides), bodies)
    depths = overlap_depths(select_bodies(plates, sides), raised)
    meets = before < 3
    assert meets.sum() > 30
    # Beams rise along their planes, which lean a little from the panels' normals.
    share = depths[meets] / (4 - before[meets])
    assert share.max() < 1 + 1e-6
    assert share.min() > 0.5
    rows = np.arange(raised.n_bodies)
    assert not separated_by_planes(plates, raised, sides, rows, 0.01)[meets].any()


def test_law_planes_that_part_bodies_are_right() -> None:
    """Whatever is said to be apart has no ball in common."""
    panels, beams = assembly()
    plates, bars = panel_bodies(panels), beam_bodies(beams)
    for first, second in ((plates, plates), (plates, bars), (bars, bars)):
        i, j = near_pairs(first.boxes, second.boxes, 0.0)
        apart = separated_by_planes(first, second, i, j, 0.01)
        assert apart.any()
        one, two = select_bodies(first, i[apart]), select_bodies(second, j[apart])
        assert overlap_depths(one, two).max() < 0.01


def test_law_no_near_pair_is_missed() -> None:
    random = np.random.default_rng(0)
    low = random.uniform(0, 10, (200, 3))
    found = np.stack([low, low + random.exponential(0.5, (200, 3))], 1)
    gaps = np.maximum(
        found[:, None, 0] - found[None, :, 1], found[None, :, 0] - found[:, None, 1]
    )
    expected = {(i, j) for i, j in zip(*np.nonzero((gaps <= 0.2).all(axis=2)), strict=True)}
    assert set(zip(*near_pairs(found, found, 0.2), strict=True)) == expected
    assert len(near_pairs(found[:0], found, 0.2)[0]) == 0


def test_a_dart_and_notched_beams_are_unions() -> None:
    """A quadrilateral with a corner that turns inwards does not fill its corner."""
    points = [[0, 0, 0], [2, -2, 0], [0, 2, 0], [-2, -2, 0.0]]
    dart, rejected = cut_panels(face_planes(Mesh(points, [[0, 1, 2, 3]])), thickness=0.1)
    assert rejected == ()
    bodies = panel_bodies(dart)
    assert bodies.n_bodies == 2
    assert bodies.parts.tolist() == [0, 0]
    center = dart.origins[0]
    for place, is_inside in (
        ([0, 1, -0.05], True),
        ([0, -1, -0.05], False),
        ([1.5, -1.4, -0.05], True),
    ):
        values = face_values(bodies.rows, bodies.axes, np.array(place) - center[None])
        assert bool((values.min(axis=1) > 0).any()) == is_inside
    a, b, worst = part_pairs(
        np.array([1.0, 3.0, 2.0]), np.array([0, 0, 1]), np.array([4, 4, 4])
    )
    assert (a.tolist(), b.tolist(), worst.tolist()) == ([0, 1], [4, 4], [3.0, 2.0])


def test_cylinders_are_bodies_too() -> None:
    _, beams = assembly()
    square, _ = cut_beams(beams.annuli, 30.0, 1.0, 60.0)
    cylinders = node_cylinders(square)
    posts, bars = cylinder_bodies(cylinders), beam_bodies(square)
    node = square.annuli.edge_vertices[:, 0]
    rows = np.searchsorted(cylinders.vertices, node)
    apart = body_distances(bars, select_bodies(posts, rows))
    np.testing.assert_allclose(apart, 1.0, atol=1e-5)
    one = common_frame(bars, select_bodies(posts, rows))
    assert one[0].shape[1] == bars.rows.shape[1] + 3
