"""
Möbius maps near a point: what a Lorentz matrix is read into before it acts on anything.

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
from ..tolerances import EPSILON, TRANSFORM_DIGITS

SIGNATURE = np.diag([1.0, 1.0, 1.0, 1.0, -1.0])
_TO_PENTASPHERICAL = np.array(
    [[0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 0], [-1, 0, 0, 0, 1], [1, 0, 0, 0, 1.0]]
)
_FROM_PENTASPHERICAL = np.linalg.inv(_TO_PENTASPHERICAL)
_ROUNDING = 64 * EPSILON


@dataclass(frozen=True)
class LocalMap:
    """
    A Möbius map seen from a point.

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
        """
        Whether right and left change places, as in every inversion.

        Returns
        -------
        bool
            True for an odd number of reflections.
        """
        return bool(np.linalg.det(self.rotation) < 0)


def make_local(
    origin: FloatArray, image: FloatArray, scale: float, rotation: FloatArray, bend: FloatArray
) -> LocalMap:
    """
    A map from its bend vector.

    Parameters
    ----------
    origin, image : (3,) float array
        A point and its image.
    scale : float
        Positive stretch at the origin.
    rotation : (3, 3) float array
        Nearly orthogonal; the nearest orthogonal matrix is taken.
    bend : (3,) float array
        The vector g.

    Returns
    -------
    LocalMap
        The map.
    """
    strength = float(norm(bend))
    direction = bend / strength if strength > 0 else np.array([1.0, 0.0, 0.0])
    u, _, vt = np.linalg.svd(rotation)
    return LocalMap(origin, image, float(scale), u @ vt, unit(direction), strength)


def to_matrix(local: LocalMap) -> FloatArray:
    """
    Lorentz matrix of a map on pentaspherical coordinates.

    Parameters
    ----------
    local : LocalMap
        The map.

    Returns
    -------
    (5, 5) float array
        The matrix, whose last entry is positive.
    """
    bend = local.strength * local.direction
    inner = np.zeros((5, 5))
    inner[0] = np.concatenate([[1.0], bend, [local.strength**2]]) / local.scale
    inner[1:4, 1:4] = local.rotation
    inner[1:4, 4] = 2 * local.rotation @ bend
    inner[4, 4] = local.scale
    rows = _translation(local.image) @ inner @ _translation(-local.origin)
    return _TO_PENTASPHERICAL @ rows @ _FROM_PENTASPHERICAL


def _translation(shift: FloatArray) -> FloatArray:
    result = np.eye(5)
    result[1:4, 0] = 2 * shift
    result[4, 1:4] = shift
    result[4, 0] = shift @ shift
    return result


def read_matrix(transform: FloatArray) -> LocalMap:
    """
    The map that a Lorentz matrix stands for.

    Parameters
    ----------
    transform : (5, 5) float array
        A Lorentz matrix; M and -M are the same map.

    Returns
    -------
    LocalMap
        Exactly a Möbius map, whatever the rounding of the matrix.

    Raises
    ------
    InputError
        If rounding far from the origin has eaten the map.

    Notes
    -----
    Similarities, and reflections in spheres and planes, keep all digits at any distance D from
    the origin: a matrix of these is known by its large entries. Any other map with radius of
    inversion r is known from its matrix to about ``ε D⁴ / r²`` (in model units).
    """
    matrix = transform if transform[4, 4] > 0 else -transform
    local = _read_similarity(matrix)
    if local is None:
        local = _read_reflection(matrix)
    return _read_any(matrix) if local is None else local


def _read_similarity(matrix: FloatArray) -> LocalMap | None:
    shift = matrix[:3, 4]  # translation over scale
    square = shift @ shift
    if matrix[3, 4] > 0:
        scale = (matrix[4, 4] + matrix[3, 4]) / (1 + square)
    else:
        scale = 1 / (matrix[4, 4] - matrix[3, 4])
    zero = np.zeros(3)
    local = make_local(zero, scale * shift, scale, matrix[:3, :3], zero)
    # An entry is rounded at the size of its block.
    length, corner = 1 + np.abs(shift).max(), scale * (1 + square) + 1 / scale
    bounds = np.full((5, 5), corner)
    bounds[:3, :3] = 1
    bounds[:3, 3:] = bounds[3:, :3] = length
    is_same = np.abs(to_matrix(local) - matrix) <= _ROUNDING * bounds
    return local if is_same.all() else None


def _read_reflection(matrix: FloatArray) -> LocalMap | None:
    outer = (SIGNATURE - matrix @ SIGNATURE) / 2  # w wᵀ
    largest = int(np.argmax(np.diag(outer)))
    if not outer[largest, largest] > 0:
        return None
    mirror = outer[:, largest] / np.sqrt(outer[largest, largest])
    product = mirror[:, None] * mirror
    bounds = np.abs(product) + np.eye(5)
    if not (np.abs(outer - product) <= _ROUNDING * bounds).all():
        return None
    b, c = mirror[:3], (mirror[3] + mirror[4]) / 2
    return local_reflection(_leading_coefficient(mirror), b, float(c))


