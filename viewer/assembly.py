"""Pictures of panels on their beams: from below, where beams are seen, or near a node."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PIL import Image

from ..kernel.arrays import FloatArray, IntArray, dot, norm, unit
from ..kernel.beams.beams import Beams
from ..kernel.beams.node_cylinders import node_cylinders
from ..kernel.beams.triangles import BeamTriangles, beam_triangles, cylinder_triangles
from ..kernel.errors import InputError
from ..kernel.panels.panels import Panels
from ..kernel.panels.tessellation import tessellate
from .camera import frame_scene, project_points
from .raster import rasterize

TOLERANCE = 0.002
"""How far triangles may be off, relative to a part."""

SAMPLES = 3
"""Samples of a pixel along each side."""

REACH = 0.3
"""Share of the longest beam of a node that is seen around it."""

PANEL, BEAM, NODE = (0.72, 0.80, 0.86), (0.80, 0.55, 0.28), (0.30, 0.32, 0.36)
INK, PAPER = 0.45, (1.0, 1.0, 1.0)


def assembly_image(
    panels: Panels,
    beams: Beams,
    direction: Sequence[float] = (0.6, -0.8, -0.7),
    near: int | None = None,
    width: int = 1600,
    height: int = 1000,
) -> Image.Image:
    """A picture of panels and beams together, with lines where parts end.

    Parameters
    ----------
    panels : Panels
        The panels, with or without thickness.
    beams : Beams
        The beams, and their node cylinders if they have any.
    direction : sequence of float
        Towards the viewer; below the model by default.
    near : int, optional
        Vertex of the mesh whose node is to fill the picture; by default all is seen.
    width, height : int
        Size in pixels.

    Returns
    -------
    Image
        The picture.

    Raises
    ------
    InputError
        If the direction is no direction, or no beam ends at the vertex.
    """
    scene = _gathered(panels, beams)
    framed = scene.points if near is None else _around(beams, near) - scene.origin
    towards = np.asarray(direction, float)
    camera = frame_scene(framed, towards, SAMPLES * width, SAMPLES * height)
    ahead = dot(scene.points - camera.eye, -camera.axes[2][None]) > 0
    shown = np.flatnonzero(ahead[scene.triangles].all(axis=1))
    screen = project_points(camera, np.where(ahead[:, None], scene.points, framed[:1]))
    seen = rasterize(screen, scene.triangles[shown], camera.width, camera.height).triangles
    lamp = unit(camera.axes[2] + 0.5 * camera.axes[0] + 0.7 * camera.axes[1])
    tones = 0.3 + 0.7 * np.abs(dot(scene.normals, lamp[None]))
    shades = scene.colors[shown] * tones[scene.triangles[shown]].mean(axis=1)[:, None]
    colors = np.append(shades, [PAPER], axis=0)[seen]
    parts = np.append(scene.parts[shown], -1)[seen]
    for axis in (0, 1):
        ends = np.diff(parts, axis=axis, prepend=np.take(parts, [0], axis)) != 0
        colors[ends] *= INK
    pixels = colors.reshape(height, SAMPLES, width, SAMPLES, 3).mean(axis=(1, 3))
    return Image.fromarray((255 * np.clip(pixels, 0, 1) ** (1 / 1.6)).astype(np.uint8))


class _Scene(NamedTuple):
    """Points (N, 3) about an origin, normals, triangles (T, 3), their colours and parts."""

    origin: FloatArray
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    colors: FloatArray
    parts: IntArray


def _gathered(panels: Panels, beams: Beams) -> _Scene:
    """Triangles of all panels, beams and node cylinders, about the origin of the panels."""
    skin = tessellate(panels, TOLERANCE)
    scenes = [
        _Scene(
            skin.origin, skin.points, skin.normals, skin.triangles,
            np.tile(PANEL, (len(skin.triangles), 1)), skin.panels,
        )
    ]  # fmt: skip
    scenes += [_flat(part, skin.origin, BEAM) for part in beam_triangles(beams, TOLERANCE)]
    nodes = node_cylinders(beams)
    if nodes.n_nodes:
        drums = cylinder_triangles(
            nodes.origins, nodes.directions, nodes.heights, nodes.radius, 0.02
        )
        scenes.append(_flat(drums, skin.origin, NODE))
    points = np.cumsum([0, *(len(scene.points) for scene in scenes)]).tolist()
    parts = np.cumsum([0, *(int(scene.parts.max(initial=-1)) + 1 for scene in scenes)]).tolist()
    return _Scene(
        skin.origin,
        np.concatenate([scene.points for scene in scenes]),
        np.concatenate([scene.normals for scene in scenes]),
        np.concatenate([each.triangles + n for each, n in zip(scenes, points, strict=False)]),
        np.concatenate([scene.colors for scene in scenes]),
        np.concatenate([each.parts + n for each, n in zip(scenes, parts, strict=False)]),
    )


def _flat(part: BeamTriangles, origin: FloatArray, color: tuple[float, float, float]) -> _Scene:
    count, size = part.points.shape[:2]
    ids: IntArray = np.arange(int(count))
    triangles: IntArray = (part.triangles + int(size) * ids[:, None, None]).reshape(-1, 3)
    return _Scene(
        origin, part.points.reshape(-1, 3) - origin, part.normals.reshape(-1, 3), triangles,
        np.tile(color, (len(triangles), 1)), np.repeat(ids, len(part.triangles)),
    )  # fmt: skip


def _around(beams: Beams, vertex: int) -> FloatArray:
    """Corners of a box, in model coordinates, that a picture of a node has to hold."""
    annuli = beams.annuli
    rows, ends = np.nonzero(annuli.edge_vertices == vertex)
    if len(rows) == 0:
        raise InputError(f"no beam ends at vertex {vertex}: name a vertex that carries beams")
    tops = annuli.corners[rows, ends] + annuli.origins[rows][:, None]
    lengths = norm(annuli.corners[rows, 1 - ends] - annuli.corners[rows, ends])
    box = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), -1).reshape(-1, 3)
    reach: FloatArray = tops.mean(axis=(0, 1)) + REACH * float(lengths.max()) * box
    return reach
