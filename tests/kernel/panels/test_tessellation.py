import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh.kernel.arrays import dot, norm, sum_by
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.fans import cut_ears, cut_fan
from spheremesh.kernel.panels.panels import Panels, panel_areas
from spheremesh.kernel.panels.tessellation import PanelTriangles, surface_rows, tessellate
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.kernel.spheres.rows import from_center_radius, normalize
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net

RTOL = 1e-12


def torus_panels(thickness: float = 0.0) -> Panels:
    smooth, _ = minimize_angles(fit_spheres(torus_net(16, 12, 3.0, 1.0)))
    return cut_panels(smooth, thickness=thickness)[0]


def l_shaped_panel(radius: float) -> Panels:
    """A panel on one sphere that cannot be seen whole from its middle."""
    flat = np.array([[0, 0], [6, 0], [6, 1], [1, 1], [1, 6], [0, 6]]) - 0.5
    height = np.sqrt(radius**2 - (flat**2).sum(1)) - radius
    mesh = Mesh(np.column_stack([flat, height]), [range(6)])
    sphere = -normalize(from_center_radius(np.array([[0, 0, -radius]]), np.array([radius**2])))
    return cut_panels(SphereMesh(mesh, sphere))[0]


def triangle_vectors(drawn: PanelTriangles) -> np.ndarray:
    a, b, c = np.moveaxis(drawn.points[drawn.triangles], 1, 0)
    return np.cross(b - a, c - a) / 2


def surface_distances(panels: Panels, drawn: PanelTriangles) -> np.ndarray:
    local = drawn.points[drawn.triangles] + drawn.origin - panels.origins[drawn.panels][:, None]
    return signed_distance(surface_rows(panels)[drawn.surfaces][:, None], local)


@pytest.mark.parametrize("thickness", [0.0, 0.05])
def test_points_lie_on_their_surfaces_with_exact_normals(thickness: float) -> None:
    panels = torus_panels(thickness)
    drawn = tessellate(panels, 0.01)
    assert np.abs(surface_distances(panels, drawn)).max() < RTOL
    assert np.abs(norm(drawn.normals) - 1).max() < RTOL
    across = dot(triangle_vectors(drawn)[:, None], drawn.normals[drawn.triangles])
    assert (across > 0).all()


def test_area_converges_quadratically_to_the_closed_form() -> None:
    panels = torus_panels()
    exact = panel_areas(panels)
    errors = []
    for tolerance in (0.04, 0.01, 0.0025):
        drawn = tessellate(panels, tolerance)
        areas = sum_by(drawn.panels, norm(triangle_vectors(drawn)), panels.n_panels)
        errors.append(np.abs(areas / exact - 1).max())
    assert errors[2] < 1e-3
    # The error falls with the tolerance, that is with the square of the steps.
    assert errors[0] / errors[1] > 2.5
    assert errors[1] / errors[2] > 2.5


def open_edges(points: np.ndarray, triangles: np.ndarray) -> int:
    """Directed edges without their opposite, points being the same to the bit alone."""
    _, ids = np.unique(points, axis=0, return_inverse=True)
    corners = ids.ravel()[triangles]
    halves = np.concatenate([np.roll(corners, k, 1)[:, :2] for k in range(3)])
    keys, counts = np.unique(halves, axis=0, return_counts=True)
    assert (counts == 1).all()
    known = {tuple(half) for half in keys.tolist()}
    return sum((b, a) not in known for a, b in known)


def closed_torus(thickness: float = 0.0) -> Panels:
    """Spheres that meet in circles through the vertices."""
    return cut_panels(
        fit_spheres(torus_net(24, 10, 3.0, 1.0)), "intersection", thickness=thickness
    )[0]


def test_neighbours_are_closed_to_the_bit() -> None:
    """However fine each of them is."""
    panels = closed_torus()
    finer = np.random.default_rng(3).choice([0.05, 0.01, 0.002], panels.n_panels)
    drawn = tessellate(panels, finer)
    assert len(np.unique(drawn.steps)) > 2
    assert open_edges(drawn.points, drawn.triangles) == 0
    assert np.abs(surface_distances(panels, drawn)).max() < RTOL


@given(
    turn=st.floats(0.0, 6.0),
    size=st.floats(-6.0, 6.0),
    away=st.floats(0.0, 1e4),
    seed=st.integers(0, 99),
)
@settings(max_examples=4)
def test_neighbours_are_closed_wherever_a_net_is(
    turn: float, size: float, away: float, seed: int
) -> None:
    """Turned, scaled, moved, renumbered: between spheres that touch no triangles gape."""
    net = torus_net(24, 10, 3.0, 1.0)
    spin = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    order = np.random.default_rng(seed).permutation(net.n_faces)
    vertices = (net.vertices @ spin + away) * 10.0**size
    moved = Mesh(vertices, [net.faces[face] for face in order])
    drawn = tessellate(cut_panels(fit_spheres(moved), "intersection")[0], 0.01)
    assert open_edges(drawn.points, drawn.triangles) == 0


