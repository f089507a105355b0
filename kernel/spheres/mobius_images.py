"""Images of points, spheres, circles and arcs under Möbius maps.

Everything is mapped in closed form about its own place (`mobius_local`); the matrix is never
multiplied onto geometry, which would lose digits with the fourth power of the distance. What
happens to orientation is said in `mobius_group`.
"""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, dot, norm, unit
from ..errors import InputError, name_ids
from ..tolerances import EPSILON
from .arcs import Arcs
from .circles import Circles
from .mobius_group import read_transform
from .mobius_local import bend_vectors, offset_images, point_images, row_images, turn_vectors
from .rows import recenter


def map_spheres(rows: FloatArray, transform: ArrayLike) -> FloatArray:
    """Images of spheres, planes and points seen as rows (..., 5), in model coordinates.

    Rows of the same norm, oriented so that sides are kept; exactly A = 0 where a sphere passes,
    within rounding, through the point sent to infinity.

    Raises
    ------
    InputError
        If the transform is no Möbius map.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1.
    """
    local = read_transform(transform)
    near = recenter(np.asarray(rows, float), local.origin)
    images = row_images(local, near, np.broadcast_to(local.origin, near[..., 1:4].shape))
    return recenter(images, -local.image)


def sent_to_infinity(points: FloatArray, transform: ArrayLike) -> BoolArray:
    """Which points (..., 3) have no image in space: up to rounding the centre of an inversion.

    Raises
    ------
    InputError
        If the transform is no Möbius map.
    """
    vectors, rounding = bend_vectors(read_transform(transform), np.asarray(points, float))
    return norm(vectors) <= rounding


def map_points(points: FloatArray, transform: ArrayLike) -> FloatArray:
    """Images of points (..., 3).

    Raises
    ------
    InputError
        If a point is sent to infinity, which `sent_to_infinity` tells beforehand; the message
        names the rows. If the transform is no Möbius map.
    """
    points = np.asarray(points, float)
    local = read_transform(transform)
    vectors, rounding = bend_vectors(local, points)
    refuse_rows(norm(vectors) <= rounding, "points {} are sent to infinity; leave them out")
    return point_images(local, points)


def map_circles(circles: Circles, transform: ArrayLike) -> Circles:
    """Images of real circles, in model coordinates.

    Going round about the normal stays going round about the normal.

    Raises
    ------
    InputError
        If a circle is imaginary, or its image a straight line; the message names them.

    Notes
    -----
    The curvature vector at a point of a curve, across its tangent, becomes
    ``rotation (κ + 2 g) / scale`` with g the bend there across the tangent.
    """
    local = read_transform(transform)
    centers, axes = np.asarray(circles.centers, float), circles.normals
    refuse_rows(~(circles.radii_squared > 0), "circles {} are imaginary or points")
    radii = np.sqrt(circles.radii_squared)[..., None]
    away, _ = bend_vectors(local, centers)
    flat = away - dot(away, axes)[..., None] * axes
    helper = np.eye(3)[np.argmin(np.abs(axes), axis=-1)]
    # Where the circle is farthest from the point sent to infinity.
    is_round = norm(flat) <= EPSILON * (1 + norm(away))
    outward = unit(np.where(is_round[..., None], np.cross(axes, helper), flat))
    bases = centers + radii * outward
    tangents = np.cross(axes, outward)
    vectors, _ = bend_vectors(local, bases)
    square = dot(vectors, vectors)[..., None]
    bends = local.strength * vectors / square
    bends = bends - dot(bends, tangents)[..., None] * tangents
    bent = 2 * bends - outward / radii
    size = 1 / radii[..., 0] + 2 * norm(bends)
    place = 1 + (norm(bases) + norm(local.origin)) * size
    is_line = norm(bent) <= 8 * EPSILON * size * place
    refuse_rows(is_line, "circles {} become straight lines; move the centre off them")
    curvature = turn_vectors(local, bases, bent) * square / local.scale
    tangents = turn_vectors(local, bases, tangents)
    length = dot(curvature, curvature)
    images = point_images(local, bases) + curvature / length[..., None]
    return Circles(images, np.cross(tangents, unit(curvature)), 1 / length)


def map_arcs(arcs: Arcs, transform: ArrayLike) -> Arcs:
    """Images of arcs, in model coordinates, by their ends and their middle.

    From the images of the starts to those of the ends; `rises` points to the bulge.

    Raises
    ------
    InputError
        If an end is sent to infinity, or an image is more than a half circle (or passes
        through infinity), which no `Arcs` can hold; the message names them.
    """
    local = read_transform(transform)
    middles = (arcs.starts + arcs.ends) / 2 + arcs.sagittas[:, None] * arcs.rises
    for points in (arcs.starts, middles, arcs.ends):
        vectors, rounding = bend_vectors(local, points)
        refuse_rows(
            norm(vectors) <= rounding, "arcs {} pass through the point sent to infinity"
        )
    first = offset_images(local, middles, arcs.starts - middles)
    last = offset_images(local, middles, arcs.ends - middles)
    # Start to middle to end turns by half of the sweep.
    turns = np.arctan2(norm(np.cross(-first, last)), dot(-first, last))
    refuse_rows(
        turns > np.pi / 2,
        "the images of arcs {} are more than half circles; move the centre away",
    )
    chords = last - first
    along = unit(chords)
    toward = -(first - dot(first, along)[:, None] * along)
    level = turn_vectors(local, middles, arcs.rises)
    level = unit(level - dot(level, along)[:, None] * along)
    is_straight = norm(toward) <= EPSILON * norm(chords)
    rises = np.where(is_straight[:, None], level, unit(toward))
    sagittas = np.tan(turns / 2) * norm(chords) / 2
    sagittas = np.where(is_straight, 0.0, sagittas)
    images = point_images(local, arcs.starts), point_images(local, arcs.ends)
    return Arcs(*images, rises, sagittas)


def refuse_rows(is_bad: BoolArray, message: str) -> None:
    """Raise an error that names the bad rows where its message has ``{}``.

    Raises
    ------
    InputError
        If a row is bad.
    """
    if np.any(is_bad):
        raise InputError(message.format(name_ids(np.flatnonzero(is_bad).tolist())))
