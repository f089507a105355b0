"""Daylight for pictures: a bright sky, and a sun with a soft edge.

How much of the sky a point sees is counted with depth pictures from directions all over the
sky. It is smooth: coarse pictures of scattered points will do, and it is taken at the points of
the triangles and interpolated. The cost is the same for any model.
"""

from dataclasses import dataclass

import numpy as np

from ..kernel.arrays import FloatArray, IntArray, norm, unit
from .camera import view_axes
from .raster import rasterize

SKY_DIRECTIONS = 32
SCATTERED = 24_000
"""Points that stand for the surfaces of a model in the sky's pictures of it."""

FINEST = 120
"""Pixels of such a picture along the longest side, at most."""

SUN_PIXELS = 560

WELDED = 30_000
"""Points from which on those that share a pixel of the sky get one light."""


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

    The points, columns (3, n), are lifted from their surface towards the light by about a
    pixel; the softness is the width of the edge of shadows, in model units, 0 for a hard edge.
    """
    across, upward, height = light.axes @ points
    across, upward = (
        (across - light.corner[0]) / light.pixel,
        (upward - light.corner[1]) / light.pixel,
    )
    # The pixel under a point may lie a little higher than the point itself.
    limit = height + light.pixel
    if not softness:
        return _taps(light, across, upward, limit, [0.0])
    width = softness / light.pixel
    result = _taps(light, across, upward, limit, [-width / 2, width / 2])
    # Where all corners of the edge agree there is none: that is nearly everywhere.
    edge = np.flatnonzero((result > 0) & (result < 1))
    taps = np.linspace(-0.5, 0.5, 4) * width
    result[edge] = _taps(light, across[edge], upward[edge], limit[edge], taps.tolist())
    return result


def _taps(
    light: DepthMap,
    across: FloatArray,
    upward: FloatArray,
    limit: FloatArray,
    taps: list[float],
) -> FloatArray:
    """Share of the taps, along both sides, at which the light is not hidden."""
    size, heights = len(light.heights), light.heights.ravel()
    columns, rows = (
        [_pixels(values + tap, size) for tap in taps] for values in (across, upward)
    )
    total = np.zeros(len(limit))
    for row in rows:
        start = row * size
        for column in columns:
            total += heights[start + column] <= limit
    return total / len(taps) ** 2


def _pixels(values: FloatArray, size: int) -> IntArray:
    return np.clip(values, 0, size - 1).astype(np.int64)


def sky_directions(count: int) -> FloatArray:
    """Middles of so many parts of the sky of equal size, (count, 3)."""
    index = np.arange(count) + 0.5
    height = index / count
    turn = np.pi * (1 + 5**0.5) * index
    across = np.sqrt(1 - height**2)
    return np.stack([across * np.cos(turn), across * np.sin(turn), height], axis=1)


def scatter(points: FloatArray, triangles: IntArray) -> tuple[FloatArray, float]:
    """`SCATTERED` points (n, 3) spread evenly over triangles, and how far apart, about."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    areas = norm(np.cross(b - a, c - a)) / 2
    total = np.cumsum(areas)
    if not len(total) or not total[-1] > 0:
        return points, 0.0
    index = np.arange(SCATTERED) + 0.5
    places: FloatArray = index / SCATTERED * total[-1]
    owners: IntArray = np.minimum(np.searchsorted(total, places), len(triangles) - 1)
    # The sequence of the plastic number leaves no holes and no heaps.
    u, v = (index * 0.7548776662466927) % 1, (index * 0.5698402909980532) % 1
    over = u + v > 1
    u[over], v[over] = 1 - u[over], 1 - v[over]
    a, b, c = a[owners], b[owners], c[owners]
    found = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    return found, float(np.sqrt(total[-1] / SCATTERED))


def sky_maps(points: FloatArray, triangles: IntArray) -> list[DepthMap]:
    """Depth maps of points (N, 3) and triangles (T, 3) from all over the sky."""
    found, spacing = scatter(points, triangles)
    return point_maps(found, spacing, SKY_DIRECTIONS)


def point_maps(points: FloatArray, spacing: float, count: int) -> list[DepthMap]:
    """Depth maps from so many directions of points (N, 3) that stand a spacing apart."""
    return [_point_map(points, spacing, direction) for direction in sky_directions(count)]


