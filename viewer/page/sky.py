"""How much light of the sky arrives at the points of panels: as `viewer.light` counts it."""

from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ..light import DepthMap, blurred, point_maps, sky_openness

DIRECTIONS: Final = 14
"""Of the sky, for pictures that are made quickly."""

GROUND: Final = 48
"""Points of the ground along each side."""

REACH: Final = 1.6
"""Side of the ground, in sizes of the model."""


def panel_openness(points: FloatArray, normals: FloatArray, sky: list[DepthMap]) -> IntArray:
    """Share of the sky seen on both sides of points, from 0 to 255, (N, 2)."""
    return np.rint(255 * sky_openness(sky, points, normals)).astype(np.int64)


def ground_openness(points: FloatArray, sky: list[DepthMap]) -> IntArray:
    """The same for a square of ground below points, by rows along y, (GROUND, GROUND)."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = REACH * float((high - low).max()) * np.linspace(-0.5, 0.5, GROUND)
    middle = (low + high) / 2
    ground = np.empty((GROUND, GROUND, 3))
    ground[..., 0], ground[..., 1] = middle[0] + side, (middle[1] + side)[:, None]
    ground[..., 2] = low[2]
    ground = ground.reshape(-1, 3)
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), ground.shape)
    open_shares = sky_openness(sky, ground, up)[:, 0].reshape(GROUND, GROUND)
    soft = blurred(open_shares, 1.2)
    return np.rint(255 * soft).astype(np.int64)


def point_sky(points: FloatArray, spacing: float) -> list[DepthMap]:
    """Depth pictures of points (N, 3) that stand at most a spacing apart on their surfaces."""
    return point_maps(points, spacing, DIRECTIONS)


def point_spacing(points: FloatArray) -> float:
    """How far neighbouring points are apart on their surfaces, where they stand in order."""
    apart = norm(np.diff(points, axis=0)) if len(points) > 1 else np.zeros(1)
    return float(np.quantile(apart, 0.9))
