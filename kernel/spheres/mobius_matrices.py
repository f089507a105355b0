"""Möbius maps and their Lorentz matrices: each made from the other."""

import numpy as np

from ..arrays import FloatArray, norm
from ..errors import InputError
from ..tolerances import EPSILON, TRANSFORM_DIGITS
from .mobius_local import MAP_ROUNDING, LocalMap, make_local
from .pentaspherical import SIGNATURE

_TO_PENTASPHERICAL = np.array(
    [[0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 0], [-1, 0, 0, 0, 1], [1, 0, 0, 0, 1.0]]
)
_FROM_PENTASPHERICAL = np.linalg.inv(_TO_PENTASPHERICAL)


def to_matrix(local: LocalMap) -> FloatArray:
    """Lorentz matrix (5, 5) of a map on pentaspherical coordinates, the last entry positive."""
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
    """The map that a Lorentz matrix stands for; M and -M are the same map.

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
    is_same = np.abs(to_matrix(local) - matrix) <= MAP_ROUNDING * bounds
    return local if is_same.all() else None


def _read_reflection(matrix: FloatArray) -> LocalMap | None:
    outer = (SIGNATURE - matrix @ SIGNATURE) / 2  # w wᵀ
    largest = int(np.argmax(np.diag(outer)))
    if not outer[largest, largest] > 0:
        return None
    mirror = outer[:, largest] / np.sqrt(outer[largest, largest])
    product = mirror[:, None] * mirror
    bounds = np.abs(product) + np.eye(5)
    if not (np.abs(outer - product) <= MAP_ROUNDING * bounds).all():
        return None
    b, c = mirror[:3], (mirror[3] + mirror[4]) / 2
    return _local_reflection(_leading_coefficient(mirror), b, float(c))


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


def _local_reflection(a: float, b: FloatArray, c: float) -> LocalMap:
    """Reflection in a unit row, seen from the point of the sphere nearest the origin: fixed."""
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
