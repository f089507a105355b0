import numpy as np
import pytest
from numpy.testing import assert_allclose

from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.colors import UNLABELLED, mould_color
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.rows import from_center_radius, normalize
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, roof_net, torus_net
from spheremesh.viewer.camera import Camera, frame_scene, pixel_rays, project_points
from spheremesh.viewer.colors import ColorBy
from spheremesh.viewer.raster import rasterize
from spheremesh.viewer.render import compare_image, render_image
from spheremesh.viewer.scene import Scene, Sight, gather, look
from spheremesh.viewer.shapes import panel_shape

SMALL = {"width": 160, "height": 120}
FRONT = (0.0, -1.0, 0.4)


def ball(**options: object) -> Panels:
    return cut_panels(fit_spheres(ellipsoid_net(16, 10, 2.0, 2.0, 1.4)), **options)[0]


def pixels(panels: Panels, **options: object) -> np.ndarray:
    return np.asarray(render_image(panels, **{**SMALL, "legend": False, **options})).astype(
        float
    )


def subject(picture: np.ndarray) -> np.ndarray:
    """Pixels that are coloured: paper and shadows are nearly grey."""
    return np.ptp(picture, axis=2) > 40


def test_picture_has_its_size_and_shows_the_panels_before_paper() -> None:
    image = render_image(ball(), width=200, height=100)
    picture = np.asarray(image)
    assert image.mode == "RGB"
    assert picture.shape == (100, 200, 3)
    corners = picture[[0, 0, -1, -1], [0, -1, 0, -1]]
    assert (corners > 200).all()
    assert picture[50, 100].mean() < 200
    assert len(np.unique(picture)) > 50


def test_equal_panels_give_equal_pictures() -> None:
    assert render_image(ball(), **SMALL).tobytes() == render_image(ball(), **SMALL).tobytes()


def test_panels_fill_the_frame_but_not_its_margin() -> None:
    labels = np.zeros(160, np.int64)
    is_subject = subject(pixels(ball(labels=labels), direction=FRONT))
    rows = np.flatnonzero(is_subject.any(axis=1))
    assert 4 < rows[0] < 14
    assert 106 < rows[-1] < 116


def test_moulds_are_painted_in_their_colours() -> None:
    labels = np.arange(160) % 10 // 5
    panels = ball(labels=labels)
    picture = pixels(panels, direction=FRONT)
    found = picture[subject(picture)]
    found = found / norm(found)[:, None]
    for label in (0, 1):
        color = np.array(mould_color(label, 2), float)
        cosine = found @ (color / norm(color))
        assert (cosine > 0.99).mean() > 0.1
    grey = pixels(ball(), direction=FRONT)
    assert not subject(grey).any()
    assert mould_color(-1, 2) == UNLABELLED


def test_curvature_is_red_outside_and_blue_inside() -> None:
    out, into = (
        pixels(panels, color_by="radius", direction=(0, 0, 1))[50:70, 70:90].mean((0, 1))
        for panels in (dome(1.0), dome(-1.0))
    )
    assert out[0] > out[2] + 40
    assert into[2] > into[0] + 40