def _leading_coefficient(mirror: FloatArray) -> float:
    """A of a unit row: half of C + A minus C - A, or from the norm where that cancels."""
    a, c = (mirror[4] - mirror[3]) / 2, (mirror[4] + mirror[3]) / 2
    square = mirror[:3] @ mirror[:3]
    error = EPSILON * (abs(a) + abs(c))
    if c == 0:
        return float(a)
    from_norm = EPSILON * (square + 1) / abs(4 * c) + error * abs(a / c)
    if from_norm < error:
        a, error = (square - 1) / (4 * c), from_norm
    return 0.0 if abs(a) <= 4 * error else float(a)


def local_reflection(a: float, b: FloatArray, c: float) -> LocalMap:
    """
    Reflection in a unit row, seen from the point of the sphere nearest the origin.

    Parameters
    ----------
    a : float
        Coefficient A of the row; 0 for a plane.
    b : (3,) float array
        Coefficients B.
    c : float
        Coefficient C.

    Returns
    -------
    LocalMap
        The reflection, which fixes its origin.
    """
    length = float(norm(b))
    if length > 0:
        normal, foot = b / length, 2 * c / (length * (length + 1)) * b
    else:
        normal = np.array([1.0, 0.0, 0.0])
        foot = -normal / (2 * a)
    mirror = np.eye(3) - 2 * normal[:, None] * normal
    return make_local(foot, foot, 1.0, mirror, -2 * a * normal)


def _read_any(matrix: FloatArray) -> LocalMap:
    """M = S R: S the similarity that takes the origin's unit sphere along, R orthogonal."""
    ball = matrix[:, 4]
    if ball[3] > 0:
        height = (ball[4] + ball[3]) / (1 + ball[:3] @ ball[:3])
    else:
        height = 1 / (ball[4] - ball[3])
    zero = np.zeros(3)
    similarity = to_matrix(make_local(zero, height * ball[:3], height, np.eye(3), zero))
    turn = _orthogonal_part(similarity).T @ _orthogonal_part(matrix)
    defect = np.abs(turn.T @ turn - np.eye(4)).max()
    if not defect <= TRANSFORM_DIGITS:
        raise InputError(
            f"the transform has lost its digits to rounding (defect {defect:.1e}): it acts too "
            "far from the origin; bring the model near the origin first, or apply the "
            "transforms one after another"
        )
    u, _, vt = np.linalg.svd(turn)
    inner = _read_orthogonal(u @ vt)
    image = height * (ball[:3] + inner.image)
    bend = inner.strength * inner.direction
    return make_local(inner.origin, image, height * inner.scale, inner.rotation, bend)


def _orthogonal_part(matrix: FloatArray) -> FloatArray:
    """R of M = L R, L the symmetric boost; rounded by ε |M|, where L⁻¹ M is by ε |M|²."""
    return matrix[:4, :4] - matrix[:4, 4:] * matrix[4, :4] / (1 + matrix[4, 4])


def _read_orthogonal(turn: FloatArray) -> LocalMap:
    """A turn of the 3-sphere, seen from a point far from the one sent to infinity."""
    to_infinity = turn[3]
    origin = np.zeros(3)
    if to_infinity[3] < 0:
        length = norm(to_infinity[:3])
        direction = to_infinity[:3] / length if length > 0 else np.array([1.0, 0.0, 0.0])
        origin = -direction
    square = origin @ origin
    sphere_point = np.concatenate([2 * origin, [square - 1]]) / (square + 1)
    moved = turn @ sphere_point
    image = moved[:3] / (1 - moved[3])
    matrix = np.eye(5)
    matrix[:4, :4] = turn
    rows = _FROM_PENTASPHERICAL @ matrix @ _TO_PENTASPHERICAL
    rows = _translation(-image) @ rows @ _translation(origin)
    return make_local(origin, image, 1 / rows[0, 0], rows[1:4, 1:4], rows[0, 1:4] / rows[0, 0])


