"""Möbius maps near a point: the form in which they act on geometry without loss of digits.

About any point that is not sent to infinity a Möbius map is

    f(origin + ξ) = image + scale rotation (ξ + |ξ|² g) / (1 + 2 g·ξ + |g|² |ξ|²),

with a bend vector g that vanishes for similarities; seen from the origin, ``-g / |g|²`` is sent
to infinity. A row (A, B, C) seen from the origin becomes, seen from the image,

    A' = (A + g·B + |g|² C) / scale,    B' = rotation (B + 2 C g),    C' = scale C.

Nothing in these forms cancels. The product of the matrix with a row does, by the fourth power
of the distance from the origin over the square of the radius of inversion.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, dot, norm, unit
from ..errors import InputError
from ..tolerances import EPSILON

MAP_ROUNDING = 64 * EPSILON
"""Relative rounding of a map and its matrix."""


@dataclass(frozen=True)
class LocalMap:
    """A Möbius map seen from a point.

    Attributes
    ----------
    origin, image : (3,) float array
        The point and its image.
    scale : float
        Positive stretch at the origin.
    rotation : (3, 3) float array
        Orthogonal; of determinant -1 where the map turns right into left.
    direction : (3,) float array
        Unit vector along the bend, away from the point sent to infinity; any if the bend is 0.
    strength : float
        Length of the bend: one over the distance of the point sent to infinity.
    """

    origin: FloatArray
    image: FloatArray
    scale: float
    rotation: FloatArray
    direction: FloatArray
    strength: float

    @property
    def reverses(self) -> bool:
        """Whether right and left change places: an odd number of reflections, as inversions."""
        return bool(np.linalg.det(self.rotation) < 0)


def make_local(
    origin: FloatArray, image: FloatArray, scale: float, rotation: FloatArray, bend: FloatArray
) -> LocalMap:
    """A map from its bend vector g, (3,), which sends a point `origin` to its `image`.

    The scale is the positive stretch at the origin; of the nearly orthogonal rotation (3, 3)
    the nearest orthogonal matrix is taken.
    """
    strength = float(norm(bend))
    direction = bend / strength if strength > 0 else np.array([1.0, 0.0, 0.0])
    u, _, vt = np.linalg.svd(rotation)
    return LocalMap(origin, image, float(scale), u @ vt, unit(direction), strength)


def _mirror_matrix(direction: FloatArray) -> FloatArray:
    """Reflection ``I - 2 n nᵀ`` in the plane across a unit vector."""
    return np.eye(3) - 2 * direction[:, None] * direction


def bend_vectors(local: LocalMap, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How the map bends about other points (..., 3) than its origin, in model coordinates.

    Bend direction plus strength times distance from the origin: vectors (..., 3) from the point
    sent to infinity, of length 1 at the origin. Also a length that is not to be told from 0.
    """
    offset = points - local.origin
    vectors = local.direction + local.strength * offset
    sizes = norm(np.asarray(points, float)) + norm(local.origin)
    return vectors, MAP_ROUNDING * (1 + local.strength * sizes)


def _move_origin(local: LocalMap, origin: FloatArray) -> LocalMap:
    """The same map seen from another point, which is not sent to infinity."""
    offset = origin - local.origin
    vector, _ = bend_vectors(local, origin)
    square = float(vector @ vector)
    bend = local.strength * vector / square
    numerator = offset + (offset @ offset) * local.strength * local.direction
    image = local.image + local.scale * (local.rotation @ numerator) / square
    rotation = local.rotation @ _mirror_matrix(local.direction) @ _mirror_matrix(unit(vector))
    return make_local(origin, image, local.scale / square, rotation, bend)