def _point_map(points: FloatArray, spacing: float, direction: FloatArray) -> DepthMap:
    axes = view_axes(direction)
    across, upward, height = axes @ points.T
    low = np.array([across.min(), upward.min()])
    extent = float(max(np.ptp(across), np.ptp(upward)))
    pixel = max(extent / (FINEST - 4), 1.3 * spacing) or 1.0
    size = int(extent / pixel) + 5
    corner = low - 2 * pixel
    column, row = (
        ((values - start) / pixel).astype(np.int64)
        for values, start in zip((across, upward), corner.tolist(), strict=True)
    )
    heights = np.full(size * size, -np.inf)
    np.maximum.at(heights, row * size + column, height)
    return DepthMap(axes, corner, pixel, heights.reshape(size, size))


def sky_openness(sky: list[DepthMap], points: FloatArray, normals: FloatArray) -> FloatArray:
    """Share of the light of the sky that reaches both sides of a surface at points (N, 3).

    On the side of the normal, and on the other: (N, 2), 0 hidden, 1 free. Of very many points
    those that share a pixel of the sky and look alike get the same.
    """
    if len(points) <= WELDED:
        return _openness(sky, points.T.copy(), normals.T.copy())
    pixel = max(light.pixel for light in sky)
    cells = np.floor((points - points.min(axis=0)) / pixel).astype(np.int64)
    sides = np.rint(1.3 * normals).astype(np.int64) + 1
    key = (cells @ np.array([1, 1 << 12, 1 << 24])) * 27 + sides @ np.array([1, 3, 9])
    _, first, which = np.unique(key, return_index=True, return_inverse=True)
    counts = np.bincount(which).astype(np.float64)
    means = [
        np.stack([np.bincount(which, column) / counts for column in values.T])
        for values in (points, normals)
    ]
    lengths = np.sqrt(sum(row * row for row in means[1]))
    means[1] = np.where(lengths > 0, means[1] / np.maximum(lengths, 1e-300), normals[first].T)
    return _openness(sky, *means)[which]


def _openness(sky: list[DepthMap], points: FloatArray, normals: FloatArray) -> FloatArray:
    """The same for columns (3, n)."""
    count = points.shape[1]
    seen, whole = np.zeros((2, count)), np.full((2, count), 1e-9)
    for light in sky:
        slope = light.axes[2] @ normals
        lift = np.copysign(1.5 * light.pixel, slope)
        reaches = light_reaches(light, points + lift * normals)
        for side, cosine in enumerate((np.maximum(slope, 0), np.maximum(-slope, 0))):
            seen[side] += cosine * reaches
            whole[side] += cosine
    return (seen / whole).T


def blurred(values: FloatArray, width: float) -> FloatArray:
    """A grid of values (rows, columns) spread by a Gaussian of so many cells."""
    reach = int(3 * width) + 1
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    weights /= weights.sum()
    for _ in range(2):
        padded = np.pad(values, ((reach, reach), (0, 0)), "edge")
        views = np.lib.stride_tricks.sliding_window_view(padded, len(weights), axis=0)
        values = (views @ weights).T
    return values


def sun_direction(right: FloatArray, back: FloatArray) -> FloatArray:
    """Towards the sun, from the upper left behind a viewer with these axes."""
    level = unit(np.array([back[0], back[1], 0.0]) - 1.1 * np.array([right[0], right[1], 0.0]))
    return unit(level + np.array([0.0, 0.0, 1.15]))


def daylight(
    normals: FloatArray, openness: FloatArray, sun: FloatArray, sunshine: FloatArray
) -> FloatArray:
    """Light (3, n) that falls on a surface: red, green and blue, linear.

    From unit normals (3, n), on the side that is looked at, and the shares (n,) of the light of
    sky and sun that arrive; `sun` points towards it. A cool sky, a warm sun, and what the
    ground throws back: free level ground gets 1.
    """
    up = normals[2]
    sky = openness * (0.5 + 0.5 * up)
    ground = (0.35 + 0.65 * openness) * (0.5 - 0.5 * up)
    direct = sunshine * np.maximum(sun @ normals, 0) / sun[2]
    return np.stack(
        [
            s * sky + g * ground + d * direct
            for s, g, d in ((0.52, 0.26, 0.48), (0.55, 0.25, 0.45), (0.60, 0.24, 0.40))
        ]
    )
