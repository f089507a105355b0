"""How a surface looks in its light: paint, and what polish mirrors."""

from typing import Literal

import numpy as np

from ..kernel.arrays import FloatArray
from .camera import Camera
from .scene import FINISHES, Scene, Sight, product

Shading = Literal["studio", "zebra", "lamps", "mirror"]
"""Matt paint; stripes; a few long lamps overhead; sky, ground and a row of houses."""

STRIPES = 14
"""Bright stripes that a mirrored ray passes in a turn of 2π."""

LAMPS, LAMP_APART, LAMP_WIDTH = 7, 17.0, 1.4
"""Lamps, the angle between two and half the width of each, in degrees."""

HOUSES = 26
"""Houses around the horizon that polish mirrors."""

INSIDE = 0.62 * (np.array([226, 226, 222]) / 255) ** 2.2
"""Grey to which the inner side of a surface pales."""

_POLISH, _INK = FINISHES.index("polish"), FINISHES.index("ink")


def tones(
    scene: Scene, sight: Sight, camera: Camera, light: FloatArray, shading: Shading
) -> FloatArray:
    """Colours (3, n), linear, of what is seen in a light (3, n) that falls on it."""
    paint = scene.colors[sight.surfaces].T.copy()
    finish = scene.finishes[sight.surfaces]
    is_ink = finish == _INK
    polished = finish == _POLISH
    if shading == "studio" or not polished.all():
        result = _painted(sight, paint, light, polished)
    else:
        result = np.empty_like(paint)
    if shading != "studio" and polished.any():
        across = camera.axes[0]
        if shading == "zebra":
            bright = _zebra(sight, across, paint, light)
        elif shading == "lamps":
            bright = _lamps(sight, across, paint, light)
        else:
            bright = _surroundings(sight, paint, light)
        result = bright if polished.all() else np.where(polished, bright, result)
    if is_ink.any():
        result = np.where(is_ink, paint, result)
    return result


def mirrored(sight: Sight) -> FloatArray:
    """Where rays (3, n) go that a surface throws back."""
    return sight.rays - 2 * product(sight.normals, sight.rays) * sight.normals


def _painted(
    sight: Sight, paint: FloatArray, light: FloatArray, polished: np.ndarray
) -> FloatArray:
    """Matt paint with a faint sheen; the inner side of panels in a paler, greyer tone."""
    inside = sight.is_inside & polished
    paint = np.where(inside, 0.35 * paint + 0.65 * INSIDE[:, None], paint)
    cosine = -product(sight.normals, sight.rays)
    upward = sight.rays[2] + 2 * cosine * sight.normals[2]
    rest = np.clip(1 - cosine, 0, 1)
    sheen = (0.03 + 0.3 * rest**2 * rest**2 * rest) * np.clip(0.3 + upward, 0, 1)
    result = paint * light + sheen * light[1]
    return result * (1 - 0.8 * sight.joints)


def _with_joints(sight: Sight, tone: FloatArray) -> FloatArray:
    joints = 0.35 * sight.joints
    return tone * (1 - joints) + 0.2 * joints


def _zebra(
    sight: Sight, across: FloatArray, paint: FloatArray, light: FloatArray
) -> FloatArray:
    """Stripes of light reflected in polished panels."""
    angle = np.arcsin(np.clip(across @ mirrored(sight), -1, 1))
    stripe = 0.5 + 0.5 * np.tanh(6 * np.cos(STRIPES * angle))
    tone = (0.06 + 0.84 * stripe) * (0.55 + 0.45 * light[1])
    white = np.array([[0.97], [0.99], [1.0]])
    return _with_joints(sight, tone * (0.88 * white + 0.12 * 1.25 * paint))


def _lamps(
    sight: Sight, across: FloatArray, paint: FloatArray, light: FloatArray
) -> FloatArray:
    """Long lamps overhead, across the view, mirrored in dark polish."""
    rays = mirrored(sight)
    level = np.cross(across, [0.0, 0.0, 1.0])
    level /= np.linalg.norm(level)
    angle = np.degrees(np.arctan2(level @ rays, np.maximum(rays[2], 0.001)))
    place = np.clip(np.rint(angle / LAMP_APART), -(LAMPS // 2), LAMPS // 2)
    beyond = np.clip((np.abs(angle - LAMP_APART * place) - LAMP_WIDTH) / 0.4, 0, 1)
    lamp = (1 - beyond**2 * (3 - 2 * beyond)) * (rays[2] >= 0) * (0.55 + 0.45 * light[1])
    polish = paint * 0.28 * (0.5 + 0.5 * light) + 0.05 * np.clip(0.4 + rays[2], 0, 1)
    white = np.array([[0.96], [0.98], [1.0]])
    return _with_joints(sight, polish + lamp * (white - polish))


def _surroundings(sight: Sight, paint: FloatArray, light: FloatArray) -> FloatArray:
    """A sky, a ground and a row of houses, mirrored in polish with some of its own colour."""
    rays = mirrored(sight)
    world = _world(rays)
    cosine = -product(sight.normals, sight.rays)
    share = 0.72 + 0.28 * np.clip(1 - cosine, 0, 1) ** 3
    tone = share * world * (0.5 + 0.5 * light[1]) + (1 - share) * paint * light
    return _with_joints(sight, tone)


def _world(rays: FloatArray) -> FloatArray:
    """What stands in each direction (3, n): made up, but the same in every picture."""
    height = rays[2]
    up = np.clip(height, 0, 1)
    turn = np.arctan2(rays[1], rays[0]) / (2 * np.pi) + 0.5
    low, high = np.array([[0.86], [0.90], [0.94]]), np.array([[0.16], [0.34], [0.66]])
    sky = low + np.sqrt(up) * (high - low)
    clouds = np.sin(5 * up + 9 * np.pi * turn) * np.sin(17 * up - 6 * np.pi * turn)
    sky += np.clip(clouds - 0.35, 0, 1) * (1 - sky) * np.clip(4 * up, 0, 1)
    house = np.floor(turn * HOUSES)
    roof: FloatArray = 0.05 + 0.16 * (np.sin(house * 12.9898) * 43758.5453 % 1)
    tint: FloatArray = 0.10 + 0.16 * (np.sin(house * 78.233) * 24634.6345 % 1)
    stone: FloatArray = tint * np.array([[1.0], [0.93], [0.85]])
    ground = np.array([[0.20], [0.22], [0.17]]) * (1 - 0.5 * np.clip(-height, 0, 1))
    above: FloatArray = np.where(height < roof, stone, sky)
    result: FloatArray = np.where(height < 0, ground, above)
    return result
