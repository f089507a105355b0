"""The camera: where a picture is taken from, and what of the scene lies where in it."""

from dataclasses import dataclass

import numpy as np

from ..kernel.arrays import FloatArray, norm, unit
from ..kernel.errors import InputError

FIELD_OF_VIEW = np.radians(24.0)
"""Horizontal opening: that of a mild telephoto lens, for a calm perspective."""

MARGIN = 0.07
"""Share of the picture that stays empty on each side."""


@dataclass(frozen=True)
class Camera:
    """A perspective camera.

    The eye is relative to the origin of the triangles; the axes (3, 3) are unit vectors to the
    right, upwards, and back towards the viewer; focal length and size are in pixels.
    """

    eye: FloatArray
    axes: FloatArray
    focal: float
    width: int
    height: int


def view_axes(direction: FloatArray) -> FloatArray:
    """Axes of a camera that looks against a direction, of any length, and stands upright.

    Unit vectors (3, 3) to the right, upwards, and towards the viewer. Raises InputError if the
    direction is zero or not finite.
    """
    if direction.shape != (3,) or not np.isfinite(direction).all() or not norm(direction) > 0:
        raise InputError(f"the direction of a view must be three numbers, not {direction}")
    back = unit(direction)
    # Seen from straight above there is no upright: then y is up.
    upright = np.array([0.0, 0.0, 1.0]) if abs(back[2]) < 0.9999 else np.array([0.0, 1.0, 0.0])
    right = unit(np.cross(upright, back))
    return np.stack([right, np.cross(back, right), back])


def frame_scene(
    points: FloatArray, direction: FloatArray, width: int, height: int, strip: int = 0
) -> Camera:
    """The nearest camera whose pyramid of view holds all points (N, 3).

    The direction points to the viewer; sizes are in pixels, the strip that is kept free at the
    right among them. Closed form: each side of the pyramid touches the points where ``x ± t z``
    is extreme, with t the slope of the side. Raises InputError if the direction is zero or not
    finite.
    """
    axes = view_axes(direction)
    x, y, z = axes @ points.T
    focal = width / 2 / np.tan(FIELD_OF_VIEW / 2)
    across, upward = (0.5 - MARGIN) * width / focal, (0.5 - MARGIN) * height / focal
    right = across - strip / focal
    # Of each pair of sides: the slopes, and where the sides meet the plane z = 0.
    pairs = [
        (across, right, float((x - across * z).min()), float((x + right * z).max())),
        (upward, upward, float((y - upward * z).min()), float((y + upward * z).max())),
    ]
    distance = max((high - low) / (s + t) for s, t, low, high in pairs)
    middles = [(low + s * distance + high - t * distance) / 2 for s, t, low, high in pairs]
    return Camera(np.array([*middles, distance]) @ axes, axes, float(focal), width, height)


def project_points(camera: Camera, points: FloatArray) -> FloatArray:
    """Where points (N, 3) in front of a camera lie in its picture.

    Pixels to the right and downwards, and the nearness (inverse depth), which is affine over
    the picture of a triangle: (N, 3).
    """
    x, y, z = camera.axes @ (points - camera.eye).T
    nearness = -1 / z
    return np.stack(
        [
            camera.width / 2 + camera.focal * x * nearness,
            camera.height / 2 - camera.focal * y * nearness,
            nearness,
        ],
        axis=1,
    )


def pixel_rays(camera: Camera, x: FloatArray, y: FloatArray) -> FloatArray:
    """Directions (n, 3) in which the camera sees pixels to the right and downwards.

    Their component along the line of sight is 1: the point at depth d is ``eye + d direction``.
    """
    across = (x - camera.width / 2) / camera.focal
    upward = (camera.height / 2 - y) / camera.focal
    right, up, back = camera.axes
    return across[:, None] * right + upward[:, None] * up - back
