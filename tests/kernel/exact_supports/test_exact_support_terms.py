"""Terms of the search for exact supports: derivatives, and what they vanish on."""

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.exact_supports.conditions import COMMON_AXES, CONDITIONS, FLATNESS
from spheremesh.kernel.exact_supports.descent import misses
from spheremesh.kernel.exact_supports.design_surface import (
    across_rim,
    design_surface,
    heights,
    slides,
)
from spheremesh.kernel.exact_supports.setting import (
    Bounds,
    SlideSetting,
    SlidState,
    first_state,
    make_setting,
    slid_by,
)
from spheremesh.kernel.exact_supports.terms import SlideTerm
from spheremesh.kernel.exact_supports.wishes import WISHES
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.solvers.blocks import jacobian_matrix, jacobian_pattern
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, roof_net

TERMS = (*CONDITIONS, FLATNESS, *WISHES)


@pytest.fixture(scope="module")
def setting() -> SlideSetting:
    mesh = roof_net(4, 5, 6.0)
    curvatures = np.full(mesh.n_faces, 0.2)
    return make_setting(mesh, design_surface(mesh), Bounds(0.06, 0.7), curvatures)


@pytest.fixture(scope="module")
def state(setting: SlideSetting) -> SlidState:
    """Somewhere off, beyond the walls at some vertices."""
    rng = np.random.default_rng(3)
    step = 0.25 * rng.normal(size=int(setting.layout.starts[-1]))
    return slid_by(setting, first_state(setting), step)


@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.name)
def test_law_d9_derivatives_are_those_of_differences(
    setting: SlideSetting, state: SlidState, term: SlideTerm
) -> None:
    layout = setting.layout
    pattern = jacobian_pattern(layout, [term.blocks(setting)])
    jacobian = jacobian_matrix(pattern, [term.jacobian(setting, state)])
    rng = np.random.default_rng(4)
    for _ in range(4):
        step = rng.normal(size=int(layout.starts[-1]))
        ahead = term.residuals(setting, slid_by(setting, state, 1e-6 * step))
        behind = term.residuals(setting, slid_by(setting, state, -1e-6 * step))
        expected = (ahead - behind) / 2e-6
        size = np.abs(expected).max()
        np.testing.assert_allclose(jacobian @ step, expected, rtol=1e-6, atol=1e-7 * size)


def test_walls_are_met(setting: SlideSetting, state: SlidState) -> None:
    """Else their derivatives would be those of nothing."""
    for term in TERMS:
        assert np.abs(term.residuals(setting, state)).max() > 0, term.name


def test_one_sphere_meets_all_conditions() -> None:
    mesh = ellipsoid_net(8, 5, 2.0, 2.0, 1.2)
    edge = mean_edge_length(mesh)
    # N points away from the centre.
    curvatures = np.full(mesh.n_faces, -edge / 2.0)
    setting = make_setting(mesh, design_surface(mesh), Bounds(0.1, 0.7), curvatures)
    assert misses(setting, first_state(setting)) < 1e-14


def test_a_pole_leads_to_a_second_common_point() -> None:
    """``A = p · N`` at v says that ``v + p / |p|²`` lies on the sphere."""
    rng = np.random.default_rng(5)
    a, center, radius = 0.3, rng.normal(size=3), 1 / 0.6
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    vertex = center + radius * direction
    normal = 2 * a * (center - vertex)
    # Any second point of the sphere.
    other = rng.normal(size=3)
    second = center + radius * other / np.linalg.norm(other)
    pole = (second - vertex) / np.dot(second - vertex, second - vertex)
    assert abs(a - pole @ normal) < 1e-13
    assert COMMON_AXES.name == "axis"


def quadric_mesh(n: int = 6) -> tuple[Mesh, FloatArray]:
    """A net on z = (x² - y²) / 8 + x y / 10 over a square, and its coordinates."""
    x, y = (
        values.ravel()
        for values in np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    )
    vertices = np.stack([x, y, (x**2 - y**2) / 8 + x * y / 10], 1)
    ids = np.arange(n * n).reshape(n, n)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return Mesh(vertices, np.stack(quads, -1).reshape(-1, 4)), vertices


def test_moves_on_a_quadric_are_slides() -> None:
    mesh, vertices = quadric_mesh()
    surface, edge = design_surface(mesh), mean_edge_length(mesh)
    rng = np.random.default_rng(6)
    moved = vertices + 0.3 * edge * rng.uniform(-1, 1, vertices.shape)
    moved[:, 2] = (moved[:, 0] ** 2 - moved[:, 1] ** 2) / 8 + moved[:, 0] * moved[:, 1] / 10
    shifts = (moved - vertices) / edge
    heights_found, _ = heights(surface, shifts)
    # A graph over one plane is a quadric over another up to third order.
    assert np.abs(heights_found).max() < 3e-3
    assert np.linalg.norm(slides(surface, shifts), axis=1).max() > 0.2
    lifted, _ = heights(surface, 0.05 * surface.frames[:, 2])
    np.testing.assert_allclose(lifted, 0.05, rtol=1e-12)


def test_moves_along_a_round_boundary_do_not_cross_it() -> None:
    mesh = ellipsoid_net(24, 5, 2.0, 2.0, 1.2)
    surface, edge = design_surface(mesh), mean_edge_length(mesh)
    turn = 0.3 * edge / 2.0
    rotation = np.array([
        [np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1],
    ])  # fmt: skip
    shifts = (mesh.vertices @ rotation.T - mesh.vertices) / edge
    along, across = slides(surface, shifts), across_rim(surface, shifts)[0]
    assert np.abs(across).max() < 0.02 * np.linalg.norm(along, axis=1).max()


def test_unused_vertices_do_no_harm() -> None:
    mesh = roof_net(4, 5, 6.0)
    loose = Mesh(np.concatenate([mesh.vertices, [[1.0, 2.0, 3.0]]]), mesh.faces)
    surface = design_surface(loose)
    np.testing.assert_allclose(surface.polynomials[:-1], design_surface(mesh).polynomials)
    assert not surface.frames[-1].any()