def dome(side: float) -> Panels:
    """One square panel that is seen from above: a hill or a hollow."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    center, radius = np.array([[0, 0, -side * np.sqrt(7.0)]]), np.array([9.0])
    row = -side * normalize(from_center_radius(center, radius))
    return cut_panels(SphereMesh(Mesh(corners, [range(4)]), row))[0]


def test_zebra_of_a_symmetric_scene_is_symmetric() -> None:
    picture = pixels(ball(), shading="zebra", direction=(0, 0, 1)).mean(axis=2)
    middle = picture[20:100, 40:120]
    assert np.ptp(middle) > 120
    mirrored = np.abs(middle - middle[:, ::-1])
    # The light comes from one side; the stripes do not.
    assert np.quantile(mirrored, 0.9) < 60


def sight_of(
    panels: Panels, direction: tuple[float, float, float]
) -> tuple[Scene, Camera, Sight]:
    """What is seen of panels, in a picture of 200 by 160 samples."""
    shape = panel_shape(panels, np.full((panels.n_panels, 3), 200.0))
    scene = gather([shape])
    camera = frame_scene(scene.points, np.array(direction), 200, 160)
    picture = rasterize(project_points(camera, scene.points), scene.triangles, 200, 160)
    y, x = np.nonzero(picture.triangles >= 0)
    found, near = picture.triangles[y, x], picture.nearness[y, x]
    return scene, camera, look(scene, camera, x + 0.5, y + 0.5, found, near)


def test_normals_are_those_of_the_spheres_and_not_of_the_triangles() -> None:
    scene, camera, sight = sight_of(ball(), FRONT)
    is_outer = ~sight.is_inside
    from_center = sight.points + scene.origin[:, None]
    assert_allclose(norm(from_center.T), 2.0, atol=1e-9)
    assert_allclose(from_center[:, is_outer] / 2, sight.normals[:, is_outer], atol=1e-9)
    along = norm(np.cross((sight.points - camera.eye[:, None]).T, sight.rays.T))
    assert along.max() < 1e-9 * norm(camera.eye)


def test_rays_and_projection_are_inverse() -> None:
    points = np.random.default_rng(3).normal(size=(50, 3))
    camera = frame_scene(points, np.array([1.0, 2.0, 3.0]), 300, 200)
    screen = project_points(camera, points)
    rays = pixel_rays(camera, screen[:, 0], screen[:, 1])
    back = camera.eye + (rays / screen[:, 2]).T
    assert_allclose(back, points, atol=1e-12)
    assert screen[:, 0].min() >= 0
    assert screen[:, 0].max() <= 300
    assert screen[:, 1].min() >= 0
    assert screen[:, 1].max() <= 200


def test_triangles_share_pixels_out_without_gaps() -> None:
    rng = np.random.default_rng(5)
    inner = rng.uniform(5, 55, (200, 2))
    outline = np.array([[2, 2], [60, 2], [60, 60], [2, 60.0]])
    from scipy.spatial import Delaunay

    flat = np.concatenate([outline, inner])
    triangles = Delaunay(flat).simplices.astype(np.int64)
    points = np.column_stack([flat, np.zeros(len(flat))])
    together = rasterize(points, triangles, 64, 64).triangles >= 0
    counts = sum(
        (rasterize(points, triangles[i : i + 1], 64, 64).triangles >= 0).astype(int)
        for i in range(len(triangles))
    )
    assert together[2:60, 2:60].all()
    assert together.sum() == 58 * 58
    assert np.max(counts) == 1


def test_nearer_triangle_hides_the_farther_one() -> None:
    square = np.array([[0, 0], [10, 0], [0, 10.0]])
    far, near = (np.column_stack([square, np.full(3, depth)]) for depth in (1.0, 2.0))
    for first, second, expected in ((far, near, 1), (near, far, 0)):
        picture = rasterize(np.concatenate([first, second]), np.arange(6).reshape(2, 3), 10, 10)
        assert picture.triangles[2, 2] == expected
        assert picture.nearness[2, 2] == pytest.approx(2.0)
        assert picture.triangles[9, 9] == -1


@pytest.mark.parametrize("direction", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 1, -0.3)])
def test_every_direction_shows_something(direction: tuple[float, float, float]) -> None:
    panels = cut_panels(face_planes(torus_net(8, 6, 3.0, 1.0)), thickness=0.1)[0]
    picture = pixels(panels, direction=direction)
    assert np.isfinite(picture).all()
    assert np.ptp(picture) > 60


def test_pictures_do_not_depend_on_the_site() -> None:
    mesh = roof_net(6, 15, 80.0)
    here = cut_panels(fit_spheres(mesh))[0]
    there = cut_panels(fit_spheres(Mesh(mesh.vertices + 2.0**20, mesh.faces)))[0]
    difference = np.abs(pixels(here) - pixels(there))
    assert np.quantile(difference, 0.99) <= 2


def test_legend_takes_its_place_beside_the_panels() -> None:
    panels = ball(labels=np.arange(160) % 3)
    plain, listed = (
        pixels(panels, width=400, legend=False),
        pixels(panels, width=400, legend=True),
    )
    swatch = np.array(mould_color(2, 3), float)
    beside = slice(250, None)
    assert 60 < (listed[:, beside] == swatch).all(axis=2).sum() < 300
    assert not (plain[:, 300:] == swatch).all(axis=2).any()
    middle = [np.flatnonzero(subject(p)[:, :250].any(axis=0)).mean() for p in (plain, listed)]
    assert middle[1] < middle[0] - 20


def test_long_legends_are_cut() -> None:
    panels = ball(labels=np.arange(160))
    assert pixels(panels, width=400, legend=True).shape == (120, 400, 3)


def test_comparison_shows_the_same_view_twice() -> None:
    mesh = roof_net(8, 20, 80.0)
    plane, smooth = (cut_panels(fit(mesh))[0] for fit in (face_planes, fit_spheres))
    picture = np.asarray(compare_image(plane, plane, width=320, height=120)).astype(int)
    left, right = picture[:, :160], picture[:, 160:]
    assert (left == right).all()
    mixed = np.asarray(compare_image(plane, smooth, width=320, height=120)).astype(int)
    assert (np.abs(mixed[:, :160] - left) < 30).mean() > 0.98
    assert (np.abs(mixed[:, 160:] - right) > 30).mean() > 0.02


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"color_by": "colour"}, "color_by must be one of 'mould', 'radius', 'angle'"),
        ({"shading": "gold"}, "shading must be one of"),
        ({"width": 0}, "width must be 16 to"),
        ({"height": 10**6}, "height must be 16 to"),
        ({"direction": (0, 0, 0)}, "direction of a view"),
        ({"direction": (1, 2)}, "direction of a view"),
        ({"legend": True, "color_by": "none"}, "nothing for a legend to say"),
        ({"direction": "under"}, "no view 'under': name one of home, front"),
        ({"eye": (0, 0, 5), "direction": "top"}, "a direction or an eye, not both"),
        ({"target": (0, 0, 5)}, "a target needs an eye"),
        ({"eye": (1, 2, 3), "target": (1, 2, 3)}, "looks at itself"),
    ],
)
def test_unusable_options_are_named(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        render_image(dome(1.0), **options)


@pytest.mark.parametrize("color_by", ["mould", "radius", "convexity", "none"])
def test_no_panels_no_picture(color_by: ColorBy) -> None:
    with pytest.raises(InputError, match="no panels"):
        render_image(select_parts(dome(1.0), np.zeros(1, bool)), color_by=color_by)
