"""How a scene becomes pixels: which surface is seen where, and in what light.

A pixel has four samples; they are shaded once for each surface that is seen in them. A picture
is taken in bands of rows, which bounds the memory.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..kernel.arrays import FloatArray, IntArray
from .camera import SAMPLES, Camera, project_points
from .light import (
    SUN_PIXELS,
    DepthMap,
    daylight,
    depth_map,
    light_reaches,
    sky_maps,
    sky_openness,
    sun_direction,
)
from .raster import DepthPicture, Raster, affine_over_triangles, close_hairlines, turns_left
from .scene import Scene, look
from .shading import Shading, tones
from .surroundings import ground_picture

DOWN, ACROSS = np.indices((SAMPLES, SAMPLES)).reshape(2, -1) + 0.5
"""Where the samples of a pixel are."""

BAND = 96
"""Rows of pixels that are drawn at a time: what bounds the memory."""

_BATCH = 1 << 14
"""As many places are shaded as stay in the processor's cache."""


@dataclass(frozen=True)
class _Lamps:
    sky: list[DepthMap]
    sun: DepthMap
    softness: float


@dataclass
class _Places:
    """Places of a band that are shaded: pixels with one surface, and shares of others.

    Coordinates are in samples; pixels are counted row by row.
    """

    x: FloatArray
    y: FloatArray
    found: IntArray
    near: FloatArray
    pixels: IntArray
    weights: FloatArray


