import time
import tracemalloc

import numpy as np
import pytest
from numpy.testing import assert_allclose

from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.parts.findings import Finding
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.spheres.rows import from_center_radius
from spheremesh.kernel.surfaces.circular_nets import roof_net, vase_net
from spheremesh.nodes import beams as cut_beams
from spheremesh.nodes import bisector_support
from spheremesh.viewer.camera import frame_scene, project_points, stand_at
from spheremesh.viewer.colors import panel_colors
from spheremesh.viewer.raster import Raster, rasterize, turns_left
from spheremesh.viewer.render import render_image
from spheremesh.viewer.scene import gather, look
from spheremesh.viewer.shapes import (
    Shape,
    axis_shape,
    circle_shape,
    edge_shape,
    line_shape,
    mesh_shape,
    sphere_shape,
)

SMALL = {"width": 160, "height": 120}


def one_sphere(radius: float = 1.0, **options: bool) -> Shape:
    rows = from_center_radius(np.array([[3.0, 2.0, 1.0]]), np.array([radius**2]))
    return sphere_shape(rows, (200, 60, 60), **options)


def picture(*things: Shape, **options: object) -> np.ndarray:
    image = render_image(things=things, **{**SMALL, "ground": False, **options})
    return np.asarray(image).astype(float)


def coloured(pixels: np.ndarray) -> np.ndarray:
    return np.ptp(pixels, axis=2) > 40


@pytest.mark.parametrize("zoom", [1.0, 30.0])
def test_highlights_of_spheres_are_those_of_the_analytic_picture(zoom: float) -> None:
    """Normals where rays meet the sphere in closed form: no triangle shows at any zoom."""
    scene = gather([one_sphere()])
    toward = np.array([0.3, -1.0, 0.4])
    eye = 6.0 * toward / norm(toward)
    camera = stand_at(eye, np.zeros(3), 200, 160)
    camera = type(camera)(camera.eye, camera.axes, camera.focal * zoom, 200, 160)
    screen = project_points(camera, scene.points)
    fronts = np.flatnonzero(turns_left(screen, scene.triangles))
    seen = rasterize(screen, scene.triangles[fronts], 200, 160)
    y, x = np.nonzero(seen.triangles >= 0)
    found, near = fronts[seen.triangles[y, x]], seen.nearness[y, x]
    sight = look(scene, camera, x + 0.5, y + 0.5, found, near)
    along = sight.rays.T @ eye
    root = along**2 - eye @ eye + 1
    exact = eye + (-along - np.sqrt(np.maximum(root, 0)))[:, None] * sight.rays.T
    # Beside the outline of the sphere itself the triangle has to do.
    inner = root > 0.01
    assert inner.mean() > 0.97
    assert_allclose(sight.normals.T[inner], exact[inner], atol=1e-9)


def test_one_sees_through_veils() -> None:
    behind = line_shape([[3.0, 5.0, 1.0]], [[3.0, 5.0, 1.4]], 0.4, (0, 0, 250))
    whole, veil = (
        picture(one_sphere(is_veil=is_veil), behind, direction=(0, -1, 0))
        for is_veil in (False, True)
    )
    blue = [(each[..., 2] > each[..., 0] + 20).sum() for each in (whole, veil)]
    assert blue[0] < 0.2 * blue[1]


def test_meshes_lines_circles_and_axes_are_drawn() -> None:
    net = vase_net(12, 6, 1.0, 2.0, 0.3)
    flat, smooth = (picture(mesh_shape(net, (190, 90, 60), smooth=s)) for s in (False, True))
    assert coloured(flat).mean() > 0.1
    assert np.abs(flat - smooth).mean() > 0.3
    edges = picture(edge_shape(net, 0.01, (200, 20, 20)))
    assert 0.01 < coloured(edges).mean() < 0.5 * coloured(flat).mean()
    axes = np.stack([net.vertices, net.vertices + np.array([0, 0, 0.2])], axis=1)
    assert coloured(picture(axis_shape(axes, 0.02, (20, 20, 200)))).any()
    ring = picture(circle_shape([[0, 0, 0]], [[0, 0, 1]], 1.0, 0.05, (200, 20, 20)))
    assert not coloured(ring)[55:65, 75:85].any()


def test_things_that_cannot_be_drawn_are_named() -> None:
    with pytest.raises(InputError, match="planes have no outline"):
        sphere_shape([[0, 0, 0, 1.0, 0]], (0, 0, 0))
    with pytest.raises(InputError, match="ends where it starts"):
        line_shape([[0, 0, 0]], [[0, 0, 0]], 0.1)
    with pytest.raises(InputError, match="nothing to draw"):
        render_image()


