"""The camera: where a picture is taken from, and what of the scene lies where in it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..kernel.arrays import FloatArray, norm, unit
from ..kernel.errors import InputError

FIELD_OF_VIEW = np.radians(24.0)
"""Horizontal opening: that of a mild telephoto lens, for a calm perspective."""

SAMPLES = 2
"""Samples of a pixel of a picture along each side."""

MARGIN = 0.07
"""Share of the picture that stays empty on each side."""

VIEWS: Final[Mapping[str, tuple[float, float, float]]] = {
    "front": (0.0, -1.0, 0.12),
    "back": (0.0, 1.0, 0.12),
    "left": (-1.0, 0.0, 0.12),
    "right": (1.0, 0.0, 0.12),
    "top": (0.0, 0.0, 1.0),
    "below": (0.5, -0.7, -0.6),
}
"""Directions to the viewer by name; ``home`` is from above, onto the long side."""

View = str | Sequence[float]


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


def view_direction(view: View, points: FloatArray) -> FloatArray:
    """Direction to the viewer of a named view, or the direction that is given.

    Raises InputError if there is no such view.
    """
    if not isinstance(view, str):
        return np.asarray(view, float)
    if view == "home":
        extent = np.ptp(points, axis=0)
        return np.array([0.5, -0.8, 0.5] if extent[0] >= extent[1] else [0.8, 0.5, 0.5])
    if view not in VIEWS:
        names = ", ".join(["home", *VIEWS])
        raise InputError(f"there is no view {view!r}: name one of {names}, or give a direction")
    return np.array(VIEWS[view])


def stand_at(eye: FloatArray, target: FloatArray, width: int, height: int) -> Camera:
    """The camera at an eye that looks at a target, sizes in pixels.

    Raises InputError if they are one point or not finite.
    """
    if eye.shape != (3,) or target.shape != (3,) or not np.isfinite([eye, target]).all():
        raise InputError(
            "the eye and the target of a view must be points of three numbers each"
        )
    if not norm(eye - target) > 0:
        raise InputError("the eye looks at itself: give a target apart from it")
    focal = width / 2 / np.tan(FIELD_OF_VIEW / 2)
    return Camera(eye, view_axes(eye - target), float(focal), width, height)


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
    """Directions in which the camera sees pixels (n,) to the right and downwards.

    As columns (3, n). Their component along the line of sight is 1: the point at depth d is
    ``eye + d direction``.
    """
    across = (x - camera.width / 2) / camera.focal
    upward = (camera.height / 2 - y) / camera.focal
    right, up, back = camera.axes
    return across * right[:, None] + upward * up[:, None] - back[:, None]
