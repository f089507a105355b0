"""What is seen in the samples of a picture: the exact point, normal and joint of a surface."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..kernel.arrays import BoolArray, FloatArray, IntArray
from .camera import Camera, pixel_rays
from .shapes import Finish, Shape

JOINT_WIDTH = 0.01
"""Half width of a drawn joint, in mean edges."""

MIN_JOINT = 0.75
"""The same in samples of the picture, for panels that are small there."""

PIXEL = 2.0
"""Samples over which the edge of a joint is spread."""

FINE_PANEL = 20.0
"""Panels of fewer samples across get paler joints, lest the picture turns grey."""

FINISHES: tuple[Finish, ...] = ("polish", "matt", "ink")


@dataclass(frozen=True)
class Scene:
    """Shapes gathered: N points, T triangles, S surfaces, about one origin.

    Attributes
    ----------
    origin : (3,) float array
        In model coordinates.
    points, normals : (N, 3) float array
        Of the triangles.
    triangles : (T, 3) int array
        Points of each.
    surfaces : (T,) int array
        Surface of each.
    is_closed, is_veil : (T,) bool array
        Whose back is never seen; through which one sees.
    table : (8, S) float array
        Rows of the surfaces, and what they are local to.
    is_exact : (S,) bool array
        Which have a row.
    colors : (S, 3) float array
        Linear, from 0 to 1.
    finishes : (S,) int array
        Places in `FINISHES`.
    joint_first, joint_degrees : (S,) int array
        Edges with a joint.
    joint_edges : (8, H) float array
        See `Joints`.
    lengths : (S,) float array
        Mean edges, or the size of what has no edges.
    """

    origin: FloatArray
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    surfaces: IntArray
    is_closed: BoolArray
    is_veil: BoolArray
    table: FloatArray
    is_exact: BoolArray
    colors: FloatArray
    finishes: IntArray
    joint_first: IntArray
    joint_degrees: IntArray
    joint_edges: FloatArray
    lengths: FloatArray


def linear(colors: FloatArray) -> FloatArray:
    """Light of colours that are sRGB from 0 to 255."""
    return (colors / 255) ** 2.2


def gather(shapes: Sequence[Shape]) -> Scene:
    """One scene of shapes, about the origin of the first."""
    origin = shapes[0].origin
    points = [shape.points + (shape.origin - origin) for shape in shapes]
    firsts = np.cumsum([0, *(len(each) for each in points)]).tolist()
    counts = [len(shape.rows) for shape in shapes]
    places = np.cumsum([0, *counts]).tolist()
    tables = [
        np.concatenate([shape.rows, shape.centers + (shape.origin - origin)], axis=1).T
        for shape in shapes
    ]
    first, degrees, edges, lengths = _all_joints(shapes)
    return Scene(
        origin,
        np.concatenate(points),
        np.concatenate([shape.normals for shape in shapes]),
        np.concatenate(
            [shape.triangles + n for shape, n in zip(shapes, firsts, strict=False)]
        ),
        np.concatenate([shape.surfaces + n for shape, n in zip(shapes, places, strict=False)]),
        np.concatenate([np.full(len(each.triangles), each.is_closed) for each in shapes]),
        np.concatenate([np.full(len(each.triangles), each.is_veil) for each in shapes]),
        np.ascontiguousarray(np.concatenate(tables, axis=1)),
        np.concatenate([shape.rows.any(axis=1) for shape in shapes]),
        np.concatenate([linear(shape.colors) for shape in shapes]),
        np.repeat([FINISHES.index(shape.finish) for shape in shapes], counts),
        first, degrees, edges, lengths,
    )  # fmt: skip


def _all_joints(
    shapes: Sequence[Shape],
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    first: list[IntArray] = []
    degrees: list[IntArray] = []
    lengths: list[FloatArray] = []
    edges = [np.zeros((0, 8))]
    so_far = 0
    for shape in shapes:
        nothing, joints = np.zeros(len(shape.rows), np.int64), shape.joints
        first.append(nothing if joints is None else joints.first + so_far)
        degrees.append(nothing if joints is None else joints.degrees)
        size = float(np.ptp(shape.points, axis=0).max()) if joints is None else joints.length
        lengths.append(np.full(len(shape.rows), size))
        if joints is not None:
            edges.append(joints.edges)
            so_far += len(joints.edges)
    return (
        np.concatenate(first),
        np.concatenate(degrees),
        np.ascontiguousarray(np.concatenate(edges).T),
        np.concatenate(lengths),
    )


@dataclass(frozen=True)
class Sight:
    """What is seen at n places of a picture. Vectors are columns: (3, n)."""

    x: FloatArray  # (n,) where in the picture, to the right, in samples
    y: FloatArray  # and downwards
    triangles: IntArray  # (n,) that are seen
    surfaces: IntArray  # (n,) that are seen
    points: FloatArray  # (3, n) of the surfaces, in the coordinates of the scene
    normals: FloatArray  # (3, n) exact unit normals there, towards the viewer
    rays: FloatArray  # (3, n) unit vectors from the viewer to the points
    is_inside: BoolArray  # (n,) whether the side is seen that does not look outwards
    joints: FloatArray  # (n,) share that is covered by a joint


def look(
    scene: Scene,
    camera: Camera,
    x: FloatArray,
    y: FloatArray,
    found: IntArray,
    near: FloatArray,
) -> Sight:
    """Cut the rays of places in a picture with the surfaces of the triangles seen there.

    Places (n,) are samples to the right and downwards; of each the triangle `found` and its
    nearness.
    """
    surfaces = scene.surfaces[found]
    rays = pixel_rays(camera, x, y)
    table = np.take(scene.table, surfaces, axis=1)
    a, b, c, centers = table[0], table[1:4], table[4], table[5:8]
    # It is a small step from the triangle to the surface: it costs no digits.
    depth = 1 / near
    points = camera.eye[:, None] + rays * depth - centers
    normals = b - 2 * a * points
    slope, square = product(normals, rays), product(rays, rays)
    value = a * product(points, points) - product(b, points) + c
    # At its outline a sphere may be missed by a ray that still meets the triangle, and a wall
    # seen edge on be met anywhere: there the point of the triangle has to do.
    root = np.sqrt(np.maximum(slope**2 - 4 * a * square * value, 0))
    divisor = slope + np.copysign(root, slope)
    size = scene.lengths[surfaces]
    is_near = np.abs(2 * value) * np.sqrt(square) < size * np.abs(divisor)
    step = np.divide(2 * value, divisor, out=np.zeros_like(value), where=is_near)
    points += step * rays
    outwards = b - 2 * a * points
    blurred = np.flatnonzero(~scene.is_exact[surfaces])
    if len(blurred):
        outwards[:, blurred] = _mean_normals(scene, camera, rays[:, blurred], found[blurred])
    outwards /= np.sqrt(product(outwards, outwards))
    rays /= np.sqrt(square)
    is_inside = product(outwards, rays) > 0
    joints = _joints(scene, surfaces, points, camera.focal * near)
    points += centers
    towards = outwards * np.where(is_inside, -1.0, 1.0)
    return Sight(x, y, found, surfaces, points, towards, rays, is_inside, joints)


def product(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar products of the columns of (3, n)."""
    result = a[0] * b[0]
    result += a[1] * b[1]
    result += a[2] * b[2]
    return result


