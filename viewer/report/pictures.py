"""Flat panels and spheres under the same stripes, small."""

import base64
import io
from dataclasses import replace

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, sum_by, unit
from ...kernel.panels.panels import Panels
from ..colors import WHITE
from ..render import render_image
from ..shapes import Shape

WIDTH, HEIGHT = 540, 330


def flat_shape(panels: Panels) -> Shape:
    """Panels as planes between the same corners, each about its middle."""
    owners, count = panels.corner_panels, panels.n_panels
    origin: FloatArray = panels.origins.mean(axis=0)
    corners: FloatArray = panels.corners + (panels.origins - origin)[owners]
    middles = sum_by(owners, corners, count) / panels.degrees[:, None]
    following = panels.next_corners
    arms: FloatArray = corners - middles[owners]
    turns: FloatArray = np.cross(arms, arms[following])
    normals = unit(sum_by(owners, turns, count))
    rows = np.zeros((count, 5))
    rows[:, 1:4] = normals
    first: IntArray = np.arange(len(owners))
    return Shape(
        origin,
        np.concatenate([corners, middles]),
        np.concatenate([normals[owners], normals]),
        np.stack([first, following, len(owners) + owners], axis=1),
        owners, rows, middles, np.tile(np.array(WHITE, float), (count, 1)), "polish",
    )  # fmt: skip


def striped_pictures(panels: Panels) -> tuple[str, str]:
    """Flat panels and panels, as addresses of pictures that hold them."""
    shell = replace(panels, thickness=0.0)
    views: list[tuple[Panels | None, list[Shape]]] = [(None, [flat_shape(panels)]), (shell, [])]
    pictures = [
        render_image(
            shown, things=things, color_by="none", shading="zebra", width=WIDTH, height=HEIGHT
        )
        for shown, things in views
    ]
    addresses: list[str] = []
    for picture in pictures:
        file = io.BytesIO()
        picture.save(file, format="JPEG", quality=86)
        addresses.append(f"data:image/jpeg;base64,{base64.b64encode(file.getvalue()).decode()}")
    return addresses[0], addresses[1]
