"""Laws of layers: panels rest on beams, at the clear distance asked for, and nothing cuts."""

from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams, node_points
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.beams.layers import beams_under_panels, circles_through, rest_clearances
from spheremesh.kernel.beams.node_cylinders import node_cylinders
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels, scale_panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.sphere_meshes.model_change import change_model
from spheremesh.kernel.spheres.incidence import evaluate, signed_distance
from spheremesh.kernel.support.annuli import end_depths
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net

Side = Literal["inward", "centred", "outward"]
SIDES: tuple[Side, ...] = ("inward", "centred", "outward")


def roof(angle: float) -> SphereMesh:
    """Two flat squares that meet in a ridge, or in a valley at a negative angle."""
    drop, run = np.sin(angle / 2), np.cos(angle / 2)
    points = [[x * run, y, -abs(x) * drop] for x in (-1, 0, 1) for y in (0.0, 1.0)]
    return face_planes(Mesh(points, [[0, 2, 3, 1], [2, 4, 5, 3]]))


@cache
def curved() -> SphereMesh:
    net = ellipsoid_net(10, 6, 3.0, 4.5, np.radians(70))
    return change_model(net, "hyperbolic", 12.0, np.zeros(3), "inner")


def laid(
    spheres: SphereMesh,
    side: Side = "inward",
    joint: float = 0.0,
    bearing: float = 0.0,
    thickness: float = 0.03,
    radius: float = 0.0,
) -> tuple[Panels, Beams]:
    panels, _ = cut_panels(spheres, "intersection", 0.02, joint, None, side)
    annuli = annulus_support(spheres, depth=0.15).annuli
    beams, rejected = beams_under_panels(
        annuli, panels, thickness, node_radius=radius, bearing=bearing
    )
    assert rejected == ()
    return panels, beams


def ridge_drop(beams: Beams) -> float:
    """How far below the ridge, which is at z = 0, the top of its beam begins."""
    row = beams.annuli.edge_vertices.tolist().index([2, 3])
    corners = beams.annuli.corners[row, :, 0] + beams.annuli.origins[row]
    assert np.ptp(corners[:, 2]) < 1e-12
    return -float(corners[0, 2])


@pytest.mark.parametrize("angle", [0.05, 0.3, 0.9])
@pytest.mark.parametrize("thickness", [0.01, 0.05])
def test_law_a_ridge_takes_half_of_the_thickness_times_the_slope(
    angle: float, thickness: float
) -> None:
    """Flat panels on both sides of a flat top: the closed form."""
    _, beams = laid(roof(angle), thickness=thickness)
    flat = 0.02 / np.cos(angle / 2)
    expected = flat + thickness / 2 * np.tan(angle / 2)
    assert ridge_drop(beams) == pytest.approx(expected, rel=1e-12)
    # Half of a joint wider, nothing changes: the panel still lies over the side of the top.
    _, beams = laid(roof(angle), thickness=thickness, joint=thickness / 4)
    assert ridge_drop(beams) == pytest.approx(expected, rel=1e-12)
    _, beams = laid(roof(angle), thickness=thickness, bearing=0.005)
    raised = expected + 0.005 / np.cos(angle / 2)
    assert ridge_drop(beams) == pytest.approx(raised, rel=1e-12)


def test_in_a_valley_panels_rest_on_the_middle() -> None:
    spheres = roof(-0.3)
    _, beams = laid(spheres)
    assert ridge_drop(beams) == pytest.approx(0.02 / np.cos(0.15), rel=1e-12)
    # With a joint they begin beside it, a little higher; beams of the rim keep the level.
    panels, beams = laid(spheres, joint=0.01)
    row = beams.annuli.edge_vertices.tolist().index([2, 3])
    rows, _, clearances = rest_clearances(beams, panels)
    np.testing.assert_allclose(clearances[rows == row], 0.005 * np.tan(0.15), rtol=1e-9)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("bearing", [0.0, 0.004])
