"""The ground that things stand on, with their shadows."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..kernel.arrays import BoolArray, FloatArray
from .camera import Camera, pixel_rays
from .light import DepthMap, blurred, daylight, light_reaches, sky_openness
from .scene import Scene

_COARSE = 160
"""Columns at which the ground is seen by the sky: its light is smooth."""

_FINE = 400
"""Columns at which it is seen by the sun."""


def ground_picture(
    scene: Scene,
    camera: Camera,
    sky: list[DepthMap],
    sun: DepthMap,
    softness: float,
    *,
    empty: bool = False,
) -> NDArray[np.float32]:
    """Linear light (3, height, width) of the ground, enlarged from few points; or paper alone.

    The camera has two samples to a pixel, and its eye is about the origin of the scene.
    """
    width, height = camera.width // 2, camera.height // 2
    rows, columns = _grid(width, height, _FINE)
    # Paper white, a little darker towards the lower rim.
    paper = 0.93 - 0.1 * ((np.arange(height) + 0.5) / height)[:, None] ** 2
    if empty:
        return np.broadcast_to(paper, (3, height, width)).astype(np.float32)
    level = float(scene.points[:, 2].min())
    points, is_ground = _ground_points(camera, level, rows, columns)
    lifted = points + np.array([[0.0], [0.0], [2 * sun.pixel]])
    sunshine = light_reaches(sun, lifted, 2 * softness).reshape(rows, columns)
    sunshine = blurred(sunshine, columns / 320).ravel()
    openness = _openness(camera, level, sky, (rows, columns))
    upwards = np.broadcast_to(np.array([[0.0], [0.0], [1.0]]), points.shape)
    light = daylight(upwards, openness.ravel(), sun.axes[2], sunshine)
    light[:, ~is_ground] = 1.0
    layers = [_enlarged(layer.reshape(rows, columns), (width, height)) for layer in light]
    return np.stack(layers) * paper.astype(np.float32)


def _openness(
    camera: Camera, level: float, sky: list[DepthMap], shape: tuple[int, int]
) -> FloatArray:
    rows, columns = _grid(shape[1], shape[0], _COARSE)
    points, _ = _ground_points(camera, level, rows, columns)
    upwards = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.T.shape)
    found = sky_openness(sky, points.T, upwards)[:, 0].reshape(rows, columns)
    # Each direction of the sky throws its own faint shadow: a blur hides their edges.
    soft = blurred(found, columns / 90)
    return np.asarray(_enlarged(soft, (shape[1], shape[0])), np.float64)


def _grid(width: int, height: int, most: int) -> tuple[int, int]:
    """Rows and columns of a coarse picture of the same shape."""
    share = min(1.0, most / width)
    return max(round(share * height), 2), max(round(share * width), 2)


def _ground_points(
    camera: Camera, level: float, rows: int, columns: int
) -> tuple[FloatArray, BoolArray]:
    """Where the rays of a coarse picture meet the ground (3, n), and whether they do."""
    x, y = np.meshgrid(
        (np.arange(columns) + 0.5) * camera.width / columns,
        (np.arange(rows) + 0.5) * camera.height / rows,
    )
    rays = pixel_rays(camera, x.ravel(), y.ravel())
    depth = level - camera.eye[2]
    is_ground = rays[2] * depth > 0
    distance = np.divide(depth, rays[2], out=np.zeros_like(rays[2]), where=is_ground)
    return camera.eye[:, None] + distance * rays, is_ground


def _enlarged(values: FloatArray, size: tuple[int, int]) -> NDArray[np.float32]:
    image = Image.fromarray(np.asarray(values, np.float32))
    return np.asarray(image.resize(size, Image.Resampling.BILINEAR))