def _mean_normals(
    scene: Scene, camera: Camera, rays: FloatArray, found: IntArray
) -> FloatArray:
    """Normals (3, n) of points, interpolated where rays meet their triangles."""
    ids = scene.triangles[found]
    corners = [(scene.points[ids[:, k]] - camera.eye).T for k in range(3)]
    total = np.zeros_like(rays)
    for k in range(3):
        # The volume that the ray spans with the other two corners is the weight of this one.
        weight = product(rays, _cross(corners[k - 2], corners[k - 1]))
        total += weight * scene.normals[ids[:, k]].T
    # The sign of all three weights is that of the side from which the triangle is seen.
    flat = _cross(corners[1] - corners[0], corners[2] - corners[0])
    return total * np.sign(product(total, flat))


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.stack(
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    )


def _joints(
    scene: Scene, surfaces: IntArray, points: FloatArray, scale: FloatArray
) -> FloatArray:
    """Share of samples within the width of a joint from an edge of their surface."""
    first, degrees = scene.joint_first[surfaces], scene.joint_degrees[surfaces]
    nearest = np.full(len(surfaces), np.inf)
    for corner in range(int(degrees.max(initial=0))):
        place = first + np.minimum(corner, degrees - 1)
        edge = np.take(scene.joint_edges, np.maximum(place, 0), axis=1)
        distance = np.abs(product(edge[:3], points) + edge[3])
        # Beyond its ends the plane of an edge may cut into a concave panel.
        along = np.abs(product(edge[4:7], points) + edge[7])
        np.minimum(nearest, distance, out=nearest, where=(along < 1.05) & (degrees > 0))
    length = scene.lengths[surfaces] * scale
    half = np.maximum(JOINT_WIDTH * length, MIN_JOINT)
    share = np.clip((half - nearest * scale) / PIXEL + 0.5, 0, 1)
    return share * np.minimum(1.0, length / FINE_PANEL)