def test_law_tops_are_clear_of_the_panels_and_one_touches(side: Side, bearing: float) -> None:
    panels, beams = laid(curved(), side, 0.004, bearing)
    rows, plates, clearances = rest_clearances(beams, panels)
    assert clearances.min() > bearing - 1e-9
    assert len(rows) == 2 * beams.n_beams - 20
    # Sampled over the tops, the inner spheres are never nearer.
    annuli = beams.annuli
    tops = beams.corners[:, :, 0, [0, 2]] + annuli.origins[:, None, None]
    side_of = np.where(annuli.edge_faces[rows, 0] == panels.face_ids[plates], 0, 1)
    nearest = np.inf
    for end in (0, 1):
        points = tops[rows, end, side_of] - panels.origins[plates]
        apart = -signed_distance(panels.inner_spheres[plates], points)
        assert apart.min() > bearing - 1e-9
        nearest = min(nearest, float(apart.min()))
    assert nearest < bearing + 5e-4


def test_law_ends_of_a_node_begin_at_one_place() -> None:
    _, beams = laid(curved())
    annuli = beams.annuli
    points = node_points(annuli)
    off = norm(annuli.corners[:, :, 0] - points)
    assert off.max() < 1e-9
    np.testing.assert_allclose(end_depths(annuli), 0.15, rtol=1e-9)
    for rows, k in ((annuli.outer, 0), (annuli.inner, 1)):
        assert np.abs(evaluate(rows[:, None], annuli.corners[:, :, k])).max() < 1e-12


def test_beams_of_a_power_keep_their_depths() -> None:
    spheres = curved()
    annuli = annulus_support(spheres, kappa=0.5).annuli
    panels, _ = cut_panels(spheres, "intersection", 0.02)
    beams, _ = beams_under_panels(annuli, panels, 0.03)
    before, _ = cut_beams(annuli, 0.03)
    kept = np.isin(before.element_ids, beams.element_ids)
    np.testing.assert_allclose(
        end_depths(beams.annuli), end_depths(before.annuli)[kept], rtol=1e-9
    )
    assert rest_clearances(beams, panels)[2].min() > -1e-9


def test_law_parallel_circles_pass_through_their_points() -> None:
    annuli = annulus_support(central_spheres(torus_net(10, 6, 3.0, 1.0)), depth=0.1).annuli
    ends = annuli.corners[:, :, 0] + np.array([[0.01], [0.03]]) * annuli.end_directions
    rows = circles_through(annuli.outer, ends)
    assert np.abs(evaluate(rows[:, None], ends)).max() < 1e-12
    square = dot(rows[:, 1:4], rows[:, 1:4]) - 4 * rows[:, 0] * rows[:, 4]
    np.testing.assert_allclose(square, 1, rtol=1e-12)
    # Points of the circle itself give it back.
    same = circles_through(annuli.outer, annuli.corners[:, :, 0])
    np.testing.assert_allclose(same, annuli.outer, atol=1e-12)


def test_cylinders_begin_below_the_panels() -> None:
    panels, beams = laid(curved(), joint=0.004, radius=0.06)
    cylinders = node_cylinders(beams)
    turns = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    rows = np.searchsorted(cylinders.vertices, beams.annuli.edge_vertices)
    for end in (0, 1):
        center, axis = cylinders.origins[rows[:, end]], cylinders.directions[rows[:, end]]
        x = beams.annuli.frames[:, 2]
        x = x - dot(x, axis)[:, None] * axis
        x /= norm(x)[:, None]
        y = np.cross(axis, x)
        for side in (0, 1):
            has = np.flatnonzero(beams.annuli.edge_faces[:, side] >= 0)
            plates = np.searchsorted(panels.face_ids, beams.annuli.edge_faces[has, side])
            first = panels.offsets[plates]
            for turn in turns:
                points = center + 0.06 * (np.cos(turn) * x + np.sin(turn) * y)
                local = points[has] - panels.origins[plates]
                depth = -signed_distance(panels.inner_spheres[plates], local)
                inside = np.ones(len(has), bool)
                for corner in range(4):
                    planes = panels.plane_normals[first + corner]
                    inside &= dot(planes, local) > panels.plane_offsets[first + corner]
                assert (depth[inside] > -1e-6).all()
    assert (cylinders.heights > 0.1).all()


