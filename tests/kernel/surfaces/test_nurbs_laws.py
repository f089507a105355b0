"""NURBS surfaces: closed forms, differences, and independence of position, scale and knots."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.surfaces.nurbs import (
    NurbsSurface,
    evaluate_nurbs,
    nearest_parameters,
    nurbs_curvatures,
)

SEEDS = st.integers(0, 2**32 - 1)
SCALES = st.floats(1e-3, 1e3)
ARC = np.array([[1.0, 0.0, 1.0], [np.sqrt(0.5), np.sqrt(0.5), np.sqrt(0.5)], [0.0, 1.0, 1.0]])
ARC_KNOTS = np.array([0.0, 0, 0, 1, 1, 1])


def revolved(profile: FloatArray, knots: FloatArray) -> NurbsSurface:
    """A quarter turn of a profile of homogeneous points (r, z, w) about the z axis."""
    r, z, w = profile.T
    points = np.empty((3, len(profile), 4))
    for i, (c, s, weight) in enumerate(ARC):
        points[i] = np.stack([c * r, s * r, weight * z, weight * w], 1)
    return NurbsSurface(ARC_KNOTS, knots, points)


def sphere(radius: float) -> NurbsSurface:
    """A quarter of the upper half."""
    return revolved(ARC * (radius, radius, 1.0), ARC_KNOTS)


def torus(major: float, minor: float) -> NurbsSurface:
    profile = ARC * (minor, minor, 1.0)
    profile[:, 0] += major * profile[:, 2]
    return revolved(profile, ARC_KNOTS)


def moved(surface: NurbsSurface, rng: np.random.Generator, scale: float) -> NurbsSurface:
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    points = surface.points.copy()
    shift = rng.uniform(-10, 10, 3)
    points[..., :3] = scale * (points[..., :3] @ turn.T + points[..., 3:] * shift)
    return NurbsSurface(surface.knots_u, surface.knots_v, points)


def random_surface(rng: np.random.Generator) -> NurbsSurface:
    """Degrees 1 to 4, with double knots, over random heights."""
    knots = []
    for degree, n_inner in zip(rng.integers(1, 5, 2), rng.integers(0, 4, 2), strict=True):
        inner = np.sort(rng.uniform(0.1, 0.9, n_inner))
        if degree > 2 and n_inner > 1:
            inner[1] = inner[0]
        knots.append(np.concatenate([[0.0] * (degree + 1), inner, [1.0] * (degree + 1)]))
        knots[-1] = 3 * knots[-1] - 1
    degrees = [int((k == k[0]).sum()) - 1 for k in knots]
    n, m = (len(k) - d - 1 for k, d in zip(knots, degrees, strict=True))
    x, y = np.meshgrid(np.arange(n) / n, np.arange(m) / m, indexing="ij")
    net = np.stack([x, y, rng.uniform(0, 0.5, (n, m)), np.ones((n, m))], -1)
    return NurbsSurface(*knots, net * rng.uniform(0.5, 2, (n, m, 1)))


def parameters(surface: NurbsSurface, rng: np.random.Generator, count: int = 60) -> FloatArray:
    low, high = surface.domain.T
    return low[:, None] + (high - low)[:, None] * rng.uniform(0.03, 0.97, (2, count))


@given(SEEDS, SCALES)
def test_a_sphere_has_one_curvature(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    radius = 2.5 * scale
    surface = moved(sphere(2.5), rng, scale)
    found = nurbs_curvatures(surface, *parameters(surface, rng))
    assert np.abs(np.abs(found.first) * radius - 1).max() < 1e-12
    assert np.abs(np.abs(found.second) * radius - 1).max() < 1e-12


@given(SEEDS, SCALES)
def test_a_torus_has_two_known_curvatures(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    surface = moved(torus(3.0, 1.25), rng, scale)
    u, v = parameters(surface, rng)
    found = nurbs_curvatures(surface, u, v)
    points = evaluate_nurbs(torus(3.0, 1.25), u, v).points
    rho = np.hypot(points[:, 0], points[:, 1])
    around = (rho - 3.0) / 1.25 / rho
    sign = np.sign(found.first + found.second)
    across = sign / (1.25 * scale)
    wanted = np.sort([across, sign * around / scale], 0)
    assert np.abs(np.stack([found.second, found.first]) - wanted).max() < 1e-12 / scale


@given(SEEDS)
def test_derivatives_are_those_of_differences(seed: int) -> None:
    rng = np.random.default_rng(seed)
    surface = random_surface(rng)
    u, v = parameters(surface, rng)
    step = 1e-6
    inner = np.concatenate([surface.knots_u, surface.knots_v])
    clear = np.abs(np.stack([u, v])[..., None] - inner).min((0, 2)) > 2 * step
    u, v = u[clear], v[clear]
    jet = evaluate_nurbs(surface, u, v)
    ahead, behind = evaluate_nurbs(surface, u + step, v), evaluate_nurbs(surface, u - step, v)
    right, left = evaluate_nurbs(surface, u, v + step), evaluate_nurbs(surface, u, v - step)
    for exact, difference in (
        (jet.u, ahead.points - behind.points),
        (jet.v, right.points - left.points),
        (jet.uu, ahead.u - behind.u),
        (jet.uv, ahead.v - behind.v),
        (jet.vv, right.v - left.v),
    ):
        tolerance = 1e-7 * (1 + np.abs(jet.uu).max() + np.abs(jet.vv).max()) ** 2
        assert np.abs(exact - difference / (2 * step)).max(initial=0) < tolerance


@given(SEEDS, SCALES)
def test_motions_and_scale(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    surface = random_surface(rng)
    u, v = parameters(surface, rng)
    before = nurbs_curvatures(surface, u, v)
    after = nurbs_curvatures(moved(surface, rng, scale), u, v)
    size = 1 + np.abs(before.first) + np.abs(before.second)
    assert np.nanmax(np.abs(after.first * scale - before.first) / size) < 1e-8
    assert np.nanmax(np.abs(after.second * scale - before.second) / size) < 1e-8


def test_far_site() -> None:
    rng = np.random.default_rng(3)
    surface = sphere(2.5)
    u, v = parameters(surface, rng)
    points = surface.points.copy()
    points[..., :3] += 1e6 * points[..., 3:]
    far = NurbsSurface(surface.knots_u, surface.knots_v, points)
    found = nurbs_curvatures(far, u, v)
    assert np.abs(np.abs(found.first) * 2.5 - 1).max() < 1e-8
    shift = evaluate_nurbs(far, u, v).points - evaluate_nurbs(surface, u, v).points
    assert np.abs(shift - 1e6).max() < 1e-9


@given(SEEDS)
def test_a_knot_more_changes_nothing(seed: int) -> None:
    """Boehm's insertion of a knot into the profile of a revolved curve."""
    rng = np.random.default_rng(seed)
    surface, new = sphere(1.0), rng.uniform(0.1, 0.9)
    net = surface.points
    first = net[:, 0] * (1 - new) + net[:, 1] * new
    second = net[:, 1] * (1 - new) + net[:, 2] * new
    finer = np.stack([net[:, 0], first, second, net[:, 2]], 1)
    knots = np.array([0.0, 0, 0, new, 1, 1, 1])
    finer_surface = NurbsSurface(surface.knots_u, knots, finer)
    u, v = parameters(surface, rng)
    v[:3] = new, 0.0, 1.0
    for a, b in zip(
        evaluate_nurbs(surface, u, v), evaluate_nurbs(finer_surface, u, v), strict=True
    ):
        assert np.abs(a - b).max() < 1e-12