def test_an_eye_sees_what_lies_before_it() -> None:
    sphere = one_sphere()
    before = picture(sphere, eye=(3.0, -6.0, 1.0), target=(3.0, 2.0, 1.0))
    rows, columns = np.nonzero(coloured(before))
    assert_allclose([rows.mean(), columns.mean()], [60, 80], atol=2)
    assert coloured(picture(sphere, eye=(3.0, -6.0, 1.0))).sum() == len(rows)
    assert not coloured(picture(sphere, eye=(3.0, -6.0, 1.0), target=(3.0, -9.0, 1.0))).any()
    # Within the sphere nothing stands before the near plane but its other side, a back.
    picture(sphere, eye=(3.0, 2.0, 1.0), target=(3.0, 3.0, 1.0))


@pytest.mark.parametrize("shape", [(4.0, 1.0, 1.0), (1.0, 1.0, 6.0)])
def test_wide_and_tall_things_fill_the_frame(shape: tuple[float, float, float]) -> None:
    net = vase_net(8, 4, 1.0, 2.0, 0.3)
    from spheremesh.kernel.meshes.mesh import with_vertices

    longer = with_vertices(net, net.vertices * shape)
    seen = coloured(picture(mesh_shape(longer, (190, 90, 60)), direction="front"))
    rows, columns = np.nonzero(seen)
    filled = max(np.ptp(rows) / 120, np.ptp(columns) / 160)
    assert 0.82 < filled < 0.9


def test_beams_and_nodes_are_drawn_below_panels() -> None:
    spheres = fit_spheres(vase_net(12, 6, 1.0, 2.0, 0.3))
    made = cut_beams(
        bisector_support(spheres, depth=0.1).annuli, thickness=0.03, node_radius=0.06
    ).beams
    panels, _ = cut_panels(spheres)
    bare = np.asarray(render_image(panels, **SMALL)).astype(float)
    carried = np.asarray(render_image(panels, beams=made, **SMALL)).astype(float)
    alone = np.asarray(render_image(beams=made, **SMALL)).astype(float)
    assert (np.abs(bare - carried).max(axis=2) > 30).mean() > 0.01
    assert (np.abs(alone - carried).max(axis=2) > 30).mean() > 0.05


@pytest.mark.parametrize("color_by", ["angle", "area", "planarity", "tilt", "radius"])
def test_measures_have_a_scale(color_by: str) -> None:
    panels, _ = cut_panels(fit_spheres(vase_net(12, 6, 1.0, 2.0, 0.3)))
    colors, legend = panel_colors(panels, color_by)
    assert colors.shape == (72, 3)
    assert legend is not None
    assert len(legend.scale) == 9
    wide = np.asarray(render_image(panels, color_by=color_by, width=300, height=120))
    assert (wide[:, 240:] < 120).any()


def test_findings_and_corners_have_kinds() -> None:
    panels, _ = cut_panels(fit_spheres(vase_net(12, 6, 1.0, 2.0, 0.3)))
    found = [
        Finding("P1", "P0003", "", severity="note"),
        Finding("P2", "P0003", ""),
        Finding("P2", "P0004", "", severity="note"),
    ]
    _, legend = panel_colors(panels, "finding", found)
    assert legend is not None
    assert [words[1] for _, words in legend.kinds] == ["1", "1", "70"]
    _, legend = panel_colors(panels, "convexity")
    assert legend is not None
    assert [words[1] for _, words in legend.kinds] == ["72", "0"]


@pytest.mark.parametrize("shading", ["zebra", "lamps", "mirror"])
def test_polish_mirrors_and_beams_do_not(shading: str) -> None:
    panels, _ = cut_panels(fit_spheres(vase_net(12, 6, 1.0, 2.0, 0.3)))
    plain, polished = (
        np.asarray(render_image(panels, shading=s, **SMALL)).astype(float)
        for s in ("studio", shading)
    )
    assert (np.abs(plain - polished).max(axis=2) > 20).mean() > 0.05
    sphere = one_sphere()
    assert (picture(sphere) == picture(sphere, shading=shading)).all()


def test_bands_are_parts_of_one_picture() -> None:
    scene = gather([one_sphere()])
    camera = frame_scene(scene.points, np.array([1.0, -1.0, 0.5]), 90, 80)
    screen = project_points(camera, scene.points)
    whole = rasterize(screen, scene.triangles, 90, 80).triangles
    raster = Raster(screen, scene.triangles, 90)
    parts = [raster.band(top, top + 16).triangles for top in range(0, 80, 16)]
    np.testing.assert_array_equal(np.concatenate(parts), whole)


def test_pictures_of_many_panels_are_bounded() -> None:
    """Seconds of 5,000 panels are in benchmarks/viewer.py; here that they hardly cost more."""
    few, many = (
        cut_panels(fit_spheres(roof_net(m, n, 80.0)), thickness=0.02)[0]
        for m, n in ((10, 12), (40, 62))
    )
    seconds = []
    for panels in (few, few, many):
        start = time.process_time()
        render_image(panels, width=800, height=500)
        seconds.append(time.process_time() - start)
    assert seconds[2] < 6 * seconds[1]
    tracemalloc.start()
    render_image(many, width=800, height=500)
    assert tracemalloc.get_traced_memory()[1] < 150e6
    tracemalloc.stop()