def test_marks_follow_the_beams() -> None:
    panels, beams = laid(curved())
    drilled, findings = drill_beams(beams, 2, 0.01, 0.02)
    assert findings == ()
    assert drilled.marks is not None
    centers = drilled.marks.centers
    for rows, sign in ((beams.annuli.outer, 1), (beams.annuli.inner, -1)):
        assert (sign * evaluate(rows[:, None, None], centers) > 0).all()
    assert panels.n_panels == 60


def test_missing_panels_and_their_beams() -> None:
    spheres = curved()
    panels, _ = cut_panels(spheres, "intersection", 0.02)
    annuli = annulus_support(spheres, depth=0.15).annuli
    some = select_parts(panels, np.arange(panels.n_panels) % 4 > 0)
    beams, rejected = beams_under_panels(annuli, some, 0.03)
    assert rejected == ()
    assert rest_clearances(beams, some)[2].min() > -1e-9
    one = select_parts(panels, np.arange(panels.n_panels) == 0)
    alone, rejected = beams_under_panels(annuli, one, 0.03, node_radius=0.05)
    assert rejected == ()
    assert alone.cylinder_tops is not None
    assert np.isfinite(alone.cylinder_tops).all()
    assert (node_cylinders(alone).heights > 0.1).all()
    none = select_parts(panels, np.zeros(panels.n_panels, bool))
    beams, _ = beams_under_panels(annuli, none, 0.03)
    np.testing.assert_array_equal(beams.corners, cut_beams(annuli, 0.03)[0].corners)


def test_a_bearing_is_a_length() -> None:
    panels, _ = cut_panels(curved(), "intersection", 0.02)
    annuli = annulus_support(curved(), depth=0.15).annuli
    for bearing in (-0.1, float("nan")):
        with pytest.raises(InputError, match="bearing must be a length"):
            beams_under_panels(annuli, panels, 0.03, bearing=bearing)
    _, rejected = beams_under_panels(annuli, panels, 0.03, bearing=1.5)
    assert rejected


@pytest.mark.parametrize("scale", [1e-3, 1000.0])
def test_law_scale_and_place_do_not_matter(scale: float) -> None:
    panels, beams = laid(curved(), "centred", 0.004, 0.002, radius=0.05)
    annuli = annulus_support(curved(), depth=0.15).annuli
    shift = np.array([2.0e5, -3.0e5, 1.0e4])

    def _far(points: FloatArray) -> FloatArray:
        return points + shift

    moved = replace(panels, origins=_far(panels.origins))
    shifted, _ = beams_under_panels(
        replace(annuli, origins=_far(annuli.origins)), moved, 0.03, 0.0, 0.05, 0.002
    )
    np.testing.assert_allclose(shifted.corners, beams.corners, atol=1e-8)
    plain = scale_beams(cut_beams(annuli, 0.03, 0.0, 0.05)[0], scale).annuli
    large, _ = beams_under_panels(
        plain, scale_panels(panels, scale), 0.03 * scale, 0.0, 0.05 * scale, 0.002 * scale
    )
    np.testing.assert_allclose(large.corners, beams.corners * scale, rtol=0, atol=1e-9 * scale)
    assert large.cylinder_tops is not None
    assert beams.cylinder_tops is not None
    np.testing.assert_allclose(
        large.cylinder_tops, beams.cylinder_tops * scale, rtol=0, atol=1e-9 * scale
    )
