"""Daylight for pictures: a bright sky, and a sun with a soft edge.

How much of the sky a point sees is counted with depth pictures from directions all over the
sky; it is smooth, so it is taken at the points of the triangles and interpolated.
"""

from dataclasses import dataclass

import numpy as np

from ..kernel.arrays import FloatArray, IntArray, dot
from .camera import view_axes
from .raster import rasterize

SKY_DIRECTIONS = 40
SKY_PIXELS = 224
SUN_PIXELS = 900


@dataclass(frozen=True)
class DepthMap:
    """What is nearest to a far away light.

    The axes (3, 3) are unit vectors across, and towards the light; the corner (2,) is where the
    picture starts along them, a pixel is in model units. The heights (n, n) are coordinates
    towards the light of the nearest point of each pixel; -inf for none.
    """

    axes: FloatArray
    corner: FloatArray
    pixel: float
    heights: FloatArray


def depth_map(
    points: FloatArray, triangles: IntArray, direction: FloatArray, size: int
) -> DepthMap:
    """The parallel picture of points (N, 3) and triangles (T, 3) from the side of a light.

    With an empty rim; the direction points towards the light, the size is in pixels.
    """
    axes = view_axes(direction)
    local = points @ axes.T
    low, extent = local.min(axis=0), np.ptp(local, axis=0)
    pixel = float(extent[:2].max()) / (size - 4) or 1.0
    corner = low[:2] - 2 * pixel
    local[:, :2] = (local[:, :2] - corner) / pixel
    picture = rasterize(local, triangles, size, size)
    return DepthMap(axes, corner, pixel, picture.nearness)


def light_reaches(light: DepthMap, points: FloatArray, softness: float = 0.0) -> FloatArray:
    """Which share of a light reaches points: from 0 in the shadow to 1 in the light.

    The points (N, 3) are lifted from their surface towards the light by about a pixel; the
    softness is the width of the edge of shadows, in model units, 0 for a hard edge.
    """
    size = len(light.heights)
    across, upward, height = light.axes @ points.T
    taps = np.linspace(-1, 1, 4) * softness / 2 if softness else np.zeros(1)
    places = [
        [_pixels((values + tap - start) / light.pixel, size) for tap in taps]
        for values, start in zip((across, upward), light.corner.tolist(), strict=True)
    ]
    heights = light.heights.ravel()
    # The pixel under a point may lie a little higher than the point itself.
    limit = height + light.pixel
    total = np.zeros(len(points))
    for row in places[1]:
        for column in places[0]:
            total += heights[row * size + column] <= limit
    return total / len(taps) ** 2


def _pixels(values: FloatArray, size: int) -> IntArray:
    return np.clip(values, 0, size - 1).astype(np.int64)


def sky_maps(points: FloatArray, triangles: IntArray) -> list[DepthMap]:
    """Depth maps of points (N, 3) and triangles (T, 3), of which coarse ones will do.

    `SKY_DIRECTIONS` of them, for parts of the sky of equal size.
    """
    index = np.arange(SKY_DIRECTIONS) + 0.5
    height = index / SKY_DIRECTIONS
    turn = np.pi * (1 + 5**0.5) * index
    across = np.sqrt(1 - height**2)
    directions = np.stack([across * np.cos(turn), across * np.sin(turn), height], axis=1)
    return [depth_map(points, triangles, direction, SKY_PIXELS) for direction in directions]


def sky_openness(sky: list[DepthMap], points: FloatArray, normals: FloatArray) -> FloatArray:
    """Share of the light of the sky that reaches both sides of a surface at points (N, 3).

    On the side of the normal, and on the other: (N, 2), 0 hidden, 1 free.
    """
    seen, whole = np.zeros((2, len(points))), np.full((2, len(points)), 1e-9)
    for light in sky:
        slope = normals @ light.axes[2]
        lift = np.copysign(1.5 * light.pixel, slope)
        reaches = light_reaches(light, points + lift[:, None] * normals)
        for side, cosine in enumerate((np.maximum(slope, 0), np.maximum(-slope, 0))):
            seen[side] += cosine * reaches
            whole[side] += cosine
    return (seen / whole).T


def daylight(
    normals: FloatArray, openness: FloatArray, sun: FloatArray, sunshine: FloatArray
) -> FloatArray:
    """Light (N, 3) that falls on a surface: red, green and blue, linear.

    From unit normals (N, 3), on the side that is looked at, and the shares (N,) of the light of
    sky and sun that arrive; `sun` points towards it. A cool sky, a warm sun, and what the
    ground throws back: free level ground gets 1.
    """
    up = normals[:, 2]
    sky = openness * (0.5 + 0.5 * up)
    ground = (0.35 + 0.65 * openness) * (0.5 - 0.5 * up)
    direct = sunshine * np.maximum(dot(normals, sun), 0) / sun[2]
    return (
        sky[:, None] * np.array([0.52, 0.55, 0.60])
        + ground[:, None] * np.array([0.26, 0.25, 0.24])
        + direct[:, None] * np.array([0.48, 0.45, 0.40])
    )