def _places(surfaces: IntArray, seen: DepthPicture, band: slice) -> _Places:
    """What is to be shaded in some rows of samples; of each triangle its surface (T,)."""
    found, steps = (_by_sample(each[band]) for each in (seen.triangles, seen.steps))
    columns = seen.triangles.shape[1] // SAMPLES
    owners = np.append(surfaces, -1).astype(np.int32)[found]
    is_whole = (owners[1:] == owners[0]).all(axis=0)
    inner = np.flatnonzero(is_whole & (owners[0] >= 0))
    x, y = SAMPLES * (inner % columns), SAMPLES * (inner // columns)
    half, mean = SAMPLES / 2, steps[:, inner].mean(axis=0)
    parts = [(x + half, y + half, found[0, inner], mean, inner, np.ones(len(inner)))]
    mixed = np.flatnonzero(~is_whole)
    some = owners[:, mixed]
    for sample in range(SAMPLES**2):
        # The first sample of each surface stands for all of its samples in the pixel.
        is_first = (some[sample] >= 0) & (some[:sample] != some[sample]).all(axis=0)
        chosen = mixed[is_first]
        # They are seen in their middle.
        same = (some[:, is_first] == some[sample, is_first]).astype(np.float64)
        count = same.sum(axis=0)
        x = SAMPLES * (chosen % columns) + ACROSS @ same / count
        y = SAMPLES * (chosen // columns) + DOWN @ same / count
        step = (steps[:, chosen] * same).sum(axis=0) / count
        parts.append((x, y, found[sample, chosen], step, chosen, count / SAMPLES**2))
    x, y, owner, step, pixels, weights = (np.concatenate(p) for p in zip(*parts, strict=True))
    return _Places(x, y, owner, seen.lowest + seen.step * step, pixels, weights)


def _by_sample(values: NDArray[np.int32]) -> NDArray[np.int32]:
    """Values of samples (rows, columns) as those of each pixel in turn, (4, pixels)."""
    rows, columns = values.shape
    split = values.reshape(rows // SAMPLES, SAMPLES, columns // SAMPLES, SAMPLES)
    return split.transpose(1, 3, 0, 2).reshape(SAMPLES**2, -1)


def expose(
    scene: Scene, camera: Camera, shading: Shading, *, ground: bool = True
) -> Image.Image:
    """The picture of a scene, band by band."""
    lamps = _hang_lamps(scene, camera)
    width, height = camera.width // SAMPLES, camera.height // SAMPLES
    picture = ground_picture(
        scene, camera, lamps.sky, lamps.sun, lamps.softness, empty=not ground
    )
    drawn = _drawable(scene, camera)
    if drawn is not None:
        screen, ids = drawn
        window = _window(screen[scene.triangles[ids].ravel()], width, height)
        shares = _openness_over(scene, lamps, screen, ids)
        for part, places in _bands(scene, screen, ids, window):
            colors = _shade(scene, camera, shading, lamps, (ids, shares), places)
            _put(picture[:, *part], places, colors)
    return _develop(picture)


def _window(points: FloatArray, width: int, height: int) -> tuple[slice, slice]:
    """Rows and columns of pixels between which all points (N, 3) on the screen lie."""
    sides = zip((1, 0), (height, width), strict=True)
    low, high = points.min(axis=0) / SAMPLES, points.max(axis=0) / SAMPLES
    rows, columns = (
        slice(int(np.clip(low[k] - 1, 0, most)), int(np.clip(high[k] + 2, 0, most)))
        for k, most in sides
    )
    return rows, columns


def _bands(
    scene: Scene, screen: FloatArray, ids: IntArray, window: tuple[slice, slice]
) -> Iterator[tuple[tuple[slice, slice], _Places]]:
    """Rows and columns of a window of the picture, and what is to be shaded in them."""
    rows, columns = window
    corner = SAMPLES * np.array([columns.start, rows.start, 0])
    width, height = SAMPLES * (columns.stop - columns.start), SAMPLES * (rows.stop - rows.start)
    veil = scene.is_veil[ids] if scene.is_veil[ids].any() else None
    raster = Raster(screen - corner, scene.triangles[ids], width, veil)
    for top in range(0, height, SAMPLES * BAND):
        bottom = min(top + SAMPLES * BAND, height)
        # One row more on both sides, whose neighbours a hairline may be closed with.
        first, last = max(top - 1, 0), min(bottom + 1, height)
        seen = close_hairlines(raster.band(first, last), veil)
        places = _places(scene.surfaces[ids], seen, slice(top - first, bottom - first))
        places.x += corner[0]
        places.y += corner[1] + top
        part = slice(rows.start + top // SAMPLES, rows.start + bottom // SAMPLES)
        yield (part, columns), places


def _drawable(scene: Scene, camera: Camera) -> tuple[FloatArray, IntArray] | None:
    """Points on the screen, and triangles that may be seen: in front, and not their backs."""
    ahead = -(scene.points - camera.eye) @ camera.axes[2]
    nearest = 1e-3 * float(ahead.max(initial=0))
    if not nearest > 0:
        return None
    is_ahead = ahead > nearest
    points = scene.points
    if not is_ahead.all():
        points = np.where(is_ahead[:, None], points, camera.eye - camera.axes[2])
    screen = project_points(camera, points)
    chosen = is_ahead[scene.triangles].all(axis=1)
    chosen &= ~scene.is_closed | turns_left(screen, scene.triangles)
    ids = np.flatnonzero(chosen)
    return (screen, ids) if len(ids) else None


def _hang_lamps(scene: Scene, camera: Camera) -> _Lamps:
    """The sky, and a sun from the upper left behind the viewer."""
    solid = scene.triangles[~scene.is_veil]
    points = scene.points
    sun = sun_direction(camera.axes[0], camera.axes[2])
    size = float(np.ptp(points, axis=0).max())
    return _Lamps(
        sky_maps(points, solid),
        depth_map(points, solid, sun, min(SUN_PIXELS, camera.width)),
        0.012 * size,
    )


def _openness_over(
    scene: Scene, lamps: _Lamps, screen: FloatArray, ids: IntArray
) -> FloatArray:
    """Share of the sky on the seen side of triangles, as affine functions of the picture."""
    triangles = scene.triangles[ids]
    used = np.zeros(len(scene.points), bool)
    used[triangles] = True
    openness = np.zeros((len(scene.points), 2))
    openness[used] = sky_openness(lamps.sky, scene.points[used], scene.normals[used])
    away = ~turns_left(screen, triangles)
    values = openness[triangles, away.astype(np.int64)[:, None]]
    return affine_over_triangles(screen, triangles, values)


def _shade(
    scene: Scene,
    camera: Camera,
    shading: Shading,
    lamps: _Lamps,
    triangles: tuple[IntArray, FloatArray],
    places: _Places,
) -> FloatArray:
    """Linear colours (3, n) of places."""
    ids, shares = triangles
    colors = np.empty((3, len(places.x)))
    for begin in range(0, len(places.x), _BATCH):
        part = slice(begin, begin + _BATCH)
        x, y, found = places.x[part], places.y[part], places.found[part]
        sight = look(scene, camera, x, y, ids[found], places.near[part])
        constant, along_x, along_y = np.take(shares, found, axis=1)
        openness = np.clip(constant + along_x * x + along_y * y, 0, 1)
        lift = 2 * lamps.sun.pixel + lamps.softness / 4
        sunshine = light_reaches(lamps.sun, sight.points + lift * sight.normals, lamps.softness)
        light = daylight(sight.normals, openness, lamps.sun.axes[2], sunshine)
        colors[:, part] = np.clip(tones(scene, sight, camera, light, shading), 0, 1)
    return colors


def _put(picture: NDArray[np.float32], places: _Places, colors: FloatArray) -> None:
    """Put places in their colours (3, n) before what a part of a picture shows."""
    shape, count = picture.shape[1:], picture[0].size
    clear = 1 - np.bincount(places.pixels, places.weights, count).reshape(shape)
    picture *= clear.astype(np.float32)
    for channel, layer in enumerate(colors):
        front = np.bincount(places.pixels, places.weights * layer, count)
        picture[channel] += front.reshape(shape)


def _develop(picture: NDArray[np.float32]) -> Image.Image:
    """Linear light (3, height, width) as sRGB."""
    fine = 4095
    curve = np.round(255 * (np.arange(fine + 1) / fine) ** (1 / 2.2)).astype(np.uint8)
    picture *= fine
    picture += 0.5
    pixels = curve[np.clip(picture, 0, fine, out=picture).astype(np.uint16)]
    return Image.fromarray(np.ascontiguousarray(pixels.transpose(1, 2, 0)))
