import numpy as np
import pytest

from spheremesh.kernel.arrays import dot, norm, sum_by
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import Panels, panel_areas
from spheremesh.kernel.panels.tessellation import (
    PanelTriangles,
    cut_ears,
    surface_rows,
    tessellate,
)
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.kernel.spheres.rows import from_center_radius, normalize
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, roof_net, torus_net

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


def test_thick_panels_are_closed_to_the_bit() -> None:
    panels = torus_panels(0.05)
    drawn = tessellate(panels, 0.01)
    for panel in (0, 7, 100):
        points = drawn.points[drawn.triangles[drawn.panels == panel]]
        _, ids = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
        ids = ids.reshape(-1, 3)
        halves = np.concatenate([ids, np.roll(ids, -1, 1)]).reshape(2, -1).T
        keys = {tuple(half) for half in halves.tolist()}
        assert len(keys) == len(halves)
        assert keys == {(b, a) for a, b in keys}


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


def test_neighbours_on_one_sphere_share_their_edges() -> None:
    mesh = ellipsoid_net(12, 2, 5.0, 5.0, 0.6)
    drawn = tessellate(cut_panels(fit_spheres(mesh), "intersection")[0], 0.01)
    _, ids = np.unique(np.round(drawn.points, 9), axis=0, return_inverse=True)
    corners = ids.reshape(-1)[drawn.triangles]
    halves = {tuple(h) for i in range(3) for h in np.roll(corners, i, 1)[:, :2].tolist()}
    rim = [half for half in halves if half[::-1] not in halves]
    heights = np.zeros(ids.max() + 1)
    heights[ids.reshape(-1)] = drawn.points[:, 2] + drawn.origin[2]
    # Open along the two rims, where the caps are missing, and nowhere else.
    assert len(rim) > 24
    assert np.abs(heights[np.array(rim)]).min() > 2.8


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