def bend_vectors(local: LocalMap, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """
    How the map bends about other points than its origin.

    Parameters
    ----------
    local : LocalMap
        The map.
    points : (..., 3) float array
        Points, in model coordinates.

    Returns
    -------
    vectors : (..., 3) float array
        Bend direction plus strength times distance from the origin: vectors from the point
        sent to infinity, of length 1 at the origin.
    rounding : (...) float array
        A length that is not to be told from 0.
    """
    offset = points - local.origin
    vectors = local.direction + local.strength * offset
    sizes = norm(np.asarray(points, float)) + norm(local.origin)
    return vectors, _ROUNDING * (1 + local.strength * sizes)


def move_origin(local: LocalMap, origin: FloatArray) -> LocalMap:
    """
    The same map seen from another point.

    Parameters
    ----------
    local : LocalMap
        The map.
    origin : (3,) float array
        The point; not sent to infinity.

    Returns
    -------
    LocalMap
        The map.
    """
    offset = origin - local.origin
    vector, _ = bend_vectors(local, origin)
    square = float(vector @ vector)
    bend = local.strength * vector / square
    numerator = offset + (offset @ offset) * local.strength * local.direction
    image = local.image + local.scale * (local.rotation @ numerator) / square
    rotation = local.rotation @ mirror_matrix(local.direction) @ mirror_matrix(unit(vector))
    return make_local(origin, image, local.scale / square, rotation, bend)


def mirror_matrix(direction: FloatArray) -> FloatArray:
    """
    Reflection in the plane across a unit vector.

    Parameters
    ----------
    direction : (3,) float array
        Unit vector n.

    Returns
    -------
    (3, 3) float array
        ``I - 2 n nᵀ``.
    """
    return np.eye(3) - 2 * direction[:, None] * direction


def after(second: LocalMap, first: LocalMap) -> LocalMap:
    """
    One map after another.

    Parameters
    ----------
    second, first : LocalMap
        The maps; `first` is applied first.

    Returns
    -------
    LocalMap
        The composition, seen from a point far from all that is sent to infinity.
    """
    bends = [first.strength, first.scale * second.strength]
    reach = min((1 / bend for bend in bends if bend > 0), default=0.0)
    steps = np.concatenate([np.zeros((1, 3)), 2 * reach * np.eye(3), -2 * reach * np.eye(3)])
    best: LocalMap | None = None
    for origin in first.origin + steps:
        vector, rounding = bend_vectors(first, origin)
        if norm(vector) <= 1024 * rounding:
            continue
        start = move_origin(first, origin)
        vector, rounding = bend_vectors(second, start.image)
        if norm(vector) <= 1024 * rounding:
            continue
        found = _follow(start, move_origin(second, start.image))
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
    bend = np.where(norm(bend) <= _ROUNDING * reach * bends, 0.0, bend)
    return make_local(
        first.origin, second.image, first.scale * second.scale,
        second.rotation @ first.rotation, bend,
    )  # fmt: skip


def point_images(local: LocalMap, points: FloatArray) -> FloatArray:
    """
    Images of points that are not sent to infinity.

    Parameters
    ----------
    local : LocalMap
        The map.
    points : (..., 3) float array
        Points.

    Returns
    -------
    (..., 3) float array
        Images.
    """
    offset = points - local.origin
    vectors, _ = bend_vectors(local, points)
    square = dot(vectors, vectors)[..., None]
    numerator = offset + dot(offset, offset)[..., None] * local.strength * local.direction
    return local.image + local.scale * (numerator / square) @ local.rotation.T


def turn_vectors(local: LocalMap, points: FloatArray, vectors: FloatArray) -> FloatArray:
    """
    Directions at points turned as the map turns them there, without its stretch.

    Parameters
    ----------
    local : LocalMap
        The map.
    points : (..., 3) float array
        Points.
    vectors : (..., 3) float array
        Vectors at the points.

    Returns
    -------
    (..., 3) float array
        Vectors of the same length at the images.
    """
    along, _ = bend_vectors(local, points)
    along = unit(along)
    vectors = vectors - 2 * dot(vectors, along)[..., None] * along
    vectors = vectors - 2 * dot(vectors, local.direction)[..., None] * local.direction
    return vectors @ local.rotation.T


def row_images(local: LocalMap, rows: FloatArray, points: FloatArray) -> FloatArray:
    """
    Images of rows seen from points, seen from the images of the points.

    Parameters
    ----------
    local : LocalMap
        The map.
    rows : (..., 5) float array
        Rows seen from the points.
    points : (..., 3) float array
        Points that are not sent to infinity.

    Returns
    -------
    (..., 5) float array
        Rows of the same norm; exactly A = 0 where the sphere passes, within rounding, through
        the point sent to infinity.
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
    """
    What small steps from points become, seen from the images of the points.

    Parameters
    ----------
    local : LocalMap
        The map.
    points : (..., 3) float array
        Points that are not sent to infinity.
    offsets : (..., 3) float array
        Steps from the points.

    Returns
    -------
    (..., 3) float array
        Image of point plus step, minus image of the point, without cancellation.
    """
    vectors, _ = bend_vectors(local, points)
    moved = vectors + local.strength * offsets
    bends = local.strength * vectors
    scales = local.scale / dot(moved, moved)
    square = dot(vectors, vectors)
    steps = offsets + (dot(offsets, offsets) / square)[..., None] * bends
    return scales[..., None] * turn_vectors(local, points, steps)