def test_solids_of_neighbours_share_their_walls_to_the_bit() -> None:
    panels = closed_torus(0.05)
    drawn = tessellate(panels, 0.01)
    outer = drawn.surfaces < panels.n_panels
    assert open_edges(drawn.points, drawn.triangles[outer]) == 0
    for panel in range(0, panels.n_panels, 23):
        assert open_edges(drawn.points, drawn.triangles[drawn.panels == panel]) == 0


def test_gaps_and_joints_stay_open() -> None:
    net = torus_net(24, 10, 3.0, 1.0)
    jointed = cut_panels(fit_spheres(net), "intersection", joint_gap=0.01)[0]
    drawn = tessellate(jointed, 0.02)
    assert open_edges(drawn.points, drawn.triangles) == drawn.steps.sum()
    # Bisecting planes leave gaps between the arcs; corners, which lie on all spheres, are one.
    drawn = tessellate(cut_panels(fit_spheres(net))[0], 0.02)
    assert open_edges(drawn.points, drawn.triangles) > 0
    rims = np.unique(drawn.points, axis=0)
    assert len(rims) < len(drawn.points) - 3 * net.n_vertices + 1


@pytest.mark.parametrize(("steps", "edges"), [(1, (1, 3, 2)), (3, (3, 5, 3, 8)), (4, (4,) * 6)])
def test_fans_cover_a_polygon_once(steps: int, edges: tuple[int, ...]) -> None:
    """With finer edges than their inside: the area of the rim, without an edge left open."""
    turns = 2 * np.pi * np.arange(len(edges) + 1) / len(edges)
    corners = np.stack([np.cos(turns), np.sin(turns)], 1)

    def ring(share: float, counts: tuple[int, ...]) -> np.ndarray:
        pairs = zip(corners[:-1], corners[1:], counts, strict=True)
        return np.concatenate(
            [share * (a + np.arange(n)[:, None] / n * (b - a)) for a, b, n in pairs]
        )

    inner = [ring(k / steps, (k,) * len(edges)) for k in range(1, steps)]
    points = np.concatenate([np.zeros((1, 2)), *inner, ring(1.0, edges)])
    triangles = cut_fan(steps, edges)
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(len(edges) / 2 * np.sin(2 * np.pi / len(edges)))
    assert open_edges(points, triangles) == sum(edges)


def test_thick_panels_enclose_their_volume() -> None:
    panels = torus_panels(0.05)
    drawn = tessellate(panels, 0.0005)
    first = drawn.points[drawn.triangles[:, 0]] + drawn.origin - panels.origins[drawn.panels]
    parts = dot(first, triangle_vectors(drawn)) / 3
    volumes = sum_by(drawn.panels, parts, panels.n_panels)
    np.testing.assert_allclose(volumes, panel_volumes(panels), rtol=2e-3)


def test_without_walls_only_the_outer_faces_remain() -> None:
    panels = torus_panels(0.05)
    drawn = tessellate(panels, 0.01, solid=False)
    assert drawn.surfaces.max() < panels.n_panels


def test_plane_panels_are_exact_with_one_step() -> None:
    panels = cut_panels(face_planes(roof_net(6, 6, 10.0)))[0]
    drawn = tessellate(panels)
    assert len(drawn.triangles) == 4 * panels.n_panels
    areas = sum_by(drawn.panels, norm(triangle_vectors(drawn)), panels.n_panels)
    np.testing.assert_allclose(areas, panel_areas(panels), rtol=1e-10)


@pytest.mark.parametrize("radius", [20.0, 1e4])
def test_panel_that_no_fan_can_cover(radius: float) -> None:
    panels = l_shaped_panel(radius)
    drawn = tessellate(panels, 0.001)
    assert np.abs(surface_distances(panels, drawn)).max() < RTOL * radius
    vectors = triangle_vectors(drawn)
    assert (vectors[:, 2] > 0).all()
    np.testing.assert_allclose(norm(vectors).sum(), panel_areas(panels)[0], rtol=0.03)


def test_ears_cover_a_comb() -> None:
    teeth = 6
    top = [[x, 3.0 if x % 2 else 1.0] for x in range(2 * teeth, -1, -1)]
    outline = np.array([[0.0, 0.0], [2.0 * teeth, 0.0], *top])
    triangles = cut_ears(outline)
    a, b, c = np.moveaxis(outline[triangles], 1, 0)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert (areas >= 0).all()
    assert areas.sum() == pytest.approx(2 * teeth * 2.0)


def test_site_coordinates_cost_no_digits() -> None:
    mesh = torus_net(8, 8, 3.0, 1.0)
    here = cut_panels(fit_spheres(mesh))[0]
    there = cut_panels(fit_spheres(Mesh(mesh.vertices + 2.0**20, mesh.faces)))[0]
    near, far = tessellate(here, 0.01), tessellate(there, 0.01)
    np.testing.assert_allclose(far.points, near.points, atol=1e-8)
    np.testing.assert_allclose(far.origin - 2.0**20, near.origin, atol=1e-8)


def test_tolerance_must_be_positive() -> None:
    with pytest.raises(InputError, match="tolerance must be positive"):
        tessellate(torus_panels(), 0.0)