def after(second: LocalMap, first: LocalMap) -> LocalMap:
    """One map after another: `first` is applied first.

    The composition is seen from a point far from all that is sent to infinity.
    """
    bends = [first.strength, first.scale * second.strength]
    reach = min((1 / bend for bend in bends if bend > 0), default=0.0)
    steps = np.concatenate([np.zeros((1, 3)), 2 * reach * np.eye(3), -2 * reach * np.eye(3)])
    best: LocalMap | None = None
    for origin in first.origin + steps:
        vector, rounding = bend_vectors(first, origin)
        if norm(vector) <= 1024 * rounding:
            continue
        start = _move_origin(first, origin)
        vector, rounding = bend_vectors(second, start.image)
        if norm(vector) <= 1024 * rounding:
            continue
        found = _follow(start, _move_origin(second, start.image))
        if best is None or found.strength < best.strength / 16:
            best = found
    if best is None:
        raise InputError(
            "the transforms cannot be composed without losing all digits; apply them one "
            "after another"
        )
    return best


def _follow(first: LocalMap, second: LocalMap) -> LocalMap:
    bend = first.strength * first.direction
    turned = first.rotation.T @ (second.strength * second.direction)
    bends = first.strength + first.scale * second.strength
    reach = 1 + bends * float(norm(first.origin) + norm(first.image) / first.scale)
    bend = bend + first.scale * turned
    # An inversion undone leaves no bend but rounding.
    bend = np.where(norm(bend) <= MAP_ROUNDING * reach * bends, 0.0, bend)
    return make_local(
        first.origin, second.image, first.scale * second.scale,
        second.rotation @ first.rotation, bend,
    )  # fmt: skip


def point_images(local: LocalMap, points: FloatArray) -> FloatArray:
    """Images of points (..., 3) that are not sent to infinity."""
    offset = points - local.origin
    vectors, _ = bend_vectors(local, points)
    square = dot(vectors, vectors)[..., None]
    numerator = offset + dot(offset, offset)[..., None] * local.strength * local.direction
    return local.image + local.scale * (numerator / square) @ local.rotation.T


def turn_vectors(local: LocalMap, points: FloatArray, vectors: FloatArray) -> FloatArray:
    """Directions at points turned as the map turns them there, without its stretch.

    Vectors (..., 3) at points (..., 3) become vectors of the same length at the images.
    """
    along, _ = bend_vectors(local, points)
    along = unit(along)
    vectors = vectors - 2 * dot(vectors, along)[..., None] * along
    vectors = vectors - 2 * dot(vectors, local.direction)[..., None] * local.direction
    return vectors @ local.rotation.T


def row_images(local: LocalMap, rows: FloatArray, points: FloatArray) -> FloatArray:
    """Images of rows (..., 5) seen from points (..., 3), seen from the images of the points.

    No point is sent to infinity. Rows of the same norm; exactly A = 0 where the sphere passes,
    within rounding, through the point sent to infinity.
    """
    vectors, _ = bend_vectors(local, points)
    square = dot(vectors, vectors)
    bends = local.strength * vectors / square[..., None]
    scales = local.scale / square
    a, b, c = rows[..., 0], rows[..., 1:4], rows[..., 4]
    bend_square = dot(bends, bends)
    curvature = a + dot(bends, b) + bend_square * c
    size = np.abs(a) + norm(bends) * norm(b) + bend_square * np.abs(c)
    # What the position of the points is rounded by moves the bends as well.
    place = norm(np.asarray(points, float)) + norm(local.origin)
    rounding = 8 * EPSILON * size * (1 + norm(bends) * place)
    is_flat = (np.abs(curvature) <= rounding) & (bend_square > 0)
    curvature = np.where(is_flat, 0.0, curvature)
    direction = turn_vectors(local, points, b + 2 * c[..., None] * bends)
    return np.concatenate(
        [(curvature / scales)[..., None], direction, (scales * c)[..., None]], -1
    )


def offset_images(local: LocalMap, points: FloatArray, offsets: FloatArray) -> FloatArray:
    """What small steps from points become, seen from the images of the points, each (..., 3).

    Image of point plus step, minus image of the point, without cancellation; no point is sent
    to infinity.
    """
    vectors, _ = bend_vectors(local, points)
    moved = vectors + local.strength * offsets
    bends = local.strength * vectors
    scales = local.scale / dot(moved, moved)
    square = dot(vectors, vectors)
    steps = offsets + (dot(offsets, offsets) / square)[..., None] * bends
    return scales[..., None] * turn_vectors(local, points, steps)
