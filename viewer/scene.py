"""What is seen in the samples of a picture: the exact point, normal and joint of a panel."""

from dataclasses import dataclass

import numpy as np

from ..kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..kernel.errors import InputError
from ..kernel.panels.panels import Panels
from ..kernel.panels.tessellation import PanelTriangles, surface_rows, tessellate
from ..kernel.spheres.incidence import evaluate, normals
from .camera import Camera, pixel_rays

JOINT_WIDTH = 0.01
"""Half width of a drawn joint, in mean edges."""

MIN_JOINT = 0.75
"""The same in samples of the picture, for panels that are small there."""

FINE_PANEL = 20.0
"""Panels of fewer samples across get paler joints, lest the picture turns grey."""


@dataclass(frozen=True)
class Scene:
    """P panels with H corners, made ready to be drawn, relative to the origin of the triangles.

    `rows` (2P + H, 5) are their surfaces, see `surface_rows`. `edges` (H, 8) have the cutting
    plane ``n, -d`` and the function (direction, constant) that runs along the edge from -1 to
    1. The edge length is the mean one.
    """

    panels: Panels
    triangles: PanelTriangles
    rows: FloatArray
    edges: FloatArray
    edge_length: float


def make_scene(panels: Panels) -> Scene:
    """Triangles and tables for drawing panels; raises InputError if there are none."""
    if panels.n_panels == 0:
        raise InputError("there are no panels to draw")
    ends = panels.corners[panels.next_corners]
    half = (ends - panels.corners) / 2
    along = half / dot(half, half)[:, None]
    middle = dot(along, (ends + panels.corners) / 2)
    columns = (panels.plane_normals, -panels.plane_offsets[:, None], along, -middle[:, None])
    return Scene(
        panels,
        tessellate(panels),
        surface_rows(panels),
        np.concatenate(columns, axis=1),
        float(2 * norm(half).mean()),
    )


@dataclass(frozen=True)
class Sight:
    """What is seen in n samples of a picture."""

    x: FloatArray  # (n,) where in the picture, to the right
    y: FloatArray  # and downwards
    triangles: IntArray  # (n,) that are seen
    panels: IntArray  # (n,) that are seen
    points: FloatArray  # (n, 3) of the surfaces, in the coordinates of the scene
    normals: FloatArray  # (n, 3) exact unit normals there, towards the viewer
    rays: FloatArray  # (n, 3) unit vectors from the viewer to the points
    is_inside: BoolArray  # (n,) whether the side is seen that does not look outwards
    joints: FloatArray  # (n,) share of the sample that is covered by a joint


def look(
    scene: Scene, camera: Camera, samples: IntArray, found: IntArray, nearness: FloatArray
) -> Sight:
    """Cut the rays of samples with the surfaces of the triangles `found` that are seen there.

    Samples (n,) are counted row by row.
    """
    panels, surfaces = scene.triangles.panels[found], scene.triangles.surfaces[found]
    shift = scene.panels.origins[panels] - scene.triangles.origin
    x = np.asarray(samples % camera.width, np.float64) + 0.5
    y = np.asarray(samples // camera.width, np.float64) + 0.5
    rays = pixel_rays(camera, x, y)
    rows = scene.rows[surfaces]
    # It is a small step from the triangle to the surface: it costs no digits.
    points = camera.eye + rays / nearness[:, None] - shift
    slope = dot(normals(rows, points), rays)
    value = evaluate(rows, points)
    # At its outline a sphere may be missed by a ray that still meets the triangle, and a wall
    # seen edge on be met anywhere: there the point of the triangle has to do.
    root = np.sqrt(np.maximum(slope**2 - 4 * rows[:, 0] * dot(rays, rays) * value, 0))
    divisor = slope + np.copysign(root, slope)
    is_near = np.abs(2 * value) < scene.edge_length * np.abs(divisor)
    points += np.divide(2 * value, divisor, out=0 * value, where=is_near)[:, None] * rays
    outwards = unit(normals(rows, points))
    is_inside = dot(outwards, rays) > 0
    joints = _joints(scene, panels, points, camera.focal * nearness)
    joints[surfaces >= 2 * scene.panels.n_panels] = 0
    towards = np.where(is_inside[:, None], -outwards, outwards)
    return Sight(
        x, y, found, panels, points + shift, towards, unit(rays), is_inside, joints
    )  # fmt: skip


def _joints(
    scene: Scene, panels: IntArray, points: FloatArray, scale: FloatArray
) -> FloatArray:
    """Share of samples within the width of a joint from an edge of their panel."""
    first, degrees = scene.panels.offsets[panels], scene.panels.degrees[panels]
    nearest = np.full(len(points), np.inf)
    for corner in range(int(degrees.max(initial=0))):
        edge = scene.edges[first + np.minimum(corner, degrees - 1)]
        distance = dot(edge[:, :3], points) + edge[:, 3]
        # Beyond its ends the plane of an edge may cut into a concave panel.
        is_beside = np.abs(dot(edge[:, 4:7], points) + edge[:, 7]) < 1.05
        np.minimum(nearest, np.abs(distance), out=nearest, where=is_beside)
    half = np.maximum(JOINT_WIDTH * scene.edge_length * scale, MIN_JOINT)
    share = np.clip(half - nearest * scale + 0.5, 0, 1)
    return share * np.minimum(1.0, scene.edge_length * scale / FINE_PANEL)
