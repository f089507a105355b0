"""Patterns of panels on a surface, and what is said of them."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.patterns.dual_patterns import hexagon_tries, smoothest_within
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes
from spheremesh.nodes import (
    NodeWarning,
    ellipsoid_mesh,
    hexagon_pattern,
    intersection_angles,
    panels,
    quad_pattern,
    sphere_gain,
    torus_mesh,
    triangle_pattern,
    triangulated_surface,
)


def hill(height: Callable[..., np.ndarray], n: int = 24) -> Mesh:
    """A graph over a rectangle."""
    u, v = np.meshgrid(np.linspace(-2, 2, n + 1), np.linspace(-1.4, 1.4, n + 1), indexing="ij")
    points = np.stack([u, v, height(u, v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    first = (i * (n + 1) + j).ravel()
    return Mesh(points, np.stack([first, first + n + 1, first + n + 2, first + 1], 1).tolist())


def long_hill(n: int = 24) -> Mesh:
    """A part of a paraboloid that bends more than twice as much one way as the other."""
    return hill(lambda u, v: -0.16 * u**2 - 0.06 * v**2, n)


@pytest.fixture(scope="module")
def pattern() -> tuple[Any, ...]:
    return quad_pattern(long_hill(), edge_length=0.6)


def test_a_hill_is_covered_by_quads_that_can_be_built(pattern: tuple[Any, ...]) -> None:
    net, report = pattern
    assert (report["status"], report["reason"], report["flaws"]["list"]) == ("usable", "", [])
    assert 25 <= report["faces"]["count"] <= 50
    assert measure_nodes(net).planarity.max() < 1e-6
    assert report["edges"]["min"] > 0.2
    assert report["deviation"]["nodes"] <= 0.02
    assert panels(net, edges="intersection", thickness=0.02).report["rejected"] == []
    mean = float(np.mean(intersection_angles(net)))
    assert report["angles_deg"]["spheres"] == pytest.approx(mean)
    assert mean < report["angles_deg"]["planes"]
    assert mean == pytest.approx(report["angles_deg"]["expected"], rel=0.2)
    json.dumps(dict(report), allow_nan=False)


def test_the_gain_is_foretold_by_sphere_gain(pattern: tuple[Any, ...]) -> None:
    surface, report = long_hill(), pattern[1]
    foretold, angles = sphere_gain(surface, edge_length=0.6)
    assert angles.shape == (surface.n_vertices,)
    assert report["angles_deg"]["planes"] == pytest.approx(foretold["quads"]["planes"], rel=0.2)


def test_patterns_do_not_depend_on_units() -> None:
    surface = long_hill(16)
    small = quad_pattern(surface, 0.8)
    large = quad_pattern(Mesh(1024 * surface.vertices, surface.faces), 1024 * 0.8)
    assert large.report["status"] == small.report["status"]
    assert large.report["faces"] == small.report["faces"]
    assert large.sphere_mesh.mesh.vertices / 1024 == pytest.approx(
        small.sphere_mesh.mesh.vertices, abs=1e-6
    )


def test_nearly_round_surfaces_are_named_before_planarising() -> None:
    with pytest.warns(NodeWarning, match="bisector"):
        report = quad_pattern(ellipsoid_mesh(24, 12, 1.0, 1.02), edge_length=0.5).report
    assert report["status"] == "not planarised"
    assert len(report["tries"]) == 1
    assert "hexagons" in report["reason"]


def test_flaws_are_named_and_ribs_are_warned_of() -> None:
    surface = hill(lambda u, v: 0.2 * np.cos(4 * u) * np.cos(4 * v), 24)
    with pytest.warns(NodeWarning) as told:
        report = quad_pattern(surface, edge_length=0.8).report
    texts = " ".join(str(each.message) for each in told)
    assert report["status"] == "flawed"
    assert report["flaws"]["list"]
    assert "ribs" in texts
    assert "is usable as it is" in texts
    assert {"face", "cause"} == set(report["flaws"]["list"][0])


def test_triangles_are_smooth_and_as_large_as_asked_for() -> None:
    net, report = triangle_pattern(long_hill(), edge_length=0.6)
    assert (report["status"], set(report["faces"]["degrees"])) == ("usable", {"3"})
    assert report["edges"]["mean"] == pytest.approx(0.6, rel=0.15)
    assert report["gain"]["measured"] > 0.3
    assert report["angles_deg"]["spheres"] == pytest.approx(
        report["angles_deg"]["expected"], rel=0.25
    )
    assert panels(net).report["rejected"] == []


def test_hexagons_are_convex_within_their_bound_and_smoother_with_looser_ones() -> None:
    tries, means = hexagon_tries(ellipsoid_mesh(24, 12), 0.27, 9, "drop"), list[float]()
    for bound in (5, 9):
        best = smoothest_within(tries, bound)
        judgement = best.judgement
        assert judgement is not None
        assert (judgement.is_usable, judgement.convex_share) == (True, 1.0)
        assert judgement.rejected_panels == judgement.rejected_beams == 0
        assert judgement.shortest >= 0.1
        assert np.degrees(judgement.lean_max) <= bound + 0.1
        means.append(judgement.angle)
    assert means[1] < means[0]


def test_hexagons_that_planes_surpass_say_so() -> None:
    saddle = triangulated_surface("waves", edge_length=0.12).mesh
    with pytest.warns(NodeWarning, match="planes are smoother"):
        report = hexagon_pattern(saddle, 0.24, max_axis_angle=3).report
    assert report["gain"]["measured"] < 0
    with pytest.raises(InputError, match="between 0 and 90"):
        hexagon_pattern(saddle, 0.12, max_axis_angle=90)


@pytest.mark.parametrize("length", [0.0, -1.0, float("inf")])
def test_lengths_that_are_none_are_refused(length: float) -> None:
    for make in (sphere_gain, quad_pattern, triangle_pattern, hexagon_pattern):
        with pytest.raises(InputError, match="edge"):
            make(torus_mesh(12, 6), length)


def test_surfaces_without_room_are_refused() -> None:
    with pytest.raises(InputError, match="too large"):
        quad_pattern(long_hill(8), edge_length=5.0)
