"""Pictures of panels without any graphics hardware.

Triangles only find the panel that is seen in a pixel; the ray of the pixel is then cut with the
panel's sphere, so that normals, reflections and joints are exact and nothing is faceted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ..kernel.arrays import FloatArray, IntArray, dot, sum_by, unit
from ..kernel.errors import InputError
from ..kernel.panels.panels import Panels
from ..kernel.panels.tessellation import tessellate
from ..kernel.parts.colors import mould_color
from .camera import Camera, frame_scene, pixel_rays, project_points
from .light import (
    SUN_PIXELS,
    DepthMap,
    daylight,
    depth_map,
    light_reaches,
    sky_maps,
    sky_openness,
)
from .raster import affine_over_triangles, close_hairlines, rasterize
from .scene import Scene, Sight, look, make_scene

ColorBy = Literal["mould", "radius", "none"]
Shading = Literal["studio", "zebra"]

SUPERSAMPLING = 2
"""Samples of a pixel along each side."""

_BATCH = 1 << 15
"""As many are shaded as stay in the processor's cache."""

MAX_SIDE = 8000

STRIPES = 14
"""Bright stripes that a mirrored ray passes in a turn of 2π."""

LEADING = 1.6
"""Distance of the lines of a legend, in sizes of its type."""

_WHITE = (226, 226, 222)
_OUTWARDS, _INWARDS = (214, 118, 92), (92, 138, 190)
_INK = (52, 56, 62)


