"""The Möbius group: similarities, inversions, their products, and what they do to everything.

A transform is a (5, 5) Lorentz matrix on pentaspherical coordinates: ``Mᵀ J M = J`` with
``J = diag(1, 1, 1, 1, -1)``. M and -M are the same map.

Orientation: a map takes sides along. The side of a sphere to which N points goes to the side to
which N points of the image, so that outside stays outside (the image of it, even where the
centre of an inversion lies inside). An inversion turns right into left: faces keep their ids,
but the order of their vertices is reversed, so that N agrees with the normal of the face again.
Edges are therefore numbered anew.

The formulas are those of Section 2 of the paper "Meshes with Spherical Faces".
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray, norm, unit
from ..errors import InputError
from ..tolerances import LORENTZ
from .mobius_local import LocalMap, after, make_local
from .mobius_matrices import read_matrix, to_matrix
from .pentaspherical import SIGNATURE, pentaspherical
from .rows import Kind, kind, normalize


def check_transform(transform: ArrayLike) -> FloatArray:
    """Refuse a matrix that is no Möbius map, (5, 5).

    Raises
    ------
    InputError
        If the shape is wrong, an entry is not finite, or ``Mᵀ J M`` is not J; the message
        states by how much.
    """
    matrix = np.asarray(transform, float)
    if matrix.shape != (5, 5):
        raise InputError(f"a transform must have shape (5, 5), not {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise InputError("the transform has entries that are not finite")
    defect = float(np.abs(matrix.T @ SIGNATURE @ matrix - SIGNATURE).max())
    size = float(max(1.0, np.abs(matrix).max() ** 2))
    if not defect <= LORENTZ * size:
        raise InputError(
            f"the transform is no Möbius map: MᵀJM differs from J by {defect:.3g}; build it "
            "with inversion, similarity and compose"
        )
    return matrix


def similarity(
    scale: float = 1.0, rotation: ArrayLike | None = None, translation: ArrayLike | None = None
) -> FloatArray:
    """The map ``x -> scale rotation x + translation``.

    Parameters
    ----------
    scale : float
        Positive factor.
    rotation : (3, 3) array_like of float, optional
        Orthogonal matrix; of determinant -1 it also reflects. None by default.
    translation : (3,) array_like of float, optional
        Shift, in model units. None by default.

    Returns
    -------
    (5, 5) float array
        The transform.

    Raises
    ------
    InputError
        If the scale is not positive, or the matrix is not orthogonal.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, the Möbius group as Lorentz matrices.

    Examples
    --------
    >>> from spheremesh.kernel.spheres.mobius_images import map_points
    >>> lift = similarity(translation=[0, 0, 1])
    >>> map_points(np.zeros((1, 3)), lift).tolist()
    [[0.0, 0.0, 1.0]]
    """
    turn = np.asarray(np.eye(3) if rotation is None else rotation, float)
    shift = _vector(np.zeros(3) if translation is None else translation, "translation")
    _check_positive("scale", scale)
    if turn.shape != (3, 3):
        raise InputError(f"a rotation must have shape (3, 3), not {turn.shape}")
    defect = float(np.abs(turn.T @ turn - np.eye(3)).max())
    if not defect <= LORENTZ:
        raise InputError(f"the rotation is not orthogonal (RᵀR differs from 1 by {defect:.3g})")
    return to_matrix(make_local(np.zeros(3), shift, scale, turn, np.zeros(3)))


def inversion(center: ArrayLike, radius: float) -> FloatArray:
    """Inversion in a sphere: ``x -> c + r² (x - c) / |x - c|²``.

    The transform (5, 5), its own inverse: the centre c is sent to infinity, the sphere of
    radius r stays in place.

    Raises
    ------
    InputError
        If the centre is no point or the radius is not positive.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, Möbius transformations.

    Examples
    --------
    >>> from spheremesh.kernel.spheres.mobius_images import map_points
    >>> map_points(np.array([[0.5, 0, 0]]), inversion([0, 0, 0], 1)).tolist()
    [[2.0, 0.0, 0.0]]
    """
    point = _vector(center, "centre")
    _check_positive("radius", radius)
    constant = (point @ point - radius**2) / (2 * radius)
    return _reflect_in(np.concatenate([[0.5 / radius], point / radius, [constant]]))


def reflection(row: ArrayLike) -> FloatArray:
    """Reflection ``s -> s - 2 <<s, w>> w`` in a sphere (an inversion) or plane w of any scale.

    The transform (5, 5), its own inverse.

    Raises
    ------
    InputError
        If the row is a point or an imaginary sphere.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, reflection in a hyperplane.
    """
    mirror = np.asarray(row, float)
    if mirror.shape != (5,) or not np.isfinite(mirror).all():
        raise InputError("a mirror must be one row of 5 finite numbers")
    if int(kind(mirror)) not in {int(Kind.SPHERE), int(Kind.PLANE)}:
        raise InputError(
            "only real spheres and planes are mirrors, not points or imaginary ones"
        )
    return _reflect_in(normalize(mirror))


def _reflect_in(unit_row: FloatArray) -> FloatArray:
    mirror = pentaspherical(unit_row)
    return np.eye(5) - 2 * (mirror[:, None] * mirror) * np.diag(SIGNATURE)


def rotation_about(vector: ArrayLike) -> FloatArray:
    """Rotation matrix (3, 3) about an axis through the origin.

    The vector is the axis times the angle, in radians, counter-clockwise seen against the axis.

    Raises
    ------
    InputError
        If it is no vector of finite numbers.
    """
    turn = _vector(vector, "rotation")
    angle = float(norm(turn))
    x, y, z = unit(turn)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + 2 * np.sin(angle / 2) ** 2 * cross @ cross


def compose(transforms: Sequence[ArrayLike]) -> FloatArray:
    """Maps (5, 5) one after another, applied first to last; none of them give the identity.

    Raises
    ------
    InputError
        If one is no Möbius map; the message names it.

    Notes
    -----
    Similarities and reflections far from the origin come out without loss. The matrix of any
    other map, of stretch 1 at distance r from the point sent to infinity and both at distance
    D from the origin, is rounded by about ``ε D⁴ / r²`` (in model units): there, apply one
    transform after another.
    """
    local = read_transform(np.eye(5))
    for place, transform in enumerate(transforms):
        try:
            local = after(read_transform(transform), local)
        except InputError as error:
            raise InputError(f"transform {place}: {error}") from None
    return to_matrix(local)


def inverse(transform: ArrayLike) -> FloatArray:
    """The map that undoes another: ``J Mᵀ J``, exactly.

    Raises
    ------
    InputError
        If it is no Möbius map.
    """
    return SIGNATURE @ check_transform(transform).T @ SIGNATURE


def read_transform(transform: ArrayLike) -> LocalMap:
    """A checked transform in the form in which it maps geometry without loss of digits.

    Raises
    ------
    InputError
        As `check_transform`.
    """
    return read_matrix(check_transform(transform))


def _vector(value: ArrayLike, name: str) -> FloatArray:
    vector = np.asarray(value, float)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError(f"the {name} must be 3 finite numbers")
    return vector


def _check_positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0):
        raise InputError(f"the {name} must be positive and finite, not {value}")
