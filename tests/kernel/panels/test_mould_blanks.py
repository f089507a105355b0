"""Blanks: caps that hold their panels, none smaller, counted per mould."""

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.panels.congruent import congruent_panels
from spheremesh.kernel.panels.cutting import EdgeMode, cut_panels
from spheremesh.kernel.panels.mould_blanks import mould_blanks, panel_caps
from spheremesh.kernel.panels.panels import Panels, panel_arcs
from spheremesh.kernel.panels.thickness import ThicknessSide
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import evaluate, project
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net


def on_regular_face(n_sides: int, angle: float) -> SphereMesh:
    """A regular polygon in the unit circle under a cap of half opening `angle`."""
    turns = 2 * np.pi * np.arange(n_sides) / n_sides
    points = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    mesh = Mesh(points + np.array([3.0, -2.0, 5.0]), [range(n_sides)])
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    return SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, np.array([angle])))


@pytest.mark.parametrize("angle", [-1.3, -0.4, -1e-4, 0.0, 0.02, 0.9])
@pytest.mark.parametrize("n_sides", [3, 4, 6])
def test_caps_of_regular_panels_in_closed_form(angle: float, n_sides: int) -> None:
    panels, _ = cut_panels(on_regular_face(n_sides, angle))
    caps = panel_caps(panels)
    np.testing.assert_allclose(caps.radii, 1, rtol=1e-11)
    np.testing.assert_allclose(caps.openings, 2 * abs(angle), rtol=1e-9, atol=1e-12)
    # Radius 1 / sin a: the crown is tan(a / 2) over the rim, to N where A < 0.
    sagitta = -np.tan(angle / 2)
    np.testing.assert_allclose(caps.sagittas, sagitta, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(caps.centers, 0, atol=1e-11)
    np.testing.assert_allclose(caps.axes, [[0, 0, 1]], atol=1e-11)


def roof_panels(edges: EdgeMode, thickness: float, side: ThicknessSide) -> Panels:
    found = minimize_angles(face_planes(roof_net(12, 16, 30.0)))[0]
    found, clusters = cluster_radii(found, 4)
    return cut_panels(found, edges, thickness, 0.02, clusters.labels, side)[0]


def outlines(panels: Panels) -> list[FloatArray]:
    """Points of the edges of both faces of each panel, carried onto its mould."""
    both = panel_arcs(panels), panel_arcs(panels, "inner")
    layers = [arc_points(arcs, np.linspace(-1, 1, 41)) for arcs in both]
    points = np.concatenate(layers, axis=1)
    on_mould = project(panels.design_spheres[panels.corner_panels, None], points)
    return [x.reshape(-1, 3) for x in np.split(on_mould, panels.offsets[1:-1])]


@pytest.mark.parametrize("edges", ["bisector", "intersection"])
@pytest.mark.parametrize("side", ["inward", "outward", "centred"])
def test_law_caps_hold_their_panels_and_none_is_smaller(
    edges: EdgeMode, side: ThicknessSide
) -> None:
    panels = roof_panels(edges, 0.2, side)
    caps = panel_caps(panels)
    moves = np.random.default_rng(2).normal(size=(20, 3))
    for i, points in enumerate(outlines(panels)):
        center, radius = caps.centers[i], caps.radii[i]
        reach = norm(points - center).max()
        assert reach <= radius * (1 + 1e-11)
        assert reach > radius * (1 - 1e-3)  # samples
        for move in 1e-2 * radius * moves:
            assert norm(points - center - move).max() > reach * (1 - 1e-9)
        # The rim lies on the mould.
        across = np.cross(caps.axes[i], [0.3, 0.5, -0.7])
        rim = center + radius * across / norm(across)
        assert abs(evaluate(panels.design_spheres[i], rim)) < 1e-10 * radius
        crown = center + caps.sagittas[i] * caps.axes[i]
        assert abs(evaluate(panels.design_spheres[i], crown)) < 1e-10 * radius


def test_law_caps_do_not_depend_on_scale_and_place() -> None:
    mesh = roof_net(6, 8, 30.0)
    found = minimize_angles(face_planes(mesh))[0]
    expected = panel_caps(cut_panels(found, thickness=0.1)[0])
    rows = found.local_spheres
    for scale, shift in ((1e-3, 0.0), (1e3, 0.0), (1.0, 1e6)):
        moved = Mesh(scale * mesh.vertices + shift, mesh.faces)
        scaled = SphereMesh.from_local(moved, rows * [1 / scale, 1, 1, 1, scale])
        caps = panel_caps(cut_panels(scaled, thickness=0.1 * scale)[0])
        np.testing.assert_allclose(caps.radii / scale, expected.radii, rtol=1e-7)
        np.testing.assert_allclose(caps.openings, expected.openings, rtol=1e-7)


def test_blanks_are_counted_and_hold_every_panel() -> None:
    panels = roof_panels("bisector", 0.1, "inward")
    diameters = 2 * panel_caps(panels).radii
    same = congruent_panels(panels)
    one = mould_blanks(panels, same)
    assert one.labels.tolist() == [0, 1, 2, 3]
    assert one.counts.sum() == panels.n_panels
    for label, diameter in zip(one.labels, one.diameters, strict=True):
        assert diameter == diameters[panels.labels == label].max()
    stock = mould_blanks(panels, same, 0.25)
    assert stock.counts.sum() == panels.n_panels
    assert len(stock.labels) > 4
    np.testing.assert_allclose(stock.diameters / 0.25, np.round(stock.diameters / 0.25))
    for label in range(4):
        sizes = stock.diameters[stock.labels == label]
        counts = stock.counts[stock.labels == label]
        assert (np.diff(sizes) > 0).all()
        found = diameters[panels.labels == label]
        for size, count in zip(sizes, counts, strict=True):
            assert ((found <= size) & (found > size - 0.25)).sum() == count
    np.testing.assert_allclose(
        np.sin(stock.openings / 2) * stock.radii, stock.diameters / 2, rtol=1e-12
    )
    rise = stock.radii * (1 - np.cos(stock.openings / 2))
    np.testing.assert_allclose(stock.sagittas, rise, rtol=1e-7)


def test_identical_panels_share_a_shape() -> None:
    found = minimize_angles(face_planes(torus_net(30, 12, 10.0, 3.0)))[0]
    found, clusters = cluster_radii(found, 3)
    panels, _ = cut_panels(found, labels=clusters.labels)
    blanks = mould_blanks(panels, congruent_panels(panels))
    assert blanks.shapes.sum() == 6
    np.testing.assert_array_equal(blanks.counts, 60 * blanks.shapes)


def test_a_diameter_on_a_step_needs_no_larger_blank() -> None:
    panels, _ = cut_panels(on_regular_face(4, 0.2), labels=np.zeros(1, np.int64))
    blanks = mould_blanks(panels, congruent_panels(panels), 0.5)
    assert blanks.diameters.tolist() == [2.0]


def test_a_large_mould_keeps_its_radius_where_small_panels_are_planes() -> None:
    corners = np.array([[0, 0], [3, 0], [4, 0], [0, 3], [3, 3], [4, 3]]) - [2.0, 1.5]
    radius = 4.5e5
    height = -np.sum(corners**2, axis=1) / (2 * radius)
    mesh = Mesh(np.column_stack([corners, height]), [[0, 1, 4, 3], [1, 2, 5, 4]])
    ball = np.array([-1 / (2 * radius), 0.0, 0.0, 1.0, 0.0])
    panels, _ = cut_panels(
        SphereMesh(mesh, np.tile(ball, (2, 1))), labels=np.zeros(2, np.int64)
    )
    assert (panels.design_spheres[:, 0] == 0).tolist() == [False, True]
    blanks = mould_blanks(panels, congruent_panels(panels))
    np.testing.assert_allclose(blanks.radii, radius, rtol=1e-9)


def test_panels_without_moulds_need_no_blanks() -> None:
    panels, _ = cut_panels(on_regular_face(4, 0.2))
    for found in (panels, select_parts(panels, np.zeros(1, bool))):
        blanks = mould_blanks(found, congruent_panels(found))
        assert len(blanks.labels) == len(blanks.counts) == 0
    with pytest.raises(InputError, match="step of blank sizes"):
        mould_blanks(panels, congruent_panels(panels), -1.0)