def render_image(
    panels: Panels,
    *,
    color_by: ColorBy = "mould",
    shading: Shading = "studio",
    direction: Sequence[float] | None = None,
    width: int = 1600,
    height: int = 1000,
    legend: bool = False,
) -> Image.Image:
    """A picture of panels in daylight, RGB; the same for the same panels.

    Colours stand for the mould; or the curvature (red where a panel curves outwards, blue where
    inwards, pale where flat); or nothing. The shading is ``studio``: matt, in the light of sky
    and sun; or ``zebra``: reflected stripes, which break at every edge that is not smooth. The
    direction points from the panels to the viewer; by default from above, onto the long side.
    Sizes are in pixels. A legend lists moulds, their radii and numbers of panels at the right.

    Raises InputError if there are no panels, or an option is unknown or out of range.
    """
    _check_options(color_by, shading, width, height)
    if legend and color_by != "mould":
        raise InputError('a legend lists moulds: it needs color_by="mould"')
    scene = make_scene(panels)
    strip = min(12 * _legend_font(panels, height), width // 2) if legend else 0
    camera = _frame([scene], direction, width, height, strip)
    image = _take(scene, camera, _panel_colors(panels, color_by), shading)
    if legend:
        _draw_legend(image, panels)
    return image


def compare_image(
    left: Panels,
    right: Panels,
    *,
    captions: tuple[str, str] = ("", ""),
    shading: Shading = "zebra",
    direction: Sequence[float] | None = None,
    width: int = 1600,
    height: int = 600,
) -> Image.Image:
    """Two sets of panels of the same model side by side, seen by the same camera, RGB.

    Captions stand below them; the size is that of the whole picture, the rest as in
    `render_image`.
    """
    _check_options("none", shading, width, height)
    scenes = [make_scene(left), make_scene(right)]
    half = width // 2
    camera = _frame(scenes, direction, half, height)
    result = Image.new("RGB", (2 * half, height))
    draw, font = ImageDraw.Draw(result), ImageFont.load_default(max(11, height // 28))
    for place, (scene, caption) in enumerate(zip(scenes, captions, strict=True)):
        moved = scenes[0].triangles.origin - scene.triangles.origin
        own = replace(camera, eye=camera.eye + moved)
        image = _take(scene, own, _panel_colors(scene.panels, "none"), shading)
        result.paste(image, (place * half, 0))
        middle = (place * half + half // 2, height - height // 16)
        draw.text(middle, caption, fill=_INK, font=font, anchor="mm")
    return result


def _check_options(color_by: str, shading: str, width: int, height: int) -> None:
    for name, value, known in (("color_by", color_by, ColorBy), ("shading", shading, Shading)):
        if value not in get_args(known):
            choices = ", ".join(repr(choice) for choice in get_args(known))
            raise InputError(f"{name} must be one of {choices}, not {value!r}")
    for name, value in (("width", width), ("height", height)):
        if not 16 <= value <= MAX_SIDE:
            raise InputError(f"the {name} must be 16 to {MAX_SIDE} pixels, not {value}")


def _frame(
    scenes: list[Scene],
    direction: Sequence[float] | None,
    width: int,
    height: int,
    strip: int = 0,
) -> Camera:
    origin = scenes[0].triangles.origin
    points = np.concatenate(
        [scene.triangles.points + (scene.triangles.origin - origin) for scene in scenes]
    )
    if direction is None:
        extent = np.ptp(points, axis=0)
        towards = np.array([0.5, -0.8, 0.5] if extent[0] >= extent[1] else [0.8, 0.5, 0.5])
    else:
        towards = np.asarray(direction, float)
    fine = SUPERSAMPLING
    return frame_scene(points, towards, fine * width, fine * height, fine * strip)


def _take(scene: Scene, camera: Camera, colors: FloatArray, shading: Shading) -> Image.Image:
    """The picture of a scene, in samples, and then in pixels."""
    triangles = scene.triangles
    screen = project_points(camera, triangles.points)
    picture = rasterize(screen, triangles.triangles, camera.width, camera.height)
    picture = close_hairlines(picture)
    lamps = _hang_lamps(scene, camera)
    openness = sky_openness(lamps.sky, triangles.points, triangles.normals)
    shares = np.stack(
        [
            affine_over_triangles(screen, triangles.triangles, side[triangles.triangles])
            for side in openness.T
        ]
    )
    found, nearness = picture.triangles.ravel(), picture.nearness.ravel()
    seen = np.flatnonzero(found >= 0)
    tones = np.empty((len(seen), 3))
    for begin in range(0, len(seen), _BATCH):
        samples = seen[begin : begin + _BATCH]
        sight = look(scene, camera, samples, found[samples], nearness[samples])
        light = _light_on(sight, lamps, shares)
        if shading == "zebra":
            tones[begin : begin + _BATCH] = _zebra(sight, camera, light)
        else:
            tones[begin : begin + _BATCH] = _studio(sight, colors[sight.panels], light)
    return _develop(_ground_picture(scene, camera, lamps), camera, seen, tones)


@dataclass(frozen=True)
class _Lamps:
    sky: list[DepthMap]
    sun: DepthMap
    softness: float


def _hang_lamps(scene: Scene, camera: Camera) -> _Lamps:
    """The sky, and a sun from the upper left behind the viewer."""
    coarse = tessellate(scene.panels, 0.02, solid=False)
    right, _, back = camera.axes
    level = unit(np.array([back[0], back[1], 0.0]) - 1.1 * np.array([right[0], right[1], 0.0]))
    sun = unit(level + np.array([0.0, 0.0, 1.15]))
    size = float(np.ptp(coarse.points, axis=0).max())
    return _Lamps(
        sky_maps(coarse.points, coarse.triangles),
        depth_map(coarse.points, coarse.triangles, sun, min(SUN_PIXELS, camera.width)),
        0.012 * size,
    )


def _light_on(sight: Sight, lamps: _Lamps, shares: FloatArray) -> FloatArray:
    constant, along_x, along_y = shares[sight.is_inside.astype(np.int64), sight.triangles].T
    openness = np.clip(constant + along_x * sight.x + along_y * sight.y, 0, 1)
    lift = 2 * lamps.sun.pixel + lamps.softness / 4
    sunshine = light_reaches(lamps.sun, sight.points + lift * sight.normals, lamps.softness)
    return daylight(sight.normals, openness, lamps.sun.axes[2], sunshine)


def _studio(sight: Sight, colors: FloatArray, light: FloatArray) -> FloatArray:
    """Matt paint with a faint sheen; the inner side in a paler, greyer tone."""
    grey = _linear(_WHITE) * 0.62
    paint = np.where(sight.is_inside[:, None], 0.35 * colors + 0.65 * grey, colors)
    cosine = -dot(sight.normals, sight.rays)
    mirrored = sight.rays[:, 2] + 2 * cosine * sight.normals[:, 2]
    sheen = (0.03 + 0.3 * (1 - cosine) ** 5) * np.clip(0.3 + mirrored, 0, 1)
    result = paint * light + (sheen * light[:, 1])[:, None]
    return result * (1 - 0.8 * sight.joints[:, None])


def _zebra(sight: Sight, camera: Camera, light: FloatArray) -> FloatArray:
    """Stripes of light reflected in polished panels."""
    mirrored = sight.rays - 2 * dot(sight.normals, sight.rays)[:, None] * sight.normals
    right = unit(camera.axes[0])
    angle = np.arcsin(np.clip(mirrored @ right, -1, 1))
    stripe = 0.5 + 0.5 * np.tanh(6 * np.cos(STRIPES * angle))
    tone = 0.06 + 0.84 * stripe
    result = (tone * (0.55 + 0.45 * light[:, 1]))[:, None] * np.array([0.97, 0.99, 1.0])
    joints = 0.35 * sight.joints[:, None]
    return result * (1 - joints) + 0.2 * joints


def _ground_picture(scene: Scene, camera: Camera, lamps: _Lamps) -> FloatArray:
    """The ground with its shadows (height, width, 3): smooth, so enlarged from few points."""
    from scipy.ndimage import gaussian_filter

    width, height = camera.width // SUPERSAMPLING, camera.height // SUPERSAMPLING
    columns, rows = max(width // 4, 2), max(height // 4, 2)
    x, y = np.meshgrid(
        (np.arange(columns) + 0.5) * camera.width / columns,
        (np.arange(rows) + 0.5) * camera.height / rows,
    )
    rays = pixel_rays(camera, x.ravel(), y.ravel())
    depth = float(scene.triangles.points[:, 2].min()) - camera.eye[2]
    is_ground = rays[:, 2] * depth > 0
    distance = np.divide(depth, rays[:, 2], out=np.zeros(len(rays)), where=is_ground)
    points = camera.eye + distance[:, None] * rays
    upwards = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
    openness = sky_openness(lamps.sky, points, upwards)[:, 0].reshape(rows, columns)
    # Each direction of the sky throws its own faint shadow: a blur hides their edges.
    openness = np.asarray(gaussian_filter(openness, columns / 120), np.float64)
    lifted = points + np.array([0.0, 0.0, 2 * lamps.sun.pixel])
    sunshine = light_reaches(lamps.sun, lifted, 2 * lamps.softness).reshape(rows, columns)
    sunshine = np.asarray(gaussian_filter(sunshine, columns / 320), np.float64)
    light = daylight(upwards, openness.ravel(), lamps.sun.axes[2], sunshine.ravel())
    light[~is_ground] = 1.0
    # Paper white, a little darker towards the lower rim.
    paper = 0.93 - 0.1 * (y.ravel() / camera.height) ** 2
    picture = np.asarray((light * paper[:, None]).reshape(rows, columns, 3), np.float32)
    layers = [
        Image.fromarray(picture[..., channel]).resize((width, height), Image.Resampling.BICUBIC)
        for channel in range(3)
    ]
    return np.stack([np.asarray(layer, np.float64) for layer in layers], axis=2)


def _develop(
    ground: FloatArray, camera: Camera, seen: IntArray, tones: FloatArray
) -> Image.Image:
    """Means over the samples of each pixel, before the ground, as sRGB."""
    height, width, _ = ground.shape
    column, row = seen % camera.width // SUPERSAMPLING, seen // camera.width // SUPERSAMPLING
    pixels = row * width + column
    weight = 1 / SUPERSAMPLING**2
    cover = weight * np.bincount(pixels, minlength=height * width)[:, None]
    front = weight * sum_by(pixels, np.clip(tones, 0, 1), height * width)
    values = front + (1 - cover) * np.clip(ground.reshape(-1, 3), 0, 1)
    picture = np.round(255 * values ** (1 / 2.2)).reshape(height, width, 3)
    return Image.fromarray(np.asarray(picture, np.uint8))


def _panel_colors(panels: Panels, color_by: ColorBy) -> FloatArray:
    """Colour of the paint of each panel (P, 3), linear."""
    if color_by == "mould":
        count = int(panels.labels.max()) + 1
        palette = [mould_color(label, count) for label in range(-1, count)]
        return _linear(palette)[panels.labels + 1]
    if color_by == "none":
        return np.tile(_linear(_WHITE), (panels.n_panels, 1))
    curvature = -panels.spheres[:, 0]
    limit = np.quantile(np.abs(curvature), 0.95)
    share = np.clip(curvature / limit, -1, 1)[:, None] if limit > 0 else curvature[:, None]
    full = np.where(share > 0, _linear(_OUTWARDS), _linear(_INWARDS))
    return _linear(_WHITE) + np.abs(share) * (full - _linear(_WHITE))


def _linear(colors: object) -> FloatArray:
    return (np.asarray(colors, float) / 255) ** 2.2


def _legend_font(panels: Panels, height: int) -> int:
    """Size of type, in pixels, at which the moulds fit in the height."""
    lines = len(np.unique(panels.labels)) + 1
    return int(np.clip(0.9 * height / lines / LEADING, 9, max(9, height / 45)))


def _draw_legend(image: Image.Image, panels: Panels) -> None:
    """Swatch, number (from 1, as in `mould_name`), radius and count of each mould."""
    labels, first, counts = np.unique(panels.labels, return_index=True, return_counts=True)
    size = _legend_font(panels, image.height)
    step = LEADING * size
    shown = min(len(labels), int(0.9 * image.height / step) - 1)
    font, draw = ImageFont.load_default(size), ImageDraw.Draw(image)
    left, top = image.width - 15 * size, (image.height - step * (shown + 1)) / 2

    def write(line: int, column: float, text: str) -> None:
        place = (left + column * size, top + line * step)
        draw.text(place, text, fill=_INK, font=font, anchor="ra")

    for column, title in ((5.0, "mould"), (9.2, "radius"), (13.4, "panels")):
        write(0, column, title)
    moulds = zip(labels.tolist(), first.tolist(), counts.tolist(), strict=True)
    for line, (label, panel, count) in enumerate(list(moulds)[:shown], start=1):
        y = top + line * step
        swatch = (left, y, left + 1.4 * size, y + size)
        draw.rectangle(swatch, fill=mould_color(label, int(labels[-1]) + 1))
        curvature = 2 * abs(float(panels.spheres[panel, 0]))
        write(line, 5.0, "-" if label < 0 else str(label + 1))
        write(line, 9.2, f"{1 / curvature:#.4g}" if curvature > 0 else "plane")
        write(line, 13.4, str(count))
    if shown < len(labels):
        write(shown + 1, 13.4, f"and {len(labels) - shown} more")
