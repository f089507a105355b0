"""Laws of drilling marks (E6): where holes lie, and when they do not fit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.beams.beams import Beams, scale_beams, section_arcs
from spheremesh.kernel.beams.contours import beam_contours
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams, mark_centers
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net

TORUS = central_spheres(torus_net(9, 6, 3.0, 1.0))
ANNULI = annulus_support(TORUS, depth=0.3).annuli
BEAMS = cut_beams(ANNULI, 0.04, 0.01)[0]


def marks_of(beams: Beams) -> FloatArray:
    assert beams.marks is not None
    return beams.marks.centers


@given(st.integers(1, 4), st.floats(0.005, 0.05), st.floats(0.03, 0.2))
@settings(max_examples=15)
def test_law_e6_marks_lie_on_a_parallel_of_the_end(
    count: int, diameter: float, inset: float
) -> None:
    drilled, findings = drill_beams(BEAMS, count, diameter, inset)
    assert findings == ()
    centers = marks_of(drilled)
    assert centers.shape == (BEAMS.n_beams, 2, count, 3)
    assert np.abs(dot(centers, ANNULI.frames[:, None, None, 2])).max() < 1e-14
    # All holes of an end lie on a line along the node axis, equally far from each other.
    steps = np.diff(centers, axis=2)
    across = np.cross(steps, ANNULI.end_directions[:, :, None])
    assert np.abs(across).max(initial=0.0) < 1e-14
    if count > 2:
        assert np.ptp(norm(steps), axis=2).max() < 1e-14
    # The nearest corner of the cut is at the inset.
    ends = BEAMS.corners.reshape(BEAMS.n_beams, 2, 1, 6, 3)
    inward = np.cross(ANNULI.end_directions, ANNULI.frames[:, None, 2])
    apart = np.abs(dot(centers[:, :, :, None] - ends, inward[:, :, None, None])).min(axis=3)
    np.testing.assert_allclose(apart, inset, rtol=1e-9)


@given(st.integers(1, 5), st.floats(0.01, 0.4), st.floats(0.01, 0.6))
@settings(max_examples=25)
def test_law_e6_holes_that_fit_lie_inside_and_apart(
    count: int, diameter: float, inset: float
) -> None:
    """Against sampled contours, which know nothing of circles and end lines."""
    inset = max(inset, 0.51 * diameter)
    drilled, findings = drill_beams(BEAMS, count, diameter, inset)
    assert drilled.marks is not None
    refused = {finding.id for finding in findings}
    outer, inner = (arc_points(a, np.linspace(-1, 1, 200)) for a in section_arcs(BEAMS))
    rims = np.concatenate([outer, inner], 1)
    for i in range(0, BEAMS.n_beams, 5):
        points = marks_of(drilled)[i].reshape(-1, 3)
        fits = bool(drilled.marks.fits[i])
        assert fits == (BEAMS.annuli.ids[i] not in refused)
        gaps = norm(points[:, None] - points) + np.eye(len(points)) * 1e9
        margin = norm(points[:, None] - rims[i]).min()
        if fits:
            assert margin > diameter / 2 - 1e-3
            assert gaps.min() >= diameter
        elif margin > diameter / 2 + 1e-3 and gaps.min() > diameter:
            reason = next(f.message for f in findings if f.id == BEAMS.annuli.ids[i])
            assert "too short" in reason or "break through" in reason or "misses" in reason


def test_marks_that_do_not_fit_are_listed_by_name() -> None:
    _, crowded = drill_beams(BEAMS, 5, 0.1, 0.1)
    assert {finding.id for finding in crowded} == set(BEAMS.annuli.ids)
    assert {finding.message for finding in crowded} == {
        "no drilling marks: they touch each other"
    }
    assert {(finding.code, finding.severity) for finding in crowded} == {("B208", "note")}
    _, wide = drill_beams(BEAMS, 1, 0.4, 0.25)
    assert any("break through an arc" in finding.message for finding in wide)
    drilled, far = drill_beams(BEAMS, 1, 0.02, 0.9)
    chords = norm(BEAMS.sections[:, 0, 0] - BEAMS.sections[:, 1, 0])
    short = {name for name, c in zip(BEAMS.annuli.ids, chords, strict=True) if c < 0.9}
    assert short <= {finding.id for finding in far} < set(BEAMS.annuli.ids)
    assert {finding.message for finding in far} <= {
        "no drilling marks: the beam is too short for them",
        "no drilling marks: they touch each other",
        "no drilling marks: their line misses an arc of the beam",
        "no drilling marks: they break through an arc",
    }
    assert drilled.marks is not None
    assert drilled.marks.fits.sum() == BEAMS.n_beams - len(far)


def test_marks_go_with_their_beams() -> None:
    drilled, _ = drill_beams(BEAMS, 2, 0.03, 0.05)
    keep = np.arange(BEAMS.n_beams) % 3 == 1
    few = select_parts(drilled, keep)
    assert np.abs(marks_of(few) - marks_of(drilled)[keep]).max() == 0
    again, _ = drill_beams(drilled, 1, 0.03, 0.05)
    assert marks_of(again).shape[2] == 1
    assert BEAMS.marks is None


def test_centres_in_the_plane_of_the_contour() -> None:
    drilled, _ = drill_beams(BEAMS, 2, 0.03, 0.05)
    assert drilled.marks is not None
    flat = mark_centers(drilled, drilled.marks)
    corners = beam_contours(BEAMS).corners
    spatial = norm(marks_of(drilled)[:, 0, 0] - BEAMS.sections[:, 0, 0])
    np.testing.assert_allclose(norm(flat[:, 0] - corners[:, 3]), spatial, rtol=1e-12)


@pytest.mark.parametrize("scale", [1e-3, 7.0, 1e3])
def test_law_e6_marks_do_not_depend_on_scale_or_place(scale: float) -> None:
    expected, _ = drill_beams(BEAMS, 2, 0.03, 0.05)
    large, _ = drill_beams(scale_beams(BEAMS, scale), 2, 0.03 * scale, 0.05 * scale)
    assert np.abs(marks_of(large) / scale - marks_of(expected)).max() < 1e-12
    scaled = scale_beams(expected, scale)
    assert np.abs(marks_of(large) - marks_of(scaled)).max() < 1e-12 * scale
    assert scaled.marks is not None
    assert scaled.marks.diameter == pytest.approx(0.03 * scale)
    shift = np.array([4e5, -7e5, 1e5])
    moved = Mesh(TORUS.mesh.vertices + shift, TORUS.mesh.faces)
    annuli = annulus_support(
        SphereMesh.from_local(moved, TORUS.local_spheres), depth=0.3
    ).annuli
    far, _ = drill_beams(cut_beams(annuli, 0.04, 0.01)[0], 2, 0.03, 0.05)
    place = marks_of(far) + far.annuli.origins[:, None, None] - shift
    home = marks_of(expected) + BEAMS.annuli.origins[:, None, None]
    assert np.abs(place - home).max() < 1e-8


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ((0, 0.02, 0.05), "at least 1 hole"),
        ((2, 0.0, 0.05), "diameter must be a length above 0"),
        ((2, np.nan, 0.05), "diameter must be a length above 0"),
        ((2, 0.02, 0.01), "more than half the diameter"),
        ((2, 0.02, np.inf), "more than half the diameter"),
    ],
)
def test_bad_options_are_refused(options: tuple[int, float, float], match: str) -> None:
    with pytest.raises(InputError, match=match):
        drill_beams(BEAMS, *options)


def test_no_beams_get_no_marks() -> None:
    none = select_parts(BEAMS, np.zeros(BEAMS.n_beams, bool))
    drilled, findings = drill_beams(none, 2, 0.03, 0.05)
    assert findings == ()
    assert marks_of(drilled).shape == (0, 2, 2, 3)