def test_a_pole_has_no_curvature() -> None:
    found = nurbs_curvatures(sphere(1.0), np.array([0.3, 0.3]), np.array([1.0, 0.5]))
    assert np.isnan(found.first).tolist() == [True, False]
    assert np.isnan(found.normals[0]).all()


@given(SEEDS)
def test_nearest_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    surface = moved(torus(3.0, 1.25), rng, 1.0)
    u, v = parameters(surface, rng)
    jet, bend = evaluate_nurbs(surface, u, v), nurbs_curvatures(surface, u, v)
    heights = rng.uniform(-0.3, 0.3, len(u))
    found, distances = nearest_parameters(surface, jet.points + heights[:, None] * bend.normals)
    assert np.abs(found - np.stack([u, v], 1)).max() < 1e-7
    assert np.abs(distances - np.abs(heights)).max() < 1e-12


def test_bad_surfaces() -> None:
    good = sphere(1.0)
    for knots, points, message in (
        (np.array([0.0, 0, 1, 0, 1, 1]), good.points, "decrease"),
        (np.zeros(6), good.points, "span nothing"),
        (np.arange(3.0), good.points, "3 knots do not fit 3"),
        (ARC_KNOTS, good.points[..., :3], "shape"),
        (ARC_KNOTS, good.points * (1, 1, 1, -1), "weight"),
        (ARC_KNOTS, good.points * np.nan, "not finite"),
    ):
        with pytest.raises(InputError, match=message):
            NurbsSurface(knots, ARC_KNOTS, points)
    with pytest.raises(InputError, match="parameters must lie"):
        evaluate_nurbs(good, np.array([1.5]), np.array([0.5]))
